"""Meshes laid flat: exact positions on developables, every seed; fall-back; holes; what is not developable."""

import numpy as np
import pytest

from stages.errors import NoSolutionError
from stages.geometry.arrays import norm
from stages.geometry.mesh.arap import energy, settled
from stages.geometry.mesh.flat import at_rest, by_side, flattened, resting
from stages.geometry.mesh.intrinsic import conformal, laid
from stages.geometry.mesh.lengths import chords
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.meshmap import MeshMap
from stages.geometry.mesh.topology import edges_of
from tests.meshes import KNOWN, Known, cylinder, hemisphere, misplaced, noisy, right_cone, single_precision, with_hole
from tests.near import assert_near

REST = 1e-10


def flat(known: Known, mesh: Mesh | None = None) -> MeshMap:
    return flattened(mesh or known.mesh, accuracy=REST * known.size)


def on_chords(known: Known, mesh: Mesh) -> MeshMap:
    edges = edges_of(mesh)
    lengths = chords(mesh.vertices, edges.ends)
    return at_rest(mesh, edges, lengths, kind="chord", noise_mm=0.0, accuracy=REST * known.size)


SMALL = 60, 16
"""Columns and rows: 1920 triangles.  Ten seeds of 10 000 are in the benches."""
COARSER = (158.0 / 60.0) ** 6
"""Fits of degree 4 leave slopes that are off by h^5 at both ends of an edge of length h: lengths by its sixth power."""
BETTER = 10.0
"""Than chords, at least; on the sharpest of these it is 17 times."""
GOALS = {
    "cylinder": 1e-9, "right cone": 1e-7, "oblique cone": 5e-6, "round cone": 5e-6, "tangent surface": 1e-7,
    "strap": 1e-7,
}  # fmt: skip
"""Position error over size at 10 000 irregular triangles."""


@pytest.mark.parametrize("name", GOALS)
def test_a_developable_unrolls_to_its_exact_positions(name: str) -> None:
    known = KNOWN[name](7, *SMALL)
    made, plain = flat(known), on_chords(known, known.mesh)
    error = misplaced(made.positions, known.flat) / known.size
    assert made.kind == "curved"
    assert made.reached_mm <= REST * known.size
    assert error <= GOALS[name] * COARSER
    assert error <= misplaced(plain.positions, known.flat) / known.size / BETTER
    rounded = flat(known, single_precision(known.mesh))
    assert misplaced(rounded.positions, known.flat) / known.size <= max(1e-7, 2.0 * error)


def test_lengths_that_are_exact_give_positions_that_are_exact() -> None:
    known = right_cone(2, 60, 12)
    edges = edges_of(known.mesh)
    exact = norm(known.flat[edges.ends[:, 1]] - known.flat[edges.ends[:, 0]])
    made = at_rest(known.mesh, edges, exact, kind="curved", noise_mm=0.0, accuracy=REST * known.size)
    assert_near(
        misplaced(made.positions, known.flat) / known.size, 0.0, bound=1e-12, why="rounding of 60 edges in a row"
    )
    assert np.abs(made.strains).max() < 1e-12


@pytest.mark.parametrize("amount", [1e-7, 1e-6, 1e-5, 1e-4, 1e-3])
@pytest.mark.parametrize("name", ["cylinder", "oblique cone"])
def test_noise_never_makes_it_worse_than_chords(name: str, amount: float) -> None:
    known = KNOWN[name](3, 80, 16)
    mesh = noisy(known.mesh, amount)
    made, plain = flat(known, mesh), on_chords(known, mesh)
    assert misplaced(made.positions, known.flat) <= 1.2 * misplaced(plain.positions, known.flat)


@pytest.mark.parametrize("cells", [(40, 8), (20, 4), (12, 3)])
@pytest.mark.parametrize("name", KNOWN)
def test_coarse_and_sharp_meshes_are_never_worse_than_chords(name: str, cells: tuple[int, int]) -> None:
    known = KNOWN[name](1, *cells)
    made, plain = flat(known), on_chords(known, known.mesh)
    assert misplaced(made.positions, known.flat) <= 1.2 * misplaced(plain.positions, known.flat)


