"""The lines and arcs of a path as edges: what a path that was read from a file says of its own exact outline.

An arc is evaluated from its chord and sweep, as everywhere (`arcpath`): its centre may be far away.
"""

from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import ArrayValue, Points2, Values
from stages.geometry.curves.plane import PlaneCurve, Segment
from stages.geometry.paths.arcpath import ArcPath, along, chords, directions, lengths, piece_count, sweeps


@dataclass(frozen=True, slots=True, eq=False)
class PathPiece(ArrayValue):
    """A path of one piece as an edge, run through at constant speed."""

    path: ArcPath

    def at(self, t: Values) -> Points2:
        """Return the points at t, in mm."""
        points: Points2 = along(self.path, np.zeros(t.size, dtype=np.int64), t)
        return points

    def derivative(self, t: Values) -> Points2:
        """Return d/dt of the points, in mm."""
        first, _ = directions(self.path)
        angle = first[0] + sweeps(self.path)[0] * t
        return float(lengths(self.path)[0]) * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def edges_of(path: ArcPath) -> tuple[PlaneCurve, ...]:
    """Return the pieces of a path in order: straight ones as segments."""
    start, end = chords(path)
    return tuple(_edge(path, start[i], end[i], i) for i in range(piece_count(path)))


def _edge(path: ArcPath, start: Values, end: Values, number: int) -> PlaneCurve:
    """Return one piece."""
    if sweeps(path)[number] == 0.0:
        return Segment(start, end)
    return PathPiece(ArcPath(np.stack([start, end]), np.array([path.bulges[number], 0.0]), closed=False))
