"""Smooth curves that turn back along a line: found below a width, told from lines, corners and what is wider."""

from fractions import Fraction

import numpy as np
import pytest

from stages.geometry.curves.curves import Circular, Curve, bezier
from stages.geometry.rails.hairpin import NARROW, PLACES, hairpin
from tests.near import assert_near, assert_relative


def ellipse(minor: float, start: float = 0.0, sweep: float = 2.0 * np.pi) -> Circular:
    """Return an ellipse of 240 mm about (1, 2, 3), its long axis oblique."""
    across = np.array([-0.8, 0.6, 0.0])
    return Circular(np.array([1.0, 2.0, 3.0]), MAJOR * ALONG, minor * across, np.zeros(3), start, sweep)


MAJOR = 120.0
ALONG = np.array([0.6, 0.8, 0.0])


def cubic(*along: int) -> Curve:
    """Return a cubic with its control points on a straight line."""
    return bezier([(Fraction(x), Fraction(2 * x), Fraction(0)) for x in along])


@pytest.mark.parametrize("minor", [6e-5, -1e-9, 0.0])
def test_an_ellipse_of_no_width_is_its_axis_there_and_back(minor: float) -> None:
    found = hairpin(ellipse(minor))
    assert found is not None
    assert_relative(found.long_mm, 2.0 * MAJOR, bound=1e-9, why="v = 1/2 is the other end; the width adds its square")
    assert_near(found.off_mm, abs(minor), bound=1e-12, why="the axis is v = 1/4; rounding of 120 mm")
    assert found.v == 0.5


def test_the_width_is_a_share_of_the_length() -> None:
    most = NARROW * 2.0 * MAJOR
    assert hairpin(ellipse(most * 0.99)) is not None
    assert hairpin(ellipse(most * 1.01)) is None


@pytest.mark.parametrize(("start", "at"), [(-0.05, 0.05 / 1.5), (-1.0, 1.0 / 1.5), (2.0, (np.pi - 2.0) / 1.5)])
def test_part_of_an_ellipse_turns_back_where_the_end_of_its_axis_is(start: float, at: float) -> None:
    found = hairpin(ellipse(1e-6, start, 1.5))
    assert found is not None
    assert_near(found.v, at, bound=1.0 / (PLACES - 1.0), why="the place before it")


def test_part_of_an_ellipse_between_the_ends_of_its_axis_does_not_turn_back() -> None:
    assert hairpin(ellipse(1e-6, 0.1, 3.0)) is None


@pytest.mark.parametrize(
    ("curve", "turns"),
    [(cubic(0, 1, 2, 3), False), (cubic(0, 1, 5, 6), False), (cubic(0, 4, 4, 0), True), (cubic(0, 6, 5, 1), True)],
)
def test_a_line_turns_back_if_its_parameter_does(curve: Curve, turns: bool) -> None:
    assert (hairpin(curve) is not None) == turns


def test_a_curve_of_one_point_does_not() -> None:
    assert hairpin(cubic(1, 1, 1, 1)) is None
