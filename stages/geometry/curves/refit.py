"""Smooth edges through the corner points of a polygon that stands for a smooth outline: what a mesh's boundary was.

A mesh keeps points of its boundary and loses the curves between them.  They are put back:

1. Corners (`planecorners`).
2. Straight stretches and circular ones, as far as their points are straight or on a circle within `accuracy`.
3. Cubic splines (`planespline`) through what is left; they begin and end in the directions of their straight or
   circular neighbours.

Two things are told, both measured: how far the edges leave the polygon, and how far they would move if every other
point were unknown, of which a quarter is what they are worth between the points at most (`LEFT`).
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import radians, tau

import numpy as np

from stages.geometry.arrays import Numbers, Points2, Vector2, cross2, norm
from stages.geometry.curves.plane import CircularArc, PlaneCurve, Segment
from stages.geometry.curves.planecorners import corners
from stages.geometry.curves.planespline import Spline, spline

LEAST_STRAIGHT = 4
"""Points that make a straight stretch: three are straight wherever a curve turns over."""

LEAST_ROUND, LEAST_SWEEP = 7, radians(15.0)
"""Points, and turning, that make a circular stretch: fewer are on a circle within the accuracy by accident."""

LEAST_SPLINE = 5
"""Points below which every other one is no curve."""

LEFT = 0.25
"""Share of the change from twice the spacing that is left at this spacing: 1/15 where points are even (the error of
cubic splines falls with the fourth power), up to 0.2 seen where distances differ ninefold."""


@dataclass(frozen=True, slots=True)
class Refitted:
    """Edges end to end around a closed outline, and how they lie to its points.

    at: for each edge the number of the point at which it begins.
    sagitta_mm: how far the edges leave the polygon, at most.
    uncertainty_mm: what they are worth between the points, estimated from every other point.
    """

    edges: tuple[PlaneCurve, ...]
    at: tuple[int, ...]
    sagitta_mm: float
    uncertainty_mm: float


@dataclass(frozen=True, slots=True)
class _Piece:
    """An edge, and the numbers of the first and last point that it joins."""

    low: int
    high: int
    edge: PlaneCurve


def refitted(points: Points2, *, accuracy: float) -> Refitted:
    """Return smooth edges through the corner points of a closed polygon (the first is not repeated), mm.

    accuracy: how far the points may lie from where they belong, mm; straight and circular edges pass within it of their
        points, splines through theirs.
    """
    edges: list[PlaneCurve] = []
    starts: list[int] = []
    sagitta = uncertainty = 0.0
    for between in _runs(points, corners(points)):
        run, pieces = _smooth(points, between, accuracy)
        for piece in pieces:
            joined = points[run[piece.low : piece.high + 1]]
            edges.append(piece.edge)
            starts.append(int(run[piece.low]))
            sagitta = max(sagitta, _off_chords(piece.edge, joined))
            uncertainty = max(uncertainty, _uncertainty(piece.edge, joined))
    return Refitted(tuple(edges), tuple(starts), sagitta, uncertainty)


def _runs(points: Points2, at: Numbers) -> list[Numbers]:
    """Return the numbers of the points from corner to corner; all of them, closed, where there is none."""
    count = len(points)
    if at.size == 0:
        return [np.arange(count + 1) % count]
    ends = [*at[1:], at[0] + count]
    return [np.arange(low, high + 1) % count for low, high in zip(at, ends, strict=True)]


def _smooth(points: Points2, run: Numbers, accuracy: float) -> tuple[Numbers, list[_Piece]]:
    """Return the edges of one run between two corners, and the run, which begins elsewhere if it is closed."""
    closed = run[0] == run[-1]
    if closed and (ring := _circle(points[run], accuracy)) is not None:
        return run, [_Piece(0, len(run) - 1, ring)]
    known = _stretches(points[run], accuracy)
    if closed and not known:
        return run, [_Piece(0, len(run) - 1, spline(points[run], periodic=True))]
    if closed:
        shift = known[0].high
        run = np.concatenate([run[shift:], run[1 : shift + 1]])
        known = _stretches(points[run], accuracy)
    return run, _filled(points[run], known)


def _filled(points: Points2, known: list[_Piece]) -> list[_Piece]:
    """Return straight and circular stretches with splines between them that keep their directions."""
    last = len(points) - 1
    pieces: list[_Piece] = []
    at, leaving = 0, None
    for stretch in [*known, None]:
        low = last if stretch is None else stretch.low
        arriving = None if stretch is None else _tangent(stretch.edge, 0.0)
        if low > at:
            pieces.append(_Piece(at, low, spline(points[at : low + 1], (leaving, arriving))))
        if stretch is not None:
            pieces.append(stretch)
            at, leaving = stretch.high, _tangent(stretch.edge, 1.0)
    return pieces


def _tangent(edge: PlaneCurve, t: float) -> Vector2:
    """Return the unit direction of an edge at one of its ends."""
    rate: Vector2 = edge.derivative(np.array([t]))[0]
    return rate / float(norm(rate))


def _stretches(points: Points2, accuracy: float) -> list[_Piece]:
    """Return the straight and the circular stretches of a run, each as long as it can be, without overlap."""
    last = len(points) - 1
    if last < LEAST_STRAIGHT - 1:
        return [_Piece(0, last, Segment(points[0], points[-1]))] if _is_straight(points, accuracy) else []
    found: list[_Piece] = []
    at = 0
    while at < last:
        straight = _farthest(points, at, accuracy, _is_straight, LEAST_STRAIGHT)
        curved = _farthest(points, at, accuracy, _is_round, LEAST_ROUND)
        if curved > straight and abs(_arc(points[at : curved + 1]).sweep_rad) < LEAST_SWEEP:
            curved = at
        end = max(straight, curved)
        if end > at:
            edge: PlaneCurve = Segment(points[at], points[end]) if straight == end else _arc(points[at : end + 1])
            found.append(_Piece(at, end, edge))
        at = max(end, at + 1)
    return found


Holds = Callable[[Points2, float], bool]


def _farthest(points: Points2, at: int, accuracy: float, holds: Holds, least: int) -> int:
    """Return the last point up to which a stretch from `at` is of one sort, or `at` if it is too short: by doubling."""
    low, last = at + least - 1, len(points) - 1
    if low > last or not holds(points[at : low + 1], accuracy):
        return at
    step = least
    while step:
        if low + step <= last and holds(points[at : low + step + 1], accuracy):
            low, step = low + step, 2 * step
        else:
            step //= 2
    return low


def _is_straight(points: Points2, accuracy: float) -> bool:
    """Return whether the points are on the straight line between the first and the last, in order."""
    along = points[-1] - points[0]
    length = float(norm(along))
    if length == 0.0:
        return False
    offset, forward = points - points[0], (points - points[0]) @ along
    return bool(np.abs(cross2(np.broadcast_to(along, offset.shape), offset)).max() <= accuracy * length) and bool(
        np.all(np.diff(forward) > 0.0)
    )


def _is_round(points: Points2, accuracy: float) -> bool:
    """Return whether the points lie on one circle."""
    arc = _arc(points)
    return bool(np.abs(norm(points - arc.centre) - arc.radius).max() <= accuracy)


def _circle(points: Points2, accuracy: float) -> CircularArc | None:
    """Return the full circle that a closed run is, its first point repeated at the end, or None."""
    if len(points) <= LEAST_ROUND:
        return None
    arc = _free_arc(points)
    if float(np.abs(norm(points - arc.centre) - arc.radius).max()) > accuracy:
        return None
    return CircularArc(arc.centre, arc.radius, arc.start_rad, tau if arc.sweep_rad > 0.0 else -tau)


def _arc(points: Points2) -> CircularArc:
    """Return the arc through the first and last point that is nearest to the others (least squares on its centre).

    The centre lies on the bisector of the chord; how far along is linear in x^2 + y^2 - 2 c.x = constant.
    """
    chord = points[-1] - points[0]
    middle, length = (points[0] + points[-1]) / 2.0, float(norm(chord))
    if length == 0.0:
        return _free_arc(points)
    across = np.array([-chord[1], chord[0]]) / length
    offset = points[1:-1] - middle
    height = offset @ across
    excess = np.sum(offset**2, axis=1) - length**2 / 4.0
    far = float(height @ excess) / float(2.0 * (height @ height) or 1.0)
    centre = middle + far * across
    return _swept(centre, points, float(np.hypot(far, length / 2.0)))


def _free_arc(points: Points2) -> CircularArc:
    """Return the circle of least squares through points of which the last repeats the first."""
    middle = points.mean(axis=0)
    offset = points - middle
    rows = np.column_stack([2.0 * offset, np.ones(len(points))])
    solution = np.linalg.lstsq(rows, np.sum(offset**2, axis=1), rcond=None)[0]
    centre = middle + solution[:2]
    return _swept(centre, points, float(norm(points - centre).mean()))


def _swept(centre: Vector2, points: Points2, radius: float) -> CircularArc:
    """Return the arc about a centre that follows the points."""
    angles = np.unwrap(np.arctan2(points[:, 1] - centre[1], points[:, 0] - centre[0]))
    return CircularArc(centre, radius or 1.0, float(angles[0]), float(angles[-1] - angles[0]))


def _off_chords(edge: PlaneCurve, points: Points2) -> float:
    """Return how far an edge leaves the polygon through its points: at the middle between them, mm."""
    if isinstance(edge, Segment):
        return 0.0
    if isinstance(edge, Spline):
        middle = edge.at((edge.breaks[1:] + edge.breaks[:-1]) / 2.0)
        chord = np.diff(points, axis=0)
        return float(np.abs(cross2(chord, middle - points[:-1]) / norm(chord)).max())
    if not isinstance(edge, CircularArc):
        raise TypeError(f"no sagitta of a {type(edge).__name__}")
    half = norm(np.diff(points, axis=0)).max() / 2.0
    return float(edge.radius - np.sqrt(max(edge.radius**2 - half**2, 0.0)))


def _uncertainty(edge: PlaneCurve, points: Points2) -> float:
    """Return how far a spline would move if every other point were unknown, as a share of what is left here, mm."""
    if not isinstance(edge, Spline) or len(points) < LEAST_SPLINE:
        return 0.0
    kept = np.union1d(np.arange(0, len(points), 2), [len(points) - 1])
    closed = bool(np.all(points[0] == points[-1]))
    coarse = spline(points[kept], periodic=closed)
    assert isinstance(coarse, Spline)
    lengths = np.concatenate([[0.0], np.cumsum(norm(np.diff(points[kept], axis=0)))])
    places = edge.breaks / edge.breaks[kept[-1]]
    at = np.interp(places, edge.breaks[kept], lengths / lengths[-1])
    rate, off = coarse.derivative(at), points - coarse.at(at)
    return float(np.abs(cross2(rate, off) / norm(rate)).max()) * LEFT
