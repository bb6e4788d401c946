"""A parameter of the rulings of a mesh: a function on it that is all but constant along them.

    along(mesh, ways, bends) -> Values        ways(fit) -> directions, curvatures        zeros(t, bends) -> Values

Of each facet the gradient along the fitted ruling, weighted by the squared curvature of its corners, is to be 0, and
across it, with little weight, 1: least squares over the vertices.  Where the mesh hardly bends the neighbours decide.
Good to some thousandths of the range; whatever is fitted in terms of it has to find the rulings better.
"""

import numpy as np
from numpy.polynomial import chebyshev
from scipy.sparse import coo_array, csr_array, vstack
from scipy.sparse.csgraph import breadth_first_order
from scipy.sparse.linalg import spsolve

from stages.geometry.arrays import Array, Points3, Values, cross3, dot, norm
from stages.geometry.mesh.fit import SurfaceFit
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.topology import edges_of


def ways(fit: SurfaceFit) -> tuple[Points3, Values]:
    """Return the direction of greatest curvature at every vertex, either way, and that curvature, signed, 1/mm."""
    xx, xy, yy = fit.second.T
    values, axes = np.linalg.eigh(np.stack([xx, xy, xy, yy], axis=1).reshape(-1, 2, 2))
    most = np.argmax(np.abs(values), axis=1)
    row = np.arange(len(most))
    axis = axes[row, :, most]
    return axis[:, :1] * fit.x + axis[:, 1:] * fit.y, values[row, most]


def along(mesh: Mesh, across: Points3, bends: Values) -> Values:
    """Return a function on the vertices that is all but constant except along `across`, where the mesh bends.

    Of each facet the quadratic form of its gradient is that of the rulings of its corners, weighted by their squared
    curvature; what is left free, and the sense, is decided by the direction in which the weights are greatest.
    """
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    area = cross3(b - a, c - a)
    twice = norm(area)
    normal = area / twice[:, None]
    weight = np.minimum(np.abs(bends) / np.median(np.abs(bends)), 1.0) ** 2
    # the mean of w w^T over the corners: its sign does not matter
    spread = sum(
        weight[mesh.faces[:, k], None, None] * across[mesh.faces[:, k], :, None] * across[mesh.faces[:, k], None, :]
        for k in range(3)
    )
    values, axes = np.linalg.eigh(np.asarray(spread))
    way = axes[:, :, 2] - dot(axes[:, :, 2], normal)[:, None] * normal
    way /= norm(way)[:, None]
    sure = np.maximum(values[:, 2], 0.0)
    way = _one_way(mesh, way)
    ruling = cross3(normal, way)
    edges = np.stack([cross3(normal, c - b), cross3(normal, a - c), cross3(normal, b - a)]) / twice[:, None]
    root = np.sqrt(twice)
    rows = [
        _rows(mesh, edges, ruling, root * np.sqrt(sure)),
        _rows(mesh, edges, way, FREE * root),
    ]
    right = np.concatenate([np.zeros(len(root)), FREE * root])
    matrix = csr_array(vstack(rows))[:, 1:]
    solved = spsolve((matrix.T @ matrix).tocsc(), matrix.T @ right)
    return np.concatenate([[0.0], np.asarray(solved)])


FREE = 0.03
"""Weight of an even rate across the rulings beside no rate along them: about the error of fitted rulings, rad."""


def _rows(mesh: Mesh, edges: Array, way: Points3, weight: Values) -> coo_array:
    """Return the rows that give the rate of a function on the vertices along a direction of each facet, weighted."""
    count = len(mesh.faces)
    values = np.concatenate([weight * dot(edge, way) for edge in edges])
    at = (np.tile(np.arange(count), 3), mesh.faces.T.ravel())
    return coo_array((values, at), shape=(count, len(mesh.vertices)))


def _one_way(mesh: Mesh, way: Points3) -> Points3:
    """Return directions of the facets turned to agree with each other along a tree of shortest ways over edges."""
    one, other = (half // 3 for half in edges_of(mesh).pairs())
    graph = coo_array((np.ones(len(one)), (one, other)), shape=(len(way), len(way))).tocsr()
    order, before = breadth_first_order(graph, 0, directed=False)
    parent = np.arange(len(way))
    parent[order[1:]] = before[order[1:]]
    sign = np.where(dot(way, way[parent]) < 0.0, -1.0, 1.0)
    while not np.array_equal(parent, parent[parent]):
        sign, parent = sign * sign[parent], parent[parent]
    return np.asarray(sign[:, None] * way)


def zeros(t: Values, bends: Values) -> Array:
    """Return where the bending changes sign, over the range and a little beyond its ends."""
    capped = np.clip(bends / np.median(np.abs(bends)), -CAPPED, CAPPED)
    if np.all(capped > FLAT) or np.all(capped < -FLAT):
        return np.zeros(0)
    roots = chebyshev.chebroots(chebyshev.chebfit(t, capped, BEND_DEGREE))
    real = np.real(roots[np.abs(np.imag(roots)) <= REAL])
    return np.sort(real[np.abs(real) <= ENDS])


CAPPED, FLAT, BEND_DEGREE = 3.0, 0.02, 12
"""Curvatures, in medians: larger ones do not count as such; none below this means no change of sign."""
REAL, ENDS = 1e-6, 1.0
"""A double root splits into a pair with an imaginary part of the square root of rounding; t runs from -1 to 1."""
