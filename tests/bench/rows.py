"""One figure of the benchmark, and what a topic is asked for."""

import re
from collections.abc import Callable, Iterator
from typing import Literal, NamedTuple

Extent = Literal["quick", "usual", "full"]
"""quick: small sizes, which show that all of it works; full: sizes that take 25 minutes."""


class Asked(NamedTuple):
    """How much is measured; seconds: for each nesting engine on each instance."""

    extent: Extent = "usual"
    seconds: float = 20.0

    @property
    def rounds(self) -> int:
        """Runs of which the median counts, where a run is short."""
        return 1 if self.extent == "quick" else 5


class Row(NamedTuple):
    """What a program reached: `figure` in `unit`, or seconds alone; memory: what it took at its peak.

    how: of how many runs, or why there is no figure.
    """

    what: str
    size: str
    program: str
    version: str
    figure: float | None = None
    unit: str = ""
    seconds: float | None = None
    memory_mb: float | None = None
    how: str = ""


Rows = Callable[[Asked], Iterator[Row]]


class Section(NamedTuple):
    """The rows of a topic; failed: the last line of what ended it."""

    name: str
    about: str
    rows: tuple[Row, ...]
    failed: str = ""


def identity(section: str, row: Row) -> str:
    """Return the name by which a text refers to a row: the same from run to run and from version to version."""
    return "-".join(re.findall(r"[a-z0-9.]+", f"{section} {row.what} {row.size} {row.program}".lower()))
