"""One row of a sheet of measurements after the other: what it says, and everything that is wrong with it.

Numbers stay exact fractions, of at most 30 digits before and after the point: what would fill the memory is no number.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from fractions import Fraction

from pipeline.asmade.nominal import Nominal
from pipeline.asmade.sizes import ISO, Dimension
from pipeline.units import MM_PER
from stages.errors import Problem

COLUMNS = (
    "part", "copy", "what", "nominal", "measured", "unit", "uncertainty", "tolerance", "tool", "x", "y", "z",
)  # fmt: skip
LENGTHS = ("mm", "cm", "m", "in")
POINTS = tuple(f"point {face}" for face in ("plus", "minus", "given"))
FORMULA = ("=", "+", "-", "@", "\t", "\r")
NOMINAL_WITHIN = Fraction(1, 100)
"""How far the nominal value of a sheet may be from the job's, mm or deg: a spreadsheet that shows two decimals."""
LARGEST = Fraction(10) ** 7
"""No part is larger, mm: 10 km."""
LONGEST_SHOWN = 40

_NUMBER = re.compile(r"[+-]?(?:\d{1,30}\.?\d{0,30}|\.\d{1,30})(?:[eE][+-]?\d{1,2})?", re.ASCII)
_COMMA = re.compile(r"[+-]?\d+,\d+", re.ASCII)


@dataclass(frozen=True, slots=True)
class Reading:
    """One measured dimension, in mm or degrees.

    uncertainty: expanded, at 95 %.  text: as it was read, for slips of the keyboard.
    tolerance: None: none is known.  by: who said the tolerance.
    """

    line: int
    copy: int
    of: Dimension
    measured: Fraction
    uncertainty: Fraction
    tolerance: Fraction | None
    by: str
    tool: Fraction | None
    text: str
    per_unit: Fraction


@dataclass(frozen=True, slots=True)
class PointReading:
    """One measured point, mm."""

    line: int
    copy: int
    part: str
    face: str
    at: tuple[float, float, float]
    uncertainty: Fraction
    tolerance: Fraction | None


@dataclass(frozen=True, slots=True)
class Measured:
    """A sheet as it was read.  left: lines without a measurement."""

    readings: tuple[Reading, ...]
    points: tuple[PointReading, ...]
    left: int


