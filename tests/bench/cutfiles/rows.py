"""A row of the table, and the table."""

from collections.abc import Sequence
from typing import Literal, NamedTuple

Evidence = Literal["proved", "sampled"]


class Row(NamedTuple):
    """A measure: its goal, what was reached, whether that is right, how it was found, and where the worst of it is."""

    measure: str
    what: str
    goal: str
    reached: str
    right: bool
    evidence: Evidence
    how: str
    where: str = ""


class Worst(NamedTuple):
    """The largest of some figures, and where it was found."""

    value: float = 0.0
    where: str = ""


def worst(found: Sequence[Worst]) -> Worst:
    """Return the largest; 0 where there is nothing to be measured."""
    return max(found, key=lambda one: one.value, default=Worst(0.0, "nothing to be measured"))


def limited(measure: str, what: str, limit: tuple[float, str], found: Sequence[Worst], how: str) -> Row:
    """Return the row of a figure that may not be above a limit, which has a unit, sampled where `how` says."""
    most, (value, unit) = worst(found), limit
    goal, reached = f"<= {value:g} {unit}".rstrip(), f"{most.value:.3g} {unit}".rstrip()
    right = bool(found) and most.value <= value
    return Row(measure, what, goal, f"{reached} ({len(found)} looked at)", right, "sampled", how, most.where)


def counted(measure: str, what: str, wrong: Sequence[str], total: int, how: str) -> Row:
    """Return the row of what must be right everywhere, every one of them looked at."""
    reached = f"{total - len(wrong)} of {total}"
    return Row(measure, what, "all", reached, bool(total) and not wrong, "proved", how, "; ".join(wrong[:MOST_TOLD]))


MOST_TOLD = 3
HEADS = ("measure", "goal", "reached", "", "evidence", "how", "worst")


def line(cells: Sequence[str]) -> str:
    """Return a line of a table in Markdown."""
    return f"| {' | '.join(cells)} |"


def head() -> str:
    """Return the first two lines of the table."""
    return f"{line(HEADS)}\n{line(('---',) * len(HEADS))}"


def shown(row: Row) -> str:
    """Return the line of a row."""
    return line((f"{row.measure} {row.what}", row.goal, row.reached, "yes" if row.right else "NO", *row[-3:]))
