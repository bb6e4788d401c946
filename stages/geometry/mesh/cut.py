"""Cutting a mesh open along edges such that it can be laid flat: which boundaries are ends, and the cuts between them.

The turning of a boundary loop, the sum of pi less the angle of the surface at each of its vertices, is 2 pi around a
flat disc, -2 pi around a hole in a developable surface wherever it lies, 0 at the end of a cylinder, and between -2
pi and 2 pi at the ends of a cone (the angle of its sector, minus that at the smaller end) [1]_.  So a loop is a hole
where its turning is -2 pi but for what the triangles make of it; every other loop is an end.  A surface with one end
is a disc with holes. One with several is a tube, and is cut from end to end until one end is left.

What the triangles make of -2 pi: along a smooth loop the angle at a vertex is off by about the square of the angle b
between the faces there, so a quarter of the sum of b^2 is allowed (b with what rounding to float32 may add); a hole
in a surface that is not developable hides the curvature that it took away, so three times the mean curvature times
the area of a disc of the loop's length is allowed too.  The small end of a cone that slopes by s from flat turns by
-2 pi + pi s^2, and is allowed pi^2 s^2 / n at n vertices: it is told from a hole from four vertices on.

Cuts run along the edges of the mesh: their vertices lie on the surface that was meshed, which points inside of
triangles do not.  The two sides of a cut are congruent, so that in the flat pattern both may be replaced by the
straight line between their ends, whatever the zigzag between.

.. [1] Gauss-Bonnet on a polyhedral surface: M. P. do Carmo, "Differential Geometry of Curves and Surfaces", 1976,
   section 4-5, with the angles at vertices for the integrals.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from stages.errors import NoSolutionError
from stages.geometry.arrays import Array, Indices, Numbers, Points3, Values, Vector3, cross3, dot, norm, unit
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.repair import ROUNDING
from stages.geometry.mesh.topology import (
    CORNERS,
    Edges,
    boundary_loops,
    by_first,
    edges_of,
    fans,
    half_edges,
    on_border,
)

PER_SQUARE = 0.25
"""Error of a hole's turning over the sum of the squared angles between its faces; at most 0.04 on meshed holes."""
PER_CURVATURE = 3.0
"""Curvature under a hole over the mean one times the area of the disc: 1.2 for a hole of 0.8 radii in a sphere."""


@dataclass(frozen=True, slots=True, eq=False)
class Opened:
    """A mesh cut open: one end, the other loops holes.

    loops: the boundary loops, the outer one first.
    seams: the two sides of every cut, vertex by vertex, each from one end to the other.
    original: the vertex of the mesh before that each vertex is, or is a copy of.
    """

    mesh: Mesh
    loops: tuple[Numbers, ...]
    seams: tuple[tuple[Numbers, Numbers], ...]
    original: Indices


def corner_angles(mesh: Mesh) -> Values:
    """Return the angle at each corner, rad, in the order of the half-edges."""
    corners = mesh.vertices[mesh.faces]
    ahead, back = corners[:, [1, 2, 0]] - corners, corners[:, [2, 0, 1]] - corners
    a, b = ahead.reshape(-1, 3), back.reshape(-1, 3)
    return np.asarray(np.arctan2(norm(cross3(a, b)), dot(a, b)))


def angle_sums(mesh: Mesh) -> Values:
    """Return the angle of the surface at each vertex, rad."""
    return np.bincount(mesh.faces.reshape(-1), corner_angles(mesh), minlength=len(mesh.vertices))


def bends(mesh: Mesh, edges: Edges) -> Values:
    """Return at each vertex the largest angle between faces that meet at an edge there, rad."""
    one, other = edges.pairs()
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(CORNERS))
    normals = unit(cross3(b - a, c - a))
    m, n = normals[one // CORNERS], normals[other // CORNERS]
    bend = np.arctan2(norm(cross3(m, n)), dot(m, n))
    largest = np.zeros(len(mesh.vertices))
    for end in half_edges(mesh.faces):
        np.maximum.at(largest, end[one], bend)
    return largest


def turnings(mesh: Mesh, loops: tuple[Numbers, ...]) -> Values:
    """Return the turning of each boundary loop, rad, positive where it turns towards the surface."""
    sums = angle_sums(mesh)
    return np.array([float(np.sum(np.pi - sums[loop])) for loop in loops])


def hole_allowances(mesh: Mesh, edges: Edges, loops: tuple[Numbers, ...]) -> Values:
    """Return how far from -2 pi the turning of each loop may be if it is a hole, rad."""
    sums, bend = angle_sums(mesh), bends(mesh, edges)
    inner = np.ones(len(mesh.vertices), dtype=bool)
    inner[np.concatenate(loops)] = False
    density = abs(float(np.sum(2.0 * np.pi - sums[inner]))) / area(mesh)
    rounding = ROUNDING * float(np.abs(mesh.vertices).max())
    allowed = []
    for loop in loops:
        sides = norm(mesh.vertices[np.roll(loop, -1)] - mesh.vertices[loop])
        bent = float(np.sum((bend[loop] + rounding / sides) ** 2))
        allowed.append(PER_SQUARE * bent + PER_CURVATURE * density * float(sides.sum()) ** 2 / (4.0 * np.pi))
    return np.array(allowed)


def area(mesh: Mesh) -> float:
    """Return the area of the triangles, mm2."""
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(CORNERS))
    return float(norm(cross3(b - a, c - a)).sum() / 2.0)


