"""Where the holes, marks and notches of a part lie on its mesh: what is given in space, moved to the nearest triangle.

A mesh has no u and v: places are points in space.  The circle of a drilled hole is the curve at the drill's distance
from its axis, found by moving points along the mesh until they are there.  A curve is known by `PER_PIECE` points of
each of its smooth pieces.  How far from the mesh a feature was given is measured at all of them; a mesh lies off its
own smooth surface by up to h^2 / 8 times the curvature, h the length of an edge.
"""

import numpy as np

from stages.construct.curves import chain
from stages.construct.features import NoPlaceError, Placement, placement
from stages.geometry.arrays import Points3, cross3, diagonal, floats, norm, unit
from stages.geometry.mesh.border import beyond
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.nearest import OnMesh, at, nearest
from stages.geometry.mesh.topology import edges_of
from stages.model.curves import CurveSpec, PlanePoint, is_flat
from stages.model.features import (
    CircleHole,
    CurveHole,
    CurveMark,
    DrilledHole,
    Feature,
    NotchSpec,
    PointMark,
    RulingMarks,
    TextMark,
)
from stages.model.part import PartSpec
from stages.model.report import Finding
from stages.model.surface import Placed
from stages.model.tolerances import Tolerances

PER_PIECE = 65
"""Points of each smooth piece of a curve."""

ROUND = 72
"""Points of the circle of a drilled hole."""

ROUNDS, MOST_ROUNDS = 8, 64
"""Moves of its points towards the drill's distance from the axis; each leaves about r^2 / R^2 of what was missing."""

ON_DRILL = 1e-6
"""Share of its radius by which they may miss it: more rounds are made until then."""

BEYOND = 1e-6
"""A place that is off the edge of the mesh by more than this share of its size is not on the part."""

CLOSES = 1e-6
"""A curve whose ends are apart by less than this share of the size is closed."""


def placed_on_mesh(spec: PartSpec, mesh: Mesh, tol: Tolerances) -> Placement:
    """Return the features of a part on its mesh; a fatal finding for each that has no place there."""
    rulings = tuple(
        Finding("no-rulings", f"{mark.name}: a mesh that was not recognised has no rulings to be marked", fatal=True)
        for mark in spec.mark
        if isinstance(mark, RulingMarks)
    )
    found = placement(spec, lambda name, feature: _placed(mesh, name, feature), tol)
    return Placement(found.features, (*rulings, *found.findings))


def _placed(mesh: Mesh, name: str, spec: Feature) -> Placed:
    match spec:
        case NotchSpec():
            if spec.edge != "outline":
                hint = 'give edge = "outline" and a distance along it'
                raise NoPlaceError("no-such-edge", f"a mesh has no edge {spec.edge!r}; {hint}")
            return Placed(name, spec)
        case CurveHole() | CurveMark():
            pieces = _curve(mesh, spec.curve, closed=isinstance(spec, CurveHole))
            return Placed(name, spec, distance_mm=_farthest(pieces), on_mesh=pieces)
        case DrilledHole():
            centre = _place(mesh, spec.at)
            round_it = _drilled(mesh, centre, float(spec.diameter) / 2.0)
            return Placed(name, spec, distance_mm=_farthest((centre,)), on_mesh=(centre, round_it))
        case CircleHole() | PointMark() | TextMark():
            centre = _place(mesh, spec.at)
            return Placed(name, spec, distance_mm=_farthest((centre,)), on_mesh=(centre,))
    raise ValueError(f"no place for {type(spec).__name__}")


def _farthest(pieces: tuple[OnMesh, ...]) -> float:
    return max(float(piece.distances.max()) for piece in pieces)


def _place(mesh: Mesh, spec: PlanePoint) -> OnMesh:
    if len(spec) == len("uv"):
        raise NoPlaceError("no-uv", "a mesh has no u and v: give the place as [x, y, z]")
    point: Points3 = floats(spec)[None]
    found = nearest(mesh, point)
    _refuse_beyond(mesh, point, found)
    return found


def _curve(mesh: Mesh, spec: CurveSpec, *, closed: bool) -> tuple[OnMesh, ...]:
    if is_flat(spec):
        raise NoPlaceError("no-uv", "a mesh has no u and v: give the points of the curve as [x, y, z]")
    places = [curve.jet(np.linspace(0.0, 1.0, PER_PIECE), 0)[0] for curve in chain(spec).curves]
    gap = float(norm(places[-1][-1] - places[0][0]))
    if closed and gap > CLOSES * _size(mesh):
        raise NoPlaceError("open-contour", f"the curve does not close: its ends are {gap:.4g} mm apart")
    pieces = tuple(nearest(mesh, points) for points in places)
    for points, piece in zip(places, pieces, strict=True):
        _refuse_beyond(mesh, points, piece)
    return pieces


def _size(mesh: Mesh) -> float:
    return diagonal(mesh.vertices)


def _refuse_beyond(mesh: Mesh, points: Points3, found: OnMesh) -> None:
    """Refuse points whose nearest place is on the edge of the mesh, though not straight below them."""
    beside = beyond(mesh, edges_of(mesh), points, found)
    worst = int(np.argmax(beside))
    if beside[worst] > BEYOND * _size(mesh):
        x, y, z = points[worst]
        raise NoPlaceError("place-outside", f"({x:.6g}, {y:.6g}, {z:.6g}) lies {beside[worst]:.4g} mm beyond the part")


def _normals(mesh: Mesh, found: OnMesh) -> Points3:
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces[found.faces]], 1, 0)
    return unit(cross3(b - a, c - a))


def _drilled(mesh: Mesh, centre: OnMesh, radius: float) -> OnMesh:
    """Return the points of the mesh at a distance from the normal at a place, once round and back to the first."""
    middle, axis = at(mesh, centre, mesh.vertices)[0], _normals(mesh, centre)[0]
    x = unit(np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))]))
    turn = 2.0 * np.pi * np.arange(ROUND + 1)[:, None] / ROUND
    out = np.cos(turn) * x + np.sin(turn) * np.cross(axis, x)
    height = np.zeros((ROUND + 1, 1))
    for number in range(1, MOST_ROUNDS + 1):
        there = middle + radius * out + height * axis
        found = nearest(mesh, there)
        off = at(mesh, found, mesh.vertices) - middle
        height = (off @ axis)[:, None]
        missed = float(np.abs(norm(off - height * axis) - radius).max())
        if number >= ROUNDS and missed <= ON_DRILL * radius:
            return found
    if missed > ROUND_ENOUGH * radius:
        raise NoPlaceError("hole-outside", "the drill leaves the surface before it has come round")
    return found


ROUND_ENOUGH = 1e-3
"""A drilled hole of which a point misses the drill by more than this share of its radius did not come round."""
