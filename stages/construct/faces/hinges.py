"""Straight edges at which two faces of a CAD file meet, in any direction: which are hinges, and why others are not.

A hinge is a straight edge, whole on both sides, that is a ruling of each face (in a plane any line is), along which
the outward normals agree to `SMOOTH_RAD` and which the two outlines run along in opposite ways: then both faces can be
laid side by side in the plane.  Edges are known by their ends, not by what the file says they share.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stages.construct.faces.based import Based, based, normals, places
from stages.construct.faces.joined import coinciding, straight_edges
from stages.construct.faces.ruled import ruled_form
from stages.construct.faces.strip import NoSeamError
from stages.construct.faces.trim import MEETS, OpenLoopError
from stages.construct.joins import SMOOTH_RAD
from stages.errors import NoSolutionError
from stages.geometry.arrays import Array, ArrayValue, dot, norm
from stages.geometry.curves.plane import PlaneCurve
from stages.geometry.ruled.strip import size
from stages.model.cadface import CadFace, CadPlane

ENDS = np.array([0.0, 1.0])
ALONG = np.array([0.1, 0.3, 0.5, 0.7, 0.9])
"""Where normals are compared: on a developable they are the same all along a ruling, and at an apex there is none."""
SAME_RULING = 1e-9
"""Of a patch in v: an edge that keeps to this runs along a ruling."""
FOLDED_BACK = np.pi / 2.0
"""Normals that enclose more look away from each other: one of both faces is inside out."""

Edge = tuple[int, int]
"""Of a face: the loop, 0 the outer one, and the curve in it."""


@dataclass(frozen=True, slots=True, eq=False)
class Meeting(ArrayValue):
    """A straight edge of two faces, by their places; why: what keeps it from being a hinge, empty if nothing does.

    ends: shape (2, 3), mm, as the outline of `one` runs.  angle_rad: between the outward normals, the largest.
    """

    one: int
    other: int
    of_one: Edge
    of_other: Edge
    ends: Array
    angle_rad: float
    why: str = ""

    @property
    def length_mm(self) -> float:
        """Return the length of the edge."""
        return float(norm(self.ends[1] - self.ends[0]))


def meetings(faces: Sequence[CadFace]) -> tuple[list[Meeting], dict[int, Based]]:
    """Return every straight edge at which two faces meet, and the faces that have one on their strips."""
    rows = [(i, ends) for i, face in enumerate(faces) for ends in straight_edges(face)]
    pairs = [(rows[a][0], rows[b][0], rows[a][1]) for a, b in coinciding(rows, faces) if rows[a][0] != rows[b][0]]
    forms = {i: ruled_form(faces[i].surface) for i in sorted({i for pair in pairs for i in pair[:2]})}
    planes = {i for i, form in forms.items() if isinstance(form, CadPlane)}
    creases = {(i, j): angle for i, j, _ in pairs if {i, j} <= planes and (angle := _crease(faces[i], faces[j]))}
    laid = {i: _tried(faces[i]) for i in sorted({k for i, j, _ in pairs if (i, j) not in creases for k in (i, j)})}
    known = {i: one for i, one in laid.items() if one is not None}
    found: list[Meeting] = []
    for i, j, ends in pairs:
        if (i, j) in creases:
            angle = creases[i, j]
            found.append(Meeting(i, j, NO_EDGE, NO_EDGE, ends, angle, _creased(angle)))
        elif i in known and j in known and (one := meeting(known[i], known[j], (i, j), ends)) is not None:
            found.append(one)
    return found, known


NO_EDGE = (0, -1)
"""Of a crease between planes, whose edges are not looked up."""


def _crease(one: CadFace, other: CadFace) -> float | None:
    """Return the angle between two planes, rad; None where it is none."""
    angle = float(np.arctan2(norm(np.cross(one.normal, other.normal)), one.normal @ other.normal))
    return angle if SMOOTH_RAD < angle < np.pi - SMOOTH_RAD else None


def _creased(angle: float) -> str:
    return f"they meet at an angle of {np.degrees(angle):.4g} deg, and a bend needs a rounded edge"


def _tried(face: CadFace) -> Based | None:
    """Return a face on its strip; None where it cannot be: the face itself is refused with the reason later."""
    try:
        return based(face)
    except (NoSeamError, OpenLoopError, NoSolutionError):
        return None


def meeting(one: Based, other: Based, numbers: tuple[int, int], ends: Array) -> Meeting | None:
    """Return how two faces meet along the straight edge between two points; None where either has no such edge."""
    of_one, of_other = edge_between(one, ends), edge_between(other, ends)
    if of_one is None or of_other is None:
        return None
    curves = curve_of(one, of_one), curve_of(other, of_other)
    mine, its = (places(side, curve, ENDS) for side, curve in zip((one, other), curves, strict=True))
    opposite = bool(dot(mine[1] - mine[0], its[1] - its[0]) < 0.0)
    there = normals(other, curves[1], 1.0 - ALONG if opposite else ALONG)
    here = normals(one, curves[0], ALONG)
    angle = float(np.arctan2(norm(np.cross(here, there)), dot(here, there)).max())
    return Meeting(*numbers, of_one, of_other, mine, angle, _why((one, other), curves, angle, opposite=opposite))


def _why(sides: tuple[Based, Based], curves: tuple[PlaneCurve, PlaneCurve], angle: float, *, opposite: bool) -> str:
    """Return what keeps an edge from being a hinge."""
    if angle > FOLDED_BACK and not opposite:
        return "their outward normals are opposite: sew the faces into one shell in the CAD program"
    if angle > SMOOTH_RAD:
        return _creased(angle)
    if not opposite:
        return "they lie on the same side of it"
    for side, curve in zip(sides, curves, strict=True):
        if not side.plane and np.ptp(curve.at(np.linspace(0.0, 1.0, 9))[:, 1]) > SAME_RULING:
            return f"it is no ruling of face {side.face.index}"
    return ""


def edge_between(side: Based, ends: Array) -> Edge | None:
    """Return which edge of a face runs between two points, either way."""
    near = MEETS * size(side.strip)
    for k, loop in enumerate(side.loops.curves):
        for i, curve in enumerate(loop):
            found = places(side, curve, ENDS)
            apart = min(float(norm(found - way).max()) for way in (ends, ends[::-1]))
            if apart <= near:
                return k, i
    return None


def curve_of(side: Based, edge: Edge) -> PlaneCurve:
    """Return the curve of u and v of an edge."""
    return side.loops.curves[edge[0]][edge[1]]
