"""Pages of the traveller: what stands on them, and their foot with check line, id and number.

The line of 100 mm is on every page: a print on which it is not 100 mm long was scaled.  The id is there in letters and
as a code (`code`).
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from pipeline.report.shopentries import TapeEntry
from pipeline.report.traveller.code import QUIET_MM, Code, code_of
from pipeline.report.traveller.flow import Block, line_blocks, stacked
from pipeline.report.traveller.ink import HAIR, INK, LINE_MM, QUIET, THIN_MM, Pen, moved, rule, said, stroked
from pipeline.report.traveller.inked import Inked
from pipeline.report.traveller.pattern import PAPERS, View, drawn_pattern, scale_text, shifted, true_view
from stages.write.helvetica import BOLD, lost, wrapped
from stages.write.pdfobjects import Page

MARGIN_MM, TOP_MM, FOOT_MM = 12.0, 11.0, 20.0
CHECK_MM, CHECK_Y_MM, TICK_MM = 100.0, 9.0, 1.6
RULE_MM = FOOT_MM - 2.5
"""The line above the foot of a page."""

CLEAR_MM = 0.2
"""Of a code from that line, more than it must be."""

FOOT_PT = 7.0
A4_MM = 210.0, 297.0
"""ISO 216."""

LETTERS_MM = 7.0
"""Around a pattern at true scale, for the letters at its corners."""

HEAD_MM = 9.0
NAME_SIGNS = 60
"""Of a name above a pattern at true scale, as far as it stands on one line: the page before has it whole."""

REPLACED = "? stands for letters beyond Western Europe: "


@dataclass(frozen=True, slots=True)
class Subject:
    """What pages are about: a part or a sheet, and its id as text."""

    name: str
    id: str
    said: str
    """All texts of it, in which letters may have been replaced."""


@dataclass(frozen=True, slots=True)
class Leaf:
    """A page without its foot."""

    width_mm: float
    height_mm: float
    content: str


def width_of(paper_mm: tuple[float, float]) -> float:
    """Return how wide what stands on a page may be."""
    return paper_mm[0] - 2.0 * MARGIN_MM


def leaves(blocks: Iterable[Block], subject: Subject, paper_mm: tuple[float, float]) -> Iterator[Leaf]:
    """Yield the pages that blocks take; from the second on the name of what they are about stands above them."""
    width, height = paper_mm
    room = height - TOP_MM - FOOT_MM
    again = list(line_blocks(subject.name, width_of(paper_mm) - 30.0, Pen(FOOT_PT + 1.0, BOLD, QUIET)))
    high = sum(line.height_mm for line in again) + 3.0
    for number, page in enumerate(stacked(blocks, room, room - high)):
        content = "".join(moved(block.content, MARGIN_MM, FOOT_MM + above) for above, block in page)
        yield Leaf(width, height, content if number == 0 else content + _again(again, paper_mm))


def _again(lines: Sequence[Block], paper_mm: tuple[float, float]) -> str:
    """Return the name on a page that goes on."""
    y, made = paper_mm[1] - TOP_MM, ""
    for line in lines:
        made += moved(line.content, MARGIN_MM, y)
        y -= line.height_mm
    made += said(
        paper_mm[0] - MARGIN_MM,
        paper_mm[1] - TOP_MM - 2.8,
        "continued",
        Pen(FOOT_PT + 1.0, colour=QUIET, align="right"),
    )
    return made + stroked(INK, LINE_MM) + rule(MARGIN_MM, y - 1.2, paper_mm[0] - MARGIN_MM, y - 1.2)


def true_leaf(inked: Inked, tape: TapeEntry | None, subject: Subject) -> Leaf | None:
    """Return the page that shows a pattern at 1:1, on the smallest paper that holds it; None where none does."""
    for paper, width, height in PAPERS:
        room = width - 2.0 * (MARGIN_MM + LETTERS_MM), height - TOP_MM - FOOT_MM - HEAD_MM - 2.0 * LETTERS_MM
        view = true_view(inked, room)
        if view is not None:
            return _true_leaf(inked, tape, subject, (paper, width, height), view)
    return None


def _true_leaf(
    inked: Inked, tape: TapeEntry | None, subject: Subject, paper: tuple[str, float, float], view: View
) -> Leaf:
    name, width, height = paper
    room = width - 2.0 * (MARGIN_MM + LETTERS_MM), height - TOP_MM - FOOT_MM - HEAD_MM - 2.0 * LETTERS_MM
    drawn = shifted(drawn_pattern(inked, view, tape), view, room)
    top = height - TOP_MM
    words = f"{scale_text(view.scale)}   true scale on {name}: check the line below before you lay it on the blank"
    first, *rest = wrapped(subject.name, width_of((width, height)) - 120.0, 11.0, BOLD)
    content = [
        moved(drawn, MARGIN_MM + LETTERS_MM, FOOT_MM + LETTERS_MM),
        said(MARGIN_MM, top - 4.0, first + ("\N{HORIZONTAL ELLIPSIS}" if rest else ""), Pen(11.0, BOLD)),
        said(width - MARGIN_MM, top - 4.0, words, Pen(FOOT_PT + 0.5, colour=QUIET, align="right")),
        stroked(INK, LINE_MM),
        rule(MARGIN_MM, top - 6.2, width - MARGIN_MM, top - 6.2),
    ]
    return Leaf(width, height, "".join(content))


def numbered(found: Sequence[Leaf], subject: Subject) -> Iterator[Page]:
    """Yield the pages of a subject with their feet."""
    for number, leaf in enumerate(found, 1):
        foot = _foot(leaf, subject, code_of(subject.id), f"page {number} of {len(found)}")
        yield Page(leaf.width_mm, leaf.height_mm, leaf.content + foot)


def _foot(leaf: Leaf, subject: Subject, code: Code, page: str) -> str:
    """Return the foot of a page: check line on the left, id, number and the code of the id on the right."""
    right, y = leaf.width_mm - MARGIN_MM, CHECK_Y_MM
    edge = right - code.side_mm
    beside = edge - QUIET_MM - CLEAR_MM
    missing = lost(subject.said)
    told = f"{REPLACED}{', '.join(f'U+{ord(letter):04X}' for letter in missing)}" if missing else ""
    made = [
        stroked(HAIR, THIN_MM),
        rule(MARGIN_MM, RULE_MM, right, RULE_MM),
        stroked(INK, LINE_MM),
        rule(MARGIN_MM, y, MARGIN_MM + CHECK_MM, y),
        *(rule(end, y - TICK_MM, end, y + TICK_MM) for end in (MARGIN_MM, MARGIN_MM + CHECK_MM)),
        said(MARGIN_MM + CHECK_MM / 2.0, y + 1.2, "100 mm on paper", Pen(FOOT_PT, align="middle")),
        said(beside, y + 2.2, subject.id, Pen(FOOT_PT + 2.0, BOLD, align="right")),
        said(beside, y - 1.4, page, Pen(FOOT_PT, colour=QUIET, align="right")),
        moved(code.content, edge, RULE_MM - CLEAR_MM - QUIET_MM - code.side_mm),
    ]
    for i, line in enumerate(wrapped(told, CHECK_MM - 10.0, FOOT_PT - 1.5)[:2]):
        made.append(said(MARGIN_MM, y - 3.6 - 2.3 * i, line, Pen(FOOT_PT - 1.5, colour=QUIET)))
    return "".join(made)
