"""The loops of a CAD face as closed curves of u and v on the strip under it.

Every edge is pulled back from space onto the strip, so that a file needs no curves in the surface's own parameters and
a face none that are exact.  An edge along a ruling, or along an edge of the strip, becomes a straight line of u and v.
On a strip that closes on itself a ruling at its ends may be either end: that which continues the loop is taken.  Where
a loop passes an apex, u and v jump: the gap is closed along the apex.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Points2, Values, Vector2, cross2, dot, norm
from stages.geometry.curves.curves import Curve
from stages.geometry.curves.plane import PlaneCurve, Segment
from stages.geometry.flat.tabled import tabled
from stages.geometry.ruled.pullback import PulledBack, lying_on
from stages.geometry.ruled.ruled import RuledPatch
from stages.geometry.ruled.strip import Strip, points, rulings, size
from stages.model.cadface import CadEdge, CadFace
from stages.model.surface import Trim

STEPS = 64
"""Places in the table of an edge, between which Newton's method starts."""
SNAPPED = 1e-9
"""Of u, or of a patch in v: what runs along a ruling or an edge of the strip to within rounding of both."""
MEETS = 1e-6
"""Share of the size by which edges that are one, or that make a loop or a ring, may miss each other: ten times what CAD
programs leave."""


class OpenLoopError(Exception):
    """A loop whose edges do not follow each other; the gap, mm."""

    def __init__(self, gap_mm: float) -> None:
        super().__init__(gap_mm)
        self.gap_mm = gap_mm


@dataclass(frozen=True, slots=True)
class Loops:
    """Loops in u and v, the outer one first, and how far from the strip their edges lie at most, mm."""

    curves: tuple[tuple[PlaneCurve, ...], ...]
    distance_mm: float

    def trim(self, patches: Sequence[RuledPatch]) -> Trim | None:
        """Return the loops as a trim; None where they are the four edges of the strip."""
        if len(self.curves) == 1 and _fills(self.curves[0], float(len(patches))):
            return None
        return Trim(self.curves[0], self.curves[1:])


def loops_of(patches: tuple[RuledPatch, ...], face: CadFace, first: int = 0) -> Loops:
    """Return the loops of a face on its strip, the v of which begins at `first`.

    Raises OpenLoopError, and NoSolutionError where Newton's method fails.
    """
    strip = Strip(patches, np.arange(len(patches) + 1.0) + first)
    found = [_loop(strip, loop) for loop in face.loops]
    return Loops(tuple(curves for curves, _ in found), max(off for _, off in found))


def _loop(strip: Strip, edges: Sequence[CadEdge]) -> tuple[tuple[PlaneCurve, ...], float]:
    """Return one loop, and how far it lies from the strip, mm."""
    found = [(edge.number, *_pulled(strip, curve)) for edge in _seam_last(edges) for curve in edge.curves]
    chosen: list[PlaneCurve] = []
    used: set[tuple[int, float]] = set()
    for number, _, ways in found:
        # a seam is passed at either end of the strip once
        left = [way for way in ways if (number, _start(way)[1]) not in used] or list(ways)
        end = None if not chosen else chosen[-1].at(np.ones(1))[0]
        chosen.append(left[0] if end is None else min(left, key=lambda way: float(norm(_start(way) - end))))
        if len(ways) > 1:
            used.add((number, float(_start(chosen[-1])[1])))
    return closed(strip, chosen), max(off for _, off, _ in found)


def _start(way: PlaneCurve) -> Vector2:
    """Return the first place of a curve of u and v."""
    start: Vector2 = way.at(np.zeros(1))[0]
    return start


def _seam_last(edges: Sequence[CadEdge]) -> list[CadEdge]:
    """Return the edges from one on that is no seam."""
    numbers = [edge.number for edge in edges]
    first = next((i for i, number in enumerate(numbers) if numbers.count(number) == 1), 0)
    return [*edges[first:], *edges[:first]]


Ways = tuple[PlaneCurve, ...]


