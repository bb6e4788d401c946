"""Surfaces parallel to a ruled patch: S + d N, N the unit normal of p x S_v.

Along a ruling of a developable N is constant, so the parallel surface has the directrices c0 + d N and c1 + d N, the
same p and the same (u, v), and is developable along the same rulings [1]_.  N is taken from the middle of the ruling,
m = p x (c0' + p'/2), which is half the sum of both end normals: an apex leaves the normal of the other end.

Where m vanishes (a ruling of no length, a ruling along the directrix, a directrix that stops), N is its limit: of
polynomial and rational patches m is a polynomial, whose components' common factor is divided out exactly; parallel
rulings keep their direction apart from their length.  Any other patch whose normal vanishes at an end is refused.
Derivatives of N = m / |m| to any order by power series (`series`).

Of a patch with warp this is the offset along the normals at the middles of its rulings.

.. [1] H. Pottmann, J. Wallner, "Computational Line Geometry", 2001, section 6.1: developables and their offsets.
"""

from dataclasses import dataclass
from fractions import Fraction
from math import comb

import numpy as np

from stages.errors import NoSolutionError
from stages.geometry.arrays import Array, ArrayValue, Points3, Values, float_rows, norm
from stages.geometry.curves.curves import Along, Bezier, Curve, RationalBezier, homogeneous
from stages.geometry.numeric import bernstein, series
from stages.geometry.numeric.basis import bernstein_jet
from stages.geometry.numeric.bernstein import Polynomial, Vector
from stages.geometry.numeric.factors import common_factor, divided_by
from stages.geometry.ruled.ruled import VANISHED, RuledPatch


@dataclass(frozen=True, slots=True, eq=False)
class Coefficients(ArrayValue):
    """A polynomial vector function by its Bernstein coefficients, shape (n, 3)."""

    points: Points3

    def jet(self, v: Values, order: int) -> Array:
        """Return value and derivatives up to `order`, shape (order + 1, n, 3)."""
        return bernstein_jet(self.points, v, order)


@dataclass(frozen=True, slots=True, eq=False)
class Normal(ArrayValue):
    """p x (c0' + p'/2); `along` is p, or anything that has its direction."""

    c0: Curve
    p: Curve
    along: Curve

    def jet(self, v: Values, order: int) -> Array:
        """Return value and derivatives up to `order`, shape (order + 1, n, 3)."""
        slopes = (self.c0.jet(v, order + 1) + 0.5 * self.p.jet(v, order + 1))[1:]
        along = self.along.jet(v, order)
        return series.derivatives(series.outer(series.taylor(along), series.taylor(slopes)))


@dataclass(frozen=True, slots=True, eq=False)
class Unit(ArrayValue):
    """A vector function scaled to length 1; zero where that is zero."""

    vector: Curve

    def jet(self, v: Values, order: int) -> Array:
        """Return value and derivatives up to `order`, shape (order + 1, n, 3)."""
        return series.derivatives(series.unit(series.taylor(self.vector.jet(v, order))))


@dataclass(frozen=True, slots=True, eq=False)
class Offset(ArrayValue):
    """A curve moved by a distance along a field of unit vectors."""

    base: Curve
    normal: Curve
    distance_mm: float

    def jet(self, v: Values, order: int) -> Array:
        """Return position and derivatives up to `order`, shape (order + 1, n, 3), mm."""
        moved: Array = self.base.jet(v, order) + self.distance_mm * self.normal.jet(v, order)
        return moved


@dataclass(frozen=True, slots=True, eq=False)
class Restricted(ArrayValue):
    """The part of any curve over [low, high], with its parameter again in [0, 1]."""

    curve: Curve
    low: float
    high: float

    def jet(self, v: Values, order: int) -> Array:
        """Return position and derivatives up to `order`, shape (order + 1, n, 3)."""
        width = self.high - self.low
        scale = np.array([width**k for k in range(order + 1)])[:, None, None]
        scaled: Array = scale * self.curve.jet(self.low + width * v, order)
        return scaled


def restricted(patch: RuledPatch, low: float, high: float) -> RuledPatch:
    """Return the part of any patch over [low, high] of v."""
    if (low, high) == (0.0, 1.0):
        return patch
    return RuledPatch(*(Restricted(curve, low, high) for curve in (patch.c0, patch.c1, patch.p)))


def offset(patch: RuledPatch, distance_mm: float, normal: Curve | None = None) -> RuledPatch:
    """Return the parallel patch at a distance in mm, positive towards p x S_v; `normal`: if it is known already.

    Regular only while the distance is less than the radius of curvature on that side.  Raises NoSolutionError where
    the normal vanishes at an end and has no limit that is known exactly.
    """
    if distance_mm == 0.0:
        return patch
    field = normals(patch) if normal is None else normal
    return RuledPatch(Offset(patch.c0, field, distance_mm), Offset(patch.c1, field, distance_mm), patch.p)


