"""Developables through a given curve: the envelopes of planes that move along it.

r is the curve, T its unit tangent, n a field of vectors across it.  The planes through r across n envelop a developable
whose rulings run along n x n' [1]_.  Each ruling is given here by the vector g = S + mu T along it, S = n x T for unit
n, so that a distance t along g is t to the side of the curve, measured across it in the tangent plane and so in the
flat pattern.

`Conjugate`: g for any field n, made perpendicular to the curve first.
`Rectifying`: n the principal normal, g = B + (tau / kappa) T; the curve is a geodesic, and unrolls to a straight line
[2]_.  By the closed form of the Frenet apparatus, not by way of n.

All derivatives come from power series of r and n; g takes the curve's derivatives up to two orders more (`Conjugate`)
or three (`Rectifying`).  Not for curves that stop, nor where g is infinite: at an inflection, where the ruling runs
along the curve, where n does not turn.  `bend`, `turn` and `crossing_sine` measure how near that is.

.. [1] H. Pottmann, J. Wallner, "Computational Line Geometry", 2001, section 6.2.
.. [2] P. Bo, W. Wang, "Geodesic-controlled developable surfaces for modeling paper bending", Computer Graphics Forum 26
   (2007).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache, partial

import numpy as np

from stages.geometry.arrays import (
    Array,
    ArrayValue,
    Matrix,
    Values,
    Vector3,
    cross3,
    dot,
    float_rows,
    floats,
    locked,
    norm,
)
from stages.geometry.curves.curves import Curve, restrict
from stages.geometry.numeric.extremum import maxima
from stages.geometry.numeric.series import derivatives, inner, outer, power, product, scaled, slope, taylor
from stages.geometry.ruled.ruled import RuledPatch

Rows = Sequence[Sequence[Fraction]]


@dataclass(frozen=True, slots=True, eq=False)
class Rectifying(ArrayValue):
    """B + (tau / kappa) T of a curve: along the rulings of its rectifying developable."""

    curve: Curve

    def jet(self, v: Values, order: int) -> Array:
        """Return value and derivatives up to `order`, shape (order + 1, n, 3)."""
        return derivatives(_kept(self, v.tobytes(), max(order, USUAL))[: order + 1])

    def series(self, v: Values, order: int) -> Array:
        """Return the power series up to `order`, shape (order + 1, n, 3).

        With b = r' x r'':  B = b / |b|  and  (tau / kappa) T = (b . r''') |r'|^2 / |b|^3 r'.
        """
        r1 = slope(taylor(self.curve.jet(v, order + 3)))
        r2 = slope(r1)
        b = outer(r1, r2)[: order + 1]
        square = inner(b, b)
        lean = product(product(inner(b, slope(r2)), inner(r1, r1)), power(square, -1.0))
        return scaled(power(square, -0.5), b + scaled(lean, r1))

    def image(self, matrix: Rows, shift: Sequence[Fraction]) -> Curve:
        """Return matrix @ curve + shift."""
        return image(self, matrix, shift)

    def part(self, low: Fraction, high: Fraction) -> Curve:
        """Return the part over [low, high]."""
        return _facing(Rectifying(restrict(self.curve, low, high)), low, high)


@dataclass(frozen=True, slots=True, eq=False)
class Conjugate(ArrayValue):
    """n x T + mu T along the rulings of the envelope of the planes through a curve and across `normal`."""

    curve: Curve
    normal: Curve

    def jet(self, v: Values, order: int) -> Array:
        """Return value and derivatives up to `order`, shape (order + 1, n, 3)."""
        return derivatives(_kept(self, v.tobytes(), max(order, USUAL))[: order + 1])

    def series(self, v: Values, order: int) -> Array:
        """Return the power series up to `order`, shape (order + 1, n, 3).

        With m across the curve:  g = (m x m') |r'| / (|m| (m' . r'))  and  m' . r' = -m . r''.
        """
        r1 = slope(taylor(self.curve.jet(v, order + 2)))
        m = _perpendicular(taylor(self.normal.jet(v, order + 1)), r1)
        lengths = product(power(inner(r1, r1), 0.5), power(inner(m, m), -0.5))
        factor = product(lengths, power(inner(m, slope(r1)), -1.0))
        return scaled(-factor, outer(m, slope(m)))

    def image(self, matrix: Rows, shift: Sequence[Fraction]) -> Curve:
        """Return matrix @ curve + shift."""
        return image(self, matrix, shift)

    def part(self, low: Fraction, high: Fraction) -> Curve:
        """Return the part over [low, high]."""
        made = Conjugate(restrict(self.curve, low, high), restrict(self.normal, low, high))
        return _facing(made, low, high)


USUAL = 2
"""Frames of a patch ask for two derivatives of one edge and of the ruling, and for one of the other edge."""


@lru_cache(maxsize=4)
def _kept(ruling: Rectifying | Conjugate, v: bytes, order: int) -> Array:
    """Return the power series of a ruling; both edges of a strip ask for it at the same places, one after the other."""
    return locked(ruling.series(np.frombuffer(v), order))


def _perpendicular(n: Array, r1: Array) -> Array:
    """Return the part of n across the curve, times |r'|^2."""
    across: Array = scaled(inner(r1, r1), n) - scaled(inner(n, r1), r1)
    return across


@dataclass(frozen=True, slots=True, eq=False)
class Beside(ArrayValue):
    """A curve moved by a distance along its rulings."""

    curve: Curve
    ruling: Curve
    distance_mm: float

    def jet(self, v: Values, order: int) -> Array:
        """Return position and derivatives up to `order`, shape (order + 1, n, 3), mm."""
        moved: Array = self.curve.jet(v, order) + self.distance_mm * self.ruling.jet(v, order)
        return moved

    def image(self, matrix: Rows, shift: Sequence[Fraction]) -> Curve:
        """Return matrix @ curve + shift."""
        return image(self, matrix, shift)

    def part(self, low: Fraction, high: Fraction) -> Curve:
        """Return the part over [low, high]."""
        return Beside(restrict(self.curve, low, high), restrict(self.ruling, low, high), self.distance_mm)


@dataclass(frozen=True, slots=True, eq=False)
class Image(ArrayValue):
    """matrix @ curve + shift, by the values of the curve."""

    curve: Curve
    matrix: Matrix
    shift: Vector3

    def jet(self, v: Values, order: int) -> Array:
        """Return position and derivatives up to `order`, shape (order + 1, n, 3)."""
        jets: Array = self.curve.jet(v, order) @ self.matrix.T
        jets[0] += self.shift
        return jets

    def image(self, matrix: Rows, shift: Sequence[Fraction]) -> Curve:
        """Return matrix @ curve + shift."""
        m = float_rows(matrix)
        return Image(self.curve, m @ self.matrix, m @ self.shift + floats(shift))

    def part(self, low: Fraction, high: Fraction) -> Curve:
        """Return the part over [low, high]."""
        return Image(restrict(self.curve, low, high), self.matrix, self.shift)


def image(curve: Curve, matrix: Rows, shift: Sequence[Fraction]) -> Image:
    """Return matrix @ curve + shift, by the values of the curve."""
    return Image(curve, float_rows(matrix), floats(shift))


def multiple(curve: Curve, factor: float) -> Curve:
    """Return the curve's vectors times a number."""
    return Image(curve, factor * np.eye(3), np.zeros(3))


def _facing(ruling: Curve, low: Fraction, high: Fraction) -> Curve:
    """Return the rulings of a part; run backwards, a curve has its left on the other side."""
    return ruling if high > low else multiple(ruling, -1.0)


def swept(curve: Curve, ruling: Curve, start_mm: float, end_mm: float) -> RuledPatch:
    """Return the patch from one distance along the rulings to another."""
    return RuledPatch(
        Beside(curve, ruling, start_mm), Beside(curve, ruling, end_mm), multiple(ruling, end_mm - start_mm)
    )


def speed(curve: Curve, v: Values) -> Values:
    """Return |r'|, mm."""
    return norm(curve.jet(v, 1)[1])


def bend(curve: Curve, v: Values) -> Values:
    """Return the curvature of a curve, 1/mm."""
    _, r1, r2 = curve.jet(v, 2)
    curvature: Values = norm(cross3(r1, r2)) / norm(r1) ** 3
    return curvature


def normal_share(curve: Curve, normal: Curve, v: Values) -> Values:
    """Return the length of the part of n that is across the curve."""
    n, r1 = normal.jet(v, 0)[0], curve.jet(v, 1)[1]
    share: Values = norm(cross3(n, r1)) / norm(r1)
    return share


def turn(curve: Curve, normal: Curve, v: Values) -> Values:
    """Return how fast the unit normal across the curve turns, rad/mm."""
    m, r1, _ = _moving(curve, normal, v)
    rate: Values = norm(np.cross(m[0], m[1])) / (dot(m[0], m[0]) * norm(r1))
    return rate


def crossing_sine(curve: Curve, normal: Curve, v: Values) -> Values:
    """Return the sine of the angle between the ruling and the curve, NaN where the normal does not turn."""
    m, r1, r2 = _moving(curve, normal, v)
    with np.errstate(divide="ignore", invalid="ignore"):
        sine: Values = np.abs(dot(m[0], r2)) * norm(m[0]) / (norm(r1) * norm(np.cross(m[0], m[1])))
    return sine


def _moving(curve: Curve, normal: Curve, v: Values) -> tuple[Array, Array, Array]:
    """Return the normal across the curve with its derivative (times |r'|^2), r' and r''."""
    jets = curve.jet(v, 2)
    m = derivatives(_perpendicular(taylor(normal.jet(v, 1)), slope(taylor(jets))))
    return m, jets[1], jets[2]


def closing(curve: Curve, ruling: Curve, v: Values) -> Values:
    """Return c, 1/mm: the edge of regression lies at -1 / c along the rulings.

    From  (r' + t g') x g = (1 + t c) r' x g.
    """
    r1, g = curve.jet(v, 1)[1], ruling.jet(v, 1)
    side = cross3(r1, g[0])
    rate: Values = dot(cross3(g[1], g[0]), side) / dot(side, side)
    return rate


@dataclass(frozen=True, slots=True)
class Widest:
    """How wide one side of a strip may be, mm, infinite without an edge of regression, and where it is reached."""

    width_mm: float
    piece: int
    v: float


def room(curves: Sequence[Curve], rulings: Sequence[Curve]) -> tuple[Widest, Widest]:
    """Return how wide the strip may be along g and against it, up to the edge of regression (sampled)."""
    sides: tuple[list[Widest], list[Widest]] = [], []
    for piece, (curve, ruling) in enumerate(zip(curves, rulings, strict=True)):
        for side, (rate, v) in zip(sides, maxima(partial(_both, curve, ruling)), strict=True):
            side.append(Widest(1.0 / rate if rate > 0.0 else np.inf, piece, v))
    along, against = (min(side, key=lambda widest: widest.width_mm) for side in sides)
    return along, against


def _both(curve: Curve, ruling: Curve, v: Values) -> Array:
    """Return the rates at which both sides close, the side along g first, shape (n, 2)."""
    rate = closing(curve, ruling, v)
    return np.stack([-rate, rate], axis=1)
