"""The exact certificate: proofs of developability, of bounds on warp and curvature, and of regularity.

For polynomial and rational directrices everything follows from polynomials with whole coefficients (`plucker`; every
double is rational, and decimals are kept as typed).  Where a normal vanishes its factor is divided out first, so that
what is left, r0 and r1, vanishes nowhere; the sign of the factors decides what happens at such a ruling (`singular`).
With D = Delta gcd(P) / (gcd(M0) gcd(M1)) and P = gcd(P) q,

    tan(warp) <= T on [0, 1]   iff   r0.r1 > 0   and   T^2 (r0.r1)^2 - |q|^2 D^2 >= 0   on [0, 1],

and  sqrt|K| <= k along edge i  iff  k |Mi|^2 -+ Delta wi^2 >= 0;  with warp <= W the normal between the edges is at
least cos(W / 2) times the shorter one, so |K| <= (k / cos(W / 2)^2)^2 over the patch; where that is too much, the
normals between the edges are bounded too.  A polynomial is proved positive by its Bernstein coefficients, halving the
interval where they do not decide [1]_.  T and k start a hair above the largest value found in floats, and climb from
wherever a proof fails, so that the bounds are nearly always within 1e-10 of the truth, that of K along the edges.
Delta == 0 proves K == 0; then r0 and r1 are the same up to a constant factor.

A warp of exactly 90 deg, reached and not exceeded, is told by the signs between all roots.  Not for trigonometric
directrices.

.. [1] J. Garloff, "Convergent bounds for the range of multivariate polynomials", LNCS 212 (1986), 37-56.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import atan, cos, inf, nextafter, pi

from stages.geometry.numeric.bernstein import Polynomial, add, inner, multiply
from stages.geometry.numeric.factors import ONE, Interval, common_factor, quotient, roots_inside
from stages.geometry.ruled.ruled import RuledPatch
from stages.verify.plucker import Factored, Ingredients, Tangent, ingredients
from stages.verify.positive import least_multiple, proved_positive, root_above
from stages.verify.singular import Singular, regular_at_ends, singular_rulings


@dataclass(frozen=True, slots=True)
class Certified:
    """What is proved of one patch.

    developable: K == 0 in exact arithmetic.
    warp_rad, curvature: upper bounds over the whole patch (1/mm2).  An infinite curvature is proved not to be bounded;
        None where nothing was proved.
    regular: the surface has a normal everywhere, edges included.
    positive: n0.n1 >= 0 (the edge of regression stays out); False if n0.n1 < 0 somewhere, or the patch has no normal.
    where: a v of the largest warp found, or at which n0.n1 < 0.
    singular: the rulings inside at which a normal vanishes.
    curvature_where: a v where |K| nearly reaches its bound, or exceeds all bounds.
    """

    developable: bool
    warp_rad: float | None
    curvature: float | None
    regular: bool
    positive: bool
    where: float | None = None
    singular: tuple[Singular, ...] = ()
    curvature_where: float | None = None


def certify(patch: RuledPatch) -> Certified:
    """Return what is proved of a patch whose directrices are exact."""
    made = ingredients(patch)
    flat = made.delta.is_zero
    n0, n1 = made.normals
    if n0.is_zero and n1.is_zero:
        return Certified(flat, pi, None, regular=False, positive=False, where=0.5)
    singular = singular_rulings(made)
    dot = _dot(made)
    positive, where = _sign(made, dot, singular)
    if not positive:
        return Certified(flat, pi, None, False, False, where, singular)
    apex = n0.is_zero or n1.is_zero
    regular = not apex and regular_at_ends(made) and all(ruling.sort == "stop" for ruling in singular)
    if flat:
        return Certified(True, 0.0, 0.0, regular, True, None, singular)
    warp, place = _warp_bound(made, dot) if where is None else (_up(pi / 2.0), where)
    curvature, sharpest = _curvature_bound(made, warp)
    return Certified(False, warp, curvature, regular, True, place, singular, sharpest)


def _dot(made: Ingredients) -> Polynomial:
    """Return r0.r1, or |r|^2 of the normal that is not identically zero."""
    n0, n1 = made.normals
    return inner((n1 if n0.is_zero else n0).rest, (n0 if n1.is_zero else n1).rest)


def _sign(made: Ingredients, dot: Polynomial, singular: tuple[Singular, ...]) -> tuple[bool, float | None]:
    """Return whether n0.n1 >= 0: if not, with a v inside where it is below; if so, with a v where r0.r1 = 0, if any."""
    n0, n1 = made.normals
    factors = ONE if n0.is_zero or n1.is_zero else multiply(n0.factor, n1.factor)
    full = multiply(factors, dot)
    middles = _between([ruling.root for ruling in singular])
    below = next((middle for middle in middles if full(middle) < 0), None)
    if below is not None:
        return False, float(below)
    if made.delta.is_zero:
        return True, None  # r0 and r1 are parallel and vanish nowhere: one place decides
    if len({factors(middle) > 0 for middle in middles}) == 1:
        state, where = proved_positive(dot if factors(middles[0]) > 0 else multiply(dot, MINUS_ONE))
        if state is True:
            return True, None
        if state is False and where is not None:
            return False, _inside(full, where)
    return _sign_by_roots(dot, full)


def _sign_by_roots(dot: Polynomial, full: Polynomial) -> tuple[bool, float | None]:
    """Decide by the signs between all roots, where n0.n1 comes down to 0 and no bound can decide."""
    below = next((middle for middle in _between(roots_inside(full)) if full(middle) < 0), None)
    return (False, float(below)) if below is not None else (True, _root(dot))


def _between(roots: Sequence[Interval]) -> list[Fraction]:
    """Return a place between each two neighbours among 0, the roots inside, and 1."""
    bounds = [Fraction(0), *(x for root in roots for x in root), Fraction(1)]
    return [(low + high) / 2 for low, high in zip(bounds[::2], bounds[1::2], strict=True)]


def _inside(full: Polynomial, v: float) -> float:
    """Return v, or from an end, where a factor may vanish, a place inside at which the sign is that near the end."""
    if 0.0 < v < 1.0:
        return v
    steps = (2.0**-k for k in range(1, 53))
    return next((x for x in (abs(v - step) for step in steps) if full(Fraction(x)) < 0), v)


MINUS_ONE = Polynomial((-1,))


def _warp_bound(made: Ingredients, dot: Polynomial) -> tuple[float | None, float]:
    """Return a proved upper bound of the warp, rad, and the v of the largest warp found."""
    n0, n1 = made.normals
    turn = quotient(multiply(made.delta, made.ruling.factor), multiply(n0.factor, n1.factor))
    top = multiply(inner(made.ruling.rest, made.ruling.rest), multiply(turn, turn))
    square, place = least_multiple((top,), multiply(dot, dot))
    return None if square is None else _up(atan(float(root_above(square)))), place


def _curvature_bound(made: Ingredients, warp: float | None) -> tuple[float | None, float | None]:
    """Return a proved upper bound of |K|, 1/mm2, infinite where it is proved that there is none, and its place."""
    if warp is None:
        return None, None
    edges = [_edge(made.delta, normal, tangent) for normal, tangent in zip(made.normals, made.tangents, strict=True)]
    pole = next((root for _, below in edges if (root := _root(below)) is not None), None)
    if pole is not None:
        return inf, pole
    bound, place = _largest(edges)
    if bound is None:
        return None, place
    spread = 1.0 / cos(warp / 2.0) ** 2
    if spread > WIDE and all(len(normal.factor.scaled) == 1 for normal in made.normals):
        inner_bound, _ = _largest(_between_edges(made))
        spread = min(spread, max(1.0, float(inner_bound / bound))) if inner_bound is not None else spread
    return _up((float(bound) * spread) ** 2), place


WIDE = 1.02
"""From here on, 16 deg of warp, the normals between the edges are worth a proof of their own."""


def _largest(fractions: Sequence[tuple[Polynomial, Polynomial]]) -> tuple[Fraction | None, float]:
    """Return a proved bound of all |f / g| on [0, 1] and the place of the largest; None where one was not proved."""
    found = [least_multiple((top, multiply(top, MINUS_ONE)), below) for top, below in fractions]
    proved = [(bound, place) for bound, place in found if bound is not None and bound <= BEYOND]
    return max(proved) if len(proved) == len(found) else (None, found[0][1])


BEYOND = 10**150
"""The square of a larger number is no double: a patch of 1e-150 mm."""


def _edge(delta: Polynomial, normal: Factored, tangent: Tangent) -> tuple[Polynomial, Polynomial]:
    """Return the fraction sqrt|K| = |f / g| along an edge, in lowest terms, g >= 0."""
    square = multiply(normal.factor, normal.factor)
    shared = common_factor((delta, square))
    rest, top = quotient(square, shared), quotient(delta, shared)
    # where `rest` has a root its sign is not used; elsewhere it has one sign
    sign = Polynomial((1 if rest(HALF) >= 0 else -1,))
    below = multiply(multiply(rest, sign), inner(normal.rest, normal.rest))
    return multiply(top, multiply(tangent.w, tangent.w)), below


def _between_edges(made: Ingredients) -> list[tuple[Polynomial, Polynomial]]:
    """Return fractions whose largest |value| bounds sqrt|K| between the edges.

    |n(u)|^2 has Bernstein coefficients |n0|^2, n0.n1, |n1|^2 in u; halved at u = 1/2, the least of each half is its own
    middle one, (|n0|^2 + n0.n1) / 2 or (|n1|^2 + n0.n1) / 2, or at an edge.
    """
    (r0, r1), (w0, w1) = (normal.rest for normal in made.normals), (tangent.w for tangent in made.tangents)
    sizes = multiply(inner(r0, r0), multiply(w1, w1)), multiply(inner(r1, r1), multiply(w0, w0))
    weight = multiply(w0, w1)
    top = multiply(multiply(made.delta, multiply(weight, weight)), Polynomial((2,)))
    across = multiply(inner(r0, r1), weight)
    sign = Polynomial((1 if across(HALF) > 0 else -1,))
    return [(top, add(size, multiply(across, sign))) for size in sizes]


HALF = Fraction(1, 2)


def _root(f: Polynomial) -> float | None:
    """Return a root of f in [0, 1], if there is one."""
    if not (f.scaled[0] and f.scaled[-1]):
        return 0.0 if not f.scaled[0] else 1.0
    inside = roots_inside(f)
    return float(inside[0][0]) if inside else None


def _up(value: float) -> float:
    """Return a double surely not below the exact result of the few roundings that made `value`."""
    return nextafter(value * (1.0 + ROUNDINGS), inf)


ROUNDINGS = 16 * 2.0**-53
"""Twice the worst of the eight roundings between a proved rational bound and the number in the report."""
