"""Which points of a profile make straight legs and which make bends.

From one end on the longest run of points that is straight or round to within rounding is taken, a round one only if

1. no step on it turns by more than `WIDEST_RAD`, and it begins in the direction in which the leg before it ends, to a
   `TANGENT` share of its largest step; at the beginning of the profile four points must lie on it instead;
2. it is overdetermined at least twice: by points beyond the three that any circle passes, and by tangents at its ends,
   of which two bends share one; and no bend goes over into another that bends the same way, as parts of an ellipse do.

What is left are folds: two straight legs that meet at an angle.  Three small ones in a row the same way are no folds
but a curve that is no arc (part of an ellipse, a spline): then there is no answer.  Nor is there for a chain that is
one leg, nor where a bend ends with a kink.
"""

from dataclasses import dataclass
from itertools import pairwise
from math import radians

import numpy as np

from stages.geometry.arrays import Array, Numbers, Points2, Values, Vector2, cross2, dot, norm, unit
from stages.geometry.mesh.profilechain import Chain, Leg

WIDEST_RAD = radians(31.0)
"""A bend in steps of up to 30 deg, and rounding."""
CURVE_RAD = radians(40.0)
"""A row of turns below this may be a curve; sharper ones are folds."""
CURVE_ROW = 3
TANGENT = 0.1
LEAST_ROUND, LEAST_FREE = 3, 4
"""Points on a bend that a leg leads to, and on one at the beginning."""
EVIDENCE, SHARED = 2, 0.5
TWICE = 2.0
"""Points are put together from several vertices, and legs laid through two of them."""
CLUSTER = 16.0
"""Roundings by which vertices may be apart that are one point of the profile."""


@dataclass(frozen=True, slots=True)
class Stretch:
    """Points from the first to the last that make one leg; the centre and radius of a bend, positive to the left."""

    first: int
    last: int
    radius: float = 0.0


def stations(points: Points2, near_mm: float) -> tuple[Array, Numbers]:
    """Return points in running order with those put together that are one, and which one each belongs to."""
    label = np.zeros(len(points), dtype=np.int64)
    first, count = points[0], 0
    for i, point in enumerate(points):
        if abs(point[0] - first[0]) + abs(point[1] - first[1]) > CLUSTER * near_mm:
            first, count = point, count + 1
        label[i] = count
    total = np.zeros((count + 1, 2))
    np.add.at(total, label, points)
    return total / np.bincount(label)[:, None], label


def stretches(points: Points2, near_mm: float) -> tuple[Stretch, ...] | None:
    """Return the legs that points in running order make; None where they are something else."""
    found: list[Stretch] = []
    at, last = 0, len(points) - 1
    while at < last:
        line = Stretch(at, _farthest(points, at, 1, near_mm, bent=False))
        bend = _bend(points, at, found[-1] if found else None, near_mm)
        found.append(bend if bend is not None and bend.last > line.last else line)
        at = found[-1].last
    sound = len(found) > 1 and all(_known(points, found, i, near_mm) for i in range(len(found)))
    return tuple(found) if sound and not _curved(points, found) else None


def _farthest(points: Points2, at: int, least: int, near_mm: float, *, bent: bool) -> int:
    """Return the last point up to which points from `at` on make one leg, by doubling; `at` if there is none."""
    holds = _is_round if bent else _is_straight
    low, last = at + least, len(points) - 1
    if low > last or not holds(points[at : low + 1], near_mm):
        return at
    step = 1
    while step:
        if low + step <= last and holds(points[at : low + step + 1], near_mm):
            low, step = low + step, 2 * step
        else:
            step //= 2
    return low


def _is_straight(points: Points2, near_mm: float) -> bool:
    forward = unit(points[-1] - points[0])
    offset = points - points[0]
    return bool(np.abs(cross2(np.broadcast_to(forward, offset.shape), offset)).max() <= TWICE * near_mm)


def _is_round(points: Points2, near_mm: float) -> bool:
    """Return whether points lie on a circle, one after the other in steps that are small enough."""
    centre = _centre(points)
    if centre is None:
        return False
    offset = points - centre
    off = float(np.abs(norm(offset) - norm(offset[0])).max())
    step = np.arctan2(cross2(offset[:-1], offset[1:]), dot(offset[:-1], offset[1:]))
    one_way = bool(np.all(step > 0.0) or np.all(step < 0.0))
    return off <= TWICE * near_mm and one_way and float(np.abs(step).max()) <= WIDEST_RAD


def _centre(points: Points2) -> Vector2 | None:
    """Return the centre of the circle through the first and last point that is nearest to the others."""
    chord = points[-1] - points[0]
    length = float(norm(chord))
    if length == 0.0:
        return None
    across = np.array([-chord[1], chord[0]]) / length
    offset = points[1:-1] - (points[0] + points[-1]) / 2.0
    height = offset @ across
    square = 2.0 * float(height @ height)
    if square == 0.0:
        return None
    far = float(height @ (dot(offset, offset) - length**2 / 4.0)) / square
    centre: Vector2 = (points[0] + points[-1]) / 2.0 + far * across
    return centre


