"""A comparison of two runs as a table for the terminal: values in full, differences to three digits."""

import json
import re
from collections.abc import Iterator, Sequence

from pipeline.report.comparison import Change, Comparison, Said

HEAD = ("part", "stage", "metric", "A", "B", "B - A", "unit", "verdict")
RIGHT = frozenset({"A", "B", "B - A"})
CONTROL = re.compile(r"[\x00-\x1f\x7f-\x9f]")
"""What a terminal would obey and not show."""

LONGEST = 32
"""Of a text in the table; the document holds all of it."""


def comparison_lines(found: Comparison) -> list[str]:
    """Return what changed, line by line; one line that says so where nothing did."""
    if found.same:
        return ["nothing changed"]
    lines = [f"part added: {shown(name)}" for name in found.added]
    lines += [f"  with a check that fails: {shown(name)}" for name in found.spoilt]
    lines += [f"part removed: {shown(name)}" for name in found.removed]
    lines += _table([HEAD, *map(_cells, found.changes)]) if found.changes else []
    lines += [f"drawing {change}: {shown(path)}" for path, change in found.files]
    return [*lines, *_summary(found)]


def _summary(found: Comparison) -> Iterator[str]:
    """Yield how much changed, and in which sense."""
    worse = sum(change.verdict == "worse" for change in found.changes) + len(found.spoilt)
    better = sum(change.verdict == "better" for change in found.changes)
    yield f"{len(found.changes)} changed, {worse} worse, {better} better"


def _cells(change: Change) -> tuple[str, ...]:
    a = "-" if change.present == "b" else _said(change.a)
    b = "-" if change.present == "a" else _said(change.b)
    difference = "" if change.difference is None else f"{change.difference:+.3g}"
    limits = change.limits
    verdict: list[str] = [change.verdict] if change.verdict else []
    if change.present == "both" and limits[0] != limits[1]:
        verdict.append(f"limit {_said(limits[0])} -> {_said(limits[1])}")
    return (*map(shown, (change.part, change.stage, change.metric)), a, b, difference, change.unit, ", ".join(verdict))


def _said(value: Said) -> str:
    """Return a number in full, the beginning of a text."""
    if value is None:
        return "none"
    if not isinstance(value, str):
        return json.dumps(value)
    return shown(value) if len(value) <= LONGEST else f"{shown(value[: LONGEST - 1])}\u2026"


def shown(text: str) -> str:
    """Return a text that a terminal shows as it is."""
    return CONTROL.sub(lambda found: f"\\x{ord(found[0]):02x}", text)


def _table(table: Sequence[tuple[str, ...]]) -> list[str]:
    """Return rows in columns: texts to the left, numbers to the right."""
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    return ["  ".join(_padded(row, widths)).rstrip() for row in table]


def _padded(row: Sequence[str], widths: Sequence[int]) -> Iterator[str]:
    for head, cell, width in zip(HEAD, row, widths, strict=True):
        yield cell.rjust(width) if head in RIGHT else cell.ljust(width)
