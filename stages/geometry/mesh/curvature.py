"""The Gaussian curvature of the surface behind a mesh, as means over regions of many triangles.

The curved edges' lengths make an intrinsic metric whose whole curvature sits in the vertices: 2 pi less the angles
around each.  Single defects are noise, and so is their sum over a region, which by Gauss and Bonnet is the turning
of its boundary. Weighted with a bump, (1 - r^2 / R^2)^3 around a centre in the plane, that fades out with two
derivatives, the sum is by parts an integral of the lengths' errors against second derivatives of the bump: errors
of single vertices cancel inside, and nothing is left at the boundary [1]_.

A mean curvature K over a region through which a ruling of length l passes is that of a surface whose normal turns
by w = l sqrt |K| along that ruling: the equivalent warp.  On a hyperbolic paraboloid over a square, K = -w^2 / l^2.

.. [1] Weak form of the curvature: M. Spivak, "A Comprehensive Introduction to Differential Geometry" III, 1979, ch.
   6, and J. Cheeger, W. Mueller, R. Schrader, "On the curvature of piecewise flat spaces", Comm. Math. Phys. 92,
   1984, 405-454.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from stages.geometry.arrays import Array, ArrayValue, Indices, Mask, Numbers, Points2, Values, cross2, dot, norm
from stages.geometry.mesh.intrinsic import areas, laid
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.topology import Edges

FEWEST = 6.0
"""Least radius of a region in mean edges: a hundred vertices."""
SCALES = (1.0, 0.5)
"""Radii of regions, as shares of the largest circle that fits."""
MOST = 80
"""Regions of one scale: beyond, they only overlap more."""
NARROWEST = 0.3
"""Least radius of a region as a share of its scale: parts that are narrower have no region of that scale."""


@dataclass(frozen=True, slots=True, eq=False)
class Regions(ArrayValue):
    """Bumps over a flattened mesh.

    centres: their middle vertices.  radii: mm.  scale: which of `SCALES` each is of.
    weights: shape (regions, vertices), the bump's values.
    """

    centres: Indices
    radii: Values
    scale: Indices
    weights: csr_array


def defects(mesh: Mesh, edges: Edges, lengths: Array) -> Values:
    """Return 2 pi less the angles around every vertex inside, rad, from the lengths of the edges; 0 at the boundary."""
    corners = laid(lengths[edges.of_half].reshape(-1, 3))
    a, b = corners[:, [1, 2, 0]] - corners, corners[:, [2, 0, 1]] - corners
    angles = np.arctan2(cross2(a, b), dot(a, b))
    total = 2.0 * np.pi - np.bincount(mesh.faces.ravel(), angles.ravel(), minlength=len(mesh.vertices))
    total[edges.ends[edges.count == 1].ravel()] = 0.0
    return np.asarray(total)


def shares(mesh: Mesh, edges: Edges, lengths: Array) -> Values:
    """Return a third of the area of the triangles around every vertex, mm2."""
    area = areas(laid(lengths[edges.of_half].reshape(-1, 3)))
    return np.bincount(mesh.faces.ravel(), np.repeat(area / 3.0, 3), minlength=len(mesh.vertices))


def regions(edges: Edges, flat: Points2) -> Regions:
    """Return bumps that cover the flattened mesh, as far as circles fit that are large enough."""
    border = np.unique(edges.ends[edges.count == 1])
    room = cKDTree(flat[border]).query(flat)[0]
    least = FEWEST * float(norm(flat[edges.ends[:, 1]] - flat[edges.ends[:, 0]]).mean())
    found = [
        (centre, radius, k)
        for k, share in enumerate(SCALES)
        for centre, radius in _covering(flat, np.minimum(room, share * room.max()), least)
    ]
    centres, radii, scale = (np.array(x) for x in zip(*found, strict=True)) if found else (np.zeros(0),) * 3
    rows = _bumps(edges, flat, centres.astype(np.int64), radii.astype(np.float64))
    return Regions(centres.astype(np.int64), radii.astype(np.float64), scale.astype(np.int64), rows)


def _covering(flat: Points2, room: Values, least: float) -> list[tuple[int, float]]:
    """Return centres and radii of circles: always the largest that fits among those not yet near a centre."""
    left = room.copy()
    found: list[tuple[int, float]] = []
    least = max(least, NARROWEST * float(room.max()))
    while len(found) < MOST and left.max() >= least:
        centre = int(np.argmax(left))
        found.append((centre, float(room[centre])))
        left[norm(flat - flat[centre]) < room[centre]] = 0.0
    return found


def _bumps(edges: Edges, flat: Array, centres: Indices, radii: Values) -> csr_array:
    """Return the bumps' values at the vertices, shape (regions, vertices), each on its own layer of the pattern."""
    rows, columns, values = [np.zeros(0, dtype=np.int64)], [np.zeros(0, dtype=np.int64)], [np.zeros(0)]
    links = csr_array((np.ones(len(edges.ends)), tuple(edges.ends.T)), shape=(len(flat), len(flat)))
    for k, (centre, radius) in enumerate(zip(centres, radii, strict=True)):
        inside = np.flatnonzero(norm(flat - flat[centre]) < radius)
        labels = connected_components(links[inside][:, inside], directed=False)[1]
        inside = inside[labels == labels[np.searchsorted(inside, centre)]]
        share = norm(flat[inside] - flat[centre]) / radius
        rows.append(np.full(len(inside), k))
        columns.append(inside)
        values.append((1.0 - share**2) ** 3)
    places = np.concatenate(rows), np.concatenate(columns)
    return csr_array((np.concatenate(values), places), shape=(len(centres), len(flat)))


