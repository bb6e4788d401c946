"""How much of a roll a layout uses."""

import math

from stages.geometry.curves.rigid import Rigid2
from stages.model.sheet import Placement, Sheet, SheetLayout
from stages.model.used import used_length_mm
from tests.near import assert_near
from tests.stages.nest.shapes import disc, rectangle

PARTS = {"bar": rectangle("bar", 100.0, 20.0), "disc": disc("disc", 30.0)}
ROLL = Sheet("roll", math.inf, 500.0, edge_gap_mm=7.0, kind="roll")


def used(sheet: Sheet, *placed: Placement) -> float:
    return used_length_mm(SheetLayout(sheet, 1, placed, 0.0), PARTS)


def test_a_roll_is_used_up_to_its_furthest_part_and_the_edge_gap() -> None:
    bar, round_one = Placement("bar", 1, Rigid2(10.0, 10.0)), Placement("disc", 1, Rigid2(300.0, 100.0))
    assert used(ROLL, bar) == 117.0
    assert_near(used(ROLL, bar, round_one), 337.0, bound=1e-12, why="the disc's rightmost point")


def test_a_turned_part_counts_as_it_lies() -> None:
    upright = Placement("bar", 1, Rigid2(50.0, 10.0, 90.0))
    assert_near(used(ROLL, upright), 57.0, bound=1e-12, why="its left edge at 30, its right one at 50")


def test_a_sheet_is_used_whole_and_of_an_empty_roll_nothing_but_the_gap() -> None:
    assert used(Sheet("s", 1000.0, 500.0), Placement("bar", 1, Rigid2())) == 1000.0
    assert used(ROLL) == 7.0
