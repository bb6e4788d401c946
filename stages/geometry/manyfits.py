"""How well each of many ways of a beam lies half a beam beside its own contour: small ones in a few passes over all.

A sheet has hundreds of copies of contours of a few pieces each, and one by one they take longer than all else that is
asked of a file.  Every piece of a way is paired with every piece of its contour, and every place with every piece.
Contours of many pieces are measured one by one, by trees (`compensation.fit`).  Both say the same.
"""

from collections.abc import Sequence

import numpy as np

from stages.geometry.arcpath import ArcPath
from stages.geometry.arrays import Array, Numbers, Values
from stages.geometry.clearance import Pieces, distances, joined, pieces, point_distances
from stages.geometry.compensation import Fit, fit, looked_at, middles

FEW_PAIRS = 2048
"""Pairs of pieces up to which a contour is measured with others."""

BLOCK = 200_000
"""Pairs that are looked at together: their arrays take some 100 MB."""

Measured = tuple[ArcPath, ArcPath]
"""A contour and the way beside it."""


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
    contours, ways = [pieces(contour) for contour, _ in every], [pieces(way) for _, way in every]
    apart = _nearest_pieces(ways, contours)
    off = [np.abs(far - half_mm) for far in _nearest([middles(way, half_mm) for _, way in every], contours)]
    left = _nearest([looked_at(contour) for contour, _ in every], ways)
    return [
        Fit(max(half_mm - near, float(one.max(initial=0.0))), max(float(most.max()) - half_mm, 0.0))
        if near <= 2.0 * half_mm
        else Fit(np.inf, np.inf)
        for near, one, most in zip(apart.tolist(), off, left, strict=True)
    ]


def _nearest_pieces(some: Sequence[Pieces], others: Sequence[Pieces]) -> Values:
    """Return the smallest distance of each set of pieces to the other set of its number, mm."""
    one, other, owner = _pairs([part.bulge.size for part in some], [part.bulge.size for part in others])
    least: Values = np.full(len(some), np.inf)
    np.minimum.at(least, owner, distances(joined(some).take(one), joined(others).take(other)))
    return least


def _nearest(places: Sequence[Array], to: Sequence[Pieces]) -> list[Array]:
    """Return the distance of each place of each set to the pieces of its number, mm."""
    counts = [part.shape[0] for part in places]
    one, other, _ = _pairs(counts, [part.bulge.size for part in to])
    least = np.full(sum(counts), np.inf)
    np.minimum.at(least, one, point_distances(np.concatenate(places)[one], joined(to).take(other)))
    return np.split(least, np.cumsum(counts)[:-1])


def _pairs(some: Sequence[int], others: Sequence[int]) -> tuple[Numbers, Numbers, Numbers]:
    """Return all pairs of one of `some[k]` and one of `others[k]` for each k, as places in both rows, and k."""
    first, second = np.array(some, dtype=np.int64), np.array(others, dtype=np.int64)
    count = first * second
    owner = np.repeat(np.arange(count.size), count)
    place = np.arange(owner.size) - np.repeat(np.cumsum(count) - count, count)
    start, begin = np.cumsum(first) - first, np.cumsum(second) - second
    return start[owner] + place // second[owner], begin[owner] + place % second[owner], owner
