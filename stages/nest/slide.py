"""How far a polygon can be pushed before it touches others, exactly, and the place it comes to rest.

Along -x, a vertex of the moving polygon meets an edge in front of it, or a vertex in front meets one of its edges; the
least of these ways is free.  Edges along the motion are passed by, middles of edges stand for equal edges face to
face.  A tip that meets a tip exactly is not seen: whoever slides tests the result for overlap.
"""

from typing import NamedTuple

import numpy as np

from stages.geometry.arrays import Array, Indices, Points2

TOUCH_MM = 1e-7
"""What overlaps by less counts as touching: above the rounding of coordinates of 1e4 mm, below the slack."""


class Outline(NamedTuple):
    """Edges by start and end points, mm."""

    start: Points2
    end: Points2


NOTHING = Outline(np.zeros((0, 2)), np.zeros((0, 2)))


def moved(outline: Outline, x: float, y: float) -> Outline:
    """Return the edges moved by (x, y)."""
    return Outline(outline.start + np.array([x, y]), outline.end + np.array([x, y]))


def together(a: Outline, b: Outline) -> Outline:
    """Return the edges of both."""
    return Outline(np.concatenate([a.start, b.start]), np.concatenate([a.end, b.end]))


def way_left(moving: Outline, fixed: Outline, most_mm: float) -> float:
    """Return how far `moving` can go along -x, at most `most_mm`, before it touches `fixed`."""
    near = _in_front(moving, fixed, most_mm)
    own = np.concatenate([moving.start, (moving.start + moving.end) / 2.0])
    front = np.concatenate([near.start, (near.start + near.end) / 2.0])
    return min(_least(own, near, 1.0), _least(front, moving, -1.0), most_mm)


def way_down(moving: Outline, fixed: Outline, most_mm: float) -> float:
    """Return how far `moving` can go along -y, at most `most_mm`, before it touches `fixed`."""
    return way_left(_swapped(moving), _swapped(fixed), most_mm)


def _swapped(outline: Outline) -> Outline:
    return Outline(outline.start[:, ::-1], outline.end[:, ::-1])


def _in_front(moving: Outline, fixed: Outline, most_mm: float) -> Outline:
    """Return the fixed edges that the motion can meet."""
    low, high = moving.start.min(axis=0), moving.start.max(axis=0)
    least, most = np.minimum(fixed.start, fixed.end), np.maximum(fixed.start, fixed.end)
    meets = (most[:, 1] > low[1]) & (least[:, 1] < high[1])
    keep: Indices = np.flatnonzero(meets & (most[:, 0] > low[0] - most_mm - TOUCH_MM) & (least[:, 0] < high[0]))
    return Outline(fixed.start[keep], fixed.end[keep])


def _least(points: Points2, edges: Outline, sense: float) -> float:
    """Return the least way along -x * sense from a point to an edge that lies in front of it; inf if none does."""
    rise = (edges.end - edges.start)[None, :, 1]
    above: Array = points[:, None, 1] - edges.start[None, :, 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = above / rise
        x = edges.start[None, :, 0] + share * (edges.end - edges.start)[None, :, 0]
        way = sense * (points[:, None, 0] - x)
        margin = TOUCH_MM / np.abs(rise)
        met = (share > margin) & (share < 1.0 - margin) & (way > -TOUCH_MM)
    return float(np.maximum(way[met], 0.0).min(initial=np.inf))
