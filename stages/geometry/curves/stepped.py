"""Curves that reach a share of the way along rulings, the share a quotient that varies from ruling to ruling.

    c(v) = origin(v) + s(v) vector(v),    s = above / below:

where a plane n . x = h meets the rulings from `origin` along `vector`, above = h - n . origin and below = n . vector.
The rulings between two such curves are (s1 - s0) vector.  Derivatives of any order by the power series of the quotient.
Not for a share whose denominator vanishes: it is not finite there.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from stages.geometry.arrays import Array, ArrayValue, Values
from stages.geometry.curves.curves import Curve, affine, bezier, restrict
from stages.geometry.numeric.series import derivatives, power, product, scaled, taylor


@dataclass(frozen=True, slots=True, eq=False)
class Share(ArrayValue):
    """above / below, each the first coordinate of a curve."""

    above: Curve
    below: Curve

    def series(self, v: Values, order: int) -> Array:
        """Return the power series of the share, shape (order + 1, n)."""
        above, below = (taylor(curve.jet(v, order)[..., 0]) for curve in (self.above, self.below))
        return product(above, power(below, -1.0))

    def at(self, v: Values) -> Values:
        """Return the share at v."""
        values: Values = self.series(v, 0)[0]
        return values

    def part(self, low: Fraction, high: Fraction) -> "Share":
        """Return the share over [low, high], with its parameter again in [0, 1]."""
        return Share(restrict(self.above, low, high), restrict(self.below, low, high))


def constant(value: Fraction) -> Share:
    """Return the same share on every ruling."""
    none = Fraction(0)
    return Share(bezier([(value, none, none)]), bezier([(Fraction(1), none, none)]))


@dataclass(frozen=True, slots=True, eq=False)
class Stepped(ArrayValue):
    """origin + (share - less) vector, less: 0 if None.  With the origin at 0: rulings between two such curves."""

    origin: Curve
    vector: Curve
    share: Share
    less: Share | None = None

    def jet(self, v: Values, order: int) -> Array:
        """Return position and derivatives up to `order`, shape (order + 1, n, 3), mm."""
        share = self.share.series(v, order)
        if self.less is not None:
            share -= self.less.series(v, order)
        step = derivatives(scaled(share, taylor(self.vector.jet(v, order))))
        return np.asarray(self.origin.jet(v, order) + step)

    def image(self, matrix: Sequence[Sequence[Fraction]], shift: Sequence[Fraction]) -> Curve:
        """Return matrix @ curve + shift."""
        turned = affine(self.vector, matrix, (Fraction(0),) * 3)
        return Stepped(affine(self.origin, matrix, shift), turned, self.share, self.less)

    def part(self, low: Fraction, high: Fraction) -> Curve:
        """Return the part over [low, high], with its parameter again in [0, 1]."""
        origin, vector = restrict(self.origin, low, high), restrict(self.vector, low, high)
        less = None if self.less is None else self.less.part(low, high)
        return Stepped(origin, vector, self.share.part(low, high), less)
