"""The certifier: whether a finished nest may be cut.  It trusts no engine and knows none.

It looks at the contours as they will be written, lines and arcs moved by the placements, not at polygons:
every copy there once, on a sheet that exists, turned as allowed; the smallest gap between two parts and to the edge,
exact; parts that cross or lie in one another.  Contours that are apart do not cross, so one point of each contour
tells whether one part lies in the other; only the area of an overlap that was found is measured on polygons.
`rigid_error_mm` compares the distances between the vertices of the placed contour with those of the part.
"""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.distance import pdist
from shapely import Polygon, STRtree, box

from stages.geometry.arcpath import ArcPath, bounds, polygon, transform
from stages.geometry.arrays import Points2
from stages.geometry.clearance import Pieces, clearances, inside, joined, pieces
from stages.model.pattern import FlatPattern
from stages.model.report import Finding, Metric
from stages.model.sheet import Nesting, NestOptions, Placement, Sheet, SheetLayout
from stages.nest.blank import allowed_angles, net_area

GAP_TOLERANCE_MM = 1e-6
"""A gap may fall short by this: above the rounding of coordinates, below what any machine can cut."""

ANGLE_TOLERANCE_DEG = 1e-9
"""An angle counts as allowed within this: 2e-8 mm on a part of 1 m."""

REACH_MM, REACH_GROWTH = 1.0, 8.0
"""Pairs are looked for up to the gap and this much; where there is none, in steps that grow by the factor."""

FINE_MM = 1e-3
"""Chord error of the polygons on which the area of an overlap is measured."""

ASIDE = (0.5403, 0.8415)
"""Unit step by which a point is moved before asking what it lies in: no contour of a shop runs along it."""

LEAST_OVERLAP_MM2 = 1e-9
"""Reported for an overlap that is certain but too small for its area to be measured."""


@dataclass(frozen=True, slots=True, eq=False)
class Laid:
    """One placed copy: its contours on the sheet, outer first, and their lines and arcs."""

    placement: Placement
    contours: tuple[ArcPath, ...]
    pieces: tuple[Pieces, ...]

    @property
    def name(self) -> str:
        """What to call it in a message."""
        return f"'{self.placement.part}' copy {self.placement.copy}"


def certify(
    nesting: Nesting, patterns: Sequence[FlatPattern], stock: Sequence[Sheet], options: NestOptions
) -> tuple[tuple[Metric, ...], tuple[Finding, ...]]:
    """Return what was measured on a nest, and what is wrong with it; every finding is fatal."""
    by_name = {pattern.part: pattern for pattern in patterns}
    findings = [*_copies(nesting, patterns), *_sheets(nesting, stock), *_rotations(nesting, by_name, options)]
    sheets = [
        [lay(by_name[one.part], one) for one in layout.placements if one.part in by_name] for layout in nesting.layouts
    ]
    measured = [_gaps(layout, laid, options) for layout, laid in zip(nesting.layouts, sheets, strict=True)]
    edge = [_edge_gap(layout, laid) for layout, laid in zip(nesting.layouts, sheets, strict=True)]
    findings += [finding for _, _, found in measured for finding in found] + [found for _, bad in edge for found in bad]
    overlap = sum((area for _, area, _ in measured), start=0.0)
    metrics = (
        Metric("utilisation", utilisation(nesting, by_name), "", "proved"),
        Metric("min_gap_mm", _least(gap for gap, _, _ in measured), "mm", "proved"),
        Metric("min_edge_gap_mm", _least(gap for gap, _ in edge), "mm", "proved"),
        Metric("overlap_mm2", overlap, "mm2", "sampled" if overlap else "proved", limit=0.0),
        Metric("rigid_error_mm", _rigid_error(sheets, by_name), "mm", "proved"),
    )
    return metrics, tuple(findings)


def passed(metrics: Iterable[Metric], findings: Iterable[Finding]) -> bool:
    """Return whether a nest may be cut."""
    return all(metric.passed for metric in metrics) and not any(finding.fatal for finding in findings)


def lay(pattern: FlatPattern, placement: Placement) -> Laid:
    """Return the contours of a part where it is placed."""
    paths = (pattern.outer.path, *(contour.path for contour in pattern.inner))
    moved = tuple(transform(path, placement.motion) for path in paths)
    return Laid(placement, moved, tuple(pieces(path) for path in moved))


