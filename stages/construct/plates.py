"""Plane parts: an outline and holes, taken as they are into the plane of the outline."""

from collections.abc import Sequence

import numpy as np

from stages.construct.curves import Chain, chain, largest_gap
from stages.construct.features import NoPlaceError, placement
from stages.construct.plain import PlaneFrame, closed_chain, in_plane, plane_edges, plane_of
from stages.geometry.arrays import Points3, Values, dot, floats, norm
from stages.geometry.curves import contours
from stages.model.curves import is_flat
from stages.model.features import CurveHole, CurveMark, Feature, NotchSpec, RulingMarks
from stages.model.material import Part
from stages.model.part import Flat
from stages.model.report import Finding, Metric, Outcome, StageReport
from stages.model.surface import Placed, Plate, Surface
from stages.model.tolerances import Tolerances


def plate(part: Part, spec: Flat, tol: Tolerances) -> Outcome[Surface | None]:
    """Return the plate, or None where a contour is open, encloses nothing, or leaves the plane."""
    links = [chain(spec.outline), *(chain(hole) for hole in spec.holes)]
    return laid(part, links, plane_of(links), tol)


def laid(part: Part, links: Sequence[Chain], frame: PlaneFrame, tol: Tolerances) -> Outcome[Surface | None]:
    """Return the plate with these contours, the outline first, in a plane."""
    findings = [finding for i, link in enumerate(links) for finding in _contour_findings(i, link, tol)]
    metrics = (Metric("planar_error_mm", frame.off_mm, "mm", "sampled", tol.chord_mm),)
    planar = Metric("planar", frame.off_mm <= tol.chord_mm, "", "sampled")
    if findings:
        return Outcome(None, StageReport("construct", part.name, (*metrics, planar), tuple(findings)))
    outline = in_plane(links[0], frame, clockwise=False)
    holes = tuple(in_plane(link, frame, clockwise=True) for link in links[1:])
    if contours.area(outline) <= 0.0:
        findings.append(Finding("no-area", "the outline encloses no area", fatal=True))
    findings += [
        Finding("no-area", f"holes[{i}] encloses no area", fatal=True)
        for i, hole in enumerate(holes)
        if contours.area(hole) >= 0.0
    ]
    features = placement(part.spec, lambda name, feature: placed_in_plane(name, feature, frame, tol), tol)
    findings += features.findings
    report = StageReport("construct", part.name, (*metrics, planar, *features.metrics), tuple(findings))
    points = np.concatenate([edge.at(np.linspace(0.0, 1.0, 33)) for edge in outline])
    size = float(norm(points.max(axis=0) - points.min(axis=0)))
    return Outcome(Plate(part, outline, holes, size, features.features) if report.passed else None, report)


def _contour_findings(index: int, link: Chain, tol: Tolerances) -> list[Finding]:
    name = f"holes[{index - 1}]" if index else "outline"
    gap = max(largest_gap(link), closed_chain(link))
    if gap <= tol.join_mm:
        return []
    return [Finding("open-contour", f"{name} does not close: {gap:.4g} mm are missing", fatal=True)]


def placed_in_plane(name: str, spec: Feature, frame: PlaneFrame, tol: Tolerances) -> Placed:
    """Return a feature in the plane of the plate; what is given in space is taken along its normal."""
    if isinstance(spec, CurveHole | CurveMark):
        link = chain(spec.curve)
        if largest_gap(link) > tol.join_mm:
            raise NoPlaceError("open-contour", f"the pieces of the curve leave a gap of {largest_gap(link):.4g} mm")
        if isinstance(spec, CurveHole) and closed_chain(link) > tol.join_mm:
            raise NoPlaceError("open-contour", f"does not close: {closed_chain(link):.4g} mm are missing")
        if is_flat(spec.curve):
            return Placed(name, spec, None, plane_edges(link, np.zeros(3), np.eye(3)[:2]))
        v = np.linspace(0.0, 1.0, OFF_PLANE_SAMPLES)
        off = max(float(np.abs(_height(frame, curve.jet(v, 0)[0])).max()) for curve in link.curves)
        return Placed(name, spec, None, plane_edges(link, frame.origin, np.stack([frame.x, frame.y])), off)
    if isinstance(spec, NotchSpec | RulingMarks):
        return Placed(name, spec)
    if len(spec.at) == len("xy"):
        return Placed(name, spec, floats(spec.at))
    point = floats(spec.at)
    place = np.stack([frame.x, frame.y]) @ (point - frame.origin)
    return Placed(name, spec, place, (), abs(float(_height(frame, point[None, :])[0])))


OFF_PLANE_SAMPLES = 65
"""To a curve: how far it leaves the plane is told, not judged; between two a smooth one strays by 1e-4 of itself."""


def _height(frame: PlaneFrame, points: Points3) -> Values:
    """Return the distances of points from the plane, mm, with their sign."""
    return dot(points - frame.origin, np.cross(frame.x, frame.y))
