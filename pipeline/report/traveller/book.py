"""`traveller.pdf`: the pages that go with a job through the shop, one or more for each part and each nested sheet.

Built from what lies in the output folder: the report, what is drawn of it (`view.json`), the side files of nested
sheets.
Pages are A4 upright, those of wide sheets across, patterns at true scale on A4 or A3 (`pattern`).

The same folder gives the same bytes.  Letters beyond Western Europe are replaced, and the page says so.
"""

from collections.abc import Iterator, Mapping

import msgspec

from pipeline.report.nestentries import sheet_of
from pipeline.report.render import Made
from pipeline.report.shopentries import PartEntry, ReportEntry, SheetEntry, SideEntry
from pipeline.report.traveller.formed import formed_picture
from pipeline.report.traveller.inked import Inked, inked, label_room_mm
from pipeline.report.traveller.pages import A4_MM, Leaf, Subject, leaves, numbered, true_leaf, width_of
from pipeline.report.traveller.part import PICTURE_MM, Shown, part_blocks, whole_view
from pipeline.report.traveller.sheet import HIGH_SHARE, Copied, Nested, in_cut_order, sheet_blocks
from pipeline.report.view.entries import VIEW, PartView, part_views
from pipeline.store import safe_name
from stages.geometry.paths.arcpath import bounds
from stages.write.drawing import rectangle
from stages.write.pdfbook import book
from stages.write.pdfobjects import Page

DIGITS = 8
"""Of the digest of a job, in the id of a page."""

MADE = "made"


def traveller_pdf(made: Made) -> bytes:
    """Return the traveller of a finished job; `KeyError` where it lies without what is drawn of its parts."""
    read, files = msgspec.convert(made.report, ReportEntry), made.files
    views = part_views(files, VIEW)
    flat = [(part.name, part.flat) for part in views.values() if part.flat is not None]
    patterns = {name: inked(one, number) for number, (name, one) in enumerate(flat)}
    pages: list[Page] = []
    for number, part in enumerate(read.parts, 1):
        if part.verdict is not None:  # else nested from its drawing: its own job has its pages
            pages += _part_pages(read, part, number, patterns.get(part.name), views.get(part.name))
    sheets = read.nest.sheets if read.status == MADE else ()
    for number, sheet in enumerate(sheets, 1):
        pages += _sheet_pages(read, _nested(read, sheet, patterns, views, files), number)
    return book(f"Traveller of {read.job.name}", pages, [one.form for one in patterns.values()])


def _part_pages(
    report: ReportEntry, part: PartEntry, number: int, pattern: Inked | None, view: PartView | None
) -> Iterator[Page]:
    """Yield the pages of a part."""
    picture = None
    if view is not None and view.formed is not None:
        picture = formed_picture(view.formed, PICTURE_MM, part.formed)
    subject = Subject(part.name, f"{_prefix(report)}-P{number:03d}", _said(report, part))
    blocks = part_blocks(Shown(part, pattern, picture), report.job, width_of(A4_MM))
    found: list[Leaf] = list(leaves(blocks, subject, A4_MM))
    if pattern is not None and whole_view(pattern, width_of(A4_MM)).scale != 1.0:
        whole = true_leaf(pattern, part.tape, subject)
        found[1:1] = [whole] if whole is not None else []
    return numbered(found, subject)


def _said(report: ReportEntry, part: PartEntry) -> str:
    """Return the texts of a part that a job chooses."""
    names = (
        [] if part.flat is None else [*(one.name for one in part.flat.holes), *(one.name for one in part.flat.marks)]
    )
    found = [finding.message for stage in part.stages for finding in stage.findings]
    return " ".join([part.name, *_job_words(report), *names, *found])


def _prefix(report: ReportEntry) -> str:
    """Return what the ids of a job begin with: of its digest, or its name where it has none."""
    return (report.job.digest or "")[:DIGITS] or safe_name(report.job.name)[:DIGITS]


def _job_words(report: ReportEntry) -> list[str]:
    job = report.job
    return [job.name, job.customer or "", job.revision or "", job.material.name]


def _nested(
    report: ReportEntry,
    entry: SheetEntry,
    patterns: Mapping[str, Inked],
    views: Mapping[str, PartView],
    files: Mapping[str, bytes],
) -> Nested:
    """Return a sheet with its outline, the order of its copies, and how its parts are drawn."""
    stock = next(sheet_of(one) for one in report.nest.stock if one.id == entry.stock)
    used = stock.width_mm if entry.used_length_mm is None else entry.used_length_mm
    outline = stock.outline if stock.outline is not None else rectangle(used, stock.height_mm)
    side = None
    path = None if entry.file is None else f"{entry.file.rpartition('.')[0]}.json"
    if path is not None and path in files:
        side = msgspec.json.decode(files[path], type=SideEntry)
    copies, is_cut_order = in_cut_order(entry, side)
    drawn = {name: _copied(patterns[name], views[name]) for name in dict.fromkeys(one.part for one in copies)}
    return Nested(entry, outline, stock.defects, copies, is_cut_order, drawn)


def _copied(pattern: Inked, view: PartView) -> Copied:
    """Return how copies of a part are drawn."""
    if view.flat is None:
        raise ValueError(f"{view.name} is nested and has no pattern")
    return Copied(pattern.number, view.flat.label, label_room_mm(view.flat))


def _sheet_pages(report: ReportEntry, sheet: Nested, number: int) -> Iterator[Page]:
    """Yield the pages of a sheet, across where it is wider than high."""
    low_x, low_y, high_x, high_y = bounds(sheet.outline)
    paper = (A4_MM[1], A4_MM[0]) if high_x - low_x > high_y - low_y else A4_MM
    entry = sheet.entry
    words = " ".join([entry.stock, *_job_words(report), *(one.part for one in sheet.copies)])
    subject = Subject(f"{entry.stock}  no. {entry.index}", f"{_prefix(report)}-S{number:03d}", words)
    blocks = sheet_blocks(sheet, report, (width_of(paper), HIGH_SHARE * paper[1]))
    return numbered(list(leaves(blocks, subject, paper)), subject)