def tapered(patch: RuledPatch, distance_mm: float, normal: Curve, kept: float) -> RuledPatch:
    """Return the patch with the edge u = `kept`, 0 or 1, where it is and the other moved by a distance along `normal`.

    Developable where the kept edge is the apex of a cone, or the patch is a plane: a cone over the moved edge, a plane
    turned a little.  Rulings of the length L become sqrt(L^2 + distance^2).
    """
    if kept == 0.0:
        return RuledPatch(patch.c0, Offset(patch.c1, normal, distance_mm), Offset(patch.p, normal, distance_mm))
    return RuledPatch(Offset(patch.c0, normal, distance_mm), patch.c1, Offset(patch.p, normal, -distance_mm))


def normals(patch: RuledPatch) -> Curve:
    """Return the unit normals along the patch, with their limits where p x S_v vanishes at an end."""
    polynomial = _polynomial_normal(patch)
    if polynomial is not None:
        return Unit(polynomial)
    along: Curve = patch.p
    if isinstance(patch.p, Along):
        sense = np.sign(patch.p.distance.jet(np.array([0.5]), 0)[0, 0, 0])
        along = Coefficients((sense * patch.p.direction)[None, :])
    normal = Normal(patch.c0, patch.p, along)
    _refuse_vanishing(normal)
    return Unit(normal)


def _refuse_vanishing(normal: Normal) -> None:
    """Raise NoSolutionError where the normal at an end is rounding."""
    v = np.array([0.0, 1.0])
    slopes = normal.c0.jet(v, 1)[1] + 0.5 * normal.p.jet(v, 1)[1]
    strength = norm(normal.jet(v, 0)[0])
    size = float(norm(normal.along.jet(np.array([0.5]), 0)[0, 0])) * float(norm(slopes).max())
    for place, value in zip(v, strength, strict=True):
        if value <= VANISHED * size:
            subject = f"the normal of the ruling at v = {place:g}"
            share = float(value) / size if size > 0.0 else 0.0
            raise NoSolutionError(subject, reached=share, wanted=VANISHED, unit="of |p||c'|")


def _polynomial_normal(patch: RuledPatch) -> Coefficients | None:
    """Return p x (c0' + p'/2) without its zeros, up to a positive factor; None for other sorts of curves.

    With c0 = A / a and c1 = B / b:  p ~ B a - A b  and  (c0 + c1)' ~ M' a b - M (a b)',  M = A b + B a.
    """
    c0, c1 = patch.c0, patch.c1
    if not (isinstance(c0, Bezier | RationalBezier) and isinstance(c1, Bezier | RationalBezier)):
        return None
    (A, a), (B, b) = _parts(c0), _parts(c1)
    if a == b:
        left, right, weight = A, B, a
    else:
        left, right, weight = _times(A, b), _times(B, a), bernstein.multiply(a, b)
    middle = tuple(bernstein.add(f, g) for f, g in zip(left, right, strict=True))
    slopes = bernstein.subtract(
        _times(tuple(bernstein.derivative(f) for f in middle), weight), _times(middle, bernstein.derivative(weight))
    )
    return _reduced(bernstein.cross(bernstein.subtract(right, left), slopes))


def _reduced(vector: Vector) -> Coefficients | None:
    """Return the vector without the factor that its components share, None if it is zero; positive at the middle."""
    if all(f.is_zero for f in vector):
        return None
    shared = common_factor(vector)
    sign = next((np.sign(float(shared(v))) for v in MIDDLES if shared(v) != 0), 1.0)
    return Coefficients(sign * _rounded(divided_by(vector, shared)))


MIDDLES = tuple(Fraction(1, 2) + Fraction(k, 64) for k in range(16))
"""Where the sign of a factor is taken from; a factor of degree 15 is not zero at all 16."""


def _parts(curve: Bezier | RationalBezier) -> tuple[Vector, Polynomial]:
    """Return numerator and weight of a curve, exact; the weight of a polynomial curve is the constant 1."""
    points = homogeneous(curve)
    if isinstance(curve, Bezier):
        return bernstein.vector_from_points(curve.exact), Polynomial((1,))
    return bernstein.vector_from_points(points), bernstein.from_bernstein([point[3] for point in points])


def _times(vector: Vector, factor: Polynomial) -> Vector:
    return tuple(bernstein.multiply(f, factor) for f in vector)


def _rounded(vector: Vector) -> Points3:
    """Return the Bernstein coefficients of three polynomials, the largest 1, each rounded once."""
    degree = max(f.degree for f in vector)
    rows = [bernstein.elevate(f, degree) for f in vector]
    exact = [[Fraction(f.scaled[i], f.denominator * comb(degree, i)) for f in rows] for i in range(degree + 1)]
    largest = max(abs(x) for point in exact for x in point)
    return float_rows([x / largest for x in point] for point in exact)
