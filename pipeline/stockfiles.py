"""Stock from files: `[[stock]] file = ...` -> rows of `[[stock]]` that hold their outlines themselves.

A drawing (`.dxf`): layers have meanings (`LayersTable`); each outline is a piece of stock, with the defects, zones and
directions that lie on it.  JSON: pieces of stock with defects and zones, in the form in which nesting instances are
published (`pipeline.stockjson`), or the remnants of an earlier job.

A row keeps its own id if the file holds one piece, else it is `<id>-<number or id of the piece>`.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from itertools import permutations
from math import atan2, degrees
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, TypeVar

from msgspec.structs import replace

from pipeline.decode import ResolveError
from pipeline.stocktables import LayersTable, StockTable, ZoneTable
from stages.model.curves import CurveSpec
from stages.model.scalars import Angle

if TYPE_CHECKING:
    from pipeline.drawings import Piece
    from stages.geometry.paths.arcpath import ArcPath

T = TypeVar("T")

HALF_TURN, QUARTER_TURN = 180.0, 90.0
ONE_WAY_DEG = 0.5
"""Lines that tell one direction may differ by so much: they are drawn by hand."""


def plain_row(row: StockTable, stem: str) -> StockTable:
    """Return a row without what only said how its file is read."""
    return replace(row, id=row.id or stem, file=None, layers=None, entry=None)


def stem_of(name: str) -> str:
    """Return the name of a file without folder and ending."""
    return FilePath(name).stem or name


@dataclass(frozen=True, slots=True)
class Drawn:
    """What a drawing of stock holds: outlines, what lies on them, and their directions along the grain in degrees."""

    outlines: "tuple[Piece, ...]"
    defects: tuple[CurveSpec, ...]
    zones: tuple[ZoneTable, ...]
    grain: tuple[tuple[tuple[float, float], float], ...]


def rows_of_drawing(row: StockTable, curves: "Mapping[str, Sequence[Piece]]") -> tuple[StockTable, ...]:
    """Return the rows that a drawing stands for.  curves: of each layer that `used_layers` names."""
    drawn = _drawn(row.layers or LayersTable(), curves)
    blank = plain_row(row, stem_of(row.file or ""))
    count = len(drawn.outlines)
    rows = []
    for i, outline in enumerate(drawn.outlines, start=1):
        name = blank.id if count == 1 else f"{blank.id}-{i}"
        rows.append(_filled(replace(blank, id=name, outline=outline.spec()), drawn))
    _refuse_strays(rows, drawn)
    _refuse_holes(rows)
    return tuple(rows)


def used_layers(layers: LayersTable, present: Collection[str]) -> tuple[str, ...]:
    """Return those layers of a drawing that have a meaning; of the outline's the first that is there."""
    there = {name.casefold(): name for name in present}
    outline = [there[name.casefold()] for name in layers.outline if name.casefold() in there]
    if not outline:
        where = f"put it on {layers.outline[0]}, or say under layers = {{ outline = [...] }} where it is"
        hint = "; ".join(filter(None, [where, _alike(layers.outline, present)]))
        raise ResolveError("file", f"no layer {' or '.join(layers.outline)} holds an outline", hint)
    return outline[0], *(there[name.casefold()] for name in _lying(layers) if name.casefold() in there)


def missing_layers(layers: LayersTable, present: Collection[str]) -> str:
    """Return what to say of layers that a job names beside the usual ones and a drawing does not have; or nothing."""
    there, usual = {name.casefold() for name in present}, {*_lying(LayersTable())}
    missing = [name for name in _lying(layers) if name not in usual and name.casefold() not in there]
    said = [f"there is nothing on the layers {', '.join(missing)}", _alike(missing, present)]
    return "; ".join(filter(None, said)) if missing else ""


def _lying(layers: LayersTable) -> tuple[str, ...]:
    """Return the layers of what lies on stock."""
    return *layers.defects, *(zone.layer for zone in layers.zones), *layers.grain, *layers.stretch


def _alike(missing: Iterable[str], present: Iterable[str]) -> str:
    """Return a question for the layers whose names are like those of missing ones; nothing if there are none."""
    there = {name.casefold(): name for name in sorted(present)}
    near = [there[like] for name in missing for like in get_close_matches(name.casefold(), there, 1)]
    return f"did you mean {', '.join(near)}?" if near else ""


def _drawn(layers: LayersTable, curves: "Mapping[str, Sequence[Piece]]") -> Drawn:
    """Return what the curves mean."""
    by_layer = {name.casefold(): found for name, found in curves.items()}

    def on(names: Iterable[str]) -> "Iterator[tuple[str, Piece]]":
        return ((name, piece) for name in names for piece in by_layer.get(name.casefold(), ()))

    outline = next(name for name in layers.outline if name.casefold() in by_layer)
    quality = {zone.layer: zone.quality for zone in layers.zones}
    return Drawn(
        tuple(_closed(name, piece) for name, piece in on([outline])),
        tuple(_closed(name, piece).spec() for name, piece in on(layers.defects)),
        tuple(ZoneTable(outline=_closed(name, piece).spec(), quality=quality[name]) for name, piece in on(quality)),
        (
            *(_direction(name, piece, 0.0) for name, piece in on(layers.grain)),
            *(_direction(name, piece, QUARTER_TURN) for name, piece in on(layers.stretch)),
        ),
    )


