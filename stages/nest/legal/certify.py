"""The certifier: whether a finished nest may be cut.  It trusts no engine and knows none.

It looks at contours, lines and arcs, never at polygons: at those of the parts moved by their placements (`certify`),
and at those read back from the cut files (`certify_contours`).  One module a rule:

- `copies`: every copy there once, on a sheet that exists, turned and mirrored as allowed, fixed ones in place;
- `gaps`, `common`: the smallest gap between two parts, exact; parts that cross or lie in one another;
- `ground`: on the sheet, away from its edge and its defects, exact; out of zones that are too poor.

`rigid_error_mm` compares the distances between the vertices of the placed contour with those of the part; of contours
with more than `MOST_PAIRS` pairs of them those between every one and some, and it is called sampled.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial.distance import cdist

from stages.geometry.arrays import Matrix, Points2
from stages.geometry.paths.arcpath import transform
from stages.model.pattern import FlatPattern
from stages.model.report import Evidence, Finding, Metric
from stages.model.sheet import Nesting, NestOptions, Placement, Sheet
from stages.nest.legal.copies import ANGLE_TOLERANCE_DEG, astray, miscounted, misturned, moved, off_grain_deg, overdrawn
from stages.nest.legal.gaps import between_copies
from stages.nest.legal.ground import edge_distances, edge_findings, utilisation, utilised, zone_finding, zone_overlaps
from stages.nest.legal.laid import Spread, fatal, lay, spread
from stages.nest.legal.region import GAP_TOLERANCE_MM

__all__ = ["ANGLE_TOLERANCE_DEG", "GAP_TOLERANCE_MM", "certify", "measured", "passed", "utilisation"]

MOST_PAIRS = 1_000_000
"""Of vertices of a contour, whose distances are compared: all pairs of 20 000 would fill gigabytes."""


def certify(
    nesting: Nesting,
    patterns: Sequence[FlatPattern],
    stock: Sequence[Sheet],
    options: NestOptions,
    fixed: Nesting | None = None,
) -> tuple[tuple[Metric, ...], tuple[Finding, ...]]:
    """Return what was measured on a nest, and what is wrong with it; every finding is fatal.

    fixed: placements that must be there as they are.
    """
    by_name = {pattern.part: pattern for pattern in patterns}
    findings = [*miscounted(nesting, patterns), *overdrawn(nesting, stock), *misturned(nesting, by_name, options)]
    findings += astray(nesting) if options.one_direction else []
    findings += moved(nesting, fixed) if fixed else []
    rigid = _rigid_error(nesting, by_name)
    findings += _not_rigid(rigid)
    sheets = [
        spread(layout, [lay(by_name[one.part], one) for one in layout.placements if one.part in by_name])
        for layout in nesting.layouts
    ]
    on_sheets, faults = measured(sheets, options)
    share, evidence = utilised(nesting, by_name)
    metrics = (
        Metric("utilisation", share, "", evidence),
        *on_sheets,
        rigid,
        *_grain(nesting, by_name),
    )
    return metrics, (*findings, *faults)


def passed(metrics: Iterable[Metric], findings: Iterable[Finding]) -> bool:
    """Return whether a nest may be cut."""
    return all(metric.passed for metric in metrics) and not any(finding.fatal for finding in findings)


class Measured(NamedTuple):
    """One sheet: smallest gaps in mm, infinite where there are none, areas in mm2, and what is wrong."""

    gap_mm: float
    common_gap_mm: float
    edge_gap_mm: float
    overlap_mm2: float
    zone_mm2: float
    findings: tuple[Finding, ...]


def measured(sheets: Sequence[Spread], options: NestOptions) -> tuple[tuple[Metric, ...], tuple[Finding, ...]]:
    """Return gaps and overlaps of copies as they lie on sheets, and what is wrong with them."""
    found = [_measured(one, options) for one in sheets]
    common = _least(one.common_gap_mm for one in found)
    zones = any(one.ground.zones for one in sheets)
    metrics = (
        Metric("min_gap_mm", _least(one.gap_mm for one in found), "mm", "proved"),
        *((Metric("min_common_gap_mm", common, "mm", "proved"),) if common is not None else ()),
        Metric("min_edge_gap_mm", _least(one.edge_gap_mm for one in found), "mm", "proved"),
        _area("overlap_mm2", sum((one.overlap_mm2 for one in found), start=0.0)),
        *((_area("zone_overlap_mm2", sum((one.zone_mm2 for one in found), start=0.0)),) if zones else ()),
    )
    return metrics, tuple(finding for one in found for finding in one.findings)


def _measured(one: Spread, options: NestOptions) -> Measured:
    """Return what was measured on one sheet."""
    between = between_copies(one, options)
    edges = edge_distances(one)
    zones = list(zone_overlaps(one))
    findings = [*between.findings, *edge_findings(one, edges), *(zone_finding(one, *zone) for zone in zones)]
    return Measured(
        between.gap_mm,
        between.common_gap_mm,
        min((distance.value for distance in edges), default=np.inf) + 0.0,
        between.overlap_mm2,
        sum((area for _, _, area in zones), start=0.0),
        tuple(findings),
    )


def _area(name: str, value: float) -> Metric:
    """Return an area that must be 0, which is then certain, while the area of an overlap is measured on polygons."""
    return Metric(name, value, "mm2", "sampled" if value else "proved", limit=0.0)


def _least(values: Iterable[float]) -> float | None:
    return min((float(value) for value in values if np.isfinite(value)), default=None)


def _grain(nesting: Nesting, by_name: Mapping[str, FlatPattern]) -> tuple[Metric, ...]:
    """Return how far a part with an axis lies off the grain at most, where there is such a part."""
    pairs = [(one, layout.sheet) for layout in nesting.layouts for one in layout.placements if one.part in by_name]
    found = [off_grain_deg(one, by_name[one.part], sheet) for one, sheet in pairs]
    known = [off for off in found if off is not None]
    return (Metric("off_grain_deg", max(known), "deg", "proved"),) if known else ()


def _rigid_error(nesting: Nesting, by_name: Mapping[str, FlatPattern]) -> Metric:
    """Return the largest change of a distance between two vertices of an outer contour by its placement."""
    placed = [one for layout in nesting.layouts for one in layout.placements if one.part in by_name]
    used = {one.part: by_name[one.part].outer.path.vertices for one in placed}
    before = {name: _apart(vertices) for name, vertices in used.items()}
    worst = max((_change(by_name[one.part], one, before[one.part]) for one in placed), default=0.0)
    evidence: Evidence = "proved" if all(_every(vertices) == 1 for vertices in used.values()) else "sampled"
    return Metric("rigid_error_mm", worst, "mm", evidence)


def _change(pattern: FlatPattern, one: Placement, before: Matrix) -> float:
    """Return the same of one copy; a mirror runs the contour the other way."""
    vertices = transform(pattern.outer.path, one.motion).vertices[:: -1 if one.motion.mirrored else 1]
    return float(np.abs(_apart(vertices) - before).max())


def _apart(vertices: Points2) -> Matrix:
    """Return the distances of all vertices to each, or to evenly chosen ones where they are many, mm."""
    apart: Matrix = cdist(vertices, vertices[:: _every(vertices)])
    return apart


def _every(vertices: Points2) -> int:
    """Return by how many vertices the ones to which distances are compared follow each other."""
    return 1 + (len(vertices) ** 2 - 1) // MOST_PAIRS


def _not_rigid(error: Metric) -> list[Finding]:
    """Return that a placement has changed a part by more than rounding does."""
    worst = float(error.value or 0.0)
    message = f"placing a part has changed its size by {worst:.3g} mm"
    return [] if worst <= GAP_TOLERANCE_MM else [fatal("rigid", message)]
