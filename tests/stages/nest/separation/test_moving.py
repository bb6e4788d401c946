"""One item moved: it stays in its bin and its spans, meets corners exactly, and never comes to lie worse."""

from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import Polygon, box

from stages.geometry.arrays import EPS
from stages.nest.separation.laying import cost_at
from stages.nest.separation.moving import (
    COARSE,
    COARSE_END,
    FAR,
    FITS,
    NEARBY,
    TOUCHING,
    any_turn,
    bounds_in,
    draw,
    move,
    moved_in,
    sticks_out,
    walk,
)
from stages.nest.separation.problem import HAIR_MM, Item, Span
from stages.nest.separation.separate import press_in, seed_all
from stages.nest.separation.state import NOWHERE, RECTANGLE
from tests.near import assert_near
from tests.stages.nest.separation.scenes import (
    BY_QUARTERS,
    FREE,
    UPRIGHT,
    Scene,
    ell,
    figures,
    kind,
    laid,
    moved,
    oblong,
    ones,
    overlaps,
    posed,
    put,
    scene,
)

EFFORT = np.array((20, 12, 8))
SEEDS = st.integers(0, 2**31 - 1)
Place = tuple[int, int, int, float, float, float, float, float]


def here(on: Scene, item: int) -> Place:
    """Where an item lies, as the kernels say it."""
    one = on.layout
    return (
        int(one.kind[item]), int(one.bin[item]), int(one.span[item]), float(one.angle[item]), float(one.cos[item]),
        float(one.sin[item]), float(one.x[item]), float(one.y[item]),
    )  # fmt: skip


def cost_of(on: Scene, item: int) -> float:
    """The cost of an item where it lies."""
    kind_, bin_, _, angle, _, _, x, y = here(on, item)
    rules = (on.tables, on.given.shapes, on.given.rules, on.given.regions)
    pose = posed(on, kind_, float(np.degrees(angle)))
    return float(cost_at(*rules, on.layout, ones(on), pose, item, kind_, bin_, x, y, np.inf))


def crowd(shapes: list[Polygon], width: float, height: float, seed: int, spans: tuple[Span, ...] = FREE) -> Scene:
    """Shapes laid at random in a bin that has room for each."""
    rng = np.random.default_rng(seed)
    on = scene([kind(one, spans) for one in shapes], bins=((width, height),))
    for item in range(len(shapes)):
        put(on, item, *(rng.uniform(0.2, 0.8, 2) * (width, height)), float(rng.choice([0.0, 90.0, 200.0])))
    press_in(on.given.shapes, on.layout, on.given.bins, on.pose, on.given.items.fixed)
    return on


def run(on: Scene, item: int) -> float:
    given_ = on.given
    return float(
        move(
            on.tables, given_.shapes, given_.rules, given_.regions, given_.items, on.layout, given_.bins, ones(on),
            on.pose, item, EFFORT,
        )
    )  # fmt: skip


def test_a_pose_lies_in_its_bin_with_its_middle_between_these() -> None:
    on = scene([kind(oblong(30.0, 10.0), regions=(RECTANGLE,) * 2)], bins=((100.0, 60.0), (60.0, 100.0)))
    wanted = (15.0, 85.0, 5.0, 55.0)
    assert_near(bounds_in(on.given.bins, posed(on, 0), 0), wanted, bound=1.1 * HAIR_MM, why="a hair inside")
    turned = (5.0, 55.0, 15.0, 85.0)
    assert_near(bounds_in(on.given.bins, posed(on, 0, 90.0), 1), turned, bound=1.1 * HAIR_MM, why="a hair inside")


def test_what_fits_a_bin_but_for_rounding_has_one_place_and_what_is_larger_has_none() -> None:
    on = scene(
        [kind(oblong(30.0, 10.0), regions=(RECTANGLE,) * 2)], bins=((30.0 - 2.5 * HAIR_MM, 40.0), (29.0, 40.0))
    )  # fmt: skip
    low, high, *_ = bounds_in(on.given.bins, posed(on, 0), 0)
    assert low == high
    assert_near(low, 15.0, bound=FITS + HAIR_MM, why="the middle")
    low, high, *_ = bounds_in(on.given.bins, posed(on, 0), 1)
    assert low > high


