"""The exact certificate: proofs of developability, of bounds on warp and curvature, and of regularity.

For polynomial directrices delta = p . (c0' x c1') and the end normals n0 = p x c0', n1 = p x c1' are polynomials with
rational coefficients (every double is rational, and decimals are kept as typed).  Common factors v^a (1 - v)^b, where a
normal vanishes at an end, are divided out first.  Since n0 x n1 = +-p delta,

    tan(warp) <= T on [0, 1]   iff   n0.n1 > 0   and   T^2 (n0.n1)^2 - |p|^2 delta^2 >= 0   on [0, 1],

and with warp <= W,  |K| <= delta^2 / (min(|n0|, |n1|) cos(W / 2))^4.  A polynomial is proved positive by its Bernstein
coefficients, halving the interval where they do not decide [1]_.  T starts a hair above the sampled value and is
raised until the proof succeeds, so the bound is nearly always within 1e-10 of the truth.  delta == 0 proves K == 0.

Not for rational or trigonometric directrices; interior zeros of a normal (a cusp) are not decided.

.. [1] J. Garloff, "Convergent bounds for the range of multivariate polynomials", LNCS 212 (1986), 37-56.
"""

from dataclasses import dataclass
from fractions import Fraction
from math import atan, cos, inf, pi

from stages.geometry import bernstein
from stages.geometry.bernstein import Polynomial, cross, derivative, divide_ends, end_zeros, inner, multiply, subtract
from stages.geometry.curves import Bezier
from stages.geometry.ruled import RuledPatch

RAISES = (1e-10, 1e-6, 1e-3, 0.5, 2.0, 9.0, 99.0)
"""The bound tried is (1 + this) times the sampled value; beyond 100 times the proof is given up."""
ELSEWHERE = tuple(Fraction(k, 16) for k in range(1, 16))
"""Where a bound starts from if it is 0 at the place given: a quintic's delta, of degree 13, is not 0 at all 15."""
SPLITS = 4000
"""Halvings that one proof may take: 2**-40 wide at some places, or 1/4000 everywhere."""
NARROWEST = 2.0**-40
"""Below this width a place stays open: a zero without a change of sign, which no halving decides."""


@dataclass(frozen=True, slots=True)
class Certified:
    """What is proved of one patch.

    developable: K == 0 in exact arithmetic.
    warp_rad, curvature: upper bounds over the whole patch (1/mm2); infinite where none was proved.
    regular: the normal vanishes nowhere, edges included.
    positive: n0.n1 > 0 inside (the edge of regression stays out); False if n0.n1 < 0 somewhere (or the patch has no
        normal at all); None if neither was proved, as where the edge of regression touches an edge inside.
    where: a v at which n0.n1 < 0, if there is one.
    """

    developable: bool
    warp_rad: float
    curvature: float
    regular: bool
    positive: bool | None
    where: float | None = None


@dataclass(frozen=True, slots=True)
class Ingredients:
    """The polynomials of a patch, common factors at the ends divided out.

    dot: n0.n1 (or |n|^2 of the one that is not identically zero).  turn2: |p|^2 delta^2 in the same scale.
    n0n0, n1n1, delta: not divided.  vanishing: whether a normal is zero at an end or identically.
    """

    dot: Polynomial
    turn2: Polynomial
    n0n0: Polynomial
    n1n1: Polynomial
    delta: Polynomial
    vanishing: bool


def ingredients(patch: RuledPatch) -> Ingredients:
    """Return the polynomials of a patch with polynomial directrices."""
    c0, c1 = (_components(curve) for curve in (patch.c0, patch.c1))
    p, d0, d1 = subtract(c1, c0), _slopes(c0), _slopes(c1)
    n0, n1 = cross(p, d0), cross(p, d1)
    delta = inner(p, cross(d0, d1))
    zeros0, zeros1, zeros_p, zeros_d = end_zeros(*n0), end_zeros(*n1), end_zeros(*p), end_zeros(delta)
    r0 = tuple(divide_ends(f, zeros0) for f in n0)
    r1 = tuple(divide_ends(f, zeros1) for f in n1)
    gone0, gone1 = (all(f.is_zero for f in n) for n in (n0, n1))
    left, right = (
        zeros_p[side] + zeros_d[side] - zeros0[side] - zeros1[side] if not delta.is_zero else 0 for side in (0, 1)
    )
    core = divide_ends(delta, zeros_d)
    core = Polynomial(((0,) * left) + core.scaled + ((0,) * right), core.denominator)
    rp = tuple(divide_ends(f, zeros_p) for f in p)
    return Ingredients(
        dot=inner(r1, r1) if gone0 else inner(r0, r0) if gone1 else inner(r0, r1),
        turn2=multiply(inner(rp, rp), multiply(core, core)),
        n0n0=inner(n0, n0),
        n1n1=inner(n1, n1),
        delta=delta,
        vanishing=gone0 or gone1 or any((*zeros0, *zeros1)),
    )


