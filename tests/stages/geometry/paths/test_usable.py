"""Outlines of stock from inside, defects from outside: never larger, never smaller than what was drawn."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import Polygon, make_valid, unary_union

from stages.errors import NoSolutionError
from stages.geometry.arrays import Points2, Values
from stages.geometry.curves.plane import CircularArc, PlaneCurve, Segment
from stages.geometry.paths.arcpath import ArcPath, area, polygon
from stages.geometry.paths.usable import NoAreaError, holds, inside, outside, touch, within
from tests.near import assert_near

ACCURACY = 0.1
DENSE = 1000


class Blob:
    """A closed smooth curve: a circle with a wave on it, which is no chain of arcs."""

    def __init__(self, radius: float, waves: int, height: float) -> None:
        self.radius, self.waves, self.height = radius, waves, height

    def at(self, t: Values) -> Points2:
        angle = 2.0 * np.pi * t
        r = self.radius + self.height * np.cos(self.waves * angle)
        points: Points2 = r[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        return points

    def derivative(self, t: Values) -> Points2:
        angle = 2.0 * np.pi * t
        r = self.radius + self.height * np.cos(self.waves * angle)
        slope = -self.waves * self.height * np.sin(self.waves * angle)
        c, s = np.cos(angle), np.sin(angle)
        found: Points2 = 2.0 * np.pi * np.stack([slope * c - r * s, slope * s + r * c], axis=1)
        return found


def ring(*corners: tuple[float, float]) -> list[PlaneCurve]:
    points = [np.array(corner, dtype=np.float64) for corner in corners]
    return [Segment(a, b) for a, b in zip(points, [*points[1:], points[0]], strict=True)]


def dense(edges: list[PlaneCurve], count: int = DENSE + 1) -> Polygon:
    return Polygon(np.concatenate([edge.at(np.linspace(0.0, 1.0, count)) for edge in edges]))


def shape(path: ArcPath) -> Polygon:
    return Polygon(polygon(path, accuracy=1e-4))


SQUARE = ring((0, 0), (100, 0), (100, 100), (0, 100))
DISC: list[PlaneCurve] = [CircularArc(np.array([3.0, 4.0]), 20.0, 0.0, 2.0 * np.pi)]
BOW_TIE = ring((0, 0), (100, 100), (100, 0), (0, 60))
FIGURE_8 = ring((0, 0), (50, 50), (100, 0), (100, 90), (50, 50), (0, 80))
TWICE = ring((0, 0), (100, 0), (100, 100), (0, 100), (0, 0), (50, 10), (50, 50), (10, 50))
SPIKE = ring((0, 0), (100, 0), (100, 50), (150, 50), (100, 50), (100, 100), (0, 100))


def test_lines_and_arcs_stay_as_they_are() -> None:
    for edges, wanted in ((SQUARE, 1e4), (DISC, 400.0 * np.pi)):
        kept, blocked = inside(edges, accuracy=ACCURACY), outside(edges, accuracy=ACCURACY)
        assert (kept.crossing, kept.drawn, kept.left_out_mm2, kept.holes) == (False, False, (), ())
        assert_near([area(kept.path), area(blocked.paths[0])], [wanted] * 2, bound=1e-10, why="closed form")
        assert not (blocked.crossing or blocked.drawn)


def test_the_sense_of_a_contour_means_nothing() -> None:
    clockwise = ring((0, 0), (0, 100), (100, 100), (100, 0))
    assert area(inside(clockwise, accuracy=ACCURACY).path) == 1e4
    assert area(outside(clockwise, accuracy=ACCURACY).paths[0]) == 1e4


@settings(max_examples=8, deadline=None)
@given(st.floats(50.0, 500.0), st.integers(2, 7), st.floats(0.0, 0.1))
def test_a_curved_outline_shrinks_and_a_curved_defect_grows_within_the_accuracy(
    radius: float, waves: int, share: float
) -> None:
    blob: list[PlaneCurve] = [Blob(radius, waves, share * radius)]
    true = dense(blob)
    kept, blocked = inside(blob, accuracy=ACCURACY), outside(blob, accuracy=ACCURACY)
    # chords of the dense polygon: s^2 k / 8 with s the step and k below 10 / radius
    slack = (2.0 * np.pi * radius / DENSE) ** 2 * 10.0 / radius / 8.0
    if share > 1e-6:
        assert kept.drawn and blocked.drawn
    assert true.buffer(slack).covers(shape(kept.path))
    assert Polygon(polygon(kept.path, accuracy=1e-3)).buffer(ACCURACY + slack).covers(true)
    assert shape(blocked.paths[0]).buffer(slack).covers(true)
    assert true.buffer(ACCURACY + slack).covers(shape(blocked.paths[0]))


def test_of_a_bow_tie_an_outline_keeps_the_larger_wing_and_a_defect_covers_both() -> None:
    kept, blocked = inside(BOW_TIE, accuracy=ACCURACY), outside(BOW_TIE, accuracy=ACCURACY)
    # its sides y = x and y = 60 - 0.6 x cross
    crossing = 60.0 / 1.6
    small, large = 60.0 * crossing / 2.0, 100.0 * (100.0 - crossing) / 2.0
    assert kept.crossing and blocked.crossing
    assert_near(area(kept.path), large, bound=1e-9, why="a triangle")
    assert_near(kept.left_out_mm2, [small], bound=1e-9, why="the other triangle")
    assert_near(sorted(area(path) for path in blocked.paths), [small, large], bound=1e-9, why="both")


def test_an_outline_that_touches_itself_keeps_its_largest_piece_and_says_what_is_lost() -> None:
    kept = inside(FIGURE_8, accuracy=ACCURACY)
    assert kept.crossing
    assert_near([area(kept.path), *kept.left_out_mm2], [2250.0, 2000.0], bound=1e-9, why="two triangles")


def test_what_an_outline_goes_round_twice_is_not_used_and_a_defect_covers_it() -> None:
    kept, blocked = inside(TWICE, accuracy=ACCURACY), outside(TWICE, accuracy=ACCURACY)
    usable = area(kept.path) - sum(area(hole) for hole in kept.holes)
    inner = abs(area(ArcPath(np.array([[0.0, 0], [50, 10], [50, 50], [10, 50]]), np.zeros(4), True)))
    assert_near(usable, 1e4 - inner, bound=1e-9, why="the inner loop is gone round twice")
    assert_near(sum(area(path) for path in blocked.paths), 1e4, bound=1e-9, why="all that it encloses")


def test_a_spike_of_no_area_is_left_out() -> None:
    for found in (inside(SPIKE, accuracy=ACCURACY).path, *outside(SPIKE, accuracy=ACCURACY).paths):
        assert_near(area(found), 1e4, bound=1e-9, why="the square without its spike")


@pytest.mark.parametrize(
    "edges", [ring((0, 0), (100, 0)), ring((0, 0), (100, 0), (50, 0)), ring((0, 0), (100, 0), (100, 100), (100, 0))]
)
def test_what_encloses_nothing_is_refused(edges: list[PlaneCurve]) -> None:
    for make in (inside, outside):
        with pytest.raises(NoAreaError):
            make(edges, accuracy=ACCURACY)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.integers(0, 12), st.integers(0, 12)), min_size=3, max_size=9))
def test_however_a_contour_crosses_itself_nothing_is_gained(corners: list[tuple[int, int]]) -> None:
    """On a coarse grid, where points, edges and whole stretches coincide."""
    edges = ring(*((10.0 * x, 10.0 * y) for x, y in corners))
    drawn = Polygon([(10.0 * x, 10.0 * y) for x, y in corners])
    try:
        kept, blocked = inside(edges, accuracy=ACCURACY), outside(edges, accuracy=ACCURACY)
    except (NoAreaError, NoSolutionError):
        assert make_valid(drawn).area < ROUNDING
        return
    covered = unary_union([shape(path) for path in blocked.paths])
    usable = shape(kept.path).difference(unary_union([shape(path) for path in kept.holes]))
    assert usable.area - usable.intersection(covered).area < ROUNDING
    assert usable.difference(make_valid(drawn)).area < ROUNDING
    assert make_valid(drawn).difference(covered).area < ROUNDING


ROUNDING = 1e-6
"""mm2, of contours of 120 mm with crossings that are computed."""


def test_contours_touch_lie_within_one_another_or_hold_a_point() -> None:
    square, disc = inside(SQUARE, accuracy=ACCURACY).path, inside(DISC, accuracy=ACCURACY).path
    small, far = (inside(ring(*corners), accuracy=ACCURACY).path for corners in (
        ((40, 40), (60, 40), (60, 60)), ((200, 0), (210, 0), (210, 10)),
    ))  # fmt: skip
    assert [touch(square, other, accuracy=ACCURACY) for other in (disc, small, far)] == [True, True, False]
    assert [within(other, square, accuracy=ACCURACY) for other in (disc, small, far)] == [False, True, False]
    edge = inside(ring((0, 40), (20, 40), (20, 60)), accuracy=ACCURACY).path
    assert not within(edge, square, accuracy=ACCURACY), "it touches the edge in a point"
    assert holds(square, np.array([50.0, 50.0]), accuracy=ACCURACY)
    assert not holds(square, np.array([150.0, 50.0]), accuracy=ACCURACY)
