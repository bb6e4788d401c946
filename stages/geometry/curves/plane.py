"""Curves of the plane as the flat pattern is made of: what every exact edge can be asked, and the two simplest ones.

An edge runs over t in [0, 1].  `at` and `derivative` are exact to rounding; a straight edge and a circular one say so
by their type, so that a writer recovers lines and arcs one to one instead of fitting them.
"""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from stages.geometry.arrays import ArrayValue, Points2, Values, Vector2


@runtime_checkable
class PlaneCurve(Protocol):
    """An edge of a flat pattern: smooth on [0, 1] except at the ends, in mm."""

    def at(self, t: Values) -> Points2:
        """Return the points at t, in mm."""
        ...

    def derivative(self, t: Values) -> Points2:
        """Return d/dt of the points, in mm."""
        ...


@runtime_checkable
class Piecewise(PlaneCurve, Protocol):
    """A curve that is smooth to some order only at its breaks, which are values of t from 0 to 1."""

    @property
    def breaks(self) -> Values:
        """Where it is not smooth."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class Segment(ArrayValue):
    """A straight edge from `start` to `end`."""

    start: Vector2
    end: Vector2

    def at(self, t: Values) -> Points2:
        """Return the points at t, in mm; both ends are hit exactly."""
        return np.outer(1.0 - t, self.start) + np.outer(t, self.end)

    def derivative(self, t: Values) -> Points2:
        """Return d/dt of the points, in mm."""
        return np.broadcast_to(self.end - self.start, (t.size, 2)).copy()


@dataclass(frozen=True, slots=True, eq=False)
class CircularArc(ArrayValue):
    """An arc about `centre` from the angle `start_rad` through `sweep_rad` (positive: counter-clockwise)."""

    centre: Vector2
    radius: float
    start_rad: float
    sweep_rad: float

    def check(self) -> None:
        """Refuse a radius that is not positive."""
        if not self.radius > 0.0:
            raise ValueError(f"the radius of an arc must be positive: {self.radius}")

    def at(self, t: Values) -> Points2:
        """Return the points at t, in mm."""
        angle = self.start_rad + self.sweep_rad * t
        return self.centre + self.radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)

    def derivative(self, t: Values) -> Points2:
        """Return d/dt of the points, in mm."""
        angle = self.start_rad + self.sweep_rad * t
        return self.radius * self.sweep_rad * np.stack([-np.sin(angle), np.cos(angle)], axis=1)


@dataclass(frozen=True, slots=True, eq=False)
class Stretch(ArrayValue):
    """The part of an edge from t = `low` to t = `high`."""

    curve: PlaneCurve
    low: float
    high: float

    def at(self, t: Values) -> Points2:
        """Return the points at t, in mm."""
        return self.curve.at(self.low + (self.high - self.low) * t)

    def derivative(self, t: Values) -> Points2:
        """Return d/dt of the points, in mm."""
        return (self.high - self.low) * self.curve.derivative(self.low + (self.high - self.low) * t)


def stretch(edge: PlaneCurve, low: float, high: float) -> PlaneCurve:
    """Return the part of an edge from t = `low` to t = `high`; straight edges and arcs stay what they are."""
    if (low, high) == (0.0, 1.0):
        return edge
    if isinstance(edge, Segment):
        start, end = edge.at(np.array([low, high]))
        return Segment(start, end)
    if isinstance(edge, CircularArc):
        sweep = edge.sweep_rad
        return CircularArc(edge.centre, edge.radius, edge.start_rad + low * sweep, (high - low) * sweep)
    return Stretch(edge, low, high)
