"""The curve at a distance to the right of an edge: p + d n, n the unit normal on the right of the direction of travel.

The parallel of a line is a line, that of an arc an arc about the same centre.  That of any other edge is evaluated
through the edge itself; its derivative p' + d n' takes n' from the Legendre series of n, which is resolved to rounding
on panels of t (`quadrature`).  Where d is more than the radius of a hollow the parallel turns back on itself: the least
radius is measured at the nodes of those panels, which resolve it, and the parallel is refused.

Not for edges whose direction jumps inside.
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from stages.geometry.arrays import Array, ArrayValue, Points2, Values, Vector2, cross2, norm, unit
from stages.geometry.curves.plane import CircularArc, PlaneCurve, Segment
from stages.geometry.numeric import quadrature

BESIDE = 1e-6
"""How far inside an end, in t, the direction is looked for where the derivative vanishes or is not finite."""


@dataclass(frozen=True, slots=True, eq=False)
class Hollow(ArrayValue):
    """Where an edge is too hollow for a parallel at a distance: the place on the edge and its radius there, mm."""

    at: Vector2
    radius_mm: float


@dataclass(frozen=True, slots=True, eq=False)
class Parallel(ArrayValue):
    """The parallel of an edge that is neither straight nor an arc.

    breaks: ends of the panels in t, (m + 1,).  slopes: Legendre coefficients of dn/dt on them, (m, order, 2).
    """

    curve: PlaneCurve
    distance_mm: float
    breaks: Values
    slopes: Array

    def at(self, t: Values) -> Points2:
        """Return the points at t, mm."""
        return self.curve.at(t) + self.distance_mm * normals(self.curve, t)

    def derivative(self, t: Values) -> Points2:
        """Return d/dt of the points, mm."""
        panel = np.clip(np.searchsorted(self.breaks, t, side="right") - 1, 0, self.breaks.size - 2)
        low, high = self.breaks[panel], self.breaks[panel + 1]
        basis = legendre.legvander((2.0 * t - low - high) / (high - low), self.slopes.shape[1] - 1)
        turning: Points2 = np.einsum("nk,nkc->nc", basis, self.slopes[panel])
        return _finite(self.curve, t) + self.distance_mm * turning


def normals(edge: PlaneCurve, t: Values) -> Points2:
    """Return the unit normals on the right of an edge."""
    along = unit(_finite(edge, t))
    return np.stack([along[:, 1], -along[:, 0]], axis=1)


def _finite(edge: PlaneCurve, t: Values) -> Points2:
    """Return the derivative, from just inside where it vanishes or is not finite at an end."""
    slopes = edge.derivative(t)
    lost = ~np.isfinite(slopes).all(axis=1) | (norm(np.nan_to_num(slopes)) == 0.0)
    if lost.any():
        slopes[lost] = edge.derivative(np.clip(t[lost], BESIDE, 1.0 - BESIDE))
    return slopes


def parallel(edge: PlaneCurve, distance_mm: float) -> PlaneCurve | Hollow:
    """Return the parallel at a distance to the right, or where the edge is too hollow for it.

    Raises NoSolutionError where the direction of the edge is not resolved.
    """
    if distance_mm == 0.0:
        return edge
    if isinstance(edge, Segment):
        (right,) = normals(edge, np.zeros(1))
        return Segment(edge.start + distance_mm * right, edge.end + distance_mm * right)
    if isinstance(edge, CircularArc):
        radius = edge.radius + np.copysign(distance_mm, edge.sweep_rad * distance_mm)
        if radius <= 0.0:
            return Hollow(edge.at(np.array([0.5]))[0], edge.radius)
        return CircularArc(edge.centre, radius, edge.start_rad, edge.sweep_rad)
    return _general(edge, distance_mm)


def _general(edge: PlaneCurve, distance_mm: float) -> Parallel | Hollow:
    """Return the parallel of any other edge."""
    breaks, values = quadrature.panels(lambda t: normals(edge, t), "direction along an edge")
    series = quadrature.coefficients(values)
    halves = np.diff(breaks) / 2.0
    slopes: Array = np.asarray(legendre.legder(series, axis=1)) / halves[:, None, None]
    made = Parallel(edge, distance_mm, breaks, slopes)
    t = np.concatenate([[0.0], quadrature.nodes(breaks[:-1], breaks[1:]).ravel(), [1.0]])
    speed, stretched = _finite(edge, t), made.derivative(t)
    # along the edge the parallel advances by 1 + d k of it; k < 0 where the edge is hollow on the right
    share = np.einsum("ij,ij->i", stretched, speed) / np.einsum("ij,ij->i", speed, speed)
    worst = int(np.argmin(share))
    if share[worst] <= 0.0:
        return Hollow(edge.at(t[worst : worst + 1])[0], abs(distance_mm / (1.0 - float(share[worst]))))
    return made


def crossing(one: PlaneCurve, other: PlaneCurve) -> tuple[float, float] | None:
    """Return t on both edges where they cross: the last crossing on `one`; None if they do not.

    By the chords of `SAMPLES` points on each and Newton's method from there.
    """
    t = np.linspace(0.0, 1.0, SAMPLES)
    found = _chords_cross(one.at(t), other.at(t))
    for i, j, share_one, share_other in found:
        place = np.array([i + share_one, j + share_other]) / (SAMPLES - 1)
        met = _newton(one, other, place)
        if met is not None:
            return met
    return None


SAMPLES = 257
"""Points of each edge: crossings closer together than 1/256 of an edge are one."""
STEPS = 30
"""Newton's method takes some five from a crossing of chords; edges that nearly touch take more."""
MET_MM = 1e-10
"""Crossings are met to the rounding of points 10 m from the origin, fifty times over."""


def _chords_cross(one: Points2, other: Points2) -> list[tuple[int, int, float, float]]:
    """Return the chords of two polygons that cross and the shares of both, the last on the first polygon first."""
    a, along = one[:-1, None], np.diff(one, axis=0)[:, None]
    b, across = other[None, :-1], np.diff(other, axis=0)[None]
    turn = cross2(along, across)
    with np.errstate(divide="ignore", invalid="ignore"):
        share_one, share_other = cross2(b - a, across) / turn, cross2(b - a, along) / turn
    met = (np.abs(share_one - 0.5) <= HALF) & (np.abs(share_other - 0.5) <= HALF)
    places = [(int(i), int(j), float(share_one[i, j]), float(share_other[i, j])) for i, j in np.argwhere(met)]
    return sorted(places, key=lambda place: (-place[0] - place[2], place[1] + place[3]))


HALF = 0.5 + 1e-6
"""A crossing may be beyond the end of a chord by rounding; Newton's method decides."""


def _newton(one: PlaneCurve, other: PlaneCurve, place: Array) -> tuple[float, float] | None:
    """Return where two edges meet, from near there."""
    for _ in range(STEPS):
        place = np.clip(place, 0.0, 1.0)
        off = other.at(place[1:])[0] - one.at(place[:1])[0]
        if norm(off) <= MET_MM:
            return float(place[0]), float(place[1])
        matrix = np.stack([one.derivative(place[:1])[0], -other.derivative(place[1:])[0]], axis=1)
        if np.linalg.det(matrix) == 0.0:
            return None
        place = place + np.linalg.solve(matrix, off)
    return None
