"""The sections of the benchmark as a text of columns and as Markdown, under where, when and of what they are."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from tests.bench.rows import Row, Section, identity

HEADS = ("what", "size", "program", "figure", "time", "memory", "how")
NUMBERS = {"figure", "time", "memory"}
TENS, LARGE = 10.0, 1000.0
"""From these on figures are shown with four digits, and without places after the point."""
FAR = 1e6
"""From here on with an exponent, if they are not whole."""

LONGER = "## Longer runs"
"""Over the rows of a page that a run of the benchmark leaves as they are."""


class Heading(NamedTuple):
    """Where and when a run was made."""

    date: str
    machine: str
    load: str
    versions: str
    extent: str
    minutes: float = 0.0


def number(value: float) -> str:
    """Return a figure with three digits, four from 10 on, a whole number with all of them."""
    if value == round(value) and abs(value) < FAR:
        return str(round(value))
    if LARGE <= abs(value) < FAR:
        return f"{value:.0f}"
    return f"{value:.4g}" if abs(value) >= TENS else f"{value:.3g}"


def duration(seconds: float | None) -> str:
    """Return a time in s or ms."""
    if seconds is None:
        return ""
    return f"{number(seconds)} s" if seconds >= 1.0 else f"{seconds * 1e3:.3g} ms"


def cells(row: Row) -> tuple[str, ...]:
    """Return a row as texts, in the order of the heads."""
    figure = "" if row.figure is None else f"{number(row.figure)} {row.unit}".strip()
    memory = "" if row.memory_mb is None else f"{max(row.memory_mb, 0.0):.0f} MB"
    program = f"{row.program} {row.version}".strip()
    return row.what, row.size, program, figure, duration(row.seconds), memory, row.how


def as_text(heading: Heading, sections: Sequence[Section]) -> str:
    """Return all sections in columns."""
    blocks = (f"{one.name}: {one.about}\n{_columns(one)}" for one in sections)
    return "\n\n".join(["\n".join(_told(heading)), *blocks])


def _columns(section: Section) -> str:
    """Return the rows of a section under their heads."""
    lines = [HEADS, *map(cells, section.rows)]
    widths = [max(len(line[k]) for line in lines) for k in range(len(HEADS))]
    made = [
        "  ".join(
            cell.rjust(width) if head in NUMBERS else cell.ljust(width)
            for head, cell, width in zip(HEADS, line, widths, strict=True)
        ).rstrip()
        for line in lines
    ]
    return "\n".join([*made, *([f"FAILED: {section.failed}"] if section.failed else [])])


def as_markdown(heading: Heading, sections: Sequence[Section]) -> str:
    """Return the page of all sections; every row has an anchor, by which other pages refer to it."""
    return "\n".join(["# Benchmarks", "", *_told(heading), "", *(line for one in sections for line in _section(one))])


def longer(page: str) -> str:
    """Return the end of a page that holds what other commands measured; nothing where it has none."""
    _, mark, rest = page.partition(f"\n{LONGER}\n")
    return f"{mark}{rest}"


def _section(section: Section) -> Iterable[str]:
    """Yield the lines of a section."""
    yield from (f"## {section.name}", "", section.about, "")
    yield f"| {' | '.join(HEADS)} |"
    yield f"|{'|'.join('---:' if head in NUMBERS else '---' for head in HEADS)}|"
    for row in section.rows:
        what, *rest = (cell.replace("|", r"\|") for cell in cells(row))
        yield f'| <a id="{identity(section.name, row)}"></a>{what} | {" | ".join(rest)} |'
    yield from ("", f"FAILED: {section.failed}", "") if section.failed else ("",)


def _told(heading: Heading) -> list[str]:
    """Return the lines over everything."""
    return [
        f"{heading.date}, {heading.machine}, {heading.load}.  {heading.extent}, {heading.minutes:.0f} minutes.",
        heading.versions,
    ]
