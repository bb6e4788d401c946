"""Plates need no unrolling: their contours are traced as they are, areas and lengths measured on both sides."""

from stages.geometry import contours
from stages.geometry.arrays import Array
from stages.geometry.cover import doubled
from stages.model.pattern import FlatPattern
from stages.model.report import Finding, Metric, Outcome, StageReport
from stages.model.surface import Plate
from stages.model.tolerances import Tolerances
from stages.unroll import outline
from stages.unroll.features import Features, on_plate
from stages.unroll.finished import box, finished, flat_figures
from stages.unroll.limits import covered_metric


def flatten(plate: Plate, tol: Tolerances) -> Outcome[FlatPattern | None]:
    """Return the plate as a pattern in its own frame."""
    spec = plate.part.spec
    contour = outline.contour(plate.outline, tol.chord_mm, spec.name)
    holes = tuple(outline.contour(hole, tol.chord_mm, f"hole-{i}") for i, hole in enumerate(plate.holes, 1))
    covered = sum(doubled(one.path) for one in (contour, *holes))
    overlap = covered_metric(covered, tol.chord_mm, proved=covered == 0.0)
    crossed = _crossing_findings(overlap)
    made = Features(contour, findings=crossed) if crossed else on_plate(plate, contour, holes)
    corners = box(contour)
    detail = {"class": "exact"} | _detail(made, corners)
    report = StageReport("unroll", spec.name, (*UNDISTORTED, overlap, *made.metrics), made.findings, detail)
    if not report.passed:
        return Outcome(None, report)
    return Outcome(finished(plate.part, made, corners, tol), report)


UNDISTORTED = (
    Metric("length_error", 0.0, "", "proved"),
    Metric("area_error", 0.0, "", "proved"),
    Metric("angle_error_deg", 0.0, "deg", "proved"),
    Metric("metric_error", 0.0, "", "proved"),
    Metric("max_strain", 0.0, "", "proved"),
)
"""A plate is moved and nothing else: that has no distortion."""


def _crossing_findings(covered: Metric) -> tuple[Finding, ...]:
    """Refuse contours that cross themselves."""
    if covered.passed:
        return ()
    message = f"a contour crosses itself: {covered.value:.4g} mm2 lie inside it twice or inside out"
    return (Finding("contour-crosses-itself", message, fatal=True),)


def _detail(made: Features, corners: Array) -> dict[str, object]:
    """Return area and lengths from the exact edges ("surface") and the same again as the flat figures."""
    area = sum(contours.area(contour.edges) for contour in (made.outer, *made.inner))
    length = contours.length(made.outer.edges)
    return {
        "surface": {"area": area, "edges": None},
        "flat": flat_figures(made, corners, area=area, length=length),
    }
