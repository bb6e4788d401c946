"""Closed polygons with their corners on exact edges, by the fewest chords.

Points along each edge are near enough to stand for it.  From one of them a chord goes to the furthest that leaves all
points between within the accuracy of it; then the accuracy is lowered as far as the number of chords does not rise, so
that no short one is left over at the end [1]_.  Since edge and chord have their ends in common, every point of the
chord is as near to the edge as the edge to the chord.  Ends of edges stay corners; edges of no length (an apex) have
none.

.. [1] H. Imai, M. Iri, "Computational-geometric methods for polygonal approximations of a curve", CVGIP 36, 1986.
"""

from collections.abc import Sequence

import numpy as np

from stages.errors import NoSolutionError
from stages.geometry.arcpath import ArcPath
from stages.geometry.arrays import Array, Numbers, Points2, norm
from stages.geometry.biarc import ZERO_LENGTH_MM
from stages.geometry.plane import PlaneCurve
from stages.geometry.sampling import dense_points, resolved

GRID_SHARE = 0.01
"""How well the points know the edge, as a share of the accuracy."""

CHORD_SHARE = 0.95
"""What chords may use of the accuracy; the rest is for those points, and for the bound of a distance found later."""

LEAST_CORNERS = 3
NONE = np.zeros((0, 2))
EVENINGS = 8
"""Bisections of the accuracy: after these the chords of an edge are as even as 1/256 of the accuracy makes them."""

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
        dense = [dense_points(edge, accuracy=GRID_SHARE * accuracy) for edge in known]
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
    """Return the fewest of the points, first and last among them, whose polygon is within `accuracy` of all."""
    best = _greedy(points, accuracy)
    low, high = 0.0, accuracy
    for _ in range(EVENINGS if best.size > 2 else 0):  # noqa: PLR2004  one chord is even
        middle = (low + high) / 2.0
        found = _greedy(points, middle)
        if found.size == best.size:
            best, high = found, middle
        else:
            low = middle
    corners: Array = points[best]
    return corners


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
