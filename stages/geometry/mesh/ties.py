"""Lengths that a flattening holds: of single edges, or two edges equal to each other.

A tie is an equation sum over its edges of w |x_b - x_a|^2 / 2 = t.  With w = 1 / L for one edge and t = L / 2 it says
that the edge is L long; with w = 1 / L and -1 / L for two edges and t = 0 that both are as long as each other.  What is
left over is in mm and, near the solution, the difference of the lengths.  First derivatives are linear in the
positions, second derivatives constant.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from stages.geometry.arrays import Array, ArrayValue, Numbers, Points2, dot


@dataclass(frozen=True, slots=True, eq=False)
class Ties(ArrayValue):
    """Equations between the lengths of edges.

    ends: shape (s, 2), the vertices of every edge that takes part.  row: the tie that it belongs to.
    weight: w of the edge, 1/mm.  wanted: t of every tie, mm.
    """

    ends: Numbers
    row: Numbers
    weight: Array
    wanted: Array

    def __len__(self) -> int:
        """Return the number of ties."""
        return len(self.wanted)


def no_ties() -> Ties:
    """Return no equation at all."""
    none = np.zeros(0, dtype=np.int64)
    return Ties(np.zeros((0, 2), dtype=np.int64), none, np.zeros(0), np.zeros(0))


def kept(ends: Numbers, lengths: Array) -> Ties:
    """Return the ties of edges, shape (k, 2), that keep their lengths, mm."""
    return Ties(ends, np.arange(len(ends)), 1.0 / lengths, lengths / 2.0)


def equal(one: Numbers, other: Numbers, lengths: Array) -> Ties:
    """Return the ties of pairs of edges, shape (k, 2) each, of equal but free length; lengths: about how long, mm."""
    rows = np.arange(len(one))
    return Ties(
        np.concatenate([one, other]), np.tile(rows, 2), np.concatenate([1.0 / lengths, -1.0 / lengths]),
        np.zeros(len(one)),
    )  # fmt: skip


def together(first: Ties, second: Ties) -> Ties:
    """Return the ties of both."""
    return Ties(
        np.concatenate([first.ends, second.ends]), np.concatenate([first.row, second.row + len(first)]),
        np.concatenate([first.weight, second.weight]), np.concatenate([first.wanted, second.wanted]),
    )  # fmt: skip


def left_sides(ties: Ties, positions: Points2) -> Array:
    """Return the left side of every equation, mm."""
    span = positions[ties.ends[:, 1]] - positions[ties.ends[:, 0]]
    parts: Array = ties.weight * dot(span, span) / 2.0
    return np.asarray(np.bincount(ties.row, parts, minlength=len(ties)), dtype=np.float64)


def derivatives(ties: Ties, positions: Points2) -> csr_array:
    """Return the derivatives of the left sides by the coordinates, vertex by vertex: shape (ties, 2 n)."""
    span = ties.weight[:, None] * (positions[ties.ends[:, 1]] - positions[ties.ends[:, 0]])
    columns = 2 * ties.ends[:, :, None] + np.arange(2)
    rows = np.broadcast_to(ties.row[:, None, None], columns.shape)
    values = np.stack([-span, span], axis=1)
    shape = (len(ties), 2 * len(positions))
    return csr_array((values.ravel(), (rows.ravel(), columns.ravel())), shape=shape)


def second_derivatives(ties: Ties, multipliers: Array, count: int) -> csr_array:
    """Return the second derivatives of the sum of multiplier times left side: shape (2 count, 2 count)."""
    value = ties.weight * multipliers[ties.row]
    a, b = (2 * ties.ends[:, i, None] + np.arange(2) for i in (0, 1))
    rows = np.concatenate([a, b, a, b]).ravel()
    columns = np.concatenate([a, b, b, a]).ravel()
    values = np.repeat(np.concatenate([value, value, -value, -value]), 2)
    return csr_array((values, (rows, columns)), shape=(2 * count, 2 * count))


def off_by(ties: Ties, positions: Points2) -> float:
    """Return by how much of itself a tied length is off at most."""
    if not len(ties):
        return 0.0
    each = np.zeros(len(ties))
    np.maximum.at(each, ties.row, np.abs(ties.weight))
    return float(np.abs((left_sides(ties, positions) - ties.wanted) * each).max())
