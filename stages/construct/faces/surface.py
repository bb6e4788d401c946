"""Faces of CAD files: planes become plates, ruled faces strips of exact patches trimmed by their edges.

A face that is not ruled (a sphere, a torus, a freeform surface) is refused with the way out; one that is ruled and not
developable goes on to `verify` like any other surface.  Faces that go over into each other make one strip.
"""

from dataclasses import replace

import numpy as np

from stages.construct.curves import even, plane_axes
from stages.construct.faces.based import reached
from stages.construct.faces.blanks import blanks_of
from stages.construct.faces.branched import branched
from stages.construct.faces.chain import Joined, joined
from stages.construct.faces.closed import opened
from stages.construct.faces.ruled import Rails, ruled_form
from stages.construct.faces.seams import SEAM_NUMBER
from stages.construct.faces.strip import NoSeamError
from stages.construct.faces.trim import OpenLoopError, loops_of
from stages.construct.features import placed
from stages.construct.joins import join_metrics, join_rows, joins_of
from stages.construct.plain import PlaneFrame
from stages.construct.plates import laid
from stages.geometry.arrays import dot
from stages.geometry.ruled.planarity import is_planar
from stages.geometry.ruled.ruled import size_of
from stages.model.cadface import CadBody, CadCone, CadFace, CadPlane, CadSweep
from stages.model.material import Part
from stages.model.report import Finding, Metric, Outcome, StageReport
from stages.model.surface import RuledSurface, Surface, whole_spans
from stages.model.tolerances import Tolerances


def face_blanks(part: Part) -> tuple[Part, ...]:
    """Return the blanks that the faces of a part make: `<part>.<n>` if there are several."""
    blanks = blanks_of(body_of(part))
    if len(blanks) == 1:
        return (replace(part, body=blanks[0].body, remarks=(*part.remarks, *blanks[0].notes)),)
    return tuple(
        replace(part, spec=part.spec.blank(n), body=blank.body, remarks=(*part.remarks, *blank.notes))
        for n, blank in enumerate(blanks, 1)
    )


def body_of(part: Part) -> CadBody:
    """Return the faces that a part is made of."""
    if not isinstance(part.body, CadBody):
        raise ValueError(f"the faces of {part.name!r} were not read")
    return part.body


def face_surface(part: Part, tol: Tolerances) -> Outcome[Surface | None]:
    """Return the surface of one blank of CAD faces, or None with the reason."""
    body = body_of(part)
    try:
        return _surface(part, body, tol)
    except NoSeamError:
        message = f"the edges of {_all_called(body)} go all the way round and leave no seam to cut it along"
        hint = "split the face along a straight line in the CAD program"
        return _refused(part, Finding("no-seam", f"{message}: {hint}", True, {"face": body.faces[0].index}))
    except OpenLoopError as error:
        message = f"an edge loop of {_all_called(body)} does not close: {error.gap_mm:.4g} mm are missing"
        return _refused(part, Finding("open-contour", message, True, {"face": body.faces[0].index}))


def _surface(part: Part, body: CadBody, tol: Tolerances) -> Outcome[Surface | None]:
    """Return the surface of one blank.  Raises NoSeamError and OpenLoopError."""
    if body.joints:
        return branched(part, body, tol)
    if len(body.faces) > 1:
        return _strip(part, body.faces, joined(body), tol)
    (face,) = body.faces
    form = ruled_form(face.surface)
    if form is None:
        return _refused(part, _not_ruled(face))
    if not face.loops:
        return _refused(part, Finding("no-edges", f"{called(face)} has no edges", True, {"face": face.index}))
    if isinstance(form, CadPlane):
        return _plate(part, face, tol)
    cut, form = opened(face, form)
    remarks = (*part.remarks, *([] if cut is face else [_seam_told(cut)]))
    return _strip(replace(part, remarks=remarks), (cut,), cut_out(cut, form), tol)


