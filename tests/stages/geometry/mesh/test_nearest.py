"""Nearest points of a mesh, against a search over every triangle and against points that are known."""

import numpy as np
import pytest
from scipy.optimize import minimize

from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.nearest import at, nearest
from tests.near import assert_near


def soup(seed: int, count: int = 60, size: float = 1.0) -> Mesh:
    """Triangles of very different sizes anywhere."""
    rng = np.random.default_rng(seed)
    centres, scales = rng.uniform(-1.0, 1.0, (count, 1, 3)), 10.0 ** rng.uniform(-2.0, 0.0, (count, 1, 1))
    vertices = size * (centres + scales * rng.normal(size=(count, 3, 3))).reshape(-1, 3)
    return Mesh(vertices, np.arange(3 * count).reshape(-1, 3))


def least(corners: np.ndarray, point: np.ndarray) -> float:
    """Distance by minimising over the weights, from several starts: a second method."""
    best = np.inf
    for start in ((0.34, 0.33), (0.05, 0.05), (0.9, 0.05), (0.05, 0.9)):
        found = minimize(
            lambda w: np.sum(
                (corners[0] + w[0] * (corners[1] - corners[0]) + w[1] * (corners[2] - corners[0]) - point) ** 2
            ),
            start,
            bounds=[(0, 1), (0, 1)],
            constraints=[{"type": "ineq", "fun": lambda w: 1.0 - w[0] - w[1]}],
            options={"ftol": 1e-15},
        )
        best = min(best, float(np.sqrt(max(found.fun, 0.0))))
    return best


@pytest.mark.parametrize("seed", range(3))
def test_no_triangle_is_nearer(seed: int) -> None:
    mesh = soup(seed, 12)
    points = np.random.default_rng(seed + 9).uniform(-3.0, 3.0, (8, 3))
    found = nearest(mesh, points)
    for point, distance in zip(points, found.distances, strict=True):
        every = min(least(mesh.vertices[face], point) for face in mesh.faces)
        assert_near(distance, every, bound=1e-6, why="the minimiser's own accuracy")


@pytest.mark.parametrize("size", [1.0, 1e4])
def test_points_of_the_mesh_are_found_with_their_weights(size: float) -> None:
    mesh, rng = soup(4, 200, size), np.random.default_rng(1)
    faces, weights = rng.integers(0, 200, 50), rng.dirichlet(np.ones(3), 50)
    points = np.einsum("kj,kjc->kc", weights, mesh.vertices[mesh.faces[faces]])
    found = nearest(mesh, points)
    assert_near(found.distances, np.zeros(50), bound=1e-13 * size, why="rounding of the weights")
    assert_near(at(mesh, found, mesh.vertices), points, bound=1e-13 * size, why="rounding of the weights")
    assert_near(found.weights.sum(axis=1), np.ones(50), bound=1e-15, why="weights are shares")


def test_corners_edges_and_faces_of_one_triangle() -> None:
    mesh = Mesh(np.array([[0.0, 0, 0], [4, 0, 0], [0, 3, 0]]), np.array([[0, 1, 2]]))
    asked = np.array([[1.0, 1, 5], [-3, -4, 0], [2, -2, 1], [4, 3, 0], [9, 0, 0]])
    wanted = np.array([[1.0, 1, 0], [0, 0, 0], [2, 0, 0], [2.56, 1.08, 0], [4, 0, 0]])
    found = nearest(mesh, asked)
    assert_near(at(mesh, found, mesh.vertices), wanted, bound=1e-14, why="by hand")
    assert_near(found.distances, np.linalg.norm(asked - wanted, axis=1), bound=1e-14, why="by hand")


def test_a_triangle_without_area_is_its_edges() -> None:
    mesh = Mesh(np.array([[0.0, 0, 0], [4, 0, 0], [2, 0, 0]]), np.array([[0, 1, 2]]))
    found = nearest(mesh, np.array([[3.0, 2.0, 0.0]]))
    assert_near(found.distances, [2.0], bound=1e-15, why="by hand")
