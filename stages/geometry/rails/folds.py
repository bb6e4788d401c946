"""The way along two rails with the fewest folds, and these as small as they can be made.

A fold is the warp of the ruling at which a path turns off F = 0.  With one fold, its corner lies where the cone that
arrives can be reached from the first ruling without a fold, and the one that leaves leads to the last; both are found
on the whole lattice by a sweep over its lines, in which a path may turn beside any open zero.  The least warps of every
line join the coarse corners of `graph`, and the cheapest way is then found again and again on lattices that get
finer around its corners, until its cost stays.  Where it does not within `ROUNDS`, it is said how much it changed last.

The least fold among those that the lattice shows: an arc inside one cell is not seen; two folds or more are made
smaller around their places on the coarse lattice alone, and one from end to end of both rails stays there.
"""

from collections.abc import Iterator

import numpy as np

from stages.geometry.arrays import Array, Values
from stages.geometry.rails.corners import TINY, Rail
from stages.geometry.rails.graph import ANGLE, SMOOTH, Cell, Rules, Way, coarse, way
from stages.geometry.rails.way import legs
from stages.geometry.rails.zeros import LEAST, Field, Flags, Lines, Zeros, field, zeros

ROUNDS = 10
FINER = 8
"""Each lattice is so many times finer around the corners than the one before, if these have stayed in place."""
SPAN = 2
"""Intervals of the lattice before to either side of a corner that are made finer."""
FINEST = 1e-9
"""No lattice is finer: a fold of a degree changes by some 1e-7 deg over it."""
SETTLED = 1e-6 * ANGLE
"""Changes of the cost by less, 1e-6 deg of folding, ends the search if two finer lattices bring no more."""


def folded_way(rail_a: Rail, rail_b: Rail, rules: Rules, count: int) -> tuple[Way, float]:
    """Return the cheapest way, with its folds made as small as they can be, and by how much they may be smaller.

    That is what the last two rounds changed of them, in rad; 0 where they have settled, pi where one came or went.
    """
    found = field(rail_a, rail_b, count)
    every = zeros(found)
    best = way(found, every, rules, _anywhere(found, every))
    width = 1.0 / max(LEAST, count / max(len(rail_a), len(rail_b)))
    costs = [np.inf, np.inf]
    changes = [0.0]
    for _ in range(ROUNDS):
        if not _corners(best).size or width < FINEST:
            return best, 0.0
        after = _finer_way(best, rail_a, rail_b, rules, count=count, width=width)
        changes.append(abs(after.cost - best.cost))
        stayed, best = _moved(best, after) <= SPAN * width / 2.0, after
        if not stayed:
            continue
        if max(abs(after.cost - cost) for cost in costs) <= SETTLED:
            return best, 0.0
        costs, width = [after.cost, costs[0]], width / FINER
    folds = any(stop.fold for stop in best.stops)
    return best, min(float(np.radians(max(changes[-2:]) / ANGLE)), np.pi) if folds else 0.0


def _finer_way(best: Way, rail_a: Rail, rail_b: Rail, rules: Rules, *, count: int, width: float) -> Way:
    """Return the cheapest way over a lattice that is finer around the corners of one found before.

    It folds beside the folds of that one; if the finer lattice has no such way, that one was none, and it may anywhere.
    """
    corners = _corners(best)
    folds = np.array([(stop.t, stop.s) for stop in best.stops if stop.fold]).reshape(-1, 2)
    found = field(rail_a, rail_b, count, *(_around(corners[:, axis], width) for axis in (0, 1)))
    every = zeros(found)
    after = way(found, every, rules, _near(found, folds, width))
    return after if after.stops else way(found, every, rules, _anywhere(found, every))


def _corners(found: Way) -> Array:
    """Return the corners (t, s) of a way that do not lie where pieces of both rails end, shape (n, 2)."""
    corners = np.array([leg.knots[-1] for leg in legs(found.stops)[:-1]]).reshape(-1, 2)
    inner: Array = corners[(np.abs(corners - np.round(corners)) > TINY).any(axis=1)]
    return inner


