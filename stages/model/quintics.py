"""The paper's patches as a job file describes them: end data and shape parameters of quintic directrices.

P, T, N, k are end data of a directrix, alpha and beta its shape parameters, 0 and 1 its ends, `_hat` the second one.
`alpha = "auto"` in place of the shape parameters of a directrix asks for those of least strain energy.
"""

from collections.abc import Iterator
from typing import Literal

from msgspec import field

from stages.model.curves import Table, Trouble, not_positive
from stages.model.scalars import Curvature, Direction, Length, Number, Point, is_zero

SHAPE_KEYS = ("alpha0", "alpha1", "beta0", "beta1")
SHAPE_KEYS_HAT = tuple(f"{key}_hat" for key in SHAPE_KEYS)
CYLINDER_KEYS = ("alpha0", "alpha1", "s0", "s1")
Auto = Literal["auto"]


def shape_troubles(spec: Table, auto: str, keys: tuple[str, ...]) -> Iterator[Trouble]:
    """Yield shape parameters that are missing, or given beside "auto"."""
    given = [key for key in keys if getattr(spec, key) is not None]
    if getattr(spec, auto) is None:
        for key in keys:
            if key not in given:
                yield Trouble(key, "missing", f'give {", ".join(keys)}, or {auto} = "auto"')
    elif given:
        yield _twice(auto, given[0])


def _twice(auto: str, key: str) -> Trouble:
    return Trouble(key, f'given beside {auto} = "auto"', "leave one of them out")


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
    """The paper's (2.1) and (2.2): two quintic directrices from their end data, values as given.

    alpha, alpha_hat: "auto" instead of the shape parameters of a directrix: those of least strain energy.
    directrix_geodesic: the surface on which the first directrix is a geodesic, `half_width` to either side, instead of
        a second directrix.
    """

    alpha: Auto | None = None
    alpha0: Length | None = None
    alpha1: Length | None = None
    beta0: Length | None = None
    beta1: Length | None = None
    q0: Point | None = None
    q1: Point | None = None
    t0_hat: Direction | None = None
    t1_hat: Direction | None = None
    n0_hat: Direction | None = None
    n1_hat: Direction | None = None
    k0_hat: Curvature | None = None
    k1_hat: Curvature | None = None
    alpha_hat: Auto | None = None
    alpha0_hat: Length | None = None
    alpha1_hat: Length | None = None
    beta0_hat: Length | None = None
    beta1_hat: Length | None = None
    directrix_geodesic: bool = False
    half_width: Length | None = None

    def troubles(self) -> Iterator[Trouble]:
        """Yield zero tangents, zero normals, coincident ends and what is missing or given twice."""
        yield from zero_tangents(self, "t0", "t1")
        yield from zero_normals(self, "0", "1")
        yield from same_points(self, ("p0", "p1"))
        yield from shape_troubles(self, "alpha", SHAPE_KEYS)
        if self.directrix_geodesic:
            yield from self._geodesic_troubles()
            return
        missing = [key for key in SECOND_ENDS if getattr(self, key) is None]
        for key in missing:
            yield Trouble(key, "missing", "give the second directrix, or directrix_geodesic = true and half_width")
        if self.half_width is not None:
            yield Trouble("half_width", "not used without directrix_geodesic = true", "leave it out")
        yield from shape_troubles(self, "alpha_hat", SHAPE_KEYS_HAT)
        if not missing:
            yield from zero_tangents(self, "t0_hat", "t1_hat")
            yield from zero_normals(self, "0_hat", "1_hat")
            yield from same_points(self, ("q0", "q1"))

    def _geodesic_troubles(self) -> Iterator[Trouble]:
        """Yield a width that is missing or makes no band, and data of the second directrix."""
        for key in (*SECOND_ENDS, "alpha_hat", *SHAPE_KEYS_HAT):
            if getattr(self, key) is not None:
                yield Trouble(key, "given beside directrix_geodesic = true", "the edges follow from half_width")
        if self.half_width is None:
            yield Trouble("half_width", "missing", "how far the surface reaches to either side of the directrix")
        yield from not_positive(self, "half_width")


