"""What holds a mesh together, against closed forms, Euler's and libigl's counts, planted faults, and other orders."""

import igl
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.topology import (
    boundary_loops,
    edges_of,
    euler_characteristic,
    genus,
    part_of,
    pieces,
    pinched,
    turned,
    with_turned,
)
from tests.meshes import jittered
from tests.near import assert_near
from tests.tubes import flat, holed, moebius, rolled, shuffled, together, tube, turned_over

SQUARE = holed(9, [], flat)
MESHES = {
    "square": SQUARE,
    "tube": tube(20, 6, (5.0, 3.0), 8.0),
    "three holes": holed(21, [(-0.5, 0.0, 0.2), (0.5, 0.4, 0.15), (0.4, -0.5, 0.3)], rolled),
    "two pieces": together(SQUARE, tube(12, 3, (1.0, 1.0), 2.0)),
}
COUNTS = {"square": (1, 1, 1), "tube": (1, 0, 2), "three holes": (1, -2, 4), "two pieces": (2, 1, 3)}
"""Pieces, Euler characteristic (1 - holes for a disc, 0 for a tube), boundary loops."""


@pytest.mark.parametrize("name", MESHES)
def test_pieces_euler_characteristic_and_loops_are_the_known_ones_and_libigls(name: str) -> None:
    mesh = MESHES[name]
    edges = edges_of(mesh)
    count, labels = pieces(mesh, edges)
    loops = boundary_loops(mesh, edges)
    assert (count, euler_characteristic(mesh, edges), len(loops)) == COUNTS[name]
    assert euler_characteristic(mesh, edges) == igl.euler_characteristic(mesh.faces)
    assert count == igl.facet_components(mesh.faces)[0]
    assert sorted(map(len, loops)) == sorted(map(len, igl.boundary_loop_all(mesh.faces)))
    assert labels[0] == 0
    assert np.array_equal(np.unique(labels), np.arange(count))


def test_edges_are_those_of_libigl() -> None:
    mesh = MESHES["three holes"]
    edges = edges_of(mesh)
    assert np.array_equal(np.unique(np.sort(igl.edges(mesh.faces), axis=1), axis=0), edges.ends)
    assert edges.count.sum() == 3 * len(mesh.faces)


def test_loops_leave_the_surface_on_their_left() -> None:
    mesh = holed(15, [(0.1, 0.0, 0.4)], flat)
    areas = {}
    for loop in boundary_loops(mesh, edges_of(mesh)):
        x, y, _ = mesh.vertices[loop].T
        areas[0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))] = len(loop)
    outer, hole = sorted(areas, reverse=True)
    rim = areas[hole]
    assert_near(outer, 4.0, bound=1e-13, why="the square, summed over 60 corners")
    assert_near(hole, -0.5 * rim * 0.4**2 * np.sin(2 * np.pi / rim), bound=1e-13, why="a regular polygon, clockwise")


@settings(max_examples=25)
@given(st.integers(0, 2**31), st.sampled_from(sorted(MESHES)))
def test_the_order_of_vertices_faces_and_corners_does_not_count(seed: int, name: str) -> None:
    mesh = shuffled(MESHES[name], seed)
    edges = edges_of(mesh)
    assert (pieces(mesh, edges)[0], euler_characteristic(mesh, edges), len(boundary_loops(mesh, edges))) == COUNTS[name]
    assert len(pinched(mesh, edges)) == 0


@settings(max_examples=25)
@given(st.integers(0, 2**31), st.floats(0.0, 0.45))
def test_faces_turned_over_are_found_and_no_others(seed: int, share: float) -> None:
    mesh = MESHES["tube"]
    some = np.random.default_rng(seed).permutation(len(mesh.faces))[: int(share * len(mesh.faces))]
    spoiled = turned_over(mesh, some)
    found = turned(spoiled, edges_of(spoiled))
    assert found is not None
    assert np.array_equal(found, np.sort(some))
    assert edges_of(with_turned(spoiled, found)).count.max() == 2


def test_where_half_of_the_faces_run_either_way_the_first_one_is_kept() -> None:
    mesh = Mesh(np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]), np.array([[0, 1, 2], [0, 3, 2]]))
    found = turned(mesh, edges_of(mesh))
    assert found is not None
    assert found.tolist() == [1]


def test_a_moebius_strip_has_one_side_and_libigl_cannot_orient_it_either() -> None:
    mesh = moebius()
    assert turned(mesh, edges_of(mesh)) is None
    oriented, _ = igl.bfs_orient(mesh.faces)
    start, end = oriented.reshape(-1), oriented[:, [1, 2, 0]].reshape(-1)
    halves = np.stack([start, end], axis=1)
    assert len(np.unique(halves, axis=0)) < len(halves)


def test_a_vertex_of_two_fans_is_pinched_open_and_closed_ones_alike() -> None:
    points = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [-1, 0, 0], [-1, -1, 0], [0, 0, 1]])
    bow_tie = Mesh(points, np.array([[0, 1, 2], [0, 3, 4]]))
    assert pinched(bow_tie, edges_of(bow_tie)).tolist() == [0]
    fan = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1]])
    two_closed = Mesh(np.zeros((7, 3)), np.concatenate([fan, np.where(fan, fan + 3, 0)]))
    assert pinched(two_closed, edges_of(two_closed)).tolist() == [0]
    assert not all(igl.is_vertex_manifold(bow_tie.faces))


def test_handles_are_counted() -> None:
    i, j = (axis.ravel() for axis in np.meshgrid(np.arange(8), np.arange(5), indexing="ij"))
    a, b, c, d = i * 5 + j, (i + 1) % 8 * 5 + j, (i + 1) % 8 * 5 + (j + 1) % 5, i * 5 + (j + 1) % 5
    torus = Mesh(np.zeros((40, 3)), np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]))
    assert genus(euler_characteristic(torus, edges_of(torus)), 0) == 1
    opened = Mesh(torus.vertices, torus.faces[1:])
    assert genus(euler_characteristic(opened, edges_of(opened)), 1) == 1
    assert genus(2, 0) == genus(1, 1) == genus(0, 2) == 0


def test_a_part_of_a_mesh_keeps_positions_and_order() -> None:
    mesh = MESHES["two pieces"]
    _, labels = pieces(mesh, edges_of(mesh))
    second = part_of(mesh, np.flatnonzero(labels == 1))
    assert np.array_equal(second.vertices, mesh.vertices[len(SQUARE.vertices) :])
    assert np.array_equal(second.faces, mesh.faces[len(SQUARE.faces) :] - len(SQUARE.vertices))


def test_a_jittered_mesh_has_the_edges_that_euler_asks_for() -> None:
    _, _, faces = jittered(3, 30, 10)
    mesh = Mesh(np.zeros((31 * 11, 3)), faces)
    edges = edges_of(mesh)
    border = 2 * (30 + 10)
    assert len(edges.count) == 3 * 31 * 11 - 3 - border
    assert len(edges.border) == border
