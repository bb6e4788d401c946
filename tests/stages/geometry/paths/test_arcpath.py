from math import cos, pi, radians, sin, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely import Point, Polygon

from stages.geometry.curves.rigid import Rigid2, apply
from stages.geometry.paths import arcpath
from stages.geometry.paths.arcpath import ArcPath
from tests.stages.geometry.plane_curves import stroked

CIRCLE = ArcPath(np.array([[10.0, 0.0], [-10.0, 0.0]]), np.array([1.0, 1.0]), closed=True)
SQUARE = ArcPath(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]), np.zeros(4), closed=True)


@st.composite
def blobs(draw: st.DrawFn) -> ArcPath:
    """Return a closed path around the origin with arcs that swell and arcs that are hollow."""
    count = draw(st.integers(3, 8))
    radius = draw(st.lists(st.floats(20.0, 40.0), min_size=count, max_size=count))
    # lines, and arcs that the centres of `stroked` can still tell from lines
    bulge = draw(st.lists(st.integers(-150, 400).map(lambda b: b / 1000.0), min_size=count, max_size=count))
    angle = 2.0 * pi * np.arange(count) / count
    vertices = np.array(radius)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return ArcPath(vertices, np.array(bulge), closed=True)


def motions() -> st.SearchStrategy[Rigid2]:
    place = st.floats(-1e3, 1e3)
    return st.builds(Rigid2, place, place, st.floats(-360.0, 360.0), st.booleans())


def test_a_circle_of_two_halves_has_the_closed_forms() -> None:
    assert arcpath.length(CIRCLE) == pytest.approx(20.0 * pi, rel=1e-15)
    assert arcpath.area(CIRCLE) == pytest.approx(100.0 * pi, rel=1e-15)
    assert arcpath.bounds(CIRCLE) == pytest.approx((-10.0, -10.0, 10.0, 10.0), abs=1e-14)
    assert np.allclose(arcpath.centres(CIRCLE), 0.0, atol=1e-14)
    assert np.allclose(arcpath.joint_turns(CIRCLE), 0.0, atol=1e-15)


def test_straight_pieces_have_no_centre_and_give_no_warning() -> None:
    assert np.isnan(arcpath.centres(SQUARE)).all()
    assert np.isinf(arcpath.radii(SQUARE)).all()
    assert (arcpath.curvatures(SQUARE) == 0.0).all()
    assert arcpath.area(SQUARE) == 16.0
    assert np.degrees(arcpath.joint_turns(SQUARE)) == pytest.approx([90.0] * 4)


@pytest.mark.parametrize("sweep", [1e-9, 1e-3, 0.0999, 0.1001, 1.0, pi])
def test_the_area_of_a_segment_is_right_on_both_sides_of_the_series(sweep: float) -> None:
    from mpmath import mp, mpf

    with mp.workdps(40):
        a = mpf(sweep)
        exact = float((a - mp.sin(a)) / (8 * mp.sin(a / 2) ** 2))
    segment = ArcPath(np.array([[0.0, 0.0], [1.0, 0.0]]), np.array([np.tan(sweep / 4.0), 0.0]), closed=True)
    assert arcpath.area(segment) == pytest.approx(exact, rel=1e-12)


def test_a_nearly_straight_arc_keeps_its_digits() -> None:
    """Its radius is 2.5e10 m: differences from the centre would be millimetres wrong."""
    arc = ArcPath(np.array([[0.0, 0.0], [100.0, 0.0]]), np.array([1e-12, 0.0]), closed=False)
    assert arcpath.bounds(arc) == pytest.approx((0.0, -5e-11, 100.0, 0.0), abs=1e-15)
    middle = arcpath.along(arc, np.array([0]), np.array([0.5]))
    assert middle[0] == pytest.approx([50.0, -5e-11], abs=1e-13)
    assert arcpath.distances(np.array([[50.0, 1.0]]), arc, np.array([0]))[0] == pytest.approx(1.0, abs=1e-9)


def test_a_piece_of_no_length_is_as_far_away_as_its_place() -> None:
    doubled = ArcPath(np.array([[0.0, 0.0], [3.0, 4.0], [3.0, 4.0], [9.0, 4.0]]), np.zeros(4), closed=False)
    far = arcpath.distances(np.zeros((2, 2)), doubled, np.array([1, 2]))
    assert far == pytest.approx([5.0, 5.0], rel=1e-15)


def test_distances_to_an_arc_are_those_of_its_carrier_or_its_ends() -> None:
    quarter = ArcPath(np.array([[10.0, 0.0], [0.0, 10.0]]), np.array([sqrt(2.0) - 1.0, 0.0]), closed=False)
    points = np.array([[3.0, 4.0], [30.0, 40.0], [10.0, -2.0], [-3.0, 10.0], [-20.0, -20.0]])
    found = arcpath.distances(points, quarter, np.zeros(5, dtype=np.int64))
    assert found == pytest.approx([5.0, 40.0, 2.0, 3.0, np.hypot(20.0, 30.0)], abs=1e-13)


