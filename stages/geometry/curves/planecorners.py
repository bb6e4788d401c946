"""The corners of an outline that is known by points only.

A corner is where the polygon turns by `POLYGON_TURN`, or where the circles through the three points on either side
leave the point in directions that differ by `CORNER`.  A circle fits a circle, however unevenly it is divided: it has
no corners.  The sharpest is taken first; no circle reaches across a corner that was taken.

What cannot be told is whether a coarse circle was meant as a polygon: one of fewer than nine sides is a polygon here.
"""

from math import atan2, radians

import numpy as np

from stages.geometry.arrays import Numbers, Points2, Values, Vector2, cross2, norm

POLYGON_TURN = radians(44.0)
"""A polygon of eight sides turns by 45 deg at each: what turns more was never a smooth curve."""

CORNER = radians(12.0)
"""Where a circle through three neighbours misses the direction of a smooth edge by half of it, the edge is sampled too
coarsely to tell."""


def corners(points: Points2) -> Numbers:
    """Return the numbers of the points at which a closed polygon has a corner, in order."""
    count = len(points)
    found: set[int] = {int(i) for i in np.flatnonzero(np.abs(_turns(points)) >= POLYGON_TURN)}
    sharp = {i: _kink(points, i, found) for i in range(count) if i not in found}
    while sharp:
        worst = max(sharp, key=lambda i: sharp[i])
        if sharp[worst] < CORNER:
            break
        found.add(worst)
        del sharp[worst]
        for i in {(worst + step) % count for step in (-2, -1, 1, 2)} & sharp.keys():
            sharp[i] = _kink(points, i, found)
    return np.array(sorted(found), dtype=np.int64)


def _turns(points: Points2) -> Values:
    """Return by how much a closed polygon turns at each point, rad."""
    before, after = points - np.roll(points, 1, axis=0), np.roll(points, -1, axis=0) - points
    turns: Values = np.arctan2(cross2(before, after), np.sum(before * after, axis=1))
    return turns


def _kink(points: Points2, i: int, corner: set[int]) -> float:
    """Return the angle between the directions in which the two sides leave a point, rad; 0 if a side is too short."""
    count = len(points)
    back, on = _reach(i, -1, count, corner), _reach(i, 1, count, corner)
    if back is None or on is None:
        return 0.0
    before = _direction(points[i], points[back[0]], points[back[1]])
    after = _direction(points[i], points[on[0]], points[on[1]])
    return abs(atan2(float(cross2(-before, after)), float(-before @ after)))


def _reach(i: int, step: int, count: int, corner: set[int]) -> tuple[int, int] | None:
    """Return the two points that follow on one side, or None where a corner lies between them."""
    near, far = (i + step) % count, (i + 2 * step) % count
    return None if near in corner else (near, far)


def _direction(at: Vector2, near: Vector2, far: Vector2) -> Vector2:
    """Return the direction in which the circle through three points leaves the first one towards the others."""
    a, b = near - at, far - at
    # the inverses of points on a circle through the origin lie on a line, across the tangent's mirror image
    direction: Vector2 = a / (a @ a) - b / (b @ b)
    return direction / float(norm(direction))