class SheetReader:
    """Takes rows one by one, and keeps what they say and what is wrong with them."""

    def __init__(self, file: str, known: dict[tuple[str, str], Dimension], nominal: Nominal) -> None:
        self.file = file
        self.known = known
        self.nominal = nominal
        self.readings: list[Reading] = []
        self.points: list[PointReading] = []
        self.problems: list[Problem] = []
        self.left = 0
        self._seen: dict[tuple[str, int, str], int] = {}

    def row(self, line: int, header: Sequence[str], cells: Sequence[str]) -> None:
        """Take one row."""
        if len(cells) > len(header):
            more = [cell for cell in cells[len(header) :] if cell.strip()]
            if more:
                hint = (
                    "a decimal comma? write a decimal point"
                    if any(map(str.isdigit, "".join(more)))
                    else "quote texts with commas"
                )
                self._wrong(line, "", f"{len(cells)} cells, and {len(header)} columns", hint)
                return
        row = dict.fromkeys(COLUMNS, "") | {name: cell.strip() for name, cell in zip(header, cells, strict=False)}
        row |= {name: plain(row[name]) for name in ("part", "what")}
        values = ("x", "y", "z") if row["what"] in POINTS else ("measured",)
        if not any(row[name] for name in values):
            self.left += 1
            return
        if row["what"] in POINTS:
            self._point(line, row)
        else:
            self._dimension(line, row)

    def _wrong(self, line: int, column: str, message: str, hint: str) -> None:
        self.problems.append(Problem(message, column, hint, self.file, line))

    def _dimension(self, line: int, row: dict[str, str]) -> None:
        """Take a measured dimension."""
        before = len(self.problems)
        of = self._of(line, row)
        copy = self._copy(line, row)
        per = self._per_unit(line, row["unit"], "mm" if of is None else of.unit)
        measured = self._number(line, row, "measured", per)
        uncertainty = self._uncertainty(line, row, per)
        tolerance = self._number(line, row, "tolerance", per, least=Fraction(0)) if row["tolerance"] else None
        tool = self._number(line, row, "tool", per, least=Fraction(0)) if row["tool"] else None
        given = self._number(line, row, "nominal", Fraction(1)) if row["nominal"] else None
        if of is None or len(self.problems) > before or measured is None or uncertainty is None:
            return
        self._same_run(line, of, given, per)
        if measured <= 0:
            self._wrong(line, "measured", f"{shown(row['measured'])} is not above 0", "sizes and angles are positive")
        self._once(line, (of.part, copy, of.what))
        limit, by = (tolerance, "sheet") if tolerance is not None else (_limit(of), ISO)
        bent_to = tool if tool is not None or of.tool is None else exact(of.tool)
        reading = Reading(line, copy, of, measured, uncertainty, limit, by, bent_to, row["measured"], per)
        self.readings.append(reading)

    def _point(self, line: int, row: dict[str, str]) -> None:
        """Take a measured point."""
        before = len(self.problems)
        if row["part"] not in self.nominal.parts:
            self._unknown_part(line, row["part"])
        copy = self._copy(line, row)
        per = self._per_unit(line, row["unit"], "mm")
        at = [self._number(line, row, name, per) for name in "xyz"]
        uncertainty = self._uncertainty(line, row, per)
        tolerance = self._number(line, row, "tolerance", per, least=Fraction(0)) if row["tolerance"] else None
        if row["measured"]:
            self._wrong(line, "measured", "a point has x, y and z, and no reading", "leave it empty")
        if len(self.problems) > before or uncertainty is None:
            return
        _, face = row["what"].split()
        x, y, z = (float(value or 0) for value in at)
        self.points.append(PointReading(line, copy, row["part"], face, (x, y, z), uncertainty, tolerance))

    # Cells

    def _of(self, line: int, row: dict[str, str]) -> Dimension | None:
        """Return what was measured; None, and a problem, if the job has no such thing."""
        found = self.known.get((row["part"], row["what"]))
        if found is None and row["part"] not in self.nominal.parts:
            self._unknown_part(line, row["part"])
        elif found is None:
            there = [what for part, what in self.known if part == row["part"]]
            near = get_close_matches(row["what"], [*there, *POINTS], 1)
            hint = f'did you mean "{near[0]}"?' if near else f"it has: {', '.join(there)}; or {', '.join(POINTS)}"
            self._wrong(line, "what", f"{shown(row['what'])} cannot be measured of {shown(row['part'])}", hint)
        return found

    def _unknown_part(self, line: int, name: str) -> None:
        near = get_close_matches(name, self.nominal.parts, 1)
        hint = f'did you mean "{near[0]}"?' if near else "the empty sheet of this job names its parts"
        self._wrong(line, "part", f"{shown(name)} is no part of this job", hint)

    def _copy(self, line: int, row: dict[str, str]) -> int:
        text = row["copy"] or "1"
        if not re.fullmatch(r"[1-9]\d{0,5}", text, re.ASCII):
            self._wrong(line, "copy", f"{shown(text)} is no copy", "1, 2, 3, ...")
            return 1
        return int(text)

    def _per_unit(self, line: int, unit: str, of: str) -> Fraction:
        allowed = ("deg",) if of == "deg" else LENGTHS
        if unit not in allowed:
            message = "the unit is missing" if not unit else f"{shown(unit)} is no unit of this"
            self._wrong(line, "unit", message, " | ".join(allowed))
        return MM_PER.get(unit, Fraction(1))

    def _uncertainty(self, line: int, row: dict[str, str], per: Fraction) -> Fraction | None:
        if not row["uncertainty"]:
            hint = "the instrument's, at 95 %: a caliper's is some 0.05 mm, a steel tape's 0.5 mm"
            self._wrong(line, "uncertainty", "the uncertainty is missing", hint)
            return None
        found = self._number(line, row, "uncertainty", per, least=Fraction(0))
        if found == 0:
            self._wrong(line, "uncertainty", "no instrument measures without error", "give what it may be off, at 95 %")
        return found

    def _number(
        self, line: int, row: dict[str, str], column: str, per: Fraction, least: Fraction | None = None
    ) -> Fraction | None:
        """Return a cell in mm or degrees; None, and a problem, if it is no such number."""
        text = row[column]
        if not _NUMBER.fullmatch(text):
            comma = _COMMA.fullmatch(text) is not None
            message = "it is missing" if not text else f"{shown(text)} is no number"
            self._wrong(
                line, column, message, "write a decimal point, not a comma" if comma else "a decimal such as 12.5"
            )
            return None
        value = Fraction(text) * per
        if abs(value) > LARGEST or (least is not None and value < least):
            limits = f"at most {float(LARGEST):g} mm" if least is None else f"from {float(least):g} on"
            self._wrong(line, column, f"{shown(text)} is out of range", limits)
            return None
        return value

    def _same_run(self, line: int, of: Dimension, given: Fraction | None, per: Fraction) -> None:
        """Refuse a nominal value that is not the job's, in mm or in the unit of the line."""
        nominal = exact(of.nominal)
        if given is not None and min(abs(given - nominal), abs(given * per - nominal)) > NOMINAL_WITHIN:
            message = f"{float(given):.6g} is not that of this job, {of.nominal:.6g} {of.unit}"
            self._wrong(line, "nominal", message, "the sheet is that of another run: write a new one with --template")

    def _once(self, line: int, key: tuple[str, int, str]) -> None:
        """Refuse a second reading of the same thing."""
        first = self._seen.setdefault(key, line)
        if first != line:
            part, copy, what = key
            message = f"{what} of {shown(part)}, copy {copy}, is on line {first} already"
            self._wrong(line, "what", message, "number the copies, or keep one reading")


def exact(value: float) -> Fraction:
    """Return a number as its shortest decimals say it."""
    return Fraction(repr(value))


def _limit(of: Dimension) -> Fraction | None:
    return None if of.tolerance is None else Fraction(of.tolerance).limit_denominator(1200)


def plain(text: str) -> str:
    """Return a text without the apostrophe that made it harmless."""
    return text[1:] if text.startswith("'") and text[1:].startswith(FORMULA) else text


def shown(cell: str) -> str:
    """Return a cell as a message shows it: quoted, without control characters, not too long."""
    short = cell if len(cell) <= LONGEST_SHOWN else f"{cell[:LONGEST_SHOWN]}..."
    return '"' + "".join(letter if letter.isprintable() else "?" for letter in short) + '"'
