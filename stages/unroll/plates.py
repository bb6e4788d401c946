"""Plates need no unrolling: their contours are traced as they are, areas and lengths measured on both sides."""

from typing import Literal

import numpy as np

from stages.geometry import arcpath, contours
from stages.geometry.arrays import Array
from stages.model.pattern import Contour, FlatPattern
from stages.model.report import Finding, Metric, Outcome, StageReport
from stages.model.scalars import Angle
from stages.model.surface import Plate
from stages.model.tolerances import Tolerances
from stages.unroll import outline


def rotations(asked: Literal["free"] | tuple[Angle, ...] | None) -> tuple[float, ...] | Literal["free"] | None:
    """Return a part's own rotations in degrees; None: what the nest allows."""
    return tuple(float(angle) for angle in asked) if isinstance(asked, tuple) else asked


def flatten(plate: Plate, tol: Tolerances) -> Outcome[FlatPattern | None]:
    """Return the plate as a pattern in its own frame."""
    spec, material = plate.part.spec, plate.part.material
    outer = outline.contour(plate.outline, tol.chord_mm, spec.name)
    inner = tuple(outline.contour(hole, tol.chord_mm, f"hole-{i + 1}") for i, hole in enumerate(plate.holes))
    overlap = sum(outline.overlap(contour.path, tol.chord_mm) for contour in (outer, *inner))
    metrics = _metrics(overlap, tol)
    findings = _crossing_findings(metrics[-1]) or _hole_findings(outer, inner, tol)
    low_x, low_y, high_x, high_y = arcpath.bounds(outer.path)
    corners = np.array([[low_x, low_y], [high_x, low_y], [high_x, high_y], [low_x, high_y]])
    report = StageReport("unroll", spec.name, metrics, findings, {"class": "exact"} | _detail(outer, inner, corners))
    if not report.passed:
        return Outcome(None, report)
    pattern = FlatPattern(
        part=spec.name,
        quantity=spec.quantity,
        outer=outer,
        inner=inner,
        marks=(),
        label_at=outline.label_place(outer.path, tuple(hole.path for hole in inner), tol.chord_mm),
        corners=corners,
        rotations=rotations(spec.rotations),
        thickness_mm=material.thickness_mm,
        density_kg_m3=material.density_kg_m3,
    )
    return Outcome(pattern, report)


def _metrics(overlap: float, tol: Tolerances) -> tuple[Metric, ...]:
    """Return a plate's distortion: a rigid motion has none, which is exact."""
    exact = (
        Metric("length_error", 0.0, "", "proved"),
        Metric("area_error", 0.0, "", "proved"),
        Metric("angle_error_deg", 0.0, "deg", "proved"),
        Metric("metric_error", 0.0, "", "proved"),
        Metric("max_strain", 0.0, "", "proved"),
    )
    return (*exact, Metric("overlap_mm2", overlap, "mm2", "sampled", tol.chord_mm**2))


def _crossing_findings(covered: Metric) -> tuple[Finding, ...]:
    """Refuse contours that cross themselves."""
    if covered.passed:
        return ()
    message = f"a contour crosses itself: {covered.value:.4g} mm2 lie inside it twice or inside out"
    return (Finding("contour-crosses-itself", message, fatal=True),)


def _hole_findings(outer: Contour, inner: tuple[Contour, ...], tol: Tolerances) -> tuple[Finding, ...]:
    """Refuse holes outside the plate or across each other."""
    import shapely

    plate = shapely.Polygon(arcpath.polygon(outer.path, accuracy=tol.chord_mm))
    holes = [shapely.Polygon(arcpath.polygon(hole.path, accuracy=tol.chord_mm)) for hole in inner]
    findings = []
    for i, hole in enumerate(holes):
        if not plate.contains(hole):
            findings.append(Finding("hole-outside", f"holes[{i}] is not inside the outline", fatal=True))
        findings += [
            Finding("holes-cross", f"holes[{i}] and holes[{j}] overlap", fatal=True)
            for j in range(i)
            if hole.intersects(holes[j])
        ]
    return tuple(findings)


def _detail(outer: Contour, inner: tuple[Contour, ...], corners: Array) -> dict[str, object]:
    """Return area and lengths from the exact edges ("surface") and the same again as the flat figures."""
    area = sum(contours.area(contour.edges) for contour in (outer, *inner))
    low, high = corners[0], corners[2]
    return {
        "surface": {"area": area, "edges": None},
        "flat": {
            "area": area,
            "outline_length": contours.length(outer.edges),
            "width": float(high[0] - low[0]),
            "height": float(high[1] - low[1]),
            "corners": corners.tolist(),
            "edges": None,
            "marks": [],
            "holes": [_hole(contour) for contour in inner],
        },
    }


def _hole(contour: Contour) -> dict[str, object]:
    """Return name, area and the middle of the box of a hole."""
    low_x, low_y, high_x, high_y = arcpath.bounds(contour.path)
    x, y = (low_x + high_x) / 2.0, (low_y + high_y) / 2.0
    return {"name": contour.name, "area": abs(contours.area(contour.edges)), "x": x, "y": y}
