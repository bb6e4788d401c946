"""Curvature over regions of a mesh: sphere, torus, saddle and developables in closed form, Gauss and Bonnet, layers."""

from typing import NamedTuple

import numpy as np
import pytest

from stages.geometry.arrays import Array, Indices, Points2, Values, norm
from stages.geometry.mesh.curvature import Regions, defects, means, regions, ruling_lengths, shares, spread
from stages.geometry.mesh.fit import SurfaceFit, fitted, stars
from stages.geometry.mesh.lengths import chords, curved, mended
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.topology import Edges, edges_of
from tests.meshes import hemisphere, jittered, patch_of, sheet
from tests.near import assert_near, assert_relative

SQUARE = 0.5
"""Of the longer sides squared: the longest of an irregular mesh are twice the mean ones, of which h^2 / 8 is told."""


class Read(NamedTuple):
    """A mesh with its regions and what was read there."""

    edges: Edges
    fit: SurfaceFit
    lengths: Values
    found: Regions
    area: Values
    mean: Values


def read(mesh: Mesh, flat: Points2) -> Read:
    edges = edges_of(mesh)
    fit = fitted(mesh, stars(mesh, edges))
    straight = chords(mesh.vertices, edges.ends)
    lengths = mended(curved(mesh.vertices, edges.ends, fit)[0], straight, edges.of_half)
    found, area = regions(edges, flat), shares(mesh, edges, lengths)
    return Read(edges, fit, lengths, found, area, means(found, defects(mesh, edges, lengths), area))


def averaged(made: Read, curvature: Values) -> Values:
    """The means of a curvature known at every vertex."""
    return np.asarray((made.found.weights @ (curvature * made.area)) / (made.found.weights @ made.area))


def graph(seed: int, height: float) -> tuple[Mesh, Points2, Values]:
    """z = height x y over a square of side 2, where its vertices are from above, and its curvature."""
    v, u, faces = jittered(seed, 40, 40)
    x, y = 2.0 * v - 1.0, 2.0 * u - 1.0
    curvature = -((height / (1.0 + height**2 * (x * x + y * y))) ** 2)
    return Mesh(np.column_stack([x, y, height * x * y]), faces), np.column_stack([x, y]), curvature


def torus(seed: int, middle: float) -> tuple[Mesh, Points2, Values]:
    """A patch of the torus of radii 3 and 1, `middle` around its tube, and its curvature."""
    v, u, faces = jittered(seed, 40, 40)
    turn, tube = 0.3 * (v - 0.5), middle + 0.8 * (u - 0.5)
    wide = 3.0 + np.cos(tube)
    places = np.column_stack([wide * np.cos(turn), wide * np.sin(turn), np.sin(tube)])
    return Mesh(places, faces), np.column_stack([3.0 * turn, tube]), np.cos(tube) / wide


def test_the_mean_curvature_of_a_sphere_is_one() -> None:
    mesh = hemisphere(0, 40)
    made = read(mesh, mesh.vertices[:, :2])
    assert len(made.mean)
    assert_relative(made.mean, np.ones_like(made.mean), bound=SQUARE * 0.05**2,
                    why="flat triangles of sides h miss h^2 / 8 of the area; h = 0.05")  # fmt: skip


@pytest.mark.parametrize("middle", [0.0, np.pi, 2.5])
def test_the_mean_curvature_of_a_torus_has_its_sign_inside_and_outside(middle: float) -> None:
    mesh, flat, curvature = torus(1, middle)
    made = read(mesh, flat)
    assert_near(made.mean, averaged(made, curvature), bound=SQUARE * 0.03**2 * float(np.abs(curvature).max()),
                why="flat triangles of sides h miss h^2 / 8 of the area; h = 0.03")  # fmt: skip


@pytest.mark.parametrize("height", [0.01, 0.3])
def test_the_mean_curvature_of_a_saddle(height: float) -> None:
    mesh, flat, curvature = graph(2, height)
    made = read(mesh, flat)
    assert_relative(made.mean, averaged(made, curvature), bound=1e-3, why="h^2 of 0.05^2 / 2 over regions of 0.5")


@pytest.mark.parametrize("name", ["cylinder", "right cone", "oblique cone", "strap"])
def test_developables_have_none(name: str) -> None:
    mesh = sheet(patch_of(name), 3, 100, 20)
    v, u, _ = jittered(3, 100, 20)
    size = float(norm(np.ptp(mesh.vertices, axis=0)))
    made = read(mesh, np.column_stack([0.5 * size * v, 0.15 * size * u]))
    assert_near(
        size**2 * made.mean, np.zeros_like(made.mean), bound=1e-3, why="0.1 deg of warp is 3e-6 of (D / l)^2 = 300"
    )


