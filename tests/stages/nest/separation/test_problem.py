"""Shapes, spans and regions as arrays: a hair inside, discs within, directions, fields of distance."""

from math import cos, pi, radians, sin

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from shapely import MultiPolygon, Point, Polygon, affinity, box, union_all

from stages.geometry.arrays import EPS
from stages.nest.separation.problem import (
    HAIR_MM,
    MOST_FEW,
    NOWHERE,
    RECTANGLE,
    Item,
    Kind,
    Problem,
    arrays,
    edges_of,
    few_angles,
    inner,
    polygons,
    tips_of,
)
from stages.nest.separation.sampling import COVERED, LEAST_POLE, MOST_POLES, poles
from tests.near import assert_near
from tests.stages.nest.separation.scenes import BY_QUARTERS, FREE, UPRIGHT, ell, figures, frame, kind, oblong, scene


def squares(*spans: tuple[tuple[float, float], ...], regions: tuple[int, ...] = ()) -> Problem:
    kinds = tuple(Kind(oblong(1.0, 1.0), (one, one), regions or (RECTANGLE, RECTANGLE)) for one in spans)
    return Problem(kinds, (Item(0, 0),), ((10.0, 5.0), (20.0, 6.0)))


@given(figures())
@settings(max_examples=60, deadline=None)
def test_the_inner_shape_lies_a_hair_inside(shape: Polygon) -> None:
    smaller = inner(shape)
    assert len(smaller.interiors) == len(shape.interiors)
    assert shape.contains(smaller)
    reach = float(smaller.boundary.distance(shape.boundary))
    assert_near(reach, HAIR_MM, bound=16 * EPS * shape.length + 1e-3 * HAIR_MM, why="an offset, after rounding")


def test_what_is_too_thin_for_a_hair_stays_as_it_is() -> None:
    thin = oblong(10.0, HAIR_MM)
    assert inner(thin).equals(thin)
    narrow = frame(10.0, 10.0 - 2.0 * HAIR_MM)
    assert len(inner(narrow).interiors) == 1


def test_edges_close_every_ring() -> None:
    edges = edges_of(MultiPolygon([frame(10.0, 4.0), box(20.0, 0.0, 25.0, 5.0)]))
    assert edges.shape == (12, 4)
    lengths = np.hypot(edges[:, 2] - edges[:, 0], edges[:, 3] - edges[:, 1])
    assert_near(float(lengths.sum()), 40.0 + 16.0 + 20.0, bound=1e-12, why="closed form")
    for ring in (edges[:4], edges[4:8], edges[8:]):
        assert (np.roll(ring, -1, axis=0)[:, :2] == ring[:, 2:]).all()


@given(figures())
@settings(max_examples=60, deadline=None)
def test_every_disc_lies_within_its_shape_the_largest_first(shape: Polygon) -> None:
    discs = poles(shape)
    assert 1 <= len(discs) <= MOST_POLES
    assert (np.diff(discs[:, 2]) <= 0.0).all()
    assert (discs[1:, 2] > LEAST_POLE * discs[0, 2]).all()
    for x, y, radius in discs:
        assert shape.contains(Point(x, y))
        assert radius > 0.0
        assert shape.boundary.distance(Point(x, y)) >= radius * (1.0 - 4 * EPS)


@given(figures())
@settings(max_examples=60, deadline=None)
def test_discs_do_not_reach_into_each_other(shape: Polygon) -> None:
    discs = poles(shape)
    for number, (x, y, radius) in enumerate(discs):
        apart = np.hypot(discs[:number, 0] - x, discs[:number, 1] - y) - discs[:number, 2] - radius
        assert (apart >= -16 * EPS * shape.length).all()


def test_discs_cover_most_of_a_square_or_there_are_as_many_as_there_may_be() -> None:
    discs = poles(oblong(100.0, 100.0))
    share = pi * float((discs[:, 2] ** 2).sum()) / 1e4
    assert share >= COVERED or len(discs) == MOST_POLES
    assert_near(float(discs[0, 2]), 50.0, bound=100.0 / 64.0, why="the middle of a cell")


