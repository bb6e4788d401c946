"""Random surfaces that follow from one curve: made, unrolled to rounding, and the same whichever way they are given."""

from collections.abc import Callable
from fractions import Fraction

import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from stages.model.tolerances import Tolerances
from tests.admissible import ADMISSIBLE, carried, grown, turned_back
from tests.near import assert_relative
from tests.parts import Passage, Table, passage
from tests.strategies import motions, scales

KIND = pytest.mark.parametrize("kind", ADMISSIBLE)
AGAIN = settings(max_examples=2, deadline=None, derandomize=True, phases=[Phase.explicit, Phase.generate])
"""A part takes seconds: no hours of shrinking."""


def made_of(table: Table, factor: float = 1.0) -> Passage:
    """Return the part, its arcs within 1/1000 of what is 1 in the table: the parts are thin."""
    made = passage(table, Tolerances(chord_mm=1e-3 * factor))
    assert made.refused_by is None, [f.message for report in made.reports.values() for f in report.findings]
    assert made.reports["verify"].detail["class"] == "exact"
    assert made.value("unroll", "metric_error") <= 1e-11
    return made


def same(made: Passage, other: Passage, factor: float, *, bound: float, why: str, back: bool = False) -> None:
    """Compare the flat figures; those of the surface agree with them by the metric error."""
    a, b = made.side("flat"), other.side("flat")
    assert_relative(b["area"], a["area"] * factor**2, bound=bound, why=why)  # type: ignore[operator]
    left, right = a["edges"], b["edges"]
    assert isinstance(left, dict) and isinstance(right, dict)
    ends = ("end", "start") if back else ("start", "end")
    assert_relative(
        [right[key] for key in ends], [left[key] * factor for key in ("start", "end")], bound=bound, why=why
    )
    sides = [sorted([found["c0"], found["c1"]]) for found in (left, right)]
    assert_relative(sides[1], [x * factor for x in sides[0]], bound=bound, why=why)


def property_of(kind: str, check: Callable[[Table, Passage, st.DataObject], None]) -> None:
    """Run a check on random tables of a kind."""

    @AGAIN
    @given(ADMISSIBLE[kind], st.data())
    def run(table: Table, data: st.DataObject) -> None:
        check(table, made_of(table), data)

    run()


@KIND
def test_a_moved_part_has_the_same_pattern(kind: str) -> None:
    def check(table: Table, made: Passage, data: st.DataObject) -> None:
        there = made_of(carried(table, data.draw(motions())))
        same(made, there, 1.0, bound=1e-9, why="coordinates up to 1000 for a part of 1 to 10, derivatives of them")

    property_of(kind, check)


@KIND
def test_a_larger_part_has_a_larger_pattern(kind: str) -> None:
    def check(table: Table, made: Passage, data: st.DataObject) -> None:
        factor = data.draw(scales())
        same(
            made,
            made_of(grown(table, factor), float(Fraction(factor))),
            float(Fraction(factor)),
            bound=1e-11,
            why="decimals rounded once",
        )

    property_of(kind, check)


@KIND
def test_a_part_given_from_its_other_end_is_the_same_part(kind: str) -> None:
    def check(table: Table, made: Passage, data: st.DataObject) -> None:
        same(made, made_of(turned_back(table)), 1.0, bound=1e-11, why="one surface", back=True)

    property_of(kind, check)
