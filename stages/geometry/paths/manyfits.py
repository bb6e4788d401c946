"""How well each of many ways of a beam lies half a beam beside its own contour: small ones in a few passes over all.

A sheet has hundreds of copies of contours of a few pieces each, and one by one they take longer than all else that is
asked of a file.  Every piece of a way is paired with the pieces of its contour that may be near, and every place with
every piece.  Contours of many pieces are measured one by one, by trees (`compensation.fit`).  Both say the same.
"""

from collections.abc import Sequence

import numpy as np

from stages.geometry.arrays import Array, Numbers, Points2, Values
from stages.geometry.paths.arcpath import ArcPath
from stages.geometry.paths.clearance import Pieces, boxes, distances, point_distances
from stages.geometry.paths.compensation import Fit, fit, looked_at, middles
from stages.geometry.paths.manypaths import pieces

FEW_PAIRS = 2048
"""Pairs of pieces up to which a contour is measured with others."""

BLOCK = 200_000
"""Pairs that are looked at together: their arrays take some 100 MB."""

Measured = tuple[ArcPath, ArcPath]
"""A contour and the way beside it."""

Pairs = tuple[Numbers, Numbers, Numbers]
"""Places in two rows, and the number of what both belong to."""


def fits(contours: Sequence[ArcPath], ways: Sequence[ArcPath], half_mm: float) -> list[Fit]:
    """Return how well each way lies half a beam beside its contour."""
    every = list(zip(contours, ways, strict=True))
    sizes = np.array([contour.bulges.size * way.bulges.size for contour, way in every], dtype=np.int64)
    found: dict[int, Fit] = {}
    for block in _blocks(np.flatnonzero(sizes <= FEW_PAIRS), sizes):
        found |= zip(block.tolist(), _together([every[number] for number in block], half_mm), strict=True)
    return [found.get(number) or fit(*pair, half_mm) for number, pair in enumerate(every)]


def _blocks(numbers: Numbers, sizes: Numbers) -> list[Numbers]:
    """Return the numbers in blocks of about `BLOCK` pairs."""
    turns = np.flatnonzero(np.diff(np.cumsum(sizes[numbers]) // BLOCK)) + 1
    return [block for block in np.split(numbers, turns) if block.size]


def _together(every: Sequence[Measured], half_mm: float) -> list[Fit]:
    contours, ways = ([pair[k] for pair in every] for k in (0, 1))
    (of_contours, contour), (of_ways, way) = pieces(contours), pieces(ways)
    one, other, owner = _near(_pairs(way, contour, len(every)), of_ways, of_contours, 2.0 * half_mm)
    near = _most(-distances(of_ways.take(one), of_contours.take(other)), owner, np.full(len(every), -np.inf))
    amid, on = middles(ways, half_mm)
    off = _most(np.abs(_nearest(amid, on, of_contours, contour) - half_mm), on, np.zeros(len(every)))
    places, at = looked_at(contours)
    left = _most(_nearest(places, at, of_ways, way) - half_mm, at, np.zeros(len(every)))
    return [
        Fit(max(half_mm + near_mm, off_mm), left_mm) if -near_mm <= 2.0 * half_mm else Fit(np.inf, np.inf)
        for near_mm, off_mm, left_mm in zip(near.tolist(), off.tolist(), left.tolist(), strict=True)
    ]


def _near(pairs: Pairs, some: Pieces, others: Pieces, within: float) -> Pairs:
    """Return the pairs of pieces whose boxes are not farther apart than that, mm."""
    one, other, owner = pairs
    (low, high), (from_low, to_high) = (np.split(boxes(pieces), 2, axis=1) for pieces in (some, others))
    apart = np.maximum(low[one] - to_high[other], from_low[other] - high[one]).max(axis=1)
    chosen = np.flatnonzero(apart <= within)
    return one[chosen], other[chosen], owner[chosen]


def _most(values: Array, owner: Numbers, least: Array) -> Array:
    """Return the largest of the values of each owner, or its least one."""
    np.maximum.at(least, owner, values)
    return least


def _nearest(places: Points2, owner: Numbers, to: Pieces, of: Numbers) -> Values:
    """Return the distance of each place to the pieces of the contour of its number, mm; of: that of each piece."""
    one, other, _ = _pairs(owner, of, int(of[-1]) + 1)
    return -_most(-point_distances(places[one], to.take(other)), one, np.full(places.shape[0], -np.inf))


def _pairs(some: Numbers, others: Numbers, count: int) -> Pairs:
    """Return all pairs of places in two rows of one owner, and that; the rows hold owners, rising, below a count."""
    first, second = np.bincount(some, minlength=count), np.bincount(others, minlength=count)
    both = first * second
    owner = np.repeat(np.arange(count), both)
    place = np.arange(owner.size) - np.repeat(np.cumsum(both) - both, both)
    start, begin = np.cumsum(first) - first, np.cumsum(second) - second
    return start[owner] + place // second[owner], begin[owner] + place % second[owner], owner
