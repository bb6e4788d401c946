"""Polynomials on [0, 1] in exact integer arithmetic, for bounds that are proofs.

A polynomial of degree n is f(v) = (1 / denominator) sum_i c_i v^i (1 - v)^(n - i) with whole c_i: the Bernstein
coefficients are c_i / (binomial(n, i) denominator).  In this scaled form a product is a plain convolution, a common
factor v^a (1 - v)^b shows as leading and trailing zeros, and nothing is ever rounded.  The convex hull of the Bernstein
coefficients bounds f on [0, 1] [1]_; halving the interval makes the bound as tight as wanted.

.. [1] R. T. Farouki, "The Bernstein polynomial basis: a centennial retrospective", CAGD 29 (2012), 379-419.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import comb, lcm

import numpy as np

from stages.geometry.arrays import Array, Mask, Values

Vector = tuple["Polynomial", ...]
"""Three polynomials, the components of a vector function."""


@dataclass(frozen=True, slots=True)
class Polynomial:
    """Scaled Bernstein coefficients c_i (whole numbers) over a positive whole denominator."""

    scaled: tuple[int, ...]
    denominator: int = 1

    @property
    def degree(self) -> int:
        """Return the degree of the representation (not lowered where leading terms cancel)."""
        return len(self.scaled) - 1

    @property
    def is_zero(self) -> bool:
        """Return whether it vanishes identically: exact."""
        return not any(self.scaled)

    def __call__(self, v: Fraction) -> Fraction:
        """Return the exact value at v."""
        x, whole = v.numerator, v.denominator
        total, power = 0, 1
        for c in reversed(self.scaled):
            total = total * x + c * power
            power *= whole - x
        return Fraction(total, self.denominator * whole**self.degree)


def from_bernstein(coefficients: Sequence[Fraction]) -> Polynomial:
    """Return the polynomial with these Bernstein coefficients."""
    n = len(coefficients) - 1
    denominator = lcm(*(c.denominator for c in coefficients))
    return Polynomial(tuple(comb(n, i) * int(c * denominator) for i, c in enumerate(coefficients)), denominator)


def vector_from_points(points: Sequence[Sequence[Fraction]]) -> Vector:
    """Return the three components of the Bezier curve with these exact control points."""
    return tuple(from_bernstein([point[axis] for point in points]) for axis in range(3))


def multiply(f: Polynomial, g: Polynomial) -> Polynomial:
    """Return f g."""
    product = [0] * (f.degree + g.degree + 1)
    for i, a in enumerate(f.scaled):
        if a:
            for j, b in enumerate(g.scaled):
                product[i + j] += a * b
    return Polynomial(tuple(product), f.denominator * g.denominator)


def elevate(f: Polynomial, degree: int) -> Polynomial:
    """Return f represented in a higher degree: times (v + (1 - v)) as often as needed."""
    scaled = f.scaled
    for _ in range(degree - f.degree):
        scaled = tuple(a + b for a, b in zip((*scaled, 0), (0, *scaled), strict=True))
    return Polynomial(scaled, f.denominator)


def add(f: Polynomial, g: Polynomial, *, sign: int = 1) -> Polynomial:
    """Return f + sign g."""
    degree = max(f.degree, g.degree)
    f, g = elevate(f, degree), elevate(g, degree)
    common = lcm(f.denominator, g.denominator)
    left, right = common // f.denominator, sign * (common // g.denominator)
    return Polynomial(tuple(left * a + right * b for a, b in zip(f.scaled, g.scaled, strict=True)), common)


def derivative(f: Polynomial) -> Polynomial:
    """Return df/dv."""
    n = f.degree
    if n == 0:
        return Polynomial((0,))
    c = f.scaled
    return Polynomial(tuple((i + 1) * c[i + 1] - (n - i) * c[i] for i in range(n)), f.denominator)


def cross(a: Vector, b: Vector) -> Vector:
    """Return the cross product of two vector functions."""
    return tuple(
        add(multiply(a[i], b[j]), multiply(a[j], b[i]), sign=-1) for i, j in ((1, 2), (2, 0), (0, 1))
    )  # fmt: skip


def inner(a: Vector, b: Vector) -> Polynomial:
    """Return the dot product of two vector functions."""
    return add(add(multiply(a[0], b[0]), multiply(a[1], b[1])), multiply(a[2], b[2]))


def subtract(a: Vector, b: Vector) -> Vector:
    """Return a - b."""
    return tuple(add(f, g, sign=-1) for f, g in zip(a, b, strict=True))


def lowered(f: Polynomial) -> Polynomial:
    """Return f represented in a degree lower by one; ValueError if its degree is really that high."""
    scaled: list[int] = []
    for c in f.scaled[:-1]:
        scaled.append(c - (scaled[-1] if scaled else 0))
    if scaled[-1:] != [f.scaled[-1]]:
        raise ValueError("a polynomial of full degree cannot be lowered")
    return Polynomial(tuple(scaled), f.denominator)


def rounded(f: Polynomial) -> Array:
    """Return the scaled coefficients in float64, all divided by one power of 2 that makes the largest at most 1."""
    bits = max(c.bit_length() for c in f.scaled)
    return np.array([c / (1 << bits) for c in f.scaled])


def ratio(f: Array, g: Array, v: Values) -> Values:
    """Return f / g at v in floats, by rounded scaled coefficients; infinite or NaN where g vanishes.

    By Horner's rule in v / (1 - v), or its inverse in the upper half: what f and g have in common cancels.
    """
    upper = v > HALF
    base = np.where(upper, v, 1.0 - v)
    t = np.where(upper, 1.0 - v, v) / base
    with np.errstate(divide="ignore", invalid="ignore"):
        quotient: Values = _horner(f, upper, t) / _horner(g, upper, t) * base ** float(f.size - g.size)
    return quotient


HALF = 0.5


def _horner(f: Array, upper: Mask, t: Values) -> Values:
    turned = np.stack([f, f[::-1]])[upper.astype(np.int64)].T
    total: Values = turned[-1]
    for row in turned[-2::-1]:
        total = total * t + row
    return total


@dataclass(frozen=True, slots=True)
class Piece:
    """A polynomial on a dyadic part of [0, 1]: Bernstein coefficients `b_i * 2**-shift / denominator`, b_i whole."""

    b: tuple[int, ...]
    denominator: int
    shift: int = 0


def whole(f: Polynomial) -> Piece:
    """Return f on all of [0, 1], in Bernstein coefficients with a common denominator."""
    n = f.degree
    common = lcm(*(comb(n, i) for i in range(n + 1)))
    return Piece(tuple(c * (common // comb(n, i)) for i, c in enumerate(f.scaled)), f.denominator * common)


def halves(piece: Piece) -> tuple[Piece, Piece]:
    """Return the piece on the left and on the right half of its interval (de Casteljau, exact)."""
    n = len(piece.b) - 1
    row = list(piece.b)
    left, right = [row[0] << n], [row[-1] << n]
    for level in range(1, n + 1):
        row = [a + b for a, b in pairwise(row)]
        left.append(row[0] << (n - level))
        right.append(row[-1] << (n - level))
    shift = piece.shift + n
    return Piece(tuple(left), piece.denominator, shift), Piece(tuple(right[::-1]), piece.denominator, shift)
