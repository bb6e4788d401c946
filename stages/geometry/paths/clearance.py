"""Smallest distance between paths of lines and arcs, closed form, in mm.

The distance of two pieces is reached at an end of one of them, at a common normal, or is 0 where they cross.  A common
normal of a line and an arc runs through the centre, one of two arcs through both centres.  So every candidate is a
point of one piece, and its distance to the other piece is evaluated: a candidate that is slightly off its place along
the piece changes the result in second order only.  The distance of a point to an arc comes from the power of the point
relative to the chord, not from |p - c| - r, so that flat arcs of huge radius lose no digits.

Pairs of pieces are found on their boxes; what is farther than the wanted range is never looked at.

Symbols: s, e, m start, end and middle of a chord; b bulge; c centre; r radius; p a point; h the offset of the centre
from m in units of the chord turned left, h = (1/b - b)/4.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from shapely import STRtree, box

from stages.geometry.arrays import Array, ArrayValue, Indices, Mask, Points2, Values, cross2, dot, norm, unit
from stages.geometry.paths.arcpath import ArcPath, chords, piece_count

FLAT_BULGE = 1e-12
"""An arc flatter than this counts as its chord: its height is under 1e-9 mm on a chord of 2 m."""


BLOCK = 2000
"""Pieces looked at in one go: some 1e5 pairs, so the arrays stay within a few MB."""


@dataclass(frozen=True, slots=True, eq=False)
class Pieces(ArrayValue):
    """Lines (bulge 0) and arcs by start, end and bulge; centre and radius are 0 for lines."""

    start: Points2
    end: Points2
    bulge: Values
    centre: Points2
    radius: Values

    def take(self, index: Indices) -> "Pieces":
        """Return the pieces of those indices."""
        return Pieces(self.start[index], self.end[index], self.bulge[index], self.centre[index], self.radius[index])


def pieces(path: ArcPath) -> Pieces:
    """Return the lines and arcs of a path, pieces of length 0 left out."""
    bulge = path.bulges[: piece_count(path)]
    start, end = chords(path)
    keep = np.flatnonzero(norm(end - start) > 0.0)
    if keep.size == 0:
        raise ValueError("a path of length 0 has no distance to anything")
    return between(start[keep], end[keep], bulge[keep])


def between(start: Points2, end: Points2, bulge: Values) -> Pieces:
    """Return the lines and arcs between points, none of length 0."""
    bulge = np.where(np.abs(bulge) < FLAT_BULGE, 0.0, bulge)
    curved = bulge != 0.0
    safe = np.where(curved, bulge, 1.0)
    chord = end - start
    left = np.stack([-chord[:, 1], chord[:, 0]], axis=1)
    centre = (start + end) / 2.0 + ((1.0 / safe - safe) / 4.0)[:, None] * left
    radius = norm(chord) * np.abs(1.0 / safe + safe) / 4.0
    return Pieces(start, end, bulge, np.where(curved[:, None], centre, 0.0), np.where(curved, radius, 0.0))


def joined(many: Sequence[Pieces]) -> Pieces:
    """Return several lists of pieces as one."""
    return Pieces(
        np.concatenate([one.start for one in many]),
        np.concatenate([one.end for one in many]),
        np.concatenate([one.bulge for one in many]),
        np.concatenate([one.centre for one in many]),
        np.concatenate([one.radius for one in many]),
    )


def boxes(some: Pieces) -> Array:
    """Return boxes that contain the pieces, shape (n, 4): x least, y least, x most, y most, in mm.

    An arc lies within its chord widened by its height on both sides, up to half a circle; beyond, in its circle.
    """
    reach = (np.abs(some.bulge) * norm(some.end - some.start) / 2.0)[:, None]
    low, high = np.minimum(some.start, some.end) - reach, np.maximum(some.start, some.end) + reach
    large = (np.abs(some.bulge) > 1.0)[:, None]
    radius = some.radius[:, None]
    low, high = np.where(large, some.centre - radius, low), np.where(large, some.centre + radius, high)
    return np.concatenate([low, high], axis=1)


def clearance(a: Pieces, b: Pieces, *, within: float) -> float:
    """Return the smallest distance between two sets of pieces in mm, exact; inf if it is more than `within`."""
    owner = np.repeat(np.arange(2), (a.bulge.size, b.bulge.size))
    return clearances(joined([a, b]), owner, within=within).get((0, 1), np.inf)


def clearances(some: Pieces, owner: Indices, *, within: float) -> dict[tuple[int, int], float]:
    """Return the smallest distance in mm, exact, of every two owners of pieces that are not farther than `within`.

    Keys are pairs of owners, the smaller first.
    """
    least: dict[tuple[int, int], float] = {}
    for first, second in _near_pairs(boxes(some), owner, within):
        distance = distances(some.take(first), some.take(second))
        order = np.lexsort((distance, owner[second], owner[first]))
        pairs = np.stack([owner[first], owner[second]], axis=1)[order]
        fresh = np.flatnonzero(np.any(np.diff(pairs, axis=0, prepend=-1) != 0, axis=1))
        for (one, other), value in zip(pairs[fresh].tolist(), distance[order][fresh].tolist(), strict=True):
            least[one, other] = min(value, least.get((one, other), np.inf))
    return {pair: value for pair, value in sorted(least.items()) if value <= within}


def _near_pairs(low_high: Array, owner: Indices, within: float) -> Iterator[tuple[Indices, Indices]]:
    """Yield, in blocks, pairs of pieces of different owners, the smaller first, whose boxes are not too far apart."""
    low, high = low_high[:, :2] - within, low_high[:, 2:] + within
    tree = STRtree(box(*low_high.T))
    for start in range(0, owner.size, BLOCK):
        chosen = slice(start, start + BLOCK)
        first, second = tree.query(box(*low[chosen].T, *high[chosen].T))
        first = first.astype(np.int64) + start
        second = second.astype(np.int64)
        wanted = owner[first] < owner[second]
        if wanted.any():
            yield first[wanted], second[wanted]


def nearest(some: Pieces, owner: Indices, to: Pieces, *, within: float) -> dict[int, float]:
    """Return the smallest distance in mm, exact, to other pieces of every owner that is not farther than `within`."""
    least: dict[int, float] = {}
    low_high = boxes(some)
    tree = STRtree(box(*boxes(to).T))
    for start in range(0, owner.size, BLOCK):
        chosen = slice(start, start + BLOCK)
        low, high = low_high[chosen, :2] - within, low_high[chosen, 2:] + within
        one, other = tree.query(box(*low.T, *high.T))
        one = one.astype(np.int64) + start
        distance = distances(some.take(one), to.take(other.astype(np.int64)))
        for name, value in zip(owner[one].tolist(), distance.tolist(), strict=True):
            least[name] = min(value, least.get(name, np.inf))
    return {name: value for name, value in sorted(least.items()) if value <= within}


def distances(a: Pieces, b: Pieces) -> Values:
    """Return the distance of each piece of `a` to the piece of `b` at the same place, in mm."""
    least = np.full(a.bulge.shape, np.inf)
    for one, other in ((a, b), (b, a)):
        for point in (one.start, one.end, *normal_points(one, other)):
            least = np.minimum(least, point_distances(point, other))
    return np.where(crossing(a, b), 0.0, least)


def point_distances(point: Points2, to: Pieces) -> Values:
    """Return the distance of each point to its piece, in mm."""
    ends = np.minimum(norm(point - to.start), norm(point - to.end))
    chord = to.end - to.start
    along = np.clip(dot(point - to.start, chord) / dot(chord, chord), 0.0, 1.0)
    line = norm(point - to.start - along[:, None] * chord)
    away = unit(point - to.centre)
    signed = power(point, to) / np.where(to.bulge == 0.0, 1.0, norm(point - to.centre) + to.radius)
    arc = np.where(on_side(point - signed[:, None] * away, to), np.minimum(np.abs(signed), ends), ends)
    return np.where(to.bulge == 0.0, line, arc)


def _offset(some: Pieces) -> Values:
    """Return h of each piece, 0 for lines."""
    safe = np.where(some.bulge == 0.0, 1.0, some.bulge)
    return (1.0 / safe - safe) / 4.0


def power(point: Points2, of: Pieces) -> Values:
    """Return |p - c|^2 - r^2 of each point and circle, in mm2, without cancellation of large radii."""
    middle = (of.start + of.end) / 2.0
    height = cross2(of.end - of.start, point - middle)
    power: Values = dot(point - of.start, point - of.end) - 2.0 * _offset(of) * height
    return power


def on_side(point: Points2, of: Pieces) -> Mask:
    """Return whether a point of the circle lies on the arc: on the side of the chord to which the bulge swells."""
    side: Mask = np.sign(of.bulge) * cross2(of.end - of.start, point - of.start) <= 0.0
    return side


def normal_points(one: Pieces, other: Pieces) -> tuple[Points2, ...]:
    """Return points of `one` where a common normal with `other` may stand (ends of `one` where there is none)."""
    chord = one.end - one.start
    along = np.clip(dot(other.centre - one.start, chord) / dot(chord, chord), 0.0, 1.0)
    foot = one.start + along[:, None] * chord
    other_chord = other.end - other.start
    across = np.stack([-other_chord[:, 1], other_chord[:, 0]], axis=1)
    towards = np.where((other.bulge == 0.0)[:, None], across, other.centre - one.centre)
    is_line = (one.bulge == 0.0)[:, None]
    return tuple(np.where(is_line, foot, arc_point(one, sign * towards)) for sign in (1.0, -1.0))


def arc_point(of: Pieces, direction: Points2) -> Points2:
    """Return the point of each arc in a direction from its centre; the nearer end of its sweep where that is off it.

    In the frame of the chord, by the angle from the middle of the arc, so that flat arcs lose no digits.
    """
    chord = of.end - of.start
    left = np.stack([-chord[:, 1], chord[:, 0]], axis=1)
    half = 2.0 * np.arctan(np.where(of.bulge == 0.0, 1.0, of.bulge))
    swell = -np.sign(of.bulge)[:, None] * left
    turn = np.arctan2(dot(direction, chord), dot(direction, swell))
    turn = np.clip(turn, -np.abs(half), np.abs(half))
    x = np.sin(turn) / np.sin(np.abs(half)) / 2.0
    rise = np.sin((np.abs(half) + turn) / 2.0) * np.sin((np.abs(half) - turn) / 2.0) / np.sin(np.abs(half))
    middle = (of.start + of.end) / 2.0
    point: Points2 = middle + x[:, None] * chord + rise[:, None] * swell
    return point


def crossing(a: Pieces, b: Pieces) -> Mask:
    """Return which pieces have a point in common with their partner, touching ends aside."""
    line_a, line_b = a.bulge == 0.0, b.bulge == 0.0
    return np.where(
        line_a & line_b,
        _lines_cross(a, b),
        np.where(line_a, _line_meets_arc(a, b), np.where(line_b, _line_meets_arc(b, a), _arcs_meet(a, b))),
    )


def _lines_cross(a: Pieces, b: Pieces) -> Mask:
    """Return which two segments cross in their insides."""
    along_a, along_b = a.end - a.start, b.end - b.start
    by_a = cross2(along_a, b.start - a.start) * cross2(along_a, b.end - a.start)
    by_b = cross2(along_b, a.start - b.start) * cross2(along_b, a.end - b.start)
    crossed: Mask = (by_a < 0.0) & (by_b < 0.0)
    return crossed


def _line_meets_arc(line: Pieces, arc: Pieces) -> Mask:
    """Return which segments meet their arc: roots of the power along the line, on both."""
    along = line.end - line.start
    square, half = dot(along, along), dot(along, line.start - arc.centre)
    beyond = power(line.start, arc)
    root = np.sqrt(np.maximum(half**2 - square * beyond, 0.0))
    larger = -(half + np.copysign(root, half))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        roots = (larger / square, np.where(larger == 0.0, np.inf, beyond / larger))
    met = np.zeros(beyond.shape, dtype=bool)
    for t in roots:
        inside = (t >= 0.0) & (t <= 1.0)
        met |= inside & on_side(line.start + np.where(inside, t, 0.0)[:, None] * along, arc)
    real: Mask = met & (half**2 >= square * beyond)
    return real


def _arcs_meet(a: Pieces, b: Pieces) -> Mask:
    """Return which arcs meet: the two points of their circles, on both arcs."""
    between = b.centre - a.centre
    apart = norm(between)
    within_reach = (apart > 0.0) & (np.abs(a.radius - b.radius) <= apart) & (apart <= a.radius + b.radius)
    safe = np.where(within_reach, apart, np.inf)  # what cannot meet: nothing is divided by next to nothing
    along = apart * (apart / safe) / 2.0 + (a.radius - b.radius) * ((a.radius + b.radius) / safe) / 2.0
    square = (a.radius - along) * (a.radius + along)
    towards = between / safe[:, None]
    left = np.stack([-towards[:, 1], towards[:, 0]], axis=1) * np.sqrt(np.maximum(square, 0.0))[:, None]
    foot = a.centre + along[:, None] * towards
    met = np.zeros(apart.shape, dtype=bool)
    for point in (foot + left, foot - left):
        met |= on_side(point, a) & on_side(point, b)
    real: Mask = met & (square >= 0.0) & within_reach
    return real
