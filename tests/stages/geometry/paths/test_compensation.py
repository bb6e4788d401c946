"""The way of a beam around contours: what it leaves in corners, where it does not fit, and faults planted in a way."""

import numpy as np
import pytest

from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, backwards, transform
from stages.geometry.paths.beside import ROUND, Corners
from stages.geometry.paths.compensation import TooNarrow, compensated, fit
from tests.near import assert_near
from tests.stages.geometry.paths.test_beside import ANGLE, CIRCLE, SQUARE, notched, polygon

HALF_MM = 0.1
EXACT = 1e-12


def way(contour: ArcPath, corners: Corners = ROUND) -> ArcPath:
    found = compensated(contour, HALF_MM, corners)
    assert isinstance(found, ArcPath)
    return found


@pytest.mark.parametrize("corners", [ROUND, Corners(mitred=True)], ids=["round", "mitred"])
@pytest.mark.parametrize("contour", [SQUARE, backwards(CIRCLE), CIRCLE], ids=["square", "hole", "disc"])
def test_without_inner_corners_nothing_is_left_standing(contour: ArcPath, corners: Corners) -> None:
    found = fit(contour, way(contour, corners), HALF_MM)
    assert_near([found.off_mm, found.left_mm], [0.0, 0.0], bound=EXACT, why="exact to rounding")


def test_an_inner_corner_keeps_what_a_disc_leaves() -> None:
    found = fit(ANGLE, way(ANGLE), HALF_MM)
    assert_near(found.left_mm, (np.sqrt(2.0) - 1.0) * HALF_MM, bound=EXACT, why="closed form at 90 degrees")
    assert found.off_mm <= EXACT


def test_a_slot_is_entered_if_it_is_wider_than_the_beam() -> None:
    assert fit(notched(0.21), way(notched(0.21)), HALF_MM).off_mm <= EXACT
    narrow = compensated(notched(0.19), HALF_MM, ROUND)
    assert isinstance(narrow, TooNarrow)
    x, y = narrow.at.tolist()
    assert abs(x - 5.0) <= 0.1
    assert 3.0 <= y < 10.0
    assert narrow.left_mm > 2.0 * HALF_MM


def test_a_hole_as_narrow_as_the_beam_has_no_way() -> None:
    narrow = compensated(backwards(CIRCLE), 5.0, ROUND)
    assert isinstance(narrow, TooNarrow)
    assert_near(narrow.at, [0.0, 0.0], bound=EXACT, why="its middle")


def test_a_neck_that_the_beam_cannot_pass_is_named() -> None:
    bone = backwards(
        polygon(
            *((0.0, 0.0), (4.0, 0.0), (4.0, 1.95), (6.0, 1.95), (6.0, 0.0), (10.0, 0.0)),
            *((10.0, 4.0), (6.0, 4.0), (6.0, 2.05), (4.0, 2.05), (4.0, 4.0), (0.0, 4.0)),
        )
    )
    narrow = compensated(bone, HALF_MM, ROUND)
    assert isinstance(narrow, TooNarrow)
    assert_near(narrow.at, [5.0, 2.0], bound=0.2, why="in the neck, 2 long")


@pytest.mark.parametrize(
    ("change", "least"),
    [
        (lambda path: transform(path, Rigid2(1e-4, 0.0)), 0.99e-4),
        (lambda path: transform(path, Rigid2(0.0, 0.0, 0.001)), 1e-5),
        (lambda path: ArcPath(path.vertices * 1.0001, path.bulges, closed=True), 1e-4),
        (lambda path: ArcPath(path.vertices, path.bulges * 0.99, closed=True), 1e-4),
    ],
    ids=["moved", "turned", "grown", "bent"],
)
def test_a_way_that_is_off_by_little_is_measured(change: object, least: float) -> None:
    good = way(ANGLE)
    assert fit(ANGLE, good, HALF_MM).off_mm <= EXACT
    assert fit(ANGLE, change(good), HALF_MM).off_mm >= least  # type: ignore[operator]


def test_a_way_elsewhere_is_off_beyond_measure() -> None:
    assert fit(SQUARE, transform(way(SQUARE), Rigid2(500.0, 0.0)), HALF_MM).off_mm == np.inf
