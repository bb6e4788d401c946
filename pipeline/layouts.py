"""Layouts that are kept: `layout.json` of every nested job, and a job that is placed by such a file.

The job file names it (`nest.layout`), or `--layout` does, which comes first.

A layout that holds every copy is final: nothing is searched, it is certified and written, and the same layout gives the
same bytes.  A person may edit it.  Where some placements say `fixed = true`, these stay and all others are placed anew
around them; where none says so, all that the file holds stay, and the copies that it lacks are placed around them.
Sheets of one stock go by their numbers, in whatever order the file has them; those on which nothing is left go, and
those after them move up.

What the file alone shows to be wrong is an error with its line, every one at once; what geometry decides (overlaps,
gaps, angles) the certifier says.  `fixed` is a wish: it is read, and never written.
"""

from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from pipeline import __version__
from pipeline.decode import Complaint, suggestion
from pipeline.layoutfile import SCHEMA, LayoutFile, Row, SheetRows, read_layout
from stages.errors import BadInputError, Problem
from stages.model.sheet import Nesting, Placement, Sheet, SheetLayout

if TYPE_CHECKING:
    from pipeline.job import Job
    from pipeline.run import JobResult
    from stages.model.pattern import FlatPattern

LAYOUT = "layout.json"
Document = dict[str, object]
NO_SHARE = 0.0
"""The utilisation of a layout that is not nested yet."""


@dataclass(frozen=True, slots=True)
class Stored:
    """A layout for a job: its file, and its sheets as they stay."""

    source: LayoutFile
    sheets: tuple[SheetRows, ...]


def with_layout(job: "Job", file: Path) -> "Job":
    """Return the job placed by a layout file, which is one of its inputs then; `BadInputError`."""
    source = read_layout(file)
    return replace(laid(job, source), inputs=(*job.inputs, (file.name, source.digest)))


def laid(job: "Job", source: LayoutFile) -> "Job":
    """Return the job placed by a layout; `BadInputError` with everything that its file alone shows to be wrong."""
    if not job.stock:
        hint = "add [[stock]]"
        raise BadInputError(Problem("the job has no stock to lay parts on", hint=hint, file=str(source.file)))
    quantities = {part.name: part.spec.quantity for part in job.parts}
    complaints = [
        *source.complaints,
        *_stock_complaints(source.sheets, job.stock),
        *_copy_complaints(_rows(source.sheets), quantities, blanks_of=quantities),
    ]
    if complaints:
        raise BadInputError(*source.problems(complaints))
    return replace(job, layout=Stored(source, kept(source.sheets)))


def kept(sheets: Sequence[SheetRows]) -> tuple[SheetRows, ...]:
    """Return the sheets as they stay: with the fixed copies if any copy is fixed, else with all."""
    some = any(row.fixed for row in _rows(sheets))
    left = [replace(sheet, rows=tuple(row for row in sheet.rows if row.fixed or not some)) for sheet in sheets]
    return tuple(sheet for sheet in left if sheet.rows)


def summary(stored: Stored) -> str:
    """Return in a line how much of a layout stays."""
    stay, there = len(_rows(stored.sheets)), len(_rows(stored.source.sheets))
    lie = "copies lie" if there != 1 else "copy lies"
    anew = "" if stay == there else f", {there - stay} that are not fixed are placed anew"
    return f"{stored.source.file}: {there} {lie} on its sheets{anew}"


def placed(stored: Stored, stock: Sequence[Sheet], patterns: "Sequence[FlatPattern]") -> Nesting:
    """Return the copies that stay where they are; `BadInputError` for those of blanks that there are not."""
    quantities = {pattern.part: pattern.quantity for pattern in patterns}
    complaints = [*_copy_complaints(_rows(stored.sheets), quantities, blanks_of=())]
    if complaints:
        raise BadInputError(*stored.source.problems(complaints))
    sheets = {sheet.id: sheet for sheet in stock}
    numbers: Counter[str] = Counter()
    layouts = []
    for sheet in in_order(stored.sheets):
        numbers[sheet.stock] += 1
        copies = tuple(Placement(row.part, row.copy, row.motion, row.fixed) for row in sheet.rows)
        layouts.append(SheetLayout(sheets[sheet.stock], numbers[sheet.stock], copies, NO_SHARE))
    return Nesting(tuple(layouts))


