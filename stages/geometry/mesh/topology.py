"""How the triangles of a mesh hang together: edges, pieces, sides, boundaries, holes, places where it is no surface.

Half-edge 3f + i runs from corner i of face f to the next one; half-edges between the same two vertices are one edge.
Where at most two faces meet at every edge, and the faces about every vertex follow each other, the mesh is a surface
(a manifold, with boundary); it has two sides if the faces can be turned such that neighbours run along their common
edge in opposite directions.  Pieces, fans about vertices and sides are connected components of graphs: of the faces,
of their corners, and of the faces each taken twice, once for either side [1]_.  Nothing here looks at positions.

.. [1] The double cover: a face joined to itself turned over lies on a one-sided surface (J. Stillwell, "Classical
   Topology and Combinatorial Group Theory", 2nd ed., 1993, section 1.3).
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from stages.geometry.arrays import ArrayValue, Indices, Mask, Numbers, Pairs, Triples
from stages.geometry.mesh.mesh import Mesh

CORNERS = 3
"""Of a triangle, and its sides."""


@dataclass(frozen=True, slots=True, eq=False)
class Edges(ArrayValue):
    """The edges of a mesh.

    ends: shape (k, 2), the two vertices, the lower number first; edges in rising order.
    of_half: the edge of each half-edge.
    count: how many faces meet there.
    """

    ends: Pairs
    of_half: Numbers
    count: Numbers

    @property
    def border(self) -> Indices:
        """Return the half-edges of the boundary: those on edges of one face."""
        return np.flatnonzero(self.count[self.of_half] == 1)

    def pairs(self) -> tuple[Indices, Indices]:
        """Return the half-edges that meet at edges of two faces, the lower number first."""
        order = np.argsort(self.of_half, kind="stable")
        begins = np.cumsum(self.count) - self.count
        inner = begins[self.count == len("ab")]
        return order[inner], order[inner + 1]


def half_edges(faces: Triples) -> tuple[Indices, Indices]:
    """Return the vertices at which each half-edge begins and ends."""
    return faces.reshape(-1), faces[:, [1, 2, 0]].reshape(-1)


def edges_of(mesh: Mesh) -> Edges:
    """Return the edges of a mesh."""
    start, end = half_edges(mesh.faces)
    n = max(len(mesh.vertices), 1)
    keys, of_half, count = np.unique(
        np.minimum(start, end) * n + np.maximum(start, end), return_inverse=True, return_counts=True
    )
    return Edges(np.stack([keys // n, keys % n], axis=1), of_half, count)


def edge_numbers(edges: Edges, pairs: Numbers) -> Numbers:
    """Return the numbers of the edges between pairs of vertices, shape (k, 2); -1 where there is no edge."""
    n = int(edges.ends.max(initial=0)) + 1
    low, high = np.sort(pairs, axis=1).T
    keys = edges.ends[:, 0] * n + edges.ends[:, 1]
    at = np.minimum(np.searchsorted(keys, low * n + high), len(keys) - 1)
    return np.where((keys[at] == low * n + high) & (high < n), at, -1)


def linked(count: int, one: Indices, other: Indices) -> tuple[int, Numbers]:
    """Return the number of connected components of a graph, and that of each of its `count` nodes."""
    graph = coo_array((np.ones(len(one), dtype=np.int8), (one, other)), shape=(count, count))
    found, labels = connected_components(graph, directed=False)
    return int(found), labels.astype(np.int64)


def pieces(mesh: Mesh, edges: Edges) -> tuple[int, Indices]:
    """Return the number of pieces joined along edges, and that of each face; numbered by their first faces."""
    order = np.argsort(edges.of_half, kind="stable")
    same = edges.of_half[order[1:]] == edges.of_half[order[:-1]]
    found, labels = linked(len(mesh.faces), order[1:][same] // CORNERS, order[:-1][same] // CORNERS)
    return found, by_first(labels)


def by_first(labels: Indices) -> Indices:
    """Return labels numbered anew in the order in which they first occur."""
    _, first, which = np.unique(labels, return_index=True, return_inverse=True)
    rank = np.zeros(len(first), dtype=np.int64)
    rank[np.argsort(first)] = np.arange(len(first))
    return rank[which]


def turned(mesh: Mesh, edges: Edges) -> Indices | None:
    """Return the faces to turn over so that all run alike; None for a one-sided surface.

    Of each piece the smaller half is turned, its first face kept where the halves are equal.  Only for meshes in which
    at most two faces meet at an edge.
    """
    one, other = edges.pairs()
    start, _ = half_edges(mesh.faces)
    against = start[one] == start[other]
    if not against.any():
        return np.zeros(0, dtype=np.int64)
    m, a, b = len(mesh.faces), one // CORNERS, other // CORNERS
    found, labels = linked(
        2 * m, np.concatenate([a, a + m]), np.concatenate([b + m * against, b + m * (1 - against.astype(np.int64))])
    )
    upper, lower = labels[:m], labels[m:]
    if (upper == lower).any():
        return None
    score = 2 * m * np.bincount(upper, minlength=found)
    np.maximum.at(score, upper, score[upper] + m - np.arange(m))
    return np.flatnonzero(score[upper] < score[lower])


def with_turned(mesh: Mesh, faces: Indices) -> Mesh:
    """Return the mesh with some faces turned over."""
    changed = mesh.faces.copy()
    changed[faces] = changed[faces][:, [0, 2, 1]]
    return Mesh(mesh.vertices, changed)


def fans(mesh: Mesh, edges: Edges, closed: Indices | None = None) -> tuple[int, Numbers]:
    """Return the number of fans, and that of each corner: runs of faces about one vertex that share edges.

    A vertex with two fans is where a surface touches itself at a point.  closed: edges that count as cut.
    """
    one, other = edges.pairs()
    if closed is not None:
        shut = np.zeros(len(edges.count), dtype=np.int64)
        shut[closed] = 1
        kept = shut[edges.of_half[one]] == 0
        one, other = one[kept], other[kept]
    start, _ = half_edges(mesh.faces)
    opposite = start[one] != start[other]
    at_start, at_end = np.where(opposite, _next(other), other), np.where(opposite, other, _next(other))
    count = CORNERS * len(mesh.faces)
    return linked(count, np.concatenate([one, _next(one)]), np.concatenate([at_start, at_end]))


def _next(half: Indices) -> Indices:
    """Return the next half-edge of the same face; its beginning is the corner where the half-edge ends."""
    following: Indices = half - half % CORNERS + (half % CORNERS + 1) % CORNERS
    return following


def pinched(mesh: Mesh, edges: Edges) -> Indices:
    """Return the vertices about which the faces make more than one fan."""
    start, _ = half_edges(mesh.faces)
    _, labels = fans(mesh, edges)
    _, first = np.unique(labels, return_index=True)
    return np.flatnonzero(np.bincount(start[first], minlength=len(mesh.vertices)) > 1)


def on_border(mesh: Mesh, edges: Edges) -> Mask:
    """Return whether each vertex is on the boundary."""
    border = np.zeros(len(mesh.vertices), dtype=bool)
    border[edges.ends[edges.count == 1]] = True
    return border


def boundary_loops(mesh: Mesh, edges: Edges) -> tuple[Numbers, ...]:
    """Return the vertices of every boundary loop, in the direction in which the surface lies on the left.

    Each begins at its lowest number; the loops are in the order of these.  Only for oriented surfaces without pinched
    vertices.
    """
    start, end = half_edges(mesh.faces)
    border = edges.border
    following = dict(zip(start[border].tolist(), end[border].tolist(), strict=True))
    loops = []
    for first in sorted(following):
        if first not in following:
            continue
        loop, at = [first], following.pop(first)
        while at != first:
            loop.append(at)
            at = following.pop(at)
        loops.append(np.array(loop, dtype=np.int64))
    return tuple(loops)


def euler_characteristic(mesh: Mesh, edges: Edges) -> int:
    """Return vertices - edges + faces; vertices that no face uses do not count."""
    return len(used(mesh.faces)) - len(edges.count) + len(mesh.faces)


def used(faces: Numbers) -> Numbers:
    """Return the vertices that some face names, in rising order; by counting, which is faster than sorting."""
    return np.flatnonzero(np.bincount(faces.reshape(-1), minlength=1))


def compact(mesh: Mesh) -> Mesh:
    """Return the mesh without the vertices that no face names; the others keep their order."""
    kept = used(mesh.faces)
    numbers = np.zeros(len(mesh.vertices), dtype=np.int64)
    numbers[kept] = np.arange(len(kept))
    return Mesh(mesh.vertices[kept], numbers[mesh.faces])


def genus(characteristic: int, loops: int) -> int:
    """Return the number of handles of a connected two-sided surface with so many boundary loops."""
    return (2 - characteristic - loops) // 2


def part_of(mesh: Mesh, faces: Indices) -> Mesh:
    """Return some faces of a mesh, with the vertices that they use, in the order they had."""
    return compact(Mesh(mesh.vertices, mesh.faces[faces]))
