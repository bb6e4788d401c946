"""A bin that the others can do without is emptied, step by step."""

from time import monotonic

import numpy as np
import pytest
from shapely import box

from stages.nest.separation.emptying import emptied, emptiest
from stages.nest.separation.problem import RECTANGLE, Item, Kind, Problem, Spot
from stages.nest.separation.separate import measure
from stages.nest.separation.sharing import Bench, Shared, Wish, bench_for, place, same_again

SIDE = 10.0
LONG_S = 600.0
"""It ends by itself when no bin can be emptied; kernels may have to be compiled first."""

BINS = ((50.0, 41.0), (50.0, 41.0), (50.0, 41.0))


def scene(counts: tuple[int, ...], cost: tuple[float, ...] = (1.0, 1.0, 1.0)) -> tuple[Problem, Bench, Shared]:
    """Squares in rows, so many in each of three bins, each with room for twenty."""
    half = SIDE / 2.0
    kind = Kind(box(-half, -half, half, half), (((0.0, 0.0),),) * 3, (RECTANGLE,) * 3)
    problem = Problem((kind,), (Item(0, 0),) * sum(counts), BINS)
    bench = bench_for(problem, 1, 0)
    spots = [
        Spot(b, 0, 0.0, half + 1e-3 + 1.01 * SIDE * (k % 4), half + 1e-3 + 1.01 * SIDE * (k // 4))
        for b, count in enumerate(counts)
        for k in range(count)
    ]
    for item, spot in enumerate(spots):
        place(bench.given, bench.layout, bench.pose, item, spot)
    used = tuple(b for b, count in enumerate(counts) if count)
    wish = Wish(monotonic() + 5.0, True, 1, 1, cost, (2050.0,) * 3, (True,) * 3)
    return problem, bench, Shared(same_again(bench.layout), used, wish, lambda _: None)


def left(bench: Bench, shared: Shared) -> float:
    count, given = shared.layout.x.size, bench.given
    pairs, walls = np.zeros((count, count)), np.zeros(count)
    return float(
        measure(
            bench.tables,
            given.shapes,
            given.rules,
            given.regions,
            given.items,
            shared.layout,
            given.bins,
            bench.pose,
            pairs,
            walls,
            True,
        )
    )


def test_two_of_three_bins_are_emptied_and_nothing_overlaps() -> None:
    problem, bench, shared = scene((6, 4, 3))
    emptied(bench, problem, shared, monotonic() + LONG_S)
    assert len(shared.used) == 1
    bench.given.bins.size[:] = BINS
    assert left(bench, shared) == 0.0


def test_the_bin_with_the_least_in_it_goes_first_and_free_ones_never() -> None:
    problem, bench, shared = scene((6, 4, 3))
    assert emptiest(bench, problem, shared) == 2
    problem, bench, shared = scene((6, 4, 3), cost=(1.0, 1.0, 0.0))
    assert emptiest(bench, problem, shared) == 1


@pytest.mark.parametrize("counts", [(12, 12, 0), (6, 0, 0)])
def test_what_the_others_cannot_hold_is_left_alone(counts: tuple[int, ...]) -> None:
    problem, bench, shared = scene(counts)
    assert emptiest(bench, problem, shared) == -1
