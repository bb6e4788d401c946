"""A formed part of several faces as triangles, so that it is drawn as it is trimmed.

Each face is cut into cells of u and v inside its outline, and the cells into triangles: off the face by the sagitta of
a cell, and good for a picture only.
"""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from stages.geometry.arrays import Numbers, Points2, Points3
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.ruled.strip import Strip, points
from stages.model.surface import BranchedSurface, MeshSurface, RuledSurface, Trim

CELLS = 8
"""Cells along the rulings, and across them in each patch."""
SAMPLES = 17


def as_mesh(surface: BranchedSurface) -> MeshSurface:
    """Return the faces as triangles, and their outlines as loops."""
    vertices: list[Points3] = []
    triangles: list[Numbers] = []
    loops: list[Numbers] = []
    for face in surface.faces:
        corners, rings = drawn(face)
        first = sum(len(one) for one in vertices)
        vertices.append(corners)
        triangles.append(first + np.arange(len(corners)).reshape(-1, 3))
        for ring in rings:
            loops.append(sum(len(one) for one in vertices) + np.arange(len(ring)))
            vertices.append(ring)
    mesh = Mesh(np.concatenate(vertices), np.concatenate(triangles))
    return MeshSurface(surface.part, mesh, tuple(loops), surface.size_mm)


def drawn(face: RuledSurface) -> tuple[Points3, list[Points3]]:
    """Return the corners of the triangles of a face, three each, and its loops, mm."""
    if face.trim is None:
        raise ValueError("a face of a branched surface has no trim")
    strip = strip_of(face)
    rings = _rings(face.trim)
    corners = np.concatenate(list(_triangles(rings, strip.knots)))
    return points(strip, *corners.T), [points(strip, *ring.T) for ring in rings]


def strip_of(face: RuledSurface) -> Strip:
    """Return a face with the v at which its patches begin and end."""
    return Strip(face.patches, np.array([*(float(low) for low, _ in face.spans), float(face.spans[-1][1])]))


def _rings(trim: Trim) -> list[Points2]:
    """Return the loops of a trim as polygons of u and v."""
    t = np.linspace(0.0, 1.0, SAMPLES)[:-1]
    return [np.concatenate([curve.at(t) for curve in loop]) for loop in (trim.outer, *trim.inner)]


def _triangles(rings: list[Points2], knots: Points2) -> Iterator[Points2]:
    """Yield the corners of triangles of u and v, three rows each, counter-clockwise."""
    import shapely

    area = shapely.make_valid(shapely.Polygon(rings[0], rings[1:]))
    across = np.linspace(0.0, 1.0, CELLS + 1)
    along = np.unique(np.concatenate([np.linspace(a, b, CELLS + 1) for a, b in pairwise(knots)]))
    for low, high in pairwise(along):
        for left, right in pairwise(across):
            cell = shapely.clip_by_rect(area, left, low, right, high)
            for one in shapely.constrained_delaunay_triangles(cell).geoms:
                yield np.asarray(shapely.orient_polygons(one).exterior.coords)[:3]
