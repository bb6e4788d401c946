"""Whether shapes overlap, and how deep: shapely's answer on random figures, and the cases on the border of it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import Point, Polygon

from stages.geometry.arrays import EPS
from stages.nest.separation.laying import overlap
from stages.nest.separation.problem import HAIR_MM, edges_of
from stages.nest.separation.touching import depth, discs_overlap, edges_cross, edges_near, is_inside
from tests.near import assert_near
from tests.stages.nest.separation.scenes import (
    angles,
    ell,
    figures,
    frame,
    kind,
    laid,
    moved,
    oblong,
    posed,
    put,
    scene,
    shares,
)

ROUNDING = 64 * EPS
"""Of a coordinate: it is turned, moved and compared."""


def badness(one: Polygon, other: Polygon, x: float, y: float, angle: float = 0.0, *, base: float = 0.0) -> float:
    """How badly `other`, turned and moved by (x, y), overlaps `one`, both moved by `base` along both axes."""
    on = scene([kind(one), kind(other)])
    put(on, 0, base, base)
    return float(overlap(on.given.shapes, on.layout, 0, posed(on, 1, angle), 1, base + x, base + y))


@given(figures(), angles(), shares(), shares())
@settings(max_examples=100, deadline=None)
def test_a_point_is_inside_where_shapely_says_so(shape: Polygon, angle: float, x: float, y: float) -> None:
    there = moved(shape, 0.0, 0.0, angle)
    size = shape.length
    point = Point(x * size / 4.0, y * size / 4.0)
    edges = edges_of(there)
    if there.boundary.distance(point) > ROUNDING * size:
        assert is_inside(edges, 0, len(edges), point.x, point.y) == there.contains(point)


@given(figures(), figures(), angles(), angles(), st.tuples(shares(), shares()))
@settings(max_examples=100, deadline=None)
def test_figures_overlap_where_shapely_says_so(
    one: Polygon, other: Polygon, turn: float, angle: float, away: tuple[float, float]
) -> None:
    on = scene([kind(one), kind(other)])
    reach = (one.length + other.length) / 4.0
    put(on, 0, -3.0 * reach, reach, turn)
    put(on, 1, (away[0] - 3.0) * reach, (away[1] + 1.0) * reach, angle)
    found = float(
        overlap(
            on.given.shapes, on.layout, 0, posed(on, 1, angle), 1, float(on.layout.x[1]), float(on.layout.y[1])
        )
    )  # fmt: skip
    a, b = laid(on, 0), laid(on, 1)
    shared = float(a.intersection(b).area)
    if shared > ROUNDING * reach * reach:
        assert found > 0.0
    if a.distance(b) > ROUNDING * reach:
        assert found == 0.0


@given(figures((30.0, 1000.0)), angles(), angles(), shares(), shares())
@settings(max_examples=50, deadline=None)
def test_it_does_not_matter_which_of_two_shapes_lies(
    shape: Polygon, turn: float, angle: float, x: float, y: float
) -> None:
    other, size = ell(50.0, 10.0), 100.0
    on = scene([kind(shape), kind(other)])
    put(on, 0, 0.0, 0.0, turn)
    put(on, 1, x * size, y * size, angle)
    there = overlap(on.given.shapes, on.layout, 0, posed(on, 1, angle), 1, x * size, y * size)
    back = overlap(on.given.shapes, on.layout, 1, posed(on, 0, turn), 0, 0.0, 0.0)
    assert_near(float(there), float(back), bound=1e-9 * size, why="the same sum in another order")


@pytest.mark.parametrize("base", [0.0, 9_999.3, 1e5 / 3.0])
@pytest.mark.parametrize("angle", [0.0, 90.0, 180.0, 270.0])
def test_rectangles_side_by_side_touch_and_do_not_overlap(base: float, angle: float) -> None:
    one, square = oblong(100.0, 50.0), oblong(50.0, 50.0)
    assert badness(one, square, 75.0, 0.0, angle, base=base) == 0.0
    assert badness(one, square, 0.0, 50.0, angle, base=base) == 0.0
    assert badness(one, square, 75.0, 50.0, angle, base=base) == 0.0, "corner at corner"


@pytest.mark.parametrize("base", [0.0, 9_999.3, 1e5 / 3.0])
@pytest.mark.parametrize("angle", [0.0, 90.0, 180.0, 270.0])
def test_rectangles_that_reach_a_little_into_each_other_overlap(base: float, angle: float) -> None:
    one, square, little = oblong(100.0, 50.0), oblong(50.0, 50.0), 4.0 * HAIR_MM
    assert badness(one, square, 75.0 - little, 0.0, angle, base=base) > 0.0
    assert badness(one, square, 0.0, 50.0 - little, angle, base=base) > 0.0
    assert badness(one, square, 75.0 - little, 50.0 - little, angle, base=base) > 0.0


@pytest.mark.parametrize("base", [0.0, 9_999.3, 1e5 / 3.0])
@pytest.mark.parametrize("shift", [0.0, 10.0, 49.0, 99.0])
def test_rectangles_between_the_same_two_lines_overlap_although_their_long_edges_only_run_along(
    base: float, shift: float
) -> None:
    one = oblong(100.0, 50.0)
    assert badness(one, one, shift, 0.0, base=base) > 0.0
    assert badness(one, one, -shift, 0.0, 180.0, base=base) > 0.0
    assert badness(one, one, 0.0, shift / 2.0, base=base) > 0.0


def test_a_shape_upon_itself_overlaps() -> None:
    for shape in (oblong(30.0, 10.0), ell(30.0, 1.0), frame(30.0, 29.0)):
        assert badness(shape, shape, 0.0, 0.0) > 0.0


def test_a_cross_of_two_thin_bars_overlaps_though_neither_holds_a_corner_of_the_other() -> None:
    assert badness(oblong(100.0, 1.0), oblong(1.0, 100.0), 40.0, 3.0) > 0.0


def test_a_part_in_a_hole_does_not_overlap_and_one_that_covers_the_hole_does() -> None:
    ring = frame(100.0, 60.0)
    assert badness(ring, oblong(60.0, 60.0), 0.0, 0.0) == 0.0, "it fits exactly"
    assert badness(oblong(60.0, 60.0), ring, 0.0, 0.0) == 0.0
    assert badness(ring, oblong(50.0, 50.0), 5.0, -5.0) == 0.0
    assert badness(ring, oblong(61.0, 61.0), 0.0, 0.0) > 0.0
    assert badness(ring, oblong(90.0, 90.0), 0.0, 0.0) > 0.0, "it covers the hole, and no edges cross"
    assert badness(oblong(90.0, 90.0), ring, 0.0, 0.0) > 0.0
    assert badness(ring, oblong(200.0, 200.0), 0.0, 0.0) > 0.0
    assert badness(ring, oblong(10.0, 10.0), 40.0, 0.0) > 0.0, "it lies in the material"


def test_rings_lie_within_one_another_and_over_one_another() -> None:
    large, middle, small = frame(100.0, 80.0), frame(80.0, 40.0), frame(40.0, 10.0)
    assert badness(large, middle, 0.0, 0.0) == 0.0
    assert badness(large, small, 10.0, -10.0) == 0.0
    assert badness(middle, small, 0.0, 0.0) == 0.0
    assert badness(large, frame(90.0, 10.0), 0.0, 0.0) > 0.0
    assert badness(frame(90.0, 88.0), frame(95.0, 60.0), 0.0, 0.0) > 0.0, "one ring within the material of the other"


def test_hooks_that_interlock_exactly_do_not_overlap() -> None:
    hook = ell(30.0, 10.0)
    assert badness(hook, hook, 10.0, 10.0) == 0.0
    assert badness(hook, hook, 10.0 - 1e-6, 10.0) > 0.0
    assert badness(hook, oblong(20.0, 20.0), 5.0, 5.0) == 0.0


def test_only_edges_whose_box_meets_the_clip_are_near() -> None:
    edges, found = edges_of(oblong(10.0, 10.0)), np.zeros((4, 4))
    assert edges_near(edges, 0, 4, (4.0, -1.0, 9.0, 1.0), found) == 1
    assert found[:, 0].tolist() in ([5.0, -5.0, 5.0, 5.0], [5.0, 5.0, 5.0, -5.0])
    assert edges_near(edges, 0, 4, (-9.0, -9.0, 9.0, 9.0), found) == 4
    assert edges_near(edges, 0, 4, (5.0, 5.0, 9.0, 9.0), found) == 2, "those that only touch it too"
    assert edges_near(edges, 0, 4, (-4.0, -4.0, 4.0, 4.0), found) == 0
    assert edges_near(edges, 1, 3, (-9.0, -9.0, 9.0, 9.0), found) == 2, "of the range alone"


CROSSINGS = {
    "cross": ((0.0, 0.0, 4.0, 4.0), (0.0, 4.0, 4.0, 0.0), True),
    "end on the other": ((0.0, 0.0, 4.0, 0.0), (2.0, 0.0, 2.0, 3.0), True),
    "end at end": ((0.0, 0.0, 4.0, 0.0), (4.0, 0.0, 7.0, 3.0), True),
    "along": ((0.0, 0.0, 4.0, 0.0), (3.0, 0.0, 7.0, 0.0), True),
    "along, the other way": ((4.0, 1.0, 0.0, 0.0), (3.0, 0.75, -1.0, -0.25), True),
    "on one line, apart": ((0.0, 0.0, 4.0, 0.0), (5.0, 0.0, 7.0, 0.0), False),
    "parallel": ((0.0, 0.0, 4.0, 0.0), (0.0, 1.0, 4.0, 1.0), False),
    "past the end": ((0.0, 0.0, 4.0, 0.0), (5.0, -1.0, 5.0, 1.0), False),
}


@pytest.mark.parametrize("name", CROSSINGS)
@pytest.mark.parametrize("moved_by", [(0.0, 0.0), (1000.0, -512.0)])
def test_two_edges_cross_touch_or_are_apart(name: str, moved_by: tuple[float, float]) -> None:
    first, second, wanted = CROSSINGS[name]
    dx, dy = moved_by
    one = np.array([first]) + np.array([dx, dy, dx, dy])
    other, near = np.array([second]), np.zeros((4, 1))
    clip = (-9999.0, -9999.0, 9999.0, 9999.0)
    assert edges_cross(one, 0, 1, other, 0, 1, dx, dy, clip, near) == wanted
    back = np.array([second]) + np.array([dx, dy, dx, dy])
    assert edges_cross(back, 0, 1, np.array([first]), 0, 1, dx, dy, clip, near) == wanted


def test_discs_overlap_only_if_they_reach_into_each_other() -> None:
    one, other = np.array([[0.0, 10.0], [0.0, 0.0], [2.0, 1.0]]), np.array([[0.0], [0.0], [3.0]])
    assert not discs_overlap(one, 0, 2, other, 0, 1, 0.0, 5.0)
    assert discs_overlap(one, 0, 2, other, 0, 1, 0.0, 4.9)
    assert discs_overlap(one, 0, 2, other, 0, 1, 10.0, 3.9), "the second one"
    assert not discs_overlap(one, 0, 1, other, 0, 1, 10.0, 3.9), "the first one alone"


def test_the_depth_of_two_discs_is_how_far_they_reach_into_each_other_times_the_smaller_radius() -> None:
    one, other = np.array([[1.0], [2.0], [5.0]]), np.array([[0.0], [0.0], [3.0]])
    found = depth(one, 0, 1, other, 0, 1, 7.0, 2.0, 0.1)
    assert_near(float(found), (5.0 + 3.0 - 6.0) * 3.0, bound=1e-12, why="closed form")
    apart = depth(one, 0, 1, other, 0, 1, 101.0, 2.0, 0.1)
    assert_near(float(apart), 3.0 * 0.1**2 / (0.2 + 92.0), bound=1e-15, why="closed form, apart by 92")


def test_the_depth_has_no_jump_where_it_turns_from_a_line_to_a_tail() -> None:
    one, eps = np.array([[0.0], [0.0], [5.0]]), 0.1
    below, above = (float(depth(one, 0, 1, one, 0, 1, 10.0 - eps + by, 0.0, eps)) for by in (1e-9, -1e-9))
    assert_near(below, above, bound=2e-9 * 5.0 * 1.01, why="slope 1 times the radius on both sides")


DISCS = st.lists(st.tuples(st.floats(-1.0, 0.0), st.floats(-1.0, 1.0), st.floats(0.01, 1.0)), min_size=1, max_size=5)


@given(DISCS, DISCS, st.floats(0.0, 3.0), st.floats(1e-3, 1.0))
@settings(max_examples=100, deadline=None)
def test_the_depth_is_positive_and_falls_on_the_way_apart(
    left: list[tuple[float, float, float]], right: list[tuple[float, float, float]], way: float, step: float
) -> None:
    one, other = np.array(left).T.copy(), (np.array(right) * np.array([-1.0, 1.0, 1.0])).T.copy()
    near, far = (float(depth(one, 0, len(left), other, 0, len(right), x, 0.0, 0.01)) for x in (way, way + step))
    assert 0.0 < far < near, "every disc of the right one lies to the right of every one of the left"
