"""Chords on exact edges: as many as the closed form says, within the accuracy, corners kept."""

from math import acos, ceil, pi

import numpy as np
import pytest

from stages.errors import NoSolutionError
from stages.geometry.arcpath import area
from stages.geometry.hausdorff import hausdorff
from stages.geometry.inscribed import chorded, inscribed
from stages.geometry.plane import CircularArc, Segment
from stages.geometry.sampling import resolved
from tests.near import assert_near
from tests.stages.write.patterns import polygon_edges

TAU = 2.0 * pi


@pytest.mark.parametrize("accuracy", [0.1, 0.02])
@pytest.mark.parametrize("radius", [5.0, 80.0])
def test_a_circle_takes_as_many_chords_as_its_height_asks(radius: float, accuracy: float) -> None:
    edge = CircularArc(np.array([3.0, -2.0]), radius, 0.4, TAU)
    path = inscribed([edge], accuracy=accuracy)
    fewest = ceil(TAU / (2.0 * acos(1.0 - accuracy / radius)))
    # 5 % of the accuracy is kept back, and corners lie on a grid of points
    assert fewest <= path.bulges.size <= 1.1 * fewest + 1
    found = hausdorff([resolved(edge, accuracy=1e-4)], path, accuracy=accuracy)
    assert 0.8 * accuracy < found.bound_mm <= accuracy
    off = np.hypot(*(path.vertices - [3.0, -2.0]).T) - radius
    assert_near(off, np.zeros(off.size), bound=1e-9 * radius, why="corners are on the edge")


def test_straight_edges_stay_as_they_are() -> None:
    corners = ((0.0, 0.0), (100.0, 0.0), (90.0, 40.0), (0.0, 50.0))
    path = inscribed(polygon_edges(*corners), accuracy=0.02)
    assert_near(path.vertices, np.array(corners), bound=1e-12, why="ends of edges are corners")


def test_a_hole_smaller_than_the_accuracy_still_encloses_something() -> None:
    path = inscribed([CircularArc(np.zeros(2), 0.01, 0.0, -TAU)], accuracy=0.05)
    assert path.bulges.size >= 3
    assert area(path) < 0.0


def test_no_short_chord_is_left_over() -> None:
    path = inscribed([CircularArc(np.zeros(2), 20.0, 0.0, TAU)], accuracy=0.02)
    steps = np.hypot(*(np.roll(path.vertices, -1, axis=0) - path.vertices).T)
    assert steps.min() > 0.5 * steps.max()


def test_an_edge_that_is_a_point_has_no_corner_of_its_own() -> None:
    first, second, third = polygon_edges((0.0, 0.0), (80.0, 0.0), (0.0, 60.0))
    apex = Segment(np.array([0.0, 60.0]), np.array([0.0, 60.0 + 1e-13]))
    path, numbers = chorded([first, second, apex, third], 0.02)
    assert_near(path.vertices, [[0, 0], [80, 0], [0, 60]], bound=1e-12, why="ends of edges")
    assert numbers.tolist() == [0, 1, 3]


def test_edges_that_are_all_points_are_refused() -> None:
    point = Segment(np.zeros(2), np.zeros(2))
    with pytest.raises(NoSolutionError, match="a contour of points"):
        inscribed([point, point], accuracy=0.02)
