"""Nearest places: feet of points beside surfaces are found, and all that are as near."""

from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.arrays import EPS, Vector3, norm, unit
from stages.geometry.curves.curves import Bezier, Circular, bezier, exactly
from stages.geometry.ruled.nearest import nearest, nearest_within, rivals
from stages.geometry.ruled.ruled import RuledPatch, between
from stages.geometry.ruled.strip import Strip, jet, points, size
from tests.near import assert_near
from tests.parts import (
    AUMANN_CUBIC,
    ELLIPTIC_CYLINDER,
    EXAMPLE_1,
    MITRED_CYLINDER,
    OBLIQUE_CONE,
    QUINTIC_TANGENT,
    RIGHT_FRUSTUM,
    Table,
    patches,
)

PARTS: dict[str, Table] = {
    "tangent surface": QUINTIC_TANGENT, "oblique cone": OBLIQUE_CONE, "frustum": RIGHT_FRUSTUM, "bezier pair":
    AUMANN_CUBIC, "mitred cylinder": MITRED_CYLINDER, "elliptic cylinder": ELLIPTIC_CYLINDER, "example 1": EXAMPLE_1,
}  # fmt: skip
STRIPS = {name: Strip(patches(table), np.arange(len(patches(table)) + 1.0)) for name, table in PARTS.items()}
TUBE = Circular(np.zeros(3), np.array([40.0, 0, 0]), np.array([0, 40.0, 0]), np.zeros(3), 0.0, 2.0 * pi)


def tube(height: float = 100.0) -> Strip:
    """Return a closed cylinder of radius 40 about z, its seam at +x."""
    top = Circular(np.array([0, 0, height]), TUBE.U, TUBE.V, TUBE.W, 0.0, TUBE.sweep)
    return Strip((between(TUBE, top),), np.array([0.0, 1.0]))


def beside(strip: Strip, u: float, v: float, away: float) -> tuple[Vector3, Vector3]:
    """Return a point of the strip, and the point `away` mm from it along the normal."""
    found = jet(strip, np.array([u]), np.array([v]))
    return found.s[0], (found.s + away * unit(np.cross(found.s_u, found.s_v)))[0]


def moved(curve: Bezier, matrix: np.ndarray, shift: np.ndarray) -> Bezier:
    return bezier([exactly(row) for row in curve.points @ matrix.T + shift])


@pytest.mark.parametrize("name", PARTS)
@settings(max_examples=15, deadline=None)
@given(u=st.floats(0.01, 0.99), share=st.floats(0.01, 0.99), away=st.floats(-1e-4, 1e-4))
def test_a_point_beside_the_surface_is_pulled_back_to_its_foot(name: str, u: float, share: float, away: float) -> None:
    strip = STRIPS[name]
    scale = size(strip)
    foot, point = beside(strip, u, share * strip.knots[-1], away * scale)
    found = nearest(strip, point)
    on_surface = points(strip, found.place[:1], found.place[1:])[0]
    assert_near(on_surface, foot, bound=1e-12 * scale, why="the slope is bisected to its rounding")
    assert_near(found.distance_mm, abs(away) * scale, bound=1e-13 * scale, why="one subtraction at that place")


