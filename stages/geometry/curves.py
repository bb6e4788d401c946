"""Smooth curves in space over v in [0, 1], with derivatives, closed under affine maps and restriction.

Three sorts are enough: Bezier (polynomial), rational Bezier, and circular motion (centre + cos U + sin V + angle W:
arcs, circles, ellipses and helices).  Cones and cylinders over them are affine images of the same sort, so nothing is
approximated.  A Bezier curve carries its control points exactly as well, for proofs; floats are those, rounded once.
`Difference` is what is left when two curves of unlike sorts are subtracted; `Along` are parallel rulings.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import comb
from typing import Protocol, runtime_checkable

import numpy as np

from stages.geometry.arrays import Array, ArrayValue, Points3, Values, Vector3

ExactPoint = tuple[Fraction, Fraction, Fraction]
ExactPoints = tuple[ExactPoint, ...]


@runtime_checkable
class Curve(Protocol):
    """A curve that is smooth on [0, 1]."""

    def jet(self, v: Values, order: int) -> Array:
        """Return position and derivatives up to `order`, shape (order + 1, n, 3), mm."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class Bezier(ArrayValue):
    """A polynomial curve by its exact control points; `points` are the same in float64."""

    exact: ExactPoints
    points: Points3

    def check(self) -> None:
        """Refuse an empty curve."""
        if len(self.exact) != len(self.points) or not self.exact:
            raise ValueError("a Bezier curve needs as many exact as rounded control points, at least one")

    def jet(self, v: Values, order: int) -> Array:
        """Return position and derivatives up to `order`, shape (order + 1, n, 3)."""
        return np.stack([bernstein_sum(differences(self.points, k), v) for k in range(order + 1)])


@dataclass(frozen=True, slots=True, eq=False)
class RationalBezier(ArrayValue):
    """A rational curve: control points already multiplied by their positive weights, shape (n, 3), and the weights."""

    weighted: Points3
    weights: Values

    def check(self) -> None:
        """Refuse weights that are not positive."""
        if not (self.weights > 0.0).all():
            raise ValueError("weights must be positive")

    def jet(self, v: Values, order: int) -> Array:
        """Return position and derivatives up to `order`, shape (order + 1, n, 3), by the quotient rule.

        Taken from the first point on: far from the origin the quotient rule would lose the derivatives' digits.
        """
        origin = self.weighted[0] / self.weights[0]
        near = self.weighted - np.outer(self.weights, origin)
        jets: list[Array] = []
        weight = [bernstein_sum(differences(self.weights[:, None], k), v) for k in range(order + 1)]
        for k in range(order + 1):
            rest = sum((comb(k, i) * weight[i] * jets[k - i] for i in range(1, k + 1)), np.zeros((v.size, 3)))
            jets.append((bernstein_sum(differences(near, k), v) - rest) / weight[0])
        jets[0] = jets[0] + origin
        return np.stack(jets)


@dataclass(frozen=True, slots=True, eq=False)
class Circular(ArrayValue):
    """centre + cos(a) U + sin(a) V + a W with the angle a = start + v sweep, rad."""

    centre: Vector3
    U: Vector3
    V: Vector3
    W: Vector3
    start: float
    sweep: float

    def jet(self, v: Values, order: int) -> Array:
        """Return position and derivatives up to `order`, shape (order + 1, n, 3)."""
        a = (self.start + self.sweep * v)[:, None]
        jets = [self.centre + np.cos(a) * self.U + np.sin(a) * self.V + a * self.W]
        for k in range(1, order + 1):
            turned = a + k * np.pi / 2.0
            rise = self.W if k == 1 else 0.0 * self.W
            jets.append(self.sweep**k * (np.cos(turned) * self.U + np.sin(turned) * self.V + rise))
        return np.stack(jets)


@dataclass(frozen=True, slots=True, eq=False)
class Difference(ArrayValue):
    """The curve a - b, by subtraction of values: loses digits where the two nearly meet."""

    a: Curve
    b: Curve

    def jet(self, v: Values, order: int) -> Array:
        """Return position and derivatives up to `order`, shape (order + 1, n, 3)."""
        difference: Array = self.a.jet(v, order) - self.b.jet(v, order)
        return difference


@dataclass(frozen=True, slots=True, eq=False)
class Along(ArrayValue):
    """A direction times a distance, the first coordinate of a curve: keeps its direction however short it gets."""

    distance: Curve
    direction: Vector3

    def jet(self, v: Values, order: int) -> Array:
        """Return position and derivatives up to `order`, shape (order + 1, n, 3)."""
        scaled: Array = self.distance.jet(v, order)[..., :1] * self.direction
        return scaled


def bezier(exact: Sequence[Sequence[Fraction]]) -> Bezier:
    """Return the Bezier curve with these exact control points."""
    points = tuple((Fraction(x), Fraction(y), Fraction(z)) for x, y, z in exact)
    return Bezier(points, np.array([[float(x) for x in point] for point in points]))


def exactly(values: Sequence[float] | Array) -> tuple[Fraction, ...]:
    """Return the doubles as the rationals they are."""
    return tuple(Fraction(float(value)) for value in values)