def _bend(points: Points2, at: int, before: Stretch | None, near_mm: float) -> Stretch | None:
    """Return the bend that begins at a point; None where none does."""
    least = (LEAST_FREE if before is None else LEAST_ROUND) - 1
    end = _farthest(points, at, least, near_mm, bent=True)
    if end == at:
        return None
    bend = _rounded(points, at, end)
    if bend is None or (before is not None and not _smooth(points, before, bend, near_mm)):
        return None
    return bend


def _rounded(points: Points2, first: int, last: int) -> Stretch | None:
    centre = _centre(points[first : last + 1])
    if centre is None:
        return None
    arrow, step = points[first] - centre, points[first + 1] - points[first]
    return Stretch(first, last, float(np.copysign(norm(arrow), cross2(arrow, step))))


def direction(points: Points2, stretch: Stretch, end: int) -> Vector2:
    """Return the direction of a leg at its beginning (0) or end (-1)."""
    run = points[stretch.first : stretch.last + 1]
    if stretch.radius == 0.0:
        return np.asarray(unit(run[-1] - run[0]))
    centre = _centre(run)
    if centre is None:
        raise ValueError("the points of an arc have a centre")
    arrow = unit(run[end] - centre) * np.sign(stretch.radius)
    return np.array([-arrow[1], arrow[0]])


def turn_between(points: Points2, before: Stretch, after: Stretch) -> float:
    """Return by how much a profile turns from one leg to the next, rad."""
    a, b = direction(points, before, -1), direction(points, after, 0)
    return float(np.arctan2(cross2(a, b), a @ b))


def _smooth(points: Points2, before: Stretch, after: Stretch, near_mm: float) -> bool:
    """Return whether two legs, one of them a bend, go over into each other.

    Either may have taken a point beyond the place where they meet: one that is within rounding of both.
    """
    bends = [bend for bend in (before, after) if bend.radius]
    taken = max(float(np.sqrt(2.0 * TWICE * near_mm / abs(bend.radius))) for bend in bends)
    return abs(turn_between(points, before, after)) <= TANGENT * min(_step(points, bend) for bend in bends) + taken


def _step(points: Points2, bend: Stretch) -> float:
    """Return the largest angle of a step on a bend, rad."""
    longest = float(norm(np.diff(points[bend.first : bend.last + 1], axis=0)).max())
    return 2.0 * float(np.arcsin(min(longest / (2.0 * abs(bend.radius)), 1.0)))


def _known(points: Points2, found: list[Stretch], i: int, near_mm: float) -> bool:
    """Return whether a bend goes over into both its neighbours and is overdetermined; a straight leg is known."""
    bend = found[i]
    if bend.radius == 0.0:
        return True
    beside = [(found[k], found[k + 1]) for k in (i - 1, i) if 0 <= k < len(found) - 1]
    if any(a.radius * b.radius > 0.0 for a, b in beside):
        return False
    tangents = sum(SHARED if a.radius and b.radius else 1.0 for a, b in beside)
    more = bend.last - bend.first + 1 - LEAST_ROUND
    return more + tangents >= EVIDENCE and all(_smooth(points, a, b, near_mm) for a, b in beside)


def _curved(points: Points2, found: list[Stretch]) -> bool:
    """Return whether folds follow each other as the corners of a polygon do that stands for a curve."""
    row, way = 0, 0.0
    for a, b in pairwise(found):
        turn = 0.0 if a.radius or b.radius else turn_between(points, a, b)
        row = 0 if turn == 0.0 or abs(turn) > CURVE_RAD else row + 1 if np.sign(turn) == way else 1
        way = float(np.sign(turn))
        if row >= CURVE_ROW:
            return True
    return False


def chain_of(points: Points2, found: tuple[Stretch, ...]) -> Chain:
    """Return the chain of legs, as good as single points are."""
    legs = []
    for i, leg in enumerate(found):
        run = points[leg.first : leg.last + 1]
        sharp = i > 0 and leg.radius == 0.0 == found[i - 1].radius
        fold = turn_between(points, found[i - 1], leg) if sharp else 0.0
        if leg.radius == 0.0:
            legs.append(Leg(float(norm(run[-1] - run[0])), 0.0, fold, sharp))
        else:
            turn = float(_turned(run, leg))
            legs.append(Leg(abs(leg.radius * turn), turn))
    x, y = direction(points, found[0], 0)
    return Chain(points[0], float(np.arctan2(y, x)), tuple(legs))


def _turned(run: Points2, bend: Stretch) -> float:
    """Return the angle of a bend, rad."""
    chords: Values = norm(np.diff(run, axis=0)) / (2.0 * abs(bend.radius))
    return float(np.copysign(2.0 * np.arcsin(np.minimum(chords, 1.0)).sum(), bend.radius))
