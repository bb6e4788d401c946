"""The sheet of measurements: an empty one to fill in, and a filled one read strictly, every error at once.

Comma-separated, UTF-8, one measurement a line, these columns, by name and in any order:

    part, what      as in the empty sheet
    copy            which copy was measured: 1, 2, ...; empty: 1
    nominal         as in the empty sheet, or empty; a sheet of another run is told by it
    measured        the reading, a decimal point; empty: not measured
    unit            mm, cm, m or in; deg for angles
    uncertainty     of the instrument, +-, at 95 %, in that unit: a caliper's 0.05 mm, a steel tape's 0.5 mm
    tolerance       +-, in that unit; empty: ISO 2768-1 m
    tool            inside radius of the tool that a radius was bent to, in that unit; empty: that of the roll schedule
    x, y, z         of a point on the formed part instead of `measured`

Only the first two and `measured`, `unit`, `uncertainty` are required of a sheet.  `what` of a point says where the
probe touched: `point plus` or `point minus`, the face on that side; `point given`, the surface as the job gives it.
The frame is the part's own; any other, the same for all points of a copy, where a best fit is asked for.

Text that a spreadsheet would take for a formula is written behind an apostrophe, and read without it.
"""

import csv
import io
from collections.abc import Iterator, Sequence
from difflib import get_close_matches
from fractions import Fraction
from pathlib import Path

from pipeline.asmade.nominal import Nominal
from pipeline.asmade.rows import COLUMNS, FORMULA, POINTS, Measured, SheetReader, exact, shown
from pipeline.asmade.sizes import length_tolerance
from stages.errors import BadInputError, Problem

REQUIRED = frozenset({"part", "what", "measured", "unit", "uncertainty"})
LARGEST_SHEET = 50_000_000
"""Bytes; a sheet of a million points takes less."""
# The empty sheet


def template(nominal: Nominal) -> str:
    """Return an empty sheet for a job: a line for everything that can be measured, and one to copy for points."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\r\n")
    writer.writerow(COLUMNS)
    for part in nominal.parts:
        for one in (one for one in nominal.dimensions if one.part == part):
            writer.writerow((harmless(part), 1, harmless(one.what), decimal(one.nominal), "", one.unit, *[""] * 6))
        if part in nominal.ruled:
            writer.writerow((harmless(part), 1, POINTS[0], "", "", "mm", *[""] * 6))
    return stream.getvalue()


def decimal(value: float) -> str:
    """Return a number in decimals without an exponent and without needless zeros."""
    return f"{value:.6f}".rstrip("0").rstrip(".")


def harmless(text: str) -> str:
    """Return a text that no spreadsheet takes for a formula."""
    return f"'{text}" if text.startswith(FORMULA) else text


# A filled one


def read_sheet(file: Path, nominal: Nominal) -> Measured:
    """Return what was measured; `BadInputError` with everything that stands against it."""
    reader = SheetReader(str(file), {(one.part, one.what): one for one in nominal.dimensions}, nominal)
    rows = _rows(file)
    header = [cell.strip().casefold() for cell in rows[0][1]]
    problems = [*_header_problems(header, str(file), rows[0][0])]
    if problems:
        raise BadInputError(*problems)
    for line, cells in rows[1:]:
        if any(cell.strip() for cell in cells):
            reader.row(line, header, cells)
    if not reader.readings and not reader.points and not reader.problems:
        reader.problems.append(Problem("nothing is measured", "measured", "fill in some lines", str(file)))
    if reader.problems:
        raise BadInputError(*reader.problems)
    return Measured(tuple(reader.readings), tuple(reader.points), reader.left)


def _rows(file: Path) -> list[tuple[int, list[str]]]:
    """Return the rows with the numbers of their lines; `BadInputError` for what is no text of rows."""
    try:
        content = file.read_bytes()
    except OSError as error:
        hint = "planish compare --template OUT writes an empty sheet"
        raise BadInputError(Problem(f"cannot be read: {error.strerror}", hint=hint, file=str(file))) from None
    if len(content) > LARGEST_SHEET:
        raise BadInputError(
            Problem(f"{len(content)} bytes", hint=f"at most {LARGEST_SHEET}; divide it", file=str(file))
        )
    try:
        reader = csv.reader(io.StringIO(content.decode("utf-8-sig"), newline=""), strict=True)
        rows = []
        begins = 1
        for row in reader:
            rows.append((begins, row))
            begins = reader.line_num + 1
    except UnicodeDecodeError:
        raise BadInputError(Problem("is not UTF-8", hint="save it as CSV UTF-8", file=str(file))) from None
    except csv.Error as error:
        message = f"is no table of commas: {error}"
        hint = "close every quotation mark"
        raise BadInputError(Problem(message, hint=hint, file=str(file), line=begins)) from None
    if not rows:
        raise BadInputError(Problem("is empty", hint="planish compare --template OUT writes a sheet", file=str(file)))
    return rows


def _header_problems(header: Sequence[str], file: str, line: int) -> Iterator[Problem]:
    """Yield columns that are missing, unknown or there twice."""
    if len(header) == 1 and ";" in header[0]:
        yield Problem(
            "its columns are parted by semicolons", hint="save it with commas and decimal points", file=file, line=line
        )
        return
    for name in sorted(REQUIRED - set(header)):
        yield Problem(
            "the column is missing", name, f"the first line names the columns: {', '.join(COLUMNS)}", file, line
        )
    for number, name in enumerate(header):
        if name not in COLUMNS:
            near = get_close_matches(name, COLUMNS, 1)
            hint = f'did you mean "{near[0]}"?' if near else f"known columns: {', '.join(COLUMNS)}"
            yield Problem(f"{shown(name)} is no column", f"column {number + 1}", hint, file, line)
        elif name in header[:number]:
            yield Problem("the column is there twice", name, "keep one", file, line)


def point_tolerance(nominal: Nominal, part: str) -> Fraction | None:
    """Return the general tolerance of a part's largest size: what its points are held to if the sheet says nothing."""
    largest = max((one.nominal for one in nominal.dimensions if one.part == part and one.unit == "mm"), default=0.0)
    found = length_tolerance(largest)
    return None if found is None else exact(found)
