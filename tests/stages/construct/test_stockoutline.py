"""Closed curves of a job file as edges in the plane of a sheet."""

import numpy as np
import pytest

from pipeline.decode import Walk, decode
from stages.construct.stockoutline import NoContourError, closed_edges
from stages.geometry.curves import contours
from stages.geometry.curves.plane import CircularArc, Segment
from stages.model.curves import CurveSpec
from tests.near import assert_near

JOIN_MM = 0.01


def curve(**keys: object) -> CurveSpec:
    found = decode(Walk(), CurveSpec, keys)
    assert found is not None
    return found


def test_lines_and_arcs_become_lines_and_arcs_in_x_and_y() -> None:
    triangle = closed_edges(curve(polyline=[[0, 0], [4, 0], [0, 3], [0, 0]]), join_mm=JOIN_MM)
    assert [type(edge) for edge in triangle] == [Segment] * 3
    (circle,) = closed_edges(curve(circle={"center": [1, 2], "radius": 5}), join_mm=JOIN_MM)
    assert isinstance(circle, CircularArc)
    assert_near([contours.area(triangle), contours.area([circle])], [6.0, 25.0 * np.pi], bound=1e-13, why="closed form")


def test_a_small_gap_is_closed_by_a_straight_edge_and_a_larger_one_is_told() -> None:
    nearly = closed_edges(curve(polyline=[[0, 0], [4, 0], [0, 3], [0, 0.009]]), join_mm=JOIN_MM)
    assert len(nearly) == 4
    for before, after in zip(nearly, [*nearly[1:], nearly[0]], strict=True):
        assert np.array_equal(before.at(np.array([1.0])), after.at(np.array([0.0])))
    with pytest.raises(NoContourError, match=r"0\.02 mm are missing"):
        closed_edges(curve(polyline=[[0, 0], [4, 0], [0, 3], [0, 0.02]]), join_mm=JOIN_MM)


def test_the_plane_may_lie_at_any_height_but_not_askew() -> None:
    high = curve(polyline=[[0, 0, 7], [4, 0, 7], [0, 3, 7], [0, 0, 7]])
    assert_near(contours.area(closed_edges(high, join_mm=JOIN_MM)), 6.0, bound=1e-13, why="a triangle")
    with pytest.raises(NoContourError, match="leaves the plane of the sheet by 1 mm"):
        closed_edges(curve(polyline=[[0, 0, 7], [4, 0, 7], [0, 3, 8], [0, 0, 7]]), join_mm=JOIN_MM)


def test_a_chain_of_curves_is_one_contour() -> None:
    halves = [
        {"line": [[0, 0], [4, 0]]},
        {"arc": {"center": [2, 0], "radius": 2, "start": 0, "end": 180}},
    ]
    edges = closed_edges(curve(chain=halves), join_mm=JOIN_MM)
    assert_near(contours.area(edges), 2.0 * np.pi, bound=1e-12, why="half a disc")
