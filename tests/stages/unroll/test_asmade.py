"""What one measurement says of kerf, K-factor and springback: closed forms, and the models run backwards."""

from math import pi, radians, sqrt

import numpy as np
import pytest

from stages.model.material import Material
from stages.unroll.asmade import (
    Estimate,
    Folded,
    bending_share,
    corner_moves,
    distance_rate,
    k_factor_of,
    propagated,
    yield_share,
)
from stages.unroll.rolls import tool_radius
from tests.near import assert_near


def exactly(*values: float) -> tuple[Estimate, ...]:
    """Return values known without error."""
    return tuple(Estimate(value, 0.0) for value in values)


def test_corners_of_a_rectangle_move_by_half_the_kerf_along_both_sides() -> None:
    corners = np.array([[0.0, 0.0], [30.0, 0.0], [30.0, 40.0], [0.0, 40.0]])
    moves = corner_moves(corners)
    assert_near(moves, [[0.5, 0.5], [-0.5, 0.5], [-0.5, -0.5], [0.5, -0.5]], bound=1e-15, why="closed form")
    assert_near(distance_rate(corners[0], corners[2], moves[0], moves[2]), -1.4, bound=1e-15, why="(3 + 4) / 5")


def test_corners_of_a_rhombus_move_along_its_diagonals() -> None:
    corners = np.array([[2.0, 0.0], [0.0, 1.0], [-2.0, 0.0], [0.0, -1.0]])
    moves = corner_moves(corners)
    assert_near(moves[0], [-sqrt(5.0) / 2.0, 0.0], bound=1e-15, why="k / 2 / sin(p / 2), sin(p / 2) = 1 / sqrt(5)")
    assert_near(moves[1], [0.0, -sqrt(5.0) / 4.0], bound=1e-15, why="sin(p / 2) = 2 / sqrt(5)")


@pytest.mark.parametrize("k", [0.3, 0.44])
def test_k_comes_back_from_what_a_bend_with_it_would_measure(k: float) -> None:
    t, r, theta = 2.0, 3.0, radians(75.0)
    setback = (r + t) * np.tan(theta / 2.0)
    part = Folded(
        Estimate(40.0 + 50.0 + theta * (r + k * t), 0.0), Estimate(t, 0.0),
        exactly(40.0 + setback, 50.0 + setback), exactly(theta), exactly(r),
    )  # fmt: skip
    assert_near(k_factor_of(part).value, k, bound=1e-14, why="rounding")
    assert k_factor_of(part).uncertainty == 0.0


def test_the_uncertainty_of_the_blank_reaches_k_over_t_and_angle() -> None:
    part = Folded(Estimate(100.0, 0.1), Estimate(2.0, 0.0), exactly(47.0, 57.0), exactly(pi / 2.0), exactly(4.0))
    assert_near(k_factor_of(part).uncertainty, 0.1 / (2.0 * pi / 2.0), bound=1e-12, why="linear: u / (t theta)")


@pytest.mark.parametrize("left", [50.0, 300.0, 2000.0])
def test_springback_comes_back_from_the_tool_that_the_schedule_asks_for(left: float) -> None:
    sheet = Material(thickness_mm=2.0, yield_strength_mpa=235.0, youngs_modulus_gpa=210.0)
    tool = tool_radius(sheet, left)
    assert tool is not None
    share = yield_share(Estimate(tool, 0.0), Estimate(left, 0.0), 2.0)
    assert_near(share.value / (235.0 / 210e3), 1.0, bound=1e-9, why="two root finders of one cubic")


def test_a_sheet_that_closes_in_has_a_negative_share_and_one_that_cannot_says_nothing() -> None:
    assert yield_share(Estimate(100.0, 0.0), Estimate(99.0, 0.0), 2.0).value < 0.0
    assert np.isinf(yield_share(Estimate(100.0, 0.0), Estimate(40.0, 0.0), 2.0).uncertainty)


@pytest.mark.parametrize(("ratio", "x"), [(1.0, 0.0), (0.0, 0.5), (0.3125, 0.25), (2.0, -0.5)])
def test_the_cubic_is_solved(ratio: float, x: float) -> None:
    assert_near(bending_share(ratio), x, bound=1e-8, why="at the ends the cubic is flat: half the digits")


def test_uncertainties_add_as_squares() -> None:
    found = propagated(lambda x: float(3.0 * x[0] - 4.0 * x[1]), (Estimate(1.0, 1.0), Estimate(1.0, 1.0)))
    assert_near([found.value, found.uncertainty], [-1.0, 5.0], bound=1e-15, why="3, 4, 5")
