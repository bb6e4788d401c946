"""Chords on exact edges: as many as the closed form says, within the accuracy, corners kept."""

from math import acos, ceil, pi

import numpy as np
import pytest

from stages.errors import NoSolutionError
from stages.geometry.curves.plane import CircularArc, Segment
from stages.geometry.flat.sampling import resolved
from stages.geometry.paths.arcpath import area
from stages.geometry.paths.hausdorff import hausdorff
from stages.geometry.paths.inscribed import CHORD_SHARE, STEPS, chorded, inscribed
from tests.near import assert_near
from tests.stages.geometry.plane_curves import Formula
from tests.stages.write.patterns import polygon_edges

TAU = 2.0 * pi
ELLIPSE = Formula(
    lambda t: 25.0 * np.exp(1j * TAU * t) + 15.0 * np.exp(-1j * TAU * t),
    lambda t: TAU * 1j * (25.0 * np.exp(1j * TAU * t) - 15.0 * np.exp(-1j * TAU * t)),
)
"""Half-axes of 40 and 10 mm."""


@pytest.mark.parametrize("accuracy", [0.1, 0.02])
@pytest.mark.parametrize("radius", [5.0, 80.0])
def test_a_circle_takes_as_many_chords_as_its_height_asks(radius: float, accuracy: float) -> None:
    edge = CircularArc(np.array([3.0, -2.0]), radius, 0.4, TAU)
    path = inscribed([edge], accuracy=accuracy)
    fewest, kept = (ceil(TAU / (2.0 * acos(1.0 - share * accuracy / radius))) for share in (1.0, CHORD_SHARE))
    # a chord ends on a point: it may fall short by one step
    assert fewest <= path.bulges.size <= ceil(kept * (1.0 + 1.0 / (STEPS - 1)))
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


@pytest.mark.parametrize("radius", [4.0, 20.0, 33.0, 50.0, 81.0, 300.0])
def test_no_short_chord_is_left_over(radius: float) -> None:
    path = inscribed([CircularArc(np.zeros(2), radius, 0.0, TAU)], accuracy=0.02)
    steps = np.hypot(*(np.roll(path.vertices, -1, axis=0) - path.vertices).T)
    # what is left over is spread over all, each ends on a point
    assert steps.min() > (1.0 - 2.0 / STEPS) * (1.0 - 1.0 / path.bulges.size) * steps.max()


def test_chords_follow_the_bend_of_an_edge() -> None:
    """On an ellipse of 40 x 10 they are longest where it is flattest, and each is about as high as allowed."""
    path = inscribed([ELLIPSE], accuracy=0.02)
    steps = np.hypot(*(np.roll(path.vertices, -1, axis=0) - path.vertices).T)
    assert steps.max() > 3.0 * steps.min()
    middles = resolved(ELLIPSE, accuracy=1e-5)
    assert 0.8 * 0.02 < hausdorff([middles], path, accuracy=0.02).value_mm <= CHORD_SHARE * 0.02 * (1.0 + 1.0 / STEPS)


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
