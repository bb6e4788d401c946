"""Lengths, areas and boxes of many paths of lines and arcs at once: those of `arcpath`, to the last digit.

A sheet has hundreds of copies of contours of a few pieces each; one by one they take far longer than what is asked of
them.  All pieces are laid in a row and measured together; sums run over the paths of one count of pieces at a time, in
the order in which they run over one path by itself.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Array, ArrayValue, Indices, Mask, Numbers, Points2, Values, norm
from stages.geometry.curves.rigid import Rigid2, matrix
from stages.geometry.paths import arcs
from stages.geometry.paths.arcpath import ArcPath, transform
from stages.geometry.paths.clearance import Pieces, between


@dataclass(frozen=True, slots=True, eq=False)
class Row(ArrayValue):
    """The pieces of some paths one after the other.

    owner: the number of the path of each piece.  counts: how many pieces each path has; none has none.
    """

    start: Points2
    end: Points2
    bulge: Values
    owner: Numbers
    counts: Numbers


def row(paths: Sequence[ArcPath]) -> Row:
    """Return the pieces of some paths."""
    if not paths:
        return Row(np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0), NONE, NONE)
    vertices = np.concatenate([path.vertices for path in paths])
    size, closed = _sizes(paths)
    last = np.cumsum(size) - 1
    follows = np.arange(1, vertices.shape[0] + 1)
    follows[last] = last - size + 1
    kept = np.ones(follows.size, dtype=bool)
    kept[last[~closed]] = False
    owner = np.repeat(np.arange(size.size), size)[kept]
    bulge = np.concatenate([path.bulges for path in paths])[kept]
    return Row(vertices[kept], vertices[follows[kept]], bulge, owner, np.where(closed, size, size - 1))


NONE: Numbers = np.zeros(0, dtype=np.int64)


def _sizes(paths: Sequence[ArcPath]) -> tuple[Numbers, Mask]:
    """Return how many vertices each path has, and whether it is closed."""
    size = np.array([path.bulges.size for path in paths], dtype=np.int64)
    return size, np.array([path.closed for path in paths], dtype=bool)


def piece_lengths(of: Row) -> Values:
    """Return the length of each piece in mm; exact."""
    return arcs.lengths(of.start, of.end, arcs.sweeps(of.bulge))


def points_at(of: Row, piece: Indices, share: Values) -> Points2:
    """Return the points at shares of the sweep of pieces, in mm; exact."""
    return arcs.between(of.start[piece], of.end[piece], arcs.sweeps(of.bulge[piece]), share)


def lengths(paths: Sequence[ArcPath]) -> Values:
    """Return the length of each path in mm; exact."""
    found = row(paths)
    return _sums(piece_lengths(found), found.counts)


def shortest(paths: Sequence[ArcPath]) -> Values:
    """Return the length of the shortest piece of each path in mm; exact."""
    found = row(paths)
    return _least(piece_lengths(found), found)


def shortest_chords(paths: Sequence[ArcPath]) -> Values:
    """Return how near two vertices that follow each other are on each path, mm."""
    found = row(paths)
    return _least(norm(found.end - found.start), found)


def steepest(paths: Sequence[ArcPath]) -> Values:
    """Return the largest bulge of each path, whatever its sign."""
    found = row(paths)
    return -_least(-np.abs(found.bulge), found)


def _least(values: Array, of: Row) -> Array:
    """Return the least of the values of each path."""
    least: Array = np.minimum.reduceat(values, np.cumsum(of.counts) - of.counts) if of.counts.size else values
    return least


def ends(paths: Sequence[ArcPath]) -> tuple[Points2, Points2]:
    """Return where each path begins and where it ends, a closed one at its beginning."""
    found = row(paths)
    last = np.cumsum(found.counts) - 1
    return found.start[last - found.counts + 1], found.end[last]


def end_curvatures(paths: Sequence[ArcPath]) -> Array:
    """Return the signed curvature of the first and of the last piece of each path in 1/mm, shape (paths, 2)."""
    found = row(paths)
    last = np.cumsum(found.counts) - 1
    piece = np.stack([last - found.counts + 1, last], axis=1)
    return arcs.curvatures(found.start[piece], found.end[piece], arcs.bends(found.bulge[piece]))


def areas(paths: Sequence[ArcPath]) -> Values:
    """Return the signed area of each path in mm2, all closed, positive counter-clockwise; exact."""
    found = row(paths)
    middle = np.zeros((found.counts.size, 2))
    for numbers, pieces in _alike(found.counts):
        middle[numbers] = found.start[pieces].mean(axis=1)
    swept = arcs.areas(found.start, found.end, arcs.sweeps(found.bulge), middle[found.owner])
    return _sums(swept, found.counts)


def boxes(paths: Sequence[ArcPath]) -> Array:
    """Return the exact extent of each path, arcs included: x least, y least, x most, y most in mm, shape (paths, 4)."""
    found = row(paths)
    low, high = (np.full((found.counts.size, 2), start) for start in (np.inf, -np.inf))
    bent = np.flatnonzero(found.bulge)
    piece, points = arcs.furthest(found.start[bent], found.end[bent], arcs.sweeps(found.bulge[bent]))
    owner = np.concatenate([found.owner, found.owner, found.owner[bent[piece]]])
    every = np.concatenate([found.start, found.end, points])
    np.minimum.at(low, owner, every)
    np.maximum.at(high, owner, every)
    return np.concatenate([low, high], axis=1)


def polygons(paths: Sequence[ArcPath], accuracy: float) -> tuple[Points2, Numbers]:
    """Return points along each path whose polygon is within `accuracy` mm of it, and the number of the path of each.

    The last point of a closed path is not repeated.
    """
    found = row(paths)
    sweep = arcs.sweeps(found.bulge)
    steps = arcs.steps(np.abs(sweep), arcs.radii(found.start, found.end, arcs.bends(found.bulge)), accuracy)
    _, closed = _sizes(paths)
    last = (np.cumsum(found.counts) - 1)[~closed]
    count = steps.copy()
    count[last] += 1
    piece = np.repeat(np.arange(count.size), count)
    within = np.arange(piece.size) - np.repeat(np.cumsum(count) - count, count)
    points = points_at(found, piece, within / steps[piece])
    begins, ends = within == 0, within == steps[piece]
    points[begins], points[ends] = found.start[piece[begins]], found.end[piece[ends]]
    return points, found.owner[piece]


def moved(paths: Sequence[ArcPath], motion: Rigid2) -> list[ArcPath]:
    """Return the moved paths, each as `transform` moves it."""
    if motion.mirrored:
        return [transform(path, motion) for path in paths]
    turn, shift = matrix(motion).T, np.array([motion.x, motion.y])
    return [ArcPath(path.vertices @ turn + shift, path.bulges, path.closed) for path in paths]


def pieces(paths: Sequence[ArcPath]) -> tuple[Pieces, Numbers]:
    """Return the lines and arcs of all paths, those of length 0 left out, and the number of the path of each."""
    found = row(paths)
    long = norm(found.end - found.start) > 0.0
    owner = found.owner[long]
    if np.unique(owner).size < len(paths):
        raise ValueError("a path of length 0 has no distance to anything")
    return between(found.start[long], found.end[long], found.bulge[long]), owner


def _sums(values: Array, counts: Numbers) -> Array:
    """Return the sums of the values of each path."""
    sums = np.zeros(counts.size)
    for numbers, pieces in _alike(counts):
        sums[numbers] = values[pieces].sum(axis=1)
    return sums


def _alike(counts: Numbers) -> list[tuple[Numbers, Numbers]]:
    """Return the numbers of the paths of each count of pieces, and those of their pieces, shape (paths, count)."""
    first = np.cumsum(counts) - counts
    some = [(int(count), np.flatnonzero(counts == count)) for count in np.unique(counts)]
    return [(numbers, first[numbers][:, None] + np.arange(count)) for count, numbers in some]
