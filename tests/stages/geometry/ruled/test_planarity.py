"""Planarity: a proof where points are exact, a sampled answer elsewhere."""

from fractions import Fraction

import pytest
from hypothesis import given, settings

from stages.geometry.curves.curves import bezier
from stages.geometry.ruled.planarity import is_planar
from stages.geometry.ruled.ruled import between
from tests.parts import EXAMPLE_1, EXAMPLE_2_CYLINDER, MITRED_CYLINDER, RIGHT_FRUSTUM, patches
from tests.strategies import different_points, motions, moved


def test_theorem_2_1_gives_a_plane_and_that_is_proved() -> None:
    assert is_planar(patches(EXAMPLE_1)) == (True, True)


def test_a_cylinder_is_not_plane() -> None:
    assert is_planar(patches(EXAMPLE_2_CYLINDER)) == (False, True)
    assert is_planar(patches(MITRED_CYLINDER)) == (False, False)


def test_a_cone_of_no_height_is_plane_as_far_as_samples_show() -> None:
    assert is_planar(patches(RIGHT_FRUSTUM | {"height": 0})) == (True, False)
    assert is_planar(patches(RIGHT_FRUSTUM | {"height": "1e-6"})) == (False, False)


@settings(max_examples=30)
@given(different_points(6), motions())
def test_points_of_one_plane_stay_in_one_plane_and_the_smallest_change_is_seen(
    rows: list[tuple[Fraction, ...]], motion: object
) -> None:
    level = [(x, y, 2 * x - 3 * y) for x, y, _ in rows]
    patch = moved(between(bezier(level[:3]), bezier(level[3:])), motion)
    assert is_planar((patch,)) == (True, True)
    spans = any(
        (a[0] - level[0][0]) * (b[1] - level[0][1]) != (a[1] - level[0][1]) * (b[0] - level[0][0])
        for a in level[2:]
        for b in level[2:]
    )
    off = [level[0], (level[1][0], level[1][1], level[1][2] + Fraction(1, 10**30)), *level[2:]]
    assert is_planar((between(bezier(off[:3]), bezier(off[3:])),)) == (not spans, True)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_points_on_a_line_are_plane(count: int) -> None:
    line = bezier([(Fraction(i), Fraction(2 * i), Fraction(0)) for i in range(count + 1)])
    assert is_planar((between(line, line),)) == (True, True)
