"""Shapes laid into a layout, walls of regions, and what a place costs: closed forms, and shapely's answer."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from shapely import MultiPolygon, Point, Polygon, affinity, box

from stages.geometry.arrays import EPS
from stages.nest.separation.laying import WALL, cost_at, distance_in, leaves, may_lie, overlap, wall
from stages.nest.separation.problem import HAIR_MM, Item, pose_for
from stages.nest.separation.sampling import Area
from stages.nest.separation.state import NOWHERE, RECTANGLE, Regions
from tests.near import assert_near
from tests.stages.nest.separation.scenes import (
    UPRIGHT,
    Scene,
    angles,
    ell,
    figures,
    frame,
    kind,
    laid,
    oblong,
    ones,
    posed,
    put,
    scene,
    shares,
)

ROUNDING = 64 * EPS
HOLED = Polygon(box(0, 0, 1000, 600).exterior, [box(300, 200, 500, 400).exterior])
ISLANDS = MultiPolygon([HOLED, box(1010, 0, 1300, 600), box(340, 240, 460, 360)])
SLANTED = Polygon([(0, 0), (900, 100), (1000, 700), (500, 300), (100, 600)])
REGIONS: dict[str, Area] = {"with a hole": HOLED, "islands": ISLANDS, "hollow": SLANTED}


def within(region: Area, *shapes: Polygon) -> Scene:
    """A scene of shapes that may lie on a region only."""
    on = scene([kind(one, regions=(0,)) for one in shapes], bins=((2000.0, 1000.0),))
    given_ = replace(on.given, regions=field_of(region))
    return on._replace(given=given_, pose=pose_for(given_))


@cache
def field_of(region: Area) -> Regions:
    """The arrays of a region, made once: they take longer than all else here."""
    return scene([kind(oblong(1.0, 1.0), regions=(0,))], regions=(region,)).given.regions


def is_out(on: Scene, x: float, y: float, angle: float = 0.0) -> bool:
    return bool(leaves(on.given.shapes, on.given.regions, 0, posed(on, 0, angle), 0, x, y))


def wall_at(on: Scene, x: float, y: float, angle: float = 0.0) -> float:
    given_ = on.given
    return float(wall(given_.shapes, given_.rules, given_.regions, posed(on, 0, angle), 0, 0, x, y))


@given(figures(), angles(), shares(), shares())
@settings(max_examples=60, deadline=None)
def test_an_item_lies_where_its_motion_takes_it(shape: Polygon, angle: float, x: float, y: float) -> None:
    on, size = scene([kind(shape)]), shape.length
    put(on, 0, x * size, y * size, angle)
    there = laid(on, 0)
    ends = on.layout.edges[:, :2]
    assert_near(on.layout.box[0], there.bounds, bound=ROUNDING * size, why="two ways to turn and move")
    for corner in ends:
        assert there.boundary.distance(Point(corner)) <= ROUNDING * size
    for px, py, radius in on.layout.poles.T:
        assert there.boundary.distance(Point(px, py)) >= radius - 4.0 * ROUNDING * size


def test_a_quarter_turn_is_exact() -> None:
    on = scene([kind(oblong(30.0, 10.0))])
    pose = posed(on, 0, 90.0)
    assert_near(pose.box, (-5.0, -15.0, 5.0, 15.0), bound=1.1 * HAIR_MM, why="a hair inside")
    assert -pose.box[0] == pose.box[2]


def test_an_item_says_how_it_lies() -> None:
    on = scene([kind(oblong(30.0, 10.0)), kind(ell(9.0, 3.0), ((40.0, 60.0),))])
    put(on, 1, 7.0, -3.0, 45.0)
    layout = on.layout
    assert (layout.x[1], layout.y[1], layout.angle[1]) == (7.0, -3.0, np.radians(45.0))
    assert (layout.cos[1], layout.sin[1]) == (np.cos(np.radians(45.0)), np.sin(np.radians(45.0)))
    assert (layout.kind[1], layout.bin[1], layout.span[1]) == (1, 0, on.given.rules.turn[1, 0])


def test_a_copy_turned_over_is_its_other_shape_and_nothing_of_the_first_is_left() -> None:
    hull, hook, dot = ell(30.0, 10.0).convex_hull, ell(30.0, 10.0), oblong(1.0, 1.0)
    on = scene([kind(hull), kind(hook), kind(dot)], [Item(0, 1), Item(2, 2)])
    for _ in range(2):
        put(on, 0, 0.0, 0.0, kind_=1)
        assert overlap(on.given.shapes, on.layout, 0, posed(on, 2), 2, 2.0, 2.0) == 0.0, "in the bay of the hook"
        assert overlap(on.given.shapes, on.layout, 0, posed(on, 2), 2, -10.0, 10.0) > 0.0
        put(on, 0, 0.0, 0.0, kind_=0)
        assert overlap(on.given.shapes, on.layout, 0, posed(on, 2), 2, -1.0, -1.0) > 0.0
        assert overlap(on.given.shapes, on.layout, 0, posed(on, 2), 2, 12.0, 12.0) == 0.0, "beside the hull"


def test_discs_of_parts_that_touch_do_not_reach_into_each_other() -> None:
    square = oblong(100.0, 100.0)
    on = scene([kind(square), kind(square)])
    put(on, 0, 0.0, 0.0)
    away = 2.0 * on.given.shapes.poles[1, 0]
    for y in (away, -away, 0.0):
        for angle in (0.0, 90.0, 180.0, 270.0):
            assert overlap(on.given.shapes, on.layout, 0, posed(on, 1, angle), 1, 100.0, y) == 0.0
            assert overlap(on.given.shapes, on.layout, 0, posed(on, 1, angle), 1, -100.0, y) == 0.0


@pytest.mark.parametrize("name", REGIONS)
@given(shares(), shares())
@settings(max_examples=60, deadline=None)
def test_the_distance_is_read_from_the_grid_to_less_than_a_cell(name: str, x: float, y: float) -> None:
    on = within(REGIONS[name], oblong(1.0, 1.0))
    regions, point = on.given.regions, Point(600.0 + 700.0 * x, 300.0 + 400.0 * y)
    found = float(distance_in(regions, 0, point.x, point.y))
    true = REGIONS[name].boundary.distance(point) * (1.0 if REGIONS[name].contains(point) else -1.0)
    cell = float(regions.cell[0])
    assert found <= true + 0.7072 * cell, "the mean distance to the corners of a cell is at most this"
    low_x, low_y, high_x, high_y = REGIONS[name].bounds
    if low_x <= point.x <= high_x and low_y <= point.y <= high_y:
        assert found >= true - 0.7072 * cell


@pytest.mark.parametrize("name", REGIONS)
@given(figures((1.0, 30.0, 300.0)), angles(), shares(), shares())
@settings(max_examples=60, deadline=None)
def test_a_shape_leaves_a_region_where_shapely_says_so(
    name: str, shape: Polygon, angle: float, x: float, y: float
) -> None:
    region = REGIONS[name]
    on = within(region, shape)
    place = (600.0 + 700.0 * x, 300.0 + 400.0 * y)
    put(on, 0, *place, angle)
    there = laid(on, 0)
    out = is_out(on, *place, angle)
    assert (wall_at(on, *place, angle) > 0.0) == out
    if float(there.difference(region).area) > ROUNDING * 1e6:
        assert out
    if region.contains(there) and region.boundary.distance(there) > ROUNDING * 1e3:
        assert not out


def test_a_shape_that_fits_a_region_exactly_does_not_leave_it() -> None:
    on = within(box(0, 0, 300, 200), oblong(300.0, 200.0))
    assert not is_out(on, 150.0, 100.0)
    assert not is_out(within(box(0, 0, 200, 300), oblong(300.0, 200.0)), 100.0, 150.0, 90.0)
    assert is_out(on, 150.0 + 4.0 * HAIR_MM, 100.0)
    assert is_out(on, 150.0, 100.0 - 4.0 * HAIR_MM)


def test_a_shape_over_the_hole_of_a_region_leaves_it_unless_its_own_hole_is_there() -> None:
    assert is_out(within(HOLED, oblong(400.0, 400.0)), 400.0, 300.0)
    assert is_out(within(HOLED, oblong(100.0, 100.0)), 400.0, 300.0), "it lies in the hole"
    assert not is_out(within(HOLED, frame(400.0, 200.0)), 400.0, 300.0)
    assert is_out(within(HOLED, frame(400.0, 199.0)), 400.0, 300.0)


def test_a_part_may_lie_on_an_island_and_not_across_the_gap_between_two() -> None:
    small = within(ISLANDS, oblong(100.0, 100.0))
    assert not is_out(small, 400.0, 300.0), "on the island in the hole"
    assert is_out(within(ISLANDS, oblong(300.0, 300.0)), 400.0, 300.0), "over the hole and its island"
    assert not is_out(small, 1060.0, 300.0)
    assert is_out(small, 1005.0, 300.0)
    assert not is_out(within(ISLANDS, frame(180.0, 130.0)), 150.0, 300.0)
    assert is_out(within(ISLANDS, frame(180.0, 130.0)), 400.0, 300.0), "around the island, in the hole"


def test_what_is_farther_out_costs_more() -> None:
    on = within(box(0, 0, 1000, 600), oblong(100.0, 100.0))
    found = [wall_at(on, 990.0 + 10.0 * step, 300.0) for step in range(20)]
    assert found == sorted(found)
    assert len(set(found)) == len(found)
    far = wall_at(on, 1e5, 300.0)
    assert far > found[-1]
    assert np.isfinite(far)


def test_a_rectangle_has_no_wall_as_its_items_are_kept_in_it() -> None:
    on = scene([kind(oblong(10.0, 10.0))], bins=((5.0, 5.0),))
    assert wall_at(on, 400.0, 300.0) == 0.0


def test_a_kind_may_lie_where_it_has_a_region_and_an_angle() -> None:
    shape = oblong(1.0, 1.0)
    on = scene(
        [kind(shape, regions=(RECTANGLE, NOWHERE, 0)), kind(shape, (), regions=(RECTANGLE, NOWHERE, 0))],
        bins=((10.0, 5.0),) * 3,
        regions=(box(0, 0, 5, 5),),
    )
    assert [bool(may_lie(on.given.rules, 0, bin_)) for bin_ in range(3)] == [True, False, True]
    assert not any(may_lie(on.given.rules, 1, bin_) for bin_ in range(3))


def costs(
    on: Scene, item: int, place: tuple[float, float], *, limit: float = np.inf, bin_: int = 0, heavy: float = 1.0
) -> float:
    """The cost of an item at a place; the weight of the pair of items 0 and 2 is `heavy`."""
    given_, which, weights = on.given, int(on.given.items.kind[item]), ones(on)
    weights.pair[0, 2] = heavy
    rules = (on.tables, given_.shapes, given_.rules, given_.regions)
    return float(cost_at(*rules, on.layout, weights, posed(on, which), item, which, bin_, *place, limit))


def four(*, region: bool = False) -> Scene:
    """Four squares at (0, 0), twice at (80, 0), and in another bin at (0, 0)."""
    numbers = (0, 0) if region else (RECTANGLE, RECTANGLE)
    wide = box(-50, -50, 200, 200)
    on = scene([kind(oblong(100.0, 100.0), UPRIGHT, numbers)] * 4, bins=((1e3, 1e3),) * 2, regions=(wide,))
    for item, x in enumerate((0.0, 80.0, 80.0)):
        put(on, item, x, 0.0)
    put(on, 3, 0.0, 0.0, bin_=1)
    return on


def test_a_cost_is_the_sum_over_the_others_in_the_bin_by_their_weights() -> None:
    on = four()
    single = float(overlap(on.given.shapes, on.layout, 1, posed(on, 0), 0, 0.0, 0.0))
    assert single > 0.0
    assert_near(costs(on, 0, (0.0, 0.0)), 2.0 * single, bound=1e-12 * single, why="two others, neither itself")
    assert_near(costs(on, 0, (0.0, 0.0), heavy=5.0), 6.0 * single, bound=1e-12 * single, why="the weights")
    assert costs(on, 3, (0.0, 0.0), bin_=1) == 0.0, "nothing else lies there"
    assert costs(on, 0, (500.0, 0.0)) == 0.0


def test_a_cost_above_the_limit_is_told_without_looking_at_the_rest() -> None:
    on = four()
    single = float(overlap(on.given.shapes, on.layout, 1, posed(on, 0), 0, 0.0, 0.0))
    assert single * 0.5 <= costs(on, 0, (0.0, 0.0), limit=single * 0.5) < 2.0 * single
    assert costs(on, 0, (0.0, 0.0), limit=np.inf) > single * 1.5


def test_the_wall_counts_in_the_cost() -> None:
    on = four(region=True)
    assert costs(on, 0, (100.0, 140.0)) == 0.0
    out = wall_at(on, 190.0, 100.0)
    assert out > 0.0
    assert_near(costs(on, 0, (190.0, 100.0)), out, bound=1e-12 * out, why="nothing else is there")


def test_the_wall_of_a_deep_shape_is_its_discs_times_their_radii() -> None:
    on = within(box(0, 0, 1000, 600), oblong(100.0, 100.0))
    discs, x = on.given.shapes.poles.T, 1030.0
    into = discs[:, 2] - (1000.0 - x - discs[:, 0])
    eps = 0.01 * 100.0
    into = np.where(into < eps, eps * eps / (2.0 * eps - into), into)
    wanted = WALL * np.sqrt(float((into * discs[:, 2]).sum()) + eps * eps) * 100.0
    bound = 1e-3 * wanted
    assert_near(wall_at(on, x, 300.0), wanted, bound=bound, why="by hand; the grid is exact near a straight edge")


def test_moving_everything_changes_nothing() -> None:
    region = SLANTED
    away = within(affinity.translate(region, 40.0, -70.0), ell(300.0, 50.0))
    here = within(region, ell(300.0, 50.0))
    for x, y in ((300.0, 250.0), (600.0, 250.0), (150.0, 500.0)):
        assert is_out(here, x, y, 20.0) == is_out(away, x + 40.0, y - 70.0, 20.0)
        a, b = wall_at(here, x, y, 20.0), wall_at(away, x + 40.0, y - 70.0, 20.0)
        assert_near(a, b, bound=1e-6 * max(a, 1.0), why="the grid moves with it")
