"""Area covered too often: closed forms, invariance, a second method, and that each ingredient is needed."""

from itertools import pairwise
from math import ceil, pi, tan

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.arrays import EPS
from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, area, backwards, polygon, transform
from stages.geometry.paths.cover import COINCIDENT, doubled, windings
from tests.near import assert_near, assert_relative


def ring(*corners: tuple[float, float]) -> ArcPath:
    return ArcPath(np.array(corners), np.zeros(len(corners)), closed=True)


def sector(inner: float, outer: float, sweep: float) -> ArcPath:
    """An annulus sector that may go round more than once."""
    count = max(ceil(sweep / 3.0), 1)
    t = np.linspace(0.0, sweep, count + 1)
    out = np.stack([np.cos(t), np.sin(t)], axis=1)
    bulges = np.full(count, tan(sweep / count / 4.0))
    vertices = np.vstack([inner * out[:1], outer * out, inner * out[:0:-1]])
    return ArcPath(vertices, np.concatenate([[0.0], bulges, [0.0], -bulges]), closed=True)


SQUARE = ((0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0))
INNER = ((1.0, 1.0), (3.0, 1.0), (3.0, 3.0), (1.0, 3.0))
CASES: dict[str, tuple[ArcPath, float]] = {
    "a square": (ring(*SQUARE), 0.0),
    "a square with a square in it again": (ring(*SQUARE, (0.0, 0.0), *INNER, (1.0, 1.0)), 4.0),
    "and a third time": (ring(*SQUARE, (0.0, 0.0), *INNER, *INNER, (1.0, 1.0)), 8.0),
    "a square with a hole by a slit": (ring(*SQUARE, (0.0, 0.0), INNER[0], *INNER[:0:-1], (1.0, 1.0)), 0.0),
    "a bow, one lobe inside out": (ring((0.0, 0.0), (6.0, 6.0), (6.0, 0.0), (0.0, 6.0)), 9.0),
    "a spike that goes and comes back": (ring((0.0, 0.0), (4.0, 0.0), (9.0, 0.0), (4.0, 0.0), (4.0, 4.0)), 0.0),
    "two lobes that touch in a corner": (
        ring((0.0, 0.0), (4.0, 0.0), (2.0, 2.0), (4.0, 4.0), (0.0, 4.0), (2.0, 2.0)), 0.0),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_polygons_with_a_closed_form(name: str) -> None:
    path, expected = CASES[name]
    assert_near(doubled(path), expected, bound=64 * EPS * 81, why="sums of areas of up to 81 mm2")


@pytest.mark.parametrize("inner", [0.5, 50.0, 99.9])
@pytest.mark.parametrize("degrees", [30, 180, 359.9, 360, 360.001, 420, 500, 720, 720.5, 1080, 1499])
def test_a_sector_covers_twice_what_goes_beyond_each_full_turn(degrees: float, inner: float) -> None:
    """Up to a full turn nothing; at 720 and 1080 deg every turn lies exactly on the one before."""
    sweep = float(np.radians(degrees))
    expected = (100.0**2 - inner**2) / 2.0 * max(sweep - 2 * pi, 0.0)
    found = doubled(sector(inner, 100.0, sweep))
    assert_near(found, expected, bound=256 * EPS * 1e4 * max(sweep, 1.0), why="some 100 sums of sectors of 1e4 mm2")
    if degrees <= 360:
        assert found == 0.0


def test_a_disc_across_a_disc_counts_the_lens() -> None:
    """A figure of two circles of radius 1, 1 apart, run through as one closed path: both cover the lens."""
    t = np.array([0.0, 0.5, 1.0, 1.5]) * pi
    circle = np.stack([np.cos(t), np.sin(t)], axis=1)
    beside = circle + np.array([1.0, 0.0])
    bulges = np.full(4, tan(pi / 8))
    vertices = np.vstack([circle, circle[:1], beside, beside[:1]])
    path = ArcPath(vertices, np.concatenate([bulges, [0.0], bulges, [0.0]]), closed=True)
    lens = 2 * pi / 3 - 3**0.5 / 2
    assert_near(doubled(path), lens, bound=64 * EPS * 4, why="the lens of two unit circles; areas of up to 4 mm2")


@pytest.mark.parametrize("share", [1e-4, 1e-6, 2e-7])
def test_a_thin_overlap_is_measured(share: float) -> None:
    """Down to some times what counts as coincident: the sliver is 1e-5 mm wide at the inner edge."""
    sweep = 2 * pi + share
    expected = 0.5 * (100.0**2 - 50.0**2) * share
    found = doubled(sector(50.0, 100.0, sweep))
    assert_relative(found, expected, bound=1e-15 * 1e4 / share / 3750 + 4 * COINCIDENT, why="rounding of 1e4 mm2")


def test_windings_are_those_that_every_piece_taken_by_itself_adds_up_to() -> None:
    """Second method: the angle that the path turns by about a point, over the chords of a fine polygon."""
    path = sector(30.0, 100.0, 9.0)
    fine = polygon(path, accuracy=1e-3)
    points = np.random.default_rng(1).uniform(-110.0, 110.0, (700, 2))
    arms = (fine - points[:, None]) @ np.array([1.0, 1.0j])
    turned = np.angle(np.roll(arms, -1, axis=1) / arms).sum(axis=1) / (2.0 * pi)
    clear = np.abs(np.hypot(*points.T)[:, None] - [30.0, 100.0]).min(axis=1) > 1e-2
    assert {*windings(path, points)[clear].tolist()} == {0.0, 1.0, 2.0}
    assert (windings(path, points)[clear] == np.round(turned)[clear]).all()


@settings(max_examples=25, deadline=None)
@given(st.floats(400, 1300), st.floats(0, 360), st.floats(-1e3, 1e3), st.booleans(), st.floats(1e-2, 1e3))
def test_nothing_changes_by_motion_and_reversal_and_scale_acts_twice(
    degrees: float, angle: float, shift: float, mirrored: bool, scale: float
) -> None:
    plain = sector(30.0, 100.0, float(np.radians(degrees)))
    expected = doubled(plain)
    moved = transform(plain, Rigid2(shift, -shift, angle, mirrored))
    bound = 1e4 * EPS * (1e3 + 100.0) * 100.0
    assert_near(doubled(moved), expected, bound=bound, why="vertices 1e3 mm away are rounded by 1e3 EPS")
    assert_near(doubled(backwards(plain)), expected, bound=bound, why="the same pieces the other way")
    scaled = ArcPath(plain.vertices * scale, plain.bulges, closed=True)
    assert_relative(doubled(scaled), expected * scale**2, bound=1e-9, why="the same figure")


@settings(max_examples=40, deadline=None)
@given(st.lists(st.tuples(st.integers(-50, 50), st.integers(-50, 50)), min_size=3, max_size=9, unique=True),
       st.lists(st.sampled_from([-0.6, -0.2, 0.0, 0.0, 0.15, 0.9]), min_size=9, max_size=9))  # fmt: skip
def test_a_random_tangle_agrees_with_its_polygon(corners: list[tuple[int, int]], bends: list[float]) -> None:
    """Second method: a fine polygon, noded, each face by the winding number of its middle summed from angles."""
    path = ArcPath(np.array(corners, dtype=float), np.array(bends[: len(corners)]), closed=True)
    sense = 1.0 if area(path) >= 0.0 else -1.0
    fine = polygon(path, accuracy=1e-3)
    lines = [shapely.LineString(pair) for pair in pairwise([*fine.tolist(), fine[0].tolist()]) if pair[0] != pair[1]]
    faces = shapely.polygonize([shapely.node(shapely.MultiLineString(lines))]).geoms
    expected = 0.0
    for face in faces:
        inside = face.representative_point()
        arms = (fine - [inside.x, inside.y]) @ [1.0, 1.0j]
        winding = sense * round(float(np.angle(np.roll(arms, -1) / arms).sum() / (2 * pi)))
        expected += face.area * max(winding - 1, -winding, 0)
    length = float(np.abs(np.diff(fine, axis=0, append=fine[:1])).sum())
    assert_near(doubled(path), expected, bound=1e-3 * 9 * length + 1e-6, why="9 covers, each outline within 1e-3 mm")


def test_winding_numbers_of_an_arc_and_its_chord() -> None:
    half = ArcPath(np.array([[1.0, 0.0], [-1.0, 0.0]]), np.array([1.0, 0.0]), closed=True)
    at = np.array([[0.0, 0.5], [0.0, -0.5], [0.0, 1.5], [0.9, 0.9], [0.0, 0.999999], [0.0, 1.000001]])
    assert windings(half, at).tolist() == [1, 0, 0, 0, 1, 0]
    assert windings(backwards(half), at).tolist() == [-1, 0, 0, 0, -1, 0]
