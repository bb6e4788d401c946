"""The least fold that no strip between two rails avoids, as a lower bound over a lattice.

Every strip is a path from the first ruling to the last on which no parameter falls; where it turns from one cone to
another it folds by the warp of that ruling.  A strip begins on the line t = 0 or s = 0 and ends on the last lines, so
its first and last turns lie on these.  Each cell, and each edge of the border, gets a lower bound of the warp on it: 0
beside an open zero, else the least of its corners less what a smooth function can dip between them (an eighth of its
second differences each way, taken twice).  The largest bound passed at a turn is then made as small as can be over all
paths, by dynamic programming.  Round closed rails a path may begin anywhere and ends there.

Second differences are sampled: the bound is no proof where the rails wriggle between lattice lines.  Taken again on
twice as many lines it must not fall.
"""

from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Array, Values
from stages.geometry.railzero import Field, Zeros


@dataclass(frozen=True, slots=True)
class Bound:
    """A fold in rad that no strip avoids, and the parameters of a ruling where it is passed."""

    fold_rad: float
    t: float
    s: float


@dataclass(frozen=True, slots=True)
class _Costs:
    """Lower bounds of the warp, rad: of cells (n - 1, m - 1), and of edges and corners of the border.

    first_a, last_a: edges along rail a at s = 0 and at the end of s, (n - 1,); first_b, last_b: along rail b, (m - 1,).
    aside_a, aside_b: the warp where t has run out before s has begun, and the other way round.
    """

    cells: Array
    first_a: Array
    last_a: Array
    first_b: Array
    last_b: Array
    aside_a: float
    aside_b: float


def least_fold(found: Field, every: Zeros) -> Bound:
    """Return the lower bound of the largest fold on any strip."""
    costs = _costs(found, every)
    value = _bottleneck(costs)
    every_cost = np.pad(costs.cells, 1, constant_values=np.inf)
    every_cost[1:-1, 0], every_cost[1:-1, -1] = costs.first_a, costs.last_a
    every_cost[0, 1:-1], every_cost[-1, 1:-1] = costs.first_b, costs.last_b
    every_cost[-1, 0], every_cost[0, -1] = costs.aside_a, costs.aside_b
    i, j = np.unravel_index(int(np.argmin(np.abs(every_cost - value))), every_cost.shape)
    return Bound(value, _at(found.a.value, int(i)), _at(found.b.value, int(j)))


def least_fold_round(found: Field, every: Zeros) -> Bound:
    """Return the lower bound of the largest fold on any strip that leads once round closed rails.

    Such a strip passes the first line of rail a in some interval of rail b and comes round to it in the same: every
    interval is begun in, and where in it the path begins and ends need not agree.
    """
    cells = _costs(found, every).cells
    round_ = cells.T[(np.arange(cells.shape[1])[:, None] + np.arange(cells.shape[1] + 1)) % cells.shape[1]]
    # along the axes: where the path begins, how many intervals of b it has passed, and the interval of a
    on_a = np.zeros(cells.T.shape)
    on_b = round_[:, 0].copy()
    on_b[:, 0] = 0.0
    for column in np.moveaxis(round_[:, 1:], 1, 0):
        on_a = np.minimum.accumulate(np.maximum(on_b, column), axis=1)
        on_b = np.minimum(on_b, np.maximum(on_a, column))
    value = float(np.minimum(on_a[:, -1], on_b[:, -1]).min())
    i, j = np.unravel_index(int(np.argmin(np.abs(cells - value))), cells.shape)
    return Bound(value, _at(found.a.value, int(i) + 1), _at(found.b.value, int(j) + 1))


def _at(lines: Values, k: int) -> float:
    """Return the middle of the k-th interval, counted from 1; 0 and one too many are the ends."""
    return float(lines[max(k - 1, 0) : k + 1].mean()) if k < lines.size else float(lines[-1])


def _costs(found: Field, every: Zeros) -> _Costs:
    """Return the lower bounds."""
    warp = found.warp
    signed = np.where(found.F >= 0.0, warp, -warp)
    # with the sign of F the warp is smooth across open zeros, without it across closed ones
    dip_a = np.minimum(_dip(signed), _dip(warp))
    dip_b = np.minimum(_dip(signed.T), _dip(warp.T)).T
    cells = _least(warp) - _most(dip_a + dip_b)
    edges_a = np.minimum(warp[:-1], warp[1:]) - np.maximum(dip_a[:-1], dip_a[1:])
    edges_b = np.minimum(warp[:, :-1], warp[:, 1:]) - np.maximum(dip_b[:, :-1], dip_b[:, 1:])
    cells, edges_a, edges_b = (np.maximum(bound, 0.0) for bound in (cells, edges_a, edges_b))
    for (kind, i, j), zero in every.items():
        if zero.open:
            (edges_b if kind == "column" else edges_a)[i, j] = 0.0
            cells[max(i - (kind == "column"), 0) : i + 1, max(j - (kind == "row"), 0) : j + 1] = 0.0
    aside = float(warp[-1, 0]), float(warp[0, -1])
    return _Costs(cells, edges_a[:, 0], edges_a[:, -1], edges_b[0], edges_b[-1], *aside)


def _least(warp: Array) -> Array:
    """Return the least of each cell's corners."""
    least: Array = np.minimum(np.minimum(warp[:-1, :-1], warp[1:, :-1]), np.minimum(warp[:-1, 1:], warp[1:, 1:]))
    return least


def _most(dip: Array) -> Array:
    """Return the largest of each cell's corners."""
    return -_least(-dip)


def _dip(values: Array) -> Array:
    """Return by how much a function may dip between samples along the first axis: a quarter of second differences."""
    second = np.abs(values[:-2] - 2.0 * values[1:-1] + values[2:]) / 4.0
    dips: Array = np.concatenate([second[:1], second, second[-1:]])
    return dips


def _bottleneck(costs: _Costs) -> float:
    """Return the least, over all paths, of the largest bound at which a path turns."""
    cells = costs.cells
    on_a, on_b = np.full(cells.shape[0], np.inf), np.full(cells.shape[0], np.inf)
    best = min(costs.aside_a, costs.aside_b)
    for j in range(cells.shape[1]):
        column = cells[:, j]
        if j == 0:
            on_b = np.minimum(on_b, costs.first_a)  # along s = 0, then off it
        entered = np.maximum(on_b, column)
        entered[0] = min(entered[0], costs.first_b[j])  # along t = 0, then off it
        on_a = np.minimum.accumulate(entered)
        on_b = np.minimum(on_b, np.maximum(on_a, column))
        best = min(best, max(float(on_a[-1]), float(costs.last_b[j])))
    return min(best, float(np.maximum(on_b, costs.last_a).min()))
