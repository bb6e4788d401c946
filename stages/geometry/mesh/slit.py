"""Lines on a mesh: ways along its edges near a line of points, and slits from the boundary inwards.

A slit doubles the vertices of a way except the last, so that a dart can open there or close.  Lines of single edges and
of the boundary follow the line of points as well as the edges allow: every edge counts its length, times the more the
farther it lies from the line (`cut.along`).
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from stages.errors import NoSolutionError
from stages.geometry.arrays import Indices, Numbers, Points3, Values, norm
from stages.geometry.mesh.cut import NEAR, distance_to, edge_lengths, halves_along, parted, run_along, snapped
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.topology import Edges

APART = 4.0
"""Mean edges from one point of a line to the next that is gone through: nearer ones are known to no edge."""


@dataclass(frozen=True, slots=True, eq=False)
class Slit:
    """A mesh with slits.

    sides: both sides of every slit, vertex by vertex, from the boundary to the vertex where both end.
    original: the vertex of the mesh before that each vertex is, or is a copy of.
    """

    mesh: Mesh
    sides: tuple[tuple[Numbers, Numbers], ...]
    original: Indices


def slit(mesh: Mesh, edges: Edges, ways: tuple[Numbers, ...]) -> Slit:
    """Return the mesh slit along ways that have no vertex in common, each from the boundary to a vertex inside."""
    halves = [halves_along(mesh, edges, way) for way in ways]
    closed = np.concatenate([np.zeros(0, dtype=np.int64), *(edges.of_half[left] for left, _ in halves)])
    made, original = parted(mesh, edges, closed)
    sides = tuple((run_along(made, left), run_along(made, right)[::-1]) for left, right in halves)
    return Slit(made, sides, original)


def followed(mesh: Mesh, edges: Edges, line: Points3) -> Numbers:
    """Return the vertices along edges near a line of points, from the vertex nearest its first point to its last's.

    Raises NoSolutionError if no edge leads on.
    """
    lengths = edge_lengths(mesh, edges)
    middle = mesh.vertices[edges.ends].mean(axis=1)
    stops = _stops(line, APART * float(lengths.mean()))
    path = [np.zeros(0, dtype=np.int64)]
    for low, high in pairwise(stops):
        part = line[low : high + 1]
        weight = lengths * (1.0 + NEAR * (distance_to(middle, part) / lengths.mean()) ** 2)
        first, last = (snapped(mesh, edges, point, float(lengths.mean())) for point in (part[0], part[-1]))
        path.append(_way(mesh, edges, first, last, weight))
    whole: Numbers = np.concatenate(path)
    return np.asarray(whole[np.append(True, np.diff(whole) != 0)])


def _stops(line: Points3, apart_mm: float) -> list[int]:
    """Return the numbers of the points of a line that are that far from each other, the first and the last of all."""
    stops = [0]
    for i, point in enumerate(line[1:-1], 1):
        if min(norm(point - line[stops[-1]]), norm(point - line[-1])) >= apart_mm:
            stops.append(i)
    return [*stops, len(line) - 1]


def _way(mesh: Mesh, edges: Edges, first: int, last: int, weight: Values) -> Numbers:
    """Return the vertices of the lightest way along edges, those of the boundary included."""
    a, b = edges.ends.T
    n = len(mesh.vertices)
    graph = coo_array((weight, (a, b)), shape=(n, n)).tocsr()
    far, before = dijkstra(graph, directed=False, indices=first, return_predecessors=True)
    if not np.isfinite(far[last]):
        raise NoSolutionError("a way along the edges of the mesh", reached=0.0, wanted=1.0, unit="edges")
    path = [last]
    while path[-1] != first:
        path.append(int(before[path[-1]]))
    return np.array(path[::-1], dtype=np.int64)