def _moved(before: Way, after: Way) -> float:
    """Return how far the corner of a way that is farthest from all corners of another is from them."""
    old, new = _corners(before), _corners(after)
    if not (old.size and new.size):
        return 0.0 if old.size == new.size else np.inf
    return float(np.abs(new[:, None] - old[None]).max(axis=-1).min(axis=1).max())


def _around(corners: Values, width: float) -> Array:
    """Return finer lines around corners, and ever coarser ones up to the distance of those between pieces' lines.

    Without these a zero far from a corner would lie beside it, on one edge of the lattice.
    """
    fine = np.arange(1, SPAN * FINER + 1) * (width / FINER)
    coarse = fine[-1] * 2.0 ** np.arange(1, max(int(np.log2(1.0 / LEAST / fine[-1])), 0) + 1)
    steps = np.concatenate([-coarse[::-1], -fine[::-1], [0.0], fine, coarse])
    return np.unique(corners[:, None] + steps)


def _near(found: Field, folds: Array, width: float) -> Iterator[Cell]:
    """Yield the corners of the lattice around folds."""
    for fold in folds:
        i, j = (
            np.flatnonzero(np.abs(of.value - x) <= SPAN * width).tolist()
            for of, x in zip((found.a, found.b), fold, strict=True)
        )
        yield from ((n, m) for n in i for m in j)


def _anywhere(found: Field, every: Zeros) -> Iterator[Cell]:
    """Yield corners all over the lattice, and those where a single fold is least."""
    yield from coarse(found)
    yield from _promising(found, every)


def _promising(found: Field, every: Zeros) -> Iterator[Cell]:
    """Yield the corner with the least warp on each line at which a way with one fold may have it."""
    smooth = _beside_zeros(found, every)
    crease_a, crease_b = (_creases(of, turn) for of, turn in ((found.a, found.turn_a), (found.b, found.turn_b.T)))
    before = _reached(smooth, crease_a, crease_b.T)
    back = (flags[::-1, ::-1] for flags in (smooth, crease_a, crease_b.T))
    after = [reached[::-1, ::-1] for reached in _reached(*back)]
    for arrives, leaves in ((before[0], after[1]), (before[1], after[0])):
        warp = np.where(arrives & leaves, found.warp, np.inf)
        i, j = warp.argmin(axis=0), warp.argmin(axis=1)
        yield from ((n, m) for m, n in enumerate(i.tolist()) if np.isfinite(warp[n, m]))
        yield from ((n, m) for n, m in enumerate(j.tolist()) if np.isfinite(warp[n, m]))


def _beside_zeros(found: Field, every: Zeros) -> Flags:
    """Return at which corners of the lattice a path may turn smoothly, if only beside them."""
    smooth: Flags = (found.F == 0.0) & (found.warp <= SMOOTH)
    for (kind, i, j), zero in every.items():
        if zero.open:
            smooth[i : i + 1 + (kind == "row"), j : j + 1 + (kind == "column")] = True
    return smooth


def _creases(of: Lines, turns: Array) -> Flags:
    """Return between which lines a cone would fold over a break, shape (n - 1, m)."""
    creases: Flags = ~of.inside[:, None] & (turns > SMOOTH)
    return creases


def _reached(smooth: Flags, crease_a: Flags, crease_b: Flags) -> tuple[Flags, Flags]:
    """Return which corners a path without folds reaches on a cone with its apex on b, and on one with it on a."""
    on_a, on_b = np.zeros_like(smooth), np.zeros_like(smooth)
    begun = np.arange(smooth.shape[1]) == 0
    # a path that has crossed a crease is another one: count them
    crossed = np.hstack([np.zeros((len(smooth), 1), dtype=np.int64), np.cumsum(crease_b, axis=1)])
    arriving = begun
    for i, turns in enumerate(smooth):
        if i:
            arriving = on_a[i - 1] & ~crease_a[i - 1]
        entered = (turns & arriving) | (begun & (i == 0))
        last = np.maximum.accumulate(np.where(entered, crossed[i], -1))
        on_b[i] = last == crossed[i]
        on_a[i] = arriving | (turns & on_b[i])
    return on_a, on_b
