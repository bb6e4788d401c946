"""The way of a beam's middle around a contour, half a beam beside it, and whether what it leaves is the contour.

The beam is as wide as a disc of that diameter: it reaches every place of the contour but inner corners, where the disc
leaves something standing, and notches narrower than it, where it leaves all.  What is left standing at a place of the
contour is its distance from the way, less half the beam.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import ArrayValue, Numbers, Points2, Vector2
from stages.geometry.paths.arcpath import ArcPath, along, area, lengths
from stages.geometry.paths.beside import Corners, beside, nearest
from stages.geometry.paths.clearance import clearance, pieces
from stages.geometry.paths.manypaths import piece_lengths, points_at, row

SHARES = (0.0, 0.25, 0.5, 0.75)
"""Where on each piece it is measured what is left standing: the deepest place is a vertex, or amid an arc."""

DEEPEST_BEAMS = 1.0
"""More than a beam's width left standing is no inner corner any more but a notch that the beam does not enter: in a
corner of two lines that is so below 39 degrees."""

LONG_HALVES = 4.0
"""Pieces of a way this many half beams long have their middles beside a piece of the contour, mitred corners or not."""


@dataclass(frozen=True, slots=True, eq=False)
class TooNarrow(ArrayValue):
    """Where a contour is narrower than the beam; left_mm: how much is left standing there, infinite: nothing is cut."""

    at: Vector2
    left_mm: float


@dataclass(frozen=True, slots=True)
class Fit:
    """A way against its contour, in mm.

    off_mm: how far the middles of its long pieces are from lying half a beam beside it, or any place of it is nearer.
    left_mm: the most that is left standing.
    """

    off_mm: float
    left_mm: float


def compensated(contour: ArcPath, half_mm: float, corners: Corners) -> ArcPath | TooNarrow:
    """Return the way of the beam on the right of a closed contour, or where that is too narrow for it."""
    ways = beside(contour, half_mm, corners)
    if len(ways) == 1 and area(ways[0]) * area(contour) > 0.0:
        at, left = _most_left(contour, ways[0], half_mm)
        return ways[0] if left <= DEEPEST_BEAMS * 2.0 * half_mm else TooNarrow(at, left)
    every = np.arange(lengths(contour).size)
    if not ways:
        return TooNarrow(along(contour, every, np.full(every.size, 0.5)).mean(axis=0), np.inf)
    first, second = (way.vertices for way in ways[:2])
    apart = np.hypot(*(first[:, None] - second[None]).transpose(2, 0, 1))
    one, other = np.unravel_index(int(apart.argmin()), apart.shape)
    return TooNarrow((first[one] + second[other]) / 2.0, np.inf)


def fit(contour: ArcPath, way: ArcPath, half_mm: float) -> Fit:
    """Return how well a way lies half a beam beside a contour, however it was made."""
    nearer = half_mm - clearance(pieces(way), pieces(contour), within=2.0 * half_mm)
    if not np.isfinite(nearer):
        return Fit(np.inf, np.inf)
    off = np.abs(nearest(middles([way], half_mm)[0], contour, 2.0 * half_mm) - half_mm)
    return Fit(max(nearer, float(off.max(initial=0.0))), _most_left(contour, way, half_mm)[1])


def middles(ways: Sequence[ArcPath], half_mm: float) -> tuple[Points2, Numbers]:
    """Return the middles of the long pieces of some ways, and the number of the way of each."""
    every = row(ways)
    long = np.flatnonzero(piece_lengths(every) > LONG_HALVES * half_mm)
    return points_at(every, long, np.full(long.size, 0.5)), every.owner[long]


def _most_left(contour: ArcPath, way: ArcPath, half_mm: float) -> tuple[Vector2, float]:
    """Return where on a contour the most is left standing, and how much, mm."""
    places, _ = looked_at([contour])
    reach = (1.0 + 2.0 * DEEPEST_BEAMS) * half_mm
    far = nearest(places, way, 2.0 * reach)
    while not np.isfinite(far).all():
        reach *= 2.0
        far = nearest(places, way, 2.0 * reach)
    most = int(far.argmax())
    return places[most], max(float(far[most]) - half_mm, 0.0)


def looked_at(contours: Sequence[ArcPath]) -> tuple[Points2, Numbers]:
    """Return the places of some contours at which it is measured, and the number of the contour of each."""
    every = row(contours)
    piece = np.repeat(np.arange(every.bulge.size), len(SHARES))
    return points_at(every, piece, np.tile(SHARES, every.bulge.size)), every.owner[piece]
