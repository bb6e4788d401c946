"""Which sheets the search is offered: those of the first placement, and others as far as there are any."""

import numpy as np

from stages.model.sheet import Nesting, NestOptions, Sheet
from stages.nest.blank import Placed
from stages.nest.lots import task_of
from stages.nest.search import MOST_BINS, bins_for, plan_of, pose
from stages.nest.sheets import Filled, Plan
from tests.near import assert_near
from tests.stages.nest.shapes import rectangle
from tests.stages.nest.stock import roll
from tests.stages.nest.test_search import ROUNDING, SHEET, motions, posed


def test_one_kind_of_sheet_is_offered_as_often_as_the_plan_has_it() -> None:
    task, first, found = posed([rectangle("a", 250.0, 200.0, 5)], [SHEET], NestOptions(4.0))
    assert len(first.sheets) > 1
    assert found.beds == [sheet.bed for sheet in first.sheets]
    assert bins_for(task, first) == list(found.beds)


def test_other_kinds_of_sheets_are_offered_as_far_as_there_are_any() -> None:
    small, large = Sheet("small", 300.0, 250.0), Sheet("large", 500.0, 400.0, 2)
    task, first, found = posed([rectangle("a", 250.0, 200.0, 3)], [small, large], NestOptions(4.0))
    ids = [bed.sheet.id for bed in found.beds]
    assert ids[: len(first.sheets)] == [sheet.bed.sheet.id for sheet in first.sheets]
    assert ids.count("small") == len(first.sheets) + 1, "as many as needed, and so one more than there are now"
    assert ids.count("large") == 2, "no more than there are"
    assert bins_for(task, first) == list(found.beds)


def test_a_roll_is_offered_once() -> None:
    _, _, found = posed([rectangle("a", 150.0, 100.0, 3)], [roll("r", 200.0), SHEET], NestOptions(4.0))
    assert sum(bed.sheet.is_roll for bed in found.beds) == 1


def test_sheets_of_a_plan_are_never_left_out_of_the_problem() -> None:
    count = MOST_BINS + 5
    task = task_of([rectangle("a", 390.0, 290.0, count, rotations=(0.0,))], [SHEET], NestOptions(), Nesting(()))
    one = Placed(task.kinds[0].on(task.beds[0])[0], 0.0, 0.0)
    first = Plan((Filled(task.beds[0], (one,)),) * count, {})
    found = pose(task, first, 1.0, 0)
    assert found is not None
    assert len(found.request.problem.items) == count
    assert [spot.bin for spot in found.request.start] == list(range(count))
    back = np.array(motions(plan_of(found.request.start, found)))
    assert_near(back, np.array(motions(first)), bound=ROUNDING, why="there and back")


def test_sheets_without_room_are_not_offered() -> None:
    """Their box would be of negative sides, and so of an area above 0."""
    cramped = Sheet("cramped", 100.0, 100.0, edge_gap_mm=80.0)
    task, first, found = posed([rectangle("a", 250.0, 200.0, 5)], [SHEET, cramped], NestOptions(4.0))
    assert {bed.sheet.id for bed in found.beds} == {SHEET.id}
    assert bins_for(task, first) == list(found.beds)
