"""A layout as an engine tells it, checked by the certifier and measured.

Engines only tell where they put what: one line of JSON for each layout, better ones later.  Whether it is valid, and
how dense, is found here from the contours of the parts alone, the same for every engine, planish included.

Density: area of the parts over strip height times used length; over the area of the sheets or hides used, net of
their defects.  Equivalent density, for rectangular sheets: over that area less the largest strip that one straight cut
along a side leaves of the emptiest sheet.

Engines that compute in single precision leave angles of 90.000003 deg and overlaps of 1e-14 mm2.  An angle within
`ANGLE_NOISE_DEG` of an allowed one is that one, and where the certifier then finds nothing but shortfalls below
`NOISE` of the sheet's size, the verdict is `rounding`: fair to compare, not fit to cut.
"""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import inf, nan
from typing import Literal

import msgspec
import numpy as np

from stages.geometry.arrays import norm
from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import area, bounds, transform
from stages.model.pattern import FlatPattern
from stages.model.report import Finding, Metric
from stages.model.sheet import Nesting, NestOptions, Placement, Sheet, SheetLayout
from stages.nest.legal.certify import certify, passed
from tests.bench.nest.instances import Instance

Box = tuple[float, float, float, float]
Verdict = Literal["valid", "rounding", "INVALID"]

ANGLE_NOISE_DEG = 1e-3
"""Far below any grain tolerance; a part of 1 m moves by 0.02 mm, which the certifier then sees."""

NOISE = 1e-6
"""Of the size of the sheet: 16 times the last bit of single precision."""

NOISY = {"gap", "edge-gap", "overlap"}
"""Findings that rounding can cause."""


class Spot(msgspec.Struct):
    """One copy: mirrored (x to -x), turned about the origin, then moved; `sheet` counts all sheets used, from 0."""

    part: str
    stock: str
    sheet: int
    x: float
    y: float
    angle_deg: float
    mirrored: bool = False


class Said(msgspec.Struct):
    """One line of an engine: a layout, or an error, or what it cannot do at all; seconds and memory where it knows."""

    placed: list[Spot] = []
    error: str = ""
    unable: str = ""
    seconds: float | None = None
    memory_mb: float | None = None


@dataclass(frozen=True, slots=True)
class Measured:
    """What a layout is worth: verdict and faults; the sheets it uses; densities as fractions, NaN where undefined."""

    verdict: Verdict
    faults: tuple[str, ...]
    sheets: int
    density: float
    equivalent: float
    length_mm: float = nan


def nesting_of(spots: Sequence[Spot], instance: Instance) -> Nesting:
    """Return the nest that an engine told: copies and sheets numbered in the order in which they come."""
    stock = {sheet.id: sheet for sheet in instance.stock}
    patterns = {one.part: one for one in instance.patterns}
    copies: Counter[str] = Counter()
    held: dict[tuple[str, int], list[Placement]] = {}
    for spot in spots:
        copies[spot.part] += 1
        angle = snapped(spot.angle_deg, patterns[spot.part], instance.options)
        motion = Rigid2(spot.x, spot.y, angle, spot.mirrored)
        held.setdefault((spot.stock, spot.sheet), []).append(Placement(spot.part, copies[spot.part], motion))
    used: Counter[str] = Counter()
    layouts = []
    for (name, _), placements in held.items():
        used[name] += 1
        layouts.append(SheetLayout(stock[name], used[name], tuple(placements), 0.0))
    return Nesting(tuple(layouts))


def snapped(angle_deg: float, pattern: FlatPattern, options: NestOptions) -> float:
    """Return the allowed angle that is meant, where the angles are listed."""
    listed = options.rotations if pattern.rotations is None else pattern.rotations
    if listed is None or listed == "free":
        return angle_deg
    near = [one for one in listed if abs((angle_deg - one + 180.0) % 360.0 - 180.0) <= ANGLE_NOISE_DEG]
    return near[0] if near else angle_deg


