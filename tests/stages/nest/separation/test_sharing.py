"""How two large items change places; none goes where it may not lie, or in an angle that is not allowed there."""

import pytest

from stages.nest.separation.laying import lay
from stages.nest.separation.problem import NOWHERE, RECTANGLE, Item, Kind, Problem
from stages.nest.separation.sharing import Bench, bench_for, swap_large
from tests.stages.nest.separation.scenes import UPRIGHT, kind, oblong

BINS = ((100.0, 80.0), (100.0, 80.0))
BOTH = (RECTANGLE, RECTANGLE)
LARGE, SMALL = oblong(30.0, 30.0), oblong(5.0, 5.0)
QUARTER = ((90.0, 90.0),)
FIRST, OTHER, LAST = (0, 20.0, 20.0), (1, 60.0, 50.0), (1, 90.0, 70.0)
"""Bin and place of the items to begin with."""

Place = tuple[int, float, float]


def bench(*kinds: Kind, fixed: int | None = None) -> Bench:
    """Return a bench with an item of each kind."""
    items = tuple(Item(i, i, fixed=i == fixed) for i in range(len(kinds)))
    made = bench_for(Problem(kinds, items, BINS, ()), 1, 0)
    for item, (bin_, x, y) in zip(range(len(kinds)), (FIRST, OTHER, LAST), strict=False):
        span = int(made.given.rules.turn[item, bin_])
        angle, _, c, s = made.given.rules.span[span]
        lay(made.given.shapes, made.layout, made.pose, item, item, bin_, span, angle, c, s, x, y)
    return made


def after(made: Bench) -> list[Place]:
    """Return where the items lie after two have changed places."""
    swap_large(made, made.given)
    layout = made.layout
    return [(int(layout.bin[i]), float(layout.x[i]), float(layout.y[i])) for i in range(layout.x.size)]


def test_the_two_largest_change_places() -> None:
    assert after(bench(*(kind(shape, regions=BOTH) for shape in (LARGE, LARGE, SMALL)))) == [OTHER, FIRST, LAST]
    assert after(bench(*(kind(shape, regions=BOTH) for shape in (LARGE, SMALL, LARGE)))) == [LAST, OTHER, FIRST]


@pytest.mark.parametrize(
    "bound",
    [
        Kind(LARGE, (UPRIGHT, QUARTER), BOTH),
        Kind(LARGE, (UPRIGHT, UPRIGHT), (RECTANGLE, NOWHERE)),
        Kind(LARGE, (UPRIGHT, ()), BOTH),
    ],
    ids=["not in its angle", "not there", "in no angle"],
)
def test_an_item_stays_where_the_other_place_is_not_for_it(bound: Kind) -> None:
    assert after(bench(bound, kind(LARGE, regions=BOTH))) == [FIRST, FIRST]


def test_a_fixed_item_stays_and_one_alone_has_none_to_change_with() -> None:
    assert after(bench(kind(LARGE, regions=BOTH), kind(LARGE, regions=BOTH), fixed=1)) == [FIRST, OTHER]
    assert after(bench(kind(LARGE, regions=BOTH))) == [FIRST]