SECOND_ENDS = ("q0", "q1", "t0_hat", "t1_hat", "n0_hat", "n1_hat", "k0_hat", "k1_hat")


class QuinticPlanar(Table, frozen=True, kw_only=True, tag_field="kind", tag="quintic-planar"):
    """Theorem 2.1: both directrices leave and arrive along the end rulings, all curvatures 0.  The patch is planar.

    alpha, alpha_hat: as in `quintic-ruled`.
    """

    p0: Point
    p1: Point
    q0: Point
    q1: Point
    alpha: Auto | None = None
    alpha0: Length | None = None
    alpha1: Length | None = None
    beta0: Length | None = None
    beta1: Length | None = None
    alpha_hat: Auto | None = None
    alpha0_hat: Length | None = None
    alpha1_hat: Length | None = None
    beta0_hat: Length | None = None
    beta1_hat: Length | None = None

    def troubles(self) -> Iterator[Trouble]:
        """Yield coincident points (the end rulings are the tangents) and shape parameters missing or given twice."""
        yield from same_points(self, ("p0", "p1"), ("q0", "q1"), ("p0", "q0"), ("p1", "q1"))
        yield from shape_troubles(self, "alpha", SHAPE_KEYS)
        yield from shape_troubles(self, "alpha_hat", SHAPE_KEYS_HAT)


class QuinticCylinder(DirectrixEnds, frozen=True, kw_only=True, tag_field="kind", tag="quintic-cylinder"):
    """Theorem 2.2: one quintic directrix, parallel rulings; beta = s alpha, Q1 - P1 = g (Q0 - P0).

    alpha: "auto" instead of alpha0, alpha1, s0, s1: those of least strain energy, s of either sign.
    """

    q0: Point
    alpha: Auto | None = None
    alpha0: Length | None = None
    alpha1: Length | None = None
    s0: Number | None = None
    s1: Number | None = None
    g: Number

    def troubles(self) -> Iterator[Trouble]:
        """Yield what the theorem excludes: alpha, s and g are positive."""
        yield from zero_tangents(self, "t0", "t1")
        yield from zero_normals(self, "0", "1")
        yield from same_points(self, ("p0", "p1"), ("p0", "q0"))
        yield from not_positive(self, *CYLINDER_KEYS, "g")
        yield from shape_troubles(self, "alpha", CYLINDER_KEYS)


class QuinticCone(DirectrixEnds, frozen=True, kw_only=True, tag_field="kind", tag="quintic-cone"):
    """Theorem 2.3: the cone over a quintic directrix; shape parameters by the minimax of |r'|, or given.

    alpha: "auto" for those of least strain energy.
    guess: Algorithm 2's initial guess alpha0, alpha1, beta0, beta1; found from the chord if absent.
    fraction: which part of the way to the apex is kept.
    """

    apex: Point
    alpha: Auto | None = None
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
        if self.alpha is not None and given:
            yield _twice("alpha", given[0])
        if self.guess is not None and self.alpha is not None:
            yield Trouble("guess", 'a guess beside alpha = "auto"', "only the minimax starts from a guess")
        if self.guess is not None and given:
            yield Trouble("guess", "a guess beside given shape parameters", "leave one of them out")
        if self.guess is not None and any(value <= 0 for value in self.guess):
            yield Trouble("guess", "a value that is not above 0", "alpha and beta are positive")


def bad_fraction(fraction: tuple[Number, Number]) -> Iterator[Trouble]:
    """Yield a range of fractions that is not inside [0, 1] or not rising."""
    if not 0 <= fraction[0] < fraction[1] <= 1:
        yield Trouble("fraction", f"[{float(fraction[0]):g}, {float(fraction[1]):g}]", "0 <= a < b <= 1")
