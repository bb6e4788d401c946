"""Half chords: derivatives against Taylor coefficients of 40 digits, touching lines, lines that nearly touch."""

from math import pi

import numpy as np
import pytest
from mpmath import cos, mp, mpf, sqrt, taylor

from stages.geometry.arrays import EPS
from stages.geometry.curves.halfchord import HalfChord, excess
from tests.near import assert_near, assert_relative


def chord(radius: float, middle: float, reach: float, start: float = 0.0, sweep: float = 2.0 * pi) -> HalfChord:
    return HalfChord(excess(radius, middle, reach), excess(radius, -middle, reach), reach, 1.0, start, sweep)


@pytest.mark.parametrize(("radius", "middle", "reach"), [(100.0, 20.0, 60.0), (3.0, -0.5, 1.0), (50.0, 0.0, 49.5)])
def test_derivatives_are_those_of_the_square_root(radius: float, middle: float, reach: float) -> None:
    places = np.array([0.0, 0.13, 0.25, 0.5, 0.77, 1.0])
    jets = chord(radius, middle, reach).jet(places, 4)

    def half(v: mpf) -> mpf:
        return sqrt(mpf(radius) ** 2 - (mpf(middle) + mpf(reach) * cos(2 * mpf(pi) * v)) ** 2)

    for i, v in enumerate(places):
        with mp.workdps(40):
            series = taylor(half, mpf(float(v)), 4)
        for k in range(5):
            wanted = float(series[k] * mp.factorial(k))
            scale = radius * (2.0 * pi) ** k * (radius / (radius - abs(middle) - reach)) ** k
            assert_near(jets[k, i, 0], wanted, bound=64 * EPS * scale, why="sums of up to 5 products of series")


def test_other_coordinates_are_nothing() -> None:
    assert not chord(3.0, 0.0, 1.0).jet(np.linspace(0.0, 1.0, 5), 2)[..., 1:].any()


def test_lines_that_touch_the_pipe_leave_a_smooth_root_up_to_there() -> None:
    v = np.linspace(0.0, 1.0, 9)
    jets = chord(2.0, 0.0, 2.0, 0.0, pi).jet(v, 3)[..., 0]  # sqrt(4 - 4 cos^2) = 2 sin
    wanted = [2.0 * pi**k * np.sin(pi * v + k * pi / 2.0) for k in range(4)]
    assert_near(jets, wanted, bound=16 * EPS * 2.0 * pi**3, why="closed form 2 sin(pi v)")


def test_a_line_that_nearly_touches_keeps_its_digits() -> None:
    radius, reach, v = 100.0, 100.0 - 2.0**-40, np.array([1e-9])
    near = chord(radius, 0.0, reach).jet(v, 0)[0, 0, 0]
    with mp.workdps(40):
        h = mpf(reach) * cos(2 * mpf(pi) * mpf(float(v[0])))
        wanted = float(sqrt((mpf(radius) - h) * (mpf(radius) + h)))
    assert_relative(near, wanted, bound=16 * EPS, why="nothing cancels")


def test_an_excess_that_is_rounding_is_nothing() -> None:
    assert excess(0.3, 0.1, 0.2) == 0.0
    assert excess(0.3, 0.1, 0.2 - 1e-9) > 0.0 > excess(0.3, 0.1, 0.2 + 1e-9)
