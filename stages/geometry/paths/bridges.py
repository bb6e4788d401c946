"""The narrowest places between contours, and of a contour with itself, with the points on both sides: closed form.

Two places of contours face each other where the distance of their pieces is least and grows whichever way either moves
on, over the ends of the pieces too: ends where a neighbour comes nearer are none.  The line from the one to the other
leaves to the left of the contour, where the material is: to its right there is a notch or a slot.  Candidates for the
least distance of two lines or arcs are their ends and their common normals, as in `clearance`.

Pieces that share an end are no pair: in a corner the distance is 0.  Of what runs beside each other, one place is told.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from shapely import STRtree, box

from stages.geometry.arrays import Mask, Numbers, Points2, Values, Vector2, cross2, dot, norm, unit
from stages.geometry.paths.arcpath import ArcPath, split
from stages.geometry.paths.clearance import Pieces, arc_point, boxes, crossing, joined, normal_points, pieces
from stages.geometry.paths.overlap import QUARTER_BULGE

TOWARDS = 1e-9
"""A neighbour that leads nearer by less than this share of its way runs across: rounding of directions."""

AT_END = 1e-9
"""A place this share of its piece's chord from its end is that end."""


@dataclass(frozen=True, slots=True)
class Bridge:
    """Two places that face each other, x and y, the contours that they lie on by number, and how far they are, mm."""

    first: int
    second: int
    at: tuple[float, float]
    to: tuple[float, float]
    width_mm: float


class Found(NamedTuple):
    """Pairs of pieces by number, places on both, and their distance."""

    one: Numbers
    other: Numbers
    at: Points2
    to: Points2
    width: Values


def webs(paths: Sequence[ArcPath], *, within: float) -> list[Bridge]:
    """Return the narrowest web, material between two cuts, of every two contours and of each with itself.

    paths: closed, none touching another, material to their left.  within: how wide it is at most, mm.
    """
    gentle = [split(path, max_bulge=QUARTER_BULGE) for path in paths]
    some = joined([pieces(path) for path in gentle])
    count = np.array([path.bulges.size for path in gentle], dtype=np.int64)
    owner = np.repeat(np.arange(count.size), count)
    first = np.repeat(np.cumsum(count) - count, count)
    number = np.arange(owner.size) - first
    after = first + (number + 1) % count[owner]
    before = first + (number - 1) % count[owner]
    one, other = _near(some, after, before, within)
    found = _facing(some, one, other)
    leaves = cross2(_tangents(some, found.one, found.at), found.to - found.at) > 0.0
    keep = leaves & (found.width <= within) & (found.width > 0.0)
    for place, piece, towards in ((found.at, found.one, found.to), (found.to, found.other, found.at)):
        keep &= _is_least(some, piece, place, towards, (after, before))
    least: dict[tuple[int, int], Bridge] = {}
    for k in np.flatnonzero(keep)[np.argsort(found.width[keep], kind="stable")].tolist():
        pair = int(owner[found.one[k]]), int(owner[found.other[k]])
        least.setdefault(pair, Bridge(*pair, _point(found.at[k]), _point(found.to[k]), float(found.width[k])))
    return [least[pair] for pair in sorted(least)]


def _point(at: Vector2) -> tuple[float, float]:
    x, y = at.tolist()
    return x, y


def _near(some: Pieces, after: Numbers, before: Numbers, within: float) -> tuple[Numbers, Numbers]:
    """Return the pairs of pieces, the smaller first, that share no end and whose boxes are not too far apart."""
    low_high = boxes(some)
    tree = STRtree(box(*low_high.T))
    one, other = tree.query(box(*(low_high[:, :2] - within).T, *(low_high[:, 2:] + within).T))
    apart = (one < other) & (after[one] != other) & (before[one] != other)
    return one[apart].astype(np.int64), other[apart].astype(np.int64)


def _facing(some: Pieces, one: Numbers, other: Numbers) -> Found:
    """Return the places of two pieces each that are nearest to each other."""
    a, b = some.take(one), some.take(other)
    at, to, width = a.start, b.start, np.full(one.size, np.inf)
    for swapped, (p, q) in enumerate(((a, b), (b, a))):
        for point in (_amid(p, q), *normal_points(p, q), p.start, p.end):
            foot = _foot(point, q)
            away = norm(foot - point)
            nearer = (away < width * (1.0 - AT_END))[:, None]
            at, to = np.where(nearer, foot if swapped else point, at), np.where(nearer, point if swapped else foot, to)
            width = np.minimum(width, away)
    width = np.where(crossing(a, b), 0.0, width)
    return Found(one, other, at, to, width)


def _amid(p: Pieces, q: Pieces) -> Points2:
    """Return a place amid what of each piece is beside its partner: where both run on at one distance, no end of it."""
    middle = (_foot(q.start, p) + _foot(q.end, p)) / 2.0
    return _foot(middle, p)


def _foot(point: Points2, of: Pieces) -> Points2:
    """Return the place of each piece that is nearest to its point."""
    chord = of.end - of.start
    share = np.clip(dot(point - of.start, chord) / dot(chord, chord), 0.0, 1.0)
    on_arc = arc_point(of, point - of.centre)
    foot: Points2 = np.where((of.bulge == 0.0)[:, None], of.start + share[:, None] * chord, on_arc)
    return foot


def _tangents(some: Pieces, piece: Numbers, at: Points2) -> Points2:
    """Return the unit directions of pieces at places on them."""
    of = some.take(piece)
    spoke = at - of.centre
    turned = np.sign(of.bulge)[:, None] * np.stack([-spoke[:, 1], spoke[:, 0]], axis=1)
    tangents: Points2 = unit(np.where((of.bulge == 0.0)[:, None], of.end - of.start, turned))
    return tangents


def _is_least(some: Pieces, piece: Numbers, place: Points2, towards: Points2, around: tuple[Numbers, Numbers]) -> Mask:
    """Return which places are not led nearer by the piece that goes on where theirs ends."""
    of = some.take(piece)
    near = AT_END * norm(of.end - of.start)
    forward = unit(towards - place)
    after, before = around
    onward = dot(_tangents(some, after[piece], of.end), forward)
    backward = -dot(_tangents(some, before[piece], of.start), forward)
    least: Mask = ((norm(place - of.end) > near) | (onward <= TOWARDS)) & (
        (norm(place - of.start) > near) | (backward <= TOWARDS)
    )
    return least
