"""What is placed where: a part grown by half the gap, in the angles it may take, and the usable room of a sheet.

Every part grows by half the gap and every sheet shrinks by the edge gap less that half: then parts may touch each
other and the edge, and both gaps are kept.  A grown part is a polygon that contains the exact one (outward arcs by
tangents, mitred corners, then clipped to the exact box), so the side of the approximation is always the safe one.
"""

from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import numpy as np
from shapely import (
    Geometry,
    MultiPolygon,
    Polygon,
    affinity,
    box,
    get_parts,
    make_valid,
    maximum_inscribed_circle,
    transform,
)

from stages.geometry.arrays import Points2
from stages.geometry.curves.rigid import Rigid2, apply
from stages.geometry.paths import arcpath
from stages.geometry.paths.arcpath import bounds, polygon
from stages.model.pattern import FlatPattern
from stages.model.sheet import NestOptions, Placement, Quality, Sheet

Region: TypeAlias = Polygon | MultiPolygon
"""Where grown parts may lie, in the frame of a bed; it may be empty."""

HAIR_MM = 1e-9
"""Parts grow by this much more than half the gap, so that parts that touch are apart in spite of rounding (1e-12)."""

SLACK_MM = 5e-7
"""A sheet counts as this much larger: parts that fit exactly do, after rounding.  Half of what the certifier allows."""

FINEST_MM, COARSEST_MM, CHORD_SHARE = 0.01, 0.3, 2e-4
"""Chord error of a grown polygon: this share of the part's diagonal, within these limits."""

MANY_VERTICES = 60
"""A grown polygon with more vertices is simplified, outward, by the chord error."""

MITRE_LIMIT = 1.5
"""Corners of 90 degrees (1.41) keep their point, so that boxes stay boxes; sharper ones are cut off outside the arc."""

CIRCLE_SHARE = 1e-3
"""How closely the largest circle in a part is wanted, in shares of the part."""


@dataclass(frozen=True, slots=True, eq=False)
class Bed:
    """Where grown parts may lie on a sheet; `stock` is its place in the list.

    x_mm, y_mm: where the origin of the bed lies on the sheet.
    width_mm, height_mm: the box of the room; the width of a roll is a bound that suffices for all parts.
    regions: the room itself for each class of parts, None where it is the whole box: the first for parts that every
    zone is good enough for, each next one without the zones of one more of the rising `levels` of quality.
    cost, cost_mm: what one such sheet counts, and each mm of it that is used.
    """

    stock: int
    sheet: Sheet
    x_mm: float
    y_mm: float
    width_mm: float
    height_mm: float
    regions: tuple[Region | None, ...] = (None,)
    levels: tuple[int, ...] = ()
    cost: float = 1.0
    cost_mm: float = 0.0

    def level(self, quality: Quality) -> int:
        """Return the number of the class of parts of a quality: how many levels of zones they must not enter."""
        if quality == "best":
            return len(self.levels)
        return 0 if quality == "any" else bisect_left(self.levels, quality)

    def region(self, quality: Quality) -> Region | None:
        """Return where grown parts of a quality may lie, in the frame of the bed; None: in the whole box."""
        return self.regions[self.level(quality)]

    def room_mm2(self, quality: Quality) -> float:
        """Return the area of that region in mm2."""
        region = self.region(quality)
        return self.width_mm * self.height_mm if region is None else float(region.area)

    @property
    def area_mm2(self) -> float:
        """The area of the room, zones included."""
        return self.room_mm2("any")

    @property
    def plain(self) -> bool:
        """Whether every part may lie in the whole box."""
        return all(region is None for region in self.regions)


@dataclass(frozen=True, eq=False)
class Blank:
    """One part to be placed, as it is or mirrored: its grown polygon in the flat frame, mirrored already.

    part: its number among the lots, in which copies are counted (the two hands of a pair have one each).
    """

    part: int
    pattern: FlatPattern
    mirrored: bool
    grow_mm: float
    shape: Polygon

    @cached_property
    def area_mm2(self) -> float:
        """The area of the part itself."""
        return net_area(self.pattern)

    @cached_property
    def inner_radius_mm(self) -> float:
        """The radius of the largest circle in the grown part, or up to the tolerance less."""
        low_x, low_y, high_x, high_y = self.shape.bounds
        longest = float(np.hypot(high_x - low_x, high_y - low_y))
        return float(maximum_inscribed_circle(self.shape, tolerance=CIRCLE_SHARE * longest).length)


@dataclass(frozen=True, eq=False)
class Turned:
    """A grown part in one angle, the lower left corner of its exact box at the origin.

    dx, dy: what the motion of the part adds to the place of that corner.
    core: the polygon less the rounding, for tests of overlap.
    """

    blank: Blank
    angle_deg: float
    dx: float
    dy: float
    width_mm: float
    height_mm: float
    shape: Polygon

    @cached_property
    def core(self) -> Polygon:
        """The polygon shrunk by the slack: what touches does not overlap."""
        return self.shape.buffer(-SLACK_MM / 2.0, join_style="mitre")

    @cached_property
    def outline(self) -> tuple[Points2, Points2]:
        """Start and end points of all edges, holes included, the inside to the left."""
        return edges(self.shape)


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """A turned part whose box has its lower left corner at (x, y) of the bed.

    given: the placement by which it was put there from outside; it stays.
    """

    turned: Turned
    x: float
    y: float
    given: Placement | None = None

    @property
    def right_mm(self) -> float:
        """The right end of the box."""
        return self.x + self.turned.width_mm

    @property
    def top_mm(self) -> float:
        """The upper end of the box."""
        return self.y + self.turned.height_mm

    def motion(self, bed: Bed) -> Rigid2:
        """Return the motion from the flat frame of the part to the sheet."""
        if self.given is not None:
            return self.given.motion
        turned = self.turned
        x, y = self.x + turned.dx + bed.x_mm, self.y + turned.dy + bed.y_mm
        return Rigid2(x, y, turned.angle_deg, turned.blank.mirrored)


