"""Lines for the engineer as they stand below a picture: broken where the column ends, and in two columns."""

import textwrap
from collections.abc import Sequence

from pipeline.report.pictures.canvas import ELLIPSIS

INDENT = "    "
"""Before what goes on of a line that was broken."""


def wrapped(lines: Sequence[str], signs: int, most: int) -> list[str]:
    """Return the lines broken at `signs`, at most `most` of them, the last one saying what is left out."""
    broken = [part for line in lines for part in textwrap.wrap(line.strip(), signs, subsequent_indent=INDENT) or [""]]
    if len(broken) <= most:
        return broken
    return [*broken[: most - 1], f"{ELLIPSIS} and {len(broken) - most + 1} more lines: see the report"]


def in_columns(lines: Sequence[str]) -> tuple[Sequence[str], Sequence[str]]:
    """Return wrapped lines in two columns, as even as may be: none goes on in the other column."""
    ends = [i for i, line in enumerate(lines) if i and not line.startswith(INDENT)]
    cut = min((*ends, len(lines)), key=lambda end: (max(end, len(lines) - end), -end))
    return lines[:cut], lines[cut:]
