"""How far strips bend: closed forms, a second integral, folds and inflections, and places at equal turning."""

from fractions import Fraction
from math import radians

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.errors import NoSolutionError
from stages.geometry.arrays import Values, cross2, norm
from stages.geometry.numeric import quadrature
from stages.geometry.ruled.ruled import RuledPatch, bending, frames
from stages.geometry.ruled.tightest import tightest
from stages.geometry.ruled.turning import (
    MOST_TURNS,
    Turning,
    chord_turning,
    equal_turns,
    is_fold,
    places,
    run_angle,
    runs,
    turning,
    turning_places,
)
from tests.near import assert_near, assert_relative
from tests.parts import (
    AUMANN_CUBIC,
    CIRCLE,
    ELLIPTIC_CYLINDER,
    EXAMPLE_1,
    EXAMPLE_2_CYLINDER,
    MITRED_CYLINDER,
    OBLIQUE_CONE,
    QUINTIC_TANGENT,
    RIGHT_FRUSTUM,
    Table,
    patches,
)
from tests.strategies import Motion, motions, moved, scaled, scales

FULL_ROUND = 2.0 * np.pi


def strip(table: Table) -> Turning:
    return turning(patches(table))


def even_places(parts: tuple[RuledPatch, ...], steps: int) -> np.ndarray:
    return turning_places(turning(parts), len(parts), steps)


def trough(points: list[list[object]]) -> Table:
    """Planes over a polyline in the plane z = 0: folds alone."""
    return {"kind": "cylinder", "directrix": {"polyline": points}, "direction": [0, 0, 1], "length": 5}


ZIGZAG: list[list[object]] = [[0, 0, 0], [3, 0, 0], [3, 4, 0], [9, 4, 0]]
"""Left by 90 deg, right by 90 deg."""


# Amounts


@pytest.mark.parametrize(
    ("table", "total"),
    [
        (MITRED_CYLINDER, FULL_ROUND),
        (ELLIPTIC_CYLINDER, FULL_ROUND),
        (RIGHT_FRUSTUM, FULL_ROUND * 4.0 / np.hypot(4.0, 1.5)),
        (EXAMPLE_1, 0.0),
    ],
)
def test_what_goes_once_around_turns_by_the_length_of_its_gauss_image(table: Table, total: float) -> None:
    assert_near(strip(table).total_rad, total, bound=1e-13, why="a quadrature of 1e-14 of 2 pi")


@pytest.mark.parametrize("table", [AUMANN_CUBIC, QUINTIC_TANGENT, OBLIQUE_CONE, EXAMPLE_2_CYLINDER])
def test_the_turning_is_that_of_the_second_derivatives(table: Table) -> None:
    """By S_vv . N over the width (`ruled.bending`), which shares no formula with N'."""
    (patch,) = patches(table)

    def rate(v: Values) -> np.ndarray:
        f = frames(patch, v)
        return np.stack([bending(f, 0.0), bending(f, 1.0), np.ones_like(v)], axis=1)

    by_bending = quadrature.integral(rate, "second way")[:2]
    signed = sum(stretch.angle_rad for stretch in strip(table).stretches)
    assert_near(by_bending, [signed, signed], bound=1e-12, why="two quadratures of 1e-14 of their rates of up to 30")


@pytest.mark.parametrize("table", [AUMANN_CUBIC, QUINTIC_TANGENT, OBLIQUE_CONE, EXAMPLE_2_CYLINDER, trough(ZIGZAG)])
def test_chords_of_the_normal_tell_the_same(table: Table) -> None:
    made = chord_turning(patches(table))
    total = strip(table).total_rad
    assert_near(made, total, bound=total**3 * 1e-4, why="a chord is short by its cube / 24, and 512 are summed")


def test_the_planted_fault_of_a_lost_patch_is_seen_by_the_chords() -> None:
    every = patches({"kind": "cylinder", "directrix": {"points": [[0, 0, 0], [3, 1, 0], [5, -2, 0], [8, 0, 0]]},
                     "direction": [0, 0, 1], "length": 5})  # fmt: skip
    assert len(every) > 1
    assert abs(turning(every[:-1]).total_rad - chord_turning(every)) > 0.05


# Signs


