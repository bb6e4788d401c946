"""How far points lie beyond the border of a mesh that they are nearest to."""

import numpy as np

from stages.geometry.arrays import Mask, Points3, Values, cross3, dot, norm, unit
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.nearest import OnMesh, at
from stages.geometry.mesh.topology import Edges


def beyond(mesh: Mesh, edges: Edges, points: Points3, there: OnMesh) -> Values:
    """Return how far points lie beyond the border, along the triangle that each is nearest to, mm; 0 inside.

    there: their nearest places.  What is nearest to a border vertex may be found on a triangle without a free side.
    """
    free = edges.count[edges.of_half].reshape(-1, 3) == 1
    on_border = np.isin(np.arange(len(mesh.vertices)), mesh.faces[free | np.roll(free, 1, axis=1)])
    # the side that begins at corner k lies across from corner k + 2; one corner alone is a vertex
    touched = there.weights > 0.0
    across = (np.roll(free, 2, axis=1)[there.faces] & ~touched).any(axis=1)
    alone = touched.sum(axis=1) == 1
    corner = mesh.faces[there.faces, np.argmax(there.weights, axis=1)]
    outside: Mask = np.where(alone, on_border[corner], across)
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces[there.faces]], 1, 0)
    normal = unit(cross3(b - a, c - a))
    off = points - at(mesh, there, mesh.vertices)
    return np.asarray(np.where(outside, norm(off - dot(off, normal)[:, None] * normal), 0.0))
