"""Plane parts: an outline and holes, taken as they are into the plane of the outline."""

import numpy as np

from stages.construct.curves import Chain, chain, largest_gap
from stages.construct.plain import closed_chain, in_plane, plane_of
from stages.geometry import contours
from stages.geometry.arrays import norm
from stages.model.material import Part
from stages.model.part import Flat
from stages.model.report import Finding, Metric, Outcome, StageReport
from stages.model.surface import Plate, Surface
from stages.model.tolerances import Tolerances


def plate(part: Part, spec: Flat, tol: Tolerances) -> Outcome[Surface | None]:
    """Return the plate, or None where a contour is open, encloses nothing, or leaves the plane."""
    links = [chain(spec.outline), *(chain(hole) for hole in spec.holes)]
    findings = [finding for i, link in enumerate(links) for finding in _contour_findings(i, link, tol)]
    frame = plane_of(links)
    metrics = (Metric("planar_error_mm", frame.off_mm, "mm", "sampled", tol.chord_mm),)
    planar = Metric("planar", frame.off_mm <= tol.chord_mm, "", "sampled")
    if findings:
        return Outcome(None, StageReport("construct", part.name, (*metrics, planar), tuple(findings)))
    outline = in_plane(links[0], frame, clockwise=False)
    holes = tuple(in_plane(link, frame, clockwise=True) for link in links[1:])
    if contours.area(outline) <= 0.0:
        findings.append(Finding("no-area", "the outline encloses no area", fatal=True))
    report = StageReport("construct", part.name, (*metrics, planar), tuple(findings))
    points = np.concatenate([edge.at(np.linspace(0.0, 1.0, 33)) for edge in outline])
    size = float(norm(points.max(axis=0) - points.min(axis=0)))
    return Outcome(Plate(part, outline, holes, size) if report.passed else None, report)


def _contour_findings(index: int, link: Chain, tol: Tolerances) -> list[Finding]:
    name = f"holes[{index - 1}]" if index else "outline"
    gap = max(largest_gap(link), closed_chain(link))
    if gap <= tol.join_mm:
        return []
    return [Finding("open-contour", f"{name} does not close: {gap:.4g} mm are missing", fatal=True)]