def test_a_surface_that_bends_towards_the_side_of_p_x_c0_turns_positive() -> None:
    """p = z, c' counter-clockwise: N points to the axis, towards which a circle bends."""
    circle = {"kind": "cylinder", "directrix": CIRCLE, "direction": [0, 0, 1], "length": 1}
    downwards = circle | {"direction": [0, 0, -1]}
    assert [round(s.angle_rad, 12) for s in strip(circle).stretches] == [round(FULL_ROUND, 12)]
    assert [round(s.angle_rad, 12) for s in strip(downwards).stretches] == [-round(FULL_ROUND, 12)]


def test_the_stretches_of_example_2_part_at_its_inflection() -> None:
    (patch,) = patches(EXAMPLE_2_CYLINDER)
    first, second = strip(EXAMPLE_2_CYLINDER).stretches
    assert first.high == second.low
    _, slope, bend = patch.c0.jet(np.array([first.high]), 2)[:, 0]
    scale = float(norm(slope) * norm(bend))
    assert_near(cross2(slope[:2], bend[:2]) / scale, 0.0, bound=1e-11, why="a root at 1e-12 of v, times the slope")
    assert first.angle_rad < 0.0 < second.angle_rad
    assert_near(first.angle_rad + second.angle_rad, 0.0, bound=1e-13, why="the end tangents are parallel")


def test_folds_turn_at_one_place_with_their_sign() -> None:
    left, right = (s for s in strip(trough(ZIGZAG)).stretches if is_fold(s))
    assert (left.piece, right.piece) == (1, 2)
    assert_near([left.angle_rad, right.angle_rad], [np.pi / 2, -np.pi / 2], bound=1e-15, why="right angles")
    assert len(runs(strip(trough(ZIGZAG)))) == len(["plane", "fold", "plane", "fold", "plane"])


def test_a_run_goes_on_over_a_smooth_join_and_ends_at_a_fold_or_an_inflection() -> None:
    halves = [{"arc": {"center": [0, 0, 0], "radius": 2, "start": a, "end": a + 90}} for a in (0, 90)]
    smooth = strip({"kind": "cylinder", "directrix": {"chain": halves}, "direction": [0, 0, 1], "length": 1})
    (run,) = runs(smooth)
    assert len(run) == len(halves)
    assert_near(run_angle(run), np.pi, bound=1e-14, why="two quarters")
    assert len(runs(strip(EXAMPLE_2_CYLINDER))) == len(["down", "up"])


# Places


def test_places_on_an_ellipse_are_where_its_normal_has_turned_so_far() -> None:
    """x = 5 cos a, y = 2 sin a: the normal (cos a / 5, sin a / 2) has the angle atan2(5 sin a, 2 cos a)."""
    upright = ELLIPTIC_CYLINDER | {"direction": [0, 0, 1]}
    steps = 24
    v = even_places(patches(upright), steps)
    turned = np.unwrap(np.arctan2(5 * np.sin(FULL_ROUND * v), 2 * np.cos(FULL_ROUND * v)))
    assert_near(turned, FULL_ROUND * np.arange(1, steps) / steps, bound=1e-12, why="1e-10 was asked")


def test_places_are_even_on_right_cones_and_on_planes() -> None:
    even = np.arange(1, 8) / 8
    assert_near(even_places(patches(RIGHT_FRUSTUM), 8), even, bound=1e-14, why="a constant rate")
    assert_near(even_places(patches(EXAMPLE_1), 8), even, bound=0.0, why="a plane: shares of the parameter")


def test_steps_are_as_few_as_keep_the_angle_and_no_more_than_can_be_told_apart() -> None:
    assert [equal_turns(radians(90.0), most) for most in (90.0, 89.999, 30.0, 7.0)] == [1, 2, 3, 13]
    assert equal_turns(radians(MOST_TURNS * 0.1), 0.1) == MOST_TURNS
    with pytest.raises(NoSolutionError) as raised:
        equal_turns(radians(90.0), 1e-5)
    assert_near([raised.value.reached], [90.0 / MOST_TURNS], bound=1e-15, why="the least step that so many lines allow")
    assert (raised.value.wanted, raised.value.unit) == (1e-5, "deg")


def test_places_may_lie_at_a_fold_several_times() -> None:
    assert even_places(patches(trough(ZIGZAG)), 5).tolist() == [1.0, 1.0, 2.0, 2.0]


