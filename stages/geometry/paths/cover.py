"""How often a closed path of lines and arcs covers the plane, and the area that it covers too often.

The winding number W is constant between the pieces, so the integral of any f(W) over the plane is, by Green's theorem,
a sum over the pieces once they are cut where they meet:  the area swept by a piece times f(W on its left) - f(W on its
right).  With f(W) = max(W - 1, -W, 0) that is the area covered more than once or inside out.  W is counted exactly, by
the chords that pass a point and the circular segments that hold it; nothing is replaced by polygons.

Where m pieces run along each other within `COINCIDENT` of the size (an annulus wound twice), each counts for 1/m.
Slivers thinner than a few times that are not seen; apart from them the area is exact to rounding.

Symbols: s, e ends of a piece, b its bulge, T unit tangent at s, k curvature; g(P) = 2 T x (P - s) - k |P - s|^2 is 0 on
the carrier of a piece.  Along another piece, with x = tan(angle from its middle / 2) over its largest value,
(1 + b^2 x^2) g is a quadratic in x whose roots are where the two meet.
"""

from dataclasses import dataclass

import numpy as np
import shapely
from shapely import STRtree, box

from stages.geometry.arrays import Indices, Mask, Points2, Values, cross2, dot, norm
from stages.geometry.paths.arcpath import (
    ArcPath,
    along,
    bounds,
    chords,
    curvatures,
    directions,
    distances,
    lengths,
    split,
    sweeps,
    swept,
)
from stages.geometry.paths.overlap import QUARTER_BULGE, fractions_beside, near_pairs

COINCIDENT = 1e-8
"""Pieces nearer than this share of the path's size run along each other: fitted arcs are within 1e-9 of the edges that
they stand for, twice over, and the ends of pieces that meet there are off by as much."""

BLOCK = 500
"""Points whose winding numbers are counted in one go: 1e6 pairs where every piece is beside every point."""


@dataclass(frozen=True, slots=True, eq=False)
class Meeting:
    """Places where pieces of a path meet others: the piece by number, and the share of its sweep."""

    piece: Indices
    fraction: Values


def doubled(path: ArcPath) -> float:
    """Return the area that a closed path covers more than once or inside out, mm2; whichever way round it runs."""
    gentle = split(path, max_bulge=QUARTER_BULGE)
    low_x, low_y, high_x, high_y = bounds(gentle)
    apart = COINCIDENT * max(high_x - low_x, high_y - low_y)
    meeting = meetings(gentle, apart)
    if meeting.piece.size == 0:
        return 0.0
    cut = divided(gentle, meeting, apart)
    sense = 1.0 if np.sum(swept(cut, cut.vertices.mean(axis=0))) >= 0.0 else -1.0
    left, right, beside = _sides(cut, apart)
    gained = _excess(sense * left) - _excess(sense * right)
    middle = np.array([low_x + high_x, low_y + high_y]) / 2.0
    return max(float(np.sum(swept(cut, middle) * gained / beside)), 0.0)


def _excess(winding: Values) -> Values:
    """Return how often too often a place is covered: not at all for 0 and 1, any inside-out cover counts."""
    excess: Values = np.maximum(np.maximum(winding - 1.0, -winding), 0.0)
    return excess


def meetings(gentle: ArcPath, apart: float) -> Meeting:
    """Return where the pieces of a path meet, the joints of neighbours aside; arcs up to a quarter circle.

    Crossings, and ends of one piece within `apart` mm of another: on both pieces.
    """
    start, end = chords(gentle)
    first, second = near_pairs(start, end, gentle.bulges[: start.shape[0]], apart)
    found = [*_crossings(gentle, first, second, apart), *_crossings(gentle, second, first, apart)]
    for one, other in ((first, second), (second, first)):
        for points in (start[other], end[other]):
            found.append(_beside(gentle, one, other, points, apart))
    return Meeting(np.concatenate([m.piece for m in found]), np.concatenate([m.fraction for m in found]))


def _crossings(gentle: ArcPath, first: Indices, second: Indices, apart: float) -> tuple[Meeting, Meeting]:
    """Return on each second piece where it crosses the first, for both roots."""
    bulge = gentle.bulges[second]
    low, middle, high = (
        _carrier(gentle, first, along(gentle, second, np.full(first.size, f))) for f in (0.0, 0.5, 1.0)
    )
    weight = 1.0 + bulge**2
    b, c = weight * (high - low) / 2.0, weight * (high + low) / 2.0 - middle
    # middle + b x + c x^2 = 0; the root of larger size first, so that nothing cancels
    root = np.sqrt(np.maximum(b**2 - 4.0 * c * middle, 0.0))
    larger = -(b + np.copysign(root, b)) / 2.0
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        places = (larger / c, middle / larger)
    safe = np.where(bulge == 0.0, 1.0, bulge)
    met = []
    for place in places:
        inside = (np.abs(place) <= 1.0) & (b**2 >= 4.0 * c * middle)
        x = np.where(inside, place, 0.0)
        fraction = (1.0 + np.where(bulge == 0.0, x, np.arctan(safe * x) / np.arctan(safe))) / 2.0
        points = along(gentle, second, fraction)
        on = inside & (distances(points, gentle, first) <= apart) & ~_at_joint(gentle, first, second, points, apart)
        met.append(Meeting(second[on], fraction[on]))
    return met[0], met[1]


