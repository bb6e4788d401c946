"""The pages of a part: what it is, how it looks, whether it is right, what to measure, how to bend or roll it.

The first page has head, facts, pattern and what to measure; tables go on behind it on as many pages as they take.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from pipeline.report.entries import MetricEntry
from pipeline.report.shopentries import FlatEntry, JobEntry, PartEntry, TapeEntry
from pipeline.report.traveller.flow import (
    BODY_PT,
    LEADING,
    Block,
    Column,
    Row,
    Table,
    line_blocks,
    space,
    table_blocks,
    title_block,
)
from pipeline.report.traveller.forming import forming_tables
from pipeline.report.traveller.ink import (
    BAD,
    GOOD,
    HAIR,
    HAIR_MM,
    INK,
    PAPER,
    QUIET,
    Pen,
    area,
    moved,
    rule,
    said,
    stroked,
)
from pipeline.report.traveller.inked import Inked
from pipeline.report.traveller.numbers import DASH, counted, kilograms, millimetres, plain, square
from pipeline.report.traveller.pattern import (
    AROUND_MM,
    SIZES_MM,
    View,
    best_view,
    drawn_pattern,
    scale_text,
    shifted,
    sizes,
)
from stages.write.helvetica import BOLD, CAPITALS, MM_PER_POINT, REGULAR, width_mm, wrapped

NAME_PT = 20.0, 14.0, 10.0
"""Sizes of a name: the largest in which it takes no more than `NAME_LINES`, the last whatever it takes."""

NAME_LINES = 2
CHIP_MM, CHIP_HIGH_MM, CHIP_PT = 44.0, 9.0, 12.0
PICTURE_MM = 88.0, 66.0
FACT_LABEL_MM, FACTS_GAP_MM = 30.0, 6.0
PATTERN_HIGH_MM = 78.0
WORST = 6
"""Checks on the first page: those that come nearest to their limits."""

REFUSED = ("rejected", "inconclusive")
CLASS_WORDS = {"exact": "EXACT", "rejected": "REJECTED", "inconclusive": "NOT DECIDED"}


@dataclass(frozen=True, slots=True)
class Shown:
    """A part with its pattern, which one that was refused has not, and its picture."""

    part: PartEntry
    inked: Inked | None
    picture: str | None
    """Operators that draw the formed part in a box of `PICTURE_MM`, from its lower left corner."""


def part_blocks(shown: Shown, job: JobEntry, width_mm: float) -> Iterator[Block]:
    """Yield what stands on the pages of a part."""
    part = shown.part
    yield from head_blocks(part.name, _about(part, job), width_mm, chip(part.verdict or ""))
    yield _facts_block(shown, job, width_mm)
    if shown.inked is not None and part.flat is not None:
        yield from _pattern_blocks(shown, shown.inked, part.flat, width_mm)
    if part.tape is not None:
        yield from _tape_blocks(part.tape, width_mm)
    yield from _check_blocks(part, width_mm)
    yield from _finding_blocks(part, width_mm)
    for table in forming_tables(part, width_mm):
        yield from table_blocks(table)


def head_blocks(name: str, about: str, width_mm: float, mark: str) -> Iterator[Block]:
    """Yield the head of a page: a name as large as it can be, what it is about, a mark on the right."""
    room = width_mm - CHIP_MM - 4.0
    fitting = (size for size in NAME_PT if len(wrapped(name, room, size, BOLD)) <= NAME_LINES)
    size = next(fitting, NAME_PT[-1])
    lines = list(line_blocks(name, room, Pen(size, BOLD)))
    high = max(lines[0].height_mm, CHIP_HIGH_MM)
    placed = moved(mark, width_mm - CHIP_MM, -CHIP_HIGH_MM)
    yield Block(high, moved(lines[0].content, 0.0, lines[0].height_mm - high) + placed)
    yield from lines[1:]
    yield space(0.8)
    yield from line_blocks(about, width_mm, Pen(BODY_PT + 0.5, colour=QUIET))
    yield Block(2.4, stroked(INK, 0.4) + rule(0.0, -1.4, width_mm, -1.4))


def chip(reached: str) -> str:
    """Return the verdict, white on its colour, a frame in `CHIP_MM` and `CHIP_HIGH_MM`."""
    words = CLASS_WORDS.get(reached, f"PASSED: {reached.upper()}")
    colour = BAD if reached in REFUSED else GOOD
    size = CHIP_PT
    while width_mm(words, size, BOLD) > CHIP_MM - 4.0:
        size -= 0.5
    up = (CHIP_HIGH_MM - CAPITALS * size * MM_PER_POINT) / 2.0
    return area(0.0, 0.0, CHIP_MM, CHIP_HIGH_MM, colour) + said(
        CHIP_MM / 2.0, up, words, Pen(size, BOLD, PAPER, "middle")
    )


def _about(part: PartEntry, job: JobEntry) -> str:
    """Return how many there are, of what, for whom."""
    pieces = counted(part.quantity, "piece")
    who = [job.customer or "", f"revision {job.revision}" if job.revision else ""]
    return "   \N{MIDDLE DOT}   ".join(word for word in (pieces, _sheet(job), f"job {job.name}", *who) if word)


def _sheet(job: JobEntry) -> str:
    thick = "" if job.material.thickness_mm is None else f"{job.material.thickness_mm:g} mm"
    return " ".join(word for word in (job.material.name, thick) if word)


def _facts(part: PartEntry, job: JobEntry) -> Iterator[tuple[str, str]]:
    """Yield what is to be known of a part, by its name."""
    yield "Material", job.material.name or "not stated"
    yield "Thickness", "not stated" if job.material.thickness_mm is None else f"{job.material.thickness_mm:g} mm"
    if part.flat is not None:
        blank = part.flat.blank
        yield "Blank", f"{millimetres(blank.width)} \N{MULTIPLICATION SIGN} {millimetres(blank.height)} mm"
        yield "Area", square(blank.area)
        yield "Mass", kilograms(part.mass_kg)
        yield "Cut", f"{millimetres(part.cut_length_mm, 'mm')}, {counted(part.pierces, 'pierce')}"
    tolerance, process = job.tolerance, job.process
    if tolerance is not None:
        yield "Class", f"{part.verdict}; accepted up to {tolerance.accept}"
        yield "Tolerances", f"contour {tolerance.chord_mm:g} mm, joins {tolerance.join_mm:g} mm"
    if process is not None:
        kerf = "not stated" if process.kerf_mm is None else f"{process.kerf_mm:g} mm"
        yield "Process", f"{process.type or 'not stated'}, kerf {kerf}, compensation {process.kerf_compensation}"
    worst = next(iter(nearest(part)), None)
    if worst is not None:
        stage, metric = worst
        said_so = f"{plain(metric.value, metric.unit)}, limit {plain(metric.limit, metric.unit)}, {metric.evidence}"
        yield "Nearest to its limit", f"{stage}: {metric.name} {said_so}"


def _facts_block(shown: Shown, job: JobEntry, width_mm: float) -> Block:
    """Return the picture of the formed part beside the facts."""
    left = PICTURE_MM[0] + FACTS_GAP_MM if shown.picture is not None else 0.0
    step = BODY_PT * MM_PER_POINT * LEADING
    content, y = "", -1.0
    for label, fact in _facts(shown.part, job):
        names = wrapped(label, FACT_LABEL_MM - 2.0, BODY_PT)
        lines = wrapped(fact, width_mm - left - FACT_LABEL_MM, BODY_PT)
        for i in range(max(len(names), len(lines))):
            y -= step
            content += said(left, y, names[i], Pen(BODY_PT, colour=QUIET)) if i < len(names) else ""
            content += said(left + FACT_LABEL_MM, y, lines[i], Pen(BODY_PT)) if i < len(lines) else ""
        y -= 1.7
        content += stroked(HAIR, HAIR_MM) + rule(left, y + 0.4, width_mm, y + 0.4)
    high = -y
    if shown.picture is not None:
        high = max(high, PICTURE_MM[1])
        content += moved(shown.picture, 0.0, -PICTURE_MM[1])
    return Block(high, content)


def _pattern_blocks(shown: Shown, inked: Inked, flat: FlatEntry, width_mm: float) -> Iterator[Block]:
    """Yield the whole pattern at a scale that is said."""
    around = AROUND_MM + SIZES_MM
    view = whole_view(inked, width_mm)
    content = drawn_pattern(inked, view, shown.part.tape) + sizes(flat.blank, view)
    title = title_block(f"Flat pattern   {scale_text(view.scale)}", width_mm, _pattern_note(view))
    high = view.size[1] + around + AROUND_MM
    room = width_mm - around - AROUND_MM, view.size[1]
    placed = moved(shifted(content, view, room), around, around - high)
    yield space(3.0)
    yield Block(title.height_mm + high, title.content + moved(placed, 0.0, -title.height_mm))


def whole_view(inked: Inked, width_mm: float) -> View:
    """Return how the whole pattern is shown on the first page."""
    around = AROUND_MM + SIZES_MM
    return best_view(inked, (width_mm - around - AROUND_MM, PATTERN_HIGH_MM - around - AROUND_MM))


def _pattern_note(view: View) -> str:
    turned = ", turned by 90\N{DEGREE SIGN} on this page" if view.turned else ""
    return f"Seen from above, in mm{turned}. Dashed: bend up; dash-dot: bend down; fine: roll."


def _tape_blocks(tape: TapeEntry, width_mm: float) -> Iterator[Block]:
    """Yield what to measure with a tape."""
    if not tape.spans:
        return
    share_mm = width_mm / 5.0
    columns = (
        Column("from \N{EN DASH} to", share_mm),
        Column("what", share_mm),
        Column("along the edge", share_mm, "right", "mm"),
        Column("straight", share_mm, "right", "mm"),
        Column("evidence", share_mm),
    )
    rows = tuple(
        Row((f"{span.first} {DASH} {span.last}", span.what, millimetres(span.along_mm), millimetres(span.straight_mm),
             span.evidence), BOLD if span.along_mm is None else REGULAR)
        for span in tape.spans
    )  # fmt: skip
    yield from table_blocks(Table("Measure on the blank", columns, rows, above_mm=3.0))


def nearest(part: PartEntry) -> Sequence[tuple[str, MetricEntry]]:
    """Return the checks of a part with their stages: failed ones first, then by what they take of their limits."""
    checks = [
        (stage.stage, metric)
        for stage in part.stages
        for metric in stage.metrics
        if metric.limit is not None and (metric.value is not None or not metric.passed)
    ]
    return sorted(checks, key=lambda check: (check[1].passed, -_share(check[1])))


def _share(metric: MetricEntry) -> float:
    """Return what a value takes of its limit; 0 where that is no number or nothing."""
    value, limit = metric.value, metric.limit
    if isinstance(value, bool) or isinstance(limit, bool) or not value or not limit:
        return 0.0
    return float(value) / float(limit)


def _check_blocks(part: PartEntry, width_mm: float) -> Iterator[Block]:
    """Yield the checks that come nearest to their limits."""
    found = nearest(part)
    columns = (
        Column("stage", 22.0),
        Column("check", width_mm - 22.0 - 26.0 - 26.0 - 22.0 - 20.0 - 22.0),
        Column("value", 26.0, "right"),
        Column("limit", 26.0, "right"),
        Column("margin", 22.0, "right"),
        Column("verdict", 20.0),
        Column("evidence", 22.0),
    )
    shown = [check for i, check in enumerate(found) if i < WORST or not check[1].passed]
    rows = tuple(
        Row(
            (stage, one.name, plain(one.value, one.unit), plain(one.limit, one.unit), _margin(one),
             "pass" if one.passed else "FAIL", one.evidence),
            colour=INK if one.passed else BAD,
        )
        for stage, one in shown
    )  # fmt: skip
    more = "" if len(shown) == len(found) else f"The {len(shown)} nearest to their limits; {len(found)} in report.json."
    if rows:
        yield from table_blocks(Table("Checks", columns, rows, more))


def _margin(metric: MetricEntry) -> str:
    return DASH if metric.margin is None else plain(metric.margin, metric.unit)


def _finding_blocks(part: PartEntry, width_mm: float) -> Iterator[Block]:
    """Yield what an engineer must know."""
    found = [(stage.stage, finding) for stage in part.stages for finding in stage.findings]
    columns = (Column("stage", 22.0), Column("finding", width_mm - 22.0))
    rows = tuple(Row((stage, one.message), colour=BAD if one.fatal else INK) for stage, one in found)
    if rows:
        yield from table_blocks(Table("To be known", columns, rows))
