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
from stages.unroll.finished import box, finished


def flatten(plate: Plate, tol: Tolerances) -> Outcome[FlatPattern | None]:
    """Return the plate as a pattern in its own frame."""
    spec = plate.part.spec
    contour = outline.contour(plate.outline, tol.chord_mm, spec.name)
    holes = tuple(outline.contour(hole, tol.chord_mm, f"hole-{i}") for i, hole in enumerate(plate.holes, 1))
    overlap = sum(doubled(contour.path) for contour in (contour, *holes))
    metrics = _metrics(overlap, tol)
    crossed = _crossing_findings(metrics[-1])
    made = Features(contour, findings=crossed) if crossed else on_plate(plate, contour, holes)
    corners = box(contour)
    detail = {"class": "exact"} | _detail(made, corners)
    report = StageReport("unroll", spec.name, (*metrics, *made.metrics), made.findings, detail)
    if not report.passed:
        return Outcome(None, report)
    return Outcome(finished(plate.part, made, corners, tol), report)


def _metrics(overlap: float, tol: Tolerances) -> tuple[Metric, ...]:
    """Return a plate's distortion: a rigid motion has none, which is exact."""
    exact = (
        Metric("length_error", 0.0, "", "proved"),
        Metric("area_error", 0.0, "", "proved"),
        Metric("angle_error_deg", 0.0, "deg", "proved"),
        Metric("metric_error", 0.0, "", "proved"),
        Metric("max_strain", 0.0, "", "proved"),
    )
    return (*exact, Metric("overlap_mm2", overlap, "mm2", "proved", tol.chord_mm**2))


def _crossing_findings(covered: Metric) -> tuple[Finding, ...]:
    """Refuse contours that cross themselves."""
    if covered.passed:
        return ()
    message = f"a contour crosses itself: {covered.value:.4g} mm2 lie inside it twice or inside out"
    return (Finding("contour-crosses-itself", message, fatal=True),)


def _detail(made: Features, corners: Array) -> dict[str, object]:
    """Return area and lengths from the exact edges ("surface") and the same again as the flat figures."""
    area = sum(contours.area(contour.edges) for contour in (made.outer, *made.inner))
    low, high = corners[0], corners[2]
    return {
        "surface": {"area": area, "edges": None},
        "flat": {
            "area": area,
            "outline_length": contours.length(made.outer.edges),
            "width": float(high[0] - low[0]),
            "height": float(high[1] - low[1]),
            "corners": corners.tolist(),
            "edges": None,
            "marks": made.mark_rows,
            "holes": made.hole_rows,
        },
    }
