"""Items that overlap are parted: by shapely nothing overlaps, and every rule of where they may lie is kept."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import MultiPolygon, Polygon, box

from stages.nest.separation.problem import Item, empty_layout
from stages.nest.separation.separate import (
    FALL,
    RAISE,
    RAISE_MORE,
    copy_places,
    measure,
    overlaps_any,
    press_in,
    reweigh,
    seed_all,
    separate,
)
from stages.nest.separation.state import NOWHERE, RECTANGLE, Layout, Weights
from tests.near import assert_near
from tests.stages.nest.separation.scenes import (
    BY_QUARTERS,
    FREE,
    UPRIGHT,
    Scene,
    ell,
    figures,
    frame,
    kind,
    laid,
    oblong,
    ones,
    overlaps,
    put,
    scene,
)

EFFORT = np.array((20, 12, 8))
SEEDS = st.integers(0, 2**31 - 1)


def parted(on: Scene, seed: int = 1, *, patience: int = 100, rounds: int = 500, stop: int = 0) -> tuple[float, Scene]:
    """The least overlap reached, and the layout that has it."""
    best = empty_layout(on.problem, on.given)
    seed_all(seed)
    left = separate(
        on.tables, on.given.shapes, on.given.rules, on.given.regions, on.given.items, on.layout, best, on.given.bins,
        ones(on), on.pose, patience, 1, rounds, EFFORT, np.array([stop]),
    )  # fmt: skip
    return float(left), on._replace(layout=best)


def total(on: Scene, *, exact: bool = True) -> tuple[float, np.ndarray, np.ndarray]:
    """The overlap of a layout, of its pairs, and with the edges."""
    count = len(on.problem.items)
    pairs, walls = np.zeros((count, count)), np.zeros(count)
    given_ = on.given
    found = measure(
        on.tables, given_.shapes, given_.rules, given_.regions, given_.items, on.layout, given_.bins, on.pose, pairs,
        walls, exact
    )  # fmt: skip
    return float(found), pairs, walls


def scattered(on: Scene, seed: int, width: float, height: float) -> Scene:
    """All items of a scene laid at random within a width and a height of the first bin."""
    rng = np.random.default_rng(seed)
    for item in range(len(on.problem.items)):
        put(on, item, *(rng.uniform(0.0, 1.0, 2) * (width, height)))
    press_in(on.given.shapes, on.layout, on.given.bins, on.pose, on.given.items.fixed)
    return on


def assert_legal(on: Scene) -> None:
    """Nothing overlaps in a bin, and everything lies in its bin, its region and its spans."""
    layout, problem = on.layout, on.problem
    count = len(problem.items)
    for bin_, (width, height) in enumerate(problem.bins):
        there = [laid(on, item) for item in range(count) if layout.bin[item] == bin_]
        assert overlaps(there) == 0.0
        assert all(box(0.0, 0.0, width, height).buffer(1e-6).contains(one) for one in there)
    for item in range(count):
        which, bin_ = int(layout.kind[item]), int(layout.bin[item])
        assert which in (problem.items[item].kind, problem.items[item].other)
        number = problem.kinds[which].regions[bin_]
        assert number != NOWHERE
        if number != RECTANGLE:
            assert problem.regions[number].buffer(1e-9).contains(laid(on, item))
        angle = float(np.degrees(layout.angle[item]))
        assert any(low - 1e-9 <= angle <= high + 1e-9 for low, high in problem.kinds[which].spans[bin_])


@given(SEEDS)
@settings(max_examples=10, deadline=None)
def test_squares_in_a_roomy_bin_are_parted(seed: int) -> None:
    on = scattered(scene([kind(oblong(10.0, 10.0))] * 12, bins=((80.0, 50.0),)), seed, 80.0, 50.0)
    left, best = parted(on, seed)
    assert left == 0.0
    assert_legal(best)


@given(st.lists(figures((20.0, 40.0)), min_size=3, max_size=6), SEEDS)
@settings(max_examples=10, deadline=None)
def test_hollow_figures_that_may_be_turned_are_parted(shapes: list[Polygon], seed: int) -> None:
    on = scene([kind(one, FREE) for one in shapes], bins=((400.0, 200.0),))
    left, best = parted(scattered(on, seed, 200.0, 150.0), seed)
    assert left == 0.0
    assert_legal(best)


def test_what_fits_only_exactly_is_found_by_contacts() -> None:
    on = scene([kind(oblong(10.0, 10.0))] * 6, bins=((30.0, 20.0),))
    left, best = parted(scattered(on, 4, 30.0, 20.0), 4)
    assert left == 0.0
    assert_legal(best)


def test_too_much_for_a_bin_is_not_parted_and_the_least_bad_layout_is_kept() -> None:
    on = scene([kind(oblong(10.0, 10.0))] * 5, bins=((20.0, 20.0),))
    left, best = parted(scattered(on, 4, 20.0, 20.0), rounds=50)
    assert left > 0.0
    found, *_ = total(best, exact=False)
    assert_near(found, left, bound=1e-9 * left, why="the same sum")


def test_fixed_items_stay_and_the_others_go_around_them() -> None:
    items = [Item(0, 0, fixed=True), *[Item(0, 0)] * 7]
    on = scene([kind(oblong(10.0, 10.0))], items, bins=((62.0, 34.0),))
    scattered(on, 2, 62.0, 34.0)
    put(on, 0, 31.0, 17.0)
    left, best = parted(on)
    assert left == 0.0
    assert (best.layout.x[0], best.layout.y[0], best.layout.angle[0]) == (31.0, 17.0, 0.0)
    assert_legal(best)


def test_what_is_fixed_is_not_for_the_search_to_judge() -> None:
    items = [*[Item(0, 0, fixed=True)] * 3, Item(0, 0)]
    on = scene([kind(oblong(10.0, 10.0), regions=(0,))], items, bins=((45.0, 25.0),), regions=(box(0, 0, 45, 25),))
    places = [(10.0, 10.0), (12.0, 10.0), (42.0, 10.0), (25.0, 10.0)]
    for item, place in enumerate(places):
        put(on, item, *place)
    left, best = parted(on)
    assert left == 0.0, "though two of them overlap, and one leaves the region and the bin"
    assert best.layout.x.tolist() == [10.0, 12.0, 42.0, 25.0]
    put(on, 3, 19.0, 10.0)
    assert total(on)[0] > 0.0, "what is not fixed must not overlap them"


def test_nothing_goes_where_its_kind_may_not_lie() -> None:
    kinds = [
        kind(oblong(10.0, 10.0), UPRIGHT, (RECTANGLE, NOWHERE)),
        kind(oblong(10.0, 10.0), UPRIGHT, (RECTANGLE, RECTANGLE)),
    ]
    on = scene(kinds, [Item(0, 0)] * 4 + [Item(1, 1)] * 3, bins=((22.0, 22.0), (40.0, 12.0)))
    left, best = parted(scattered(on, 6, 22.0, 22.0))
    assert left == 0.0
    assert best.layout.bin.tolist() == [0] * 4 + [1] * 3
    assert_legal(best)


BAD = Polygon(box(0, 0, 100, 60).exterior, [box(30, 10, 70, 50).exterior])
PARTS = MultiPolygon([box(0, 0, 28, 60), box(72, 0, 100, 60)])


@pytest.mark.parametrize("seed", range(3))
def test_every_kind_keeps_to_its_own_region(seed: int) -> None:
    kinds = [kind(oblong(20.0, 9.0), BY_QUARTERS, (0,)), kind(ell(24.0, 8.0), FREE, (1,)), kind(oblong(38.0, 38.0))]
    on = scene(kinds, [Item(0, 0)] * 4 + [Item(1, 1)] * 2 + [Item(2, 2)], bins=((100.0, 60.0),), regions=(BAD, PARTS))
    left, best = parted(scattered(on, seed, 100.0, 60.0), seed)
    assert left == 0.0
    assert_legal(best)


def test_angles_stay_within_the_spans() -> None:
    spans = ((80.0, 100.0), (260.0, 280.0))
    on = scene([kind(oblong(30.0, 8.0), spans)] * 6, bins=((80.0, 80.0),))
    for item in range(6):
        put(on, item, 40.0, 40.0, 90.0)
    left, best = parted(on)
    assert left == 0.0
    assert_legal(best)
    assert len(set(best.layout.angle.tolist())) > 1, "some were turned"


def test_small_parts_go_into_the_holes_of_large_ones() -> None:
    on = scene([kind(frame(60.0, 40.0)), *[kind(oblong(15.0, 15.0))] * 4], bins=((60.0, 60.0),))
    left, best = parted(scattered(on, 3, 60.0, 60.0))
    assert left == 0.0
    assert_legal(best)


def test_an_item_in_an_angle_in_which_it_does_not_fit_its_bin_is_turned() -> None:
    on = scene([kind(oblong(50.0, 20.0), BY_QUARTERS)], bins=((80.0, 30.0),))
    put(on, 0, 40.0, 15.0, 90.0)
    press_in(on.given.shapes, on.layout, on.given.bins, on.pose, on.given.items.fixed)
    assert total(on)[0] > 0.0, "it sticks out"
    left, best = parted(on)
    assert left == 0.0
    assert_legal(best)


def test_an_item_that_fits_in_no_angle_never_counts_as_parted() -> None:
    on = scene([kind(oblong(50.0, 40.0), BY_QUARTERS)], bins=((80.0, 30.0),))
    put(on, 0, 40.0, 15.0)
    left, _ = parted(on, rounds=5)
    assert left > 0.0


def test_the_same_seed_parts_in_the_same_way() -> None:
    def once(seed: int) -> Layout:
        on = scene([kind(ell(20.0, 6.0), FREE)] * 6, bins=((90.0, 60.0),))
        return parted(scattered(on, 1, 90.0, 60.0), seed)[1].layout

    first, second, other = once(7), once(7), once(8)
    assert first.x.tolist() == second.x.tolist()
    assert first.angle.tolist() == second.angle.tolist()
    assert first.x.tolist() != other.x.tolist()


def test_a_stop_ends_it_before_anything_moves() -> None:
    on = scattered(scene([kind(oblong(10.0, 10.0))] * 9, bins=((31.0, 31.0),)), 1, 20.0, 20.0)
    before, *_ = total(on, exact=False)
    left, best = parted(on, stop=1)
    assert left == before > 0.0
    assert best.layout.x.tolist() == on.layout.x.tolist()


def test_patience_ends_what_makes_no_progress() -> None:
    on = scene([kind(oblong(10.0, 10.0))] * 2, bins=((10.0, 10.0),))
    put(on, 0, 5.0, 5.0)
    put(on, 1, 5.0, 5.0)
    left, _ = parted(on, patience=3, rounds=10**9)
    assert left > 0.0


def test_the_overlap_of_a_layout_is_the_sum_over_pairs_and_walls() -> None:
    on = scene([kind(oblong(10.0, 10.0), regions=(0,))] * 3, bins=((50.0, 50.0),), regions=(box(0, 0, 50, 50),))
    for item, x in enumerate((10.0, 15.0, 46.0)):
        put(on, item, x, 10.0)
    found, pairs, walls = total(on)
    assert (pairs == pairs.T).all()
    assert np.argwhere(pairs > 0.0).tolist() == [[0, 1], [1, 0]]
    assert np.flatnonzero(walls).tolist() == [2]
    assert_near(found, float(pairs[0, 1] + walls[2]), bound=1e-12 * found, why="the sum")
    assert [bool(overlaps_any(pairs, walls, item)) for item in range(3)] == [True, True, True]
    walls[2] = 0.0
    assert not overlaps_any(pairs, walls, 2)


def test_weights_of_what_overlaps_rise_and_the_others_fall_back_to_one() -> None:
    pairs = np.array([[0.0, 4.0, 2.0], [4.0, 0.0, 0.0], [2.0, 0.0, 0.0]])
    walls = np.array([0.0, 1.0, 0.0])
    weights = Weights(np.full((3, 3), 3.0), np.array([1.01, 1.0, 3.0]))
    reweigh(weights, pairs, walls)
    worst, half = 3.0 * (RAISE + RAISE_MORE), 3.0 * (RAISE + RAISE_MORE / 2.0)
    fallen = 3.0 * FALL
    wanted = [[fallen, worst, half], [worst, fallen, fallen], [half, fallen, fallen]]
    assert_near(weights.pair, wanted, bound=1e-12, why="closed form")
    assert_near(weights.wall, [1.0, RAISE + RAISE_MORE / 4.0, fallen], bound=1e-12, why="closed form")


def test_without_any_overlap_no_weight_changes() -> None:
    weights = Weights(np.full((2, 2), 3.0), np.full(2, 3.0))
    reweigh(weights, np.zeros((2, 2)), np.zeros(2))
    assert (weights.pair == 3.0).all()
    assert (weights.wall == 3.0).all()


def test_what_is_pressed_in_lies_in_its_bin_and_what_is_fixed_or_inside_stays() -> None:
    on = scene([kind(oblong(10.0, 10.0))], [Item(0, 0), Item(0, 0, fixed=True), Item(0, 0)], bins=((40.0, 30.0),))
    for item, (x, y) in enumerate([(99.0, -7.0), (99.0, -7.0), (20.0, 20.0)]):
        put(on, item, x, y)
    press_in(on.given.shapes, on.layout, on.given.bins, on.pose, on.given.items.fixed)
    wanted = [(35.0, 5.0), (99.0, -7.0), (20.0, 20.0)]
    assert_near(np.column_stack([on.layout.x, on.layout.y]), wanted, bound=1e-6, why="up to the hair")
    assert_near(laid(on, 0).bounds, on.layout.box[0], bound=1e-12, why="the box goes with it")


def test_a_copied_layout_is_the_same_and_its_own() -> None:
    on = scattered(scene([kind(ell(20.0, 6.0), FREE)] * 3, bins=((90.0, 60.0),)), 1, 90.0, 60.0)
    other = empty_layout(on.problem, on.given)
    copy_places(on.layout, other)
    assert all(np.array_equal(a, b) for a, b in zip(on.layout, other, strict=True))
    put(on, 0, 1.0, 1.0, 3.0)
    assert not np.array_equal(on.layout.edges, other.edges)
