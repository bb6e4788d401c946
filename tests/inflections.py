"""Centre lines of straps with inflections by design:  r' = a(s(v)),  a a polynomial vector and s a polynomial, exact.

The curvature vanishes where s' does.  The rulings are those of the curve with r' = a(s) at s(v), in closed form:

    T = a / |a|,    B = a x a' / |a x a'|,    lambda = det(a, a', a'') |a|^3 / |a x a'|^3.
"""

from collections.abc import Sequence
from fractions import Fraction
from math import comb

from mpmath import mpf

from tests import oracles
from tests.oracles import Vec

Coefficients = Sequence[Fraction | int]
"""Of a polynomial, the constant first."""
Along = Sequence[Coefficients]
"""The three components of a."""

CIRCLE: Along = ([1], [0, 2], [0, 0, 2])
"""|a| = 1 + 2 s^2, on a circle of the sphere: lambda = 1, the strap is a cylinder along (1, 0, 1)."""
FREE: Along = ([1, 0, Fraction(1, 5)], [0, 1], [0, 0, Fraction(1, 2), Fraction(1, 3)])


def times(f: Coefficients, g: Coefficients) -> list[Fraction]:
    product = [Fraction(0)] * (len(f) + len(g) - 1)
    for i, x in enumerate(f):
        for j, y in enumerate(g):
            product[i + j] += Fraction(x) * Fraction(y)
    return product


def composed(f: Coefficients, s: Coefficients) -> list[Fraction]:
    """Return f(s(v)) by Horner's rule."""
    total = [Fraction(f[-1])]
    for c in f[-2::-1]:
        total = times(total, s)
        total[0] += Fraction(c)
    return total


def rising(at: Sequence[Fraction | str]) -> list[Fraction]:
    """Return the s with s(0) = 0 and s' = the product of (v - place) over these places, repeated ones repeated."""
    slope = [Fraction(1)]
    for place in at:
        slope = times(slope, [-Fraction(place), Fraction(1)])
    return [Fraction(0)] + [c / (k + 1) for k, c in enumerate(slope)]


def control_points(a: Along, s: Coefficients, size: Fraction | int = 1) -> list[list[str]]:
    """Return the control points of the curve from the origin with r' = size a(s(v)), as a job file may hold them."""
    components = [[Fraction(0), *(c / (k + 1) for k, c in enumerate(composed(f, s)))] for f in a]
    n = max(map(len, components)) - 1
    return [
        [str(size * sum((Fraction(comb(i, k), comb(n, k)) * c for k, c in enumerate(f[: i + 1])), Fraction(0)))
         for f in components]
        for i in range(n + 1)
    ]  # fmt: skip


def value(f: Coefficients, x: mpf) -> mpf:
    total = mpf(0)
    for c in reversed(f):
        total = total * x + (mpf(c.numerator) / c.denominator if c else 0)
    return total


def _slope(f: Coefficients) -> list[Fraction]:
    return [k * Fraction(c) for k, c in enumerate(f)][1:] or [Fraction(0)]


def frame(a: Along, s: Coefficients, v: mpf) -> tuple[Vec, Vec, mpf]:
    """Return T, B and lambda to 40 digits."""
    at = value(s, mpf(v))
    first, second = [_slope(f) for f in a], [_slope(_slope(f)) for f in a]
    p, q, r = (tuple(value(f, at) for f in rows) for rows in (a, first, second))
    b = oracles.cross(p, q)
    lean = oracles.dot(b, r) * oracles.norm(p) ** 3 / oracles.norm(b) ** 3
    T, B = (tuple(x / oracles.norm(vector) for x in vector) for vector in (p, b))
    return T, B, lean


def length(a: Along, s: Coefficients) -> mpf:
    """Return the length of the curve, to 40 digits."""
    return oracles.Antiderivative(lambda v: oracles.norm(tuple(value(f, value(s, v)) for f in a)))(1)
