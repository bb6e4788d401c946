"""Closed polygons with their corners on exact edges, by next to the fewest chords.

Points along each edge are near enough to stand for it.  From one of them a chord goes to the furthest that leaves all
points between within the accuracy of it [1]_, from the first point on, and from the last one back.  Corners are laid
between what both give, the first ones next to the first, the last ones next to the last, so that no short chord is left
over at an end.  Since edge and chord have their ends in common, every point of the chord is as near to the edge as the
edge to the chord.  Ends of edges stay corners; edges of no length (an apex) have none.

How far from the fewest: on an arc of a circle, where equal chords are the fewest, 1.8 % for the share of the accuracy
that is kept back, and up to one in `STEPS` for corners that stand on points.  Where the height over a chord does not
rise with its end all along, a longer chord may be missed: the furthest is found by halving.

.. [1] H. Imai, M. Iri, "Computational-geometric methods for polygonal approximations of a curve", CVGIP 36, 1986.
"""

from collections.abc import Sequence

import numpy as np

from stages.errors import NoSolutionError
from stages.geometry.arrays import Array, Numbers, Points2, norm
from stages.geometry.curves.plane import PlaneCurve
from stages.geometry.flat.sampling import dense_points, resolved
from stages.geometry.paths.arcpath import ArcPath
from stages.geometry.paths.biarc import ZERO_LENGTH_MM

GRID_SHARE = 0.01
"""How well the grid knows the edge by which points are spread over it, as a share of the accuracy."""

STEPS = 44
"""The least number of steps from point to point that make up the longest chord of an arc."""

CHORD_SHARE = 0.965
"""What chords may use of the accuracy; the rest is for what is between the points, and for the bound of a distance
found later, which is 0.03 of it above what it finds."""

POINT_SHARE = CHORD_SHARE / STEPS**2
"""How near the points are to the edge as a polygon, as a share of the accuracy: heights go with the square of steps."""

LEAST_CORNERS = 3
NONE = np.zeros((0, 2))
FINER = 0.25
"""Where an edge is so small that its chords enclose nothing, they are laid within this share of the accuracy."""


def inscribed(edges: Sequence[PlaneCurve], *, accuracy: float) -> ArcPath:
    """Return a closed path of chords within `accuracy` mm of the edges, both ways.

    Raises NoSolutionError for edges that are all points.
    """
    return chorded(edges, accuracy)[0]


def chorded(edges: Sequence[PlaneCurve], accuracy: float) -> tuple[ArcPath, Numbers]:
    """Return that path, and of each of its chords the number of the edge that it stands for."""
    known = [resolved(edge, accuracy=GRID_SHARE * accuracy) for edge in edges]
    while True:
        dense = [dense_points(edge, accuracy=POINT_SHARE * accuracy) for edge in known]
        if not any(map(has_length, dense)):
            raise NoSolutionError("a contour of points", reached=0.0, wanted=ZERO_LENGTH_MM, unit="mm")
        corners = [_corners(points, CHORD_SHARE * accuracy)[:-1] if has_length(points) else NONE for points in dense]
        counts = [some.shape[0] for some in corners]
        if sum(counts) >= LEAST_CORNERS:
            path = ArcPath(np.concatenate(corners), np.zeros(sum(counts)), closed=True)
            return path, np.repeat(np.arange(len(edges)), counts)
        accuracy *= FINER


def has_length(points: Points2) -> bool:
    """Return whether points along an edge are apart."""
    return float(norm(points - points[0]).max()) > ZERO_LENGTH_MM


def _corners(points: Points2, accuracy: float) -> Array:
    """Return few of the points, first and last among them, whose polygon is within `accuracy` of all."""
    last = points.shape[0] - 1
    forth, back = _greedy(points, accuracy), last - _greedy(points[::-1], accuracy)[::-1]
    corners: Array = points[_evenly(points, forth, back, accuracy) if forth.size == back.size else forth]
    return corners


def _evenly(points: Points2, forth: Numbers, back: Numbers, accuracy: float) -> Numbers:
    """Return the numbers of as many points, from those that go forth at the first over to those that go back."""
    share, last = np.arange(forth.size) / (forth.size - 1), points.shape[0] - 1
    chosen = [0]
    for to in np.rint(forth + share * (back - forth)).astype(np.int64)[1:].tolist():
        start = chosen[-1]
        if start == last:
            break
        near = to > start and _height(points[start : to + 1]) <= accuracy
        chosen.append(to if near else start + _reach(points, start, max(to - start, 1), accuracy))
    return np.array(chosen) if chosen[-1] == last else forth


def _greedy(points: Points2, accuracy: float) -> Numbers:
    """Return the numbers of points of which each is the furthest that a chord from the one before may reach."""
    last = points.shape[0] - 1
    chosen, stride = [0], last
    while chosen[-1] < last:
        reach = _reach(points, chosen[-1], min(stride, last - chosen[-1]), accuracy)
        chosen.append(chosen[-1] + reach)
        stride = 2 * reach
    return np.array(chosen)


def _reach(points: Points2, start: int, stride: int, accuracy: float) -> int:
    """Return how many points further a chord may go, found by doubling and halving from a stride."""
    last = points.shape[0] - 1 - start
    low, high = 1, stride
    while high < last and _height(points[start : start + high + 1]) <= accuracy:
        low, high = high, min(2 * high, last)
    if _height(points[start : start + high + 1]) <= accuracy:
        return high
    while high - low > 1:
        middle = (low + high) // 2
        if _height(points[start : start + middle + 1]) <= accuracy:
            low = middle
        else:
            high = middle
    return low


def _height(points: Points2) -> float:
    """Return how far points are from the chord between the first and the last of them, mm."""
    chord = points[-1] - points[0]
    square = float(chord @ chord)
    offset = points - points[0]
    share = np.clip(offset @ chord / square, 0.0, 1.0) if square > 0.0 else np.zeros(points.shape[0])
    return float(norm(offset - share[:, None] * chord).max())
