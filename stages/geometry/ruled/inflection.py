"""Rulings of a strap through inflections of its centre line, exact for polynomial and rational curves.

With r = A / w in homogeneous coordinates, exactly:

    r' = R / w^2,               R = w A' - w' A
    r' x r'' = N / w^3,         N = w A' x A'' - w' A x A'' + w'' A x A'
    det(r', r'', r''') = D / w^4,   D = w [A' A'' A'''] - w' [A A'' A'''] + w'' [A A' A'''] - w''' [A A' A'']

so that the ruling of the rectifying developable is  N / |N| + D |R|^2 R / (w |N|^3).  Where the curvature vanishes all
components of N do: with their greatest common factor f, N = f b, it is, up to its sign, which changes with that of f,

    g = b / |b| + (D / f^3) |R|^2 R / (w |b|^3).

b vanishes nowhere.  So the strap goes on through an inflection just where D / f^3, reduced, has no pole there; the
plane that it touches then turns on smoothly, while the principal normal may jump to its opposite.  An inflection of
which the decimals only come near is none: there the ruling turns very fast instead.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import comb

import numpy as np

from stages.geometry.arrays import Array, ArrayValue, Values, float_rows
from stages.geometry.curves.curves import Bezier, Curve, RationalBezier, homogeneous, raised
from stages.geometry.numeric.basis import bernstein_jet
from stages.geometry.numeric.bernstein import (
    Polynomial,
    Vector,
    add,
    cross,
    derivative,
    from_bernstein,
    inner,
    multiply,
)
from stages.geometry.numeric.factors import common_factor, divided_by, quotient, roots_inside
from stages.geometry.numeric.series import derivatives, power, product, scaled, taylor
from stages.geometry.numeric.series import inner as inner_series
from stages.geometry.ruled.envelope import Rows, image


@dataclass(frozen=True, slots=True)
class Bending:
    """R, w and b of a curve, its curvature's factor f, and D / f^3 in lowest terms."""

    R: Vector
    w: Polynomial
    b: Vector
    f: Polynomial
    top: Polynomial
    bottom: Polynomial

    @property
    def straight(self) -> bool:
        """Return whether the curve is a straight line: it bends nowhere."""
        return all(component.is_zero for component in self.b)

    @property
    def inflections(self) -> list[float]:
        """Return where in [0, 1] the curvature vanishes."""
        return roots(self.f)

    @property
    def poles(self) -> list[float]:
        """Return the inflections at which the ruling runs off along the curve."""
        return roots(self.bottom)


def bending(curve: Bezier | RationalBezier) -> Bending:
    """Return how a curve bends, exactly."""
    points = homogeneous(curve)
    A: Vector = tuple(from_bernstein([point[axis] for point in points]) for axis in range(3))
    w = from_bernstein([point[3] for point in points])
    if len({point[3] for point in points}) == 1:
        w = from_bernstein([points[0][3]])
    jets, weights = [A], [w]
    for _ in range(3):
        jets.append(tuple(derivative(component) for component in jets[-1]))
        weights.append(derivative(weights[-1]))
    R = _sum((weights[0], jets[1]), (_minus(weights[1]), jets[0]))
    N = _sum(
        (weights[0], cross(jets[1], jets[2])),
        (_minus(weights[1]), cross(jets[0], jets[2])),
        (weights[2], cross(jets[0], jets[1])),
    )
    f = _of_size_one(common_factor(N))
    b = N if all(component.is_zero for component in N) else _quotients(N, f)
    top, bottom = _reduced(_determinant(jets, weights), multiply(f, multiply(f, f)))
    return Bending(R, w, b, f, top, bottom)


def _sum(*terms: tuple[Polynomial, Vector]) -> Vector:
    """Return the sum of polynomial times vector."""
    rows = [tuple(multiply(factor, component) for component in vector) for factor, vector in terms]
    total = rows[0]
    for row in rows[1:]:
        total = tuple(add(a, b) for a, b in zip(total, row, strict=True))
    return total


def _minus(f: Polynomial) -> Polynomial:
    return Polynomial(tuple(-c for c in f.scaled), f.denominator)