@pytest.mark.parametrize("table", [AUMANN_CUBIC, OBLIQUE_CONE, EXAMPLE_2_CYLINDER])
def test_between_places_the_turning_is_equal_to_1e_10(table: Table) -> None:
    bends = strip(table)
    for run in runs(bends):
        v = places(bends, run, np.linspace(0.0, 1.0, 14))
        assert (v[0], v[-1]) == (run[0].low, run[-1].high)
        steps = np.diff(bends.pieces[0].upto(v)[:, 0])
        assert_near(steps, np.full(13, run_angle(run) / 13), bound=1e-14, why="v is found to its last digit")


# Widths and radii


def test_the_distance_across_the_rulings_is_the_arc_on_a_cylinder_whatever_its_ends() -> None:
    upto = strip(MITRED_CYLINDER).pieces[0].upto(np.array([0.25, 1.0]))
    arcs = np.array([np.pi, 4.0 * np.pi])
    assert_near(upto[:, 1:], np.stack([arcs, arcs], axis=1), bound=2e-13, why="1e-14 of the length")


@pytest.mark.parametrize(
    ("table", "sign", "curvature", "u"),
    [
        (MITRED_CYLINDER, 1.0, 0.5, None),
        (RIGHT_FRUSTUM, 1.0, 4.0 / np.hypot(4.0, 1.5) / 1.5, 1.0),
        ({"kind": "cone", "radius0": 3, "radius1": 0, "height": 4}, 1.0, np.inf, 1.0),
        (ELLIPTIC_CYLINDER | {"direction": [0, 0, 1]}, 1.0, 5.0 / 4.0, None),
    ],
)
def test_the_tightest_bend_in_closed_form(table: Table, sign: float, curvature: float, u: float | None) -> None:
    found = tightest(strip(table), sign)
    assert found is not None
    assert found.curvature == curvature or abs(found.curvature / curvature - 1.0) < 1e-13
    assert u is None or found.u == u
    assert tightest(strip(table), -sign) is None


def test_both_ways_of_a_surface_with_an_inflection_have_their_tightest_place() -> None:
    (patch,) = patches(EXAMPLE_2_CYLINDER)
    v = np.linspace(0.0, 1.0, 20001)
    _, slope, bend = patch.c0.jet(v, 2)
    signed = cross2(slope[:, :2], bend[:, :2]) / norm(slope) ** 3
    for sign in (1.0, -1.0):
        found = tightest(strip(EXAMPLE_2_CYLINDER), sign)
        assert found is not None
        best = float((sign * signed).max())
        assert_relative([found.curvature], [best], bound=1e-6, why="20001 places miss the top by their spacing squared")
        assert found.curvature >= best * (1.0 - 1e-14)


# Whatever the surface


@settings(max_examples=10, deadline=None)
@given(motions(), scales(), st.sampled_from([AUMANN_CUBIC, QUINTIC_TANGENT, EXAMPLE_2_CYLINDER]))
def test_a_motion_and_a_scale_leave_the_turning(motion: Motion, factor: Fraction, table: Table) -> None:
    (patch,) = patches(table)
    before, after = turning((patch,)), turning((moved(scaled(patch, factor), motion),))
    for a, b in zip(before.stretches, after.stretches, strict=True):
        assert_near(b.angle_rad, a.angle_rad, bound=1e-12, why="1e-14 of rates of up to 30")
        assert_near([b.low, b.high], [a.low, a.high], bound=1e-9, why="a root where the rate is flat")


@pytest.mark.parametrize("table", [AUMANN_CUBIC, EXAMPLE_2_CYLINDER])
def test_run_backwards_it_bends_as_far_the_other_way(table: Table) -> None:
    """Reversed, p x c0' looks to the other side."""
    (patch,) = patches(table)
    back = RuledPatch(*(_Backwards(curve) for curve in (patch.c0, patch.c1, patch.p)))
    forward, reverse = strip(table).stretches, turning((back,)).stretches[::-1]
    made = [-stretch.angle_rad for stretch in reverse]
    assert_near(made, [stretch.angle_rad for stretch in forward], bound=1e-12, why="1e-14 of rates of up to 30")


class _Backwards:
    def __init__(self, curve) -> None:  # type: ignore[no-untyped-def]
        self.curve = curve

    def jet(self, v: Values, order: int) -> np.ndarray:
        signs = np.array([(-1.0) ** k for k in range(order + 1)])[:, None, None]
        return signs * self.curve.jet(1.0 - v, order)
