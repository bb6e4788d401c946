"""The bend table and the roll schedule on paper: what has no number is said as what it is."""

from types import SimpleNamespace
from typing import cast

import pytest

from pipeline.report.shopentries import DetailEntry, PartEntry
from pipeline.report.traveller.flow import Table
from pipeline.report.traveller.forming import forming_tables
from pipeline.sidelines import Radii, RollRow

SHARP = "too sharp for a tool there"


def schedule(radius: Radii, tool: Radii | None, note: str | None = None) -> Table:
    row = RollRow(0.5, 12.0, "up", radius, (0.0, 0.0), (1.0, 0.0), tool_radius_mm=tool, note=note)
    part = SimpleNamespace(stages=(SimpleNamespace(detail=DetailEntry(rolls=(row,))),), flat=None)
    (table,) = forming_tables(cast(PartEntry, part), 180.0)
    return table


@pytest.mark.parametrize(
    ("radius", "tool", "words"),
    [
        ((100.0, 200.0), (90.0, 170.0), "90.00 / 170.0"),
        ((100.0, 100.0), (90.0, 90.0), "90.00"),
        ((None, 155.0), (None, 109.0), "flat / 109.0"),
        ((None, None), (None, None), "flat"),
        ((0.0, 155.0), (None, 109.0), "– / 109.0"),
        ((0.0, 155.0), None, "–"),
    ],
)
def test_an_end_is_rolled_flat_only_where_the_part_is_flat(radius: Radii, tool: Radii | None, words: str) -> None:
    (row,) = schedule(radius, tool).rows
    assert row.cells[4] == words


def test_what_is_too_sharp_to_be_rolled_is_told_below_the_schedule() -> None:
    assert schedule((0.0, 155.0), (None, 109.0), SHARP).note.endswith(" Too sharp for a tool there.")
    assert "harp" not in schedule((100.0, 155.0), (90.0, 109.0)).note
