"""Half the chord that a round pipe cuts from parallel lines which start on a circle or an ellipse.

A line at the distance h from the axis of a pipe of radius rho stays inside for 2 sqrt(rho^2 - h^2), if it crosses the
axis at a right angle.  Lines from the points of a turning a = start + v sweep have h = middle + reach cos(a), and

    rho - h = (rho - middle - reach) + 2 reach sin(a / 2)^2,
    rho + h = (rho + middle - reach) + 2 reach cos(a / 2)^2:

sums that do not cancel, however nearly a line touches the pipe.  Where an excess (in brackets) is 0, lines do touch it;
the root is then a multiple of |sin| or |cos|, smooth on every piece between the touching lines.

Derivatives of any order by the power series of a square root.  Not for a line that misses the pipe: its half chord is
not a number.
"""

from dataclasses import dataclass
from math import pi, sin

import numpy as np

from stages.geometry.arrays import EPS, Array, ArrayValue, Values
from stages.geometry.numeric.series import derivatives, power, product, taylor

TOUCHING = 8 * EPS
"""An excess below this share of the radius is the rounding of what it is the difference of."""


@dataclass(frozen=True, slots=True, eq=False)
class HalfChord(ArrayValue):
    """scale sqrt((below + 2 reach sin(a/2)^2) (above + 2 reach cos(a/2)^2)) as the first coordinate of a curve.

    below, above: the excesses rho - middle - reach and rho + middle - reach, mm; 0 where lines touch the pipe.
    a = start + v sweep, rad.  On a piece on which lines touch, none does but at its ends.
    """

    below: float
    above: float
    reach: float
    scale: float
    start: float
    sweep: float

    def jet(self, v: Values, order: int) -> Array:
        """Return value and derivatives up to `order`, shape (order + 1, n, 3); the last two coordinates are 0."""
        first = self._factor(self.below, 0.0, v, order)
        second = self._factor(self.above, pi / 2.0, v, order)
        jets = np.zeros((order + 1, v.size, 3))
        jets[..., 0] = self.scale * derivatives(product(first, second))
        return jets

    def _factor(self, excess: float, ahead: float, v: Values, order: int) -> Array:
        """Return the power series of sqrt(excess + 2 reach sin(a/2 + ahead)^2), shape (order + 1, n)."""
        half = self.start / 2.0 + ahead
        rate = self.sweep / 2.0
        wave = taylor(np.stack([rate**k * np.sin(half + v * rate + k * pi / 2.0) for k in range(order + 1)]))
        if excess == 0.0:
            touching: Array = np.sign(sin(half + rate / 2.0)) * np.sqrt(2.0 * self.reach) * wave
            return touching
        square = 2.0 * self.reach * product(wave, wave)
        square[0] += excess
        return power(square, 0.5)


def excess(radius: float, middle: float, reach: float) -> float:
    """Return radius - middle - reach, mm, 0 where that is rounding."""
    left = radius - middle - reach
    return 0.0 if abs(left) <= TOUCHING * (radius + abs(middle) + reach) else left
