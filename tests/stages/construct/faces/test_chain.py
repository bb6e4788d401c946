"""Curves of u and v run the other way: the same points, the opposite derivative."""

import numpy as np

from stages.construct.faces.chain import Turned
from stages.geometry.curves.plane import CircularArc
from tests.near import assert_near

T = np.array([0.0, 0.3, 1.0])


def test_a_curve_run_the_other_way_has_the_same_points_and_the_opposite_derivative() -> None:
    """A quarter of the unit circle, from (1, 0) to (0, 1), at the angle (1 - t) pi / 2."""
    turned = Turned(CircularArc(np.zeros(2), 1.0, 0.0, np.pi / 2.0))
    angle = (1.0 - T) * np.pi / 2.0
    x, y = np.cos(angle), np.sin(angle)
    assert_near(turned.at(T), np.column_stack([x, y]), bound=1e-15, why="closed form")
    assert_near(turned.derivative(T), np.pi / 2.0 * np.column_stack([y, -x]), bound=1e-15, why="d/dt of it")
