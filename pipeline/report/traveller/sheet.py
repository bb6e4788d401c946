"""The pages of a nested sheet: where every copy lies, what is left over, in which order it is cut.

A copy has the number of its outline in the drawing that is cut, and its name where there is room; the table below says
what each number is.  Where sheets have no drawing of their own, copies are numbered as they were placed.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import hypot

import numpy as np

from pipeline.report.shopentries import JobEntry, NestEntry, PlacementEntry, ReportEntry, SheetEntry, SideEntry
from pipeline.report.traveller.flow import Block, Column, Row, Table, space, table_blocks, title_block
from pipeline.report.traveller.ink import (
    BAD,
    INK,
    LINE_MM,
    PAPER,
    QUIET,
    THIN_MM,
    TINT,
    Pen,
    area,
    filled,
    moved,
    said,
    stroked,
)
from pipeline.report.traveller.numbers import counted, degrees, kilograms, millimetres, plain, share
from pipeline.report.traveller.part import CHIP_HIGH_MM, CHIP_MM, CHIP_PT, head_blocks
from pipeline.report.traveller.pattern import DENOMINATORS, scale_text
from stages.geometry.curves.rigid import Rigid2, apply, matrix
from stages.geometry.paths.arcpath import ArcPath, bounds
from stages.write.drawing import rectangle
from stages.write.helvetica import BOLD, CAPITALS, MM_PER_POINT, width_mm
from stages.write.pdf import numbers, outline, stroke

HIGH_SHARE = 0.46
"""Of a page, how high a sheet is drawn at most."""

NUMBER_PT, NAME_PT, LEAST_PT = 8.0, 7.0, 5.0


@dataclass(frozen=True, slots=True)
class Copied:
    """How copies of a part are drawn: by the form of that number, its name at a place with so much room around it."""

    form: int
    label_at: tuple[float, float]
    room_mm: float


@dataclass(frozen=True, slots=True)
class Nested:
    """A sheet with its outline, its copies in the order in which they are cut, or placed, and how parts are drawn."""

    entry: SheetEntry
    outline: ArcPath
    defects: tuple[ArcPath, ...]
    copies: tuple[PlacementEntry, ...]
    is_cut_order: bool
    drawn: Mapping[str, Copied]


def in_cut_order(entry: SheetEntry, side: SideEntry | None) -> tuple[tuple[PlacementEntry, ...], bool]:
    """Return the copies of a sheet in the order in which their outlines are cut, and whether that is known."""
    first: dict[tuple[str | None, int | None], int] = {}
    for number, contour in enumerate(side.contours if side is not None else ()):
        if contour.contour == 0:
            first.setdefault((contour.part, contour.copy), number)
    keys = [first.get((one.part, one.copy)) for one in entry.placements]
    if any(key is None for key in keys):
        return entry.placements, False
    return tuple(sorted(entry.placements, key=lambda one: first[(one.part, one.copy)])), True


def sheet_blocks(sheet: Nested, report: ReportEntry, room_mm: tuple[float, float]) -> Iterator[Block]:
    """Yield what stands on the pages of a sheet.  room_mm: how wide they are, and how high it may be drawn."""
    wide_mm, high_mm = room_mm
    entry = sheet.entry
    name = f"{entry.stock}  no. {entry.index}"
    yield from head_blocks(name, _about(sheet, report.job), wide_mm, used_chip(entry.utilisation))
    yield _drawing(sheet, wide_mm, high_mm)
    yield from table_blocks(_order_table(sheet, wide_mm))
    yield from _checks(report.nest, wide_mm)


def used_chip(utilisation: float) -> str:
    """Return how much of a sheet is used, framed as verdicts are."""
    up = (CHIP_HIGH_MM - CAPITALS * CHIP_PT * MM_PER_POINT) / 2.0
    words = f"{share(utilisation)} used"
    return area(0.0, 0.0, CHIP_MM, CHIP_HIGH_MM, INK) + said(
        CHIP_MM / 2.0, up, words, Pen(CHIP_PT, BOLD, PAPER, "middle")
    )


def _about(sheet: Nested, job: JobEntry) -> str:
    entry = sheet.entry
    low_x, low_y, high_x, high_y = bounds(sheet.outline)
    times = "\N{MULTIPLICATION SIGN}"
    thick = "" if job.material.thickness_mm is None else f"{job.material.thickness_mm:g} mm"
    size = f"{entry.kind} {millimetres(high_x - low_x)} {times} {millimetres(high_y - low_y)} mm"
    left = entry.offcut
    words = [
        " ".join(word for word in (job.material.name, thick) if word),
        size,
        counted(len(entry.placements), "piece"),
        f"parts {kilograms(entry.mass_kg)}",
        f"cut {millimetres(entry.cut_length_mm, 'mm')}, {counted(entry.pierces, 'pierce')}",
        "" if left is None else f"left over {millimetres(left.width_mm)} {times} {millimetres(left.height_mm)} mm",
        "" if entry.used_length_mm is None else f"used {millimetres(entry.used_length_mm, 'mm')} of the roll",
        f"job {job.name}",
        entry.file or "",
    ]
    return "   \N{MIDDLE DOT}   ".join(word for word in words if word)


def _scale(size: tuple[float, float], within: tuple[float, float]) -> float:
    """Return the largest scale of the series at which a sheet fits."""
    ten = 1.0
    while True:
        for denominator in DENOMINATORS:
            scale = 1.0 / (ten * denominator)
            if size[0] * scale <= within[0] and size[1] * scale <= within[1]:
                return scale
        ten *= 10.0


def _drawing(sheet: Nested, wide_mm: float, high_mm: float) -> Block:
    """Return the sheet with its copies, numbered."""
    low_x, low_y, high_x, high_y = bounds(sheet.outline)
    scale = _scale((high_x - low_x, high_y - low_y), (wide_mm, high_mm))
    title = title_block(f"Nest   {scale_text(scale)}", wide_mm, _note(sheet))
    high = scale * (high_y - low_y)
    s, x, y = scale, -scale * low_x, -scale * low_y
    made = [f"q {numbers((s, 0.0, 0.0, s, x, y))} cm\n", *_stock(sheet, scale)]
    made.append(f"{filled(TINT)} {stroked(INK, THIN_MM / scale)}")
    labels = []
    for number, placed in enumerate(sheet.copies, 1):
        copied, motion = sheet.drawn[placed.part], Rigid2(placed.x, placed.y, placed.angle, placed.mirrored)
        made.append(_copy(copied.form, motion))
        at = apply(motion, np.array([copied.label_at]))[0]
        labels.append(_label(number, placed.part, (s * at[0] + x, s * at[1] + y), scale * copied.room_mm))
    if sheet.entry.offcut is not None:
        left = sheet.entry.offcut
        middle = s * (left.x + left.width_mm / 2.0) + x, s * (left.y + left.height_mm / 2.0) + y
        labels.append(_left_over(middle, scale * min(left.width_mm, left.height_mm)))
    content = "".join([*made, "Q\n", *labels])
    across = (wide_mm - scale * (high_x - low_x)) / 2.0
    total = title.height_mm + 3.0 + high
    return Block(total, title.content + moved(content, across, -total))


def _note(sheet: Nested) -> str:
    order = "Numbers: order of cutting." if sheet.is_cut_order else "Numbers: order of placing."
    return f"{order} Dashed: what is left over. Turned over copies are marked in the table."


def _stock(sheet: Nested, scale: float) -> Iterator[str]:
    """Yield the sheet, its defects and what is left over."""
    yield stroked(INK, LINE_MM / scale) + stroke(sheet.outline)
    for path in sheet.defects:
        yield f"{filled(TINT)} {stroked(BAD, THIN_MM / scale)} {outline(path)} b\n"
    if sheet.entry.offcut is not None:
        left = sheet.entry.offcut
        yield stroked(QUIET, THIN_MM / scale, f"[{numbers((2.0 / scale, 1.5 / scale))}] 0")
        yield stroke(rectangle(left.width_mm, left.height_mm, left.x, left.y))


def _copy(form: int, motion: Rigid2) -> str:
    """Return a copy where it lies."""
    (a, c), (b, d) = matrix(motion)
    return f"q {numbers((a, b, c, d, motion.x, motion.y))} cm /X{form} Do Q\n"


def _label(number: int, name: str, at: tuple[float, float], free_mm: float) -> str:
    """Return the number of a copy with its name below it as far as there is room, else the number alone, or nothing."""
    x, y = at
    step = NAME_PT * MM_PER_POINT
    half = width_mm(name, NAME_PT) / 2.0
    if half**2 + step**2 <= free_mm**2:
        return said(x, y + 0.3, str(number), Pen(NUMBER_PT, BOLD, align="middle")) + said(
            x, y - step, name, Pen(NAME_PT, colour=QUIET, align="middle")
        )
    size = NUMBER_PT
    while hypot(width_mm(str(number), size, BOLD), CAPITALS * size * MM_PER_POINT) > 2.0 * free_mm:
        size -= 1.0
        if size < LEAST_PT:
            return ""
    return said(x, y - CAPITALS * size * MM_PER_POINT / 2.0, str(number), Pen(size, BOLD, align="middle"))


def _left_over(at: tuple[float, float], free_mm: float) -> str:
    words = "left over"
    if width_mm(words, NAME_PT) > free_mm:
        return ""
    return said(at[0], at[1] - 1.0, words, Pen(NAME_PT, colour=QUIET, align="middle"))


def _order_table(sheet: Nested, wide_mm: float) -> Table:
    """Return what each number is."""
    columns = (
        Column("no.", 12.0),
        Column("part", wide_mm - 12.0 - 16.0 - 28.0 - 28.0 - 24.0 - 24.0),
        Column("copy", 16.0),
        Column("x", 28.0, "right", "mm"),
        Column("y", 28.0, "right", "mm"),
        Column("angle", 24.0, "right", "\N{DEGREE SIGN}"),
        Column("", 24.0),
    )
    rows = tuple(
        Row((str(number), one.part, str(one.copy), millimetres(one.x), millimetres(one.y), degrees(one.angle),
             "mirrored" if one.mirrored else ""))
        for number, one in enumerate(sheet.copies, 1)
    )  # fmt: skip
    title = "Order of cutting" if sheet.is_cut_order else "Pieces"
    return Table(title, columns, rows, "Place of the flat frame of each part on the sheet.")


def _checks(nest: NestEntry, wide_mm: float) -> Iterator[Block]:
    """Yield what was measured of the nest as a whole."""
    yield space(1.0)
    columns = (
        Column("check of the whole nest", wide_mm - 90.0),
        Column("value", 30.0, "right"),
        Column("limit", 30.0, "right"),
        Column("evidence", 30.0),
    )
    rows = tuple(
        Row(
            (one.name, plain(one.value, one.unit),
             "" if one.limit is None else plain(one.limit, one.unit), one.evidence),
            colour=INK if one.passed else BAD,
        )
        for one in nest.metrics
    )  # fmt: skip
    if rows:
        yield from table_blocks(Table("Checks", columns, rows))
