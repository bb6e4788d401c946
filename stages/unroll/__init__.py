"""Unroll: the certified surface as a flat pattern, and how far the map is from an isometry.

    unroll(certificate, tol) -> Outcome[FlatPattern | None]

The neutral surface of the sheet (`thickness`) is laid flat along its rulings, by quadrature to rounding
(`geometry.flat.development`); one that is developable only nearly, by least strain (`geometry.flat.relaxed`).
Lengths, angles, area and metric of pattern and surface are measured separately and compared (`distortion`): their
difference is the distortion.  Holes and marks go through the same map (`features`), bend lines and the roll schedule
follow the turning of the surface (`forming`, `rolls`).  A pattern that overlaps itself, or is strained beyond the class
that the job accepts, is refused.
"""

from dataclasses import dataclass, field, replace

from stages.geometry.arrays import Points2
from stages.geometry.flat.development import develop
from stages.geometry.flat.flatmap import Development
from stages.model.pattern import FlatPattern
from stages.model.report import Metric, Outcome, StageReport
from stages.model.surface import BranchedSurface, Certificate, MeshSurface, Plate, RuledSurface
from stages.model.tolerances import Class, Tolerances
from stages.unroll import outline
from stages.unroll.distortion import Distortion, measure
from stages.unroll.divide import division
from stages.unroll.features import Features, on_strip
from stages.unroll.finished import box, finished, flat_figures
from stages.unroll.forming import folded, formed, standing, with_pieces
from stages.unroll.limits import area_findings, class_of, overlap, overlap_findings, strain_findings
from stages.unroll.onpart import on_part
from stages.unroll.rolls import scheduled
from stages.unroll.sensitivity import sensitivity
from stages.unroll.sides import surface_figures
from stages.unroll.strain import as_detail, strain_field
from stages.unroll.tangencies import tangency_marks
from stages.unroll.thickness import Neutral, neutral
from stages.unroll.trimmed import Trimmed, trimmed, with_trim

__all__ = ["unroll"]


def unroll(certificate: Certificate, tol: Tolerances) -> Outcome[FlatPattern | None]:
    """Return the flat pattern in its own frame, or None with the reason.

    Positions are within 1e-12 of the size of the exact development, within `FLATTENED` of that of least strain; the
    contour's lines and arcs within `tol.chord_mm`.
    Raises NoSolutionError where a quadrature does not resolve, the least strain is not found, or the arcs do not keep
    the chord.
    """
    if isinstance(certificate.surface, Plate):
        from stages.unroll.plates import flatten

        return flatten(certificate.surface, tol)
    if isinstance(certificate.surface, MeshSurface):
        from stages.unroll.meshes import flatten_mesh

        return flatten_mesh(certificate, tol)
    if isinstance(certificate.surface, BranchedSurface):
        from stages.unroll.branched import unroll_branched

        return unroll_branched(certificate, certificate.surface, tol)
    surface = certificate.surface
    sheet = neutral(surface, tol)
    if any(finding.fatal for finding in sheet.findings):
        detail = {"class": "rejected"} | sheet.detail
        return Outcome(None, StageReport("unroll", surface.part.name, sheet.metrics, sheet.findings, detail))
    return _laid_flat(sheet, certificate.reached, tol)


@dataclass(frozen=True, slots=True)
class Laid:
    """A flat map, and what was found out in making it."""

    development: Development
    metrics: tuple[Metric, ...] = ()
    detail: dict[str, object] = field(default_factory=dict)


FLATTENED = 1e-7
"""How exact positions of a map of least strain are, as a share of the size: 1 um on a part of 10 m."""
FIELD = 9, 33
"""Places along and across the rulings at which the strain is reported."""


def _laid(surface: RuledSurface, reached: Class) -> Laid:
    """Return the flat map: along the rulings, or by least strain if the surface has warp."""
    if reached == "exact":
        return Laid(develop(surface.patches))
    from stages.geometry.flat.relaxed import relaxed

    found = relaxed(surface.patches, accuracy=FLATTENED)
    metrics = (
        Metric("flattening_error", found.reached, "", "sampled", FLATTENED),
        Metric("strain_uncertainty", found.strain_change),
    )
    return Laid(
        found.development, metrics, {"strain_field": as_detail(strain_field(surface, found.development, *FIELD))}
    )


