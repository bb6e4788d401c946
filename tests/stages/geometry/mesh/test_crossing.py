"""Crossing triangles: depths in closed form, every pair checked by brute force, and meshes that must stay clean."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.arrays import Points3
from stages.geometry.mesh.crossing import boxes, close_pairs, crossings, morton
from stages.geometry.mesh.mesh import Mesh
from tests.meshes import cylinder, right_cone
from tests.near import assert_near
from tests.tubes import dome, flat, holed, moved, rolled, rotation, together, tube

FINE = 1e-6
PAIR = np.array([[0, 1, 2], [3, 4, 5]])


def pair(other: list[list[float]]) -> Mesh:
    """Return a right triangle with legs of 10 in the plane z = 0, and another one."""
    return Mesh(np.array([[0.0, 0, 0], [10, 0, 0], [0, 10, 0], *other]), PAIR)


@pytest.mark.parametrize("deep", [1e-3, 0.1, 1.0])
def test_a_corner_through_a_face_is_as_deep_as_it_reaches(deep: float) -> None:
    found = crossings(pair([[2, 2, -deep], [2, 2, 5], [3, 2, 5]]), FINE)
    assert (found.faces.tolist(), found.others.tolist()) == ([0], [1])
    assert_near(found.depth_mm, [deep], bound=1e-14, why="along the normal of the first")


@pytest.mark.parametrize("gap", [0.0, 1e-9, 1e-3, 3.0])
def test_a_corner_on_or_above_a_face_does_not_cross(gap: float) -> None:
    assert len(crossings(pair([[2, 2, gap], [2, 2, 5], [3, 2, 5]]), FINE).faces) == 0


def test_two_triangles_in_one_plane_overlap_by_what_they_do() -> None:
    found = crossings(pair([[9, -1, 0], [9, 20, 0], [30, -1, 0]]), FINE)
    assert_near(found.depth_mm, [1.0], bound=1e-14, why="the corner of the one reaches 1 past the side of the other")
    assert len(crossings(pair([[11, 0, 0], [11, 20, 0], [30, 0, 0]]), FINE).faces) == 0
    assert len(crossings(pair([[10, 0, 0], [0, 10, 0], [10, 10, 0]]), FINE).faces) == 0


@settings(max_examples=40)
@given(st.floats(0.01, 3.1))
def test_neighbours_touch_at_whatever_angle_they_meet(angle: float) -> None:
    points = np.array([[0.0, 0, 0], [10, 0, 0], [3, 8, 0], [4, 8 * np.cos(angle), 8 * np.sin(angle)]])
    assert len(crossings(Mesh(points, np.array([[0, 1, 2], [1, 0, 3]])), FINE).faces) == 0


def test_a_neighbour_folded_back_lies_on_its_neighbour() -> None:
    points = np.array([[0.0, 0, 0], [10, 0, 0], [3, 8, 0], [4, 8, 0]])
    assert len(crossings(Mesh(points, np.array([[0, 1, 2], [1, 0, 3]])), FINE).faces) == 1


def test_triangles_that_share_a_corner_cross_only_if_one_goes_through_the_other() -> None:
    through = np.array([[0.0, 0, 0], [10, 0, 0], [0, 10, 0], [4, 4, -2], [4, 4, 2]])
    beside = np.array([[0.0, 0, 0], [10, 0, 0], [0, 10, 0], [-4, -4, -2], [-4, -4, 2]])
    faces = np.array([[0, 1, 2], [0, 3, 4]])
    assert len(crossings(Mesh(through, faces), FINE).faces) == 1
    assert len(crossings(Mesh(beside, faces), FINE).faces) == 0


def meets(mesh: Mesh, one: int, other: int) -> bool:
    """Return whether a side of either triangle goes through the inside of the other: by volumes, for random ones."""
    a, b = mesh.vertices[mesh.faces[one]], mesh.vertices[mesh.faces[other]]
    return any(pierces(p, q, t) for s, t in ((a, b), (b, a)) for p, q in zip(s, np.roll(s, 1, axis=0), strict=True))


def pierces(p: Points3, q: Points3, corners: Points3) -> bool:
    def volume(*four: Points3) -> float:
        return float(np.linalg.det(np.array(four[1:]) - four[0]))

    a, b, c = corners
    if volume(p, a, b, c) * volume(q, a, b, c) >= 0:
        return False
    signs = [volume(p, q, a, b) > 0, volume(p, q, b, c) > 0, volume(p, q, c, a) > 0]
    return all(signs) or not any(signs)


@pytest.mark.parametrize("seed", range(4))
def test_random_triangles_cross_where_a_side_goes_through(seed: int) -> None:
    source = np.random.default_rng(seed)
    corners = source.uniform(0, 10, (60, 1, 3)) + source.uniform(-2, 2, (60, 3, 3))
    mesh = Mesh(corners.reshape(-1, 3), np.arange(180).reshape(-1, 3))
    found = crossings(mesh, 0.0)
    wanted = {(i, j) for i in range(60) for j in range(i + 1, 60) if meets(mesh, i, j)}
    assert wanted
    assert set(zip(found.faces.tolist(), found.others.tolist(), strict=True)) == wanted


@pytest.mark.parametrize("count", [1, 2, 3, 7, 64, 200])
def test_the_tree_finds_every_pair_of_boxes_that_meet_once(count: int) -> None:
    source = np.random.default_rng(count)
    low = source.uniform(0, 10, (count, 3))
    high = low + source.exponential(1.0, (count, 3))
    found = [tuple(sorted(two)) for one, other in close_pairs(low, high) for two in zip(one, other, strict=True)]
    meet = (low[:, None] <= high[None]).all(axis=2) & (low[None] <= high[:, None]).all(axis=2)
    assert len(found) == len(set(found))
    assert set(found) == {(i, j) for i in range(count) for j in range(i + 1, count) if meet[i, j]}


def test_places_on_the_curve_are_those_of_interleaved_bits() -> None:
    side = np.arange(4)
    points = np.stack(np.meshgrid(side, side, side, indexing="ij"), axis=-1).reshape(-1, 3).astype(float)
    top = np.argsort(morton(points))
    halves = (points[top] >= 2) @ [1, 2, 4]
    assert np.array_equal(halves, np.repeat(np.arange(8), 8))


@pytest.mark.parametrize("size", [0.01, 1.0, 100.0])
def test_meshes_of_developables_and_others_do_not_cross_themselves(size: float) -> None:
    for mesh in (
        cylinder(0, 60, 12, size).mesh,
        right_cone(1, 60, 12, size).mesh,
        holed(15, [(0.1, 0.0, 0.4)], flat),
        holed(15, [], dome),
        tube(30, 8, (5.0, 1.0), 3.0),
    ):
        assert len(crossings(mesh, 1e-7 * float(np.ptp(mesh.vertices))).faces) == 0


def test_boxes_hold_their_triangles() -> None:
    mesh = holed(9, [], rolled)
    low, high = boxes(mesh)
    corners = mesh.vertices[mesh.faces]
    assert ((low[:, None] <= corners) & (corners <= high[:, None])).all()


@settings(max_examples=20)
@given(st.integers(0, 2**31), st.floats(0.02, 0.4))
def test_a_sheet_pushed_through_another_is_found_wherever_it_lies(seed: int, deep: float) -> None:
    sheet = holed(11, [], flat)
    upright = moved(sheet, np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]) * 0.3, np.array([0.013, 0.017, 0.3 - deep]))
    both = moved(together(sheet, upright), rotation(seed), np.array([1.0, 2.0, 3.0]))
    apart = moved(
        together(sheet, moved(upright, np.eye(3), np.array([0, 0, deep + 1e-3]))), rotation(seed), np.zeros(3)
    )
    found = crossings(both, 1e-6)
    half = len(sheet.faces)
    assert len(found.faces) >= 3
    assert ((found.faces < half) & (found.others >= half)).all()
    assert len(crossings(apart, 1e-6).faces) == 0