def net_area(pattern: FlatPattern) -> float:
    """Return the area of a part less its holes, in mm2; exact for the path."""
    holes = sum(abs(arcpath.area(contour.path)) for contour in pattern.inner)
    return abs(arcpath.area(pattern.outer.path)) - holes


def as_blank(part: int, pattern: FlatPattern, options: NestOptions, *, mirrored: bool = False) -> Blank:
    """Return a part ready to be placed."""
    grow = options.gap_mm / 2.0 + HAIR_MM
    shape = _grown(pattern, grow)
    if mirrored:
        shape = transform(shape, lambda points: apply(Rigid2(mirrored=True), points))
    return Blank(part, pattern, mirrored, grow, shape)


def _grown(pattern: FlatPattern, grow_mm: float) -> Polygon:
    low_x, low_y, high_x, high_y = bounds(pattern.outer.path)
    diagonal = np.hypot(high_x - low_x, high_y - low_y)
    chord = float(np.clip(CHORD_SHARE * diagonal, FINEST_MM, COARSEST_MM))
    exact = material(pattern, chord)
    grown = exact.buffer(grow_mm, join_style="mitre", mitre_limit=MITRE_LIMIT)
    if len(grown.exterior.coords) <= MANY_VERTICES:
        return grown
    return exact.buffer(grow_mm + chord, join_style="mitre", mitre_limit=MITRE_LIMIT).simplify(chord)


def material(pattern: FlatPattern, chord_mm: float) -> Polygon:
    """Return a polygon, holes cut out, that contains the part and is within the chord error of it."""
    outer = polygon(pattern.outer.path, accuracy=chord_mm, outside=True)
    holes = [polygon(contour.path, accuracy=chord_mm, outside=True) for contour in pattern.inner]
    shape = Polygon(outer, holes)
    if shape.is_valid:
        return shape
    parts = make_valid(shape)
    return max(getattr(parts, "geoms", [parts]), key=lambda one: one.area)


def extent(blank: Blank, angle_deg: float) -> tuple[float, float, float, float]:
    """Return the exact box of the part itself, turned by an angle: x and y least, width, height; mm."""
    motion = Rigid2(angle_deg=angle_deg, mirrored=blank.mirrored)
    low_x, low_y, high_x, high_y = bounds(arcpath.transform(blank.pattern.outer.path, motion))
    return low_x, low_y, high_x - low_x, high_y - low_y


def turned(blank: Blank, angle_deg: float) -> Turned:
    """Return a blank turned by an angle."""
    low_x, low_y, wide, high = extent(blank, angle_deg)
    grow = blank.grow_mm
    dx, dy, width, height = grow - low_x, grow - low_y, wide + 2.0 * grow, high + 2.0 * grow
    shape = transform(blank.shape, lambda points: apply(Rigid2(dx, dy, angle_deg), points))
    shape = shape.intersection(box(0.0, 0.0, width, height))
    return Turned(blank, angle_deg, dx, dy, width, height, shape)


def fits_turned(blank: Blank, angle_deg: float, within: Bed) -> bool:
    """Return whether the box of a blank turned by an angle lies within the bed."""
    _, _, wide, high = extent(blank, angle_deg)
    grow = 2.0 * blank.grow_mm
    return wide + grow <= within.width_mm and high + grow <= within.height_mm


def fits(one: Turned, within: Bed) -> bool:
    """Return whether the box lies within the bed."""
    return one.width_mm <= within.width_mm and one.height_mm <= within.height_mm


def polygon_at(placed: Placed) -> Polygon:
    """Return the grown polygon where it lies."""
    return affinity.translate(placed.turned.shape, placed.x, placed.y)


def core_at(turned: Turned, x: float, y: float) -> Polygon:
    """Return the polygon less the rounding where it would lie."""
    return affinity.translate(turned.core, x, y)


def edges(shape: Region) -> tuple[Points2, Points2]:
    """Return start and end points of all edges of polygons, holes included, the inside to the left."""
    rings = [ring for one in polygons(shape) for ring in _rings(one)]
    if not rings:
        return np.zeros((0, 2)), np.zeros((0, 2))
    return np.concatenate([ring[:-1] for ring in rings]), np.concatenate([ring[1:] for ring in rings])


def polygons(shape: Geometry) -> list[Polygon]:
    """Return the polygons of which a shape consists; lines and points that came with it are dropped."""
    return [one for one in get_parts(shape).tolist() if isinstance(one, Polygon) and not one.is_empty]


def as_region(parts: Sequence[Polygon]) -> Region:
    """Return polygons that do not meet as one shape."""
    return parts[0] if len(parts) == 1 else MultiPolygon(parts)


def _rings(shape: Polygon) -> list[Points2]:
    """Return the closed loops of corners of a polygon, the inside to the left."""
    sides = [(shape.exterior, True), *((hole, False) for hole in shape.interiors)]
    return [_as_sensed(np.asarray(ring.coords)[:, :2], ring.is_ccw == sense) for ring, sense in sides]


def _as_sensed(points: Points2, right: bool) -> Points2:
    return points if right else points[::-1]
