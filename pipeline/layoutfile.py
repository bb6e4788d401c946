"""The file of a layout, as it is read: every sheet with what lies on it, and everything that is wrong with its form.

`layout.json`, schema planish-layout/1, is written by every nested job; a `report.json` is read too, by its
`nest.sheets`.  Numbers become the doubles that they are the shortest decimals of, so that they come back bit by bit.
What the file says is held against a job in `pipeline.layouts`.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from hashlib import sha256
from math import inf
from pathlib import Path as FilePath

from pipeline.decode import Complaint, suggestion
from pipeline.parse import parse, read_bytes, refuse_huge, text_of
from pipeline.paths import Path
from pipeline.placed import placed
from pipeline.units import describe
from stages.errors import Problem
from stages.geometry.curves.rigid import Rigid2
from stages.model.caps import MOST_COPIES

SCHEMA = "planish-layout/1"
REPORTS = "planish-report/"

SHEET_KEYS = ("stock", "index", "placements")
PLACEMENT_KEYS = ("part", "copy", "x", "y", "angle", "mirrored", "fixed")
MOTION_KEYS = ("x", "y", "angle")
MOST_LAID = 20 * MOST_COPIES
"""Values of a layout: each copy takes eight, and a report tells more of it."""
MOST_MM = 1e9
"""No sheet is as large, and on none as far from the origin the last digit of a coordinate is less than 1e-7 mm."""


@dataclass(frozen=True, slots=True)
class Row:
    """One placed copy as the file says it, and where it says it."""

    part: str
    copy: int
    motion: Rigid2
    fixed: bool
    path: Path


@dataclass(frozen=True, slots=True)
class SheetRows:
    """One sheet as the file says it: `index` counts from 1 within its stock."""

    stock: str
    index: int
    rows: tuple[Row, ...]
    path: Path


@dataclass(frozen=True, slots=True)
class LayoutFile:
    """A layout file: its sheets as far as their form is right, what is wrong with the rest, and who made it.

    engine: name, version and seed of what placed the copies, as the file tells them; None: it does not.
    """

    file: FilePath
    text: str
    sheets: tuple[SheetRows, ...]
    complaints: tuple[Complaint, ...]
    engine: Mapping[str, object] | None
    digest: str

    def problems(self, complaints: Sequence[Complaint]) -> list[Problem]:
        """Return complaints as problems, each with its line and column, in the order of the file."""
        return placed(complaints, self.text, self.file)


def read_layout(file: FilePath) -> LayoutFile:
    """Return a layout file; `BadInputError` if it cannot be read at all."""
    return layout_of(read_bytes(file), file)


def layout_of(content: bytes, file: FilePath) -> LayoutFile:
    """Return a layout file of these bytes; `BadInputError` if they cannot be read at all."""
    text = text_of(content, file)
    raw = parse(text, file)
    refuse_huge(raw, file, MOST_LAID)
    reading = Reading()
    sheets, engine = _document(reading, raw)
    return LayoutFile(file, text, sheets, tuple(reading.complaints), engine, sha256(content).hexdigest())


@dataclass(slots=True)
class Reading:
    """What is wrong so far."""

    complaints: list[Complaint] = field(default_factory=list)

    def complain(self, path: Path, message: str, hint: str = "") -> None:
        """Note something wrong."""
        self.complaints.append(Complaint(path, message, hint))

    def tables(self, raw: object, path: Path) -> Iterator[tuple[Path, Mapping[str, object]]]:
        """Yield the tables of an array with their paths."""
        if not isinstance(raw, list):
            self.complain(path, f"{describe(raw)} where an array belongs", "write [ ... ]")
            return
        for number, item in enumerate(raw):
            if isinstance(item, Mapping):
                yield (*path, number), item
            else:
                self.complain((*path, number), f"{describe(item)} where a table belongs", "write { ... }")

    def known(self, table: Mapping[str, object], path: Path, keys: Sequence[str]) -> None:
        """Note the keys that mean nothing."""
        for key in table:
            if key not in keys:
                self.complaints.append(Complaint((*path, key), "unknown key", suggestion(key, keys), "key"))

    def text(self, table: Mapping[str, object], key: str, path: Path) -> str | None:
        """Return a text, or None after noting that it is none."""
        value = table.get(key)
        if isinstance(value, str):
            return value
        self._wrong(table, key, path, "a text")
        return None

    def count(self, table: Mapping[str, object], key: str, path: Path) -> int | None:
        """Return a whole number from 1 on, or None after noting that it is none."""
        value = table.get(key)
        if isinstance(value, int) and not isinstance(value, bool) and int(value) >= 1:
            return int(value)
        self._wrong(table, key, path, "a whole number from 1 on")
        return None

    def number(self, table: Mapping[str, object], key: str, path: Path) -> float | None:
        """Return a finite number, or None after noting that it is none."""
        value = table.get(key)
        if isinstance(value, int | float | Decimal) and not isinstance(value, bool):
            number = _double(value)
            if abs(number) <= MOST_MM:
                return number
            self.complain((*path, key), f"{describe(value)} is not a number of this world", "write a finite one")
            return None
        self._wrong(table, key, path, "a number")
        return None

    def flag(self, table: Mapping[str, object], key: str, path: Path) -> bool:
        """Return a boolean, false if it is not there."""
        value = table.get(key, False)
        if not isinstance(value, bool):
            self._wrong(table, key, path, "true or false")
        return value is True

    def _wrong(self, table: Mapping[str, object], key: str, path: Path, wanted: str) -> None:
        read = f"{describe(table[key])} where {wanted} belongs" if key in table else "missing"
        self.complain((*path, key), read, "" if key in table else f"{wanted} is needed")


def _double(value: int | float | Decimal) -> float:
    """Return the nearest double; infinite where there is none."""
    try:
        return float(value)
    except OverflowError:
        return inf


def _document(reading: Reading, raw: Mapping[str, object]) -> tuple[tuple[SheetRows, ...], Mapping[str, object] | None]:
    """Return the sheets of a layout or of a report, and who made them."""
    schema = raw.get("schema")
    if isinstance(schema, str) and schema.startswith(REPORTS):
        nest = raw.get("nest")
        listed = nest.get("sheets") if isinstance(nest, Mapping) else None
        return _sheets(reading, listed, ("nest", "sheets"), strict=False), _engine_of_report(raw, nest)
    if schema != SCHEMA:
        hint = f'a layout.json says "{SCHEMA}", a report.json "{REPORTS}1"'
        reading.complain(("schema",), f"{describe(schema)} is no layout" if "schema" in raw else "missing", hint)
        return (), None
    reading.known(raw, (), ("schema", "job", "engine", "sheets"))
    engine = raw.get("engine")
    return _sheets(reading, raw.get("sheets"), ("sheets",), strict=True), engine if isinstance(engine, dict) else None


def _engine_of_report(raw: Mapping[str, object], nest: object) -> Mapping[str, object] | None:
    """Return what a report says of who placed the copies."""
    engine = nest.get("engine") if isinstance(nest, Mapping) else None
    return engine if isinstance(engine, dict) else None


def _sheets(reading: Reading, raw: object, path: Path, *, strict: bool) -> tuple[SheetRows, ...]:
    """Return the sheets; strict: keys that mean nothing are errors."""
    sheets = []
    for where, table in reading.tables(raw, path):
        if strict:
            reading.known(table, where, SHEET_KEYS)
        stock, index = reading.text(table, "stock", where), reading.count(table, "index", where)
        inside = reading.tables(table.get("placements"), (*where, "placements"))
        rows = [_row(reading, one, place, strict=strict) for place, one in inside]
        if stock is not None and index is not None:
            sheets.append(SheetRows(stock, index, tuple(row for row in rows if row is not None), where))
    return tuple(sheets)


def _row(reading: Reading, table: Mapping[str, object], path: Path, *, strict: bool) -> Row | None:
    """Return one placed copy, or None if it cannot be told which."""
    if strict:
        reading.known(table, path, PLACEMENT_KEYS)
    part, copy = reading.text(table, "part", path), reading.count(table, "copy", path)
    x, y, angle = (reading.number(table, key, path) for key in MOTION_KEYS)
    mirrored, fixed = reading.flag(table, "mirrored", path), reading.flag(table, "fixed", path)
    if part is None or copy is None:
        return None
    # where a number is wrong the file is refused, and any place lets the rest of the row be judged
    motion = Rigid2() if x is None or y is None or angle is None else Rigid2(x, y, angle, mirrored)
    return Row(part, copy, motion, fixed, path)