@given(SEEDS)
@settings(max_examples=50, deadline=None)
def test_a_random_angle_is_within_a_span_of_the_kind(seed: int) -> None:
    spans = ((10.0, 20.0), (90.0, 90.0), (340.0, 380.0))
    on = scene([kind(oblong(1.0, 1.0)), kind(oblong(1.0, 1.0), spans)])
    seed_all(seed)
    span, angle, c, s = any_turn(on.given.rules, 1, 0)
    assert on.given.rules.turn[1, 0] <= span < on.given.rules.turns[1, 0]
    low, high = on.given.rules.span[span, :2]
    assert low <= angle <= high
    assert (c, s) == (0.0, 1.0) if low == high else (np.cos(angle), np.sin(angle))


def test_every_span_is_drawn() -> None:
    on = scene([kind(oblong(1.0, 1.0), BY_QUARTERS)])
    seed_all(1)
    assert {any_turn(on.given.rules, 0, 0)[1] for _ in range(200)} == {0.0, pi / 2.0, pi, 1.5 * pi}


@given(figures((30.0,)), figures((30.0, 100.0)), SEEDS)
@settings(max_examples=40, deadline=None)
def test_a_walk_never_ends_worse_and_tells_the_cost_of_its_end(one: Polygon, other: Polygon, seed: int) -> None:
    on = crowd([one, other, oblong(40.0, 20.0)], 200.0, 150.0, seed)
    seed_all(seed)
    before = cost_of(on, 0)
    given_ = on.given
    rules = (on.tables, given_.shapes, given_.rules, given_.regions)
    place, cost = walk(
        *rules, on.layout, given_.bins, ones(on), on.pose, 0, here(on, 0), before, COARSE, COARSE_END
    )  # fmt: skip
    assert cost <= before
    kind_, bin_, span, angle, c, s, x, y = place
    low, high = given_.rules.span[span, :2]
    assert low <= angle <= high
    put(on, 0, x, y, float(np.degrees(angle)))
    assert_near(cost_of(on, 0), cost, bound=1e-6 * max(before, 1.0), why="the same place, its angle through degrees")
    assert (kind_, bin_) == (0, 0)
    assert_near(c * c + s * s, 1.0, bound=8 * EPS, why="cosine and sine")


@given(figures((30.0, 60.0)), figures((30.0, 60.0)), SEEDS)
@settings(max_examples=40, deadline=None)
def test_a_moved_item_lies_no_worse_within_its_bin_and_where_the_layout_says(
    one: Polygon, other: Polygon, seed: int
) -> None:
    on = crowd([one, other, one, oblong(40.0, 20.0)], 200.0, 150.0, seed)
    seed_all(seed)
    before, rest = cost_of(on, 0), [here(on, item) for item in range(1, 4)]
    cost = run(on, 0)
    assert cost <= before
    assert_near(cost_of(on, 0), cost, bound=1e-6 * max(before, 1.0), why="the same place, its angle through degrees")
    assert [here(on, item) for item in range(1, 4)] == rest, "nothing else moves"
    assert box(0.0, 0.0, 200.0, 150.0).buffer(1e-6).contains(laid(on, 0))
    if cost == 0.0:
        assert all(laid(on, 0).intersection(laid(on, item)).area < 1e-9 for item in range(1, 4))


def test_an_item_that_overlaps_nothing_stays() -> None:
    on = scene([kind(oblong(10.0, 10.0), FREE)] * 2, bins=((100.0, 100.0),))
    put(on, 0, 20.0, 20.0, 12.0)
    put(on, 1, 60.0, 60.0)
    place = here(on, 0)
    assert run(on, 0) == 0.0
    assert here(on, 0) == place


