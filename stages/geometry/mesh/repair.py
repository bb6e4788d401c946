"""A mesh out of a file -> a clean one, with everything that was done to it counted.

Formats without shared vertices (STL) give every triangle corners of its own.  First what is bit for bit one position
becomes one vertex.  Then vertices on open edges become one where they are within `ROUNDING` of the mesh's largest
coordinate: programs that compute a corner twice, once for each face, round it to float32 twice [1]_.  Vertices in the
inside of the surface are left alone: nothing is open there that welding could close.

A face that names a vertex twice covers nothing, and its neighbours close over it when it is dropped.  A flat face of
three different vertices (a sliver: the middle vertex on its longest edge) may not be dropped, or a crack stays; its
longest edge is turned into the other diagonal of the sliver and its neighbour.  A face over the same three vertices as
another one is dropped.

Not repaired: more than two faces at an edge, vertices on the middle of open edges, holes that should not be there.

.. [1] 4 units in the last place: both roundings, and one operation before each.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from stages.geometry.arrays import Indices, Numbers, Points3, Triples, Values, cross3, norm
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.topology import CORNERS, Edges, compact, edges_of, half_edges, linked, used

ROUNDING = 4.0 * float(np.finfo(np.float32).eps)
"""Of the largest coordinate: float32 positions nearer than this are one."""


@dataclass(frozen=True, slots=True, eq=False)
class Repair:
    """A mesh after repair.

    merged: vertices that were bit for bit one; welded: further ones that were one but for rounding, at most
    `welded_mm` apart.  duplicates, collapsed, flat: faces dropped, faces of no area dropped, slivers resolved.
    unused: vertices that no face names.  slivers: faces of no area that are left.
    """

    mesh: Mesh
    tolerance_mm: float
    merged: int = 0
    welded: int = 0
    welded_mm: float = 0.0
    duplicates: int = 0
    collapsed: int = 0
    flat: int = 0
    unused: int = 0
    slivers: Indices = field(default_factory=lambda: np.zeros(0, dtype=np.int64))


def repaired(mesh: Mesh) -> Repair:
    """Return the mesh welded, without faces of no area, duplicate faces and unused vertices."""
    tolerance = ROUNDING * float(np.abs(mesh.vertices).max(initial=0.0))
    named = used(mesh.faces)
    numbers = same_position(mesh.vertices)
    merged = len(named) - len(used(numbers[named]))
    faces = numbers[mesh.faces]
    near = nearly_same(mesh.vertices, faces, tolerance)
    welded = len(used(faces)) - len(used(near[faces]))
    welded_mm = float(norm(mesh.vertices - mesh.vertices[near]).max(initial=0.0))
    solid = without_collapsed(near[faces])
    single = without_duplicates(solid)
    clean, flat, slivers = without_slivers(compact(Mesh(mesh.vertices, single)), tolerance)
    return Repair(
        mesh=clean,
        tolerance_mm=tolerance,
        merged=merged,
        welded=welded,
        welded_mm=welded_mm,
        duplicates=len(solid) - len(single),
        collapsed=len(faces) - len(solid),
        flat=flat,
        unused=len(mesh.vertices) - len(named),
        slivers=slivers,
    )


def same_position(points: Points3) -> Indices:
    """Return for each point the first one with the very same coordinates."""
    bits = (points + 0.0).view(np.uint64)
    mixed = np.zeros(len(points), dtype=np.uint64)
    for axis in range(bits.shape[1]):
        mixed = _scrambled(mixed ^ bits[:, axis])
    _, first, which = np.unique(mixed, return_index=True, return_inverse=True)
    numbers = first[which].astype(np.int64)
    if np.array_equal(points[numbers], points):
        return numbers
    _, first, which = np.unique(points, axis=0, return_index=True, return_inverse=True)
    return first[which.reshape(-1)].astype(np.int64)


def _scrambled(words: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Return 64-bit words with every bit of each depending on all of its bits (the finaliser of SplitMix64)."""
    words = (words ^ (words >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    words = (words ^ (words >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return words ^ (words >> np.uint64(31))


def nearly_same(points: Points3, faces: Triples, tolerance: float) -> Indices:
    """Return for each point the one that it is welded to: itself, but on open edges."""
    numbers = np.arange(len(points))
    border = border_vertices(Mesh(points, faces))
    if not len(border) or tolerance == 0.0:
        return numbers
    pairs = cKDTree(points[border]).query_pairs(tolerance, output_type="ndarray")
    if not len(pairs):
        return numbers
    _, cluster = linked(len(border), pairs[:, 0].astype(np.int64), pairs[:, 1].astype(np.int64))
    order = np.lexsort((*points[border].T[::-1], cluster))
    leads = np.concatenate([[True], np.diff(cluster[order]) > 0])
    lead = order[leads][np.cumsum(leads) - 1]
    numbers[border[order]] = border[lead]
    return numbers


def border_vertices(mesh: Mesh) -> Indices:
    """Return the vertices on edges of one face."""
    edges = edges_of(mesh)
    return used(edges.ends[edges.count == 1])


def without_collapsed(faces: Triples) -> Numbers:
    """Return the faces of three different vertices."""
    a, b, c = faces.T
    return np.asarray(faces[(a != b) & (b != c) & (c != a)])


def without_duplicates(faces: Triples) -> Numbers:
    """Return the first face over each three vertices."""
    a, b, c = np.sort(faces, axis=1).T
    n = int(faces.max(initial=0)) + 1
    rank = a * n + b
    order = np.lexsort((np.arange(len(faces)), c, rank))
    again = (np.diff(rank[order]) == 0) & (np.diff(c[order]) == 0)
    kept = np.ones(len(faces), dtype=bool)
    kept[order[1:][again]] = False
    return np.asarray(faces[kept])


def heights(mesh: Mesh) -> Values:
    """Return the least height of each face, mm: twice its area over its longest side."""
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(CORNERS))
    longest = np.maximum(np.maximum(norm(b - a), norm(c - b)), norm(a - c))
    twice = norm(cross3(b - a, c - a))
    return np.asarray(np.divide(twice, longest, out=np.zeros_like(twice), where=longest > 0.0))


def without_slivers(mesh: Mesh, tolerance: float) -> tuple[Mesh, int, Indices]:
    """Return the mesh with slivers resolved, how many were, and those that could not be.

    A sliver on the boundary, its longest edge open, is dropped: the middle vertex is then on the boundary.  One whose
    neighbour is a sliver too waits for it; rounds end when none makes them fewer.
    """
    found, before = np.flatnonzero(heights(mesh) <= tolerance), len(mesh.faces) + 1
    resolved = 0
    while 0 < len(found) < before:
        before = len(found)
        mesh, done = _resolve(mesh, found.tolist())
        resolved += done
        found = np.flatnonzero(heights(mesh) <= tolerance)
    return mesh, resolved, found


def _resolve(mesh: Mesh, found: list[int]) -> tuple[Mesh, int]:
    """Return the mesh with each sliver resolved whose neighbourhood no other one has changed in this round."""
    edges = edges_of(mesh)
    order = np.argsort(edges.of_half, kind="stable")
    begins = np.cumsum(edges.count) - edges.count
    present = {tuple(pair) for pair in edges.ends.tolist()}
    faces, touched, dropped, flipped = mesh.faces.copy(), set[int](), set[int](), 0
    for face in found:
        half = CORNERS * face + _longest(mesh, face)
        edge = edges.of_half[half]
        meeting = order[begins[edge] : begins[edge] + edges.count[edge]]
        around = {int(other) // CORNERS for other in meeting}
        if around & touched or len(meeting) > len("ab"):
            continue
        a, c, b = (int(x) for x in np.roll(mesh.faces[face], -(half % CORNERS)))
        if len(meeting) == 1:
            dropped.add(face)
        else:
            other = int(meeting.sum()) - half
            d = int(mesh.faces.reshape(-1)[other - other % CORNERS + (other + 2) % CORNERS])
            same_way = int(mesh.faces.reshape(-1)[other]) == a
            if (min(b, d), max(b, d)) in present or b == d:
                continue
            faces[face] = a, d, b
            faces[other // CORNERS] = (b, d, c) if not same_way else (c, d, b)
            flipped += 1
        touched |= around
    kept = np.setdiff1d(np.arange(len(faces)), sorted(dropped))
    return Mesh(mesh.vertices, faces[kept]), flipped + len(dropped)


def _longest(mesh: Mesh, face: int) -> int:
    """Return which half-edge of a face is the longest."""
    corners = mesh.vertices[mesh.faces[face]]
    return int(np.argmax(norm(corners[[1, 2, 0]] - corners)))


def cracks(mesh: Mesh, edges: Edges, tolerance: float) -> tuple[Indices, Indices]:
    """Return vertices that lie on open edges within `tolerance` without being their ends, and those half-edges."""
    half = edges.border
    start, end = (ends[half] for ends in half_edges(mesh.faces))
    points = mesh.vertices
    border = np.unique(np.concatenate([start, end]))
    if not len(border):
        return border, half
    middle, along = (points[start] + points[end]) / 2.0, points[end] - points[start]
    reach = norm(along) / 2.0 + tolerance
    lists = cKDTree(points[border]).query_ball_point(middle, reach)
    which = np.repeat(np.arange(len(half)), [len(found) for found in lists])
    vertex = border[np.concatenate([np.asarray(found, dtype=np.int64) for found in lists])]
    length = norm(along)[which]
    arm = points[vertex] - points[start[which]]
    share = np.einsum("ij,ij->i", arm, along[which]) / length**2
    away = norm(arm - share[:, None] * along[which])
    inside = (away <= tolerance) & (share * length > tolerance) & ((1.0 - share) * length > tolerance)
    return vertex[inside], half[which[inside]]
