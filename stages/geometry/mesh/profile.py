"""A mesh of flanges and bends with parallel rulings, seen along them: the direction, and its vertices in running order.

    profiled(mesh) -> Profile | None

Coplanar facets are taken together as plates.  The direction lies in all flanges: it is that across the normals of two
plates along which most of the area lies, then that of least squares over all of these.  Facets of bends need not lie
along it (holes in a bend leave slanting ones).  Seen along the direction the mesh is a curve.  Every edge says how far
apart its ends are on it, by the tangents of its facets; the places that fit best (least squares over the edges) order
the vertices, and what a chord for an arc has put in the wrong order is exchanged by the tangents.

None where no direction holds a `FLANGES` share of the area: a mesh of something else.
"""

from dataclasses import dataclass
from math import radians

import numpy as np
from scipy.sparse import coo_array

from stages.geometry.arrays import (
    Array,
    ArrayValue,
    Indices,
    Matrix,
    Numbers,
    Points2,
    Points3,
    Values,
    Vector3,
    cross3,
    diagonal,
    dot,
    norm,
    unit,
)
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.primitives import facets, frame_about
from stages.geometry.mesh.recognise import deviation_of
from stages.geometry.mesh.topology import Edges, edges_of, linked
from stages.geometry.numeric.sparsesolve import factorised

FLANGES = 0.4
"""Share of the area that lies along the direction: of bent sheet nearly all."""
LARGEST = 12
"""Plates, by area, of which one may make the direction together with the largest."""
CROSSING = radians(3.0)
"""Normals closer than this make no direction."""
COPLANAR = radians(1.0)
"""Two facets that turn by more are not in one plane, however much rounding may have turned them."""
ROUNDED = 1e-12
"""Share of the size by which vertices may be off where a file keeps all digits: some thousand roundings."""


@dataclass(frozen=True, slots=True, eq=False)
class Profile(ArrayValue):
    """The vertices seen along the rulings.

    frame: x, y and the direction as rows; the run of the mesh is n x d, n outwards.
    order: the numbers of the vertices along the run.  near_mm: how far rounding may move a vertex.
    """

    frame: Matrix
    order: Numbers
    near_mm: float


def allowed_mm(mesh: Mesh) -> float:
    """Return how far rounding may have moved the vertices from where they belong, mm."""
    keeps = deviation_of(mesh, np.zeros(len(mesh.vertices))).rounding_mm
    return max(keeps, ROUNDED * diagonal(mesh.vertices))


def profiled(mesh: Mesh) -> Profile | None:
    """Return a mesh as it is seen along its rulings; None where it has no flanges or only one direction of them."""
    edges, near = edges_of(mesh), allowed_mm(mesh)
    direction = _direction(_plates(mesh, edges, near), near)
    if direction is None:
        return None
    frame = np.stack([*frame_about(direction), direction])
    return Profile(frame, _ordered(mesh, frame, near), near)


# The direction


@dataclass(frozen=True, slots=True, eq=False)
class _Plates(ArrayValue):
    """Coplanar facets together, the largest first: normals, areas in mm2 and extents in mm."""

    normals: Points3
    areas: Values
    extents: Values


