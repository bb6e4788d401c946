"""The pieces of a path as edges: they run along the path, and give back its length and area."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.arrays import EPS
from stages.geometry.curves import contours
from stages.geometry.curves.plane import Segment
from stages.geometry.paths import arcpath
from stages.geometry.paths.arcpath import ArcPath
from stages.geometry.paths.edges import PathPiece, edges_of
from tests.near import assert_near, assert_relative

CORNERS = np.array([[0.0, 0.0], [40.0, 0.0], [40.0, 30.0], [0.0, 30.0]])
SQUARE_OF_ARCS = ArcPath(CORNERS, np.array([0.0, 0.3, -0.2, 1.0]), closed=True)
T = np.linspace(0.0, 1.0, 9)


@given(st.lists(st.floats(-1.0, 1.0), min_size=4, max_size=4))
@settings(max_examples=40, deadline=None)
def test_length_and_area_are_those_of_the_path(bulges: list[float]) -> None:
    path = ArcPath(CORNERS, np.array(bulges), closed=True)
    edges = edges_of(path)
    assert_relative(contours.length(edges), arcpath.length(path), bound=1e-12, why="a quadrature of constants")
    assert_near(contours.area(edges), arcpath.area(path), bound=1e-12 * 5000.0, why="a quadrature, of the scale")


def test_straight_pieces_are_segments_and_the_others_keep_their_bulge() -> None:
    edges = edges_of(SQUARE_OF_ARCS)
    assert [type(edge) for edge in edges] == [Segment, PathPiece, PathPiece, PathPiece]
    ends = [edge.at(np.array([0.0, 1.0])) for edge in edges]
    assert_near([end[0] for end in ends], CORNERS, bound=0.0, why="pieces begin in the vertices")
    assert_near([end[1] for end in ends], np.roll(CORNERS, -1, axis=0), bound=64 * EPS * 40.0, why="one product")


@pytest.mark.parametrize("bulge", [1.0, -1.0, 0.4, 1e-6])
def test_an_arc_runs_on_its_circle_with_the_derivative_of_its_points(bulge: float) -> None:
    (arc,) = edges_of(ArcPath(CORNERS[:2], np.array([bulge, 0.0]), closed=False))
    step = 1e-4
    middle = T[1:-1]
    slope = (arc.at(middle + step) - arc.at(middle - step)) / (2.0 * step)
    # the third derivative is at most length x sweep^2 <= 40 pi / 2 x pi^2 < 700
    assert_near(arc.derivative(middle), slope, bound=700.0 * step**2 / 6.0 + 1e-9, why="a central difference")
    half = 40.0 / 2.0
    radius = half * (1.0 / abs(bulge) + abs(bulge)) / 2.0
    centre = np.array([half, np.sign(bulge) * half * (1.0 / abs(bulge) - abs(bulge)) / 2.0])
    from_centre = np.hypot(*(arc.at(T) - centre).T)
    assert_relative(from_centre, np.full(T.size, radius), bound=1e-14, why="rounding")


def test_an_open_path_has_one_edge_less() -> None:
    assert len(edges_of(ArcPath(CORNERS, np.zeros(4), closed=False))) == 3