@settings(max_examples=7, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_no_place_of_the_surface_is_nearer_to_any_point_of_space(seed: int) -> None:
    """The second method is a plain search on a grid: a grid point is nowhere nearer, and somewhere hardly farther."""
    rng = np.random.default_rng(seed)
    strip = STRIPS[sorted(PARTS)[seed % len(PARTS)]]
    scale = size(strip)
    middle = points(strip, np.array([0.5]), np.array([strip.knots[-1] / 2.0]))[0]
    point = middle + scale * rng.uniform(-1.0, 1.0, 3)
    u, v = np.meshgrid(np.linspace(0.0, 1.0, 21), np.linspace(0.0, strip.knots[-1], 1001))
    least = float(norm(points(strip, u.ravel(), v.ravel()) - point).min())
    found = nearest(strip, point).distance_mm
    assert found <= least + 8 * EPS * scale
    # half a step of the grid along and across, as distances on the surface
    corners = points(strip, u.ravel(), v.ravel()).reshape(*u.shape, 3)
    step = norm(np.diff(corners, axis=0)).max() + norm(np.diff(corners, axis=1)).max()
    assert found >= least - step / 2.0


@pytest.mark.parametrize("factor", [1e-2, 1.0, 1e2])
def test_the_place_moves_and_grows_with_the_surface(factor: float) -> None:
    (patch,) = patches(QUINTIC_TANGENT)
    turn = np.linalg.qr(np.array([[1.0, 2.0, 0.5], [-1.0, 0.3, 2.0], [0.2, 1.0, -1.0]]))[0]
    shift = factor * np.array([310.0, -77.0, 41.0])
    assert isinstance(patch.c0, Bezier) and isinstance(patch.c1, Bezier)
    other: RuledPatch = between(moved(patch.c0, factor * turn, shift), moved(patch.c1, factor * turn, shift))
    strip, again = Strip((patch,), np.array([0.0, 1.0])), Strip((other,), np.array([0.0, 1.0]))
    _, point = beside(strip, 0.4, 0.7, 3.0)
    place = nearest(strip, point).place
    there = nearest(again, factor * turn @ point + shift)
    assert_near(there.place, place, bound=1e-12, why="rounding of the motion: 1e-15 of the size, in shares of it")
    assert_near(there.distance_mm / factor, 3.0, bound=1e-11, why="as above, 1000 mm and 3 mm")


@settings(max_examples=25, deadline=None)
@given(angle=st.floats(0.05, 2.0 * pi - 0.05), z=st.floats(1.0, 99.0), radius=st.floats(5.0, 90.0))
def test_on_a_cylinder_the_place_is_the_angle_and_the_height(angle: float, z: float, radius: float) -> None:
    point = np.array([radius * np.cos(angle), radius * np.sin(angle), z])
    found = nearest(tube(), point)
    assert_near(found.place, [z / 100.0, angle / (2.0 * pi)], bound=1e-14, why="closed form, one arctan away")
    assert_near(found.distance_mm, abs(radius - 40.0), bound=1e-13, why="closed form")


def test_a_point_beyond_the_edge_belongs_to_the_edge() -> None:
    found = nearest(tube(), np.array([0.0, 43.0, 104.0]))
    assert_near(found.place, [1.0, 0.25], bound=1e-15, why="closed form")
    assert_near(found.distance_mm, 5.0, bound=1e-14, why="3, 4, 5")


def test_two_places_equally_near_are_both_told() -> None:
    strip = tube()
    seam = nearest(strip, np.array([40.0, 0.0, 30.0]))
    assert_near(np.sort(np.append(seam.place[1], rivals(strip, seam)[:, 1])), [0.0, 1.0], bound=0.0, why="both ends")
    assert len(rivals(strip, nearest(strip, np.array([0.0, 0.0, 30.0])))) > 0
    assert len(rivals(strip, nearest(strip, np.array([39.9, 1.0, 30.0])))) == 0


def test_the_rulings_of_an_apex_are_one_place() -> None:
    cone = Strip(patches(OBLIQUE_CONE | {"fraction": [0, 1]}), np.array([0.0, 1.0]))
    found = nearest(cone, np.array([1.5, 0.5, 4.0]))
    assert_near([found.place[0], found.distance_mm], [1.0, 0.0], bound=1e-15, why="the apex is c1")
    assert len(rivals(cone, found)) == 0


def test_a_joint_is_one_place() -> None:
    c0, c1 = tube().patches[0].c0, tube().patches[0].c1
    assert isinstance(c0, Circular) and isinstance(c1, Circular)
    halves = [
        between(*(Circular(c.centre, c.U, c.V, c.W, start, pi) for c in (c0, c1))) for start in (0.0, pi)
    ]  # fmt: skip
    strip = Strip(tuple(halves), np.array([0.0, 1.0, 2.0]))
    found = nearest(strip, np.array([-40.5, 0.0, 30.0]))
    assert_near(found.place, [0.3, 1.0], bound=1e-14, why="closed form")
    assert len(rivals(strip, found)) == 0


@pytest.mark.parametrize("name", PARTS)
def test_within_an_interval_about_it_the_place_is_found_again(name: str) -> None:
    """One point and interval each, all at a time; beyond an edge, the place on the edge."""
    strip = STRIPS[name]
    scale, last = size(strip), strip.knots[-1]
    every = np.array([beside(strip, u, v * last, 1e-3 * scale)[1] for u, v in ((0.2, 0.3), (0.5, 0.7), (0.9, 0.1))])
    places = np.array([nearest(strip, point).place for point in every])
    low, high = np.clip(places[:, 1] - 1e-2, 0.0, last), np.clip(places[:, 1] + 2e-2, 0.0, last)
    found = nearest_within(strip, every, low, high, 40)
    assert_near(points(strip, *found.T), points(strip, *places.T), bound=1e-12 * scale, why="2^-40 of 3e-2 of v")
