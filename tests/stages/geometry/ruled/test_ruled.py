"""Warp, curvature and regression of ruled patches: closed forms, and exact evaluation at single rulings."""

from fractions import Fraction
from math import atan, degrees, hypot, pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings

from stages.geometry.arrays import EPS, Array, diagonal, dot, norm, unit
from stages.geometry.curves.curves import Circular, bezier, exactly
from stages.geometry.ruled import ruled
from stages.geometry.ruled.ruled import RuledPatch, between, end_normals, frames
from tests.near import assert_near, assert_relative
from tests.parts import (
    AUMANN_CUBIC,
    AUMANN_FIRST,
    AUMANN_POINTS,
    ELLIPTIC_CYLINDER,
    EXAMPLE_1,
    OBLIQUE_CONE,
    QUINTIC_TANGENT,
    RIGHT_FRUSTUM,
    Table,
    aumann,
    patches,
)
from tests.strategies import different_points, motions, moved, scaled, scales

V = np.linspace(0.0, 1.0, 33)
DEVELOPABLE: dict[str, Table] = {
    "cone": OBLIQUE_CONE, "frustum": RIGHT_FRUSTUM, "cylinder": ELLIPTIC_CYLINDER, "tangent": QUINTIC_TANGENT,
    "aumann": AUMANN_CUBIC, "plane": EXAMPLE_1,
}  # fmt: skip


def saddle(warp_deg: float) -> RuledPatch:
    """Return a square of side 200 whose first and last ruling are turned against each other; warp at the middle."""
    rise = 100.0 * np.tan(np.radians(warp_deg) / 2.0)
    rows = [[(-100.0, -100.0, rise), (100.0, -100.0, -rise)], [(-100.0, 100.0, -rise), (100.0, 100.0, rise)]]
    return between(*(bezier([exactly(point) for point in row]) for row in rows))


@pytest.mark.parametrize("name", DEVELOPABLE)
def test_a_developable_has_no_warp_and_no_curvature(name: str) -> None:
    patch = patches(DEVELOPABLE[name])[0]
    inside = V[1:-1]
    f = frames(patch, inside)
    n0, n1 = end_normals(f)
    weakest = float(np.minimum(norm(n0), norm(n1)).min() / (norm(f.p) * norm(f.c0_d1)).max())
    bound = 32 * EPS / weakest
    assert_near(ruled.warp(patch, inside), 0.0 * inside, bound=bound, why="rounding over the weakest normal")


@pytest.mark.parametrize("warp_deg", [1e-6, 0.1, 10.0, 80.0])
def test_the_warp_of_a_saddle_is_the_angle_it_was_built_with(warp_deg: float) -> None:
    patch = saddle(warp_deg)
    assert_relative(np.degrees(ruled.warp(patch, np.array([0.5]))), [warp_deg], bound=1e-9, why="rise rounded at 1e-6")


def test_the_curvature_of_a_saddle_is_that_of_z_equal_to_a_x_y() -> None:
    rise = 100.0 * np.tan(np.radians(10.0) / 2.0)
    a = rise / 100.0**2
    assert_relative(
        ruled.gaussian(saddle(10.0), np.array([0.5])), [a * a], bound=1e-12, why="K = -a^2 at the middle, -a^2/(1+..)^2"
    )


def test_the_warp_is_half_a_turn_where_the_rulings_cross_the_edge_of_regression() -> None:
    """Aumann with lambda = 1/2: the edge of regression is inside for t in (1/2, 1]."""
    patch = patches(aumann(AUMANN_POINTS, AUMANN_FIRST, "0.5", "2.3"))[0]
    v = np.array([0.25, 0.45, 0.55, 0.9])
    assert_near(ruled.warp(patch, v), [0.0, 0.0, pi, pi], bound=1e-12, why="parallel normals, rounding of 1e-15")
    t, L, M = v, 0.5, 2.3
    assert_relative(ruled.regression(frames(patch, v)), (M - t) / (M - L), bound=1e-12, why="closed form")


def test_parallel_rulings_meet_nowhere() -> None:
    patch = patches(ELLIPTIC_CYLINDER)[0]
    assert np.isinf(ruled.regression(frames(patch, V))).all()
    assert not ruled.turn_rate(frames(patch, V)).any()


