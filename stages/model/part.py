"""A part as it is asked for: its surface by kind, quantity, marks.

One class per kind of surface; `SurfaceSpec` is their union, told apart by the key `kind`.  The names of the fields are
those of the job file, and those of the paper: P, T, N, k are end data of a directrix, alpha and beta its shape
parameters, 0 and 1 its ends, `_hat` the second directrix.
"""

from collections.abc import Iterator
from typing import Annotated, Literal

from msgspec import Meta, field

from stages.model.curves import CurveSpec, Table, Trouble, is_flat
from stages.model.scalars import Angle, Curvature, Direction, Length, Number, Point, is_zero

ENDS_HAT = ("0", "1", "0_hat", "1_hat")


def zero_tangents(spec: Table, *keys: str) -> Iterator[Trouble]:
    """Yield the tangents of length 0."""
    for key in keys:
        if is_zero(getattr(spec, key)):
            yield Trouble(key, "the tangent has length 0", "give the direction of the curve at this end")


def zero_normals(spec: Table, *ends: str) -> Iterator[Trouble]:
    """Yield the normals of length 0 where the curvature is not 0."""
    for end in ends:
        if is_zero(getattr(spec, f"n{end}")) and getattr(spec, f"k{end}") != 0:
            yield Trouble(f"n{end}", f"the normal has length 0 but k{end} is not 0", f"give n{end}, or k{end} = 0")


def same_points(spec: Table, *pairs: tuple[str, str]) -> Iterator[Trouble]:
    """Yield the pairs of points that coincide."""
    for first, second in pairs:
        if getattr(spec, first) == getattr(spec, second):
            yield Trouble(second, f"{second} is the same point as {first}", "the two ends must differ")


def not_positive(spec: Table, *keys: str) -> Iterator[Trouble]:
    """Yield the values that are given and not above 0."""
    for key in keys:
        value = getattr(spec, key)
        if value is not None and value <= 0:
            yield Trouble(key, f"{float(value):g}", "must be above 0")


class QuinticRuled(Table, frozen=True, kw_only=True, tag_field="kind", tag="quintic-ruled"):
    """The paper's (2.1) and (2.2): two quintic directrices from their end data, values as given."""

    p0: Point
    p1: Point
    t0: Direction
    t1: Direction
    n0: Direction
    n1: Direction
    k0: Curvature
    k1: Curvature
    alpha0: Length
    alpha1: Length
    beta0: Length
    beta1: Length
    q0: Point
    q1: Point
    t0_hat: Direction
    t1_hat: Direction
    n0_hat: Direction
    n1_hat: Direction
    k0_hat: Curvature
    k1_hat: Curvature
    alpha0_hat: Length
    alpha1_hat: Length
    beta0_hat: Length
    beta1_hat: Length

    def troubles(self) -> Iterator[Trouble]:
        """Yield zero tangents, zero normals and coincident ends."""
        yield from zero_tangents(self, "t0", "t1", "t0_hat", "t1_hat")
        yield from zero_normals(self, *ENDS_HAT)
        yield from same_points(self, ("p0", "p1"), ("q0", "q1"))


class QuinticPlanar(Table, frozen=True, kw_only=True, tag_field="kind", tag="quintic-planar"):
    """Theorem 2.1: both directrices leave and arrive along the end rulings, all curvatures 0.  The patch is planar."""

    p0: Point
    p1: Point
    q0: Point
    q1: Point
    alpha0: Length
    alpha1: Length
    beta0: Length
    beta1: Length
    alpha0_hat: Length
    alpha1_hat: Length
    beta0_hat: Length
    beta1_hat: Length

    def troubles(self) -> Iterator[Trouble]:
        """Yield coincident points: the end rulings are the tangents, so they may not vanish."""
        yield from same_points(self, ("p0", "p1"), ("q0", "q1"), ("p0", "q0"), ("p1", "q1"))


