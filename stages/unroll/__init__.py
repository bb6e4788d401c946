"""Unroll: the certified surface as a flat pattern, and how far the map is from an isometry.

    unroll(certificate, tol) -> Outcome[FlatPattern | None]

Along the rulings, by quadrature to rounding (`stages.geometry.development`).  Lengths, angles, area and metric of
pattern and surface are measured separately and compared (`measure`): their difference is the distortion.  A pattern
that overlaps itself, or is strained beyond the class that the job accepts, is refused.
"""

from dataclasses import dataclass

import numpy as np

from stages.geometry import arcpath
from stages.geometry.arrays import Points2
from stages.geometry.development import develop
from stages.geometry.flatmap import Development
from stages.model.pattern import Contour, FlatPattern, Mark
from stages.model.report import Finding, Metric, Outcome, StageReport
from stages.model.surface import Certificate, Plate, RuledSurface
from stages.model.tolerances import CLASSES, STRAIN_LIMIT, Class, Tolerances, class_by_strain
from stages.unroll import measure, outline
from stages.unroll.marks import ruling_marks
from stages.unroll.measure import Edges, PieceNodes
from stages.unroll.plates import flatten, rotations

__all__ = ["unroll"]


@dataclass(frozen=True, slots=True)
class Sides:
    """Edge lengths in mm and areas in mm2, of the surface and of the flat pattern, by separate quadratures."""

    surface: Edges
    flat: Edges
    surface_area: float
    flat_area: float

    def length_error(self) -> float:
        """Return the largest relative difference of an edge length; edges shorter than rounding are passed over."""
        pairs = list(zip(self.surface.values(), self.flat.values(), strict=True))
        longest = max(self.surface.values())
        return max((abs(b - a) / a for a, b in pairs if a > NO_EDGE * longest), default=0.0)


NO_EDGE = 1e-12
"""An edge shorter than this share of the longest is a point (an apex)."""


def unroll(certificate: Certificate, tol: Tolerances) -> Outcome[FlatPattern | None]:
    """Return the flat pattern in its own frame, or None with the reason.

    Positions are within 1e-12 of the size of the exact development; the contour's lines and arcs within `tol.chord_mm`.
    Raises NoSolutionError where the quadrature does not resolve, or the arcs do not keep the chord.
    """
    if isinstance(certificate.surface, Plate):
        return flatten(certificate.surface, tol)
    return _strip(certificate.surface, certificate.reached, tol)


def _strip(surface: RuledSurface, reached: Class, tol: Tolerances) -> Outcome[FlatPattern | None]:
    name = surface.part.name
    development = develop(surface.patches)
    outer = outline.contour(outline.edges(development), tol.chord_mm, name)
    nodes = [measure.at_nodes(piece) for piece in development.pieces]
    corners = outline.corners(development)
    metrics, sides = _metrics(surface, development, nodes, corners, tol)
    overlap = outline.overlap(outer.path, tol.chord_mm)
    covered = Metric("overlap_mm2", overlap, "mm2", "sampled", tol.chord_mm**2)
    findings = (*_strain_findings(metrics, reached, tol), *_overlap_findings(covered))
    metrics = (*metrics, covered)
    marks = tuple(mark for spec in surface.part.spec.mark for mark in ruling_marks(development, spec))
    detail = {"class": _class(metrics, reached)} | _detail(corners, outer, sides)
    report = StageReport("unroll", name, metrics, findings, detail)
    if not report.passed:
        return Outcome(None, report)
    return Outcome(_pattern(surface, outer, marks, corners, tol), report)


def _pattern(
    surface: RuledSurface, outer: Contour, marks: tuple[Mark, ...], corners: Points2, tol: Tolerances
) -> FlatPattern:
    spec, material = surface.part.spec, surface.part.material
    return FlatPattern(
        part=spec.name,
        quantity=spec.quantity,
        outer=outer,
        inner=(),
        marks=marks,
        label_at=outline.label_place(outer.path, (), tol.chord_mm),
        corners=corners,
        rotations=rotations(spec.rotations),
        thickness_mm=material.thickness_mm,
        density_kg_m3=material.density_kg_m3,
    )


def _metrics(
    surface: RuledSurface, development: Development, nodes: list[PieceNodes], corners: Points2, tol: Tolerances
) -> tuple[tuple[Metric, ...], Sides]:
    """Return the distortion, and the figures on both sides that it was computed from."""
    sides = Sides(
        measure.surface_edges(surface.patches),
        measure.flat_edges(nodes, corners),
        measure.surface_area(surface.patches),
        measure.flat_area(nodes, corners),
    )
    metric = measure.metric_error(development, nodes)
    strain = measure.largest_strain(development, nodes)
    gap = outline.piece_gap(development)
    return (
        Metric("length_error", sides.length_error()),
        Metric("area_error", abs(sides.flat_area - sides.surface_area) / sides.surface_area),
        Metric("angle_error_deg", float(np.degrees(measure.corner_angles(development, nodes))), "deg"),
        Metric("metric_error", metric.value, where={"v": metric.v, "u": metric.u}),
        Metric("max_strain", strain.value, "", "sampled", STRAIN_LIMIT[tol.accept], {"v": strain.v, "u": strain.u}),
        Metric("flat_gap_mm", gap, "mm", "sampled", tol.join_mm),
    ), sides


def _strain(metrics: tuple[Metric, ...]) -> tuple[Metric, float]:
    strain = next(metric for metric in metrics if metric.name == "max_strain")
    return strain, float(strain.value or 0.0)


def _class(metrics: tuple[Metric, ...], by_warp: Class) -> str:
    """Return the worse of the classes by warp and by strain; a part without warp has no strain but rounding."""
    by_strain = class_by_strain(_strain(metrics)[1])
    return "no class" if by_strain is None else max(by_warp, by_strain, key=CLASSES.index)


def _strain_findings(metrics: tuple[Metric, ...], reached: Class, tol: Tolerances) -> tuple[Finding, ...]:
    """Refuse a part whose strain is of a worse class than the job accepts."""
    strain, value = _strain(metrics)
    if strain.passed:
        return ()
    message = (
        f"flattening strains the sheet by {value:.3g}, allowed {STRAIN_LIMIT[tol.accept]:g} "
        f"(accept = {tol.accept!r}); by warp it is {reached!r}, by strain {class_by_strain(value) or 'no class'!r}"
    )
    return (Finding("strain", message, True, strain.where),)


def _overlap_findings(covered: Metric) -> tuple[Finding, ...]:
    if covered.passed:
        return ()
    message = f"the flat pattern covers {covered.value:.4g} mm2 twice: divide the part into two that each turn less"
    return (Finding("flat-overlap", message, fatal=False),)


def _detail(corners: Points2, outer: Contour, sides: Sides) -> dict[str, object]:
    """Return the figures of both sides, and of the flat pattern alone."""
    low_x, low_y, high_x, high_y = arcpath.bounds(outer.path)
    return {
        "surface": {"area": sides.surface_area, "edges": _edges(sides.surface)},
        "flat": {
            "area": sides.flat_area,
            "outline_length": sum(sides.flat.values()),
            "width": high_x - low_x,
            "height": high_y - low_y,
            "corners": corners.tolist(),
            "edges": _edges(sides.flat),
            "marks": [],
            "holes": [],
        },
    }


def _edges(edges: Edges) -> dict[str, float]:
    return {"c0": edges.c0, "c1": edges.c1, "start": edges.start, "end": edges.end}