def _seam_told(face: CadFace) -> Finding:
    """Say where a face without a seam is cut open."""
    seam = next(edge for edge in face.loops[0] if edge.number == SEAM_NUMBER)
    a, b = seam.curves[0].jet(np.array([0.0, 1.0]), 0)[0]
    places = " to ".join(f"({x:.6g}, {y:.6g}, {z:.6g})" for x, y, z in (a, b))
    message = f"{called(face)} goes all the way round without a seam: it is cut open from {places} mm"
    return Finding("seam-added", message, False, {"face": face.index})


def _all_called(body: CadBody) -> str:
    return " and ".join(called(face) for face in body.faces)


def called(face: CadFace) -> str:
    """Return a face as messages name it."""
    return f"face {face.index}" + (f" {face.name!r}" if face.name else "")


def _refused(part: Part, *findings: Finding) -> Outcome[Surface | None]:
    return Outcome(None, StageReport("construct", part.name, (), (*part.remarks, *findings)))


def _not_ruled(face: CadFace) -> Finding:
    message = (
        f"{called(face)} is not ruled: it is a {face.sort}. No flat sheet takes that shape without stretching; to have "
        'it flattened with strain, export it as a mesh (STL, OBJ, PLY) and use kind = "mesh"'
    )
    return Finding("not-ruled", message, True, {"face": face.index})


def _plate(part: Part, face: CadFace, tol: Tolerances) -> Outcome[Surface | None]:
    """Return a plane face as a plate, seen from outside the body."""
    chains = [even([curve for edge in loop for curve in edge.curves]) for loop in face.loops]
    x, y = plane_axes(face.normal)
    v = np.linspace(0.0, 1.0, 33)
    points = np.concatenate([curve.jet(v, 0)[0] for link in chains for curve in link.curves])
    off = float(np.abs(dot(points - face.place, face.normal)).max())
    frame = PlaneFrame(float(dot(face.place, face.normal)) * face.normal, x, y, off)
    made = laid(part, chains, frame, tol)
    return replace(made, report=replace(made.report, findings=(*part.remarks, *made.report.findings)))


def cut_out(face: CadFace, form: CadSweep | CadCone | Rails) -> Joined:
    """Return a ruled face on its rails if they are its edges, else on a strip that its edges trim.

    Raises NoSeamError, OpenLoopError, and NoSolutionError where Newton's method fails.
    """
    patches = reached(face, form)
    return Joined(patches, loops_of(patches, face), (0, len(patches)))


def _strip(part: Part, faces: tuple[CadFace, ...], cut: Joined, tol: Tolerances) -> Outcome[Surface | None]:
    """Return ruled faces as a strip."""
    size, patches = size_of(cut.patches), cut.patches
    joins = joins_of(patches)
    planar, proved = is_planar(patches)
    features = placed(part.spec, patches, tol)
    metrics = (
        Metric("edge_distance_mm", cut.loops.distance_mm, "mm", "sampled", tol.join_mm),
        Metric("planar", planar, "", "proved" if proved else "sampled"),
        *join_metrics(joins, size, tol),
        *features.metrics,
    )
    report = StageReport(
        "construct",
        part.name,
        metrics,
        (*part.remarks, *features.findings),
        _detail(faces, join_rows(joins, size, tol)),
    )
    if not report.passed:
        return Outcome(None, report)
    surface = RuledSurface(
        part,
        patches,
        size,
        whole_spans(len(patches)),
        features.features,
        trim=cut.loops.trim(patches),
        tangencies=tuple(float(v) for v in cut.breaks[1:-1]),
    )
    return Outcome(surface, report)


def _detail(faces: tuple[CadFace, ...], joins: list[dict[str, object]]) -> dict[str, object]:
    rows: dict[str, object] = {"faces": [{"face": face.index, "name": face.name, "sort": face.sort} for face in faces]}
    return rows | ({"joins": joins} if joins else {})
