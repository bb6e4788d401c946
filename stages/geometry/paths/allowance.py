"""A closed outline widened by a distance of its own along each edge: parallels, and what joins them at the corners.

Where two parallels drift apart (a convex corner) both are continued along their tangents until they meet, a mitre; one
that would reach farther than `MITRE_LIMIT` times the larger distance from the corner is cut off straight between the
ends of the parallels.  Where they cross (a hollow corner) both end at the crossing.  Where the distances differ so much
that they do neither, the wider strip ends at a right angle to its edge.  An edge that its neighbours leave nothing of
is passed over, if what is widened without it is still as wide there, within the accuracy.

The outline runs counter-clockwise, each edge beginning where the one before ends; distances are to its right, outward.
What the result cannot be is a `Fault`.  That parallels of edges far from each other cross is not seen here.

Symbols: a, b the distances before and after a corner P; T, S the directions there; turn the angle from T to S.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import atan2, cos, hypot, inf, sin

import numpy as np

from stages.geometry.arrays import ArrayValue, Points2, Vector2, cross2, norm
from stages.geometry.curves.parallel import Hollow, crossing, normals, parallel
from stages.geometry.curves.plane import PlaneCurve, Segment, stretch
from stages.geometry.paths.biarc import ZERO_LENGTH_MM

MITRE_LIMIT = 2.0
"""A right angle reaches 1.41 times the distance from its corner, one of 60 degrees 2."""

STRAIGHT_RAD = 1e-9
"""A corner that turns by less has no crossing that could be found: its parallels end beside each other."""

START, END = np.zeros(1), np.ones(1)
LOOKS = 9
FINE_LOOKS = 65
"""Points of an edge: to see whether it is one, and to measure how far it is from another."""


@dataclass(frozen=True, slots=True, eq=False)
class Fault(ArrayValue):
    """Why an outline cannot be widened: the number of the edge, the place on it, and the radius of a hollow, mm."""

    edge: int
    at: Vector2
    radius_mm: float | None = None


@dataclass(frozen=True, slots=True)
class Strip:
    """A parallel: of which edge, at which distance, and what is left of it; a line may go on beyond its ends."""

    edge: int
    distance_mm: float
    curve: PlaneCurve
    low: float = 0.0
    high: float = 1.0


@dataclass(frozen=True, slots=True)
class Widened:
    """The widened outline, and for each of its edges the strip that it is, or None for what joins two strips."""

    edges: tuple[PlaneCurve, ...]
    strips: tuple[Strip | None, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Join:
    """What joins two strips: where the one before ends and the one after begins, and a corner on the way between."""

    high: float = 1.0
    low: float = 0.0
    corner: Vector2 | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Corner(ArrayValue):
    """Where two strips meet: unit normals outward before and after it, and the angle that the outline turns by."""

    at: Vector2
    out_before: Vector2
    out_after: Vector2
    turn: float


def widened(edges: Sequence[PlaneCurve], distances_mm: Sequence[float], *, accuracy: float) -> Widened | Fault:
    """Return the outline widened by these distances, each at least 0, or what is in the way.

    accuracy: mm that an edge may be farther from the result where it was passed over.
    Raises NoSolutionError where the direction of an edge is not resolved.
    """
    strips: list[Strip] = []
    for number, (edge, distance) in enumerate(zip(edges, distances_mm, strict=True)):
        if is_point(edge):
            continue
        curve = parallel(edge, distance)
        if isinstance(curve, Hollow):
            return Fault(number, curve.at, curve.radius_mm)
        strips.append(Strip(number, distance, curve))
    return _joined(edges, strips, accuracy)


def is_point(edge: PlaneCurve) -> bool:
    """Return whether an edge has no length that a reader could tell: that of an apex."""
    points = edge.at(np.linspace(0.0, 1.0, LOOKS))
    return bool(norm(points - points[0]).max() <= ZERO_LENGTH_MM)


def _joined(edges: Sequence[PlaneCurve], strips: Sequence[Strip], accuracy: float) -> Widened | Fault:
    """Return the strips with their joins; those that nothing is left of are passed over, one by one."""
    left, gone = list(strips), list[Strip]()
    while left:
        joins = [_join(edges, strip, left[(i + 1) % len(left)]) for i, strip in enumerate(left)]
        made = [
            replace(strip, low=before.low, high=after.high)
            for strip, before, after in zip(left, [joins[-1], *joins], joins, strict=False)
            if before is not None and after is not None
        ]
        swallowed = _swallowed(left, joins)
        if swallowed is None:
            result = _chained(made, [join for join in joins if join is not None])
            far = next((strip for strip in gone if not _as_wide(edges[strip.edge], strip, result, accuracy)), None)
            return result if far is None else _middle(edges, far)
        gone.append(left.pop(swallowed))
    return _middle(edges, gone[0])


def _middle(edges: Sequence[PlaneCurve], strip: Strip) -> Fault:
    return Fault(strip.edge, edges[strip.edge].at(np.array([0.5]))[0])


def _swallowed(left: Sequence[Strip], joins: Sequence[Join | None]) -> int | None:
    """Return the place of a strip that nothing is left of, or the shorter one of two that cannot be joined."""
    for i, join in enumerate(joins):
        if join is None:
            return min((i, (i + 1) % len(left)), key=lambda one: float(norm(np.diff(_points(left[one]), axis=0)).sum()))
    for i, (before, after) in enumerate(zip([joins[-1], *joins], joins, strict=False)):
        if before is not None and after is not None and after.high <= before.low:
            return i
    return None


def _points(strip: Strip) -> Points2:
    return strip.curve.at(np.linspace(0.0, 1.0, LOOKS))


def _as_wide(edge: PlaneCurve, strip: Strip, result: Widened, accuracy: float) -> bool:
    """Return whether the result is no farther from an edge that was passed over than it would be, but for accuracy."""
    import shapely

    t = np.linspace(0.0, 1.0, FINE_LOOKS)
    ring = shapely.LinearRing(np.concatenate([one.at(t)[:-1] for one in result.edges]))
    away = shapely.distance(ring, shapely.points(edge.at(np.linspace(0.0, 1.0, LOOKS))))
    return bool(away.max() <= strip.distance_mm + accuracy)


def _chained(strips: Sequence[Strip], joins: Sequence[Join]) -> Widened:
    """Return strips and joins as one outline."""
    made: list[PlaneCurve] = []
    of: list[Strip | None] = []
    for i, (strip, join) in enumerate(zip(strips, joins, strict=True)):
        following = strips[(i + 1) % len(strips)]
        curve = stretch(strip.curve, strip.low, strip.high)
        made.append(curve)
        of.append(strip)
        way = [curve.at(END)[0], join.corner, following.curve.at(np.array([join.low]))[0]]
        known = [point for point in way if point is not None]
        for one, other in pairwise(known):
            if norm(other - one) > ZERO_LENGTH_MM:
                made.append(Segment(one, other))
                of.append(None)
    return Widened(tuple(made), tuple(of))


def _join(edges: Sequence[PlaneCurve], before: Strip, after: Strip) -> Join | None:
    """Return what joins two strips; None where they should cross and do not."""
    if norm(after.curve.at(START)[0] - before.curve.at(END)[0]) <= ZERO_LENGTH_MM:
        return Join()
    (right,), (other,) = normals(edges[before.edge], END), normals(edges[after.edge], START)
    turn = atan2(float(cross2(right, other)), float(right @ other))
    place = Corner(edges[before.edge].at(END)[0], right, other, turn)
    if norm(edges[after.edge].at(START)[0] - place.at) > ZERO_LENGTH_MM:  # what lay between was passed over
        return _crossed(before, after)
    a, b = before.distance_mm, after.distance_mm
    reach_before, reach_after = _reach(a, b, turn), _reach(b, a, turn)
    if turn > STRAIGHT_RAD and min(reach_before, reach_after) >= -ZERO_LENGTH_MM:
        return _mitre(before, after, place, reach_before, reach_after)
    if turn < -STRAIGHT_RAD and max(reach_before, reach_after) <= ZERO_LENGTH_MM:
        return _crossed(before, after)
    return _step_down(before, after, place) if a > b else _step_up(before, after, place)


def _reach(a: float, b: float, turn: float) -> float:
    """Return how far the strip of the width a goes on beyond the corner until it meets that of the width b, mm."""
    across = sin(turn)
    return (b - a * cos(turn)) / across if across != 0.0 else inf


def _crossed(before: Strip, after: Strip) -> Join | None:
    met = crossing(before.curve, after.curve)
    return None if met is None else Join(*met)


def _mitre(before: Strip, after: Strip, place: Corner, reach_before: float, reach_after: float) -> Join:
    """Return the corner where both tangents meet; lines go on to it by themselves."""
    wide = max(before.distance_mm, after.distance_mm)
    if hypot(before.distance_mm, reach_before) > MITRE_LIMIT * wide:
        return Join()
    high, low = _longer(before.curve, reach_before), -_longer(after.curve, reach_after, 0.0)
    if isinstance(before.curve, Segment) or isinstance(after.curve, Segment):
        return Join(high, low)
    along = np.array([-place.out_before[1], place.out_before[0]])
    return Join(corner=before.curve.at(END)[0] + reach_before * along)


def _longer(curve: PlaneCurve, by_mm: float, end: float = 1.0) -> float:
    """Return t at a length beyond the end of a line; the end itself of any other curve."""
    return end + by_mm / float(norm(curve.end - curve.start)) if isinstance(curve, Segment) else end


def _step_down(before: Strip, after: Strip, place: Corner) -> Join | None:
    """Return the join of a wide strip, which ends at a right angle, to a narrow one."""
    if place.turn < 0.0:
        if after.distance_mm == 0.0:
            return Join()
        met = crossing(Segment(before.curve.at(END)[0], place.at), after.curve)
        return None if met is None else Join(1.0, met[1])
    back = after.distance_mm * np.tan(place.turn)
    low = -_longer(after.curve, float(back), 0.0)
    foot = place.at + after.distance_mm / cos(place.turn) * place.out_before
    return Join(1.0, low, None if isinstance(after.curve, Segment) else foot)


def _step_up(before: Strip, after: Strip, place: Corner) -> Join | None:
    """Return the join of a narrow strip to a wide one, which begins at a right angle."""
    if place.turn < 0.0:
        if before.distance_mm == 0.0:
            return Join()
        met = crossing(before.curve, Segment(place.at, after.curve.at(START)[0]))
        return None if met is None else Join(met[0], 0.0)
    ahead = before.distance_mm * np.tan(place.turn)
    high = _longer(before.curve, float(ahead))
    foot = place.at + before.distance_mm / cos(place.turn) * place.out_after
    return Join(high, 0.0, None if isinstance(before.curve, Segment) else foot)
