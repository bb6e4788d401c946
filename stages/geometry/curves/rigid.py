"""Rigid motions of the plane, with an optional mirror first: x -> R (M x) + d.

Quarter turns are exact: their sines and cosines are 0 and +-1, not 6e-17.
"""

from dataclasses import dataclass
from math import cos, radians, sin

import numpy as np

from stages.geometry.arrays import Array, ArrayValue, Matrix

QUARTER_TURNS = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), 180.0: (-1.0, 0.0), 270.0: (0.0, -1.0)}


@dataclass(frozen=True, slots=True, eq=False)
class Rigid2(ArrayValue):
    """Mirror (x to -x) if `mirrored`, turn by `angle_deg` counter-clockwise, then move by (x, y) in mm."""

    x: float = 0.0
    y: float = 0.0
    angle_deg: float = 0.0
    mirrored: bool = False

    def check(self) -> None:
        """Refuse what is not finite."""
        if not np.isfinite([self.x, self.y, self.angle_deg]).all():
            raise ValueError(f"a placement must be finite: {self.x}, {self.y}, {self.angle_deg}")


def matrix(motion: Rigid2) -> Matrix:
    """Return the linear part, shape (2, 2): turn times mirror."""
    c, s = QUARTER_TURNS.get(motion.angle_deg % 360.0) or (
        cos(radians(motion.angle_deg)),
        sin(radians(motion.angle_deg)),
    )
    mirror = -1.0 if motion.mirrored else 1.0
    return np.array([[c * mirror, -s], [s * mirror, c]])


def apply(motion: Rigid2, points: Array) -> Array:
    """Return the moved points, shape (..., 2)."""
    moved: Array = points @ matrix(motion).T + np.array([motion.x, motion.y])
    return moved
