"""Which nodes of a strip of elements move together, which do not move, and in what order the rest are unknown.

Columns of nodes run along the strip and neighbours share one.  All nodes of a ruling of length 0 are one point, and so
are those along an edge that is an apex.  Three unknowns hold the strip in its frame: c0(0) at the origin and the first
ruling along +x (the last one if the first has no length).  Behind a ruling of length 0 inside the strip the rest would
turn freely about that point: its far end keeps its direction from there.

Ordered by columns the equations are banded; the few unknowns of apexes, which meet every column of their patch, form a
border.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from stages.geometry.arrays import Array, Mask, Numbers
from stages.geometry.numeric.elements import Degrees

HELD = -1
"""In place of an unknown's number: the node does not move that way."""


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """How a strip hangs together.

    counts: elements of each patch.
    pointed: whether the rulings at the ends of patches have no length, one more than patches.
    apex0, apex1: whether c0 and c1 of each patch is a single point.
    """

    counts: tuple[int, ...]
    pointed: tuple[bool, ...]
    apex0: tuple[bool, ...]
    apex1: tuple[bool, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Numbering:
    """The unknowns of m elements, shape (m, nodes, 2), `HELD` for none; the last `border` of them belong to apexes."""

    unknowns: Numbers
    count: int
    border: int


def number(shape: Shape, degrees: Degrees, flat: Array) -> Numbering:
    """Return the unknowns; `flat` are the undisplaced positions of the nodes, shape (columns, nu + 1, 2), mm."""
    points = one_point(shape, degrees)
    apexes = _apexes(shape, degrees, points)
    ids, held = _framed(shape, degrees, points[..., None] * 2 + np.arange(2), flat)
    numbers, border = _ordered(ids, held, apexes)
    nv = degrees.v
    columns = np.arange(sum(shape.counts))[:, None] * nv + np.arange(nv + 1)
    elements = numbers[columns].reshape(columns.shape[0], -1, 2)
    return Numbering(elements, int(numbers.max()) + 1, border)


def starts(shape: Shape, degrees: Degrees) -> Numbers:
    """Return the columns at the ends of the patches, one more than patches."""
    return np.concatenate([[0], np.cumsum(shape.counts)]) * degrees.v


def one_point(shape: Shape, degrees: Degrees) -> Numbers:
    """Return a number for each node, shape (columns, nu + 1), the same for nodes that are one point."""
    ends = starts(shape, degrees)
    points = np.arange((ends[-1] + 1) * (degrees.u + 1)).reshape(-1, degrees.u + 1)
    if shape.pointed[0]:
        points[0] = points[0, 0]
    for low, high, apex0, apex1, pointed in zip(
        ends[:-1], ends[1:], shape.apex0, shape.apex1, shape.pointed[1:], strict=True
    ):
        for side, apex in ((0, apex0), (-1, apex1)):
            if apex:
                points[low : high + 1, side] = points[low, side]
        if pointed:
            points[high] = points[high, -1 if apex1 else 0]
    return points


def _apexes(shape: Shape, degrees: Degrees, points: Numbers) -> Numbers:
    """Return the numbers of the points that are a whole edge."""
    ends = starts(shape, degrees)[:-1]
    found = [points[low, side] for side, flags in ((0, shape.apex0), (-1, shape.apex1))
             for low, apex in zip(ends, flags, strict=True) if apex]  # fmt: skip
    return np.unique(np.array(found, dtype=np.int64))


def _framed(shape: Shape, degrees: Degrees, ids: Numbers, flat: Array) -> tuple[Numbers, list[int]]:
    """Return the numbers of the components, two made one where that keeps the frame, and those that do not move."""
    ends = starts(shape, degrees)
    held = [int(ids[0, 0, 0]), int(ids[0, 0, 1])]
    folds = [k for k in range(1, ends.size - 1) if shape.pointed[k]]
    runs = [*ends[[0, *folds]], ends[-1]]
    if not shape.pointed[0]:
        held.append(int(ids[0, -1, 1]))
    elif not folds and not shape.pointed[-1]:
        ids = np.where(ids == ids[-1, -1, 1], ids[-1, 0, 1], ids)
    else:
        held.append(_turning(ids[runs[1]], flat[runs[1]] - flat[0, 0]))
    return ids, held + [_turning(ids[last], flat[last] - flat[first, 0]) for first, last in pairwise(runs[1:])]


def _turning(ids: Numbers, arms: Array) -> int:
    """Return the component that turns a column most about a point, `arms` being the vectors from there."""
    node, component = np.unravel_index(int(np.argmax(np.abs(arms))), arms.shape)
    return int(ids[node, 1 - component])


def _ordered(ids: Numbers, held: list[int], apexes: Numbers) -> tuple[Numbers, int]:
    """Return the unknowns in the order of their columns, those of apexes last, and how many these are."""
    every, first = np.unique(ids, return_index=True)
    free: Mask = ~np.isin(every, held)
    bordering = np.isin(every // 2, apexes)
    order = np.lexsort((first, bordering))
    order = order[free[order]]
    numbers = np.full(every.size, HELD, dtype=np.int64)
    numbers[order] = np.arange(order.size)
    return numbers[np.searchsorted(every, ids)], int((bordering & free).sum())