def utilisation(nesting: Nesting, by_name: dict[str, FlatPattern]) -> float | None:
    """Return the area of all parts over the area of all sheets used; None without a sheet."""
    sheets = sum(layout.sheet.width_mm * layout.sheet.height_mm for layout in nesting.layouts)
    placed = (one for layout in nesting.layouts for one in layout.placements)
    parts = sum(net_area(by_name[one.part]) for one in placed if one.part in by_name)
    return parts / sheets if nesting.layouts else None


def _least(values: Iterable[float]) -> float | None:
    finite = [value for value in values if np.isfinite(value)]
    return min(finite, default=None)


def _fatal(code: str, message: str, **where: float | str) -> Finding:
    return Finding(code, message, fatal=True, where=dict(where) or None)


def _copies(nesting: Nesting, patterns: Sequence[FlatPattern]) -> list[Finding]:
    """Return what is missing, there twice, or not wanted at all."""
    wanted = {(pattern.part, copy) for pattern in patterns for copy in range(1, pattern.quantity + 1)}
    there = Counter((one.part, one.copy) for layout in nesting.layouts for one in layout.placements)
    missing = [
        _fatal("missing-copy", f"'{part}' copy {copy} is not placed", part=part)
        for part, copy in sorted(wanted - set(there))
    ]
    twice = [
        _fatal("duplicate-copy", f"'{part}' copy {copy} is placed {count} times", part=part)
        for (part, copy), count in sorted(there.items())
        if count > 1
    ]
    odd = [
        _fatal("unknown-copy", f"'{part}' copy {copy} was not asked for", part=part)
        for part, copy in sorted(set(there) - wanted)
    ]
    return missing + twice + odd


def _sheets(nesting: Nesting, stock: Sequence[Sheet]) -> list[Finding]:
    """Return which sheets do not exist, or are used more often than there are."""
    findings = [
        _fatal("unknown-sheet", f"sheet '{layout.sheet.id}' is not in the stock as it is used", sheet=layout.sheet.id)
        for layout in nesting.layouts
        if layout.sheet not in stock
    ]
    for sheet in stock:
        indices = sorted(layout.index for layout in nesting.layouts if layout.sheet.id == sheet.id)
        if indices != list(range(1, len(indices) + 1)):
            findings.append(_fatal("sheet-index", f"the sheets of '{sheet.id}' are numbered {indices}", sheet=sheet.id))
        if sheet.quantity is not None and len(indices) > sheet.quantity:
            message = f"{len(indices)} sheets of '{sheet.id}' are used, there are {sheet.quantity}"
            findings.append(_fatal("stock-exceeded", message, sheet=sheet.id))
    return findings


def _rotations(nesting: Nesting, by_name: dict[str, FlatPattern], options: NestOptions) -> list[Finding]:
    """Return which copies are mirrored or turned against their limits."""
    findings = []
    for one in (one for layout in nesting.layouts for one in layout.placements if one.part in by_name):
        angles, angle = allowed_angles(by_name[one.part], options), one.motion.angle_deg
        if one.motion.mirrored:
            findings.append(_fatal("mirrored", f"'{one.part}' copy {one.copy} is mirrored", part=one.part))
        if angles is not None and not any(_same_angle(angle, allowed) for allowed in angles):
            message = f"'{one.part}' copy {one.copy} is turned by {angle:g} deg, allowed are {angles}"
            findings.append(_fatal("rotation", message, part=one.part, angle_deg=angle))
    return findings


def _same_angle(a_deg: float, b_deg: float) -> bool:
    """Return whether two angles are the same up to whole turns."""
    return abs((a_deg - b_deg + 180.0) % 360.0 - 180.0) <= ANGLE_TOLERANCE_DEG


def _edge_gap(layout: SheetLayout, laid: Sequence[Laid]) -> tuple[float, list[Finding]]:
    """Return the smallest distance to the edge of the sheet in mm, negative outside, and whether it is too small."""
    sheet = layout.sheet
    gaps = []
    for one in laid:
        low_x, low_y, high_x, high_y = bounds(one.contours[0])
        gaps.append((min(low_x, low_y, sheet.width_mm - high_x, sheet.height_mm - high_y), one.name))
    least, name = min(gaps, default=(np.inf, ""))
    if least >= sheet.edge_gap_mm - GAP_TOLERANCE_MM:
        return least, []
    message = f"{name} is {least:.6g} mm from the edge of {_label(layout)}, asked {sheet.edge_gap_mm:g} mm"
    return least, [_fatal("edge-gap", message, sheet=_label(layout), gap_mm=least)]