def bernstein_basis(degree: int, v: Values) -> Array:
    """Return the Bernstein polynomials of a degree at v, shape (n points, degree + 1)."""
    powers = np.ones((degree + 1, v.size))
    others = np.ones((degree + 1, v.size))
    for i in range(1, degree + 1):
        powers[i] = powers[i - 1] * v
        others[i] = others[i - 1] * (1.0 - v)
    basis: Array = np.array([comb(degree, i) for i in range(degree + 1)])[:, None] * powers * others[::-1]
    return basis.T


def bernstein_sum(coefficients: Array, v: Values) -> Array:
    """Return sum_i B_i^n(v) coefficients[i], shape (n points, k); stable for v in [0, 1]."""
    total: Array = bernstein_basis(coefficients.shape[0] - 1, v) @ coefficients
    return total


def differences(coefficients: Array, order: int) -> Array:
    """Return the Bernstein coefficients of the derivative of that order (one zero row beyond the degree)."""
    for _ in range(order):
        n = coefficients.shape[0] - 1
        coefficients = n * np.diff(coefficients, axis=0) if n > 0 else np.zeros_like(coefficients)
    return coefficients


def affine(curve: Curve, matrix: Sequence[Sequence[Fraction]], shift: Sequence[Fraction]) -> Curve:
    """Return matrix @ curve + shift; exact on Bezier curves."""
    if isinstance(curve, Bezier):
        return bezier(
            [
                [sum((m * x for m, x in zip(row, point, strict=True)), d) for row, d in zip(matrix, shift, strict=True)]
                for point in curve.exact
            ]
        )
    m = np.array([[float(x) for x in row] for row in matrix])
    d = np.array([float(x) for x in shift])
    if isinstance(curve, RationalBezier):
        return RationalBezier(curve.weighted @ m.T + np.outer(curve.weights, d), curve.weights)
    if isinstance(curve, Circular):
        return Circular(m @ curve.centre + d, m @ curve.U, m @ curve.V, m @ curve.W, curve.start, curve.sweep)
    raise ValueError(f"no affine image of a {type(curve).__name__}")


def restrict(curve: Curve, low: Fraction, high: Fraction) -> Curve:
    """Return the part of the curve over [low, high], with its parameter again in [0, 1]; exact on Bezier curves."""
    if low == 0 and high == 1:
        return curve
    if isinstance(curve, Bezier):
        return bezier(blossom(curve.exact, low, high))
    if isinstance(curve, RationalBezier):
        rows = [(*point, w) for point, w in zip(curve.weighted, curve.weights, strict=True)]
        part = np.array(blossom([exactly(row) for row in rows], low, high), dtype=np.float64)
        return RationalBezier(part[:, :3], part[:, 3])
    if isinstance(curve, Circular):
        start = curve.start + curve.sweep * float(low)
        return Circular(curve.centre, curve.U, curve.V, curve.W, start, curve.sweep * float(high - low))
    raise ValueError(f"no part of a {type(curve).__name__}")


def blossom(points: Sequence[Sequence[Fraction]], low: Fraction, high: Fraction) -> list[list[Fraction]]:
    """Return the control points over [low, high] (exact de Casteljau): b[low^(n-i) high^i]."""
    n = len(points) - 1

    def polar(arguments: Sequence[Fraction]) -> list[Fraction]:
        rows = [list(point) for point in points]
        for t in arguments:
            rows = [[(1 - t) * a + t * b for a, b in zip(left, right, strict=True)] for left, right in pairwise(rows)]
        return rows[0]

    return [polar([low] * (n - i) + [high] * i) for i in range(n + 1)]


def difference(a: Curve, b: Curve) -> Curve:
    """Return a - b, by control points where both are Bezier curves or share their circular motion."""
    if isinstance(a, Bezier) and isinstance(b, Bezier):
        degree = max(len(a.exact), len(b.exact)) - 1
        pairs = zip(elevated(a.exact, degree), elevated(b.exact, degree), strict=True)
        return bezier([[x - y for x, y in zip(p, q, strict=True)] for p, q in pairs])
    if isinstance(a, Circular) and isinstance(b, Circular) and (a.start, a.sweep) == (b.start, b.sweep):
        return Circular(a.centre - b.centre, a.U - b.U, a.V - b.V, a.W - b.W, a.start, a.sweep)
    if isinstance(a, RationalBezier) and isinstance(b, RationalBezier) and np.array_equal(a.weights, b.weights):
        return RationalBezier(a.weighted - b.weighted, a.weights)
    return Difference(a, b)


def elevated(points: ExactPoints, degree: int) -> ExactPoints:
    """Return the control points of the same curve in a higher degree."""
    while len(points) <= degree:
        n = len(points)
        inner = [_between(points[i], points[i - 1], Fraction(i, n)) for i in range(1, n)]
        points = (points[0], *inner, points[-1])
    return points


def _between(a: ExactPoint, b: ExactPoint, share: Fraction) -> ExactPoint:
    """Return (1 - share) a + share b."""
    rest = 1 - share
    return rest * a[0] + share * b[0], rest * a[1] + share * b[1], rest * a[2] + share * b[2]