def test_discs_end_at_a_share_of_the_largest_wherever_the_shape_lies() -> None:
    """A disc with a tail along a row of the grid, an eighth of the area: discs in it would have 3 % of the first."""
    tailed = union_all([Point(0.0, 0.0).buffer(50.0), box(0.0, -0.72, 450.0, 2.28)])
    near, far = poles(tailed), poles(affinity.translate(tailed, 3000.0, -40.0))
    assert_near(far, near + np.array([3000.0, -40.0, 0.0]), bound=1e-9, why="the same cells")
    assert LEAST_POLE * near[0, 2] > 1.5
    assert (near[:, 2] > LEAST_POLE * near[0, 2]).all()


def test_a_needle_between_the_points_of_the_grid_has_one_disc() -> None:
    needle = Polygon([(0.0, 0.0), (1000.0, 400.0), (1000.0, 400.001)])
    discs = poles(needle)
    assert discs.shape == (1, 3)
    assert needle.buffer(1e-9).contains(Point(*discs[0, :2]))


@pytest.mark.parametrize("shape", [ell(30.0, 10.0), shapely.reverse(ell(30.0, 10.0)), frame(30.0, 10.0)])
def test_tips_are_the_corners_of_the_outline_with_the_way_of_the_edge_that_leaves(shape: Polygon) -> None:
    tips = tips_of(shape)
    ring = Polygon(shape.exterior)
    assert len(tips) == len(ring.exterior.coords) - 1
    assert_near(np.hypot(tips[:, 2], tips[:, 3]), np.ones(len(tips)), bound=4 * EPS, why="unit length")
    for x, y, dx, dy in tips:
        assert ring.boundary.distance(Point(x + dx, y + dy)) < 1e-12
        assert ring.distance(Point(x + dx - 1e-3 * dy, y + dy + 1e-3 * dx)) == 0.0, "the inside is to the left"


def test_points_that_are_given_twice_are_one_tip() -> None:
    shape = Polygon([(0.0, 0.0), (10.0, 0.0), (10.0, 0.0), (10.0, 5.0)])
    assert len(tips_of(shape)) == 3


def test_spans_are_in_radians_with_exact_quarter_turns() -> None:
    rules = arrays(squares(BY_QUARTERS, ((30.0, 50.0), (10.0, 10.0)))).rules
    first = rules.span[rules.turn[0, 0] : rules.turns[0, 0]]
    assert first[:, 2:].tolist() == [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]]
    second = rules.span[rules.turn[1, 1] : rules.turns[1, 1]]
    wanted = [
        [radians(30.0), radians(50.0), cos(radians(30.0)), sin(radians(30.0))],
        [radians(10.0), radians(10.0), cos(radians(10.0)), sin(radians(10.0))],
    ]
    assert_near(second, wanted, bound=1e-15, why="closed form")


def test_what_may_be_turned_anyhow_has_a_few_angles_in_the_rough_rules() -> None:
    given_ = arrays(squares(FREE, UPRIGHT))
    rows = given_.rough.span[given_.rough.turn[0, 0] : given_.rough.turns[0, 0]]
    assert (rows[:, 0] == rows[:, 1]).all()
    assert_near(np.degrees(rows[:, 0]), np.arange(16) * 22.5, bound=1e-12, why="a turn in equal steps")
    (wide,) = given_.rules.span[given_.rules.turn[0, 0] : given_.rules.turns[0, 0]]
    assert_near(wide[:2], (0.0, 2.0 * pi), bound=EPS, why="any angle")
    assert given_.rough.turn[1, 0] == given_.rules.turn[1, 0], "a list stays as it is"
    assert given_.has_rough
    assert not given_.roughly.has_rough
    assert not arrays(squares(BY_QUARTERS, UPRIGHT)).has_rough


@pytest.mark.parametrize(("kinds", "angles"), [(10, 16), (22, 8), (31, 4), (32, 0)])
def test_there_are_so_many_of_them_that_there_are_not_too_many_tables(kinds: int, angles: int) -> None:
    many = tuple(Kind(oblong(1.0, 1.0), (FREE,), (RECTANGLE,)) for _ in range(kinds))
    problem = Problem(many, tuple(Item(k, k) for k in range(kinds)), ((10.0, 5.0),))
    assert len(few_angles(problem)) == angles
    assert angles * kinds * (kinds + 1) // 2 <= MOST_FEW


