"""The paper's patches as a job file describes them: end data and shape parameters of quintic directrices.

P, T, N, k are end data of a directrix, alpha and beta its shape parameters, 0 and 1 its ends, `_hat` the second one.
"""

from collections.abc import Iterator
from typing import Annotated

from msgspec import Meta, field

from stages.model.curves import Table, Trouble, not_positive
from stages.model.scalars import Curvature, Direction, Length, Number, Point, is_zero

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


class DirectrixEnds(Table, frozen=True, kw_only=True):
    """Both ends of a directrix (2.2): points, unit tangents, unit normals, curvatures."""

    p0: Point
    p1: Point
    t0: Direction
    t1: Direction
    n0: Direction
    n1: Direction
    k0: Curvature
    k1: Curvature


class QuinticRuled(DirectrixEnds, frozen=True, kw_only=True, tag_field="kind", tag="quintic-ruled"):
    """The paper's (2.1) and (2.2): two quintic directrices from their end data, values as given."""

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


class QuinticCylinder(DirectrixEnds, frozen=True, kw_only=True, tag_field="kind", tag="quintic-cylinder"):
    """Theorem 2.2: one quintic directrix, parallel rulings; beta = s alpha, Q1 - P1 = g (Q0 - P0)."""

    q0: Point
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


class QuinticCone(DirectrixEnds, frozen=True, kw_only=True, tag_field="kind", tag="quintic-cone"):
    """Theorem 2.3: the cone over a quintic directrix; shape parameters by the minimax of |r'|, or given.

    guess: Algorithm 2's initial guess alpha0, alpha1, beta0, beta1; found from the chord if absent.
    fraction: which part of the way to the apex is kept.
    """

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
