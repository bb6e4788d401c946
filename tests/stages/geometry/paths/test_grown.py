"""Closed paths moved to their right, piece by piece."""

from math import pi, radians, tan

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import LineString, Polygon

from stages.geometry.paths import arcpath
from stages.geometry.paths.arcpath import ArcPath, area, length
from stages.geometry.paths.biarc import trace
from stages.geometry.paths.grown import grown
from tests.near import assert_near
from tests.stages.geometry.plane_curves import ELLIPSE, TAU, Formula, stroked

SHIFT = 0.25


def polygon(*corners: tuple[float, float]) -> ArcPath:
    return ArcPath(np.array(corners), np.zeros(len(corners)), closed=True)


def moved(path: ArcPath, shifts: float | list[float]) -> ArcPath:
    found = grown(path, np.broadcast_to(np.asarray(shifts, dtype=float), path.bulges.shape).copy())
    assert found is not None
    return found


def test_corners_of_a_square_stay_corners() -> None:
    found = moved(polygon((0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)), SHIFT)
    wanted = [[-0.25, -0.25], [10.25, -0.25], [10.25, 10.25], [-0.25, 10.25]]
    assert_near(found.vertices, wanted, bound=1e-14, why="closed form, a few roundings of numbers of 10")


def test_a_side_that_does_not_move_is_run_on_or_cut_where_its_neighbours_move() -> None:
    notched = polygon((0.0, 0.0), (10.0, 0.0), (10.0, 4.0), (6.0, 4.0), (6.0, 8.0), (0.0, 8.0))
    found = moved(notched, [0.0, SHIFT, 0.0, 0.0, 0.0, 0.0])
    wanted = [[0.0, 0.0], [10.25, 0.0], [10.25, 4.0], [6.0, 4.0], [6.0, 8.0], [0.0, 8.0]]
    assert_near(found.vertices, wanted, bound=1e-14, why="closed form, a few roundings of numbers of 10")


@pytest.mark.parametrize(("sense", "radius"), [(1.0, 5.25), (-1.0, 4.75)])
def test_a_circle_keeps_its_centre_and_grows_or_as_a_hole_shrinks(sense: float, radius: float) -> None:
    circle = ArcPath(np.array([[6.0, 2.0], [-4.0, 2.0]]), sense * np.ones(2), closed=True)
    found = moved(circle, SHIFT)
    assert_near(arcpath.radii(found), [radius, radius], bound=1e-14, why="closed form")
    assert_near(arcpath.centres(found), [[1.0, 2.0]] * 2, bound=1e-14, why="closed form")


def test_a_smooth_convex_path_grows_as_steiner_says() -> None:
    """Area by length times shift and pi times its square, length by 2 pi times the shift."""
    path = trace([ELLIPSE], accuracy=0.02)
    found = moved(path, SHIFT)
    turned = np.abs(arcpath.joint_turns(path)).sum()
    # where joints turn by t the length is off by SHIFT t^3 / 12, and there are 30
    assert turned < 1e-6
    assert_near(length(found), length(path) + TAU * SHIFT, bound=1e-9, why="sums of 30 lengths, smooth joints")
    assert_near(
        area(found), area(path) + SHIFT * length(path) + pi * SHIFT**2, bound=1e-7, why="the same of areas of 15708"
    )
    assert np.degrees(np.abs(arcpath.joint_turns(found)).max()) < 1e-6


def test_pieces_that_meet_smoothly_move_by_the_largest_of_their_shifts() -> None:
    slot = ArcPath(
        np.array([[0.0, 0.0], [20.0, 0.0], [20.0, 10.0], [0.0, 10.0]]), np.array([0.0, 1.0, 0.0, 1.0]), closed=True
    )
    found = moved(slot, [0.0, 0.0, 0.0, SHIFT])
    assert_near(found.vertices[:, 1], [-0.25, -0.25, 10.25, 10.25], bound=1e-14, why="closed form")
    assert_near(found.bulges, [0.0, 1.0, 0.0, 1.0], bound=1e-14, why="half circles stay half circles")


