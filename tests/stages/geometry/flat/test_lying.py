"""Patterns are put down the same way however they were given."""

from math import radians

import numpy as np
import pytest

from stages.geometry.flat.lying import lying
from tests.near import assert_near

L_SHAPE = np.array([[0.0, 0], [90, 0], [90, 10], [60, 10], [60, 40], [0, 40]])


def put_down(points: np.ndarray) -> np.ndarray:
    rotation, move = lying(points)
    assert_near(rotation @ rotation.T, np.eye(2), bound=1e-15, why="a rotation")
    assert_near(np.linalg.det(rotation), 1.0, bound=1e-15, why="no mirror")
    return points @ rotation.T + move


@pytest.mark.parametrize("degrees", [0.0, 17.0, 90.0, 180.0, 233.0, 270.0])
@pytest.mark.parametrize("size", [1e-2, 1.0, 100.0])
def test_an_outline_lies_along_x_with_its_heavy_corner_at_the_origin(degrees: float, size: float) -> None:
    turn = radians(degrees)
    matrix = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    found = put_down(size * L_SHAPE @ matrix.T + (300.0, -70.0) * np.array(size))
    assert_near(found, size * L_SHAPE, bound=1e-12 * size, why="rounding at 3 times the size")


def test_the_box_is_the_least_of_all_directions() -> None:
    rng = np.random.default_rng(3)
    points = rng.normal(size=(40, 2)) * (30.0, 7.0)
    width, height = np.ptp(put_down(points), axis=0)
    angles = np.linspace(0.0, np.pi / 2.0, 2001)
    boxes = [np.ptp(points @ (np.cos(a), np.sin(a))) * np.ptp(points @ (-np.sin(a), np.cos(a))) for a in angles]
    assert width >= height
    assert width * height <= min(boxes) * (1.0 + 1e-12)
