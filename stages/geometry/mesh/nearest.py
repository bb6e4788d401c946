"""The nearest point of a triangle mesh to a point in space.

The triangle whose centre is nearest gives a distance d; what is nearer yet has its centre within d plus the radius of
the largest triangle, and each of those is asked (the regions of a triangle: C. Ericson, "Real-Time Collision
Detection", 2005, section 5.1.5).  Exact to rounding; slow only where one triangle is very much larger than the rest.
"""

from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Array, ArrayValue, Numbers, Points3, Values, cross3, dot, norm
from stages.geometry.mesh.mesh import Mesh


@dataclass(frozen=True, slots=True, eq=False)
class OnMesh(ArrayValue):
    """Points of a mesh.

    faces: shape (k,), the triangle of each.  weights: shape (k, 3), its share of the triangle's corners, summing to 1.
    distances: shape (k,), mm from the points asked for.
    """

    faces: Numbers
    weights: Array
    distances: Values


def nearest(mesh: Mesh, points: Points3) -> OnMesh:
    """Return the point of the mesh that is nearest to each of the points, mm."""
    from scipy.spatial import cKDTree

    corners = mesh.vertices[mesh.faces]
    centres = corners.mean(axis=1)
    reach = float(norm(corners - centres[:, None]).max())
    tree = cKDTree(centres)
    first = np.asarray(tree.query(points)[1])
    upper = norm(points - _closest(corners[first], points)[0])
    faces = [np.asarray(tree.query_ball_point(point, far + reach)) for point, far in zip(points, upper, strict=True)]
    found = [
        _best(corners, np.append(near, start), point) for near, start, point in zip(faces, first, points, strict=True)
    ]
    return OnMesh(
        np.array([face for face, _, _ in found], dtype=np.int64),
        np.array([weights for _, weights, _ in found]).reshape(-1, 3),
        np.array([distance for _, _, distance in found], dtype=np.float64),
    )


def at(mesh: Mesh, found: OnMesh, values: Array) -> Array:
    """Return values given at the vertices, shape (n, c), at points of the mesh: linear in each triangle."""
    mixed: Array = np.einsum("kj,kjc->kc", found.weights, values[mesh.faces[found.faces]])
    return mixed


def _best(corners: Array, faces: Numbers, point: Array) -> tuple[int, Array, float]:
    """Return the triangle nearest to a point, the weights of its corners, and the distance."""
    faces = faces.astype(np.int64)
    there = np.broadcast_to(point, (faces.size, 3))
    on, weights = _closest(corners[faces], there)
    far = norm(there - on)
    best = int(np.argmin(far))
    return int(faces[best]), weights[best], float(far[best])


def _closest(corners: Array, points: Points3) -> tuple[Points3, Array]:
    """Return the nearest point of each triangle, corners of shape (k, 3, 3), to its point, and its corners' weights."""
    inside = _inside(corners, points)
    candidates = [inside, *(_on_edge(corners, points, i, (i + 1) % 3) for i in range(3))]
    places = np.stack([np.einsum("kj,kjc->kc", weights, corners) for weights in candidates])
    far = norm(points - places)
    far[0, (inside < 0.0).any(axis=1)] = np.inf
    best, every = np.argmin(far, axis=0), np.arange(len(points))
    return places[best, every], np.stack(candidates)[best, every]


def _inside(corners: Array, points: Points3) -> Array:
    """Return the weights of the corners at the foot of the normal; negative where it lies outside or is not defined."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    normal = cross3(b - a, c - a)
    area = dot(normal, normal)
    second = dot(cross3(points - a, c - a), normal)
    third = dot(cross3(b - a, points - a), normal)
    weights = np.stack([area - second - third, second, third], axis=1)
    flat = area <= 0.0
    weights[flat] = -1.0
    return weights / np.where(flat, 1.0, area)[:, None]


def _on_edge(corners: Array, points: Points3, i: int, j: int) -> Array:
    """Return the weights of the corners at the nearest point of one edge."""
    along = corners[:, j] - corners[:, i]
    square = dot(along, along)
    share = np.clip(dot(points - corners[:, i], along) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    weights = np.zeros((len(points), 3))
    weights[:, i], weights[:, j] = 1.0 - share, share
    return weights
