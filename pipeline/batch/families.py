"""A family of jobs: one job file as a template, and a table of values whose every row makes a job of it.

The first row of the table holds paths as `--set` takes them (`part[0].surface.k0`), and `id` over the column that
names the jobs, if there is one.  An empty cell leaves the template as it is.  The table is CSV in UTF-8, with a mark
of that at its begin or without; between its cells are commas, semicolons or tabs, whichever make paths of the first
row; cells stand in quotes where they hold these, quotes or ends of lines.  Rows stream: a table may have millions.
In messages they are counted as spreadsheets do: the first row, that of the paths, is row 1.
"""

import codecs
import csv
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from pipeline.batch.entries import DIGITS, JOB_ENDS, Entries, Entry, Source, capped, job_id, read_some
from pipeline.batch.identity import content
from pipeline.parse import setting_of
from pipeline.paths import parsed
from pipeline.store import safe_name
from stages.errors import BadInputError, Problem

ID = "id"
MOST_COLUMNS = 1000
MOST_LINES = 1000
"""Of one row; a quote that is not closed ends its row here."""
BETWEEN = ",;\t"
"""What may stand between cells: spreadsheets write semicolons where the comma is in numbers."""
AROUND = b" \r\n"
"""What is no part of a row at its ends; a tab may be the end of an empty cell."""
LINE_END = b"\n"
WIDE = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
AS_UTF8 = "save it as CSV in UTF-8"


@dataclass(frozen=True, slots=True)
class Table:
    """A table of values and the template that they are put into.

    columns: the first row.  between: what stands between cells.  own: bytes of the template.  shared: the digests of
    what all rows share, the template and the first row.
    """

    file: Path
    template: Path
    columns: tuple[str, ...]
    between: str
    own: bytes
    shared: bytes

    @property
    def source(self) -> Source:
        """Return where its jobs come from."""
        return Source("table", str(self.file.absolute()), str(self.template.absolute()))


def table_of(file: Path, template: Path) -> Table:
    """Return a table; `BadInputError` where a file is not there, or the first row is not one of paths."""
    wrong = [Problem("no such file", file=str(path)) for path in (file, template) if not path.is_file()]
    if template.suffix.lower() not in JOB_ENDS:
        wrong.append(Problem("a template is one job file, TOML or JSON", file=str(template)))
    if wrong:
        raise BadInputError(*wrong)
    with file.open("rb") as stream:
        head, _ = next(_records(stream, BETWEEN), (b"", 0))
    try:
        between, columns = _parted(head)
    except ValueError as error:
        raise BadInputError(Problem(f"the first row cannot be read: {error}", file=str(file), line=1)) from None
    problems = [Problem(message, hint=hint, file=str(file), line=1) for message, hint in _head_troubles(columns)]
    if problems:
        raise BadInputError(*problems)
    own = read_some(template) or b""
    return Table(file, template, columns, between, own, content(own) + content(head))


def _parted(head: bytes) -> tuple[str, tuple[str, ...]]:
    """Return what stands between the cells of a first row, and these; `ValueError` saying why it is none."""
    if head.startswith(WIDE):
        raise ValueError(f"it is UTF-16 text; {AS_UTF8}")
    try:
        text = head.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError(f"it is not UTF-8 text; {AS_UTF8}") from None
    ways = [(between, tuple(cell.strip() for cell in _cells(text, between))) for between in BETWEEN]
    return max(ways, key=lambda way: (not any(_head_troubles(way[1])), len(way[1])))


def _head_troubles(columns: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Yield what is wrong with the first row of a table."""
    if not any(columns):
        yield "the first row holds no paths", "write paths as --set takes them, such as part[0].surface.k0"
    if len(columns) > MOST_COLUMNS:
        yield f"{len(columns)} columns", f"at most {MOST_COLUMNS}"
        return
    for name, count in Counter(columns).items():
        if count > 1:
            yield f'the column "{name}" is there {count} times', "once"
        if name != ID and ("=" in name or not parsed(name)):
            yield f'"{name}" is no path into a job file', f'such as part[0].surface.k0, or "{ID}"'


def rows(table: Table) -> Entries:
    """Yield the jobs of a table; a row that nothing can be made of is a job too, and a bad one."""
    source, stem = table.source, job_id(table.template.stem)
    names = table.columns.index(ID) if ID in table.columns else None
    with table.file.open("rb") as stream:
        offset = 0
        for number, (record, size) in enumerate(_records(stream, table.between)):
            own = record.strip(AROUND)
            if number and own:
                start = offset + len(record) - len(record.lstrip(AROUND))
                name = (names is not None and _id(own, names, table.between)) or f"{stem}-{number:0{DIGITS}}"
                yield source, Entry(name, start, len(own), number + 1, content_of(table, own))
            offset += size


def content_of(table: Table, own: bytes) -> bytes:
    """Return the digest of a row's job: of its template, of the paths of the table, and of the row."""
    return content(table.shared + content(own))


def _records(stream: BinaryIO, between: str) -> Iterator[tuple[bytes, int]]:
    """Yield the rows of a table, each with the end of its line, and how long it is; a cell in quotes goes on.

    between: what may stand between its cells.
    """
    quoted = re.compile(rb'(?:\A(?:\xef\xbb\xbf)?|[%s])"[^"]*+(?:""[^"]*+)*+("|\Z)' % re.escape(between).encode())
    whole: list[bytes] = []
    opened, length = False, 0
    for text, size in capped(stream):
        whole.append(text)
        length += size
        cells = [*quoted.finditer(b'"' + text if opened else text)]
        opened = bool(cells) and not cells[-1][1]
        if not opened or len(whole) >= MOST_LINES:
            yield b"".join(whole), length
            whole, opened, length = [], False, 0
    if whole:
        yield b"".join(whole), length


def _id(own: bytes, column: int, between: str) -> str | None:
    """Return the id that a row gives itself; None where it gives none."""
    try:
        cell = _cells(own.decode(), between)[column].strip()
    except (ValueError, IndexError):
        return None
    return job_id(cell) if cell and safe_name(cell) else None


def _cells(text: str, between: str) -> list[str]:
    """Return the cells of one row; `ValueError` where quotes or letters are out of place."""
    try:
        return next(csv.reader([text], delimiter=between, strict=True), [])
    except csv.Error as error:
        raise ValueError(str(error)) from None


def settings(columns: Sequence[str], own: bytes, between: str = ",", origin: str = "the row") -> tuple[str, ...]:
    """Return what a row sets, as `--set` takes it; `ValueError` saying why nothing can be made of it.

    origin: the file and the row, as messages say it.
    """
    try:
        cells = _cells(own.decode(), between)
    except UnicodeDecodeError:
        raise ValueError(f"{origin} is not UTF-8 text; {AS_UTF8}") from None
    except ValueError as error:
        lines = f"; its quotes take {own.count(LINE_END) + 1} lines for one row" if LINE_END in own else ""
        raise ValueError(f"{origin} cannot be read: {error}{lines}") from None
    if len(cells) != len(columns):
        raise ValueError(f"{origin}: {len(cells)} cells where the table has {len(columns)} columns")
    pairs = zip(columns, cells, strict=True)
    return tuple(setting_of(path, cell.strip(), origin) for path, cell in pairs if path != ID and cell.strip())