def _components(curve: object) -> bernstein.Vector:
    if not isinstance(curve, Bezier):
        raise TypeError("the exact certificate needs polynomial directrices")
    return bernstein.vector_from_points(curve.exact)


def _slopes(c: bernstein.Vector) -> bernstein.Vector:
    return tuple(derivative(f) for f in c)


def certify(patch: RuledPatch, at: float) -> Certified:
    """Return what is proved of the patch; `at` is the v of the largest sampled warp, where the bounds start from."""
    made = ingredients(patch)
    if made.dot.is_zero:
        return Certified(made.delta.is_zero, pi, inf, regular=False, positive=False, where=0.5)
    positive, where = proved_positive(made.dot)
    if not positive:
        return Certified(made.delta.is_zero, pi, inf, False, positive, where if positive is False else None)
    if made.delta.is_zero:
        return Certified(True, 0.0, 0.0, regular=not made.vanishing, positive=True)
    warp = _warp_bound(made, Fraction(at))
    curvature = _curvature_bound(made, warp, Fraction(at))
    return Certified(False, warp, curvature, regular=not made.vanishing, positive=True)


def _warp_bound(made: Ingredients, at: Fraction) -> float:
    """Return a proved upper bound of the warp, rad."""
    dot2 = multiply(made.dot, made.dot)
    sampled = made.turn2(at) / dot2(at)
    bound2 = _raised(sampled, dot2, made.turn2)
    return pi if bound2 is None else _up(atan(float(bound2) ** 0.5))


def _curvature_bound(made: Ingredients, warp: float, at: Fraction) -> float:
    """Return a proved upper bound of |K|, 1/mm2; infinite where a normal vanishes at an end while delta does not."""
    if made.vanishing or warp >= pi:
        return inf
    delta2 = multiply(made.delta, made.delta)
    bounds = []
    for square in (made.n0n0, made.n1n1):
        fourth = multiply(square, square)
        bound = _raised(delta2(at) / fourth(at), fourth, delta2)
        if bound is None:
            return inf
        bounds.append(float(bound))
    return _up(max(bounds) / cos(warp / 2.0) ** 4)


def _raised(start: Fraction, below: Polynomial, above: Polynomial) -> Fraction | None:
    """Return t, a little above `start`, such that t below - above >= 0 on [0, 1] is proved; None if no try succeeds."""
    floor = start or max(above(v) / below(v) for v in ELSEWHERE)
    for raised in RAISES:
        t = _rounded(floor * (1 + Fraction(raised)) ** 2)
        difference = bernstein.add(multiply(Polynomial((t.numerator,), t.denominator), below), above, sign=-1)
        if proved_positive(difference)[0]:
            return t
    return None


def _rounded(t: Fraction) -> Fraction:
    """Return t rounded to a double: short numbers keep the proof quick, and t is free."""
    return Fraction(float(t))


def _up(value: float) -> float:
    """Return a double surely not below the exact result of the few roundings that made `value`."""
    return value * (1.0 + ROUNDINGS)


ROUNDINGS = 16 * 2.0**-53
"""Twice the worst of the eight roundings between a proved rational bound and the number in the report."""


def proved_positive(f: Polynomial) -> tuple[bool | None, float | None]:
    """Return True if f > 0 on [0, 1] is proved, False with a v where f < 0, None with a v where it stays open."""
    pending = [(bernstein.whole(f), 0.0, 1.0)]
    undecided: float | None = None
    for _ in range(SPLITS):
        if not pending:
            return (True, None) if undecided is None else (None, undecided)
        piece, low, high = pending.pop()
        if min(piece.b) > 0:
            continue
        for value, v in ((piece.b[0], low), (piece.b[-1], high)):
            if value < 0:
                return False, v
        if high - low <= NARROWEST:
            undecided = low
            continue
        middle = (low + high) / 2.0
        left, right = bernstein.halves(piece)
        pending += [(right, middle, high), (left, low, middle)]
    return None, pending[-1][1] if pending else 0.5