def test_what_sticks_out_of_its_bin_is_moved_even_to_where_it_overlaps() -> None:
    on = scene([kind(oblong(90.0, 90.0))] * 2, bins=((100.0, 100.0),))
    put(on, 0, 150.0, 50.0)
    put(on, 1, 50.0, 50.0)
    assert_near(float(sticks_out(on.given.bins, on.layout, 0)), 95.0, bound=1.1 * HAIR_MM, why="closed form")
    assert cost_of(on, 0) == 0.0
    seed_all(1)
    assert 0.0 < run(on, 0) < np.inf
    assert sticks_out(on.given.bins, on.layout, 0) == 0.0


def test_what_fits_in_no_angle_is_left_where_it_is_at_an_infinite_cost() -> None:
    on = scene([kind(oblong(120.0, 110.0), BY_QUARTERS)], bins=((100.0, 100.0),))
    put(on, 0, 50.0, 50.0)
    place = here(on, 0)
    assert run(on, 0) == np.inf
    assert here(on, 0) == place


def test_an_item_finds_its_way_out_where_there_is_room() -> None:
    on = scene([kind(oblong(10.0, 10.0))] * 3, bins=((100.0, 100.0),))
    for item in range(3):
        put(on, item, 50.0, 50.0)
    seed_all(3)
    assert run(on, 0) == 0.0
    assert run(on, 1) == 0.0
    assert overlaps([laid(on, item) for item in range(3)]) == 0.0


def test_an_item_is_moved_to_a_bin_where_it_may_lie_and_turned_over_where_that_helps() -> None:
    hook = ell(30.0, 10.0)
    mirrored = Polygon([(-x, y) for x, y in hook.exterior.coords])
    kinds = [
        kind(oblong(60.0, 60.0), UPRIGHT, (RECTANGLE, NOWHERE, RECTANGLE)),
        kind(hook, UPRIGHT, (RECTANGLE, NOWHERE, NOWHERE)),
        kind(mirrored, UPRIGHT, (RECTANGLE, NOWHERE, RECTANGLE)),
    ]
    on = scene(kinds, [Item(0, 0), Item(1, 2)], bins=((60.0, 60.0), (99.0, 99.0), (30.0, 30.0)))
    put(on, 0, 30.0, 30.0)
    put(on, 1, 30.0, 30.0)
    seed_all(5)
    costs = [run(on, 1) for _ in range(20)]
    assert costs[-1] == 0.0
    assert here(on, 1)[:2] == (2, 2), "mirrored, in the only bin with room for it"


@pytest.mark.parametrize("sort", [FAR, NEARBY, TOUCHING])
def test_a_place_drawn_is_one_where_the_item_may_lie(sort: int) -> None:
    on = scene(
        [kind(oblong(20.0, 10.0), BY_QUARTERS, (RECTANGLE, NOWHERE)), kind(ell(9.0, 3.0), FREE, (RECTANGLE,) * 2)],
        bins=((100.0, 60.0), (50.0, 50.0)),
    )
    put(on, 0, 50.0, 30.0)
    put(on, 1, 40.0, 30.0)
    seed_all(sort)
    for _ in range(100):
        found, place = draw(
            on.given.shapes, on.given.rules, on.given.items, on.layout, on.given.bins, 0, here(on, 0), sort
        )
        if not found:
            continue
        assert place[:2] == (0, 0)
        angle = float(np.degrees(place[3]))
        found, x, y = moved_in(on.given.shapes, on.given.bins, posed(on, 0, angle), place, sort)
        if found:
            low_x, low_y, high_x, high_y = moved(oblong(20.0, 10.0), x, y, angle).bounds
            assert min(low_x, low_y) >= -1e-6
            assert high_x <= 100.0 + 1e-6
            assert high_y <= 60.0 + 1e-6


def test_a_place_where_the_shape_does_not_fit_is_none() -> None:
    on = scene([kind(oblong(20.0, 10.0), BY_QUARTERS)], bins=((100.0, 15.0),))
    put(on, 0, 50.0, 7.0)
    for sort in (FAR, NEARBY, TOUCHING):
        assert not moved_in(on.given.shapes, on.given.bins, posed(on, 0, 90.0), here(on, 0), sort)[0]
    outside = (*here(on, 0)[:6], 5.0, 7.0)
    assert not moved_in(on.given.shapes, on.given.bins, posed(on, 0), outside, TOUCHING)[0], "it sticks out"
