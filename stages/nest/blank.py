"""What is placed where: a part grown by half the gap, in the angles it may take, and the usable rectangle of a sheet.

Every part grows by half the gap and every sheet shrinks by the edge gap less that half: then parts may touch each
other and the edge, and both gaps are kept.  A grown part is a polygon that contains the exact one (outward arcs by
tangents, mitred corners, then clipped to the exact box), so the side of the approximation is always the safe one.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from shapely import Polygon, affinity, box, make_valid, transform

from stages.geometry import arcpath
from stages.geometry.arcpath import bounds, polygon
from stages.geometry.arrays import Points2
from stages.geometry.rigid import Rigid2, apply
from stages.model.pattern import FlatPattern
from stages.model.sheet import NestOptions, Sheet

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

NEVER_TURNED = (0.0,)


@dataclass(frozen=True, slots=True)
class Bed:
    """The rectangle in which grown parts may lie: `inset_mm` inside the sheet; `stock` is its place in the list."""

    stock: int
    sheet: Sheet
    inset_mm: float
    width_mm: float
    height_mm: float


@dataclass(frozen=True, eq=False)
class Blank:
    """One part to be placed: its place in the list, what it may be turned by (None: any angle), its grown polygon."""

    part: int
    pattern: FlatPattern
    angles: tuple[float, ...] | None
    grow_mm: float
    shape: Polygon

    @cached_property
    def area_mm2(self) -> float:
        """The area of the part itself."""
        return net_area(self.pattern)


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
    """A turned part whose box has its lower left corner at (x, y) of the bed."""

    turned: Turned
    x: float
    y: float

    @property
    def right_mm(self) -> float:
        """The right end of the box."""
        return self.x + self.turned.width_mm

    def motion(self, bed: Bed) -> Rigid2:
        """Return the motion from the flat frame of the part to the sheet."""
        turned = self.turned
        return Rigid2(self.x + turned.dx + bed.inset_mm, self.y + turned.dy + bed.inset_mm, turned.angle_deg)


def net_area(pattern: FlatPattern) -> float:
    """Return the area of a part less its holes, in mm2; exact for the path."""
    holes = sum(abs(arcpath.area(contour.path)) for contour in pattern.inner)
    return abs(arcpath.area(pattern.outer.path)) - holes


def bed(stock: int, sheet: Sheet, options: NestOptions) -> Bed:
    """Return where grown parts may lie on a sheet."""
    inset = sheet.edge_gap_mm - options.gap_mm / 2.0 - HAIR_MM
    return Bed(stock, sheet, inset, sheet.width_mm - 2.0 * inset + SLACK_MM, sheet.height_mm - 2.0 * inset + SLACK_MM)


def as_blank(part: int, pattern: FlatPattern, options: NestOptions) -> Blank:
    """Return a part ready to be placed."""
    grow = options.gap_mm / 2.0 + HAIR_MM
    return Blank(part, pattern, allowed_angles(pattern, options), grow, _grown(pattern, grow))


def allowed_angles(pattern: FlatPattern, options: NestOptions) -> tuple[float, ...] | None:
    """Return the angles in [0, 360) degrees a part may be turned by, None for any; its own list goes first."""
    wished = options.rotations if pattern.rotations is None else pattern.rotations
    if wished is None or wished == "free":
        return None
    return tuple(dict.fromkeys(angle % 360.0 for angle in wished)) or NEVER_TURNED


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


def turned(blank: Blank, angle_deg: float) -> Turned:
    """Return a blank turned by an angle."""
    low_x, low_y, high_x, high_y = bounds(arcpath.transform(blank.pattern.outer.path, Rigid2(angle_deg=angle_deg)))
    grow = blank.grow_mm
    dx, dy = grow - low_x, grow - low_y
    width, height = high_x - low_x + 2.0 * grow, high_y - low_y + 2.0 * grow
    motion = Rigid2(dx, dy, angle_deg)
    shape = transform(blank.shape, lambda points: apply(motion, points)).intersection(box(0.0, 0.0, width, height))
    return Turned(blank, angle_deg, dx, dy, width, height, shape)


def fits(one: Turned, within: Bed) -> bool:
    """Return whether the box lies within the bed."""
    return one.width_mm <= within.width_mm and one.height_mm <= within.height_mm


def polygon_at(placed: Placed) -> Polygon:
    """Return the grown polygon where it lies."""
    return affinity.translate(placed.turned.shape, placed.x, placed.y)


def core_at(turned: Turned, x: float, y: float) -> Polygon:
    """Return the polygon less the rounding where it would lie."""
    return affinity.translate(turned.core, x, y)


def edges(shape: Polygon) -> tuple[Points2, Points2]:
    """Return start and end points of all edges of a polygon, holes included, the inside to the left."""
    rings = [(shape.exterior, True), *((hole, False) for hole in shape.interiors)]
    turned_right = [_as_sensed(np.asarray(ring.coords)[:, :2], ring.is_ccw == sense) for ring, sense in rings]
    return np.concatenate([ring[:-1] for ring in turned_right]), np.concatenate([ring[1:] for ring in turned_right])


def _as_sensed(points: Points2, right: bool) -> Points2:
    return points if right else points[::-1]
