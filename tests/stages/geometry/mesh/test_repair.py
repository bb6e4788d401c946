"""Repair: soups become the meshes that they were made of, planted faults are repaired, named, or left for a refusal."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.arrays import norm
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.repair import ROUNDING, Repair, cracks, heights, repaired, same_position
from stages.geometry.mesh.topology import boundary_loops, edges_of, euler_characteristic
from tests.near import assert_near
from tests.tubes import flat, holed, moved, rolled, rotation, shuffled, soup, tube

DISC = holed(15, [(0.2, 0.1, 0.3)], rolled)


def counts(found: Repair) -> tuple[int, int, int]:
    edges = edges_of(found.mesh)
    return len(found.mesh.vertices), euler_characteristic(found.mesh, edges), len(boundary_loops(found.mesh, edges))


def scaled(mesh: Mesh, factor: float) -> Mesh:
    return Mesh(mesh.vertices * factor, mesh.faces)


@pytest.mark.parametrize("size", [1.0, 100.0, 10_000.0])
@pytest.mark.parametrize("single", [True, False])
def test_a_soup_is_welded_to_the_mesh_that_it_was_made_of(size: float, single: bool) -> None:
    mesh = scaled(DISC, size / 2.8)
    found = repaired(soup(mesh, single=single))
    assert counts(found) == (len(mesh.vertices), 0, 2)
    assert found.merged == 3 * len(mesh.faces) - len(mesh.vertices)
    assert (found.welded, found.duplicates, found.collapsed, found.flat, found.unused) == (0, 0, 0, 0, 0)


def test_trimesh_welds_the_same_vertices() -> None:
    broken = soup(DISC)
    other = trimesh.Trimesh(broken.vertices, broken.faces, process=False)
    other.merge_vertices()
    assert len(other.vertices) == len(repaired(broken).mesh.vertices)


@settings(max_examples=25)
@given(st.integers(0, 2**31), st.floats(0.0, 0.45))
def test_corners_rounded_apart_by_single_precision_are_one(seed: int, share: float) -> None:
    broken = soup(DISC)
    source = np.random.default_rng(seed)
    largest = np.abs(broken.vertices).max()
    moves = source.uniform(-1, 1, broken.vertices.shape) * (share * ROUNDING * largest / np.sqrt(12.0))
    found = repaired(Mesh(broken.vertices + moves, broken.faces))
    assert counts(found) == (len(DISC.vertices), 0, 2)
    assert found.welded_mm <= found.tolerance_mm


def test_corners_further_apart_than_rounding_stay_apart() -> None:
    broken = soup(DISC, single=False)
    points = broken.vertices.copy()
    points[0] += 30.0 * ROUNDING
    found = repaired(Mesh(points, broken.faces))
    assert len(found.mesh.vertices) == len(DISC.vertices) + 1


def test_vertices_inside_the_surface_are_never_welded() -> None:
    points = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 0], [0.5, 0.5, 2e-7]])
    upper = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    lower = np.where(upper == 4, 5, upper)[:, ::-1]
    found = repaired(Mesh(points, np.concatenate([upper, lower])))
    assert found.welded == 0
    assert len(found.mesh.faces) == 8


@settings(max_examples=25)
@given(st.integers(0, 2**31))
def test_order_and_motion_do_not_change_what_is_repaired(seed: int) -> None:
    broken = shuffled(soup(moved(DISC, rotation(seed), np.array([3.0, -2.0, 5.0]))), seed)
    found = repaired(broken)
    assert counts(found) == (len(DISC.vertices), 0, 2)


def test_positions_are_one_exactly_where_all_their_bits_are() -> None:
    points = np.array([[0.0, 1, 2], [-0.0, 1, 2], [0, 1, 2 + 1e-15], [5, 1, 2], [0, 1, 2]])
    assert same_position(points).tolist() == [0, 0, 2, 3, 0]


def test_duplicate_faces_are_dropped_whichever_way_they_run() -> None:
    faces = np.concatenate([DISC.faces, DISC.faces[3:4, [1, 2, 0]], DISC.faces[7:8, ::-1]])
    found = repaired(Mesh(DISC.vertices, faces))
    assert found.duplicates == 2
    assert np.array_equal(found.mesh.faces, repaired(DISC).mesh.faces)


def test_faces_that_name_a_vertex_twice_are_dropped_and_unused_vertices_too() -> None:
    faces = np.concatenate([DISC.faces, [[0, 0, 1], [2, 3, 3]]])
    points = np.concatenate([DISC.vertices, [[9.0, 9.0, 9.0]]])
    found = repaired(Mesh(points, faces))
    assert (found.collapsed, found.unused) == (2, 1)
    assert np.array_equal(found.mesh.vertices, DISC.vertices)


def with_sliver(mesh: Mesh, off: float = 0.0) -> Mesh:
    """Return the mesh with a vertex put on an inner edge, on one side of it only: a sliver takes up the other side."""
    edges = edges_of(mesh)
    one, other = edges.pairs()
    half, opposite = int(one[len(one) // 2]), int(other[len(other) // 2])
    flat_faces = mesh.faces.reshape(-1)
    a, c = int(flat_faces[half]), int(flat_faces[half - half % 3 + (half + 1) % 3])
    apex = int(flat_faces[half - half % 3 + (half + 2) % 3])
    b = len(mesh.vertices)
    points = np.concatenate([mesh.vertices, [(mesh.vertices[a] + mesh.vertices[c]) / 2.0 + [0.0, 0.0, off]]])
    assert opposite >= 0
    faces = np.delete(mesh.faces, half // 3, axis=0)
    return Mesh(points, np.concatenate([faces, [[a, b, apex], [b, c, apex], [a, c, b]]]))


def test_a_sliver_on_an_inner_edge_is_turned_into_two_faces_with_area() -> None:
    mesh = holed(9, [], flat)
    found = repaired(with_sliver(mesh))
    assert (found.flat, len(found.slivers)) == (1, 0)
    assert counts(found) == (len(mesh.vertices) + 1, 1, 1)
    areas = trimesh.Trimesh(found.mesh.vertices, found.mesh.faces, process=False)
    assert areas.is_winding_consistent
    assert_near(areas.area, 4.0, bound=1e-13, why="the square")
    assert heights(found.mesh).min() > 0.01


def test_a_sliver_on_the_boundary_is_dropped() -> None:
    points = np.array([[0.0, 0, 0], [2, 0, 0], [1, 0, 0], [1, 1, 0]])
    found = repaired(Mesh(points, np.array([[0, 2, 3], [2, 1, 3], [0, 1, 2]])))
    assert (found.flat, len(found.mesh.faces), len(found.mesh.vertices)) == (1, 2, 4)


def test_a_thin_face_with_area_is_left_alone() -> None:
    found = repaired(with_sliver(holed(9, [], flat), off=1e-4))
    assert (found.flat, len(found.slivers)) == (0, 0)


def test_of_a_mesh_of_slivers_nothing_is_left() -> None:
    points = np.column_stack([np.arange(12.0), np.zeros(12), np.zeros(12)])
    faces = np.array([[i, i + 1, i + 2] for i in range(10)])
    found = repaired(Mesh(points, faces))
    assert (found.flat, len(found.mesh.faces), len(found.slivers)) == (10, 0, 0)


def test_a_vertex_on_an_open_edge_is_a_crack_and_one_beside_it_is_not() -> None:
    mesh = with_sliver(holed(9, [], flat))
    torn = Mesh(mesh.vertices, mesh.faces[:-1])
    tolerance = ROUNDING
    vertex, half = cracks(torn, edges_of(torn), tolerance)
    assert vertex.tolist() == [len(mesh.vertices) - 1]
    assert len(half) == 1
    shifted = torn.vertices.copy()
    shifted[-1, 2] += 1e-3
    aside = Mesh(shifted, torn.faces)
    assert len(cracks(aside, edges_of(aside), tolerance)[0]) == 0
    assert len(cracks(mesh, edges_of(mesh), tolerance)[0]) == 0


def test_a_clean_mesh_comes_back_as_it_is() -> None:
    mesh = tube(30, 8, (5.0, 3.0), 8.0)
    found = repaired(mesh)
    assert np.array_equal(found.mesh.faces, mesh.faces)
    assert float(norm(found.mesh.vertices - mesh.vertices).max()) == 0.0