def means(found: Regions, defect: Array, area: Array) -> Values:
    """Return the mean Gaussian curvature of every region, 1/mm2."""
    return np.asarray((found.weights @ defect) / (found.weights @ area))


def spread(found: Regions, differences: Values) -> Values:
    """Return the standard deviation of every region's mean, from two means each that differ by noise alone.

    By noise of single vertices it falls with the cube of the radius: two powers from the bump's second derivatives, one
    from the number of vertices; so all regions together tell it.
    """
    return np.asarray(np.sqrt(np.mean((differences * found.radii**3) ** 2)) / found.radii**3)


def ruling_lengths(mesh: Mesh, edges: Edges, flat: Array, normals: Array, found: Regions) -> Values:
    """Return how long the rulings through the regions' centres are in the plane, mm, the longer where there are two."""
    a, b = edges.ends.T
    way, flat_way = mesh.vertices[b] - mesh.vertices[a], flat[b] - flat[a]
    bend = -dot(normals[b] - normals[a], way)
    x, y = flat_way.T
    terms = np.stack([x * x, 2.0 * x * y, y * y], axis=1)
    border = edges.ends[edges.count == 1]
    lengths = np.zeros(len(found.centres))
    for k, centre in enumerate(found.centres):
        weight = _row(found.weights, k, len(flat))[a]
        near = weight > 0.0
        form = np.linalg.lstsq(terms[near] / norm(flat_way[near])[:, None], (bend / norm(flat_way))[near], rcond=None)[
            0
        ]
        lengths[k] = max(_extent(flat, border, flat[centre], along) for along in _rulings(form))
    return lengths


def _row(weights: csr_array, k: int, count: int) -> Values:
    """Return one region's bump at all vertices."""
    whole = np.zeros(count)
    part = slice(weights.indptr[k], weights.indptr[k + 1])
    whole[weights.indices[part]] = weights.data[part]
    return whole


def _rulings(form: Array) -> list[Array]:
    """Return the directions without normal curvature of a second fundamental form, or that of the least."""
    xx, xy, yy = form
    values, axes = np.linalg.eigh(np.array([[xx, xy], [xy, yy]]))
    low, high = values
    if low < 0.0 < high:
        steep = np.arctan2(np.sqrt(-low), np.sqrt(high))
        return [np.cos(steep) * axes[:, 0] + sign * np.sin(steep) * axes[:, 1] for sign in (-1.0, 1.0)]
    return [axes[:, int(np.argmin(np.abs(values)))]]


def _extent(flat: Points2, border: Numbers, centre: Array, along: Array) -> float:
    """Return how far the line through a place runs within the nearest boundary edges on both sides, mm."""
    p, q = flat[border[:, 0]] - centre, flat[border[:, 1]] - centre
    side_p, side_q = (cross2(np.broadcast_to(along, x.shape), x) for x in (p, q))
    crossed: Mask = (side_p > 0.0) != (side_q > 0.0)
    share = side_p[crossed] / (side_p[crossed] - side_q[crossed])
    reach = (p[crossed] + share[:, None] * (q[crossed] - p[crossed])) @ along
    ahead, behind = reach[reach > 0.0], -reach[reach <= 0.0]
    return float(ahead.min(initial=np.inf) + behind.min(initial=np.inf)) if len(ahead) and len(behind) else 0.0
