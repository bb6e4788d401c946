"""A mesh from a file as one oriented disc, cut open where it closes on itself; or why it is no sheet.

    mesh_surface(part, spec, tol) -> Outcome[Surface | None]
    blanks(part) -> the parts that the pieces of a mesh are

What a careful look can settle is repaired, with a finding (vertices that are one but for rounding, duplicate faces,
faces of no area, faces turned over).  What it cannot is refused with number and place: edges of three faces, sheets
that touch in a point, one-sided surfaces, cracks, folds and crossings, closed surfaces without a seam."""

from dataclasses import dataclass, field, replace

import numpy as np

from stages.construct.features import Placement, placed, placement
from stages.construct.meshes.faults import (
    place,
    repair_findings,
    repair_metrics,
    self_crossing,
    surface_findings,
    text,
)
from stages.construct.meshes.features import placed_on_mesh
from stages.construct.meshes.recovery import Recovery, recovered
from stages.construct.meshes.sewing import off_mesh, sewn
from stages.construct.meshes.solid import thin_solid
from stages.construct.plain import PlaneFrame
from stages.construct.plates import placed_in_plane
from stages.errors import NoSolutionError
from stages.geometry.arrays import Numbers, Points3, diagonal, floats, norm
from stages.geometry.mesh.cut import Opened, area, edge_lengths, ends_of, opened, turnings
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.repair import Repair, repaired
from stages.geometry.mesh.topology import (
    Edges,
    boundary_loops,
    edges_of,
    euler_characteristic,
    genus,
    part_of,
    pieces,
    turned,
    with_turned,
)
from stages.model.material import Part
from stages.model.meshes import MeshFile
from stages.model.part import PartSpec
from stages.model.report import Finding, Metric, Outcome, StageReport
from stages.model.surface import MeshSurface, RuledSurface, Surface
from stages.model.tolerances import Tolerances


@dataclass(slots=True)
class Report:
    """What is gathered on the way."""

    metrics: list[Metric] = field(default_factory=list)
    findings: list[Finding] = field(default_factory=list)
    detail: dict[str, object] = field(default_factory=dict)

    @property
    def fatal(self) -> bool:
        """Return whether the mesh is refused."""
        return any(finding.fatal for finding in self.findings)

    def outcome(self, part: Part, surface: Surface | None) -> Outcome[Surface | None]:
        """Return what construct hands on."""
        report = StageReport("construct", part.name, tuple(self.metrics), tuple(self.findings), self.detail)
        return Outcome(surface if report.passed else None, report)


def body_of(part: Part) -> Mesh:
    """Return the mesh of a part that is described by one."""
    if not isinstance(part.body, Mesh):
        raise ValueError(f"the mesh of part {part.name!r} was not read")
    return part.body


def blanks(part: Part) -> tuple[Part, ...]:
    """Return the part itself, or a part `<part>.<n>` for each piece of its mesh that hangs together."""
    body = body_of(part)
    repair = repaired(body)
    mesh = repair.mesh
    count, labels = pieces(mesh, edges_of(mesh))
    if count <= 1:
        return (part,)
    order = np.argsort(labels, kind="stable")
    runs = np.split(order, np.cumsum(np.bincount(labels))[:-1])
    message = f"the file holds {count} pieces that do not hang together: each is a blank of its own"
    done = (finding for finding in repair_findings(repair) if not finding.fatal)
    remarks = (*part.remarks, Finding("mesh-pieces", message, False, {"pieces": count}), *done)
    if part.spec.has_features:
        which = "holes, marks and seams: which of the pieces is meant is not said; give that piece a file of its own"
        remarks = (*remarks, Finding("mesh-pieces", which, fatal=True))
    return tuple(
        replace(part, spec=part.spec.blank(n), body=part_of(mesh, run), remarks=remarks)
        for n, run in enumerate(runs, 1)
    )


def mesh_surface(part: Part, spec: MeshFile, tol: Tolerances) -> Outcome[Surface | None]:
    """Return the plate or ruled surface that a mesh was made from, else the mesh as a disc, or None with the reason."""
    report = Report(findings=list(part.remarks))
    repair = repaired(body_of(part))
    report.metrics += repair_metrics(repair)
    report.findings += repair_findings(repair)
    mesh = _oriented(repair, report)
    if mesh is None:
        return report.outcome(part, None)
    crossed, folds = self_crossing(mesh, repair.tolerance_mm)
    report.metrics.append(crossed)
    report.findings += folds
    solid = thin_solid(part, mesh, tol) if spec.recognise and spec.seam is None and not report.fatal else None
    if solid is not None:
        part, mesh = solid.part, solid.mesh
        report.metrics += solid.metrics
        report.findings += solid.findings
    found = None if report.fatal else _opened(mesh, spec, report)
    if found is None:
        return report.outcome(part, None)
    sewing = sewn(MeshSurface(part, found.mesh, found.loops, _size(found.mesh), found.seams), spec)
    made = sewing.surface
    report.metrics += sewing.metrics
    report.findings += sewing.findings
    exact = recovered(part, made.mesh, made.straight_loops, tol) if spec.recognise and not spec.cuts else None
    if exact is not None:
        report.metrics += exact.metrics
        report.findings += exact.findings
        report.detail |= exact.detail
    features = _features(part.spec, made, exact, tol)
    report.metrics += features.metrics
    report.findings += features.findings
    return report.outcome(part, replace(made if exact is None else exact.surface, features=features.features))


