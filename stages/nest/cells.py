"""Which cells of a grid a polygon touches.

The cells whose middle lies inside come from the parity of crossings along each row, those at the rim from the middles
of the stretches into which the grid lines cut each edge.  Every touched cell counts: a picture only grows.
"""

import numpy as np
from numpy.typing import NDArray

from stages.geometry.arrays import Array, Numbers, Points2, Values

Cells = NDArray[np.bool_]

INWARD = 1e-6
"""Edges on a grid line count for the cell inside; in cells."""


def cover(outline: tuple[Points2, Points2], cell_mm: float) -> Cells:
    """Return the cells, counted from the origin, that a polygon with its inside to the left touches."""
    start, end = outline[0] / cell_mm, outline[1] / cell_mm
    if not start.size:
        return np.zeros((0, 0), dtype=np.bool_)
    size = np.ceil(np.maximum(start.max(axis=0), 0.0)).astype(np.int64) + 1
    cells = _inside(start, end, (int(size[1]), int(size[0])))
    edge, share = _stretches(start, end)
    along = end - start
    inward = np.stack([-along[:, 1], along[:, 0]], axis=1)
    inward *= INWARD / np.maximum(np.linalg.norm(inward, axis=1), INWARD)[:, None]
    point = start[edge] + share[:, None] * along[edge] + inward[edge]
    column, row = np.clip(np.floor(point), 0, size - 1).astype(np.int64).T
    cells[row, column] = True
    return cells


def _stretches(start: Points2, end: Points2) -> tuple[Numbers, Array]:
    """Return, for every stretch of an edge between two grid lines, the edge and the share of the way to its middle."""
    edge = [np.arange(start.shape[0]), np.arange(start.shape[0])]
    share = [np.zeros(start.shape[0]), np.ones(start.shape[0])]
    for axis in range(2):
        low, high = np.minimum(start[:, axis], end[:, axis]), np.maximum(start[:, axis], end[:, axis])
        which, line = _whole_numbers(np.floor(low) + 1.0, np.ceil(high))
        edge.append(which)
        share.append((line - start[which, axis]) / (end - start)[which, axis])
    every, at = np.concatenate(edge), np.concatenate(share)
    order = np.lexsort((at, every))
    every, at = every[order], at[order]
    same = every[1:] == every[:-1]
    return every[:-1][same], ((at[1:] + at[:-1]) / 2.0)[same]


def _whole_numbers(low: Values, high: Values) -> tuple[Numbers, Array]:
    """Return the whole numbers from each low up to and without its high: index of the pair, number."""
    count = np.maximum(high - low, 0.0).astype(np.int64)
    which = np.repeat(np.arange(low.size), count)
    return which, low[which] + (np.arange(which.size) - np.repeat(np.cumsum(count) - count, count))


def _inside(start: Points2, end: Points2, size: tuple[int, int]) -> Cells:
    """Return the cells whose middle lies inside, by the parity of crossings along each row."""
    low, high = np.minimum(start[:, 1], end[:, 1]) - 0.5, np.maximum(start[:, 1], end[:, 1]) - 0.5
    which, line = _whole_numbers(np.ceil(low), np.ceil(high))
    row = line.astype(np.int64)
    share = (line + 0.5 - start[which, 1]) / (end - start)[which, 1]
    x = start[which, 0] + share * (end - start)[which, 0]
    column = np.ceil(x - 0.5).astype(np.int64)
    crossings = np.zeros(size, dtype=np.int64)
    keep = (row >= 0) & (row < size[0]) & (column < size[1])
    np.add.at(crossings, (row[keep], np.maximum(column[keep], 0)), 1)
    inside: Cells = np.cumsum(crossings, axis=1) % 2 == 1
    return inside


def framed(covered: Cells, size: tuple[int, int]) -> Cells:
    """Return a picture cut off or filled up with empty cells to a size."""
    cells = np.zeros(size, dtype=np.bool_)
    kept = covered[: size[0], : size[1]]
    cells[: kept.shape[0], : kept.shape[1]] = kept
    return cells


def widest_gap(taken: Cells) -> float:
    """Return the distance in cells from the middle of the remotest free cell to that of the nearest taken one.

    What lies beyond the picture counts as taken.
    """
    from scipy.ndimage import distance_transform_edt

    free = np.pad(~taken, 1)
    return float(distance_transform_edt(free).max())