def ends_of(mesh: Mesh, edges: Edges, loops: tuple[Numbers, ...]) -> Indices:
    """Return which boundary loops are ends, the one that turns most first; the others are holes."""
    turning = turnings(mesh, loops)
    is_end = np.abs(turning + 2.0 * np.pi) > hole_allowances(mesh, edges, loops)
    order = np.argsort(-turning, kind="stable")
    outer = order[0]
    return np.array([outer, *(i for i in order[1:] if is_end[i])], dtype=np.int64)


def opened(mesh: Mesh, seam: Points3 | None = None) -> Opened:
    """Return a connected oriented surface cut until it has one end.

    seam: points near which the first cut runs; without it every cut is the shortest way between two ends.
    Raises NoSolutionError where no way along the edges leads from end to end.
    """
    now, original = mesh, np.arange(len(mesh.vertices))
    cuts: list[tuple[Numbers, Numbers]] = []
    while True:
        edges = edges_of(now)
        loops = boundary_loops(now, edges)
        ends = ends_of(now, edges, loops) if loops else np.zeros(0, dtype=np.int64)
        if seam is not None and not cuts:
            path = along(now, edges, seam, tuple(loops[i] for i in ends))
        elif len(ends) > 1:
            free = [np.setdiff1d(loops[i], _vertices(now, cuts)) for i in ends]
            path = shortest(now, edges, free[0], np.concatenate(free[1:]))
        else:
            rest = sorted(set(range(len(loops))) - {int(i) for i in ends})
            sides = tuple((run_along(now, left), run_along(now, right)[::-1]) for left, right in cuts)
            return Opened(now, tuple(loops[i] for i in (*ends, *rest)), sides, original)
        left, right = halves_along(now, edges, path)
        now, of = parted(now, edges, edges.of_half[left])
        if len(of) == len(original):
            raise NoSolutionError("a cut inside the mesh, which opens nothing", reached=1.0, wanted=2.0, unit="edges")
        original = original[of]
        cuts.append((left, right))


def _vertices(mesh: Mesh, cuts: list[tuple[Numbers, Numbers]]) -> Indices:
    """Return the vertices on the sides of cuts."""
    start, end = half_edges(mesh.faces)
    halves = np.concatenate([np.zeros(0, dtype=np.int64), *(side for cut in cuts for side in cut)])
    return np.unique(np.concatenate([start[halves], end[halves]]))


def run_along(mesh: Mesh, halves: Indices) -> Numbers:
    """Return the vertices along half-edges that follow each other."""
    start, end = half_edges(mesh.faces)
    return np.append(start[halves], end[halves[-1:]])


def halves_along(mesh: Mesh, edges: Edges, path: Indices) -> tuple[Numbers, Numbers]:
    """Return the half-edges along a path of vertices, and those against it from its end to its beginning."""
    start, _ = half_edges(mesh.faces)
    order = np.argsort(edges.of_half, kind="stable")
    begins = np.cumsum(edges.count) - edges.count
    n = len(mesh.vertices)
    wanted = np.minimum(path[1:], path[:-1]) * n + np.maximum(path[1:], path[:-1])
    closed = np.searchsorted(edges.ends[:, 0] * n + edges.ends[:, 1], wanted)
    one, other = order[begins[closed]], order[begins[closed] + 1]
    forward = start[one] == path[:-1]
    return np.where(forward, one, other), np.where(forward, other, one)[::-1]


def edge_lengths(mesh: Mesh, edges: Edges) -> Values:
    """Return the length of each edge, mm."""
    return norm(mesh.vertices[edges.ends[:, 1]] - mesh.vertices[edges.ends[:, 0]])


