"""Where paths of lines and arcs run along each other: cuts that would be made twice.

An overlap of two pieces begins and ends at an end of one of them.  So the ends of the second are projected onto the
first, and each interval between is tested at three inner points against their exact distance to the second piece.
Pieces that only cross or touch are never reported, however small their angle; pieces that run near each other and part
within one interval are not either.  Pairs are found on their boxes.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from shapely import STRtree, box

from stages.geometry.arrays import Array, Indices, Numbers, Points2, Values, norm
from stages.geometry.paths import arcs
from stages.geometry.paths.arcpath import ArcPath, along, chords, curvatures, distances, lengths, sweeps
from stages.geometry.paths.manypaths import Row, points_at, row

QUARTER_BULGE = 0.41421356237309503
"""tan(pi / 8): longer arcs are divided into pieces of a quarter turn at most, none of which bends back on itself."""
INNER = (0.25, 0.5, 0.75)
"""Where an interval is tested, as shares of it."""

NEARLY_STRAIGHT = 1e-6
"""Below this sweep (rad) the share of the chord stands for the share of the arc: they differ by sweep^2 / 24."""


@dataclass(frozen=True, slots=True)
class Overlap:
    """Two paths by number (the same one twice if it runs back along itself) and the length they share, in mm."""

    first: int
    second: int
    length_mm: float


def overlaps(paths: Sequence[ArcPath], *, apart: float, least: float) -> list[Overlap]:
    """Return the pairs of paths that run within `apart` mm of each other for more than `least` mm together."""
    loose, owner = _loose(paths)
    start, end = chords(loose)
    first, second = near_pairs(start[::2], end[::2], loose.bulges[::2], apart)
    shared = _shared(loose, first, second, apart) if first.size else np.zeros(0)
    found: dict[tuple[int, int], float] = {}
    for a, b, length in zip(owner[first].tolist(), owner[second].tolist(), shared.tolist(), strict=True):
        key = (min(a, b), max(a, b))
        found[key] = found.get(key, 0.0) + length
    return [Overlap(a, b, length) for (a, b), length in sorted(found.items()) if length > least]


def _loose(paths: Sequence[ArcPath]) -> tuple[ArcPath, Numbers]:
    """Return all pieces as the even pieces of one path, and the number of the path that each is from.

    The odd pieces, which lead from one to the next, mean nothing.  Longer arcs than a quarter turn are divided.
    """
    every = row(paths)
    sweep, most = arcs.sweeps(every.bulge), 4.0 * np.arctan(QUARTER_BULGE)
    count = np.maximum(np.ceil(np.abs(sweep) / most - arcs.ROUNDING), 1.0).astype(np.int64)
    piece = np.repeat(np.arange(count.size), count)
    within = np.arange(piece.size) - np.repeat(np.cumsum(count) - count, count)
    ends = [_at(every, piece, (within + far) / count[piece]) for far in (0.0, 1.0)]
    bulge = np.where(count == 1, every.bulge, np.tan(sweep / (4.0 * count)))[piece]
    bulges = np.stack([bulge, np.zeros_like(bulge)], axis=1).ravel()
    return ArcPath(np.stack(ends, axis=1).reshape(-1, 2), bulges, closed=True), every.owner[piece]


def _at(every: Row, piece: Indices, share: Values) -> Points2:
    """Return the points at shares of the sweep of pieces; their ends as they are."""
    first, last = (share == 0.0)[:, None], (share == 1.0)[:, None]
    return np.where(first, every.start[piece], np.where(last, every.end[piece], points_at(every, piece, share)))


def near_pairs(start: Array, end: Array, bulge: Array, apart: float) -> tuple[Indices, Indices]:
    """Return the pairs of gentle pieces whose boxes come within 2 `apart` mm, each once, the smaller index first.

    Start and end are of shape (n, 2), the bulges of shape (n,).
    """
    margin = np.abs(bulge) * norm(end - start) / 2.0 + apart
    low, high = np.minimum(start, end), np.maximum(start, end)
    boxes = box(low[:, 0] - margin, low[:, 1] - margin, high[:, 0] + margin, high[:, 1] + margin)
    a, b = STRtree(boxes).query(boxes)
    once = a < b
    return a[once].astype(np.int64), b[once].astype(np.int64)


def _shared(loose: ArcPath, first: Indices, second: Indices, apart: float) -> Values:
    """Return the length in mm over which the second piece of each pair runs along the first."""
    start, end = (points[::2][second] for points in chords(loose))
    marks = np.zeros((first.size, 4))
    marks[:, 1] = fractions_beside(loose, 2 * first, start)
    marks[:, 2] = fractions_beside(loose, 2 * first, end)
    marks[:, 3] = 1.0
    marks[:, 1:3].sort(axis=1)
    shared = np.zeros(first.size)
    whole = lengths(loose)[2 * first]
    for k in range(3):
        width = marks[:, k + 1] - marks[:, k]
        beside = width * whole > apart
        for inner in INNER:
            points = along(loose, 2 * first, marks[:, k] + inner * width)
            beside &= distances(points, loose, 2 * second) <= apart
        shared += np.where(beside, width * whole, 0.0)
    return shared


def fractions_beside(path: ArcPath, piece: Indices, points: Points2) -> Values:
    """Return at which share of each piece the point beside it lies, in [0, 1]; for sweeps up to a quarter circle."""
    start, end = (ends[piece] for ends in chords(path))
    half, curvature = sweeps(path)[piece] / 2.0, curvatures(path)[piece]
    chord, reach = norm(end - start), norm(points - start)
    arc = np.arcsin(np.clip(reach * np.abs(curvature) / 2.0, 0.0, 1.0))
    curved = np.abs(half) > NEARLY_STRAIGHT
    share: Array = np.where(
        curved,
        arc / np.where(curved, np.abs(half), 1.0),
        np.divide(reach, chord, out=np.zeros_like(reach), where=chord > 0.0),
    )
    ahead = np.einsum("ij,ij->i", points - start, end - start) > 0.0
    fraction: Values = np.where(ahead, np.clip(share, 0.0, 1.0), 0.0)
    return fraction
