"""Curves as seen along the normal of a plane: what is straight or round there stays so exactly."""

import numpy as np
import pytest

from stages.construct.curves import even
from stages.construct.plain import Projected, plane_edges
from stages.geometry.arrays import EPS
from stages.geometry.curves.curves import Circular, bezier, exactly
from stages.geometry.curves.plane import CircularArc, Segment
from tests.near import assert_near

ORIGIN = np.array([5.0, -7.0, 30.0])
UPRIGHT = np.eye(3)[:2]


def turning(u: list[float], v: list[float], w: list[float]) -> Circular:
    return Circular(np.array([1.0, 2.0, 3.0]), np.array(u), np.array(v), np.array(w), 0.4, -2.0)


CURVES = {
    "a line": (bezier([exactly(one) for one in ([0.0, 0.0, 0.0], [3.0, 4.0, 9.0])]), Segment),
    "a circle": (turning([10.0, 0.0, 0.0], [0.0, 10.0, 0.0], [0.0, 0.0, 0.0]), CircularArc),
    "a circle run the other way": (turning([0.0, 10.0, 0.0], [10.0, 0.0, 0.0], [0.0, 0.0, 0.0]), CircularArc),
    "an ellipse": (turning([10.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 0.0]), Projected),
    "axes at an angle": (turning([10.0, 0.0, 0.0], [6.0, 8.0, 0.0], [0.0, 0.0, 0.0]), Projected),
    "a helix that leans": (turning([10.0, 0.0, 0.0], [0.0, 10.0, 0.0], [2.0, 0.0, 1.0]), Projected),
}


@pytest.mark.parametrize("name", CURVES)
def test_a_curve_in_a_plane_is_of_its_sort_and_runs_as_it_did(name: str) -> None:
    curve, sort = CURVES[name]
    (edge,) = plane_edges(even([curve]), ORIGIN, UPRIGHT)
    assert type(edge) is sort
    t = np.linspace(0.0, 1.0, 9)
    assert_near(edge.at(t), (curve.jet(t, 0)[0] - ORIGIN)[:, :2], bound=16 * EPS * 20.0, why="the same points")
