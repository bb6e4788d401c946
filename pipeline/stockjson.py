"""Stock from JSON files: pieces in the form in which nesting instances are published, and remnants of earlier jobs.

An instance [1]_ has `bins`, each with `id`, `shape`, `zones` (`quality`, `shape`), `stock` (how many) and `cost`; a
shape is `{"type": "simple_polygon", "data": [[x, y], ...]}` or `{"type": "polygon", "data": {"outer": [...], "inner":
[[...], ...]}}`, inner rings being holes.  Lengths are in the units of the job.  What else it holds says nothing of the
stock and is not looked at.

Remnants: `{"schema": "planish-remnant/1", "remnants": [{"id", "width_mm", "height_mm", "material", "thickness_mm",
"grain_deg", "from"}]}`, rectangles in mm.

.. [1] J. Gardeyn, G. Vanden Berghe, T. Wauters, arXiv:2509.13329, 2025: the external form of jagua-rs.
"""

import json
from collections.abc import Callable, Mapping, Sequence
from decimal import Decimal
from itertools import pairwise
from typing import TypeVar

from msgspec.structs import replace

from pipeline.decode import ResolveError, suggestion
from pipeline.stocktables import MOST_SHEETS, StockTable, ZoneTable
from pipeline.units import UnreadableError, coordinate_of, describe, quantity
from stages.model.curves import CurveSpec, PlanePoint
from stages.model.scalars import Angle, Length, Number

REMNANTS = "planish-remnant/1"
LEAST_POINTS = 3

Entry = Mapping[str, object]
Quantity = TypeVar("Quantity", Length, Number, Angle)


def rows_of_json(row: StockTable, blank: StockTable, content: bytes, unit: str) -> tuple[StockTable, ...]:
    """Return the rows that a JSON file stands for.

    row: as the job file has it.  blank: the same without file, its id the name of the file if the row has none.
    """
    document = _document(content)
    entries, make = _pieces(document)
    names = [str(entry.get("id", number)) for number, entry in enumerate(entries)]
    chosen = range(len(entries)) if row.entry is None else [_chosen(row.entry, names)]
    return tuple(
        make(replace(blank, id=_name(row, blank, names[i], single=len(chosen) == 1)), entries[i], unit) for i in chosen
    )


Make = Callable[[StockTable, Entry, str], StockTable]


def _pieces(document: Entry) -> tuple[list[Entry], Make]:
    """Return the pieces of stock that a file describes, and how each becomes a row."""
    if document.get("schema") == REMNANTS:
        return _entries(document, "remnants"), _remnant
    if "bins" in document:
        return _entries(document, "bins"), _bin
    raise ResolveError("file", "the JSON file holds no stock", f'"bins", or "schema": "{REMNANTS}"')


def _document(content: bytes) -> Entry:
    try:
        document = json.loads(content, parse_float=Decimal)
    except (ValueError, RecursionError) as error:
        raise ResolveError("file", f"this is no JSON that can be read: {error}", "") from None
    if not isinstance(document, dict):
        raise ResolveError("file", f"{describe(document)} where the stock belongs", "an object")
    return document


def _entries(document: Entry, key: str) -> list[Entry]:
    found = document.get(key)
    if not isinstance(found, list) or not found or not all(isinstance(entry, dict) for entry in found):
        raise ResolveError("file", f"{key}: {describe(found)} where objects belong", "at least one")
    return found


def _chosen(entry: str | int, names: Sequence[str]) -> int:
    """Return the number of the piece that is asked for by its id."""
    if str(entry) not in names:
        raise ResolveError("entry", f"there is no {describe(entry)} in the file", suggestion(str(entry), names))
    return names.index(str(entry))


def _name(row: StockTable, blank: StockTable, name: str, *, single: bool) -> str:
    """Return the id of a row: its own for a single piece; remnants keep theirs."""
    if row.id is None and not name.isdecimal():
        return name
    return str(blank.id) if single and row.id is not None else f"{blank.id}-{name}"


def _remnant(blank: StockTable, entry: Entry, _: str) -> StockTable:
    """Return the row of a remnant, a rectangle in mm."""
    where = f"remnant {blank.id}"
    thickness, grain = entry.get("thickness_mm"), entry.get("grain_deg")
    material = entry.get("material")
    return replace(
        blank,
        kind="remnant",
        width=_positive(Length, entry.get("width_mm"), "mm", f"{where}: width_mm"),
        height=_positive(Length, entry.get("height_mm"), "mm", f"{where}: height_mm"),
        material=blank.material or (str(material) if material else None),
        thickness=None if thickness is None else _positive(Length, thickness, "mm", f"{where}: thickness_mm"),
        grain=blank.grain if blank.grain is not None or grain is None else _quantity(Angle, grain, "mm", where),
    )


