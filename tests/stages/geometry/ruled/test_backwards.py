"""Curves and patches turned round: every sort of curve has the turned values and derivatives, exactly where it can."""

from fractions import Fraction

import numpy as np
import pytest

from stages.geometry.curves.curves import Along, Bezier, Circular, Difference, bezier, rational, restrict
from stages.geometry.ruled.backwards import Backwards, backwards, exchanged, opposite, reversed_patch
from stages.geometry.ruled.ruled import at, delta, frames
from tests.near import assert_near
from tests.parts import QUINTIC_TANGENT, patches

CUBIC = bezier([[Fraction(x) for x in row] for row in ((0, 0, 0), (1, 2, 0), (3, 1, 4), (5, 0, 1))])
ARC = Circular(np.array([1.0, 2.0, 3.0]), np.array([2.0, 0, 0]), np.array([0, 2.0, 0]), np.zeros(3), 0.3, 1.4)
CONIC = rational([[Fraction(x) for x in row] for row in ((1, 0, 0, 1), (1, 1, 0, 1), (0, 2, 0, 2))])
SORTS = {
    "Bezier": CUBIC, "rational": CONIC, "circular": ARC, "difference": Difference(ARC, CUBIC),
    "along": Along(CUBIC, np.array([0.0, 0.6, 0.8])), "any": Backwards(ARC),
}  # fmt: skip
V = np.linspace(0.0, 1.0, 9)


@pytest.mark.parametrize("name", SORTS)
def test_the_jet_at_v_is_that_at_the_other_side_with_every_odd_derivative_negative(name: str) -> None:
    curve = SORTS[name]
    for turned in (backwards(curve), Backwards(curve)):
        expected = curve.jet(1.0 - V, 4) * np.array([1.0, -1.0, 1.0, -1.0, 1.0])[:, None, None]
        assert_near(turned.jet(V, 4), expected, bound=1e-11, why="fourth derivatives of some 1e3, in another order")


@pytest.mark.parametrize("name", SORTS)
def test_the_opposite_is_minus_the_curve(name: str) -> None:
    assert_near(opposite(SORTS[name]).jet(V, 3), -SORTS[name].jet(V, 3), bound=1e-12, why="only signs change")


def test_a_part_of_a_turned_curve_is_the_turned_part() -> None:
    turned = Backwards(Difference(ARC, CUBIC))
    part = restrict(turned, Fraction(1, 4), Fraction(1, 2))
    assert_near(part.jet(V, 1)[0], turned.jet(0.25 + 0.25 * V, 1)[0], bound=1e-14, why="the same values")
    assert_near(part.jet(V, 1)[1], 0.25 * turned.jet(0.25 + 0.25 * V, 1)[1], bound=1e-13, why="a quarter of the speed")
    assert restrict(turned, Fraction(1), Fraction(0)) is turned.curve


def test_exact_control_points_stay_exact_and_turning_twice_changes_nothing() -> None:
    once = backwards(CUBIC)
    assert isinstance(once, Bezier)
    assert once.exact == CUBIC.exact[::-1]
    twice = backwards(once)
    assert isinstance(twice, Bezier)
    assert twice.exact == CUBIC.exact


def test_a_turned_patch_has_the_same_points_and_stays_developable_and_exact() -> None:
    (patch,) = patches(QUINTIC_TANGENT)
    u = np.linspace(0.0, 1.0, 9)
    assert_near(at(reversed_patch(patch), u, V), at(patch, u, 1.0 - V), bound=1e-12, why="rounding of 600 mm")
    assert_near(at(exchanged(patch), u, V), at(patch, 1.0 - u, V), bound=1e-12, why="rounding of 600 mm")
    for turned in (reversed_patch(patch), exchanged(patch)):
        assert turned.exact
        f = frames(turned, V)
        scale = 500.0**3
        assert_near(delta(f), np.zeros(9), bound=1e-12 * scale, why="rounding of the triple product")