def _gaps(layout: SheetLayout, laid: Sequence[Laid], options: NestOptions) -> tuple[float, float, list[Finding]]:
    """Return the smallest gap in mm, the area of overlap in mm2, and what is wrong with them on one sheet."""
    gaps = _pair_gaps(laid, options.gap_mm)
    least, pair = min(((gap, pair) for pair, gap in gaps.items()), default=(np.inf, (0, 0)))
    findings = []
    if least < options.gap_mm - GAP_TOLERANCE_MM:
        names = " and ".join(laid[i].name for i in pair)
        message = f"{names} on {_label(layout)} are {least:.6g} mm apart, asked {options.gap_mm:g} mm"
        findings.append(_fatal("gap", message, sheet=_label(layout), gap_mm=least))
    total = 0.0
    for i, j in _boxes_meet(laid):
        area = _overlap(laid[i], laid[j], gaps.get((i, j), options.gap_mm + REACH_MM))
        total += area
        if area > 0.0:
            message = f"{laid[i].name} and {laid[j].name} on {_label(layout)} overlap by {area:.6g} mm2"
            findings.append(_fatal("overlap", message, sheet=_label(layout), overlap_mm2=area))
    return least, total, findings


def _label(layout: SheetLayout) -> str:
    return f"sheet {layout.sheet.id}-{layout.index}"


def _pair_gaps(laid: Sequence[Laid], gap_mm: float) -> dict[tuple[int, int], float]:
    """Return the exact gaps of all pairs at least as near as asked, and of the nearest pair in any case."""
    if len(laid) <= 1:
        return {}
    some = [joined(one.pieces) for one in laid]
    owner = np.repeat(np.arange(len(laid)), [one.bulge.size for one in some])
    every, reach = joined(some), gap_mm + REACH_MM
    while not (found := clearances(every, owner, within=reach)):
        reach *= REACH_GROWTH
    return found


def _boxes_meet(laid: Sequence[Laid]) -> list[tuple[int, int]]:
    """Return the pairs whose boxes meet."""
    frames = [box(*bounds(one.contours[0])) for one in laid]
    first, second = STRtree(frames).query(frames, predicate="intersects")
    return sorted((i, j) for i, j in zip(first.tolist(), second.tolist(), strict=True) if i < j)


def _overlap(a: Laid, b: Laid, gap_mm: float) -> float:
    """Return the area common to two parts in mm2: exactly 0 where their contours are apart and neither lies within."""
    if gap_mm > 0.0 and not (_reaches_into(a, b, gap_mm) or _reaches_into(b, a, gap_mm)):
        return 0.0
    area = float(_material(a).intersection(_material(b)).area)
    return max(area, LEAST_OVERLAP_MM2) if gap_mm > 0.0 else area


def _reaches_into(a: Laid, b: Laid, gap_mm: float) -> bool:
    """Return whether a contour of `a` lies within the material of `b`, given how far apart the contours are."""
    step = min(gap_mm, REACH_MM) / 2.0 * np.array(ASIDE)
    points = np.stack([path.vertices[0] for path in a.contours]) + step
    within = inside(points, b.pieces[0])
    for hole in b.pieces[1:]:
        within &= ~inside(points, hole)
    return bool(within.any())


def _material(one: Laid) -> Polygon:
    """Return the part as a polygon with holes."""
    rings = [polygon(path, accuracy=FINE_MM) for path in one.contours]
    return Polygon(rings[0], rings[1:]).buffer(0.0)


def _rigid_error(sheets: Sequence[Sequence[Laid]], by_name: dict[str, FlatPattern]) -> float:
    """Return the largest change of a distance between two vertices of an outer contour by its placement, in mm."""
    before = {name: pdist(pattern.outer.path.vertices) for name, pattern in by_name.items()}
    errors = [
        float(np.abs(pdist(_as_before(one)) - before[one.placement.part]).max()) for laid in sheets for one in laid
    ]
    return max(errors, default=0.0)


def _as_before(one: Laid) -> Points2:
    """Return the placed vertices in their first order; a mirror runs the contour the other way."""
    return one.contours[0].vertices[:: -1 if one.placement.motion.mirrored else 1]