def _determinant(jets: Sequence[Vector], weights: Sequence[Polynomial]) -> Polynomial:
    """Return D."""
    total = Polynomial((0,))
    for left_out, sign in zip(range(4), (1, -1, 1, -1), strict=True):
        a, b, c = (jet for order, jet in enumerate(jets) if order != left_out)
        total = add(total, multiply(weights[left_out], inner(a, cross(b, c))), sign=sign)
    return total


def _of_size_one(f: Polynomial) -> Polynomial:
    """Return the polynomial with its largest coefficient 1, and positive beside v = 0."""
    sign = 1 if next(c for c in f.scaled if c) > 0 else -1
    return Polynomial(tuple(sign * c for c in f.scaled), max(map(abs, f.scaled)))


def _quotients(vector: Vector, f: Polynomial) -> Vector:
    """Return vector / f; f is without a common divisor but for its denominator."""
    made = divided_by(vector, Polynomial(f.scaled))
    return tuple(Polynomial(tuple(f.denominator * c for c in q.scaled), q.denominator) for q in made)


def _reduced(top: Polynomial, bottom: Polynomial) -> tuple[Polynomial, Polynomial]:
    """Return a fraction in lowest terms."""
    shared = common_factor((top, bottom))
    return quotient(top, shared), quotient(bottom, shared)


def roots(f: Polynomial) -> list[float]:
    """Return the roots of a polynomial in [0, 1], its ends among them."""
    ends = [(v, v) for v in (Fraction(0), Fraction(1)) if f(v) == 0]
    return sorted(float(low + high) / 2.0 for low, high in [*ends, *roots_inside(f)])


@dataclass(frozen=True, slots=True, eq=False)
class Through(ArrayValue):
    """The ruling g of a strap through inflections, by rounded Bernstein coefficients of what it is made of.

    vectors: R and b side by side, shape (n, 6).  scalars: w, and top and bottom of D / f^3, shape (k, 3).
    low, high: the part of the parameter that [0, 1] stands for.
    """

    vectors: Array
    scalars: Array
    low: float = 0.0
    high: float = 1.0

    def jet(self, v: Values, order: int) -> Array:
        """Return value and derivatives up to `order`, shape (order + 1, n, 3)."""
        step = self.high - self.low
        at = (1.0 - v) * self.low + v * self.high
        both, numbers = (taylor(bernstein_jet(rows, at, order)) for rows in (self.vectors, self.scalars))
        R, b = both[..., :3], both[..., 3:]
        w, top, bottom = (numbers[..., k] for k in range(3))
        square = inner_series(b, b)
        rate = product(product(top, inner_series(R, R)), power(product(w, bottom), -1.0))
        g = scaled(power(square, -0.5), b) + scaled(product(rate, power(square, -1.5)), R)
        jets: Array = derivatives(g) * (step ** np.arange(order + 1.0))[:, None, None]
        return jets

    def image(self, matrix: Rows, shift: Sequence[Fraction]) -> Curve:
        """Return matrix @ curve + shift."""
        return image(self, matrix, shift)

    def part(self, low: Fraction, high: Fraction) -> "Through":
        """Return the part over [low, high]."""
        at = [self.low + float(share) * (self.high - self.low) for share in (low, high)]
        return Through(self.vectors, self.scalars, *at)


def through(made: Bending) -> Through:
    """Return the ruling of a strap over a curve without poles."""
    scale = max(map(abs, _coefficients(made.bottom)))
    fraction = [[c / scale for c in _coefficients(f)] for f in (made.top, made.bottom)]
    scalars = [_coefficients(made.w), *fraction]
    return Through(_table([_coefficients(f) for f in (*made.R, *made.b)]), _table(scalars))


def _coefficients(f: Polynomial) -> list[Fraction]:
    """Return the Bernstein coefficients."""
    n = f.degree
    return [Fraction(c, comb(n, i) * f.denominator) for i, c in enumerate(f.scaled)]


def _table(columns: Sequence[Sequence[Fraction]]) -> Array:
    """Return Bernstein coefficients in one degree, in float64, as columns."""
    degree = max(len(column) for column in columns) - 1
    return float_rows(_in_degree(column, degree) for column in columns).T


def _in_degree(coefficients: Sequence[Fraction], degree: int) -> list[Fraction]:
    rows = [(c,) for c in coefficients]
    while len(rows) <= degree:
        rows = [(c,) for (c,) in raised(rows)]
    return [c for (c,) in rows]