def test_the_bending_radius_of_a_cone_grows_along_the_ruling() -> None:
    """Radius rho(u) = r(u) / cos(half angle): 3 and 1.5 over a slant of hypot(1.5, 4) that rises 4."""
    patch, slant = patches(RIGHT_FRUSTUM)[0], hypot(1.5, 4.0)
    for u in (0.0, 0.25, 1.0):
        rho = (3.0 - 1.5 * u) * slant / 4.0
        assert_relative(1.0 / np.abs(ruled.curvature(patch, V, u)), np.full(33, rho), bound=1e-12, why="closed form")


def test_an_apex_bends_without_bound_unless_the_part_is_plane() -> None:
    cone = patches(RIGHT_FRUSTUM | {"radius1": 0})[0]
    swapped = patches(RIGHT_FRUSTUM | {"radius0": 0})[0]
    disc = patches(RIGHT_FRUSTUM | {"radius1": 0, "height": 0})[0]
    assert np.isinf(ruled.curvature(cone, V, 1.0)).all()
    assert np.isinf(ruled.curvature(swapped, V, 0.0)).all()
    assert not ruled.curvature(disc, V, 1.0).any()
    assert np.isfinite(ruled.curvature(cone, V, 0.0)).all()


def test_the_curvature_of_a_tangent_surface_is_torsion_over_curvature_and_distance() -> None:
    """Edge (2 cos t, 2 sin t, t), rulings from 1/2 to 2 along its tangent: kappa = 2/5, tau = 1/5, rho = 2 s."""
    x, y, z = np.eye(3)
    root = sqrt(5.0)

    def rail(s: float) -> Circular:
        return Circular(s / root * z, 2.0 * x + 2.0 * s / root * y, 2.0 * y - 2.0 * s / root * x, z, 0.0, 2.0)

    patch = between(rail(0.5), rail(2.0))
    for u in (0.0, 0.5, 1.0):
        expected = np.full(33, 0.5 / (0.5 + 1.5 * u))
        assert_relative(np.abs(ruled.curvature(patch, V, u)), expected, bound=1e-12, why="closed form")


def test_the_curvature_of_an_elliptic_cylinder_is_that_of_its_right_section() -> None:
    """Rulings along y/2 + z: the section across them is an ellipse of semi-axes 5 and 2 cos(atan(1/2))."""
    b = 2.0 * 2.0 / sqrt(5.0)
    a, t = 5.0, 2.0 * pi * V
    expected = a * b / (a * a * np.sin(t) ** 2 + b * b * np.cos(t) ** 2) ** 1.5
    for u in (0.0, 1.0):
        found = np.abs(ruled.curvature(patches(ELLIPTIC_CYLINDER)[0], V, u))
        assert_relative(found, expected, bound=1e-12, why="closed form")


@settings(max_examples=30)
@given(different_points(4), motions(), scales())
def test_warp_is_the_same_moved_scaled_reversed_and_with_its_edges_exchanged(
    rows: list[tuple[Fraction, ...]], motion: object, factor: Fraction
) -> None:
    patch = between(bezier(rows[:2]), bezier(rows[2:]))
    v = np.linspace(0.1, 0.9, 5)
    f = frames(patch, v)
    n0, n1 = end_normals(f)
    ends = np.maximum(norm(f.c0_d1), norm(f.c1_d1))
    weakest = float((np.minimum(norm(n0), norm(n1)) / (norm(f.p) * ends)).min())
    if weakest < 1e-3:
        return
    bound = 64 * EPS * (1e3 / 0.01) / weakest**2
    expected = ruled.warp(patch, v)
    for other, at in (
        (moved(patch, motion), v),
        (scaled(patch, factor), v),
        (between(bezier(rows[1::-1]), bezier(rows[:1:-1])), 1.0 - v),
        (between(patch.c1, patch.c0), v),
    ):
        assert_near(ruled.warp(other, at), expected, bound=bound, why="points rounded at 1e3, over the normals")


def test_the_shortest_normal_of_a_ruling_lies_on_the_segment_between_its_ends() -> None:
    n0, n1 = np.array([[1.0, 1.0, 0.0]]), np.array([[-1.0, 1.0, 0.0]])
    assert ruled.nearest_to_zero(n0, n1).tolist() == [[0.0, 1.0, 0.0]]
    assert ruled.nearest_to_zero(n0, n0).tolist() == n0.tolist()
    assert ruled.nearest_to_zero(n0, 3.0 * n0).tolist() == n0.tolist()


