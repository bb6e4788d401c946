"""Openings: points on the main and on the branch, slopes, lengths and areas of 40 digits, branches that touch."""

from math import cos, pi, radians, sin

import numpy as np
import pytest
from mpmath import asin, cot, ellipe, mp, mpf, sqrt

from stages.geometry.arrays import EPS, Points2
from stages.geometry.curves import contours
from stages.geometry.curves.halfchord import TOUCHING
from stages.geometry.curves.opening import Opening, opening
from tests import oracles
from tests.near import assert_near, assert_relative

SHAPES = [(100.0, 60.0, 20.0, 60), (1.0, 0.75, -0.1, 125), (4500.0, 1000.0, 0.0, 90), (50.0, 12.5, -30.0, 30),
          (3.0, 2.999, 0.0, 45)]  # fmt: skip
TOUCHES = [(50.0, 50.0, 0.0, 50), (50.0, 30.0, 20.0, 70), (50.0, 30.0, -20.0, 110), (0.3, 0.1, 0.2, 90)]
EVERY = pytest.mark.parametrize(("main", "branch", "middle", "angle"), SHAPES + TOUCHES)
T = np.linspace(0.0, 1.0, 33)


def rolled(main: float, flat: Points2) -> np.ndarray:
    """Return points of the development back on the main."""
    around = flat[:, 1] / main
    return np.stack([flat[:, 0], main * np.sin(around), main * np.cos(around)], axis=1)


@EVERY
def test_laid_around_the_main_the_opening_lies_on_the_branch(
    main: float, branch: float, middle: float, angle: int
) -> None:
    axis = np.array([cos(radians(angle)), 0.0, sin(radians(angle))])
    for edge in opening(main, branch, middle, radians(angle)):
        arm = rolled(main, edge.at(T)) - [0.0, middle, 0.0]
        away = np.linalg.norm(arm - np.outer(arm @ axis, axis), axis=1)
        size = main / sin(radians(angle)) * 2.0
        assert_near(away, np.full(T.size, branch), bound=32 * EPS * size**2 / branch, why="a few roundings of the size")


@EVERY
def test_points_and_slopes_are_those_of_the_formulas_to_40_digits(
    main: float, branch: float, middle: float, angle: int
) -> None:
    rho, r, m = (oracles.exact(repr(x)) for x in (main, branch, middle))
    alpha = mp.radians(angle)
    for edge in opening(main, branch, middle, radians(angle)):
        for t in (1e-6, 0.1, 0.249, 0.4999, 0.77, 1.0 - 2.0**-20):
            b, sweep = mpf(edge.start) + mpf(t) * mpf(edge.sweep), mpf(edge.sweep)
            h, turn = m + r * mp.cos(b), -r * mp.sin(b)
            z = sqrt((rho - h) * (rho + h))
            point = [z * cot(alpha) - r * mp.sin(b) / mp.sin(alpha), rho * mp.atan2(h, z)]
            slope = [sweep * (-h * turn / z * cot(alpha) - r * mp.cos(b) / mp.sin(alpha)), sweep * rho * turn / z]
            # b is rounded to some EPS of a turn, and positions move by the slope; slopes by their own, which is largest
            # where the branch nearly touches: over the share of a turn that is the root of the gap's
            scale = float(abs(slope[0]) + abs(slope[1]) + rho)
            gap = max(main - abs(middle) - branch, 0.0) / main
            steep = 1.0 / np.sqrt(gap) if gap > TOUCHING else 1.0
            where = np.array([t])
            assert_near(edge.at(where)[0], [float(x) for x in point], bound=64 * EPS * scale, why="rounding of b")
            found = edge.derivative(where)[0]
            assert_near(found, [float(x) for x in slope], bound=64 * EPS * scale * steep, why="rounding of b")