def test_a_warp_of_the_saddle_is_read_along_its_rulings() -> None:
    mesh, flat, _ = graph(4, 0.01)
    made = read(mesh, flat)
    lengths = ruling_lengths(mesh, made.edges, flat, made.fit.normals, made.found)
    assert_relative(
        lengths, np.full(len(lengths), 2.0), bound=0.02, why="both rulings run along the sides, as seen by fits"
    )
    turned = lengths * np.sqrt(-made.mean)
    exact = 2.0 * np.arctan(0.01)
    assert_relative(turned, np.full(len(turned), exact), bound=0.02, why="as the lengths; K falls by 1e-4")


def test_defects_add_up_to_what_the_boundary_says() -> None:
    """Gauss and Bonnet: whatever the lengths, interior defects are 2 pi less the turning of the boundary."""
    mesh, _, _ = graph(1, 0.5)
    edges = edges_of(mesh)
    lengths = chords(mesh.vertices, edges.ends) * np.random.default_rng(0).uniform(0.999, 1.001, len(edges.ends))
    sides = lengths[edges.of_half].reshape(-1, 3)
    a, b, c = sides.T
    angles = np.arccos(np.stack([(a * a + c * c - b * b) / (2 * a * c), (a * a + b * b - c * c) / (2 * a * b),
                                 (b * b + c * c - a * a) / (2 * b * c)], axis=1))  # fmt: skip
    around = np.bincount(mesh.faces.ravel(), angles.ravel())
    border = np.unique(edges.ends[edges.count == 1])
    turning = float((np.pi - around[border]).sum())
    assert_near(float(defects(mesh, edges, lengths).sum()), 2.0 * np.pi - turning, bound=1e-11, why="9600 arc cosines")


def test_one_longer_edge_bends_four_vertices_and_nothing_in_all() -> None:
    mesh, flat, _ = graph(5, 0.0)
    edges = edges_of(mesh)
    lengths = chords(mesh.vertices, edges.ends)
    inside = np.flatnonzero((edges.count == 2) & (norm(flat[edges.ends].mean(axis=1)) < 0.5))[0]
    lengths[inside] *= 1.0 + 1e-4
    found = defects(mesh, edges, lengths)
    bent = np.flatnonzero(np.abs(found) > 1e-7)
    assert len(bent) == 4
    assert set(edges.ends[inside]) < set(bent)
    assert np.abs(found[bent]).max() > 5e-5
    assert abs(found.sum()) < 1e-11


def test_noise_of_single_vertices_cancels_in_the_means() -> None:
    mesh, flat, _ = graph(6, 0.0)
    shaken = Mesh(mesh.vertices + np.random.default_rng(0).normal(0.0, 1e-5, mesh.vertices.shape), mesh.faces)
    made = read(shaken, flat)
    single = defects(shaken, made.edges, chords(shaken.vertices, made.edges.ends)) / made.area
    assert np.abs(made.mean).max() < 1e-3 * np.abs(single).max()


def test_bumps_are_one_in_the_middle_and_nought_at_the_boundary() -> None:
    mesh, flat, _ = graph(7, 0.1)
    edges = edges_of(mesh)
    found = regions(edges, flat)
    weights = found.weights.toarray()
    assert_near(weights[np.arange(len(weights)), found.centres], np.ones(len(weights)), bound=0.0, why="r = 0")
    border = np.unique(edges.ends[edges.count == 1])
    assert_near(weights[:, border], np.zeros((len(weights), len(border))), bound=0.0, why="circles end before it")
    assert weights.min() >= 0.0
    assert set(found.scale) == {0, 1}


def layers_of(found: Regions, v: Values) -> list[Array]:
    """The parameters of the vertices of every region."""
    rows: list[Indices] = [np.flatnonzero(row) for row in found.weights.toarray()]
    return [v[row] for row in rows]


def test_a_region_keeps_to_its_own_layer_of_the_pattern() -> None:
    v, u, faces = jittered(8, 240, 24)
    slant, angle = 1.0 + u, 9.0 * v
    flat = np.column_stack([slant * np.cos(angle), slant * np.sin(angle)])
    mesh = Mesh(np.column_stack([flat, 0.3 * angle]), faces)
    made = layers_of(regions(edges_of(mesh), flat), v)
    assert len(made) > 8
    assert max(float(np.ptp(row)) for row in made) * 9.0 < 1.5, "a circle of radius 0.5 seen from 1.5 spans 0.7 rad"


def test_what_is_too_narrow_has_no_region() -> None:
    v, u, faces = jittered(0, 40, 3)
    flat = np.column_stack([40.0 * v, 3.0 * u])
    assert len(regions(edges_of(Mesh(np.column_stack([flat, 0.0 * v]), faces)), flat).centres) == 0


def test_the_spread_falls_with_the_cube_of_the_radius() -> None:
    mesh, flat, _ = graph(9, 0.1)
    found = regions(edges_of(mesh), flat)
    known = np.random.default_rng(0).choice([-1.0, 1.0], len(found.radii)) * 1e-3 / found.radii**3
    assert_relative(spread(found, known), np.abs(known), bound=1e-12, why="the root of the mean of equal squares")