def test_points_of_a_patch_lie_on_its_rulings_and_a_part_has_the_same_points() -> None:
    patch = patches(QUINTIC_TANGENT)[0]
    half = ruled.part(patch, Fraction(1, 4), Fraction(3, 4))
    u = np.linspace(0.0, 1.0, 33)
    bound = 64 * EPS * 700.0
    assert_near(ruled.at(half, u, V), ruled.at(patch, u, 0.25 + V / 2.0), bound=bound, why="points up to 700 mm")


def test_the_rulings_of_a_part_keep_their_direction_however_short() -> None:
    """Restricted like the directrices: subtracted anew, rulings of 1e-9 mm would be off by 1e-6 rad."""
    pipe: Table = {
        "kind": "cylinder", "directrix": {"circle": {"center": [0, 0, 0], "radius": 10}},
        "direction": ["0.3", "0.2", 1], "end_plane": {"point": [10, 0, 0], "normal": [1, 0, 1]},
    }  # fmt: skip
    patch = patches(pipe)[0]
    beginning = ruled.part(patch, Fraction(0), Fraction(1, 1024))
    near = np.array([1e-3, 1e-2, 0.5, 1.0])
    here, there = beginning.p.jet(near, 1), patch.p.jet(near / 1024.0, 1)
    assert 0.0 < norm(here[0]).min() < 1e-9
    sense = np.sign(here[0][:, 2:])
    assert_near(sense * unit(here[0]), np.tile(unit(np.array([0.3, 0.2, 1.0])), (4, 1)), bound=4 * EPS, why="one unit")
    assert_near(here[0], there[0], bound=64 * EPS * 10.0, why="points of a circle of 10 mm")
    assert_near(here[1] * 1024.0, there[1], bound=64 * EPS * 63.0, why="derivatives of 20 pi mm, by the share")


class Spiral:
    """A curve on the helicoid z = c a that moves outwards as it turns: (r + v) (cos v, sin v, 0) + c v z."""

    def __init__(self, r: float, c: float) -> None:
        self.r, self.c = r, c

    def jet(self, v: Array, order: int) -> Array:
        assert order <= 2
        e = np.stack([np.cos(v), np.sin(v), 0.0 * v], axis=1)
        e_d1 = np.stack([-np.sin(v), np.cos(v), 0.0 * v], axis=1)
        reach, z = (self.r + v)[:, None], np.array([0.0, 0.0, 1.0])
        jets = [reach * e + self.c * v[:, None] * z, e + reach * e_d1 + self.c * z, 2.0 * e_d1 - reach * e]
        return np.stack(jets[: order + 1])


def test_a_minimal_surface_has_no_curvature_across_its_rulings_however_its_edges_run() -> None:
    """On a helicoid the mean curvature is 0, and so is the curvature across the straight rulings."""
    patch = between(Spiral(1.0, 0.5), Spiral(3.0, 0.5))
    for u in (0.0, 0.5, 1.0):
        assert_near(ruled.curvature(patch, V, u), 0.0 * V, bound=1e-13, why="terms of size 1 that cancel")


def test_the_box_of_points_has_their_diagonal() -> None:
    assert diagonal(np.array([[0.0, 0.0, 0.0], [1.0, 2.0, 1.0], [1.0, -0.0, 2.0]])) == 3.0


def test_a_helicoid_has_the_curvature_of_its_closed_form() -> None:
    """S = (r cos a, r sin a, c a), r from 1 to 3: K = -c^2 / (c^2 + r^2)^2, warp = atan(3/c) - atan(1/c)."""
    c, zero, x, y, z = 0.5, np.zeros(3), *np.eye(3)
    rail = [Circular(zero, r * x, r * y, c * z, 0.0, 2.0) for r in (1.0, 3.0)]
    patch = between(*rail)
    assert_relative(ruled.gaussian(patch, V), np.full(33, (c / (c * c + 1.0)) ** 2), bound=1e-13, why="closed form")
    expected = np.full(33, atan(3.0 / c) - atan(1.0 / c))
    assert_relative(ruled.warp(patch, V), expected, bound=1e-13, why="closed form")
    assert degrees(expected[0]) > 10.0
    assert_near(dot(*end_normals(frames(patch, V))).min() > 0, True, bound=0.0, why="no fold")
