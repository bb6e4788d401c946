"""How patches meet along a ruling: gap, angle of the normals, jump of curvature."""

from fractions import Fraction
from math import hypot, pi, radians

import numpy as np
import pytest

from stages.geometry.arrays import EPS
from stages.geometry.curves.curves import Circular
from stages.geometry.ruled.joins import join
from stages.geometry.ruled.ruled import RuledPatch, between, part
from tests.near import assert_near, assert_relative
from tests.parts import EXAMPLE_1, QUINTIC_TANGENT, patches

ZERO, X, Y, Z = np.zeros(3), *np.eye(3)


def pipe(radius: float, sweep: float, *, height: float = 4.0, shift: np.ndarray = ZERO, top: float = 1.0) -> RuledPatch:
    """Return a cylinder about z that ends at the ruling through the origin, leaving along +y or -y; top < 1: a cone."""
    centre = shift - radius * X
    start = 0.0 if sweep > 0 else sweep
    low = Circular(centre, radius * X, radius * Y, ZERO, start, abs(sweep))
    high = Circular(centre + height * Z, top * radius * X, top * radius * Y, ZERO, start, abs(sweep))
    return between(low, high)


def test_a_patch_cut_in_two_meets_itself_with_equal_curvature() -> None:
    patch = patches(QUINTIC_TANGENT)[0]
    met = join(part(patch, Fraction(0), Fraction(1, 3)), part(patch, Fraction(1, 3), Fraction(1)))
    assert_near([met.gap_mm, met.normal_rad], [0.0, 0.0], bound=64 * EPS * 700, why="points up to 700 mm")
    assert met.jump is not None
    assert_near(met.jump, 0.0, bound=1e-13, why="curvatures of 1e-3 per mm to 1e-10 of them")


def test_cylinders_of_unlike_radius_meet_smoothly_with_a_jump_of_curvature() -> None:
    met = join(pipe(10.0, -1.0), pipe(4.0, 1.0))
    assert_near([met.gap_mm, met.normal_rad], [0.0, 0.0], bound=64 * EPS * 10, why="a dozen roundings")
    assert_relative([met.jump], [1 / 4 - 1 / 10], bound=1e-13, why="closed form")


def test_the_worse_end_of_the_ruling_counts_for_the_jump() -> None:
    """A cone of radius r at the foot and r/2 at the top, slant s, height h: curvature h / (r s), double at the top."""
    cone = RuledPatch(
        *(Circular(level * Z - 10.0 * X, r * X, r * Y, ZERO, 0.0, 1.0) for r, level in ((10.0, 0.0), (5.0, 4.0))),
        Circular(4.0 * Z, -5.0 * X, -5.0 * Y, ZERO, 0.0, 1.0),
    )
    same = join(part_before(cone), cone)
    assert same.jump is not None
    assert_near(same.jump, 0.0, bound=1e-13, why="one cone")
    plane_like = join(pipe(1e9, -1e-9), cone)
    steep = 4.0 / hypot(4.0, 5.0)
    assert plane_like.jump is not None
    assert plane_like.jump > 0.99 * steep / 5.0


def part_before(cone: RuledPatch) -> RuledPatch:
    back = [c.replace(start=-1.0) for c in (cone.c0, cone.c1, cone.p) if isinstance(c, Circular)]
    return RuledPatch(*back)


@pytest.mark.parametrize("angle_deg", [0.001, 30.0, 90.0, 179.0])
def test_a_fold_is_the_angle_between_the_normals(angle_deg: float) -> None:
    a = radians(angle_deg)
    turned = np.array([-np.sin(a), np.cos(a), 0.0])
    flat = [Circular(level * Z - Y, ZERO, ZERO, Y, 0.0, 1.0) for level in (0.0, 1.0)]
    tilted = [Circular(level * Z, ZERO, ZERO, turned, 0.0, 1.0) for level in (0.0, 1.0)]
    met = join(between(*flat), between(*tilted))
    assert_near(np.degrees(met.normal_rad), angle_deg, bound=1e-12, why="closed form")
    assert met.jump == 0.0


def test_a_gap_is_measured_at_the_worse_end() -> None:
    met = join(pipe(10.0, -1.0), pipe(10.0, 1.0, shift=0.25 * Z, height=5.0))
    assert_near(met.gap_mm, 1.25, bound=1e-13, why="0.25 below, 1.25 above")


def test_a_jump_is_not_defined_where_the_normal_vanishes() -> None:
    """Theorem 2.1 leaves along its end rulings: no normal there."""
    patch = patches(EXAMPLE_1)[0]
    assert join(patch, patch).jump is None
    assert 0.0 <= join(patch, patch).normal_rad <= pi
