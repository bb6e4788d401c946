"""How sharply a mesh bends, towards its normals and away from them, and the mesh parallel to it.

The curvature at a vertex is the principal one of greatest size of the surface fitted there (`fit`); vertices whose
fit leaves too much of their surroundings unexplained (`lengths`) say nothing.  Sampled at the vertices: between
them, and at the edge of the mesh, where fits are one-sided, it may be sharper.  Noise of s mm adds some s / h^2 for
edges of h mm.

The parallel mesh has its vertices moved along the fitted normals.  Parallel surfaces of a developable are developable
along the same rulings; the error is the distance times that of the normals.
"""

import numpy as np

from stages.geometry.arrays import Values
from stages.geometry.mesh.across import ways
from stages.geometry.mesh.bends import MeshBends, SharpVertex
from stages.geometry.mesh.curvature import shares
from stages.geometry.mesh.fit import SurfaceFit, fitted_at
from stages.geometry.mesh.lengths import UNEXPLAINED, chords
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.topology import Edges


def bends_of(mesh: Mesh, edges: Edges, fit: SurfaceFit) -> MeshBends:
    """Return how a mesh bends."""
    curvature = np.where(fit.residual <= UNEXPLAINED * fit.relief, ways(fit)[1], 0.0)
    area = shares(mesh, edges, chords(mesh.vertices, edges.ends))
    towards, away = (_sharpest(mesh, sign * curvature) for sign in (1.0, -1.0))
    turned = (float(area @ np.maximum(curvature, 0.0)), float(area @ np.maximum(-curvature, 0.0)))
    return MeshBends(towards, away, turned)


def _sharpest(mesh: Mesh, curvature: Values) -> SharpVertex | None:
    """Return where a curvature is largest, None where it is nowhere above 0."""
    vertex = int(np.argmax(curvature))
    size = float(np.ptp(mesh.vertices, axis=0).max())
    if curvature[vertex] * size <= FIT_NOISE:
        return None
    x, y, z = (float(value) for value in mesh.vertices[vertex])
    return SharpVertex(float(curvature[vertex]), vertex, (x, y, z))


FIT_NOISE = 1e-6
"""Curvature over the size of a mesh below which it is none: fits of exact vertices leave as much."""


def parallel(mesh: Mesh, edges: Edges, fit: SurfaceFit, distance_mm: float) -> Mesh:
    """Return the mesh moved along its normals: those of the closest fit where vertices suffice for it."""
    closest = fitted_at(mesh, edges, mesh.vertices, np.arange(len(mesh.vertices)))
    normals = np.where(np.isfinite(closest.residual)[:, None], closest.normals, fit.normals)
    return Mesh(mesh.vertices + distance_mm * normals, mesh.faces)
