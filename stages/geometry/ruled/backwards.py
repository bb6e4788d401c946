"""Curves and ruled patches run the other way round, and patches with their edges exchanged.

What carries its data exactly (Bezier, rational, circular) is turned in them; any other curve is evaluated at 1 - v.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from stages.geometry.arrays import Array, ArrayValue, Values
from stages.geometry.curves.curves import Along, Bezier, Circular, Curve, Difference, RationalBezier, affine, restrict
from stages.geometry.ruled.ruled import RuledPatch

WHOLE = Fraction(0), Fraction(1)


@dataclass(frozen=True, slots=True, eq=False)
class Backwards(ArrayValue):
    """A curve run the other way round: its value at v is that of `curve` at 1 - v."""

    curve: Curve

    def jet(self, v: Values, order: int) -> Array:
        """Return position and derivatives up to `order`, shape (order + 1, n, 3)."""
        signs = (-1.0) ** np.arange(order + 1)
        turned: Array = signs[:, None, None] * self.curve.jet(1.0 - v, order)
        return turned

    def image(self, matrix: Sequence[Sequence[Fraction]], shift: Sequence[Fraction]) -> Curve:
        """Return matrix @ curve + shift."""
        return Backwards(affine(self.curve, matrix, shift))

    def part(self, low: Fraction, high: Fraction) -> Curve:
        """Return the part over [low, high]; over [1, 0] that is the curve itself again."""
        if (low, high) == WHOLE[::-1]:
            return self.curve
        return Backwards(restrict(self.curve, 1 - high, 1 - low))


def backwards(curve: Curve) -> Curve:
    """Return the curve run from its end to its start."""
    match curve:
        case Difference():
            return Difference(backwards(curve.a), backwards(curve.b))
        case Along():
            return Along(backwards(curve.distance), curve.direction)
        case Bezier() | RationalBezier() | Circular() | Backwards():
            return restrict(curve, *WHOLE[::-1])
    return Backwards(curve)


def opposite(curve: Curve) -> Curve:
    """Return minus the curve."""
    match curve:
        case Difference():
            return Difference(curve.b, curve.a)
        case Along():
            return Along(curve.distance, -curve.direction)
    return affine(curve, NEGATIVE, (Fraction(0),) * 3)


NEGATIVE = tuple(tuple(Fraction(-(i == j)) for j in range(3)) for i in range(3))


def reversed_patch(patch: RuledPatch) -> RuledPatch:
    """Return the patch with its rulings in the opposite order."""
    return RuledPatch(backwards(patch.c0), backwards(patch.c1), backwards(patch.p))


def exchanged(patch: RuledPatch) -> RuledPatch:
    """Return the patch with its edges exchanged: every ruling points the other way."""
    return RuledPatch(patch.c1, patch.c0, opposite(patch.p))
