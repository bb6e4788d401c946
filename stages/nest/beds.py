"""The room on a piece of stock in which grown parts may lie, and what using it counts.

A rectangle is exact.  An outline becomes a polygon within it (swelling arcs by chords, hollow ones by tangents), shrunk
by the edge gap less half the gap between parts; defects, as polygons around them, grow by the same; zones are taken out
as they are.  So every approximation only takes room away.

Where the edge gap is less than half the gap, a rectangle and a convex outline grow by the difference, as a part that is
in the grown one with half a gap around it is in the true one by itself.  Of a hollow outline, of defects and of zones
that is not true: narrow bays and thin zones would vanish.  They stay as they are, and up to half a gap beside them is
not used.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
from shapely import Polygon, affinity, box, make_valid, prepare, unary_union

from stages.geometry.paths.arcpath import ArcPath, area, backwards, bounds, polygon
from stages.model.pattern import FlatPattern
from stages.model.sheet import NestOptions, Sheet
from stages.nest.blank import (
    CHORD_SHARE,
    COARSEST_MM,
    FINEST_MM,
    HAIR_MM,
    MANY_VERTICES,
    MITRE_LIMIT,
    SLACK_MM,
    Bed,
    Region,
    as_region,
    polygons,
)

CONVEX_SHARE = 1e-9
"""An outline counts as convex where its hull is larger by less than this share."""

SHARP_LIMIT = 10.0
"""Corners of a convex outline that grows are cut off beyond this many times the growth."""


METRE_MM = 1000.0
"""Rolls are priced by the metre."""


def beds(patterns: Sequence[FlatPattern], stock: Sequence[Sheet], options: NestOptions) -> list[Bed]:
    """Return the room on every piece of stock, in its order.

    Remnants are free.  Where all other stock has a price, that is what it counts; otherwise, or if all prices are 0,
    every new sheet counts 1.
    """
    prices = [sheet.price for sheet in stock if sheet.kind != "remnant"]
    priced = None not in prices and any(prices)
    length = roll_length(patterns, options)
    return [costed(bed(number, one, options, length), priced=priced) for number, one in enumerate(stock)]


def costed(free: Bed, *, priced: bool) -> Bed:
    """Return a bed with what it counts: one sheet of it, and each mm that is used."""
    sheet = free.sheet
    if sheet.kind == "remnant":
        return replace(free, cost=0.0)
    if not priced or sheet.price is None:
        return free
    return replace(free, cost=0.0, cost_mm=sheet.price / METRE_MM) if sheet.is_roll else replace(free, cost=sheet.price)


def roll_length(patterns: Sequence[FlatPattern], options: NestOptions) -> float:
    """Return a length in mm in which all copies can lie one after another, however they are turned."""
    sizes = ((one.quantity, bounds(one.outer.path)) for one in patterns)
    return sum(
        (count * (float(np.hypot(x1 - x0, y1 - y0)) + options.gap_mm) for count, (x0, y0, x1, y1) in sizes), start=0.0
    )


def bed(stock: int, sheet: Sheet, options: NestOptions, length_mm: float = 0.0) -> Bed:
    """Return where grown parts may lie on a sheet; of a roll, within this length besides its edge gaps."""
    inset = sheet.edge_gap_mm - options.gap_mm / 2.0 - HAIR_MM
    if sheet.outline is not None:
        room = _within(sheet.outline, inset)
        x, y, right, top = (0.0, 0.0, 0.0, 0.0) if room.is_empty else room.bounds
        return _with_regions(Bed(stock, sheet, x, y, right - x, top - y), room, inset)
    width = length_mm if sheet.is_roll else sheet.width_mm - 2.0 * inset + SLACK_MM
    height = sheet.height_mm - 2.0 * inset + SLACK_MM
    rectangle = Bed(stock, sheet, inset, inset, width, height)
    if not (sheet.defects or sheet.zones):
        return rectangle
    return _with_regions(rectangle, box(inset, inset, inset + max(width, 0.0), inset + max(height, 0.0)), inset)


def _with_regions(frame: Bed, room: Region, inset_mm: float) -> Bed:
    """Return a bed with its regions, given the room, in the frame of the sheet, without regard to defects and zones."""
    sheet = frame.sheet
    free = room.difference(unary_union([_around(path, inset_mm) for path in sheet.defects]))
    levels = tuple(sorted({zone.quality for zone in sheet.zones}))
    regions = [_settled(free, frame)]
    for level in levels:
        worse = [_around(zone.outline, 0.0) for zone in sheet.zones if zone.quality == level]
        free = free.difference(unary_union(worse))
        regions.append(_settled(free, frame))
    return replace(frame, regions=tuple(regions), levels=levels)


def _settled(shape: Region, frame: Bed) -> Region:
    """Return a region in the frame of its bed, ready for many questions."""
    moved = as_region(polygons(affinity.translate(shape, -frame.x_mm, -frame.y_mm)))
    prepare(moved)
    return moved


def _within(outline: ArcPath, inset_mm: float) -> Region:
    """Return the room within an outline, in the frame of the sheet; it never reaches out of the true one."""
    chord = chord_mm(outline)
    inner = _valid(polygon(_sensed(outline, right=False), accuracy=chord, outside=True)[::-1])
    slack = SLACK_MM / 2.0
    if inset_mm <= 0.0 and inner.convex_hull.area <= inner.area * (1.0 + CONVEX_SHARE):
        return as_region(polygons(inner.buffer(slack - inset_mm, join_style="mitre", mitre_limit=SHARP_LIMIT)))
    shrink = max(inset_mm, 0.0) - slack
    if _vertices(inner) <= MANY_VERTICES:
        return as_region(polygons(inner.buffer(-shrink, join_style="mitre", mitre_limit=MITRE_LIMIT)))
    smaller = inner.buffer(-shrink - chord, join_style="mitre", mitre_limit=MITRE_LIMIT)
    return as_region(polygons(make_valid(smaller.simplify(chord))))


def _around(outline: ArcPath, grow_mm: float) -> Region:
    """Return a polygon around an outline, grown if asked, in the frame of the sheet; it never misses a part of it."""
    hull = _filled(_valid(polygon(_sensed(outline, right=True), accuracy=chord_mm(outline), outside=True)))
    grow = max(grow_mm, 0.0)
    return hull if grow == 0.0 else as_region(polygons(hull.buffer(grow, join_style="mitre", mitre_limit=MITRE_LIMIT)))


def chord_mm(outline: ArcPath) -> float:
    """Return the chord error of the polygon for an outline of stock, in mm."""
    low_x, low_y, high_x, high_y = bounds(outline)
    return float(np.clip(CHORD_SHARE * np.hypot(high_x - low_x, high_y - low_y), FINEST_MM, COARSEST_MM))


def _sensed(outline: ArcPath, *, right: bool) -> ArcPath:
    """Return an outline counter-clockwise if `right`, else clockwise."""
    return outline if (area(outline) > 0.0) == right else backwards(outline)


def _valid(points: Iterable[object]) -> Region:
    """Return a polygon with these corners; where it crosses itself, the pieces it encloses."""
    shape = Polygon(points)
    return shape if shape.is_valid else as_region(polygons(make_valid(shape)))


def _filled(shape: Region) -> Region:
    """Return the same without holes."""
    return as_region(polygons(unary_union([Polygon(one.exterior) for one in polygons(shape)])))


def _vertices(shape: Region) -> int:
    return sum(len(one.exterior.coords) for one in polygons(shape))
