"""Fits around the vertices of a mesh: closed forms of normals and curvatures, noise found again, limits stated."""

import numpy as np
import pytest

from stages.geometry.arrays import Array, cross3, dot, norm, unit
from stages.geometry.mesh.fit import SurfaceFit, fitted, stars
from stages.geometry.mesh.flat import noise
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.topology import edges_of
from tests.meshes import cylinder, hemisphere, jittered, noisy, oblique_cone
from tests.near import assert_near, assert_relative


def fit_of(mesh: Mesh, degree: int = 4) -> SurfaceFit:
    return fitted(mesh, stars(mesh, edges_of(mesh)), degree)


def quartic(seed: int) -> tuple[Mesh, Array]:
    """A graph of degree 4 over a rectangle much finer one way, and its exact normals."""
    v, u, faces = jittered(seed, 40, 12)
    x, y = 20.0 * v, u
    z = 0.1 * x + 0.02 * x * x + 0.3 * x * y - 0.4 * y * y + 1e-3 * x**3 * y + 0.2 * y**4
    dx, dy = 0.1 + 0.04 * x + 0.3 * y + 3e-3 * x**2 * y, 0.3 * x - 0.8 * y + 1e-3 * x**3 + 0.8 * y**3
    return Mesh(np.column_stack([x, y, z]), faces), unit(np.column_stack([-dx, -dy, np.ones_like(dx)]))


def test_a_plane_is_fitted_to_rounding() -> None:
    v, u, faces = jittered(0, 20, 9)
    mesh = Mesh(np.column_stack([v, u, 0.3 * v - 0.2 * u + 5.0]), faces)
    fit = fit_of(mesh)
    across = unit(np.array([[-0.3, 0.2, 1.0]]))
    assert_near(norm(cross3(fit.normals, np.repeat(across, len(fit.normals), axis=0))), np.zeros(len(fit.normals)),
                bound=1e-12, why="heights of 5 are known to 1e-15, and neighbours are 0.1 away")  # fmt: skip
    assert fit.residual.max() < 1e-14


def test_normals_of_a_cylinder_inside_and_at_the_edges() -> None:
    mesh = cylinder(1, scale=1.0).mesh
    exact = mesh.vertices * [1.0, 1.0, 0.0]
    off = norm(cross3(fit_of(mesh).normals, exact))
    assert off.max() < 2e-7, "a degree 4 fit leaves (reach)^5 / 5! of 0.1^5 / 120 over the reach, at the edges"
    assert np.median(off) < 2e-9


def test_a_polynomial_of_its_degree_is_reproduced() -> None:
    """In a tilted plane a quartic is no polynomial any more: the error is what the tilt makes of degree 5."""
    mesh, exact = quartic(0)
    flatter = Mesh(mesh.vertices * [1.0, 1.0, 1e-6], mesh.faces)
    fit = fit_of(flatter)
    normals = unit(exact / exact[:, 2:] * [1e-6, 1e-6, 1.0])
    assert_near(norm(cross3(fit.normals, normals)), np.zeros(len(exact)), bound=1e-13,
                why="slopes of 1e-5; the tilt adds their square; condition 1e3")  # fmt: skip


def test_curvatures_of_a_sphere_are_one_in_every_direction() -> None:
    mesh = hemisphere(2, 40)
    fit = fit_of(mesh)
    inside = np.flatnonzero(mesh.vertices[:, 2] > 0.3)
    for turn in (0.0, 1.0, 2.0):
        along = unit(cross3(fit.normals[inside], np.cos(turn) * fit.x[inside] + np.sin(turn) * fit.y[inside]))
        assert_relative(np.abs(fit.bending(inside, along)), np.ones(len(inside)), bound=2e-3,
                        why="h_xx of degree 4 leaves the reach, 0.15, to the fourth")  # fmt: skip


@pytest.mark.parametrize("amount", [1e-7, 1e-5, 1e-4])
def test_noise_is_found_again(amount: float) -> None:
    known = cylinder(3)
    fit = fit_of(noisy(known.mesh, amount))
    assert_relative(
        noise(fit) / known.size, amount, bound=0.05, why="median of 5000 estimates of 15 degrees of freedom"
    )


def test_noise_looks_the_same_to_both_degrees_and_coarseness_does_not() -> None:
    sharp = oblique_cone(0, 80, 16).mesh
    clean, shaken = fit_of(sharp), fit_of(noisy(sharp, 1e-4))
    assert np.median(clean.coarser / clean.residual) > 5.0
    assert 0.8 < np.median(shaken.coarser / shaken.residual) < 1.3


def test_too_few_neighbours_are_said_to_be() -> None:
    strip = cylinder(0, 12, 1).mesh
    fit = fit_of(strip)
    assert np.isinf(fit.residual).all()
    assert np.isinf(noise(fit))


def test_another_layer_of_a_folded_sheet_is_no_neighbour() -> None:
    """A hairpin whose sheets lie a third of an edge apart: its normals are those of the single sheet."""
    v, u, faces = jittered(4, 60, 12)
    length, gap = 6.0 * v, 0.03
    along = np.minimum(length, 6.0 - length)
    mesh = Mesh(np.column_stack([along, u, np.where(length > 3.0, gap, 0.0)]), faces)
    flat = np.abs(length - 3.0) > 0.7
    assert_near(np.abs(fit_of(mesh).normals[flat][:, 2]), np.ones(int(flat.sum())), bound=1e-12, why="two planes")


def test_a_vertex_without_a_face_is_refused() -> None:
    mesh = cylinder(0, 8, 4).mesh
    lonely = Mesh(np.vstack([mesh.vertices, [0.0, 0.0, 9.0]]), mesh.faces)
    with pytest.raises(ValueError, match="belongs to no face"):
        fit_of(lonely)


def test_moving_and_scaling_a_mesh_moves_and_scales_its_fit() -> None:
    mesh = oblique_cone(1, 24, 8).mesh
    turn = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    one, other = fit_of(mesh), fit_of(Mesh(1000.0 * mesh.vertices @ turn.T, mesh.faces))
    assert_near(other.normals, one.normals @ turn.T, bound=1e-9, why="rounding through fits of condition 1e5")
    assert_relative(other.residual, 1000.0 * one.residual, bound=1e-5, why="residuals are 1e-6 of the heights")
    assert dot(other.normals, one.normals @ turn.T).min() > 0.0