def _carrier(gentle: ArcPath, piece: Indices, points: Points2) -> Values:
    """Return g of each piece at its point: 0 on the line or circle that carries it, positive on its left."""
    start, _ = chords(gentle)
    angle = directions(gentle)[0][piece]
    offset = points - start[piece]
    tangent = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    carrier: Values = 2.0 * cross2(tangent, offset) - curvatures(gentle)[piece] * dot(offset, offset)
    return carrier


def _beside(gentle: ArcPath, one: Indices, other: Indices, points: Points2, apart: float) -> Meeting:
    """Return where an end of another piece lies on a piece."""
    on = (distances(points, gentle, one) <= apart) & ~_at_joint(gentle, one, other, points, apart)
    return Meeting(one[on], fractions_beside(gentle, one[on], points[on]))


def _at_joint(gentle: ArcPath, one: Indices, other: Indices, points: Points2, apart: float) -> Mask:
    """Return which points are merely the joint of two pieces that follow each other."""
    count = lengths(gentle).size
    joint = np.zeros(one.size, dtype=bool)
    for before, after in ((one, other), (other, one)):
        shared = gentle.vertices[after]
        follows = (before + 1) % count == after
        joint |= follows & (np.hypot(*(points - shared).T) <= 2.0 * apart)
    return joint


def divided(gentle: ArcPath, meeting: Meeting, apart: float) -> ArcPath:
    """Return the same path cut where its pieces meet; cuts within 4 `apart` mm of an end or of each other are one."""
    count = lengths(gentle).size
    piece = np.concatenate([np.arange(count), meeting.piece])
    fraction = np.concatenate([np.zeros(count), meeting.fraction])
    order = np.lexsort((fraction, piece))
    piece, fraction = piece[order], fraction[order]
    length = lengths(gentle)[piece]
    least = 4.0 * apart
    last = 0.0
    keep = np.zeros(piece.size, dtype=bool)
    for i, (share, whole) in enumerate(zip(fraction.tolist(), length.tolist(), strict=True)):
        first = i == 0 or piece[i] != piece[i - 1]
        keep[i] = first or ((share - last) * whole > least and (1.0 - share) * whole > least)
        last = share if keep[i] else last
    piece, fraction = piece[keep], fraction[keep]
    following = np.append(fraction[1:], 0.0)
    width = np.where(following > fraction, following, 1.0) - fraction
    vertices = along(gentle, piece, fraction)
    vertices[fraction == 0.0] = gentle.vertices
    return ArcPath(vertices, np.tan(sweeps(gentle)[piece] * width / 4.0), closed=True)


def _sides(cut: ArcPath, apart: float) -> tuple[Values, Values, Values]:
    """Return the winding numbers beside the middle of each piece, left and right, and how many pieces pass it.

    A piece passes where its ends lie on both sides of the normal there: of two that are joined just there, one.
    """
    count = lengths(cut).size
    every = np.arange(count)
    middles = along(cut, every, np.full(count, 0.5))
    first, last = directions(cut)
    across = (first + last) / 2.0 + np.pi / 2.0
    aside = 2.0 * apart * np.stack([np.cos(across), np.sin(across)], axis=1)
    left, right = windings(cut, middles + aside), windings(cut, middles - aside)
    start, end = chords(cut)
    one, other = near_pairs(start, end, cut.bulges, 2.0 * apart)
    beside = np.ones(count)
    for a, b in ((one, other), (other, one)):
        ahead = [cross2(points[b] - middles[a], aside[a]) > 0.0 for points in (start, end)]
        passes = (distances(middles[a], cut, b) <= 2.0 * apart) & (ahead[0] != ahead[1])
        beside += np.bincount(a[passes], minlength=count)
    return left, right, beside


def windings(path: ArcPath, points: Points2) -> Values:
    """Return how often a closed path winds about each point, counter-clockwise positive; arcs up to a half circle.

    The polygon of the chords, by its passages of the ray to the right; each circular segment that holds the point adds
    its sense.  Pieces above, below and left of a point do neither.  A point on the path may go either way.
    """
    start, end = chords(path)
    reach = np.abs(path.bulges[: start.shape[0]]) * norm(end - start) / 2.0
    low, high = np.minimum(start, end) - reach[:, None], np.maximum(start, end) + reach[:, None]
    leftmost = float(min(low[:, 0].min(), points[:, 0].min()))
    tree = STRtree(box(leftmost, low[:, 1], np.nextafter(high[:, 0], np.inf), high[:, 1]))
    wound = np.zeros(points.shape[0])
    for first in range(0, points.shape[0], BLOCK):
        place, piece = tree.query(shapely.points(points[first : first + BLOCK]))
        found = _passes(path, piece, points[first + place])
        wound[first : first + BLOCK] = np.bincount(place, found, minlength=wound[first : first + BLOCK].size)
    return wound


def _passes(path: ArcPath, piece: Indices, at: Points2) -> Values:
    """Return what each piece adds to the winding number of its point."""
    start, end = (ends[piece] for ends in chords(path))
    side = cross2(end - start, at - start)
    rises = (start[:, 1] <= at[:, 1]) & (end[:, 1] > at[:, 1]) & (side > 0.0)
    falls = (start[:, 1] > at[:, 1]) & (end[:, 1] <= at[:, 1]) & (side < 0.0)
    sense = np.sign(path.bulges[piece])
    held = (_carrier(path, piece, at) * sense > 0.0) & (side * sense < 0.0)
    added: Values = rises.astype(np.float64) - falls + held * sense
    return added
