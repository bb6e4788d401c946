"""The same patch written otherwise: what no length, area or pattern may depend on."""

from collections.abc import Callable, Sequence
from fractions import Fraction
from math import comb
from typing import TypeVar

from stages.geometry.curves.curves import Bezier, bezier, elevated
from stages.geometry.ruled.ruled import RuledPatch, between, part

Number = TypeVar("Number")
Polynomial = Sequence[Fraction]
"""Coefficients of 1, v, v^2, ..."""

UNEVEN = (Fraction(0), Fraction(1, 10), Fraction(0), Fraction(9, 10))
"""(v + 9 v^3) / 10: the speed grows 28-fold along the edge."""
AT_REST = (Fraction(0), Fraction(0), Fraction(3), Fraction(-2))
"""3 v^2 - 2 v^3: no speed at both ends."""


def turned_around(patch: RuledPatch) -> RuledPatch:
    return _each(patch, lambda curve: bezier(curve.exact[::-1]))


def exchanged(patch: RuledPatch) -> RuledPatch:
    return between(patch.c1, patch.c0)


def raised(patch: RuledPatch) -> RuledPatch:
    return _each(patch, lambda curve: bezier(elevated(curve.exact, 8)))


def in_pieces(patch: RuledPatch, count: int) -> tuple[RuledPatch, ...]:
    return tuple(part(patch, Fraction(i, count), Fraction(i + 1, count)) for i in range(count))


def reparametrised(patch: RuledPatch, inner: Polynomial) -> RuledPatch:
    """Return the patch over the parameter that a polynomial gives, exactly."""
    return _each(patch, lambda curve: _composed(curve, inner))


def value(inner: Polynomial, v: Number) -> Number:
    """Return the polynomial's value, of whatever sort of number v is."""
    total = 0 * v
    for coefficient in reversed(inner):
        total = total * v + coefficient.numerator * v**0 / coefficient.denominator
    return total


def _each(patch: RuledPatch, change: Callable[[Bezier], Bezier]) -> RuledPatch:
    assert isinstance(patch.c0, Bezier)
    assert isinstance(patch.c1, Bezier)
    return between(change(patch.c0), change(patch.c1))


def _composed(curve: Bezier, inner: Polynomial) -> Bezier:
    degree = (len(curve.exact) - 1) * (len(inner) - 1)
    rows = [_in_bernstein(_substituted(_powers(list(axis)), inner), degree) for axis in zip(*curve.exact, strict=True)]
    return bezier([list(point) for point in zip(*rows, strict=True)])


def _powers(b: list[Fraction]) -> list[Fraction]:
    n = len(b) - 1
    return [comb(n, k) * sum((-1) ** (k - i) * comb(k, i) * b[i] for i in range(k + 1)) for k in range(n + 1)]


def _substituted(outer: list[Fraction], inner: Polynomial) -> list[Fraction]:
    total = [Fraction(0)]
    for coefficient in reversed(outer):
        product = [Fraction(0)] * (len(total) + len(inner) - 1)
        for i, a in enumerate(total):
            for j, b in enumerate(inner):
                product[i + j] += a * b
        product[0] += coefficient
        total = product
    return total


def _in_bernstein(powers: list[Fraction], n: int) -> list[Fraction]:
    a = (powers + [Fraction(0)] * (n + 1))[: n + 1]
    return [sum((Fraction(comb(j, k), comb(n, k)) * a[k] for k in range(j + 1)), Fraction(0)) for j in range(n + 1)]
