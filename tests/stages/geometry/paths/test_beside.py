"""The curve beside a contour: areas by Steiner's formula, closed forms at corners, membership of points."""

from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.arrays import Mask, Points2, Values
from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, area, backwards, length, lengths, split, transform
from stages.geometry.paths.beside import Corners, beside, nearest
from stages.geometry.paths.cover import windings
from stages.geometry.paths.overlap import QUARTER_BULGE
from stages.geometry.paths.simple import certainly_simple
from tests.near import assert_near
from tests.stages.write.patterns import sector, strip

ROUNDING = 1e-9
"""Areas of 1e5 mm2 from coordinates that are right to 1e-13."""


def polygon(*corners: tuple[float, float]) -> ArcPath:
    return ArcPath(np.array(corners, dtype=np.float64), np.zeros(len(corners)), closed=True)


SQUARE = polygon((0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0))
ANGLE = polygon((0.0, 0.0), (10.0, 0.0), (10.0, 5.0), (5.0, 5.0), (5.0, 10.0), (0.0, 10.0))
CIRCLE = ArcPath(np.array([[5.0, 0.0], [-5.0, 0.0]]), np.ones(2), closed=True)


def notched(width: float) -> ArcPath:
    """Return a square of 10 with a slot of a width, 7 deep."""
    low, high = 5.0 - width / 2.0, 5.0 + width / 2.0
    return polygon(
        (0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (high, 10.0), (high, 3.0), (low, 3.0), (low, 10.0), (0.0, 10.0)
    )


def test_around_a_square_corners_are_arcs_or_points() -> None:
    (rounded,) = beside(SQUARE, 0.5)
    (mitred,) = beside(SQUARE, 0.5, Corners(mitred=True))
    assert_near(area(rounded), 100.0 + 40.0 * 0.5 + pi * 0.25, bound=1e-12, why="Steiner")
    assert_near(length(rounded), 40.0 + pi, bound=1e-12, why="Steiner")
    assert mitred.bulges.tolist() == [0.0] * 4
    assert_near(np.sort(mitred.vertices[:, 0]), [-0.5, -0.5, 10.5, 10.5], bound=1e-15, why="closed form")


def test_a_corner_sharper_than_a_right_angle_gets_several_tangents() -> None:
    spike = polygon((0.0, 0.0), (10.0, 0.0), (0.0, 2.0))
    (mitred,) = beside(spike, 0.5, Corners(mitred=True))
    away = nearest(mitred.vertices, spike, 2.0)
    assert away.max() <= 0.5 * np.sqrt(2.0) + 1e-12
    assert away.min() >= 0.5 - 1e-12


def test_an_inner_corner_is_cut_where_the_offsets_cross() -> None:
    (rounded,) = beside(ANGLE, 0.5)
    assert_near(area(rounded), 75.0 + 40.0 * 0.5 + 5.0 * pi / 16.0 - 0.25, bound=1e-12, why="five arcs, a corner")
    assert any(np.allclose(vertex, [5.5, 5.5], atol=1e-12) for vertex in rounded.vertices)


def test_a_hole_shrinks_and_vanishes() -> None:
    (inner,) = beside(backwards(CIRCLE), 0.5)
    assert_near(area(inner), -pi * 4.5**2, bound=1e-12, why="closed form")
    assert beside(backwards(CIRCLE), 5.0) == ()
    assert beside(backwards(CIRCLE), 6.0) == ()


def test_a_slot_narrower_than_twice_the_distance_is_passed_by() -> None:
    (into,) = beside(notched(0.4), 0.1)
    assert_near(area(into), 97.2 + 0.1 * 54.0 + 6.0 * pi * 0.01 / 4.0 - 2.0 * 0.01, bound=1e-12, why="Steiner")
    (past,) = beside(notched(0.4), 0.3)
    tip = 0.3 * np.sqrt(1.0 - (2.0 / 3.0) ** 2)
    assert past.vertices[np.abs(past.vertices[:, 0] - 5.0) < 1e-9][:, 1].max() == pytest.approx(10.0 + tip, abs=1e-12)


def test_a_hole_with_a_narrow_neck_falls_into_two() -> None:
    bone = backwards(
        polygon(
            *((0.0, 0.0), (4.0, 0.0), (4.0, 1.8), (6.0, 1.8), (6.0, 0.0), (10.0, 0.0)),
            *((10.0, 4.0), (6.0, 4.0), (6.0, 2.2), (4.0, 2.2), (4.0, 4.0), (0.0, 4.0)),
        )
    )
    assert len(beside(bone, 0.1)) == 1
    assert [round(area(one), 12) < 0.0 for one in beside(bone, 0.5)] == [True, True]


@pytest.mark.parametrize("distance", [0.075, 1.25])
@pytest.mark.parametrize("contour", [strip().outer, sector().outer, strip().inner[0]], ids=["strip", "sector", "hole"])
def test_smooth_contours_follow_steiner(contour: object, distance: float) -> None:
    path: ArcPath = contour.path  # type: ignore[attr-defined]
    (found,) = beside(path, distance)
    sign = 1.0 if area(path) > 0.0 else -1.0
    wanted = abs(area(path)) + sign * length(path) * distance + pi * distance**2
    assert_near(abs(area(found)), wanted, bound=ROUNDING, why="A + L d + pi d^2: no corner points inward")


def test_no_piece_is_too_short_where_curves_meet_at_a_hair() -> None:
    (found,) = beside(strip().outer.path, 1.25, Corners(least_mm=0.05))
    assert lengths(found).min() >= 0.05
    assert_near(
        nearest(found.vertices, strip().outer.path, 5.0), np.full(found.bulges.size, 1.25), bound=1e-6, why="at it"
    )


def test_the_curve_moves_with_its_path() -> None:
    motion = Rigid2(120.0, -35.0, 33.0)
    (here,), (there,) = beside(ANGLE, 0.5), beside(transform(ANGLE, motion), 0.5)
    assert_near(transform(here, motion).vertices, there.vertices, bound=1e-11, why="rounding at 100 mm")


@settings(max_examples=25, deadline=None)
@given(
    st.lists(st.tuples(st.floats(0.3, 1.0), st.floats(3.0, 20.0), st.floats(-0.2, 0.2)), min_size=4, max_size=9),
    st.sampled_from([0.1, 0.5, 1.5]),
    st.integers(0, 2**31),
)
def test_inside_is_what_is_inside_or_nearer(
    corners: list[tuple[float, float, float]], distance: float, seed: int
) -> None:
    """Points are asked by their distance to the path, which knows nothing of offsets."""
    path = star(corners)
    points: Points2 = np.random.default_rng(seed).uniform(-25.0, 25.0, (400, 2))
    held, away = inside(path, points), nearest(points, path, 60.0)
    far = np.abs(away - distance) > 1e-6
    grown = sum((winding(one, points) for one in beside(path, distance)), np.zeros(400))
    shrunk = sum((winding(one, points) for one in beside(backwards(path), distance)), np.zeros(400))
    assert np.array_equal(grown[far] == 1.0, (held | (away < distance))[far])
    assert np.array_equal(shrunk[far] == -1.0, (held & (away > distance))[far])


def star(corners: list[tuple[float, float, float]]) -> ArcPath:
    """Return a path that goes around the origin once and cannot cross itself: angles in steps, radii, flat arcs."""
    steps = np.array([step for step, _, _ in corners])
    angle = np.cumsum(steps) * 2.0 * pi / steps.sum()
    radius = np.array([radius for _, radius, _ in corners])
    points = radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    straight = ArcPath(points, np.zeros(angle.size), closed=True)
    bent = ArcPath(points, np.array([bulge for _, _, bulge in corners]), closed=True)
    return bent if bool(certainly_simple([bent], apart=1e-6)[0]) else straight


def winding(path: ArcPath, points: Points2) -> Values:
    return windings(split(path, max_bulge=QUARTER_BULGE), points)


def inside(path: ArcPath, points: Points2) -> Mask:
    held: Mask = winding(path, points) > 0.0
    return held