def exact(shape: tuple[float, float, float, int]) -> tuple[mpf, mpf]:
    """Return length and area, by the saddle's own curve in space and by the width along the main."""
    rho, r, m = (oracles.exact(repr(x)) for x in shape[:3])
    alpha = mp.radians(shape[3])

    def rise(b: mpf) -> tuple[mpf, mpf]:
        h = m + r * mp.cos(b)
        z = sqrt(rho**2 - h**2)
        return z, h * r * mp.sin(b) / z

    def speed(v: mpf) -> mpf:
        b = 2 * mp.pi * v
        along = rise(b)[1] / mp.sin(alpha) - r * mp.cos(b) * cot(alpha)
        return 2 * mp.pi * sqrt(along**2 + r**2)

    def strip(v: mpf) -> mpf:
        b = 2 * mp.pi * v
        return 2 * mp.pi * rho * r**2 * mp.sin(b) ** 2 / (rise(b)[0] * mp.sin(alpha))

    return oracles.Antiderivative(speed)(1), oracles.Antiderivative(strip)(1)


@pytest.mark.parametrize("shape", SHAPES[:4])
def test_length_and_area_are_those_of_quadrature_to_40_digits(shape: tuple[float, float, float, int]) -> None:
    main, branch, middle, angle = shape
    edges = opening(main, branch, middle, radians(angle))
    length, area = exact(shape)
    assert_relative(contours.length(edges), float(length), bound=1e-13, why="panels to rounding")
    assert_relative(contours.area(edges), float(area), bound=1e-13, why="panels to rounding")


@pytest.mark.parametrize("angle", [30, 50, 90, 140])
def test_the_opening_of_equal_pipes_is_two_halves_of_ellipses_around_half_the_main(angle: int) -> None:
    edges = opening(50.0, 50.0, 0.0, radians(angle))
    half = mp.radians(angle) / 2
    length = sum(2 * mpf(50) / s * ellipe(1 - s**2) for s in (mp.sin(half), mp.cos(half)))
    assert len(edges) == 2
    assert_relative(contours.length(edges), float(length), bound=1e-13, why="half ellipses r by r / sin of half angles")
    area = 4.0 * 50.0**2 / sin(radians(angle))
    assert_relative(contours.area(edges), area, bound=1e-13, why="integral of 2 r cos / sin(angle) over r db")
    tips = np.concatenate([edge.at(np.zeros(1)) for edge in edges])
    assert_near(tips[:, 1], [25.0 * pi, -25.0 * pi], bound=1e-12, why="a quarter of the main to either side")
    assert_near(tips[:, 0], np.zeros(2), bound=1e-12, why="both axes cross at x = 0")


@pytest.mark.parametrize(("middle", "tip"), [(20.0, 1.0), (-20.0, -1.0)])
def test_a_branch_that_touches_one_side_has_one_corner_there(middle: float, tip: float) -> None:
    (edge,) = opening(50.0, 30.0, middle, radians(70))
    ends = edge.at(np.array([0.0, 1.0]))
    assert_near(ends[:, 1], [tip * 25.0 * pi] * 2, bound=1e-12, why="a quarter of the main")
    assert_near(ends[0], ends[1], bound=1e-12, why="closed")
    begin, end = edge.derivative(np.array([0.0, 1.0]))
    assert abs(begin[0] * end[1] - begin[1] * end[0]) > 0.1 * np.linalg.norm(begin) * np.linalg.norm(end)


@EVERY
def test_it_runs_counter_clockwise_and_closes(main: float, branch: float, middle: float, angle: int) -> None:
    edges = opening(main, branch, middle, radians(angle))
    assert contours.area(edges) > 0.0
    starts = [edge.at(np.zeros(1))[0] for edge in edges]
    ends = [edge.at(np.ones(1))[0] for edge in edges]
    size = main / sin(radians(angle))
    # near a touching side z is the root of what an angle is rounded by
    assert_near(ends, starts[1:] + starts[:1], bound=16 * EPS * size, why="sines of angles a full turn apart")


def test_a_branch_that_nearly_touches_keeps_its_digits() -> None:
    main, branch = 100.0, 100.0 - 2.0**-40
    edge: Opening = opening(main, branch, 0.0, radians(90))[0]
    found = edge.at(np.array([0.5]))[0]
    assert_near(found[0], 0.0, bound=EPS, why="cos(pi / 2) of a double, squared")
    assert_near(found[1], float(100 * asin(mpf(branch) / 100)), bound=1e-13, why="nothing cancels")
