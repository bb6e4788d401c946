"""Blocks below each other on as many pages as they take: lines of text, rows of tables, drawings.

A block is drawn with its origin at its upper left corner, y upwards, so that all of it lies below 0.  One that belongs
under a heading names it: the heading comes again at the top of every page on which such blocks go on.  Nothing is
shortened: a cell that is wider than its column goes on in lines below, a row that is higher than `MOST_LINES` in rows.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import accumulate, zip_longest

from pipeline.report.traveller.ink import (
    HAIR,
    HAIR_MM,
    INK,
    KEPT,
    LINE_MM,
    QUIET,
    Align,
    Colour,
    Pen,
    line_of,
    moved,
    rule,
    said,
    stroked,
)
from stages.write.helvetica import BOLD, DESCENT, MM_PER_POINT, REGULAR, Face, width_mm, wrapped

LEADING = 1.28
"""From line to line, over the size of the letters."""

BODY_PT, HEAD_PT, TITLE_PT = 8.5, 7.0, 10.5
CELL_GAP_MM, NUMBER_GAP_MM = 2.5, 5.0
ROW_ABOVE_MM, ROW_BELOW_MM = 0.9, 0.75
MOST_LINES = 40


@dataclass(frozen=True, slots=True)
class Block:
    """Something on a page, so high; heading: what must stand above it."""

    height_mm: float
    content: str
    heading: "Block | None" = None


def space(height_mm: float) -> Block:
    """Return empty room."""
    return Block(height_mm, "")


def stacked(blocks: Iterable[Block], first_mm: float, room_mm: float) -> Iterator[list[tuple[float, Block]]]:
    """Yield what stands on each page: blocks with their upper edges, mm above the lower end of the room.

    first_mm: the room on the first page; room_mm: on all others.
    """
    page: list[tuple[float, Block]] = []
    left, whole, above = first_mm, first_mm, None
    for block in blocks:
        heading = block.heading if block.heading is not above else None
        needed = block.height_mm + (heading.height_mm if heading else 0.0)
        if needed > left and page:
            yield page
            page, left, whole = [], room_mm, room_mm
            heading = block.heading
        for one in (heading, block):
            if one is not None and not (one.content == "" and left == whole):
                page.append((left, one))
                left -= one.height_mm
        above = block.heading
    if page:
        yield page


@dataclass(frozen=True, slots=True)
class Column:
    """A column of a table: what it is called, its unit, how wide it is, and on which side its cells stand."""

    name: str
    width_mm: float
    align: Align = "left"
    unit: str = ""


@dataclass(frozen=True, slots=True)
class Row:
    """A row of a table, its cells in letters of one kind."""

    cells: tuple[str, ...]
    face: Face = REGULAR
    colour: Colour = INK


@dataclass(frozen=True, slots=True)
class Table:
    """A table with its title; note: what is to be known of all of it."""

    title: str
    columns: tuple[Column, ...]
    rows: tuple[Row, ...]
    note: str = ""
    above_mm: float = field(default=5.0)


def table_blocks(table: Table) -> Iterator[Block]:
    """Yield a table row by row."""
    heading = _heading(table.title, table.note, table.columns)
    rooms = _rooms(table.columns)
    yield space(table.above_mm)
    for row in table.rows:
        yield from _rows(rooms, row, heading)


def line_blocks(text: str, wide_mm: float, pen: Pen, heading: Block | None = None, x: float = 0.0) -> Iterator[Block]:
    """Yield a text line by line."""
    step = pen.size_pt * MM_PER_POINT * LEADING
    for words in wrapped(text, wide_mm, pen.size_pt, pen.face):
        yield Block(step, said(x, -step + _below(pen.size_pt), words, pen), heading)


def title_block(text: str, wide_mm: float, note: str = "") -> Block:
    """Return a title above a rule."""
    made = list(line_blocks(text, wide_mm, Pen(TITLE_PT, BOLD)))
    made += line_blocks(note, wide_mm, Pen(HEAD_PT, colour=QUIET)) if note else []
    content, height = _together(made)
    return Block(height + 1.0, content + stroked(INK, LINE_MM) + rule(0.0, -height - 0.6, wide_mm, -height - 0.6))


def _together(blocks: Sequence[Block]) -> tuple[str, float]:
    """Return blocks as one, and how high they are."""
    content, height = "", 0.0
    for block in blocks:
        content += moved(block.content, 0.0, -height)
        height += block.height_mm
    return content, height


def _below(size_pt: float) -> float:
    """Return how far the baseline is above the lower edge of a line."""
    return size_pt * MM_PER_POINT * DESCENT


@dataclass(frozen=True, slots=True)
class Room:
    """Where the cells of a column lie: from x on, so wide, on the left or on the right side of that."""

    x_mm: float
    width_mm: float
    right: bool


@lru_cache(maxsize=KEPT)
def _rooms(columns: Sequence[Column]) -> tuple[Room, ...]:
    """Return where the cells of columns lie; behind numbers, which reach up to there, more is left free."""
    starts = accumulate((column.width_mm for column in columns), initial=0.0)
    right = [column.align == "right" for column in columns]
    gaps = [NUMBER_GAP_MM if one else CELL_GAP_MM for one in right]
    return tuple(
        Room(x, column.width_mm - gap, one) for x, column, gap, one in zip(starts, columns, gaps, right, strict=False)
    )


@lru_cache(maxsize=KEPT)
def _heading(title: str, note: str, columns: Sequence[Column]) -> Block:
    """Return the title of a table with the names of its columns."""
    width = sum(column.width_mm for column in columns)
    above = title_block(title, width, note)
    names = [f"{one.name} {one.unit}".strip() for one in columns]
    pen = Pen(HEAD_PT, colour=QUIET)
    content, height = _lines(_rooms(columns), _cells(_rooms(columns), names, pen), pen)
    under = stroked(HAIR, HAIR_MM) + rule(0.0, -height, width, -height)
    return Block(above.height_mm + height, above.content + moved(content + under, 0.0, -above.height_mm))


def _rows(rooms: Sequence[Room], row: Row, heading: Block) -> Iterator[Block]:
    """Yield a row, in several parts if it is too high for one."""
    pen = Pen(BODY_PT, row.face, row.colour)
    lines = _cells(rooms, row.cells, pen)
    width = rooms[-1].x_mm + rooms[-1].width_mm + (NUMBER_GAP_MM if rooms[-1].right else CELL_GAP_MM)
    for first in range(0, len(lines), MOST_LINES):
        content, height = _lines(rooms, lines[first : first + MOST_LINES], pen)
        is_last = first + MOST_LINES >= len(lines)
        under = stroked(HAIR, HAIR_MM) + rule(0.0, -height, width, -height) if is_last else ""
        yield Block(height, content + under, heading)


def _cells(rooms: Sequence[Room], cells: Sequence[str], pen: Pen) -> list[tuple[str, ...]]:
    """Return the lines of a row: of every cell one, empty where it has no more."""
    wraps = [wrapped(cell, room.width_mm, pen.size_pt, pen.face) for cell, room in zip(cells, rooms, strict=True)]
    return list(zip_longest(*wraps, fillvalue=""))


def _lines(rooms: Sequence[Room], lines: Sequence[tuple[str, ...]], pen: Pen) -> tuple[str, float]:
    """Return the lines of a row drawn, and how high they are."""
    step = pen.size_pt * MM_PER_POINT * LEADING
    places = [
        (_start(room, cell, pen), -ROW_ABOVE_MM - i * step + _below(pen.size_pt) + 0.35, cell)
        for i, cells in enumerate(lines, 1)
        for room, cell in zip(rooms, cells, strict=True)
        if cell
    ]
    return line_of(places, pen), ROW_ABOVE_MM + len(lines) * step + ROW_BELOW_MM


def _start(room: Room, cell: str, pen: Pen) -> float:
    """Return where the text of a cell begins."""
    return room.x_mm + (room.width_mm - width_mm(cell, pen.size_pt, pen.face) if room.right else 0.0)