class QuinticCylinder(Table, frozen=True, kw_only=True, tag_field="kind", tag="quintic-cylinder"):
    """Theorem 2.2: one quintic directrix, parallel rulings; beta = s alpha, Q1 - P1 = g (Q0 - P0)."""

    p0: Point
    q0: Point
    p1: Point
    t0: Direction
    t1: Direction
    n0: Direction
    n1: Direction
    k0: Curvature
    k1: Curvature
    alpha0: Length
    alpha1: Length
    s0: Number
    s1: Number
    g: Number

    def troubles(self) -> Iterator[Trouble]:
        """Yield what the theorem excludes: alpha, s and g are positive."""
        yield from zero_tangents(self, "t0", "t1")
        yield from zero_normals(self, "0", "1")
        yield from same_points(self, ("p0", "p1"), ("p0", "q0"))
        yield from not_positive(self, "alpha0", "alpha1", "s0", "s1", "g")


class QuinticCone(Table, frozen=True, kw_only=True, tag_field="kind", tag="quintic-cone"):
    """Theorem 2.3: the cone over a quintic directrix; shape parameters by the minimax of |r'|, or given.

    guess: Algorithm 2's initial guess alpha0, alpha1, beta0, beta1; found from the chord if absent.
    fraction: which part of the way to the apex is kept.
    """

    p0: Point
    p1: Point
    t0: Direction
    t1: Direction
    n0: Direction
    n1: Direction
    k0: Curvature
    k1: Curvature
    apex: Point
    alpha0: Length | None = None
    alpha1: Length | None = None
    beta0: Length | None = None
    beta1: Length | None = None
    guess: tuple[Length, Length, Length, Length] | None = None
    fraction: tuple[Number, Number] = field(default_factory=lambda: (Number(0), Number(1)))

    def troubles(self) -> Iterator[Trouble]:
        """Yield half-given shape parameters, a guess beside them, and what the theorem excludes."""
        yield from zero_tangents(self, "t0", "t1")
        yield from zero_normals(self, "0", "1")
        yield from same_points(self, ("p0", "p1"), ("p0", "apex"), ("p1", "apex"))
        yield from not_positive(self, *SHAPE_KEYS)
        yield from bad_fraction(self.fraction)
        given = [key for key in SHAPE_KEYS if getattr(self, key) is not None]
        if given and len(given) < len(SHAPE_KEYS):
            missing = ", ".join(key for key in SHAPE_KEYS if key not in given)
            yield Trouble(given[0], f"given without {missing}", "give all four shape parameters or none")
        if self.guess is not None and given:
            yield Trouble("guess", "a guess beside given shape parameters", "leave one of them out")
        if self.guess is not None and any(value <= 0 for value in self.guess):
            yield Trouble("guess", "a value that is not above 0", "alpha and beta are positive")


SHAPE_KEYS = ("alpha0", "alpha1", "beta0", "beta1")


def bad_fraction(fraction: tuple[Number, Number]) -> Iterator[Trouble]:
    """Yield a range of fractions that is not inside [0, 1] or not rising."""
    if not 0 <= fraction[0] < fraction[1] <= 1:
        yield Trouble("fraction", f"[{float(fraction[0]):g}, {float(fraction[1]):g}]", "0 <= a < b <= 1")


class NextPatch(Table, frozen=True, kw_only=True):
    """The new end of a further patch of a `quintic-strip`; which keys it needs depends on the first patch.

    After a cylinder: p1 t1 n1 k1 alpha1 s1 g.  After a cone: p1 t1 n1 k1 alpha1 beta1.  After a ruled patch: the same
    as after a cone plus q1 and the second directrix's values with `_hat`.
    """

    p1: Point
    t1: Direction
    n1: Direction
    k1: Curvature
    alpha1: Length
    s1: Number | None = None
    g: Number | None = None
    beta1: Length | None = None
    q1: Point | None = None
    t1_hat: Direction | None = None
    n1_hat: Direction | None = None
    k1_hat: Curvature | None = None
    alpha1_hat: Length | None = None
    beta1_hat: Length | None = None

    def troubles(self) -> Iterator[Trouble]:
        """Yield a zero tangent or normal."""
        yield from zero_tangents(self, "t1")
        yield from zero_normals(self, "1")