@given(blobs(), st.floats(0.05, 0.5))
def test_splitting_changes_neither_length_nor_area_nor_corners(path: ArcPath, most: float) -> None:
    cut = arcpath.split(path, max_bulge=most)
    assert np.abs(cut.bulges).max() <= most * (1.0 + 1e-9)
    assert arcpath.length(cut) == pytest.approx(arcpath.length(path), rel=1e-13)
    assert arcpath.area(cut) == pytest.approx(arcpath.area(path), rel=1e-13)
    assert {tuple(v) for v in path.vertices} <= {tuple(v) for v in cut.vertices}


def test_splitting_an_open_path_keeps_its_end() -> None:
    half = ArcPath(np.array([[10.0, 0.0], [-10.0, 0.0]]), np.array([1.0, 0.0]), closed=False)
    cut = arcpath.split(half, max_bulge=0.2)
    assert not cut.closed
    assert cut.vertices[-1].tolist() == [-10.0, 0.0]
    assert arcpath.length(cut) == pytest.approx(10.0 * pi, rel=1e-14)


@given(blobs(), motions())
def test_a_motion_changes_neither_length_nor_area(path: ArcPath, motion: Rigid2) -> None:
    moved = arcpath.transform(path, motion)
    assert arcpath.length(moved) == pytest.approx(arcpath.length(path), rel=1e-12)
    assert arcpath.area(moved) == pytest.approx(arcpath.area(path), rel=1e-12)


@given(blobs(), motions())
def test_bounds_are_those_of_many_points(path: ArcPath, motion: Rigid2) -> None:
    moved = arcpath.transform(path, motion)
    points = stroked(moved, 400)
    box = np.array(arcpath.bounds(moved))
    # an arc of radius r rises r (step/2)^2 / 2 between its points
    rise = np.nanmax(np.where(np.isinf(arcpath.radii(moved)), 0.0, arcpath.radii(moved))) * 1e-4
    tight = np.concatenate([points.min(axis=0), points.max(axis=0)])
    assert (box[:2] <= tight[:2] + 1e-9).all()
    assert (box[2:] >= tight[2:] - 1e-9).all()
    assert np.abs(box - tight).max() <= min(rise, 0.1) + 1e-9


@given(blobs())
def test_backwards_twice_is_the_same_path(path: ArcPath) -> None:
    again = arcpath.backwards(arcpath.backwards(path))
    assert (again.vertices == path.vertices).all()
    assert (again.bulges == path.bulges).all()
    assert arcpath.area(arcpath.backwards(path)) == pytest.approx(-arcpath.area(path), rel=1e-13)


@given(blobs(), st.sampled_from([0.5, 0.05, 0.005]))
def test_a_polygon_outside_contains_the_part_and_stays_near(path: ArcPath, accuracy: float) -> None:
    inside = Polygon(stroked(path, 200))
    grown = Polygon(arcpath.polygon(path, accuracy=accuracy, outside=True))
    assert max(grown.distance(Point(p)) for p in inside.exterior.coords) <= 1e-9
    # the farthest points of the polygon are its corners; the strokes themselves are up to 1e-3 short of the arcs
    assert max(inside.distance(Point(p)) for p in grown.exterior.coords) <= accuracy + 1e-3


@given(blobs(), st.sampled_from([0.5, 0.05, 0.005]))
def test_a_polygon_is_as_near_as_it_says(path: ArcPath, accuracy: float) -> None:
    ring = Polygon(arcpath.polygon(path, accuracy=accuracy)).exterior
    far = max(ring.distance(Point(p)) for p in stroked(path, 40))
    assert far <= accuracy * (1.0 + 1e-6)


def test_a_polygon_of_a_circle_takes_no_more_points_than_it_must() -> None:
    step = 2.0 * np.arccos(1.0 - 0.01 / 10.01)
    assert arcpath.polygon(CIRCLE, accuracy=0.01).shape[0] == 2 * np.ceil(pi / step)


def test_a_mirror_turns_the_path_round() -> None:
    arc = ArcPath(np.array([[1.0, 0.0], [0.0, 1.0]]), np.array([0.4, 0.0]), closed=False)
    moved = arcpath.transform(arc, Rigid2(5.0, 1.0, 30.0, mirrored=True))
    assert moved.bulges[0] == 0.4
    ends = apply(Rigid2(5.0, 1.0, 30.0, mirrored=True), arc.vertices)
    assert (moved.vertices == ends[::-1]).all()
    assert ends[0] == pytest.approx([5.0 - cos(radians(30.0)), 1.0 - sin(radians(30.0))])


@pytest.mark.parametrize(
    ("vertices", "bulges", "closed"),
    [
        ([[0.0, 0.0]], [0.0], True),
        ([[0.0, 0.0], [1.0, np.nan]], [0.0, 0.0], True),
        ([[0.0, 0.0], [1.0, 0.0]], [0.0, np.inf], True),
        ([[0.0, 0.0], [1.0, 0.0]], [0.0, 0.1], False),
    ],
)
def test_a_path_that_no_machine_can_follow_is_refused(
    vertices: list[list[float]], bulges: list[float], closed: bool
) -> None:
    with pytest.raises(ValueError, match="path"):
        ArcPath(np.array(vertices), np.array(bulges), closed)
