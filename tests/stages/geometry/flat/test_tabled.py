"""Curves of u and v as series: what they were, to rounding, and untouched where that cannot be had."""

from dataclasses import dataclass

import numpy as np
import pytest

from stages.geometry.arrays import Points2, Values
from stages.geometry.curves.curves import Circular
from stages.geometry.curves.plane import PlaneCurve
from stages.geometry.flat.tabled import MOST_PANELS, NODES, Tabled, tabled
from stages.geometry.ruled.drill import drilled
from stages.geometry.ruled.pullback import pulled_back
from stages.geometry.ruled.strip import Strip
from tests.near import assert_near
from tests.parts import QUINTIC_TANGENT, RIGHT_FRUSTUM, patches
from tests.stages.geometry.ruled.test_pullback import tube

T = np.linspace(0.0, 1.0, 1001)
ROUNDING = 1e-13
"""Of places: the last coefficients are 2e-14 at most, and those that were left out fall by as much again."""


@dataclass
class Counted:
    """A curve that counts the places it is asked for."""

    curve: PlaneCurve
    count: int = 0

    def at(self, t: Values) -> Points2:
        self.count += t.size
        return self.curve.at(t)

    def derivative(self, t: Values) -> Points2:
        return self.curve.derivative(t)


@dataclass
class Kinked:
    """A curve with a corner at a place that no panel ends at."""

    corner: float = 1.0 / 3.0

    def at(self, t: Values) -> Points2:
        return np.stack([np.abs(t - self.corner), t], axis=1)

    def derivative(self, t: Values) -> Points2:
        return np.stack([np.sign(t - self.corner), np.ones_like(t)], axis=1)


def strip_of(table: dict[str, object]) -> Strip:
    made = patches(table)
    return Strip(made, np.arange(len(made) + 1.0))


@pytest.mark.parametrize("table", [QUINTIC_TANGENT, RIGHT_FRUSTUM])
@pytest.mark.parametrize("share", [0.01, 0.2])
def test_a_drilled_hole_is_what_it_was_to_rounding(table: dict[str, object], share: float) -> None:
    strip = strip_of(table)
    extent = float(np.linalg.norm(strip.patches[0].p.jet(np.array([0.5]), 0)[0]))
    hole = drilled(strip, np.array([0.5, 0.5]), share * extent)
    assert hole is not None
    made = tabled(hole, strip)
    assert isinstance(made, Tabled)
    assert_near(made.at(T), hole.at(T), bound=ROUNDING, why="series to rounding")
    # the derivative of a series loses the square of its degree over half a panel's width
    loss = 2.0 * NODES**2 * (made.panels.size - 1)
    assert_near(made.derivative(T), hole.derivative(T), bound=loss * ROUNDING, why="degree^2 of the places'")


def test_a_ring_pulled_back_is_asked_for_a_few_hundred_places_and_no_more() -> None:
    ring = Circular(np.array([0, 0, 30.0]), np.array([0, 41.0, 0]), np.array([-41.0, 0, 20.0]), np.zeros(3), 0.0, np.pi)
    curve = Counted(pulled_back(tube(), ring, 32))
    made = tabled(curve, tube())
    asked = curve.count
    assert isinstance(made, Tabled)
    assert asked <= MOST_PANELS * NODES
    assert_near(made.at(T), curve.at(T), bound=ROUNDING, why="series to rounding")
    assert curve.count == asked + T.size


def test_ends_are_kept_to_the_last_digit_and_rounding_stays_on_the_strip() -> None:
    strip = strip_of(QUINTIC_TANGENT)

    @dataclass
    class Along:
        def at(self, t: Values) -> Points2:
            return np.stack([np.sin(np.pi * t) ** 2, t], axis=1)

        def derivative(self, t: Values) -> Points2:
            return np.stack([np.pi * np.sin(2.0 * np.pi * t), np.ones_like(t)], axis=1)

    made = tabled(Along(), strip)
    assert isinstance(made, Tabled)
    assert made.at(np.array([0.0, 1.0])).tolist() == Along().at(np.array([0.0, 1.0])).tolist()
    places = made.at(T)
    assert places.min() >= 0.0
    assert places.max() <= 1.0


def test_a_curve_with_a_kink_is_left_as_it_is() -> None:
    kinked = Kinked()
    assert tabled(kinked, strip_of(QUINTIC_TANGENT)) is kinked
    assert isinstance(tabled(Kinked(0.25), strip_of(QUINTIC_TANGENT)), Tabled), "a panel ends there"