def test_an_arc_and_a_line_that_meet_at_a_corner_cross() -> None:
    """A half disc of radius 10: only its arc moves; it meets the line of its diameter at the new radius."""
    half = ArcPath(np.array([[-10.0, 0.0], [10.0, 0.0]]), np.array([0.0, 1.0]), closed=True)
    found = moved(half, [0.0, SHIFT])
    assert_near(found.vertices, [[-10.25, 0.0], [10.25, 0.0]], bound=1e-13, why="closed form")
    assert_near(found.bulges, [0.0, 1.0], bound=1e-13, why="the same sweep")


def test_a_sharp_corner_moves_far() -> None:
    wide = 100.0 * tan(radians(5.0))
    needle = polygon((0.0, 0.0), (100.0, -wide), (100.0, wide))
    found = moved(needle, SHIFT)
    assert_near(found.vertices[0], [-SHIFT / np.sin(radians(5.0)), 0.0], bound=1e-12, why="closed form")


@pytest.mark.parametrize(
    "path",
    [
        # an arc bends to the right about a centre nearer than the shift
        ArcPath(
            np.array([[0.0, 0.0], [0.2, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]]),
            np.array([-1.0, 0.0, 0.0, 0.0, 0.0]),
            closed=True,
        ),
        # the bottom of a notch is as wide as two shifts
        polygon((0.0, 0.0), (9.9, 0.0), (9.9, 5.0), (10.1, 5.0), (10.1, 0.0), (20.0, 0.0), (20.0, 9.0), (0.0, 9.0)),
    ],
)
def test_a_piece_that_is_used_up_is_said(path: ArcPath) -> None:
    assert grown(path, np.full(path.bulges.size, SHIFT)) is None


@settings(max_examples=30, deadline=None)
@given(
    st.lists(st.floats(0.6, 1.6), min_size=5, max_size=9),
    st.lists(st.floats(-0.25, 0.25), min_size=9, max_size=9),
    st.lists(st.sampled_from([0.0, 0.01, 0.03]), min_size=9, max_size=9),
)
def test_nothing_is_lost_and_every_piece_is_as_far_out_as_asked(
    reach: list[float], bulges: list[float], shifts: list[float]
) -> None:
    """A star of lines and arcs: by polygons of both, without any formula of the code under test."""
    count = len(reach)
    spokes = 50.0 * np.array(reach) * np.exp(1j * TAU * np.arange(count) / count)
    path = ArcPath(np.stack([spokes.real, spokes.imag], axis=1), np.array(bulges[:count]), closed=True)
    before = stroked(path, 200)
    found = grown(path, np.array(shifts[:count]))
    if found is None or not Polygon(before).is_valid:
        return
    after = Polygon(stroked(found, 200))
    # 200 chords of an arc of at most 160 mm and 60 degrees are 5e-4 mm off it
    assert Polygon(before).difference(after.buffer(1e-3)).area < 1e-6
    for piece, shift in enumerate(shifts[:count]):
        part = LineString(before[200 * piece + 60 : 200 * piece + 141])
        assert after.exterior.distance(part) >= min(shift, 0.0) - 1e-3
        if shift > 0.0:
            assert after.contains(part)
            assert after.exterior.distance(part) >= shift - 1e-3


def test_the_path_of_a_formula_has_as_many_pieces_as_before() -> None:
    lens = Formula(
        lambda t: 80.0 * np.cos(TAU * t) + 30j * np.sin(TAU * t) ** 3,
        lambda t: TAU * (-80.0 * np.sin(TAU * t) + 90j * np.sin(TAU * t) ** 2 * np.cos(TAU * t)),
    )
    path = trace([lens], accuracy=0.1)
    assert moved(path, 1e-3).bulges.size == path.bulges.size
