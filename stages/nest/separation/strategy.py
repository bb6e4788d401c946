"""Search for fewer bins and then a shorter last one, in several threads that share the best layout.

Kernels let each other run, so that threads keep as many cores busy.  The clock is read here and in the two searches.
A thread that fails does not end the others; whoever asked is told when all have ended.
"""

import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from time import monotonic

from stages.nest.separation.emptying import emptied
from stages.nest.separation.fewer import EFFORT, PATIENCE, fewer
from stages.nest.separation.interlock import assembled, interlocked, interlocking
from stages.nest.separation.problem import Problem, Spot, arrays, empty_layout, pose_for
from stages.nest.separation.sharing import OVER, Shared, Wish, bench_for, parted, place, spots_of
from stages.nest.separation.shorter import narrow, shorter
from stages.nest.separation.state import Tables
from stages.nest.separation.tabling import tables_for

FEWER_SHARE = 0.8
"""Of the time, what the search for fewer bins may take before the last bin is made shorter."""

INTERLOCK_SHARE = 0.4
"""Of the time that is left, what one thread may take to put shapes together that were cut from one another."""


def improve(problem: Problem, start: Sequence[Spot], wish: Wish, tell: Callable[[list[Spot]], None]) -> None:
    """Tell every layout that is better than the start and all before, until the time is over.

    Items of the start in bin -1 lie nowhere yet.  Raises what a thread failed with.
    """
    given = arrays(problem)
    layout, pose = empty_layout(problem, given), pose_for(given)
    for item, spot in enumerate(start):
        if spot.bin >= 0:
            place(given, layout, pose, item, spot)
        else:
            layout.bin[item] = -1
    used = tuple(sorted({spot.bin for spot in start})) if wish.settled else ()
    shared = Shared(layout, used, wish, lambda found: tell(spots_of(found)))
    tables = tables_for(problem, given, wish.threads)
    with ThreadPoolExecutor(wish.threads) as pool:
        list(pool.map(lambda number: _work(problem, tables, shared, wish, number), range(wish.threads)))


def _work(problem: Problem, tables: Tables, shared: Shared, wish: Wish, number: int) -> None:
    """Search in one thread."""
    bench = bench_for(problem, wish.seed, number, tables)
    with shared.lock:
        shared.stops.append(bench.stop)
    begin = monotonic()
    timer = threading.Timer(max(wish.end - begin, 0.0), lambda: bench.stop.__setitem__(0, OVER))
    timer.daemon = True
    timer.start()
    fewer_end = wish.end if not any(wish.rectangle) else begin + FEWER_SHARE * (wish.end - begin)
    if number % 2 and shared.used:
        emptied(bench, problem, shared, fewer_end)
        bench.given.bins.size[:] = problem.bins
    fewer(bench, problem, shared, fewer_end)
    bench.given.bins.size[:] = problem.bins
    if number == 0 and interlocking(problem):
        interlocked(bench, problem, shared, wish, monotonic() + INTERLOCK_SHARE * (wish.end - monotonic()))
    if shared.used:
        shorter(bench, shared, wish)
    timer.cancel()


def warm_up(problem: Problem, start: Sequence[Spot]) -> bool:
    """Have all kernels compiled by parting a small layout once and putting it together; whether both worked."""
    bench = bench_for(problem, 0, 0)
    for item, spot in enumerate(start):
        place(bench.given, bench.layout, bench.pose, item, spot)
    narrow(bench, bench.given, 0, float(problem.bins[0][0]))
    return parted(bench, bench.given, PATIENCE, EFFORT) == 0.0 and assembled(problem, 0, lambda: False) is not None
