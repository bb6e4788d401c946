"""Lengths on the surface from its vertices: closed forms, order of the error, what is believed."""

import numpy as np
import pytest

from stages.geometry.arrays import Values, norm
from stages.geometry.mesh.fit import fitted, stars
from stages.geometry.mesh.lengths import chords, curved
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.topology import edges_of
from tests.meshes import KNOWN, cylinder, hemisphere, noisy, right_cone


def relative_errors(mesh: Mesh, exact: Values) -> Values:
    edges = edges_of(mesh)
    return np.asarray(np.abs(curved(mesh.vertices, edges.ends, fitted(mesh, stars(mesh, edges)))[0] / exact - 1.0))


@pytest.mark.parametrize("name", KNOWN)
def test_lengths_are_those_of_the_unrolled_edges(name: str) -> None:
    known = KNOWN[name](1, 80, 16)
    ends = edges_of(known.mesh).ends
    exact = norm(known.flat[ends[:, 1]] - known.flat[ends[:, 0]])
    errors = relative_errors(known.mesh, exact)
    plain = np.abs(chords(known.mesh.vertices, ends) / exact - 1.0)
    assert np.sqrt(np.mean(errors**2)) < 0.02 * np.sqrt(np.mean(plain**2))


def test_lengths_on_a_sphere_are_arcs_of_great_circles() -> None:
    mesh = hemisphere(0, 60)
    ends = edges_of(mesh).ends
    a, b = mesh.vertices[ends[:, 0]], mesh.vertices[ends[:, 1]]
    errors = relative_errors(mesh, 2.0 * np.arcsin(norm(b - a) / 2.0))
    inside = (a[:, 2] > 0.3) & (b[:, 2] > 0.3)
    assert errors[inside].max() < 2e-8, "1e-3 of the chords' m^2 / 6 of 1e-5 and more"


def test_halving_the_edges_leaves_a_sixteenth_and_less() -> None:
    """On the cone, the chords' error falls with the square, this one's with the fourth power at least."""
    left = []
    for columns, rows in ((40, 8), (80, 16)):
        known = right_cone(0, columns, rows)
        ends = edges_of(known.mesh).ends
        exact = norm(known.flat[ends[:, 1]] - known.flat[ends[:, 0]])
        left.append(float(np.sqrt(np.mean(relative_errors(known.mesh, exact) ** 2))))
    assert left[1] < left[0] / 16.0


def test_fits_of_noise_and_of_creases_are_not_believed() -> None:
    known = cylinder(0, 60, 12)
    edges = edges_of(known.mesh)
    for mesh, least, most in (
        (known.mesh, 1.0, 1.0),
        (noisy(known.mesh, 1e-3), 0.0, 0.05),
    ):
        believed = curved(mesh.vertices, edges.ends, fitted(mesh, stars(mesh, edges)))[1].mean()
        assert least <= believed <= most
    x = known.flat - known.flat.min(axis=0)
    middle = float(np.median(x[:, 0]))
    roof = Mesh(np.column_stack([np.abs(x[:, 0] - middle), x[:, 1], np.where(x[:, 0] > middle, 1.0, 0.2)
                                 * np.abs(x[:, 0] - middle)]), known.mesh.faces)  # fmt: skip
    believed = curved(roof.vertices, edges.ends, fitted(roof, stars(roof, edges)))[1]
    across = (x[edges.ends] - middle)[..., 0]
    assert not believed[np.sign(across[:, 0]) != np.sign(across[:, 1])].any()
    assert believed[np.abs(across).min(axis=1) > 50.0].all()