HAT_KEYS = ("q1", "t1_hat", "n1_hat", "k1_hat", "alpha1_hat", "beta1_hat")
NEXT_KEYS: dict[type[Table], tuple[str, ...]] = {
    QuinticCylinder: ("s1", "g"),
    QuinticCone: ("beta1",),
    QuinticRuled: ("beta1", *HAT_KEYS),
    QuinticPlanar: ("beta1", *HAT_KEYS),
}
"""The keys of `NextPatch` that a patch after one of these kinds needs, beside those that every patch has."""


class QuinticStrip(Table, frozen=True, kw_only=True, tag_field="kind", tag="quintic-strip"):
    """Theorem 3.1: patches joined with equal first and second derivatives of both directrices."""

    first: QuinticCylinder | QuinticCone | QuinticRuled | QuinticPlanar
    next: Annotated[tuple[NextPatch, ...], Meta(min_length=1)]

    def troubles(self) -> Iterator[Trouble]:
        """Yield keys that a further patch lacks, or has and cannot use."""
        wanted = NEXT_KEYS[type(self.first)]
        kind = self.first.__struct_config__.tag
        for i, patch in enumerate(self.next):
            for key in ("s1", "g", "beta1", *HAT_KEYS):
                given = getattr(patch, key) is not None
                if given and key not in wanted:
                    yield Trouble(f"next[{i}].{key}", f"not used after a {kind}", f"it takes {', '.join(wanted)}")
                if not given and key in wanted:
                    yield Trouble(f"next[{i}].{key}", f"missing after a {kind}", f"it takes {', '.join(wanted)}")


class Ruled(Table, frozen=True, kw_only=True, tag_field="kind", tag="ruled"):
    """Straight rulings between two curves, equal parameter to equal parameter."""

    c0: CurveSpec
    c1: CurveSpec

    def troubles(self) -> Iterator[Trouble]:
        """Yield curves that are not in space, and one curve given twice."""
        yield from plane_curves(self, "c0", "c1")
        if self.c0 == self.c1:
            yield Trouble("c1", "the same curve as c0", "the two curves must differ")


def plane_curves(spec: Table, *keys: str) -> Iterator[Trouble]:
    """Yield the curves with points of two coordinates."""
    for key in keys:
        if is_flat(getattr(spec, key)):
            yield Trouble(key, "a point with two coordinates", "give x, y and z; two are enough on flat parts only")


class Flat(Table, frozen=True, kw_only=True, tag_field="kind", tag="flat"):
    """A plate: a closed planar outline, and holes."""

    outline: CurveSpec
    holes: tuple[CurveSpec, ...] = ()


class Cone(Table, frozen=True, kw_only=True, tag_field="kind", tag="cone"):
    """A cone over any directrix, or a right frustum (axis z, radius0 at z = 0, seam at +x)."""

    apex: Point | None = None
    directrix: CurveSpec | None = None
    fraction: tuple[Number, Number] = field(default_factory=lambda: (Number(0), Number(1)))
    radius0: Length | None = None
    radius1: Length | None = None
    height: Length | None = None
    sweep: Angle = field(default_factory=lambda: Angle(360))

    def troubles(self) -> Iterator[Trouble]:
        """Yield a mixture of the two ways to describe a cone, and values that make none."""
        general = [key for key in ("apex", "directrix") if getattr(self, key) is not None]
        frustum = [key for key in ("radius0", "radius1", "height") if getattr(self, key) is not None]
        if general and frustum:
            yield Trouble(frustum[0], f"beside {general[0]}", "either apex and directrix, or radius0, radius1, height")
        elif len(general) == 1 or not (general or frustum):
            yield Trouble("", "apex and directrix go together", "or give radius0, radius1 and height")
        elif frustum and len(frustum) < len(("radius0", "radius1", "height")):
            yield Trouble("", f"only {' and '.join(frustum)}", "a frustum takes radius0, radius1 and height")
        yield from bad_fraction(self.fraction)
        if self.directrix is not None:
            yield from plane_curves(self, "directrix")
        if len(frustum) == len(("radius0", "radius1", "height")):
            yield from self._frustum_troubles()

    def _frustum_troubles(self) -> Iterator[Trouble]:
        radii = (self.radius0 or 0, self.radius1 or 0)
        for key, value in zip(("radius0", "radius1"), radii, strict=True):
            if value < 0:
                yield Trouble(key, f"{float(value):g} mm", "a radius may not be negative")
        if radii == (0, 0):
            yield Trouble("radius1", "both radii are 0", "one of them must be above 0")
        if self.height == 0 and radii[0] == radii[1]:
            yield Trouble("height", "0 mm between equal radii", "the surface would have no area")
        if (self.height or 0) < 0:
            yield Trouble("height", f"{float(self.height or 0):g} mm", "the height may not be negative")
        if not 0 < self.sweep <= Angle(360):
            yield Trouble("sweep", f"{float(self.sweep):g} deg", "above 0 and at most 360 deg")


