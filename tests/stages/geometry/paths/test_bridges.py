"""The narrowest webs: closed forms, a second method by dense points, invariances, corners that are no webs."""

from math import radians, tan

import numpy as np
import pytest
from scipy.spatial import cKDTree

from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, along, backwards, transform
from stages.geometry.paths.bridges import webs
from tests.near import assert_near
from tests.stages.geometry.paths.test_beside import ANGLE, CIRCLE, SQUARE, notched, polygon

EXACT = 1e-12
BONE = polygon(
    *((0.0, 0.0), (10.0, 0.0), (10.0, 4.0), (20.0, 4.0), (20.0, 0.0), (30.0, 0.0)),
    *((30.0, 10.0), (20.0, 10.0), (20.0, 6.0), (10.0, 6.0), (10.0, 10.0), (0.0, 10.0)),
)
WAISTED = ArcPath(
    np.array([[0.0, 0], [8, 0], [12, 0], [20, 0], [20, 6], [12, 6], [8, 6], [0, 6]]),
    np.array([0.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0]),
    closed=True,
)
"""A bar 6 high with two half circles of radius 2 cut into it."""


def test_a_neck_between_two_notches() -> None:
    (neck,) = webs([BONE], within=5.0)
    assert (neck.first, neck.second) == (0, 0)
    assert_near(neck.width_mm, 2.0, bound=EXACT, why="closed form")
    assert_near([neck.at[1], neck.to[1]], [4.0, 6.0], bound=EXACT, why="both sides of the neck")


def test_between_two_arcs_the_web_is_on_their_common_normal() -> None:
    (waist,) = webs([WAISTED], within=5.0)
    assert_near(waist.width_mm, 2.0, bound=EXACT, why="6 less twice 2")
    assert_near([*waist.at, *waist.to], [10.0, 2.0, 10.0, 4.0], bound=EXACT, why="closed form")


def test_a_narrow_ring_is_as_wide_everywhere_and_told_amid() -> None:
    bulge = tan(radians(90.0) / 4.0)
    ring = ArcPath(np.array([[10.0, 0], [0, 10], [0, 9.5], [9.5, 0]]), np.array([bulge, 0, -bulge, 0]), closed=True)
    (web,) = webs([ring], within=1.0)
    assert_near(web.width_mm, 0.5, bound=EXACT, why="radii 10 and 9.5")
    assert_near(np.hypot(*web.at) - np.hypot(*web.to), 0.5, bound=EXACT, why="along a radius")


def test_between_a_hole_and_the_outline_both_places_are_told() -> None:
    hole = backwards(transform(CIRCLE, Rigid2(20.0, 6.5)))
    plate = polygon((0.0, 0.0), (40.0, 0.0), (40.0, 40.0), (0.0, 40.0))
    (web,) = webs([plate, hole], within=3.0)
    assert (web.first, web.second) == (0, 1)
    assert_near([*web.at, *web.to, web.width_mm], [20.0, 0.0, 20.0, 1.5, 1.5], bound=EXACT, why="closed form")


def test_corners_are_no_webs_and_slots_are_no_material() -> None:
    assert webs([polygon((0.0, 0.0), (10.0, 0.0), (0.0, 1.0))], within=3.0) == []
    assert webs([notched(0.4)], within=2.0) == []


def test_a_square_is_as_wide_as_its_side() -> None:
    assert webs([SQUARE], within=9.9) == []
    (whole,) = webs([SQUARE], within=10.1)
    assert_near(whole.width_mm, 10.0, bound=EXACT, why="side to side")


@pytest.mark.parametrize(
    "motion", [Rigid2(3.0, -8.0, 71.0), Rigid2(0.0, 0.0, 90.0), Rigid2(1.0, 2.0, 33.0, mirrored=True)]
)
@pytest.mark.parametrize("path", [BONE, WAISTED, ANGLE], ids=["bone", "waisted", "angle"])
def test_the_width_moves_with_the_part(path: ArcPath, motion: Rigid2) -> None:
    found, moved = webs([path], within=7.0), webs([transform(path, motion)], within=7.0)
    assert_near([one.width_mm for one in moved], [one.width_mm for one in found], bound=EXACT, why="rounding at 30 mm")


@pytest.mark.parametrize("seed", range(6))
def test_dense_points_find_no_narrower_web(seed: int) -> None:
    """Two wavy sides: the least distance of points on both is the web, to the square of their spacing."""
    rng = np.random.default_rng(seed)
    x = np.linspace(0.0, 60.0, 13)
    low = np.stack([x, rng.uniform(-2.0, 0.0, 13)], axis=1)
    high = np.stack([x[::-1], rng.uniform(6.0, 8.0, 13)], axis=1)
    bulges = np.concatenate([rng.uniform(-0.15, 0.15, 12), [0.0], rng.uniform(-0.15, 0.15, 12), [0.0]])
    path = ArcPath(np.concatenate([low, high]), bulges, closed=True)
    (web,) = webs([path], within=9.0)
    pieces, shares = np.repeat(np.arange(12), 400), np.tile(np.linspace(0.0, 1.0, 400), 12)
    below, above = along(path, pieces, shares), along(path, pieces + 13, shares)
    least = float(cKDTree(below).query(above)[0].min())
    assert_near(web.width_mm, least, bound=2e-4, why="points 0.0125 mm apart, curvature under 1/4 mm, webs over 4 mm")
    assert web.width_mm <= least
