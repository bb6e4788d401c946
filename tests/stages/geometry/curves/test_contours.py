"""Area and length of closed contours: closed forms, also far from the origin and through it."""

from math import pi

import numpy as np
import pytest

from stages.geometry.arrays import EPS
from stages.geometry.curves.contours import area, area_and_centroid, from_positions, length
from stages.geometry.curves.plane import CircularArc, PlaneCurve, Segment
from stages.geometry.flat.development import develop
from stages.geometry.flat.flatmap import DevelopedEdge
from tests.near import assert_near, assert_relative
from tests.parts import RIGHT_FRUSTUM, patches


def polygon(*corners: tuple[float, float]) -> list[PlaneCurve]:
    points = np.array(corners)
    return [Segment(a, b) for a, b in zip(points, np.roll(points, -1, axis=0), strict=True)]


@pytest.mark.parametrize("shift", [0.0, 1.0, 1e6])
def test_a_polygon_has_the_area_of_the_shoelace_formula(shift: float) -> None:
    edges = polygon(*((x + shift, y + shift) for x, y in ((0.0, 0.0), (4.0, 1.0), (3.0, 5.0))))
    assert_near(area(edges), 8.5, bound=64 * EPS * max(8.5, 6.0 * shift), why="corners rounded where they are")
    assert_near(length(edges), 17**0.5 * 2 + 34**0.5, bound=64 * EPS * max(14.0, shift), why="corners rounded")


@pytest.mark.parametrize("slope", [1.0 / 3.0, 0.7, 1.1])
def test_an_edge_that_points_at_the_origin_has_an_area_of_zero_and_no_trouble(slope: float) -> None:
    edges = polygon((0.1, 0.1 * slope), (0.7, 0.7 * slope), (0.2, 5.0))
    assert area(edges) > 0.0
    assert area(edges[::-1]) > 0.0


def test_the_sense_of_a_contour_is_the_sign_of_its_area() -> None:
    disc: list[PlaneCurve] = [CircularArc(np.array([1e3, -1e3]), 2.0, 0.3, 2.0 * pi)]
    hole: list[PlaneCurve] = [CircularArc(np.array([1e3, -1e3]), 2.0, 0.3, -2.0 * pi)]
    assert_relative([area(disc), -area(hole)], [4.0 * pi] * 2, bound=64 * EPS * 1e3, why="a centre at 1e3")
    assert_relative([length(disc), length(hole)], [4.0 * pi] * 2, bound=64 * EPS * 1e3, why="a centre at 1e3")
    second = np.array([from_positions(disc), from_positions(hole)])
    assert_near(second, [[4 * pi, 4 * pi], [4 * pi, -4 * pi]], bound=64 * EPS * 1e3, why="the same in closed form")


def test_a_developed_edge_has_the_length_of_its_curve() -> None:
    piece = develop(patches(RIGHT_FRUSTUM)).pieces[0]
    for u, radius in ((0.0, 3.0), (1.0, 1.5)):
        for reverse in (False, True):
            edge = DevelopedEdge(piece, u, reverse)
            both = [length([edge]), from_positions([edge])[0]]
            assert_relative(both, [2.0 * pi * radius] * 2, bound=1e-13, why="closed form")
            ends = edge.at(np.array([0.0, 1.0]))
            assert_near(
                DevelopedEdge(piece, u, not reverse).at(np.array([1.0, 0.0])), ends, bound=0.0, why="same points"
            )


@pytest.mark.parametrize("shift", [0.0, 1e4])
def test_the_centroid_is_that_of_the_area(shift: float) -> None:
    half: list[PlaneCurve] = [CircularArc(np.array([shift, shift]), 3.0, 0.0, pi)]
    half += [Segment(np.array([shift - 3.0, shift]), np.array([shift + 3.0, shift]))]
    expected = [4.5 * pi, shift, shift + 4.0 / pi]
    assert_near(area_and_centroid(half), expected, bound=64 * EPS * (10.0 + shift), why="4 r / (3 pi) above the centre")
    backwards: list[PlaneCurve] = [CircularArc(np.array([shift, shift]), 3.0, pi, -pi)]
    backwards += [Segment(np.array([shift + 3.0, shift]), np.array([shift - 3.0, shift]))]
    found = area_and_centroid(backwards)
    assert_near(found, [-4.5 * pi, *expected[1:]], bound=64 * EPS * (10.0 + shift), why="the same, clockwise")
