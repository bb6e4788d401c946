"""Which closed contours certainly neither cross nor touch themselves: a quick proof, many at once.

Arcs are cut into sixths of a turn.  Pieces that do not follow each other must be apart by their exact distance.  Two
that do follow each other can meet again only by going round: a closed curve turns by 2 pi, its last corner by at most
pi, so they do not where both sweeps and the turn between them sum up to less than pi.  The rest is not decided here.
"""

from collections.abc import Sequence

import numpy as np
from shapely import STRtree, box

from stages.geometry.arrays import Array, Mask, Numbers, Values
from stages.geometry.paths.arcpath import ArcPath, chords, joint_turns, split, sweeps
from stages.geometry.paths.clearance import between, boxes, distances

SIXTH_BULGE = 0.2679491924311227
"""tan(60 deg / 4): three such arcs in a row turn by half a turn."""

MOST_TURN = np.pi - 0.2
"""0.2 rad short of half a turn: what comes back as a narrower needle is not decided here."""


def certainly_simple(paths: Sequence[ArcPath], *, apart: float) -> Mask:
    """Return which closed paths keep pieces that do not follow each other more than `apart` mm from each other.

    False means that it is not known.
    """
    gentle = [split(path, max_bulge=SIXTH_BULGE) for path in paths]
    count = np.array([path.bulges.size for path in gentle], dtype=np.int64)
    owner = np.repeat(np.arange(count.size), count)
    ends = [chords(path) for path in gentle]
    start, end = (np.concatenate([pair[side] for pair in ends]) for side in (0, 1))
    doubtful = np.zeros(count.size, dtype=bool)
    doubtful[owner[(start == end).all(axis=1)]] = True
    doubtful[owner[_turning(gentle) >= MOST_TURN]] = True
    real = np.flatnonzero(~doubtful[owner])
    if real.size:
        some = between(start[real], end[real], np.concatenate([path.bulges for path in gentle])[real])
        one, other = _near(boxes(some), owner[real], apart)
        step = np.abs(real[one] - real[other])
        follows = (step == 1) | (step == count[owner[real[one]]] - 1)
        one, other = one[~follows], other[~follows]
        near = distances(some.take(one), some.take(other)) <= apart
        doubtful[owner[real[one[near]]]] = True
    simple: Mask = ~doubtful
    return simple


def _turning(paths: Sequence[ArcPath]) -> Values:
    """Return how much each piece, the joint after it and the next piece turn together, rad, whichever way."""
    turns = []
    for path in paths:
        sweep = np.abs(sweeps(path))
        turns.append(sweep + np.abs(np.roll(joint_turns(path), -1)) + np.roll(sweep, -1))
    return np.concatenate(turns)


def _near(low_high: Array, owner: Numbers, apart: float) -> tuple[Numbers, Numbers]:
    """Return the pairs of pieces of one owner whose boxes come within `apart` mm, each once.

    Every owner's boxes are moved to a place of their own first, so that those of different owners are far apart.
    """
    low = np.full((int(owner.max()) + 1, 2), np.inf)
    high = -low
    np.minimum.at(low, owner, low_high[:, :2])
    np.maximum.at(high, owner, low_high[:, 2:])
    known = np.isfinite(low[:, 0])
    width = np.where(known, high[:, 0] - low[:, 0], 0.0) + 4.0 * apart
    place = np.cumsum(width) - width
    moved = low_high - np.tile(low[owner], 2)
    moved[:, ::2] += place[owner, None]
    margin = apart + ROUNDING * float(width.sum())
    frames = box(moved[:, 0] - margin, moved[:, 1] - margin, moved[:, 2] + margin, moved[:, 3] + margin)
    one, other = STRtree(frames).query(frames)
    chosen = (one < other) & (owner[one] == owner[other])
    return one[chosen].astype(np.int64), other[chosen].astype(np.int64)


ROUNDING = 1e-14
"""What a place loses by being moved, as a share of the width of all places together."""