def _closed(layer: str, piece: "Piece") -> "Piece":
    if piece.closed:
        return piece
    (x0, y0, _), (x1, y1, _) = piece.start, piece.end
    message = f"layer {layer}: the curve from ({x0:.6g}, {y0:.6g}) to ({x1:.6g}, {y1:.6g}) mm is open"
    raise ResolveError("file", message, "close the contour in the drawing")


def _direction(layer: str, piece: "Piece", turned_deg: float) -> tuple[tuple[float, float], float]:
    """Return the middle of a line and the direction that it tells, in degrees from 0 to 180."""
    (x0, y0, _), (x1, y1, _) = piece.start, piece.end
    if len(piece.links) != 1 or piece.links[0].line is None:
        raise ResolveError("file", f"layer {layer}: a direction is told by a single straight line", "draw a LINE")
    return ((x0 + x1) / 2.0, (y0 + y1) / 2.0), (degrees(atan2(y1 - y0, x1 - x0)) + turned_deg) % HALF_TURN


def _filled(row: StockTable, drawn: Drawn) -> StockTable:
    """Return a piece of stock with the defects, zones and the direction that lie on it."""
    defects = tuple(spec for spec in drawn.defects if _lies_on(row, spec))
    zones = tuple(zone for zone in drawn.zones if _lies_on(row, zone.outline))
    found = [angle for middle, angle in drawn.grain if _holds(row, middle)]
    for angle in found:
        if abs((angle - found[0] + QUARTER_TURN) % HALF_TURN - QUARTER_TURN) > ONE_WAY_DEG:
            message = f"two directions on one piece of stock: {found[0]:.6g} and {angle:.6g} deg"
            raise ResolveError("file", message, "leave one line, or give grain under [[stock]]")
    grain = row.grain if row.grain is not None or not found else Angle(repr(found[0]))
    return replace(row, defects=(*row.defects, *defects), zones=(*row.zones, *zones), grain=grain)


def _refuse_strays(rows: Sequence[StockTable], drawn: Drawn) -> None:
    """Refuse defects and zones that lie on no piece of stock: they would be lost."""
    for spec in (*drawn.defects, *(zone.outline for zone in drawn.zones)):
        if not any(_lies_on(row, spec) for row in rows):
            raise ResolveError("file", "a defect or a zone lies outside every outline", "move it, or remove it")
    for (x, y), _ in drawn.grain:
        if not any(_holds(row, (x, y)) for row in rows):
            message = f"the line of direction about ({x:.6g}, {y:.6g}) mm lies outside every outline"
            raise ResolveError("file", message, "move it onto its hide")


def _refuse_holes(rows: Sequence[StockTable]) -> None:
    """Refuse an outline that lies within another: taken for a piece of stock, parts would lie on it and around it."""
    from pipeline.stockshapes import CHORD_MM
    from stages.geometry.paths.arcpath import bounds
    from stages.geometry.paths.usable import within

    paths = [_outline(row) for row in rows] if len(rows) > 1 else []
    boxes = [bounds(path) for path in paths]
    for (i, inner), (j, outer) in permutations(enumerate(boxes), 2):
        around = outer[0] < inner[0] and outer[1] < inner[1] and inner[2] < outer[2] and inner[3] < outer[3]
        if around and within(paths[i], paths[j], accuracy=CHORD_MM):
            message = f"the outline {rows[i].id} lies within {rows[j].id}: a hole is no piece of stock"
            raise ResolveError("file", message, "put holes on the layer of the defects, such as SHEET_KEEPOUT")


def _lies_on(row: StockTable, spec: CurveSpec) -> bool:
    """Return whether a defect or a zone has a point in common with a piece of stock."""
    from pipeline.stockshapes import CHORD_MM, blocked
    from stages.geometry.paths.usable import touch

    outline = _outline(row)
    return any(touch(outline, path, accuracy=CHORD_MM) for path in _shape(blocked, spec).paths)


def _holds(row: StockTable, point: tuple[float, float]) -> bool:
    """Return whether a point lies on a piece of stock."""
    import numpy as np

    from pipeline.stockshapes import CHORD_MM
    from stages.geometry.paths.usable import holds

    return holds(_outline(row), np.array(point), accuracy=CHORD_MM)


def _outline(row: StockTable) -> "ArcPath":
    """Return the outline of a piece of stock."""
    from pipeline.stockshapes import kept

    if row.outline is None:
        raise ValueError("a piece of stock from a drawing has an outline")
    return _shape(kept, row.outline).path


def _shape(make: Callable[[CurveSpec], T], spec: CurveSpec) -> T:
    """Return the shape of a curve of the file; one that encloses nothing is the file's fault."""
    from stages.construct.stockoutline import NoContourError

    try:
        return make(spec)
    except NoContourError as error:
        raise ResolveError("file", error.message, error.hint) from None