def measured(nesting: Nesting, instance: Instance) -> Measured:
    """Return what the certifier says of a nest, and its figures."""
    verdict, faults = judged(nesting, instance)
    by_name = {one.part: one for one in instance.patterns}
    parts = sum(net_area(by_name[spot.part]) for layout in nesting.layouts for spot in layout.placements)
    boxes = [_box(layout, by_name) for layout in nesting.layouts]
    sheets = [layout.sheet for layout in nesting.layouts]
    if instance.is_strip:
        length = sum(box[2] + sheet.edge_gap_mm for box, sheet in zip(boxes, sheets, strict=True))
        density = parts / (length * instance.stock[0].height_mm)
        return Measured(verdict, faults, len(sheets), density, nan, length)
    total = sum(map(net_area_of_sheet, sheets))
    return Measured(verdict, faults, len(sheets), parts / total, equivalent_density(parts, sheets, boxes))


def judged(nesting: Nesting, instance: Instance) -> tuple[Verdict, tuple[str, ...]]:
    """Return whether the certifier passes a nest, and its faults."""
    metrics, findings = certify(nesting, instance.patterns, instance.stock, instance.options)
    if passed(metrics, findings):
        return "valid", ()
    fatal = [one for one in findings if one.fatal]
    faults = [one.message for one in fatal] or [f"{one.name} is {one.value}" for one in metrics if not one.passed]
    return ("rounding" if _is_noise(metrics, fatal, instance) else "INVALID"), tuple(faults)


def _is_noise(metrics: Sequence[Metric], fatal: Sequence[Finding], instance: Instance) -> bool:
    """Return whether all that is wrong is within what single precision leaves."""
    value = {one.name: one.value for one in metrics}
    noise = NOISE * max(min(sheet.width_mm, 10.0 * sheet.height_mm) for sheet in instance.stock)
    gap, edge = instance.options.gap_mm, max(sheet.edge_gap_mm for sheet in instance.stock)
    least = min(2.0 * float(norm(np.ptp(one.outer.path.vertices, axis=0))) for one in instance.patterns)
    overlaps = [(one.where or {}).get("overlap_mm2", inf) for one in fatal if one.code == "overlap"]
    return (
        {one.code for one in fatal} <= NOISY
        and _at_least(value["min_gap_mm"], gap - noise)
        and _at_least(value["min_edge_gap_mm"], edge - noise)
        and all(float(overlap) <= noise * least for overlap in overlaps)
    )


def _at_least(value: float | bool | None, bound: float) -> bool:
    return value is None or value >= bound


def equivalent_density(parts_mm2: float, sheets: Sequence[Sheet], boxes: Sequence[Box]) -> float:
    """Return the area of the parts over that of the sheets, of the emptiest only what a straight cut takes off it.

    boxes: of the parts on each sheet.  NaN where a sheet is no plain rectangle.
    """
    if not all(sheet.is_rectangle for sheet in sheets):
        return nan
    areas = [sheet.width_mm * sheet.height_mm for sheet in sheets]
    spared = max(left_over(sheet, box) * area_ for sheet, box, area_ in zip(sheets, boxes, areas, strict=True))
    return parts_mm2 / (sum(areas) - spared)


def left_over(sheet: Sheet, box: Box) -> float:
    """Return the largest share of a rectangle that one straight cut along a side leaves, given the box of its parts."""
    low_x, low_y, high_x, high_y = box
    gap = sheet.edge_gap_mm
    across = max(low_x, sheet.width_mm - high_x) - gap, max(low_y, sheet.height_mm - high_y) - gap
    return max(0.0, across[0] / sheet.width_mm, across[1] / sheet.height_mm)


def net_area(pattern: FlatPattern) -> float:
    """Return the area of a part in mm2 without its holes."""
    return abs(area(pattern.outer.path)) - sum(abs(area(hole.path)) for hole in pattern.inner)


def net_area_of_sheet(sheet: Sheet) -> float:
    """Return the area of a sheet in mm2 without its defects."""
    whole = sheet.width_mm * sheet.height_mm if sheet.outline is None else abs(area(sheet.outline))
    return whole - sum(abs(area(hole)) for hole in sheet.defects)


def _box(layout: SheetLayout, by_name: dict[str, FlatPattern]) -> Box:
    """Return the box of all parts on a sheet."""
    return _union(bounds(transform(by_name[one.part].outer.path, one.motion)) for one in layout.placements)


def _union(boxes: Iterable[Box]) -> Box:
    each = np.array(list(boxes))
    low_x, low_y = each[:, :2].min(axis=0)
    high_x, high_y = each[:, 2:].max(axis=0)
    return float(low_x), float(low_y), float(high_x), float(high_y)