def _features(spec: PartSpec, made: MeshSurface, exact: Recovery | None, tol: Tolerances) -> Placement:
    """Return the features of the part on what its mesh turned out to be."""
    if exact is None:
        return placed_on_mesh(spec, made.mesh, tol)
    if isinstance(exact.surface, RuledSurface):
        return placed(spec, exact.surface.patches, tol)
    origin, x, y = exact.frame if exact.frame is not None else np.eye(3)
    frame = PlaneFrame(origin, x, y, 0.0)
    return placement(spec, lambda name, feature: placed_in_plane(name, feature, frame, tol), tol)


def _size(mesh: Mesh) -> float:
    return diagonal(mesh.vertices)


def _oriented(repair: Repair, report: Report) -> Mesh | None:
    """Return the mesh with all faces turned alike, or None where it is no two-sided surface in one piece."""
    mesh = repair.mesh
    edges = edges_of(mesh)
    report.findings += surface_findings(mesh, edges, repair.tolerance_mm)
    if report.fatal:
        return None
    faces = turned(mesh, edges)
    if faces is None:
        message = "the surface has one side only, as a Moebius strip: sheet metal parts with two; cut it in two meshes"
        report.findings.append(Finding("mesh-one-sided", message, fatal=True))
        return None
    report.metrics.append(Metric("faces_turned", float(len(faces)), "", "proved"))
    if len(faces):
        where = place(mesh, mesh.faces[faces[0]])
        message = f"{len(faces)} faces ran against the others and were turned over, the first at {text(where)}"
        report.findings.append(Finding("mesh-turned", message, False, where))
    return with_turned(mesh, faces)


def _opened(mesh: Mesh, spec: MeshFile, report: Report) -> Opened | None:
    """Return the mesh cut open, or None where it is closed or has handles."""
    edges = edges_of(mesh)
    loops = boundary_loops(mesh, edges)
    characteristic = euler_characteristic(mesh, edges)
    report.metrics += _metrics(mesh, edges, len(loops), characteristic)
    report.detail["loops"] = loop_rows(mesh, edges, loops)
    handles = genus(characteristic, len(loops))
    if handles:
        message = f"the surface has {handles} handles, as a torus has one: no single cut lays it flat"
        report.findings.append(Finding("mesh-handles", f"{message}; give its parts as files of their own", True))
    elif not loops and spec.seam is None:
        report.findings.append(Finding("mesh-closed", CLOSED, fatal=True))
    seam = None if spec.seam is None else np.stack([floats(point) for point in spec.seam])
    if report.fatal or (seam is not None and _seam_is_off(mesh, edges, seam, report)):
        return None
    try:
        found = opened(mesh, seam)
    except NoSolutionError as error:
        message = f"the mesh cannot be cut along its edges there ({error}); give `seam` elsewhere, or a finer mesh"
        report.findings.append(Finding("mesh-seam", message, fatal=True))
        return None
    report.metrics += [Metric("seams", float(len(found.seams)), "", "proved"), _seam_length(found)]
    return found


CLOSED = (
    "the mesh is closed: it encloses a volume; a sheet is one open surface, so leave out the caps, or give one face of "
    "the solid sheet only, or say with `seam` where to cut it"
)


def _seam_is_off(mesh: Mesh, edges: Edges, seam: Points3, report: Report) -> bool:
    """Return whether a point of the seam is nowhere near the mesh, and say so."""
    far, found = off_mesh(mesh, edges, seam, "seam", "mesh-seam")
    report.metrics.append(Metric("seam_distance_mm", far, "mm"))
    report.findings += found
    return bool(found)


def _metrics(mesh: Mesh, edges: Edges, loops: int, characteristic: int) -> list[Metric]:
    lengths = edge_lengths(mesh, edges)
    counts = {
        "triangles": len(mesh.faces),
        "vertices": len(mesh.vertices),
        "boundary_loops": loops,
        "euler_characteristic": characteristic,
    }
    return [
        *(Metric(name, float(count), "", "proved") for name, count in counts.items()),
        Metric("edge_min_mm", float(lengths.min()), "mm"),
        Metric("edge_mean_mm", float(lengths.mean()), "mm"),
        Metric("edge_max_mm", float(lengths.max()), "mm"),
        Metric("mesh_area_mm2", area(mesh), "mm2"),
        Metric("size_mm", _size(mesh), "mm"),
    ]


def _seam_length(found: Opened) -> Metric:
    points = found.mesh.vertices
    return Metric(
        "seam_length_mm", float(sum(norm(np.diff(points[one], axis=0)).sum() for one, _ in found.seams)), "mm"
    )


def loop_rows(mesh: Mesh, edges: Edges, loops: tuple[Numbers, ...]) -> list[dict[str, object]]:
    """Return the boundary loops of the file in numbers: what each is, its length, and how it turns."""
    if not loops:
        return []
    ends, turning = set(ends_of(mesh, edges, loops).tolist()), turnings(mesh, loops)
    return [
        {
            "sort": "end" if i in ends else "hole",
            "vertices": len(loop),
            "length_mm": float(norm(mesh.vertices[np.roll(loop, -1)] - mesh.vertices[loop]).sum()),
            "turning_deg": float(np.degrees(turning[i])),
        }
        for i, loop in enumerate(loops)
    ]
