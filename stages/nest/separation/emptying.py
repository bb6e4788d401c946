"""Look for a layout on fewer bins by making the emptiest one narrower until nothing lies in it.

Its width shrinks by a share that halves after each failure, and grows again after successes; what no longer fits it
moves to the others.  Small steps work where dealing all its items over the other bins at once does not.  After a
failure two large items change places, or a layout that did not quite work out is taken up again.
"""

from time import monotonic

from stages.nest.separation.fewer import EFFORT, FULLEST, PATIENCE, STRIKES
from stages.nest.separation.pool import Pool
from stages.nest.separation.problem import Problem
from stages.nest.separation.separate import copy_places
from stages.nest.separation.sharing import Bench, Shared, parted, same_again, within
from stages.nest.separation.shorter import disturb, used_width

FIRST_STEP, LEAST_STEP, GROW = 0.1, 0.004, 1.3
"""Shares by which the width shrinks, and how much a share grows after a success."""

FAILURES = 25
"""So many failures in a row, and it is begun again from the best layout."""


def emptied(bench: Bench, problem: Problem, shared: Shared, end: float) -> None:
    """Empty one bin after the other until none can be, or the time is over."""
    while monotonic() < end:
        begun, used = shared.take(bench.layout), shared.used
        bin_ = emptiest(bench, problem, shared)
        if bin_ < 0:
            return
        bench.given.bins.size[:] = problem.bins
        _narrowed(bench, shared, (begun, used, bin_), end)


def _narrowed(bench: Bench, shared: Shared, task: tuple[int, tuple[int, ...], int], end: float) -> None:
    """Make a bin narrower until it is empty, another thread has a better layout, or nothing helps."""
    begun, used, bin_ = task
    given = within(bench.given, used)
    kept, step, failures = same_again(bench.layout), FIRST_STEP, 0
    pool = Pool()
    while monotonic() < end and shared.found == begun and failures < FAILURES:
        copy_places(kept, bench.layout)
        if failures:
            disturb(bench, given, pool)
        given.bins.size[bin_, 0] = used_width(kept, bin_) * (1.0 - step)
        left = parted(bench, given, PATIENCE, EFFORT, STRIKES)
        if left == 0.0:
            if not (bench.best.bin == bin_).any():
                shared.better(bench.best)
                return
            copy_places(bench.best, kept)
            pool.clear()
            step, failures = min(step * GROW, FIRST_STEP), 0
        elif bench.stop[0] == 0:
            step, failures = max(step / 2.0, LEAST_STEP), failures + 1
            pool.keep(left, bench.best)


def emptiest(bench: Bench, problem: Problem, shared: Shared) -> int:
    """Return the bin in use that counts and whose items have the least area; -1 if the others cannot hold them all."""
    wish, layout = shared.wish, bench.layout
    areas = [problem.kinds[item.kind].shape.area for item in problem.items]
    filled = dict.fromkeys((bin_ for bin_ in shared.used if wish.cost[bin_] > 0.0 and bin_ not in wish.held), 0.0)
    for bin_, area in zip(layout.bin.tolist(), areas, strict=True):
        if bin_ in filled:
            filled[bin_] += area
    bin_ = min(filled, key=lambda b: filled[b], default=-1)
    room = sum(wish.area[b] for b in shared.used if b != bin_)
    return bin_ if len(shared.used) > 1 and sum(areas) <= FULLEST * room else -1
