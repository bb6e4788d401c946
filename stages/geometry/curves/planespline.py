"""Cubic splines through points of the plane (C2, chord-length parameter), as edges of a pattern."""

from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Array, ArrayValue, Points2, Values, Vector2, norm
from stages.geometry.curves.plane import PlaneCurve, Segment


@dataclass(frozen=True, slots=True, eq=False)
class Spline(ArrayValue):
    """A C2 cubic spline over t in [0, 1].

    breaks: shape (n + 1,), from 0 to 1.
    powers: shape (4, n, 2): coefficients of (t - break)^3 ... (t - break)^0, mm.
    """

    breaks: Values
    powers: Array

    def at(self, t: Values) -> Points2:
        """Return the points at t, in mm."""
        x, (a, b, c, d) = self._local(t)
        points: Points2 = ((a * x + b) * x + c) * x + d
        return points

    def derivative(self, t: Values) -> Points2:
        """Return d/dt of the points, in mm."""
        x, (a, b, c, _) = self._local(t)
        rates: Points2 = (3.0 * a * x + 2.0 * b) * x + c
        return rates

    def _local(self, t: Values) -> tuple[Array, Array]:
        piece = np.clip(np.searchsorted(self.breaks, t, side="right") - 1, 0, self.breaks.size - 2)
        return (t - self.breaks[piece])[:, None], self.powers[:, piece]


def spline(
    points: Points2, directions: tuple[Vector2 | None, Vector2 | None] = (None, None), *, periodic: bool = False
) -> PlaneCurve:
    """Return the cubic spline through points; its ends keep the directions given, else the third derivative runs on."""
    from scipy.interpolate import CubicSpline

    steps = norm(np.diff(points, axis=0))
    at = np.concatenate([[0.0], np.cumsum(steps)])
    if len(points) == 2:  # noqa: PLR2004 -- a chord
        return Segment(points[0], points[1])
    ends = [(1, direction) if direction is not None else "not-a-knot" for direction in directions]
    rule: object = "periodic" if periodic else tuple(ends)
    made = CubicSpline(at, points, axis=0, bc_type=rule)
    powers = made.c * at[-1] ** np.arange(3, -1, -1)[:, None, None]
    return Spline(made.x / at[-1], powers)