class Plane(Table, frozen=True, kw_only=True):
    """A plane by a point and a normal."""

    point: Point
    normal: Direction

    def troubles(self) -> Iterator[Trouble]:
        """Yield a normal of length 0."""
        if is_zero(self.normal):
            yield Trouble("normal", "the vector has length 0", "give the direction across the plane")


class Cylinder(Table, frozen=True, kw_only=True, tag_field="kind", tag="cylinder"):
    """Parallel rulings over any directrix, cut by length or by planes."""

    directrix: CurveSpec
    direction: Direction
    length: Length | None = None
    start_plane: Plane | None = None
    end_plane: Plane | None = None

    def troubles(self) -> Iterator[Trouble]:
        """Yield a direction of length 0 and an end that is missing, doubled or at no distance."""
        yield from plane_curves(self, "directrix")
        if is_zero(self.direction):
            yield Trouble("direction", "the vector has length 0", "give the direction of the rulings")
        if (self.length is None) == (self.end_plane is None):
            yield Trouble("length", "exactly one of length and end_plane", "say where the rulings end")
        if self.length is not None and self.length <= 0:
            yield Trouble("length", f"{float(self.length):g} mm", "must be above 0")
        for key in ("start_plane", "end_plane"):
            plane = getattr(self, key)
            if plane is not None and sum(a * b for a, b in zip(plane.normal, self.direction, strict=True)) == 0:
                yield Trouble(f"{key}.normal", "the plane is parallel to the direction", "the rulings never meet it")


SurfaceSpec = (
    QuinticRuled | QuinticPlanar | QuinticCylinder | QuinticCone | QuinticStrip | Ruled | Flat | Cone | Cylinder
)
KINDS: tuple[type[Table], ...] = (
    QuinticRuled, QuinticPlanar, QuinticCylinder, QuinticCone, QuinticStrip, Ruled, Flat, Cone, Cylinder,
)  # fmt: skip


class MarkSpec(Table, frozen=True, kw_only=True):
    """Lines to be etched: `count` rulings at equal turning of the normal, or one per `max_angle` of turning."""

    kind: Literal["rulings"]
    name: str = "rulings"
    count: Annotated[int, Meta(ge=1, le=10_000)] | None = None
    max_angle: Angle | None = None

    def troubles(self) -> Iterator[Trouble]:
        """Yield neither or both of count and max_angle."""
        if (self.count is None) == (self.max_angle is None):
            yield Trouble("count", "exactly one of count and max_angle", "say how many rulings are marked")
        if self.max_angle is not None and self.max_angle <= 0:
            yield Trouble("max_angle", f"{float(self.max_angle):g} deg", "must be above 0")


class PartSpec(Table, frozen=True, kw_only=True):
    """One part: its surface and how often it is needed.

    face: which face of the sheet the surface describes; the middle one unrolls as it is.
    rotations: angles it may be turned by in the nest, or "free"; absent: what the nest allows.
    """

    name: Annotated[str, Meta(min_length=1, max_length=80)]
    surface: SurfaceSpec
    quantity: Annotated[int, Meta(ge=1, le=100_000)] = 1
    face: Literal["middle"] = "middle"
    rotations: Literal["free"] | tuple[Angle, ...] | None = None
    mark: tuple[MarkSpec, ...] = ()
