"""The least fold that no strip between two rails avoids, as a lower bound over a lattice.

Every strip is a path on which no parameter falls.  It folds where it turns from one cone to another, by the warp of
that ruling, and where a cone passes a kink of the rail that it runs along, by the turn of the normal there.  A kink has
two lattice lines with an interval of no width between them: a path that rests there arrives with the tangent before the
kink and goes on with the one after it, so that entering and leaving the kink cost two different folds.  Each cell gets
lower bounds of both, and of the turn where it is passed straight on: 0 beside an open zero, else the least of its
corners less what a smooth function can dip between them (an eighth of its second differences each way, taken twice;
only lines of one piece are compared).  The largest bound passed is then made as small as can be over all paths, by
dynamic programming.

Why it is no more than what the best strip folds by: the strip is one of these paths (an arc of F = 0 is a stair of
turns without a fold, through cells that cost nothing), each of its folds lies in a cell or at a kink that the path
counts, and is counted with a number that is no larger.  Open rails begin on the line t = 0 or s = 0 and end on the last
ones, so intervals without width are added there.  Round closed rails a path may begin anywhere and ends there; the
point where a rail closes is a break like any other, and a fold on the seam counts.

Second differences are sampled: the bound is no proof where the rails wriggle between lattice lines.  Taken again on
twice as many lines it must not fall by more than a dip.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Array, Numbers, Values, dot
from stages.geometry.rails.zeros import Field, Flags, Lines, Zeros, angles

STRAIGHT_ON = 1e-9
"""A normal that turns by less over a break, rad, does not: rounding of cross products."""


@dataclass(frozen=True, slots=True)
class Bound:
    """A fold in rad that no strip avoids, and the parameters of a ruling where it is passed."""

    fold_rad: float
    t: float
    s: float


@dataclass(frozen=True, slots=True, eq=False)
class _Costs:
    """Lower bounds of folds in each cell, rad, shape (n, m).

    enter: from a cone that runs along rail a to one along b; leave: the other way.  pass_a, pass_b: straight on over a
    break of rail a, of b; 0 inside pieces.
    """

    enter: Array
    leave: Array
    pass_a: Array
    pass_b: Array


def least_fold(found: Field, every: Zeros) -> Bound:
    """Return the lower bound of the largest fold on any strip from the first ruling of open rails to the last."""
    costs = _open_costs(found, every)
    begun = np.where(np.arange(costs.enter.shape[0]) == 0, 0.0, np.inf)
    *_, (on_a, on_b) = _swept(costs, np.zeros(1), begun[None], np.arange(costs.enter.shape[1])[None])
    return _placed(float(min(on_a[0], on_b[0, -1])), costs, *(_with_ends(of.value) for of in (found.a, found.b)))


def least_fold_round(found: Field, every: Zeros) -> Bound:
    """Return the lower bound of the largest fold on any strip that leads once round closed rails.

    Such a strip passes the first line of rail a on a cone with its apex in some interval of rail b (an arc as well: its
    stair does), and comes round to it in the same: every interval is begun in, and where in it the path begins and ends
    need not agree.
    """
    costs = _closed_costs(found, every)
    n, m = costs.enter.shape
    around = (np.arange(m)[:, None] + np.arange(m + 1)) % m
    *_, (on_a, _) = _swept(costs, np.zeros(m), np.full((m, n), np.inf), around)
    return _placed(float(on_a.min()), costs, *(np.append(of.value, of.value[-1]) for of in (found.a, found.b)))


def _swept(costs: _Costs, on_a: Values, on_b: Array, columns: Numbers) -> Iterator[tuple[Values, Array]]:
    """Yield the least of the largest bounds passed by paths through each further column, of several sweeps at a time.

    columns: the intervals of rail b in their order, shape (sweeps, count).  on_a, (sweeps,): of paths along rail a when
    they come into the first column; then when they leave each.  on_b, (sweeps, n): along b, in each interval of a.
    """
    kinks = np.nonzero(costs.pass_a.any(axis=1))[0]
    enter, leave, pass_a, pass_b = (cost.T for cost in (costs.enter, costs.leave, costs.pass_a, costs.pass_b))
    for column in columns.T:
        turned = np.maximum(on_b, leave[column])
        over = np.minimum(pass_a[column], np.maximum(enter[column], leave[column]))
        reached = _along(on_a, turned, over, kinks)
        resting = np.minimum(reached[:, :-1], turned)
        on_b = np.minimum(np.maximum(on_b, pass_b[column]), np.maximum(resting, enter[column]))
        yield reached[:, -1], on_b
        on_a = np.full(on_a.size, np.inf)


def _along(first: Values, turned: Array, over: Array, kinks: Numbers) -> Array:
    """Return what paths along rail a have passed when they come to each interval of it and past the last.

    turned: of those that turn onto it in each interval.  over: what straight on costs, 0 but at the kinks.
    """
    reached = np.column_stack([first, turned])
    start = 0
    for kink in (*kinks.tolist(), turned.shape[1]):
        np.minimum.accumulate(reached[:, start : kink + 1], axis=1, out=reached[:, start : kink + 1])
        if kink < turned.shape[1]:
            reached[:, kink + 1] = np.minimum(reached[:, kink + 1], np.maximum(reached[:, kink], over[:, kink]))
        start = kink + 1
    return reached


def _placed(value: float, costs: _Costs, lines_a: Array, lines_b: Array) -> Bound:
    """Return the bound with the middle of the first cell that costs so much."""
    every = np.stack([costs.enter, costs.leave, costs.pass_a, costs.pass_b])
    _, i, j = np.unravel_index(int(np.argmin(np.abs(every - value))), every.shape)
    return Bound(value, float(lines_a[i : i + 2].mean()), float(lines_b[j : j + 2].mean()))


def _with_ends(lines: Array) -> Array:
    return np.concatenate([lines[:1], lines, lines[-1:]])


@dataclass(frozen=True, slots=True, eq=False)
class _Intervals:
    """The intervals between lattice lines of a rail: the lines that bound each, and whether it lies inside a piece."""

    low: Numbers
    high: Numbers
    wide: Flags


def _intervals(of: Lines) -> _Intervals:
    lower = np.arange(of.value.size - 1)
    return _Intervals(lower, lower + 1, of.inside)


def _open_costs(found: Field, every: Zeros) -> _Costs:
    """Return the bounds with an interval of no width before the first line and after the last one."""
    return _costs(found, every, *(_added(_intervals(of), (0, 0), of.value.size) for of in (found.a, found.b)))


def _added(those: _Intervals, first: tuple[int, int], count: int) -> _Intervals:
    last = count - 1
    return _Intervals(
        np.concatenate([first[:1], those.low, [last]]),
        np.concatenate([first[1:], those.high, [last]]),
        np.concatenate([[False], those.wide, [False]]),
    )


def _closed_costs(found: Field, every: Zeros) -> _Costs:
    """Return the bounds with the break at which each rail closes as its last interval."""
    return _costs(found, every, *(_closed(_intervals(of), of.value.size) for of in (found.a, found.b)))


def _closed(those: _Intervals, count: int) -> _Intervals:
    return _Intervals(np.append(those.low, count - 1), np.append(those.high, 0), np.append(those.wide, False))


def _costs(found: Field, every: Zeros, a: _Intervals, b: _Intervals) -> _Costs:
    """Return the lower bounds in all cells of some intervals."""
    warp = found.warp
    signed = np.where(found.F >= 0.0, warp, -warp)
    dip_a = _dip(warp, signed, found.a)
    dip_b = _dip(warp.T, signed.T, found.b).T
    flat = _flat(found, every)
    before_a, after_a = (np.where(a.wide, other, at) for other, at in ((a.high, a.low), (a.low, a.high)))
    before_b, after_b = (np.where(b.wide, other, at) for other, at in ((b.high, b.low), (b.low, b.high)))

    def least(lines_a: tuple[Numbers, Numbers], lines_b: tuple[Numbers, Numbers]) -> Array:
        corners = [np.ix_(i, j) for i in lines_a for j in lines_b]
        dips = [np.where(a.wide[:, None], dip_a[at], 0.0) + np.where(b.wide, dip_b[at], 0.0) for at in corners]
        bound = np.minimum.reduce([warp[at] for at in corners]) - np.maximum.reduce(dips)
        zero = np.logical_or.reduce([_beside(flat, at, a, b) for at in corners])
        return np.where(zero, 0.0, np.maximum(bound, 0.0))

    enter = least((a.low, before_a), (after_b, b.high))
    leave = least((after_a, a.high), (b.low, before_b))
    return _Costs(enter, leave, _passes(found.a, found.b, a, b), _passes(found.b, found.a, b, a).T)


def _flat(found: Field, every: Zeros) -> tuple[Flags, Flags]:
    """Return on which edges along rail a, and along rail b, open zeros lie, by their lower ends, shape (n, m)."""
    along_a, along_b = (np.zeros(found.F.shape, dtype=bool) for _ in "ab")
    for (kind, i, j), zero in every.items():
        if zero.open:
            (along_b if kind == "column" else along_a)[i, j] = True
    return along_a, along_b


def _beside(flat: tuple[Flags, Flags], at: tuple[Numbers, ...], a: _Intervals, b: _Intervals) -> Flags:
    """Return which cells have an open zero on one of the two edges that meet in a corner of theirs."""
    along_a, along_b = flat
    on_a = along_a[a.low[:, None], at[1]] & a.wide[:, None]
    on_b = along_b[at[0], b.low] & b.wide
    return np.asarray(on_a | on_b)


def _passes(of: Lines, other: Lines, those: _Intervals, across: _Intervals) -> Array:
    """Return the lower bounds of the turn of a normal over the breaks of a rail, about points of the other."""
    bound = np.zeros((those.low.size, across.low.size))
    breaks = np.nonzero(~those.wide & (those.low != those.high))[0]
    low, high = those.low[breaks], those.high[breaks]
    p = other.point[None] - of.point[low, None]
    turn = angles(np.cross(p, of.slope[low, None]), np.cross(p, of.slope[high, None]))
    side = dot(p, np.broadcast_to(np.cross(of.slope[low], of.slope[high])[:, None], p.shape)) >= 0.0
    dip = _dip(turn.T, np.where(side, turn, -turn).T, other).T
    ends = across.low, across.high
    nearest = np.minimum(*(turn[:, end] for end in ends))
    dips = np.where(across.wide, np.maximum(*(dip[:, end] for end in ends)), 0.0)
    through = across.wide & (side[:, ends[0]] != side[:, ends[1]]) & (nearest < np.pi / 2.0)
    bound[breaks] = np.where(through | (nearest - dips <= STRAIGHT_ON), 0.0, nearest - dips)
    return bound


def _dip(values: Array, signed: Array, of: Lines) -> Array:
    """Return by how much an angle may dip between samples along the first axis, in the pieces of a rail.

    A quarter of second differences.  With a sign it is smooth across open zeros, without it across closed ones.
    """
    first, last = (np.searchsorted(of.piece, of.piece, side) for side in ("left", "right"))
    middle = np.clip(np.arange(of.value.size), first + 1, last - 2)
    seconds = [np.abs(of_[middle - 1] - 2.0 * of_[middle] + of_[middle + 1]) / 4.0 for of_ in (values, signed)]
    return np.asarray(np.minimum(*seconds))
