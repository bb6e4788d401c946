"""Largest values by sampling: closed forms, narrow peaks, and what it does with values that are not numbers."""

from math import pi

import numpy as np
import pytest

from stages.geometry.arrays import EPS, Values
from stages.geometry.numeric.extremum import maximum, minimum
from tests.near import assert_near


@pytest.mark.parametrize("place", [0.0, 1e-6, 0.1234567, 0.5, 1.0 / 3.0, 1.0])
def test_the_peak_of_a_parabola_is_found_to_rounding(place: float) -> None:
    value, where = maximum(lambda v: 2.0 - (v - place) ** 2)
    assert_near(value, 2.0, bound=4 * EPS, why="flat at the peak")
    assert_near(where, place, bound=1.5e-8, why="the square root of rounding, half a step of the last pass")


@pytest.mark.parametrize("waves", [3, 20, 40])
def test_the_highest_of_many_waves_is_found(waves: int) -> None:
    def wavy(v: Values) -> Values:
        return np.cos(2.0 * pi * waves * v) - (v - 0.6) ** 2

    best = round(0.6 * waves) / waves
    assert_near(maximum(wavy)[1], best, bound=1e-3 + 1.0 / (2.0 * pi * waves) ** 2, why="the parabola moves the peak")


def test_a_kink_is_found_within_a_step_of_the_last_pass() -> None:
    assert_near(maximum(lambda v: -np.abs(v - 0.7071))[1], 0.7071, bound=5.1e-9, why="half of 1/96/16**5")


def test_a_step_function_gives_its_upper_value() -> None:
    assert maximum(lambda v: np.where(v > 0.3, 1.0, 0.0))[0] == 1.0


def test_what_is_not_a_number_is_passed_over() -> None:
    value, where = maximum(lambda v: np.where(v < 0.5, np.nan, -v))
    assert_near([value, where], [-0.5, 0.5], bound=1e-8, why="the last step")
    assert maximum(lambda v: np.full_like(v, np.nan))[0] == -np.inf


def test_an_infinite_value_is_the_largest() -> None:
    assert maximum(lambda v: np.where(v == 1.0, np.inf, v)) == (np.inf, 1.0)


def test_the_least_value_is_the_largest_of_the_opposite() -> None:
    value, where = minimum(lambda v: (v - 0.3) ** 2 + 2.0)
    assert_near([value, where], [2.0, 0.3], bound=1e-7, why="flat to rounding about its place")