def test_a_strip_of_triangles_is_laid_out_on_its_chords() -> None:
    made = flat(cylinder(0, 12, 1))
    assert made.kind == "chord"
    assert np.abs(made.strains).max() < 1e-12, "triangles in a row have no vertex inside to strain them"


def test_holes_do_not_matter() -> None:
    known = right_cone(4, 80, 16)
    centre = int(np.argmin(norm(known.flat - known.flat.mean(axis=0))))
    holed = with_hole(known.mesh, centre, 20.0)
    kept = np.array([int(np.argmin(norm(known.mesh.vertices - x))) for x in holed.vertices])
    made = flat(known, holed)
    assert len(holed.faces) < len(known.mesh.faces)
    assert misplaced(made.positions, known.flat[kept]) / known.size < 1e-6


def test_a_hemisphere_comes_to_rest_strained() -> None:
    mesh = hemisphere(0, 24)
    made = flattened(mesh, accuracy=1e-10)
    assert made.reached_mm <= 1e-10
    assert 0.1 < np.abs(made.strains).max() < 1.0
    edges = edges_of(mesh)
    rest = resting(mesh, edges, made.lengths)
    for shift in np.random.default_rng(0).normal(0.0, 1e-4, (5, *made.positions.shape)):
        assert energy(rest, made.positions + shift) > energy(rest, made.positions)


def test_local_and_global_steps_come_to_the_same_rest() -> None:
    """The second method: rotations nearest to each triangle's map and positions nearest to these, in turn."""
    mesh = hemisphere(1, 8)
    made = flattened(mesh, accuracy=1e-12)
    rest = resting(mesh, edges_of(mesh), made.lengths)
    rows = np.zeros((2 * len(mesh.faces), len(mesh.vertices)))
    for m, (face, parts) in enumerate(zip(rest.faces, rest.by_corner, strict=True)):
        rows[2 * m : 2 * m + 2, face] = np.sqrt(rest.area[m]) * parts.T
    weights = np.repeat(np.sqrt(rest.area), 2)[:, None]
    solve = np.linalg.pinv(rows)
    positions = made.positions + np.random.default_rng(0).normal(0.0, 1e-3, made.positions.shape)
    for _ in range(400):
        u, _, v = np.linalg.svd((rows @ positions / weights).reshape(-1, 2, 2))
        positions = solve @ (weights * (u @ v).reshape(-1, 2))
    assert misplaced(positions, made.positions) < 1e-6


def test_the_conformal_start_keeps_angles_of_a_plane() -> None:
    known = cylinder(5, 30, 6)
    mesh = Mesh(np.column_stack([known.flat, np.zeros(len(known.flat))]), known.mesh.faces)
    edges = edges_of(mesh)
    corners = laid(by_side(edges, chords(mesh.vertices, edges.ends)))
    assert misplaced(conformal(mesh.vertices, mesh.faces, corners), known.flat) < 1e-9 * known.size


def test_what_cannot_be_reached_is_said() -> None:
    known = cylinder(0, 20, 4)
    with pytest.raises(NoSolutionError, match="rigidly"):
        flattened(known.mesh, accuracy=1e-30)


def test_sides_that_make_no_triangle_are_refused() -> None:
    with pytest.raises(NoSolutionError, match="triangles"):
        laid(np.array([[1.0, 1.0, 2.5]]))


def test_a_mesh_turned_over_by_its_start_still_comes_to_rest() -> None:
    known = right_cone(1, 20, 6)
    edges = edges_of(known.mesh)
    rest = resting(known.mesh, edges, chords(known.mesh.vertices, edges.ends))
    squeezed = known.flat * [1.0, 0.2]
    assert misplaced(settled(rest, squeezed, still=1e-8).positions, known.flat) < 0.05 * known.size
