"""Rigid motions of the plane between edges, and flat maps moved by them.

A motion is kept as cosine, sine and shift, as it follows from two edges: an angle in degrees would add its own
rounding.  Moving a map moves its coefficients: what is moved is as exact as what is not.
"""

from dataclasses import dataclass, replace

import numpy as np

from stages.geometry.arrays import Array, ArrayValue, Points2, Vector2, cross2, norm
from stages.geometry.flat.development import RulingMap
from stages.geometry.flat.flatmap import Development, FlatPiece


@dataclass(frozen=True, slots=True, eq=False)
class Motion(ArrayValue):
    """A turn by the angle of which `cos` and `sin` are given, then a shift, mm."""

    cos: float
    sin: float
    shift: Vector2

    def vectors(self, given: Array) -> Array:
        """Return vectors turned, shape (..., 2)."""
        turned: Array = given @ np.array([[self.cos, self.sin], [-self.sin, self.cos]])
        return turned

    def points(self, given: Points2) -> Points2:
        """Return points moved."""
        moved_: Points2 = self.vectors(given) + self.shift
        return moved_


STILL = Motion(1.0, 0.0, np.zeros(2))
"""The motion that moves nothing."""


def after(second: Motion, first: Motion) -> Motion:
    """Return the motion that does the first and then the second."""
    cos = second.cos * first.cos - second.sin * first.sin
    sin = second.sin * first.cos + second.cos * first.sin
    return Motion(cos, sin, second.vectors(first.shift) + second.shift)


def onto(ends: Points2, target: Points2) -> Motion:
    """Return the motion that lays an edge along another one, start on start: their middles meet exactly.

    ends, target: of the two edges, shape (2, 2), mm; neither of no length.
    """
    step, wanted = ends[1] - ends[0], target[1] - target[0]
    long = float(norm(step) * norm(wanted))
    cos, sin = float(step @ wanted) / long, float(cross2(step, wanted)) / long
    size = float(np.hypot(cos, sin))
    turn = Motion(cos / size, sin / size, np.zeros(2))
    return replace(turn, shift=target.mean(axis=0) - turn.vectors(ends.mean(axis=0)))


def moved(development: Development, motion: Motion) -> Development:
    """Return a map along rulings moved."""
    return Development(tuple(_moved(piece, motion) for piece in development.pieces))


def _moved(piece: FlatPiece, motion: Motion) -> RulingMap:
    if not isinstance(piece, RulingMap):
        raise ValueError(f"no way to move a {type(piece).__name__}")
    phi, starts = piece.phi.copy(), motion.vectors(piece.starts)
    phi[:, 0] += np.arctan2(motion.sin, motion.cos)
    starts[:, 0] += motion.shift
    return RulingMap(piece.patch, piece.breaks, phi, starts, motion.vectors(piece.steps))
