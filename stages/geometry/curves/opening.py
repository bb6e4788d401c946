"""The opening that a round branch leaves in a round main, developed with the main.

The main of radius rho has its axis along x.  The branch's surface, of radius r about an axis at the angle `angle` to x
and at the distance `middle` along y, meets it where

    h = middle + r cos b,   z = sqrt(rho^2 - h^2),   X = z cot(angle) - r sin(b) / sin(angle),   Y = rho atan2(h, z):

X along the main and Y around it from its crown, seen from outside; b = start + v sweep runs counter-clockwise.  With

    z = F G,  F^2 = (rho - middle - r) + 2 r sin(b/2)^2,  G^2 = (rho + middle - r) + 2 r cos(b/2)^2

(see `halfchord`) the slopes are Y' = rho h' / z and z' = -h h' / z with h' / z = -2 r (sin(b/2) / F) (cos(b/2) / G): no
digits are lost, however nearly the branch touches the main's side.  Where it does touch (an excess in brackets is 0)
F is a multiple of |sin(b/2)|, and the opening has a corner, at which it must be split.

Not for a branch that misses the main: z is not a number there.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from math import cos, pi, sin, tan

import numpy as np

from stages.geometry.arrays import Array, ArrayValue, Points2, Values
from stages.geometry.curves.halfchord import excess


@dataclass(frozen=True, slots=True, eq=False)
class Opening(ArrayValue):
    """A part of the developed opening over which the branch touches the main's sides at most at its ends; mm, rad."""

    main: float
    branch: float
    middle: float
    angle: float
    start: float
    sweep: float

    def at(self, t: Values) -> Points2:
        """Return the points at t, mm."""
        b = self.start + t * self.sweep
        h = self._height(b)
        z = self._root(b, 0.0, np.sin) * self._root(b, pi, np.cos)
        return np.stack(
            [z / tan(self.angle) - self.branch * np.sin(b) / sin(self.angle), self.main * np.arctan2(h, z)], axis=1
        )

    def derivative(self, t: Values) -> Points2:
        """Return d/dt of the points, mm."""
        b = self.start + t * self.sweep
        turn = -2.0 * self.branch * self._share(b, 0.0, np.sin) * self._share(b, pi, np.cos)
        along = -self._height(b) * turn / tan(self.angle) - self.branch * np.cos(b) / sin(self.angle)
        return self.sweep * np.stack([along, self.main * turn], axis=1)

    def _height(self, b: Values) -> Values:
        height: Values = self.middle + self.branch * np.cos(b)
        return height

    def _excess(self, side: float) -> float:
        """Return how far the branch stays inside the main's side at y > 0 (side 0) or y < 0 (side pi), mm."""
        return excess(self.main, self.middle * cos(side), self.branch)

    def _root(self, b: Values, side: float, wave: "Wave") -> Values:
        """Return F or G."""
        left = self._excess(side)
        if left == 0.0:
            touching: Values = np.sqrt(2.0 * self.branch) * self._sign(wave) * wave(b / 2.0)
            return touching
        root: Values = np.sqrt(left + 2.0 * self.branch * wave(b / 2.0) ** 2)
        return root

    def _share(self, b: Values, side: float, wave: "Wave") -> Values:
        """Return sin(b/2) / F or cos(b/2) / G."""
        if self._excess(side) == 0.0:
            return np.full_like(b, self._sign(wave) / np.sqrt(2.0 * self.branch))
        share: Values = wave(b / 2.0) / self._root(b, side, wave)
        return share

    def _sign(self, wave: "Wave") -> float:
        middle = np.array([(self.start + self.sweep / 2.0) / 2.0])
        return float(np.sign(wave(middle)[0]))


Wave = Callable[[Array], Array]
"""Sine or cosine."""


def opening(main: float, branch: float, middle: float, angle: float) -> tuple[Opening, ...]:
    """Return the whole opening, counter-clockwise, split where the branch touches a side of the main; radii in mm."""
    upper, lower = excess(main, middle, branch) == 0.0, excess(main, -middle, branch) == 0.0
    first = 0.0 if upper else -pi
    cuts = [first, pi, first + 2.0 * pi] if upper and lower else [first, first + 2.0 * pi]
    return tuple(Opening(main, branch, middle, angle, low, high - low) for low, high in pairwise(cuts))
