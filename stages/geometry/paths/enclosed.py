"""Which points lie within closed contours of lines and arcs.

Parity: the polygon of the chords, and each segment of a circle between chord and arc, turn the answer round.  A point
on a contour counts as on either side of it.  One that lies on a chord is taken for either side of that, but by polygon
and segment alike, so that the answer is right: a lead at 45 degrees onto quarter circles runs along their chords.
"""

import numpy as np
from numpy.typing import NDArray

from stages.geometry.arrays import Array, Mask, Numbers, Points2, cross2
from stages.geometry.paths.clearance import Pieces, power


def inside(point: Points2, closed: Pieces) -> Mask:
    """Return which points lie within a closed contour; a point on the contour may go either way."""
    flips = np.count_nonzero(_passed(closed.start[None], closed.end[None], point[:, None]), axis=1)
    for i in np.flatnonzero(closed.bulge):
        flips += _in_segment(point, closed.take(np.full(point.shape[0], i)))
    odd: Mask = flips % 2 == 1
    return odd


def inside_own(point: Points2, own: Numbers, some: Pieces, owner: Numbers) -> Mask:
    """Return which points lie within the closed contour of their number; owner: that of each piece, rising."""
    first, last = (np.searchsorted(owner, own, side=side) for side in ("left", "right"))
    place = np.repeat(np.arange(own.size), last - first)
    piece = np.arange(place.size) + np.repeat(first - np.cumsum(last - first) + (last - first), last - first)
    at, of = point[place], some.take(piece)
    flips = _passed(of.start, of.end, at).astype(np.int64) + ((of.bulge != 0.0) & _in_segment(at, of))
    odd: Mask = np.bincount(place, flips, own.size) % 2.0 == 1.0
    return odd


def _passed(start: Array, end: Array, at: Array) -> NDArray[np.bool_]:
    """Return which chords are passed on the way from points to the right, along x, for every pair or pair by pair."""
    spans = (start[..., 1] > at[..., 1]) != (end[..., 1] > at[..., 1])
    right = cross2(end - start, at - start) * np.sign(end[..., 1] - start[..., 1]) > 0.0
    passed: NDArray[np.bool_] = spans & right
    return passed


def _in_segment(point: Points2, arc: Pieces) -> Mask:
    """Return whether each point lies between its arc and the chord of that, on the chord as `_passed` takes it."""
    chord = arc.end - arc.start
    left = cross2(chord, point - arc.start)
    # what is not passed is left of a chord that runs down and right of one that runs up; above a level one
    tied = np.where(chord[:, 1] == 0.0, chord[:, 0], -chord[:, 1])
    within: Mask = (power(point, arc) < 0.0) & (arc.bulge * np.where(left == 0.0, tied, left) < 0.0)
    return within
