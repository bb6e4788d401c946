"""Flat maps of ruled patches: what every map from a surface onto the plane can do.

A map is known by its positions; nothing that measures distortion asks how they were found.  `development` makes them
by unrolling along the rulings.
"""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from stages.geometry.arrays import ArrayValue, Points2, Values
from stages.geometry.ruled import RuledPatch


@runtime_checkable
class FlatPiece(Protocol):
    """One patch, flat.  `breaks` are the ends in v, shape (m + 1,), of the panels on which positions are smooth."""

    @property
    def patch(self) -> RuledPatch:
        """The patch that is mapped."""
        ...

    @property
    def breaks(self) -> Values:
        """Ends of the panels in v, from 0 to 1."""
        ...

    def positions(self, u: Values, v: Values) -> Points2:
        """Return the flat positions of S(u, v), mm: what every later stage sees of the surface."""
        ...

    def velocities(self, u: Values, v: Values) -> Points2:
        """Return d/dv of the flat positions, mm: for directions, never for measuring distortion."""
        ...


@dataclass(frozen=True, slots=True)
class Development:
    """The pieces of a strip, flat, in one frame.

    c0(0) is at the origin and the first ruling along +x; the last one if the first has no length.
    """

    pieces: tuple[FlatPiece, ...]


@dataclass(frozen=True, slots=True, eq=False)
class DevelopedEdge(ArrayValue):
    """The flat edge u = constant of one piece as a plane curve over t in [0, 1]; `reverse` runs it from v = 1 to 0."""

    piece: FlatPiece
    u: float
    reverse: bool = False

    def at(self, t: Values) -> Points2:
        """Return the points at t, mm."""
        v = 1.0 - t if self.reverse else t
        return self.piece.positions(np.full_like(v, self.u), v)

    def derivative(self, t: Values) -> Points2:
        """Return d/dt of the points, mm."""
        v = 1.0 - t if self.reverse else t
        sign = -1.0 if self.reverse else 1.0
        return sign * self.piece.velocities(np.full_like(v, self.u), v)