def in_order(sheets: Sequence[SheetRows]) -> list[SheetRows]:
    """Return sheets in the order of a file, but those of one stock by their numbers."""
    rising: dict[str, Iterator[SheetRows]] = {
        stock: iter(sorted((sheet for sheet in sheets if sheet.stock == stock), key=lambda sheet: sheet.index))
        for stock in {sheet.stock for sheet in sheets}
    }
    return [next(rising[sheet.stock]) for sheet in sheets]


def is_whole(stored: Stored, patterns: "Sequence[FlatPattern]") -> bool:
    """Return whether every copy stays where the file has it."""
    return len(_rows(stored.sheets)) == sum(pattern.quantity for pattern in patterns)


def _rows(sheets: Sequence[SheetRows]) -> list[Row]:
    return [row for sheet in sheets for row in sheet.rows]


def _stock_complaints(sheets: Sequence[SheetRows], stock: Sequence[Sheet]) -> Iterator[Complaint]:
    """Yield sheets of no known stock, those given twice, and more of them than there are."""
    known = {sheet.id: sheet for sheet in stock}
    seen: set[tuple[str, int]] = set()
    used: Counter[str] = Counter()
    for sheet in sheets:
        if sheet.stock not in known:
            hint = suggestion(sheet.stock, list(known))
            yield Complaint((*sheet.path, "stock"), f'the job has no stock "{sheet.stock}"', hint)
            continue
        if (sheet.stock, sheet.index) in seen:
            message = f'sheet {sheet.index} of "{sheet.stock}" is there twice'
            yield Complaint((*sheet.path, "index"), message, "number the sheets of a stock from 1 on")
        seen.add((sheet.stock, sheet.index))
    for sheet in kept(sheets):
        quantity = known[sheet.stock].quantity if sheet.stock in known else None
        used[sheet.stock] += 1
        if quantity is not None and used[sheet.stock] == quantity + 1:
            message = f'more sheets of "{sheet.stock}" are used than there are: {quantity}'
            yield Complaint((*sheet.path, "stock"), message, "raise its quantity, or use fewer")


def _copy_complaints(
    rows: Sequence[Row], quantities: Mapping[str, int], *, blanks_of: Collection[str]
) -> Iterator[Complaint]:
    """Yield copies of no known part, beyond the quantity, or placed twice.

    blanks_of: parts of which it is not known yet whether they are divided into blanks, `<part>.<n>`.
    """
    seen: set[tuple[str, int]] = set()
    for row in rows:
        whole, _, number = row.part.rpartition(".")
        name = whole if row.part not in quantities and number.isdecimal() and whole in blanks_of else row.part
        if name not in quantities:
            message = f'the job has no part "{row.part}"'
            yield Complaint((*row.path, "part"), message, suggestion(row.part, list(quantities)))
        elif row.copy > quantities[name]:
            message = f'copy {row.copy} of "{row.part}", of which {quantities[name]} are wanted'
            yield Complaint((*row.path, "copy"), message, "copies count from 1 to the quantity of the part")
        if (row.part, row.copy) in seen:
            message = f'copy {row.copy} of "{row.part}" is placed twice'
            yield Complaint((*row.path, "copy"), message, "leave one of them out")
        seen.add((row.part, row.copy))


def layout_document(result: "JobResult") -> Document | None:
    """Return the layout of a nested job for its file; None where nothing was nested."""
    nesting = result.nest.product
    if nesting is None:
        return None
    return {
        "schema": SCHEMA,
        "job": result.job.name,
        "engine": engine_of(result),
        "sheets": [
            {
                "stock": layout.sheet.id,
                "index": layout.index,
                "placements": [placement_entry(copy) for copy in layout.placements],
            }
            for layout in nesting.layouts
        ],
    }


def engine_of(result: "JobResult") -> Document:
    """Return who placed the copies: whoever placed those of a stored layout to which nothing was added."""
    stored, options = result.job.layout, result.job.options
    patterns = [run.pattern for run in result.parts if run.pattern is not None]
    if stored is not None and stored.source.engine is not None and is_whole(stored, patterns):
        return dict(stored.source.engine)
    return {"name": "planish", "version": __version__, "seed": options.seed, "time_limit_s": options.time_limit_s}


def placement_entry(copy: Placement) -> Document:
    """Return one placed copy as layouts and reports say it."""
    motion = copy.motion
    return {
        "part": copy.part,
        "copy": copy.copy,
        "x": motion.x,
        "y": motion.y,
        "angle": motion.angle_deg,
        "mirrored": motion.mirrored,
    }
