"""An instance as the rivals are told it: polygons and numbers, as one JSON document.

Rivals that know no gap to the edge get beds: what of a sheet is left inside that gap.  Zones that are closed to any of
the parts are closed to all, for no rival has classes; a rival for which a bed or a part is more than it can express
says so itself.
"""

from collections.abc import Sequence

import msgspec
from shapely import Polygon, box
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from stages.geometry.paths.arcpath import ArcPath
from stages.model.pattern import FlatPattern
from stages.model.sheet import Quality, Sheet
from tests.bench.nest.instances import Instance

Ring = list[tuple[float, float]]


class Part(msgspec.Struct):
    """angles: in degrees, None: any; quarters or the like as they stand in the file."""

    id: str
    count: int
    angles: list[float] | None
    outer: Ring
    holes: list[Ring]


class Bed(msgspec.Struct):
    """Where parts of a stock may lie: outline and what is blocked in it; count None: as many as needed."""

    stock: str
    count: int | None
    outer: Ring
    blocked: list[Ring]


class Task(msgspec.Struct):
    """strip: low y, high y, least x of the parts on a strip; None: beds hold sheets."""

    seconds: float
    seed: int
    gap_mm: float
    parts: list[Part]
    beds: list[Bed]
    strip: tuple[float, float, float] | None


def task(instance: Instance, seconds: float, seed: int) -> Task:
    """Return the task that an instance is."""
    parts = [_part(one) for one in instance.patterns]
    gap = instance.options.gap_mm
    if instance.is_strip:
        sheet = instance.stock[0]
        edge = sheet.edge_gap_mm
        return Task(seconds, seed, gap, parts, [], (edge, sheet.height_mm - edge, edge))
    qualities = {one.quality for one in instance.patterns}
    beds = [bed for sheet in instance.stock for bed in _beds(sheet, qualities)]
    return Task(seconds, seed, gap, parts, beds, None)


def _part(pattern: FlatPattern) -> Part:
    angles = None if pattern.rotations in (None, "free") else [float(angle) for angle in pattern.rotations]
    holes = [_ring(hole.path) for hole in pattern.inner]
    return Part(pattern.part, pattern.quantity, angles, _ring(pattern.outer.path), holes)


def _ring(path: ArcPath) -> Ring:
    """Return the corners of a path of straight lines."""
    if path.bulges.any():
        raise ValueError("rivals are told polygons only")
    return [(float(x), float(y)) for x, y in path.vertices]


def _beds(sheet: Sheet, qualities: set[Quality]) -> list[Bed]:
    """Return what of a sheet may be used by every part, shrunk by the edge gap: more than one piece is possible."""
    edge = sheet.edge_gap_mm
    whole = box(0.0, 0.0, sheet.width_mm, sheet.height_mm) if sheet.outline is None else _polygon(sheet.outline)
    bed = whole.buffer(-edge, join_style="mitre") if edge else whole
    blocked = [_grown(_polygon(path), edge) for path in sheet.defects]
    blocked += [_polygon(zone.outline) for zone in sheet.zones if any(closed(zone.quality, one) for one in qualities)]
    usable = bed.difference(unary_union(blocked))
    return [_bed(sheet, piece) for piece in getattr(usable, "geoms", [usable]) if not piece.is_empty]


def closed(zone: int, part: Quality) -> bool:
    """Return whether a zone of that quality is closed to a part."""
    return part == "best" or (part != "any" and zone < part)


def _bed(sheet: Sheet, piece: Polygon) -> Bed:
    return Bed(sheet.id, sheet.quantity, _corners(piece.exterior.coords), [_corners(r.coords) for r in piece.interiors])


def _corners(coords: Sequence[tuple[float, ...]]) -> Ring:
    return [(float(x), float(y)) for x, y in coords[:-1]]


def _polygon(path: ArcPath) -> BaseGeometry:
    return Polygon(_ring(path)).buffer(0.0)


def _grown(polygon: BaseGeometry, by_mm: float) -> BaseGeometry:
    return polygon.buffer(by_mm, join_style="mitre") if by_mm else polygon
