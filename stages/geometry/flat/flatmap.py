"""Flat maps of ruled patches: what every map from a surface onto the plane can do.

A map is known by its positions; nothing that measures distortion asks how they were found.  `development` makes them
by unrolling along the rulings.

A position of a large part is good to the rounding of the part's size, and so is the difference of two; over a panel of
a hundredth of the part the derivative has lost two digits and those of the numerical differentiation.  A map therefore
gives the vectors between places of one panel (`chords`) as well, which need lose nothing.
"""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.polynomial import chebyshev

from stages.geometry.arrays import EPS, ArrayValue, Points2, Values, norm
from stages.geometry.ruled.ruled import RuledPatch


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

    def chords(self, u0: Values, v0: Values, u: Values, v: Values) -> Points2:
        """Return the vectors from the flat S(u0, v0) to the flat S(u, v), mm, both on one panel.

        The difference of `positions`, but good to the rounding of the panel's length where the map can: what measures
        differentiates these, and sees to it that they are that difference.
        """
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


@dataclass(frozen=True, slots=True, eq=False)
class DevelopedRuling(ArrayValue):
    """The flat ruling v = constant of one piece as a plane curve over t in [0, 1]; `reverse` runs it from u = 1 to 0.

    Straight where the piece is laid out along its rulings, slightly curved where it is flattened by least strain.
    """

    piece: FlatPiece
    v: float
    reverse: bool = False

    def at(self, t: Values) -> Points2:
        """Return the points at t, mm."""
        u = 1.0 - t if self.reverse else t
        return self.piece.positions(u, np.full_like(u, self.v))

    def derivative(self, t: Values) -> Points2:
        """Return d/dt of the points, mm: that of their polynomial through `RULING_NODES` places."""
        x = chebyshev.chebpts2(RULING_NODES)
        v, zero = np.full(RULING_NODES, self.v), np.zeros(RULING_NODES)
        series = np.linalg.solve(
            chebyshev.chebvander(x, RULING_NODES - 1), self.piece.chords(zero, v, (x + 1.0) / 2.0, v)
        )
        u = 1.0 - t if self.reverse else t
        slopes: Points2 = 2.0 * chebyshev.chebval(2.0 * u - 1.0, chebyshev.chebder(series)).T
        return -slopes if self.reverse else slopes

    def is_straight(self) -> bool:
        """Return whether the points run evenly along a straight line, but for rounding."""
        t = np.linspace(0.0, 1.0, RULING_NODES)
        points = self.at(t)
        away = norm(points - np.outer(1.0 - t, points[0]) - np.outer(t, points[-1]))
        corners = self.piece.positions(np.array([0.0, 1.0, 0.0, 1.0]), np.array([0.0, 0.0, 1.0, 1.0]))
        return bool(away.max() <= ROUNDED * norm(corners).max())


RULING_NODES = 26
"""Exact for flat rulings that are polynomials of a degree up to 25; those of least strain have at most 24."""
ROUNDED = 32 * EPS
"""Rounding of positions, as a share of the farthest corner's."""
