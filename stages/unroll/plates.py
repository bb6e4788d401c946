"""Plates need no unrolling: their contours are traced as they are, areas and lengths measured on both sides.

The plate's come from its own curves without their derivatives, lines and arcs in closed form; the pattern's from the
edges of its contours, by quadrature with derivatives.  A plate lies in its plane and its pattern is moved by nothing:
angles, metric and strain are those of the identity, which is proved.  Notches belong to the pattern alone.
"""

from collections.abc import Sequence
from math import pi

import numpy as np

from stages.geometry.arrays import Array
from stages.geometry.curves import contours
from stages.geometry.paths import arcpath
from stages.geometry.paths.cover import doubled
from stages.model.features import CircleHole, CurveHole, DrilledHole
from stages.model.pattern import Contour, FlatPattern
from stages.model.report import Finding, Metric, Outcome, StageReport
from stages.model.surface import Placed, Plate
from stages.model.tolerances import Tolerances
from stages.unroll import outline
from stages.unroll.features import Features, on_plate
from stages.unroll.finished import box, finished, flat_figures
from stages.unroll.limits import NO_AREA, area_findings, covered_metric

Figures = tuple[float, float]
"""Of a contour: its length, mm, and its signed area, mm2."""


def flatten(plate: Plate, tol: Tolerances) -> Outcome[FlatPattern | None]:
    """Return the plate as a pattern in its own frame."""
    spec = plate.part.spec
    contour = outline.contour(plate.outline, tol.chord_mm, spec.name)
    holes = tuple(outline.contour(hole, tol.chord_mm, f"hole-{i}") for i, hole in enumerate(plate.holes, 1))
    covered = sum(doubled(one.path) for one in (contour, *holes))
    overlap = covered_metric(covered, tol.chord_mm, proved=covered == 0.0)
    refused = (*_crossing_findings(overlap), *area_findings(contour), *_empty_holes(holes))
    made = Features(contour, findings=refused) if refused else on_plate(plate, contour, holes)
    corners = box(contour)
    given, flat = given_figures(plate), {one: contour_figures(one) for one in (contour, *holes)}
    surface = {"area": _net_area(plate, given), "edges": None}
    detail: dict[str, object] = {"class": "exact", "surface": surface, "flat": _flat(made, corners, flat)}
    metrics = (*errors(given, flat), *IDENTITY, overlap, *made.metrics)
    report = StageReport("unroll", spec.name, metrics, made.findings, detail)
    if not report.passed:
        return Outcome(None, report)
    return Outcome(finished(plate.part, made, corners, tol), report)


IDENTITY = (
    Metric("angle_error_deg", 0.0, "deg", "proved"),
    Metric("metric_error", 0.0, "", "proved"),
    Metric("max_strain", 0.0, "", "proved"),
)
"""Of a map that moves a plate and nothing else."""


def given_figures(plate: Plate) -> list[Figures]:
    """Return the figures of outline and holes of a plate, from its own curves."""
    return [contours.from_positions(edges) for edges in (plate.outline, *plate.holes)]


def contour_figures(one: Contour) -> Figures:
    """Return the figures of a contour of the pattern."""
    return contours.length(one.edges), contours.area(one.edges)


def errors(given: Sequence[Figures], flat: dict[Contour, Figures]) -> tuple[Metric, Metric]:
    """Return the largest relative difference of the length of a contour, and that of the area, flat against given.

    The area without the holes, over that with them: it may be nothing where holes are misplaced.
    """
    names, laid = ["outline", *(one.name for one in list(flat)[1:])], list(flat.values())
    lengths = [abs(after / before - 1.0) for (before, _), (after, _) in zip(given, laid, strict=True)]
    worst = max(range(len(names)), key=lengths.__getitem__)
    before, after = (sum(area for _, area in figures) for figures in (given, laid))
    every = max(sum(abs(area) for _, area in given), float(np.finfo(float).tiny))
    return (
        Metric("length_error", lengths[worst], where={"edge": names[worst]}),
        Metric("area_error", abs(after - before) / every),
    )


def _crossing_findings(covered: Metric) -> tuple[Finding, ...]:
    """Refuse contours that cross themselves."""
    if covered.passed:
        return ()
    message = f"a contour crosses itself: {covered.value:.4g} mm2 lie inside it twice or inside out"
    return (Finding("contour-crosses-itself", message, fatal=True),)


def _empty_holes(holes: Sequence[Contour]) -> tuple[Finding, ...]:
    """Refuse holes of which the lines and arcs that would be cut enclose nothing."""
    empty = (i for i, one in enumerate(holes) if abs(arcpath.area(one.path)) <= NO_AREA * one.chord_mm**2)
    return tuple(Finding("no-area", f"holes[{i}] encloses no area", fatal=True) for i in empty)


def _net_area(plate: Plate, given: Sequence[Figures]) -> float:
    """Return the area of a plate without its holes, those among its features too, mm2."""
    return sum(area for _, area in given) - sum(_hole_area(one) for one in plate.features)


def _hole_area(one: Placed) -> float:
    """Return the area of a feature that is a hole, from where it was placed, mm2; else 0."""
    if isinstance(one.spec, CircleHole | DrilledHole):
        return pi * float(one.spec.diameter) ** 2 / 4.0
    return abs(contours.from_positions(one.curve)[1]) if isinstance(one.spec, CurveHole) else 0.0


def _flat(made: Features, corners: Array, known: dict[Contour, Figures]) -> dict[str, object]:
    """Return the figures of the pattern, from its edges; known: those of contours that are measured already."""
    area = sum((known.get(one) or contour_figures(one))[1] for one in (made.outer, *made.inner))
    return flat_figures(made, corners, area=area, length=(known.get(made.outer) or contour_figures(made.outer))[0])
