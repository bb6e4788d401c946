"""Curves beside a cylinder are pulled back to the closed form."""

from math import pi

import numpy as np

from stages.geometry.curves.curves import Circular
from stages.geometry.ruled.pullback import pulled_back
from tests.near import assert_near
from tests.stages.geometry.ruled.test_nearest import tube


def test_a_ring_around_a_cylinder_is_pulled_back_to_the_ring_on_it() -> None:
    ring = Circular(np.array([0, 0, 30.0]), np.array([0, 41.0, 0]), np.array([-41.0, 0, 20.0]), np.zeros(3), 0.0, pi)
    curve = pulled_back(tube(), ring, 32)
    t = np.linspace(0.0, 1.0, 101)
    z = 30.0 + 20.0 * np.sin(pi * t)
    expected = np.stack([z / 100.0, 0.25 + t / 2.0], axis=1)
    assert_near(curve.at(t), expected, bound=1e-14, why="closed form")
    slopes = np.stack([pi * 20.0 * np.cos(pi * t) / 100.0, np.full_like(t, 0.5)], axis=1)
    assert_near(curve.derivative(t), slopes, bound=1e-13, why="closed form, one division by curvatures")


def test_a_curve_that_ends_on_a_seam_stays_on_its_side_of_it() -> None:
    ring = Circular(np.array([0, 0, 30.0]), np.array([41.0, 0, 0]), np.array([0, 41.0, 0]), np.zeros(3), 0.0, pi / 2)
    other = Circular(ring.centre, ring.U, ring.V, ring.W, 0.0, -pi / 2)
    assert_near(pulled_back(tube(), ring, 16).at(np.zeros(1))[0], [0.3, 0.0], bound=1e-15, why="rising from 0")
    assert_near(pulled_back(tube(), other, 16).at(np.zeros(1))[0], [0.3, 1.0], bound=1e-15, why="falling from 1")