def _laid_flat(sheet: Neutral, by_warp: Class, tol: Tolerances) -> Outcome[FlatPattern | None]:
    """Return the pattern of the neutral surface, with everything that is cut into it and drawn on it."""
    surface, name = sheet.surface, sheet.surface.part.name
    laid = _laid(surface, by_warp)
    found = measure(surface, laid.development, tol)
    cut = trimmed(sheet, laid.development, surface.trim, tol.chord_mm) if surface.trim is not None else None
    outer = cut.outer if cut is not None else outline.contour(outline.edges(laid.development), tol.chord_mm, name)
    covered = overlap(outer)
    made = on_strip(surface, laid.development, outer, cut.inner if cut is not None else ())
    bends = [formed(sheet.bent, surface, laid.development, spec) for spec in surface.part.spec.bend]
    unasked = standing if surface.tangencies else folded
    bends = bends or [unasked(sheet.bent, surface, laid.development)]
    lines = on_part([mark for bend in bends for mark in bend.marks], made.outer, made.inner)
    rolls = scheduled(sheet.bent, surface, laid.development)
    strain = next(metric for metric in found.metrics if metric.name == "max_strain")
    measured = found.metrics if cut is None else with_trim(found.metrics, cut)
    energy = (Metric("strain_energy_mm2", found.energy_mm2, "mm2"),) if by_warp != "exact" else ()
    metrics = (*measured, covered, *laid.metrics, *energy, *sheet.metrics, *made.metrics, *rolls.metrics)
    metrics = (*metrics, *(metric for bend in bends for metric in bend.metrics))
    findings = (
        *division(surface),
        *sheet.findings,
        *strain_findings(strain, by_warp, tol),
        *area_findings(outer),
        *overlap_findings(covered, DIVIDE if cut is None else DIVIDE_BEFORE),
        *made.findings,
        *(finding for bend in bends for finding in bend.findings),
        *rolls.findings,
    )
    corners = outline.corners(laid.development) if cut is None else box(outer)
    detail = {"class": class_of(strain, by_warp)} | _figures(corners, made, found, cut) | laid.detail | sheet.detail
    detail |= {"bends": [row for bend in bends for row in with_pieces(bend.rows, lines)], "rolls": list(rolls.rows)}
    detail |= {"given": _given(sheet, cut), "sensitivity": sensitivity(sheet.bent)}
    report = StageReport("unroll", name, metrics, findings, detail)
    if not report.passed:
        return Outcome(None, report)
    tangencies = on_part(tangency_marks(surface, laid.development), made.outer, made.inner)
    whole = replace(made, marks=(*made.marks, *lines, *tangencies))
    sides = outline.sides(len(surface.patches)) if cut is None else ()
    return Outcome(finished(surface.part, whole, corners, tol).replace(sides=sides), report)


DIVIDE = 'along a ruling with cut = "auto"'
DIVIDE_BEFORE = "before it is given: an outline of its own is not divided here"


def _figures(corners: Points2, made: Features, found: Distortion, cut: Trimmed | None) -> dict[str, object]:
    """Return the figures of both sides, and of the flat pattern alone; the edges of a trimmed part have no names."""
    edges = (found.surface.by_name(), found.flat.by_name()) if cut is None else (None, None)
    areas = (found.surface_area, found.flat_area) if cut is None else (cut.surface_area, cut.flat_area)
    length = sum(found.flat.by_name().values()) if cut is None else cut.outline_length
    return {
        "surface": {"area": areas[0], "edges": edges[0]},
        "flat": flat_figures(made, corners, area=areas[1], length=length, edges=edges[1]),
    }


def _given(sheet: Neutral, cut: Trimmed | None) -> dict[str, object] | None:
    """Return the figures of the surface as given, where another one, the neutral surface, is unrolled."""
    given = sheet.bent.surface
    if given is sheet.surface:
        return None
    if cut is not None:
        return {"area": cut.given_area, "edges": None}
    edges, area = surface_figures(given.patches)
    return {"area": area, "edges": edges.by_name()}