def _bin(blank: StockTable, entry: Entry, unit: str) -> StockTable:
    """Return the row of a piece of an instance."""
    where = f"bin {entry.get('id', blank.id)}"
    outer, inner = _shape(entry.get("shape"), f"{where}: shape", unit)
    zones = [_zone(zone, f"{where}: zones[{i}]", unit) for i, zone in enumerate(_listed(entry, "zones", where))]
    cost, count = entry.get("cost"), entry.get("stock", 1)
    if not isinstance(count, int) or isinstance(count, bool) or not 1 <= count <= MOST_SHEETS:
        raise ResolveError("file", f"{where}: stock is {describe(count)}", f"a whole number from 1 to {MOST_SHEETS}")
    return replace(
        blank,
        outline=outer,
        defects=(*blank.defects, *inner),
        zones=(*blank.zones, *zones),
        quantity=blank.quantity or count,
        price=blank.price if blank.price is not None or cost is None else _quantity(Number, cost, unit, where),
    )


def _zone(zone: object, where: str, unit: str) -> ZoneTable:
    """Return a zone; a hole in it is not looked at: what it encloses is no better."""
    if not isinstance(zone, dict):
        raise ResolveError("file", f"{where}: {describe(zone)} where a zone belongs", "an object")
    quality = zone.get("quality")
    if not isinstance(quality, int) or isinstance(quality, bool):
        raise ResolveError("file", f"{where}: quality is {describe(quality)}", "a whole number is needed")
    outer, _ = _shape(zone.get("shape"), f"{where}: shape", unit)
    return ZoneTable(outline=outer, quality=quality)


def _shape(shape: object, where: str, unit: str) -> tuple[CurveSpec, tuple[CurveSpec, ...]]:
    """Return the outline and the holes of a shape."""
    sort = shape.get("type") if isinstance(shape, dict) else None
    data = shape.get("data") if isinstance(shape, dict) else None
    if sort == "simple_polygon":
        return _ring(data, where, unit), ()
    if sort == "polygon" and isinstance(data, dict):
        holes = enumerate(_listed(data, "inner", where))
        return _ring(data.get("outer"), where, unit), tuple(
            _ring(hole, f"{where}: inner[{i}]", unit) for i, hole in holes
        )
    hint = '"simple_polygon" with points, or "polygon" with outer and inner'
    raise ResolveError("file", f"{where}: a shape of type {describe(sort)}", hint)


def _listed(entry: Entry, key: str, where: str) -> list[object]:
    found = entry.get(key) or []
    if not isinstance(found, list):
        raise ResolveError("file", f"{where}: {key} is {describe(found)}", "an array is needed")
    return found


def _ring(data: object, where: str, unit: str) -> CurveSpec:
    """Return a closed polyline; points that repeat the one before say nothing and are left out."""
    if not isinstance(data, list) or len(data) < LEAST_POINTS:
        raise ResolveError("file", f"{where}: {describe(data)} where points belong", "at least three, each [x, y]")
    points = [_point(point, f"{where}: point {i}", unit) for i, point in enumerate(data)]
    kept = [points[0], *(b for a, b in pairwise(points) if a != b)]
    closed = kept if kept[0] == kept[-1] else [*kept, kept[0]]
    if len(closed) <= LEAST_POINTS:
        raise ResolveError("file", f"{where}: the points enclose no area", "give at least three different ones")
    return CurveSpec(polyline=tuple(closed))


def _point(point: object, where: str, unit: str) -> PlanePoint:
    if not isinstance(point, list) or len(point) != len("xy"):
        raise ResolveError("file", f"{where} is {describe(point)}", "[x, y] is needed")
    return _read(lambda: (coordinate_of(point[0], unit), coordinate_of(point[1], unit)), where)


def _positive(sort: type[Quantity], value: object, unit: str, where: str) -> Quantity:
    found = _quantity(sort, value, unit, where)
    if found <= 0:
        raise ResolveError("file", f"{where} is {float(found):g}", "must be above 0")
    return found


def _quantity(sort: type[Quantity], value: object, unit: str, where: str) -> Quantity:
    return _read(lambda: quantity(sort, value, unit), where)


T = TypeVar("T")


def _read(make: Callable[[], T], where: str) -> T:
    try:
        return make()
    except UnreadableError as error:
        raise ResolveError("file", f"{where}: {error.message}", error.hint) from None
