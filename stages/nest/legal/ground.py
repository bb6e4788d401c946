"""Parts and the sheet they lie on: distance to its edge and defects, zones that are too poor for a part, area used.

A rectangle, and a roll, keep their distance by the exact box of a part; an outline and a defect by the exact distance
of contours.  A distance is negative where a part lies beyond the edge or on a defect: then it is how far the contours
are apart all the same, 0 where they cross.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from shapely import Polygon, box, union_all
from shapely.geometry.base import BaseGeometry

from stages.geometry.paths.arcpath import ArcPath, area, polygon
from stages.geometry.paths.clearance import nearest
from stages.model.pattern import FlatPattern
from stages.model.report import Evidence, Finding
from stages.model.sheet import Nesting, Quality, Sheet, SheetLayout, Zone
from stages.model.used import used_length_mm
from stages.nest.legal.laid import Laid, Spread, fatal, paths_of
from stages.nest.legal.region import FINE_MM, GAP_TOLERANCE_MM, Region, boxes_meet, overlap_mm2, within

REACH_MM, REACH_GROWTH = 1.0, 8.0
"""Distances are looked for up to the gap and this much; where there is none, in steps that grow by the factor."""


class Distance(NamedTuple):
    """How far a copy is from something of its sheet, mm; negative beyond the edge or on a defect."""

    value: float
    laid: Laid
    what: str
    overlap_mm2: float = 0.0


def edge_distances(spread: Spread) -> list[Distance]:
    """Return the distance of every copy to the edge that is near it, and to defects."""
    sheet, outline = spread.ground.sheet, spread.ground.outline
    if not spread.laid:
        return []
    if outline is None:
        edges = [Distance(_room(one.region, sheet), one, "the edge") for one in spread.laid]
    else:
        edges = [
            Distance(gap if within(one.region, outline, gap) else -gap, one, "the edge")
            for one, gap in _gaps(spread, outline)
        ]
    return edges + [
        Distance(-gap if area_ > 0.0 else gap, one, f"defect {number}", area_)
        for number, defect in enumerate(spread.ground.defects, start=1)
        for one, gap in _gaps(spread, defect)
        for area_ in (overlap_mm2(one.region, defect, gap) if boxes_meet(one.region, defect) else 0.0,)
    ]


def edge_findings(spread: Spread, distances: list[Distance]) -> Iterator[Finding]:
    """Yield which copies leave the sheet, lie on a defect, or are too near its edge or a defect."""
    ground, asked = spread.ground, spread.ground.sheet.edge_gap_mm
    for value, one, what, area_ in distances:
        if area_ > 0.0:
            message = f"{one.name} lies on {what} of {ground.label}, by {area_:.6g} mm2"
            yield fatal("defect", message, sheet=ground.name, overlap_mm2=area_)
        elif value < asked - GAP_TOLERANCE_MM or _beyond(value, ground.outline):
            where = f"{value:.6g} mm from {what} of {ground.label}" if value > 0.0 else f"not within {ground.label}"
            yield fatal("edge-gap", f"{one.name} is {where}, asked {asked:g} mm", sheet=ground.name, gap_mm=value)


def _beyond(value: float, outline: Region | None) -> bool:
    """Return whether the sign says that a copy is not within an outline: -0.0 where it crosses it."""
    return outline is not None and bool(np.signbit(value))


def _room(one: Region, sheet: Sheet) -> float:
    """Return the distance to the nearest edge of a rectangle or of a roll, negative outside."""
    low_x, low_y, high_x, high_y = one.box
    return min(low_x, low_y, sheet.width_mm - high_x, sheet.height_mm - high_y)


def _gaps(spread: Spread, other: Region) -> list[tuple[Laid, float]]:
    """Return every copy with the exact distance of its contours to those of a region; those that are far, left out."""
    some, owner = spread.owned
    reach = spread.ground.sheet.edge_gap_mm + REACH_MM
    while not (found := nearest(some, owner, other.outline, within=reach)):
        reach *= REACH_GROWTH
    return [(one, found.get(i, reach)) for i, one in enumerate(spread.laid)]


def zone_overlaps(spread: Spread) -> Iterator[tuple[Laid, Zone, float]]:
    """Yield which copies reach into a zone that is too poor for them, and the area of it in mm2."""
    for zone, poor in spread.ground.zones:
        wary = [one for one in spread.laid if not accepts(one.quality, zone.quality) and boxes_meet(one.region, poor)]
        gaps = _gaps(Spread(spread.ground, tuple(wary)), poor) if wary else []
        for one, gap in gaps:
            area_ = overlap_mm2(one.region, poor, gap)
            if area_ > 0.0:
                yield one, zone, area_


def zone_finding(spread: Spread, one: Laid, zone: Zone, area_mm2: float) -> Finding:
    """Return that a copy lies in a zone that is too poor for it."""
    number = next(i for i, (known, _) in enumerate(spread.ground.zones, start=1) if known is zone)
    wanted = f"it needs {one.quality}" if isinstance(one.quality, int) else "it must lie outside all zones"
    where = f"zone {number} of {spread.ground.label}, of quality {zone.quality}"
    message = f"{one.name} reaches into {where}, by {area_mm2:.6g} mm2; {wanted}"
    return fatal("zone", message, sheet=spread.ground.name, overlap_mm2=area_mm2)


def accepts(quality: Quality, zone: int) -> bool:
    """Return whether a part of that quality may lie in a zone."""
    if quality in ("any", "best"):
        return quality == "any"
    return isinstance(quality, int) and zone >= quality


def utilisation(nesting: Nesting, by_name: Mapping[str, FlatPattern]) -> float | None:
    """Return the area of all parts over the area of all sheets used; None without a sheet."""
    return utilised(nesting, by_name)[0]


def utilised(nesting: Nesting, by_name: Mapping[str, FlatPattern]) -> tuple[float | None, Evidence]:
    """Return the same, and whether it is exact: where defects of an outline overlap it is measured on polygons."""
    known = [
        replace(layout, placements=tuple(one for one in layout.placements if one.part in by_name))
        for layout in nesting.layouts
    ]
    sheets = [sheet_area_mm2(layout, by_name) for layout in known]
    whole = sum(value for value, _ in sheets)
    parts = sum(part_area_mm2(by_name[one.part]) for layout in known for one in layout.placements)
    evidence: Evidence = "proved" if all(exact for _, exact in sheets) else "sampled"
    return (parts / whole if whole > 0.0 else None), evidence


def part_area_mm2(pattern: FlatPattern) -> float:
    """Return the area of a part less its holes; exact for its path."""
    outer, *holes = (abs(area(path)) for path in paths_of(pattern))
    return outer - sum(holes)


def sheet_area_mm2(layout: SheetLayout, by_name: Mapping[str, FlatPattern]) -> tuple[float, bool]:
    """Return the area of a sheet, or of the used length of a roll, less its defects; and whether that is exact."""
    sheet = layout.sheet
    length = used_length_mm(layout, by_name) if sheet.is_roll else sheet.width_mm
    whole = length * sheet.height_mm if sheet.outline is None else abs(area(sheet.outline))
    if not sheet.defects:
        return whole, True
    bed = box(0.0, 0.0, length, sheet.height_mm) if sheet.outline is None else _ring(sheet.outline)
    defects = [_ring(defect) for defect in sheet.defects]
    apart = sum(defect.area for defect in defects) - union_all(defects).area <= GAP_TOLERANCE_MM
    if apart and all(bed.contains(defect) for defect in defects):
        return whole - sum(abs(area(defect)) for defect in sheet.defects), True
    return float(bed.difference(union_all(defects)).area), False


def _ring(path: ArcPath) -> BaseGeometry:
    return Polygon(polygon(path, accuracy=FINE_MM)).buffer(0.0)
