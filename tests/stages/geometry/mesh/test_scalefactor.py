"""The scale that a conformal map would need, against its closed form on a spherical cap."""

import numpy as np

from stages.geometry.mesh.curvature import defects
from stages.geometry.mesh.flat import by_side
from stages.geometry.mesh.intrinsic import laid
from stages.geometry.mesh.lengths import chords
from stages.geometry.mesh.scalefactor import scale_factors
from stages.geometry.mesh.topology import edges_of, on_border
from tests.caps import RADIUS, cap
from tests.near import assert_near


def test_a_cap_is_magnified_as_by_stereographic_projection() -> None:
    """It maps the sphere conformally, magnified by 1 / (1 + cos theta): u = log((1 + cos) / (1 + cos rim)), 0 there."""
    half = 0.8
    mesh = cap(half)
    edges = edges_of(mesh)
    lengths = chords(mesh.vertices, edges.ends)
    inside = (~on_border(mesh, edges)).astype(np.float64)
    found = scale_factors(mesh.faces, laid(by_side(edges, lengths)), defects(mesh, edges, lengths), inside)
    cosine = mesh.vertices[:, 2] / RADIUS
    # angle defects on irregular triangles have errors that cancel between neighbours: h^2 of the whole is left
    wanted = np.log((1.0 + cosine) / (1.0 + np.cos(half)))
    assert_near(found, wanted, bound=float(wanted.max()) * (2.0 / 30.0) ** 2 * 5.0, why="linear elements")
    assert np.argmax(found) == np.argmax(wanted)
