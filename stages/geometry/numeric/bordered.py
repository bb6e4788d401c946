"""Symmetric positive definite equations, banded but for a narrow border: A x + B y = f, B^T x + C y = g.

Cholesky's factors of the band A, then the small equations for y (Schur's complement).  A matrix that is not positive
definite is found out by the factors and refused, never solved.
"""

from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Array, ArrayValue, Numbers, Values
from stages.geometry.numeric.numbering import HELD, Numbering


@dataclass(frozen=True, slots=True, eq=False)
class Bordered(ArrayValue):
    """band: the lower diagonals of A, shape (width, n); beside: B, shape (n, r); corner: C, shape (r, r)."""

    band: Array
    beside: Array
    corner: Array


def assembled(blocks: Array, numbering: Numbering) -> Bordered:
    """Return the sum of the elements' matrices, shape (m, 2 k, 2 k)."""
    unknowns = numbering.unknowns.reshape(len(blocks), -1)
    n = numbering.count - numbering.border
    rows, columns = (np.broadcast_to(x, blocks.shape).ravel() for x in (unknowns[:, :, None], unknowns[:, None, :]))
    values = blocks.ravel()
    inside = (columns != HELD) & (rows >= columns) & (rows < n)
    depth = rows[inside] - columns[inside]
    band = _summed(depth, columns[inside], values[inside], (int(depth.max(initial=0)) + 1, n))
    border = (columns >= n) & (rows != HELD)
    sides = _summed(rows[border], columns[border] - n, values[border], (numbering.count, numbering.border))
    return Bordered(band, sides[:n], sides[n:])


def _summed(rows: Numbers, columns: Numbers, values: Array, shape: tuple[int, int]) -> Array:
    """Return a matrix with the values added at their places."""
    total = np.bincount(rows * shape[1] + columns, values, minlength=shape[0] * shape[1])
    return total.astype(np.float64).reshape(shape)


def gathered(parts: Array, numbering: Numbering) -> Values:
    """Return the sum of the elements' vectors, shape (m, k, 2), by unknown."""
    free = numbering.unknowns != HELD
    return np.bincount(numbering.unknowns[free], parts[free], minlength=numbering.count)


def spread(values: Values, numbering: Numbering) -> Array:
    """Return the unknowns' values at the nodes of every element, shape (m, k, 2); 0 where a node is held."""
    return np.append(values, 0.0)[numbering.unknowns]


def solved(system: Bordered, right: Values) -> Values | None:
    """Return the solution, or None if the matrix is not positive definite."""
    from scipy.linalg import LinAlgError, cho_solve, cho_solve_banded, cholesky, cholesky_banded

    n = system.band.shape[1]
    try:
        factor = cholesky_banded(system.band, lower=True, check_finite=False)
        inner = cho_solve_banded((factor, True), np.column_stack([right[:n], system.beside]), check_finite=False)
        if not system.corner.size:
            return np.asarray(inner[:, 0])
        small = cholesky(system.corner - system.beside.T @ inner[:, 1:], lower=True, check_finite=False)
    except LinAlgError:
        return None
    border = cho_solve((small, True), right[n:] - system.beside.T @ inner[:, 0], check_finite=False)
    return np.concatenate([inner[:, 0] - inner[:, 1:] @ border, border])