def _pulled(strip: Strip, curve: Curve) -> tuple[float, Ways]:
    """Return how far a curve lies from the strip, mm, and the ways in which it may run on it."""
    edge = lying_on(strip, curve, STEPS, within_mm=MEETS * size(strip))
    every = curve.jet(np.linspace(0.0, 1.0, STEPS + 1), 0)[0]
    off = float(norm(points(strip, *edge.table.T) - every).max())
    inner = edge.table[1:-1]
    v = _one_end(strip, inner[:, 1])
    if np.ptp(v) <= SNAPPED:
        return off, _along_ruling(strip, curve, float(np.median(v)))
    for side in (0.0, 1.0):
        if np.abs(inner[:, 0] - side).max() <= SNAPPED:
            return off, (_along_edge(strip, edge, side),)
    return off, (tabled(edge, strip),)


def _one_end(strip: Strip, v: Values) -> Values:
    """Return places on the seam of a closed strip at its beginning all of them, any others as they are."""
    first, last = float(strip.knots[0]), float(strip.knots[-1])
    on_seam = np.minimum(v - first, last - v) <= SNAPPED
    return np.full_like(v, first) if on_seam.all() and closes(strip) else v


def _along_ruling(strip: Strip, curve: Curve, v: float) -> Ways:
    """Return the line of u and v of a curve along the ruling at v; both ends of a closed strip are one ruling."""
    first, last = float(strip.knots[0]), float(strip.knots[-1])
    v = next((float(knot) for knot in strip.knots if abs(v - knot) <= SNAPPED), v)
    c0, p = (row[0] for row in rulings(strip, np.array([v])))
    ends = (curve.jet(np.array([0.0, 1.0]), 0)[0] - c0) @ p / float(dot(p, p))
    u = _snapped(ends)
    places = {first: (first, last), last: (last, first)}.get(v, (v,)) if closes(strip) else (v,)
    return tuple(Segment(np.array([u[0], at]), np.array([u[1], at])) for at in places)


def _snapped(u: Values) -> Values:
    """Return 0 or 1 where u is that to rounding."""
    return np.where(np.abs(u - np.round(u)) <= SNAPPED, np.clip(np.round(u), 0.0, 1.0), u)


def _along_edge(strip: Strip, edge: PulledBack, side: float) -> Segment:
    """Return the line of u and v along c0 or c1."""
    v = edge.table[[0, -1], 1]
    knots = strip.knots[np.argmin(np.abs(v[:, None] - strip.knots), axis=1)]
    v = np.where(np.abs(v - knots) <= SNAPPED, knots, v)
    return Segment(np.array([side, v[0]]), np.array([side, v[1]]))


def closes(strip: Strip) -> bool:
    """Return whether the last ruling is the first one again."""
    (c0, p), (c0_end, p_end) = (rulings(strip, strip.knots[[i]]) for i in (0, -1))
    return float(norm(np.concatenate([c0 - c0_end, c0 + p - c0_end - p_end])).max()) <= MEETS * size(strip)


def closed(strip: Strip, run: Sequence[PlaneCurve]) -> tuple[PlaneCurve, ...]:
    """Return the curves of a loop, joined along an apex where they part there.  Raises OpenLoopError."""
    made: list[PlaneCurve] = []
    for one, following in zip(run, [*run[1:], run[0]], strict=True):
        end, start = one.at(np.ones(1))[0], following.at(np.zeros(1))[0]
        made.append(one)
        gap = _way(strip, end, start)
        if gap > MEETS * size(strip):
            raise OpenLoopError(gap)
        if norm(end - start) > SNAPPED and gap <= SNAPPED * size(strip):
            made.append(Segment(end, start))
    return tuple(made)


def _way(strip: Strip, end: Vector2, start: Vector2) -> float:
    """Return the length on the strip of the straight way of u and v from one place to another, mm."""
    share = np.linspace(0.0, 1.0, STEPS + 1)[:, None]
    way = (1.0 - share) * end + share * start
    return float(norm(np.diff(points(strip, way[:, 0], way[:, 1]), axis=0)).sum())


def _fills(loop: Sequence[PlaneCurve], last: float) -> bool:
    """Return whether a loop runs along the four edges of a strip with v from 0 to `last`."""
    if not all(isinstance(curve, Segment) for curve in loop):
        return False
    corners: Points2 = np.array([curve.at(np.zeros(1))[0] for curve in loop])
    area = abs(float(cross2(corners, np.roll(corners, -1, axis=0)).sum())) / 2.0
    return area == last