def _plates(mesh: Mesh, edges: Edges, near_mm: float) -> _Plates:
    """Return the plates of a mesh."""
    areas = facets(mesh)[1]
    normal, twice = unit(areas), norm(areas)
    longest = norm(mesh.vertices[mesh.faces] - mesh.vertices[np.roll(mesh.faces, 1, axis=1)]).max(axis=1)
    thin = np.divide(near_mm * longest, twice, out=np.full(twice.size, np.inf), where=twice > 0.0)
    one, other = (half // mesh.faces.shape[1] for half in edges.pairs())
    turn = np.arctan2(norm(cross3(normal[one], normal[other])), dot(normal[one], normal[other]))
    level = turn <= np.minimum(thin[one] + thin[other], COPLANAR)
    count, label = linked(len(mesh.faces), one[level], other[level])
    total = np.zeros((count, 3))
    np.add.at(total, label, areas)
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    for corner in mesh.faces.T:
        np.minimum.at(low, label, mesh.vertices[corner])
        np.maximum.at(high, label, mesh.vertices[corner])
    order = np.argsort(-norm(total), kind="stable")
    return _Plates(unit(total)[order], norm(total)[order] / 2.0, norm(high - low)[order])


def _direction(plates: _Plates, near_mm: float) -> Vector3 | None:
    """Return the direction along which most of the area lies."""
    tries = [np.cross(plates.normals[0], normal) for normal in plates.normals[1 : LARGEST + 1]]
    best, most = None, FLANGES * float(plates.areas.sum())
    for direction in (unit(way) for way in tries if norm(way) > np.sin(CROSSING)):
        along = np.abs(plates.normals @ direction) * plates.extents <= LOOSE * near_mm
        if float(plates.areas[along].sum()) > most:
            best, most = along, float(plates.areas[along].sum())
    if best is None:
        return None
    rows = plates.normals[best] * (plates.areas[best] * plates.extents[best])[:, None]
    # a row of zeros: two plates have no third singular vector of their own
    found: Vector3 = np.linalg.svd(np.vstack([rows, np.zeros(3)]), full_matrices=False)[2][2]
    return found


LOOSE = 64.0
"""Roundings by which a plate may lean: two small plates make a direction that is not yet good."""


# The order


def _ordered(mesh: Mesh, frame: Array, near_mm: float) -> Indices:
    """Return the numbers of the vertices along the run."""
    points: Points2 = mesh.vertices @ frame[:2].T
    areas = facets(mesh)[1]
    tangent = np.column_stack([areas @ frame[1], -areas @ frame[0]])
    leaning: Points2 = np.zeros_like(points)
    for corner in mesh.faces.T:
        np.add.at(leaning, corner, tangent)
    places = _places(mesh, points, unit(tangent))
    return _exchanged(np.argsort(places, kind="stable"), points, unit(leaning), near_mm)


def _places(mesh: Mesh, points: Points2, tangent: Array) -> Values:
    """Return places along the run that fit the edges best, mm; tangent: of each facet, shape (m, 2)."""
    start, end = mesh.faces.ravel(), mesh.faces[:, [1, 2, 0]].ravel()
    step = dot(points[end] - points[start], np.repeat(tangent, mesh.faces.shape[1], axis=0))
    count = len(points)
    right = np.zeros(count)
    np.add.at(right, end, step)
    np.add.at(right, start, -step)
    weights = coo_array((np.ones(start.size), (start, end)), shape=(count, count))
    both = (weights + weights.T).tocoo()
    degree = np.asarray(both.sum(axis=1)).ravel()
    # the first vertex is held: one more on its diagonal
    degree[0] += 1.0
    rows, columns = np.arange(count), np.arange(count)
    matrix = coo_array(
        (
            np.concatenate([degree, -both.data]),
            (np.concatenate([rows, both.row]), np.concatenate([columns, both.col])),
        ),
        shape=(count, count),
    ).tocsc()
    return factorised(matrix).solved(right)


def _exchanged(order: Indices, points: Points2, tangent: Points2, near_mm: float) -> Indices:
    """Return the order with neighbours exchanged that run against the tangent: odd and even pairs in turn."""
    order = order.copy()
    for _ in range(MOST_PASSES):
        changed = False
        for first in (0, 1):
            one, other = order[first:-1:2], order[first + 1 :: 2]
            way = dot(points[other] - points[one], tangent[one] + tangent[other])
            wrong = first + 2 * np.flatnonzero(way < -near_mm)
            order[wrong], order[wrong + 1] = order[wrong + 1], order[wrong]
            changed = changed or wrong.size > 0
        if not changed:
            break
    return order


MOST_PASSES = 200
"""Vertices of a bend that a chord has put in the wrong place are a few places off."""