def shortest(mesh: Mesh, edges: Edges, one: Numbers, other: Numbers, weight: Values | None = None) -> Numbers:
    """Return the vertices of the shortest way along edges from one set of vertices to another.

    weight: of each edge, its length in mm if absent.  Inside it touches no boundary, so that the cut leaves no pinched
    vertex.
    """
    weight = edge_lengths(mesh, edges) if weight is None else weight
    allowed = ~on_border(mesh, edges)
    allowed[one] = True
    allowed[other] = True
    a, b = edges.ends.T
    passable = allowed[a] & allowed[b] & (edges.count > 1)
    graph = coo_array((weight[passable], (a[passable], b[passable])), shape=(len(allowed), len(allowed))).tocsr()
    if not len(one) or not len(other) or np.array_equal(one, other):
        raise NoSolutionError("a cut along the edges of the mesh", reached=0.0, wanted=1.0, unit="edges")
    far, before, _ = dijkstra(graph, directed=False, indices=one, min_only=True, return_predecessors=True)
    goal = int(other[np.argmin(far[other])])
    if not np.isfinite(far[goal]):
        raise NoSolutionError("a cut along inner edges of the mesh", reached=0.0, wanted=1.0, unit="edges")
    path = [goal]
    while before[path[-1]] >= 0:
        path.append(int(before[path[-1]]))
    return _between_ends(np.array(path[::-1], dtype=np.int64), one, other)


def _between_ends(path: Numbers, one: Numbers, other: Numbers) -> Numbers:
    """Return the piece of a way after it last leaves one set and before it first meets the other."""
    first = int(np.flatnonzero(np.isin(path, one))[-1])
    last = first + 1 + int(np.flatnonzero(np.isin(path[first + 1 :], other))[0])
    return path[first : last + 1]


NEAR = 2.0
"""Edges as far from the seam as the mean edge is long count so many times their length more."""


def along(mesh: Mesh, edges: Edges, seam: Points3, ends: tuple[Numbers, ...]) -> Numbers:
    """Return the way along edges that follows a polyline, snapped to the nearest vertices.

    On a tube it leads from the end nearest to the first point to another end, nearest to the last one.
    """
    lengths = edge_lengths(mesh, edges)
    middle = mesh.vertices[edges.ends].mean(axis=1)
    weight = lengths * (1.0 + NEAR * (distance_to(middle, seam) / lengths.mean()) ** 2)
    if len(ends) > 1:
        starts = [_nearest(mesh, loop, seam[0]) for loop in ends]
        first = int(np.argmin([norm(mesh.vertices[v] - seam[0]) for v in starts]))
        goals = np.concatenate([loop for i, loop in enumerate(ends) if i != first])
        goal = _nearest(mesh, goals, seam[-1])
        return shortest(mesh, edges, np.array([starts[first]]), np.array([goal]), weight)
    first, last = (snapped(mesh, edges, point, lengths.mean()) for point in (seam[0], seam[-1]))
    return shortest(mesh, edges, np.array([first]), np.array([last]), weight)


def snapped(mesh: Mesh, edges: Edges, point: Vector3, edge_mm: float) -> int:
    """Return the vertex nearest to a point; one on the boundary if that is less than a mean edge farther."""
    every, border = np.arange(len(mesh.vertices)), np.unique(edges.ends[edges.count == 1])
    nearest = _nearest(mesh, every, point)
    if len(border):
        outer = _nearest(mesh, border, point)
        if norm(mesh.vertices[outer] - point) < norm(mesh.vertices[nearest] - point) + edge_mm:
            return outer
    return nearest


def _nearest(mesh: Mesh, among: Indices, point: Vector3) -> int:
    return int(among[np.argmin(norm(mesh.vertices[among] - point))])


def distance_to(points: Points3, polyline: Array) -> Values:
    """Return the distance of each point from a polyline, mm."""
    best = norm(points - polyline[0])
    for a, b in pairwise(polyline):
        step = b - a
        share = np.clip((points - a) @ step / max(float(step @ step), np.finfo(float).tiny), 0.0, 1.0)
        best = np.minimum(best, norm(points - a - share[:, None] * step))
    return best


def parted(mesh: Mesh, edges: Edges, closed: Indices) -> tuple[Mesh, Numbers]:
    """Return the mesh with a copy of each vertex for every fan that the cut edges leave there, and whose copy it is.

    The first fan keeps the number of its vertex; the copies come after all vertices.
    """
    _, labels = fans(mesh, edges, closed)
    labels = by_first(labels)
    start, _ = half_edges(mesh.faces)
    _, first = np.unique(labels, return_index=True)
    vertex = start[first]
    _, keeps = np.unique(vertex, return_index=True)
    is_copy = np.ones(len(vertex), dtype=bool)
    is_copy[keeps] = False
    numbers = vertex.copy()
    numbers[is_copy] = len(mesh.vertices) + np.arange(int(is_copy.sum()))
    of = np.concatenate([np.arange(len(mesh.vertices)), vertex[is_copy]])
    return Mesh(mesh.vertices[of], numbers[labels].reshape(-1, CORNERS)), of
