"""The folds of a strip between two rails made as small as its legs allow.

A fold is the warp of the ruling at which two cones meet; that corner need not lie on F = 0, and what the corners before
and after it leave free is used: the sum of the squares of all folds is minimised over the corners, subject to their
equations and their order, by sequential quadratic programming [1]_.  A local minimum: the lattice chooses which legs,
and begins near the best place for them.  Folds at a break of a rail inside a cone are not counted.

.. [1] D. Kraft, "A software package for sequential quadratic programming", DFVLR-FB 88-28, 1988.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from stages.errors import NoSolutionError
from stages.geometry.arrays import Array, Values, norm
from stages.geometry.railcorners import DEPENDENT, TINY, Cell, Leg, Rail, cell_of, equations
from stages.geometry.railpath import legs_between, solved


def smallest_folds(parts: tuple[Leg, ...], rail_a: Rail, rail_b: Rail) -> tuple[Leg, ...]:
    """Return the legs with their folds as small as they can be made; as they are where that makes none smaller."""
    numbers = [k for k, leg in enumerate(parts[:-1], start=1) if leg.folds]
    cells = [cell_of(before, after) for before, after in pairwise(parts)]
    if not numbers:
        return parts
    corners = np.stack([*(leg.knots[0] for leg in parts), parts[-1].knots[-1]])
    moved = _minimised(_Problem(parts, corners, cells, numbers), rail_a, rail_b)
    try:
        made = solved(legs_between(parts, moved), rail_a, rail_b)
    except NoSolutionError:
        return parts
    return min((parts, made), key=lambda legs: sum(fold**2 for fold in folds_between(legs, rail_a, rail_b)))


def folds_between(parts: Sequence[Leg], rail_a: Rail, rail_b: Rail) -> list[float]:
    """Return the folds between legs, rad."""
    folds = [(after.knots[0], cell_of(before, after)) for before, after in pairwise(parts) if before.folds]
    return [fold_at(corner, cell, rail_a, rail_b) for corner, cell in folds]


def fold_at(corner: Values, cell: Cell, rail_a: Rail, rail_b: Rail) -> float:
    """Return the angle between both normals of a ruling, rad."""
    i, j = min(cell[0], len(rail_a) - 1), min(cell[1], len(rail_b) - 1)
    r, c = rail_a[i].jet(np.array([corner[0] - i]), 1)[:, 0], rail_b[j].jet(np.array([corner[1] - j]), 1)[:, 0]
    p = c[0] - r[0]
    n0, n1 = np.cross(p, r[1]), np.cross(p, c[1])
    return float(np.arctan2(norm(np.cross(n0, n1)), n0 @ n1))


@dataclass(frozen=True, slots=True)
class _Problem:
    """Legs, their corners (the first and the last ruling among them), the pieces that count there, and which fold."""

    parts: Sequence[Leg]
    corners: Array
    cells: Sequence[Cell]
    folds: Sequence[int]


def _minimised(problem: _Problem, rail_a: Rail, rail_b: Rail) -> Array:
    """Return the corners at which the sum of the squares of the folds is least, near enough to be solved for."""
    from scipy.optimize import minimize

    corners, cells = problem.corners, problem.cells
    first, last = corners[0], corners[-1]

    def every(x: Array) -> Array:
        return np.vstack([first, x.reshape(-1, 2), last])

    def folds(x: Array) -> float:
        place = every(x)
        return sum(fold_at(place[k], cells[k - 1], rail_a, rail_b) ** 2 for k in problem.folds)

    # equations that say the same (a cone at a break) would leave the quadratic programme without a solution
    rows = equations(problem.parts, corners, cells, rail_a, rail_b)[0]
    left, sizes, _ = np.linalg.svd(rows, full_matrices=False)
    kept = left[:, sizes > DEPENDENT * max(float(sizes.max(initial=0.0)), 1.0)].T

    def rest(x: Array) -> Array:
        off: Array = kept @ equations(problem.parts, every(x), cells, rail_a, rail_b)[1]
        return off

    def slopes(x: Array) -> Array:
        gradients: Array = kept @ equations(problem.parts, every(x), cells, rail_a, rail_b)[0]
        return gradients

    low, high = np.floor(corners[1:-1]), np.ceil(corners[1:-1])
    # beside a break a corner may move into the piece after it or before it, but not past the next break
    most = np.array([len(rail_a), len(rail_b)])
    low, high = np.where(low == high, np.maximum(low - 1.0, 0.0), low), np.where(low == high, low + 1.0, high)
    start = corners[1:-1].ravel()
    constraints = [
        {"type": "ineq", "fun": lambda x: np.diff(every(x), axis=0).ravel()},
        *([{"type": "eq", "fun": rest, "jac": slopes}] if len(kept) else []),
    ]
    found = minimize(
        folds,
        start,
        method="SLSQP",
        jac="3-point",
        bounds=list(zip(low.ravel(), np.minimum(high, most).ravel(), strict=True)),
        constraints=constraints,
        options={"maxiter": STEPS, "ftol": TINY},
    )
    moved: Array = every(np.asarray(found.x, dtype=np.float64))
    return np.maximum.accumulate(moved, axis=0) if np.isfinite(moved).all() else corners


STEPS = 60
