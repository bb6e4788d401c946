"""Smooth curves in space over v in [0, 1], with derivatives, closed under affine maps and restriction.

Three sorts are enough: Bezier (polynomial), rational Bezier, and circular motion (centre + cos U + sin V + angle W:
arcs, circles, ellipses and helices).  Cones and cylinders over them are affine images of the same sort, so nothing is
approximated.  Both sorts of Bezier curve carry their control points exactly as well, for proofs; floats are those,
rounded once.
`Difference` is what is left when two curves of unlike sorts are subtracted; `Along` are parallel rulings.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import comb
from typing import Protocol, runtime_checkable

import numpy as np

from stages.geometry.arrays import Array, ArrayValue, Points3, Values, Vector3, float_rows, floats
from stages.geometry.numeric.basis import bernstein_jet

ExactPoint = tuple[Fraction, Fraction, Fraction]
ExactPoints = tuple[ExactPoint, ...]
HomogeneousPoint = tuple[Fraction, Fraction, Fraction, Fraction]
HomogeneousPoints = tuple[HomogeneousPoint, ...]


@runtime_checkable
class Curve(Protocol):
    """A curve that is smooth on [0, 1]."""

    def jet(self, v: Values, order: int) -> Array:
        """Return position and derivatives up to `order`, shape (order + 1, n, 3), mm."""
        ...


@runtime_checkable
class Derived(Curve, Protocol):
    """A curve made from others, which knows its own images and parts."""

    def image(self, matrix: Sequence[Sequence[Fraction]], shift: Sequence[Fraction]) -> Curve:
        """Return matrix @ curve + shift."""
        ...

    def part(self, low: Fraction, high: Fraction) -> Curve:
        """Return the part over [low, high], with its parameter again in [0, 1]."""
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
        return bernstein_jet(self.points, v, order)


@dataclass(frozen=True, slots=True, eq=False)
class RationalBezier(ArrayValue):
    """A rational curve by its exact homogeneous control points (w x, w y, w z, w), w > 0; made by `rational`.

    origin: a point near it, mm.  near: w (x - origin) in float64.  weights: w in float64, the largest 1.
    """

    exact: HomogeneousPoints
    origin: Vector3
    near: Points3
    weights: Values

    def check(self) -> None:
        """Refuse weights that are not positive, and unlike numbers of points."""
        if not (len(self.exact) == len(self.near) == len(self.weights) > 0):
            raise ValueError("a rational curve needs as many exact as rounded control points, at least one")
        if not all(point[3] > 0 for point in self.exact):
            raise ValueError("weights must be positive")

    def jet(self, v: Values, order: int) -> Array:
        """Return position and derivatives up to `order`, shape (order + 1, n, 3), by the quotient rule.

        Taken from a point nearby: far from the origin the quotient rule would lose the derivatives' digits.
        """
        rows = bernstein_jet(np.column_stack([self.near, self.weights]), v, order)
        over, weight = rows[..., :3], rows[..., 3:]
        jets = np.zeros_like(over)
        for k in range(order + 1):
            rest = sum((comb(k, i) * weight[i] * jets[k - i] for i in range(1, k + 1)), np.zeros((v.size, 3)))
            jets[k] = (over[k] - rest) / weight[0]
        jets[0] += self.origin
        return jets


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
    return Bezier(points, float_rows(points))


def rational(exact: Sequence[Sequence[Fraction]]) -> RationalBezier:
    """Return the rational Bezier curve with these exact homogeneous control points (w x, w y, w z, w)."""
    points = tuple((Fraction(x), Fraction(y), Fraction(z), Fraction(w)) for x, y, z, w in exact)
    if not all(point[3] > 0 for point in points):
        raise ValueError("weights must be positive")
    origin = _far_origin(points)
    # the largest weight becomes 1: weights count by their ratios, whatever the scale they were typed in
    largest = max(point[3] for point in points)
    near = [[(x - point[3] * o) / largest for x, o in zip(point[:3], origin, strict=True)] for point in points]
    weights = floats(point[3] / largest for point in points)
    return RationalBezier(points, floats(origin), float_rows(near), weights)


def _far_origin(points: HomogeneousPoints) -> list[Fraction]:
    """Return the first point where the curve is smaller than its distance from the origin, else the origin itself.

    A ruling that shrinks to nothing must not be the difference of two longer vectors.
    """
    x, y, z, w = points[0]
    first = [x / w, y / w, z / w]
    extent = max(abs(c / point[3] - o) for point in points for c, o in zip(point[:3], first, strict=True))
    return first if max(map(abs, first)) > extent else [Fraction(0)] * 3


def homogeneous(curve: Bezier | RationalBezier) -> HomogeneousPoints:
    """Return the control points as (w x, w y, w z, w)."""
    if isinstance(curve, RationalBezier):
        return curve.exact
    return tuple((x, y, z, Fraction(1)) for x, y, z in curve.exact)


def exactly(values: Sequence[float] | Array) -> tuple[Fraction, ...]:
    """Return the doubles as the rationals they are."""
    return tuple(Fraction(float(value)) for value in values)


def affine(curve: Curve, matrix: Sequence[Sequence[Fraction]], shift: Sequence[Fraction]) -> Curve:
    """Return matrix @ curve + shift; exact on Bezier curves, rational ones too."""
    if isinstance(curve, Bezier):
        return bezier([_image((*point, Fraction(1)), matrix, shift) for point in curve.exact])
    if isinstance(curve, RationalBezier):
        return rational([[*_image(point, matrix, shift), point[3]] for point in curve.exact])
    m, d = float_rows(matrix), floats(shift)
    if isinstance(curve, Circular):
        return Circular(m @ curve.centre + d, m @ curve.U, m @ curve.V, m @ curve.W, curve.start, curve.sweep)
    if isinstance(curve, Derived):
        return curve.image(matrix, shift)
    raise ValueError(f"no affine image of a {type(curve).__name__}")


def _image(point: HomogeneousPoint, matrix: Sequence[Sequence[Fraction]], shift: Sequence[Fraction]) -> list[Fraction]:
    """Return the first three homogeneous coordinates of the image of a point; its weight stays."""
    return [sum((m * x for m, x in zip(row, point, strict=False)), d * point[3])
            for row, d in zip(matrix, shift, strict=True)]  # fmt: skip


def restrict(curve: Curve, low: Fraction, high: Fraction) -> Curve:
    """Return the part of the curve over [low, high], with its parameter again in [0, 1]; exact on Bezier curves,
    rational ones too."""
    if low == 0 and high == 1:
        return curve
    if isinstance(curve, Bezier):
        return bezier(blossom(curve.exact, low, high))
    if isinstance(curve, RationalBezier):
        return rational(blossom(curve.exact, low, high))
    if isinstance(curve, Circular):
        start = curve.start + curve.sweep * float(low)
        return Circular(curve.centre, curve.U, curve.V, curve.W, start, curve.sweep * float(high - low))
    if isinstance(curve, Along):
        return Along(restrict(curve.distance, low, high), curve.direction)
    if isinstance(curve, Difference):
        return Difference(restrict(curve.a, low, high), restrict(curve.b, low, high))
    if isinstance(curve, Derived):
        return curve.part(low, high)
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
    """Return a - b, by control points where both are Bezier curves (rational or not) or share their circular motion."""
    if isinstance(a, Bezier) and isinstance(b, Bezier):
        degree = max(len(a.exact), len(b.exact)) - 1
        pairs = zip(elevated(a.exact, degree), elevated(b.exact, degree), strict=True)
        return bezier([[x - y for x, y in zip(p, q, strict=True)] for p, q in pairs])
    if isinstance(a, Circular) and isinstance(b, Circular) and (a.start, a.sweep) == (b.start, b.sweep):
        return Circular(a.centre - b.centre, a.U - b.U, a.V - b.V, a.W - b.W, a.start, a.sweep)
    if isinstance(a, Bezier | RationalBezier) and isinstance(b, Bezier | RationalBezier):
        return rational(_over_one_weight(homogeneous(a), homogeneous(b)))
    return Difference(a, b)


def _over_one_weight(a: HomogeneousPoints, b: HomogeneousPoints) -> list[list[Fraction]]:
    """Return a - b of two rational curves: (A w_b - B w_a) / (w_a w_b), or (A - B) / w over the same w."""
    wa, wb = [point[3] for point in a], [point[3] for point in b]
    if wa == wb:
        return [[*(x - y for x, y in zip(p[:3], q[:3], strict=True)), p[3]] for p, q in zip(a, b, strict=True)]
    columns = [
        [x - y for x, y in zip(_product([p[axis] for p in a], wb), _product([q[axis] for q in b], wa), strict=True)]
        for axis in range(3)
    ]
    return [list(row) for row in zip(*columns, _product(wa, wb), strict=True)]


def _product(f: Sequence[Fraction], g: Sequence[Fraction]) -> list[Fraction]:
    """Return the Bernstein coefficients of the product of two polynomials in Bernstein form, exact."""
    n, m = len(f) - 1, len(g) - 1
    total = [Fraction(0)] * (n + m + 1)
    for i, x in enumerate(f):
        for j, y in enumerate(g):
            total[i + j] += comb(n, i) * comb(m, j) * x * y
    return [value / comb(n + m, k) for k, value in enumerate(total)]


def elevated(points: ExactPoints, degree: int) -> ExactPoints:
    """Return the control points of the same curve in a higher degree."""
    rows: Sequence[Sequence[Fraction]] = points
    while len(rows) <= degree:
        rows = raised(rows)
    return tuple((x, y, z) for x, y, z in rows)


def raised(rows: Sequence[Sequence[Fraction]]) -> list[tuple[Fraction, ...]]:
    """Return the Bernstein coefficients, rows of any length, of the same polynomials one degree higher."""
    n = len(rows)
    shares = [Fraction(i, n) for i in range(1, n)]
    inner = [
        tuple(share * a + (1 - share) * b for a, b in zip(rows[i], rows[i + 1], strict=True))
        for i, share in enumerate(shares)
    ]
    return [tuple(rows[0]), *inner, tuple(rows[-1])]
