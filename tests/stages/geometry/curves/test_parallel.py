"""Parallels of edges: closed forms of Steiner, arcs and lines as they are, hollows refused, crossings found."""

from dataclasses import dataclass
from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stages.geometry.arrays import EPS, Points2, Values, norm
from stages.geometry.curves import contours
from stages.geometry.curves.parallel import Hollow, Parallel, crossing, normals, parallel
from stages.geometry.curves.plane import CircularArc, Segment
from tests.near import assert_near, assert_relative

T = np.linspace(0.0, 1.0, 33)


@dataclass(frozen=True)
class Ellipse:
    """A whole ellipse, counter-clockwise."""

    a: float = 100.0
    b: float = 50.0

    def at(self, t: Values) -> Points2:
        angle = 2.0 * pi * t
        return np.stack([self.a * np.cos(angle), self.b * np.sin(angle)], axis=1)

    def derivative(self, t: Values) -> Points2:
        angle = 2.0 * pi * t
        return 2.0 * pi * np.stack([-self.a * np.sin(angle), self.b * np.cos(angle)], axis=1)


@given(st.floats(-12.0, 40.0))
def test_the_parallel_of_an_ellipse_has_the_length_and_area_of_steiners_formulas(distance: float) -> None:
    ellipse = Ellipse()
    moved = parallel(ellipse, distance)
    assert not isinstance(moved, Hollow)
    length, area = contours.length([ellipse]), contours.area([ellipse])
    assert_relative([contours.length([moved])], [length + 2.0 * pi * distance], bound=1e-12, why="L + 2 pi d")
    assert_relative([contours.area([moved])], [area + length * distance + pi * distance**2], bound=1e-12, why="Steiner")


def test_the_derivative_is_that_of_the_points() -> None:
    moved = parallel(Ellipse(), 8.0)
    assert isinstance(moved, Parallel)
    inner, step = T[1:-1], 1e-5
    slopes = (moved.at(inner + step) - moved.at(inner - step)) / (2.0 * step)
    # differences of second order: f''' step^2 / 6 with f''' <= 100 (2 pi)^3, and their rounding of 100 EPS / step
    bound = 1e5 * step**2 + 1e3 * EPS / step
    assert_near(moved.derivative(inner), slopes, bound=bound, why="central differences")


def test_a_line_stays_a_line_and_lies_on_the_right() -> None:
    moved = parallel(Segment(np.array([0.0, 0.0]), np.array([10.0, 0.0])), 3.0)
    assert isinstance(moved, Segment)
    assert_near([moved.start, moved.end], [[0.0, -3.0], [10.0, -3.0]], bound=0.0, why="along the axes")


@pytest.mark.parametrize(("sweep", "distance", "radius"), [(1.0, 4.0, 14.0), (-1.0, 4.0, 6.0), (1.0, -4.0, 6.0)])
def test_an_arc_stays_an_arc_about_the_same_centre(sweep: float, distance: float, radius: float) -> None:
    arc = CircularArc(np.array([1.0, 2.0]), 10.0, 0.3, sweep)
    moved = parallel(arc, distance)
    assert isinstance(moved, CircularArc)
    assert moved.radius == radius
    assert_near(moved.at(T), arc.at(T) + distance * normals(arc, T), bound=64 * EPS * 14.0, why="the same points")


@pytest.mark.parametrize("distance", [-25.5, -60.0])
def test_a_hollow_narrower_than_the_distance_is_refused_with_its_place_and_radius(distance: float) -> None:
    found = parallel(Ellipse(), distance)
    assert isinstance(found, Hollow)
    assert_near([abs(found.at[0]), found.at[1]], [100.0, 0.0], bound=1e-9, why="the ends of the longer axis")
    assert_near([found.radius_mm], [25.0], bound=1e-9, why="b^2 / a")


def test_a_hollow_arc_is_refused_from_its_radius_on() -> None:
    arc = CircularArc(np.zeros(2), 10.0, 0.0, -1.0)
    assert isinstance(parallel(arc, 9.999), CircularArc)
    found = parallel(arc, 10.0)
    assert isinstance(found, Hollow) and found.radius_mm == 10.0


def test_a_distance_of_nothing_is_the_edge_itself() -> None:
    ellipse = Ellipse()
    assert parallel(ellipse, 0.0) is ellipse


def test_curves_cross_where_both_are() -> None:
    line = Segment(np.array([-200.0, 10.0]), np.array([200.0, 30.0]))
    met = crossing(line, Ellipse())
    assert met is not None
    here, there = line.at(np.array(met[:1]))[0], Ellipse().at(np.array(met[1:]))[0]
    assert_near(here, there, bound=1e-10, why="Newton's method ends there")
    assert here[0] > 0.0, "of the two crossings the last on the first curve"


def test_curves_that_miss_each_other_do_not_cross() -> None:
    line = Segment(np.array([-200.0, 51.0]), np.array([200.0, 51.0]))
    assert crossing(line, Ellipse()) is None
    assert float(norm(Ellipse().at(T)).max()) <= 100.0 + 1e-12
