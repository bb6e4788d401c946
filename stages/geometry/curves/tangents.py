"""Unit tangents of curves, and sums of curves: what tangent surfaces and surfaces of constant slope are made of.

The tangent T = r' / |r'| and its derivatives follow from the power series of r' (`series`), exact in every order.  The
tangent of a straight line is constant, that of a circle or a helix is circular motion again: those stay in closed form.
Not where a curve stops (r' = 0).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from stages.geometry.arrays import EPS, Array, ArrayValue, Matrix, Values, Vector3, dot, float_rows, floats, norm, unit
from stages.geometry.curves.curves import (
    Bezier,
    Circular,
    Curve,
    RationalBezier,
    affine,
    bezier,
    elevated,
    exactly,
    restrict,
)
from stages.geometry.numeric import series


@dataclass(frozen=True, slots=True, eq=False)
class UnitTangent(ArrayValue):
    """An affine image of the unit tangent T of a curve: matrix @ T + shift."""

    curve: Curve
    matrix: Matrix
    shift: Vector3

    def jet(self, v: Values, order: int) -> Array:
        """Return position and derivatives up to `order`, shape (order + 1, n, 3)."""
        jets: Array = tangent_jet(self.curve.jet(v, order + 1)[1:]) @ self.matrix.T
        jets[0] += self.shift
        return jets

    def image(self, matrix: Sequence[Sequence[Fraction]], shift: Sequence[Fraction]) -> Curve:
        """Return matrix @ curve + shift."""
        m = float_rows(matrix)
        return UnitTangent(self.curve, m @ self.matrix, m @ self.shift + floats(shift))

    def part(self, low: Fraction, high: Fraction) -> Curve:
        """Return the part over [low, high]; run backwards, the curve beneath has the opposite tangent."""
        sense = 1.0 if high > low else -1.0
        return UnitTangent(restrict(self.curve, low, high), sense * self.matrix, self.shift)


@dataclass(frozen=True, slots=True, eq=False)
class Sum(ArrayValue):
    """The curve a + b, by addition of values."""

    a: Curve
    b: Curve

    def jet(self, v: Values, order: int) -> Array:
        """Return position and derivatives up to `order`, shape (order + 1, n, 3)."""
        total: Array = self.a.jet(v, order) + self.b.jet(v, order)
        return total

    def image(self, matrix: Sequence[Sequence[Fraction]], shift: Sequence[Fraction]) -> Curve:
        """Return matrix @ curve + shift."""
        return Sum(affine(self.a, matrix, shift), affine(self.b, matrix, (Fraction(0),) * 3))

    def part(self, low: Fraction, high: Fraction) -> Curve:
        """Return the part over [low, high]."""
        return Sum(restrict(self.a, low, high), restrict(self.b, low, high))


def tangent_jet(w: Array) -> Array:
    """Return w / |w| and its derivatives, of the same shape as those of w, (order + 1, n, 3)."""
    return series.derivatives(series.unit(series.taylor(w)))


def unit_tangent(curve: Curve) -> Curve:
    """Return the unit tangent of a curve as a curve: of a line, a circle and a helix in closed form."""
    if isinstance(curve, Bezier) and len(curve.exact) == len("ab"):
        start, end = curve.exact
        return bezier([exactly(unit(np.array([float(b - a) for a, b in zip(start, end, strict=True)])))])
    if isinstance(curve, Circular) and is_even(curve):
        speed = float(np.sqrt(dot(curve.U, curve.U) + dot(curve.W, curve.W))) * float(np.sign(curve.sweep))
        zero = np.zeros(3)
        return Circular(curve.W / speed, curve.V / speed, -curve.U / speed, zero, curve.start, curve.sweep)
    return UnitTangent(curve, np.eye(3), np.zeros(3))


def is_even(curve: Circular) -> bool:
    """Return whether a circular motion has one speed: a circle, or a helix that rises along its axis."""
    size = float(dot(curve.U, curve.U))
    products = (dot(curve.V, curve.V) - size, dot(curve.U, curve.V), dot(curve.U, curve.W), dot(curve.V, curve.W))
    return bool(np.abs(products).max() <= ROUND * (size + float(dot(curve.W, curve.W))))


ROUND = 16 * EPS
"""Products of axes that are equal, or zero, up to this share: decimals rounded once, three products."""


def total(a: Curve, b: Curve) -> Curve:
    """Return a + b: exact where both are Bezier curves or b is constant, circular where both share their motion."""
    if isinstance(b, Bezier) and len(b.exact) == 1 and isinstance(a, Bezier | RationalBezier | Circular):
        return affine(a, IDENTITY, b.exact[0])
    if isinstance(a, Bezier) and isinstance(b, Bezier):
        degree = max(len(a.exact), len(b.exact)) - 1
        pairs = zip(elevated(a.exact, degree), elevated(b.exact, degree), strict=True)
        return bezier([[x + y for x, y in zip(p, q, strict=True)] for p, q in pairs])
    if isinstance(a, Circular) and isinstance(b, Circular) and (a.start, a.sweep) == (b.start, b.sweep):
        return Circular(
            a.centre + b.centre, _together(a.U, b.U), _together(a.V, b.V), _together(a.W, b.W), a.start, a.sweep
        )
    return Sum(a, b)


def _together(x: Vector3, y: Vector3) -> Vector3:
    """Return x + y, zero where they cancel up to rounding: a circle drawn in to its centre is a point."""
    both: Vector3 = x + y
    return np.where(norm(both) <= ROUND * norm(x), 0.0, both)


IDENTITY = tuple(tuple(Fraction(int(i == j)) for j in range(3)) for i in range(3))


def end_tangents(a: Curve, b: Curve) -> tuple[Vector3, Vector3]:
    """Return the unit tangents at the end of a and at the beginning of b."""
    return unit(a.jet(np.array([1.0]), 1)[1, 0]), unit(b.jet(np.array([0.0]), 1)[1, 0])


def turn_between(a: Curve, b: Curve) -> float:
    """Return the angle between the end of a and the beginning of b, rad, in [0, pi]."""
    before, after = end_tangents(a, b)
    return float(np.arctan2(norm(np.cross(before, after)), dot(before, after)))