def test_each_bin_has_its_own_spans_and_regions() -> None:
    one = Kind(oblong(1.0, 1.0), (UPRIGHT, FREE), (RECTANGLE, NOWHERE))
    none = Kind(oblong(1.0, 1.0), ((), UPRIGHT), (RECTANGLE, RECTANGLE))
    rules = arrays(Problem((one, none), (Item(0, 0),), ((10.0, 5.0), (20.0, 6.0)))).rules
    assert rules.region.tolist() == [[RECTANGLE, NOWHERE], [RECTANGLE, RECTANGLE]]
    assert rules.span[rules.turn[0, 1], :2].tolist() == [0.0, 2.0 * pi]
    assert rules.turn[1, 0] == rules.turns[1, 0], "no angle at all"
    assert rules.turns[1, 1] - rules.turn[1, 1] == 1


def test_kinds_items_and_bins_keep_their_order() -> None:
    one = scene(
        [kind(ell(30.0, 10.0)), kind(frame(20.0, 10.0))], [Item(1, 1), Item(0, 1, fixed=True), Item(1, 0)]
    )  # fmt: skip
    items, shapes = one.given.items, one.given.shapes
    assert (items.kind.tolist(), items.other.tolist()) == ([1, 0, 1], [1, 1, 0])
    assert items.fixed.tolist() == [False, True, False]
    assert np.diff(shapes.first).tolist() == [8, 8], "a copy may be both"
    assert np.diff(shapes.tip).tolist() == [6, 4]
    assert shapes.size.tolist() == [30.0, 20.0]
    hulls = [30.0 * 30.0 - 20.0 * 20.0 / 2.0, 400.0]
    assert_near(shapes.weight, np.sqrt(hulls), bound=1e-12, why="the root of the area of the hull")
    assert np.diff(one.layout.first).tolist() == [8, 8, 8]


def test_a_copy_that_may_be_turned_over_has_as_many_edges_and_discs_in_both_its_kinds() -> None:
    kinds = (kind(ell(30.0, 10.0).convex_hull), kind(ell(30.0, 10.0)), kind(oblong(3.0, 1.0)))
    shapes = arrays(Problem(kinds, (Item(0, 1), Item(2, 2)), ((9.0, 9.0),))).shapes
    assert np.diff(shapes.first).tolist() == [6, 6, 4], "a hull has 5"
    assert np.diff(shapes.pole)[0] == np.diff(shapes.pole)[1]
    edges = shapes.edges[: shapes.first[1]]
    lengths = np.hypot(edges[:, 2] - edges[:, 0], edges[:, 3] - edges[:, 1])
    assert (lengths == 0.0).sum() == 1
    assert_near(float(lengths.sum()), kinds[0].shape.length, bound=10.0 * HAIR_MM, why="the hair, around")


REGION = MultiPolygon([Polygon(box(0, 0, 100, 60).exterior, [box(30, 20, 50, 40).exterior]), box(120, 10, 150, 50)])


def test_the_field_is_the_distance_to_the_edge_positive_inside() -> None:
    regions = scene([kind(oblong(1.0, 1.0), regions=(0,))], bins=((150.0, 60.0),), regions=(REGION,)).given.regions
    rows, columns = regions.shape[0]
    field = regions.field[: rows * columns].reshape(rows, columns)
    for i in range(0, rows, 17):
        for j in range(0, columns, 13):
            point = Point(regions.origin[0, 0] + j * regions.cell[0], regions.origin[0, 1] + i * regions.cell[0])
            away = REGION.boundary.distance(point) * (1.0 if REGION.contains(point) else -1.0)
            assert_near(float(field[i, j]), away, bound=1e-11, why="the same distance")


def test_every_ring_of_a_region_has_a_point() -> None:
    regions = scene([kind(oblong(1.0, 1.0), regions=(0,))], regions=(REGION, box(0, 0, 1, 1))).given.regions
    assert regions.point.tolist() == [0, 3, 4]
    rings = [REGION.geoms[0].exterior, REGION.geoms[0].interiors[0], REGION.geoms[1].exterior]
    assert all(ring.distance(Point(at)) == 0.0 for ring, at in zip(rings, regions.points[:3], strict=True))


def test_the_polygons_of_an_area_are_listed_without_empty_ones() -> None:
    assert polygons(Polygon()) == []
    assert polygons(REGION) == list(REGION.geoms)
    assert polygons(island := box(0, 0, 1, 1)) == [island]
