"""Tasks as problems of the search and back: the same motions, the same rules, and what the search may not choose."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely import Polygon

from stages.geometry.curves.rigid import Rigid2
from stages.model.pattern import FlatPattern
from stages.model.sheet import Nesting, NestOptions, Placement, Sheet, SheetLayout
from stages.nest import search
from stages.nest.blank import COARSEST_MM, MITRE_LIMIT, polygon_at
from stages.nest.layout import as_nesting
from stages.nest.legal.certify import certify, passed
from stages.nest.lots import task_of
from stages.nest.search import MANY, Engine, Posed, plan_of, pose, search_plans, spans_of
from stages.nest.sheets import Plan, Task, first_plans
from stages.nest.turns import ANY, Turns, contains
from tests.near import assert_near
from tests.stages.nest.separation.scenes import moved
from tests.stages.nest.shapes import angle_piece, box, contour, disc, pattern, rectangle, ring, sector
from tests.stages.nest.stock import hide, lobed, outline, roll, zone

ROUNDING = 1e-9
"""Coordinates of up to 1e3 mm, turned and moved a few times."""

SHEET = Sheet("s", 400.0, 300.0, edge_gap_mm=5.0)
HIDE = hide(
    "h",
    lobed(300.0, 0.2, 3, x=5000.0, y=-2000.0),
    quantity=3,
    edge_gap=4.0,
    grain_deg=30.0,
    defects=(outline(box(60.0, 40.0, x=4980.0, y=-2000.0)),),
    zones=(zone(box(90.0, 90.0, x=5060.0, y=-2100.0), 2),),
)
GRAINED = angle_piece("angle", 120.0, 40.0, 3).replace(axis_deg=90.0, axis_band_deg=8.0, quality=1)
FREE, LISTED = sector("sector", 60.0, 100.0, 100.0, 3), rectangle("plate", 120.0, 60.0, 3, rotations=(0.0, 90.0))
CORNER = pattern("corner", contour([(0.0, 0.0), (120.0, 0.0), (0.0, 50.0)]), quantity=5)
PAIR = CORNER.replace(part="pair", quantity=4, pair=True)
HOLED = ring("ring", 60.0, 40.0, 2)

CASES: dict[str, tuple[Sequence[FlatPattern], Sequence[Sheet], NestOptions]] = {
    "listed angles": ([LISTED], [SHEET], NestOptions(4.0)),
    "any angle": ([FREE, HOLED], [SHEET], NestOptions(4.0)),
    "turned over": ([FREE, CORNER], [SHEET], NestOptions(4.0, mirror=True)),
    "pairs": ([PAIR], [SHEET], NestOptions(4.0)),
    "a band on a hide": ([GRAINED, FREE], [HIDE], NestOptions(4.0)),
    "one direction": ([GRAINED, CORNER, PAIR], [HIDE], NestOptions(4.0, one_direction=True, mirror=True)),
    "a roll": ([FREE, LISTED], [roll("r", 200.0, edge_gap=5.0)], NestOptions(4.0)),
    "two kinds of stock": ([FREE, LISTED], [SHEET, Sheet("t", 250.0, 200.0, 2)], NestOptions(4.0)),
}


def posed(
    parts: Sequence[FlatPattern], stock: Sequence[Sheet], options: NestOptions, fixed: Nesting | None = None
) -> tuple[Task, Plan, Posed]:
    """A task, its first placement, and both as a problem."""
    task = task_of(parts, stock, options, fixed or Nesting(()))
    first = first_plans(task)[0]
    assert not first.left
    found = pose(task, first, 1.0, 7)
    assert found is not None
    return task, first, found


@cache
def case(name: str) -> tuple[Task, Plan, Posed]:
    """One of the cases, placed and posed once."""
    return posed(*CASES[name])


Motions = list[tuple[int, int, int, bool, float, float, float]]


def motions(plan: Plan) -> Motions:
    """Stock, sheet, part and motion of all that is placed."""
    found = []
    for number, sheet in enumerate(plan.sheets):
        for one in sheet.placed:
            motion, blank = one.motion(sheet.bed), one.turned.blank
            assert motion.mirrored == blank.mirrored
            found.append((sheet.bed.stock, number, blank.part, motion.mirrored, motion.angle_deg, motion.x, motion.y))
    return sorted(found)


@pytest.mark.parametrize("name", CASES)
def test_a_plan_as_spots_and_back_is_the_same_plan(name: str) -> None:
    _, first, found = case(name)
    back = plan_of(found.request.start, found)
    given_, wanted = motions(back), motions(first)
    assert [one[0] for one in given_] == [one[0] for one in wanted]
    assert {one[2:4] for one in given_} == {one[2:4] for one in wanted}
    for one in wanted:
        near = [other for other in given_ if other[2:4] == one[2:4] and abs(other[5] - one[5]) < 1.0]
        away = min(np.abs(np.array(other[4:]) - np.array(one[4:])).max() for other in near)
        assert_near(float(away), 0.0, bound=ROUNDING, why="there and back")
    assert back.left == {}


def shapes_of(found: Posed) -> list[Polygon]:
    """Where the shapes of the problem lie at the start."""
    kinds = found.request.problem.kinds
    return [moved(kinds[one.kind].shape, one.x, one.y, one.angle_deg) for one in found.request.start]


@pytest.mark.parametrize("name", CASES)
def test_every_shape_of_the_problem_covers_its_grown_part_and_little_more(name: str) -> None:
    _, first, found = case(name)
    parts = [polygon_at(one) for sheet in first.sheets for one in sheet.placed]
    for shape, part in zip(shapes_of(found), parts, strict=True):
        assert_near(float(part.difference(shape).area), 0.0, bound=1e-6 * part.length, why="rounding alone")
        assert shape.difference(part).area < COARSEST_MM * part.length, "what the exact box cuts off, if anything"


def test_what_is_only_turned_by_quarters_has_the_exact_box() -> None:
    quarters = NestOptions(4.0, rotations=(0.0, 90.0, 180.0, 270.0))
    _, first, found = posed([FREE, CORNER, HOLED], [SHEET], quarters)
    boxes = [polygon_at(one).bounds for sheet in first.sheets for one in sheet.placed]
    wanted = [shape.bounds for shape in shapes_of(found)]
    assert_near(wanted, boxes, bound=ROUNDING, why="two ways to turn and move")


@pytest.mark.parametrize("name", ["a band on a hide", "one direction"])
def test_every_part_starts_in_the_region_of_its_class(name: str) -> None:
    _, _, found = case(name)
    problem = found.request.problem
    beyond = (MITRE_LIMIT - 1.0) * found.hands[0].blank.grow_mm + COARSEST_MM
    for spot, shape in zip(found.request.start, shapes_of(found), strict=True):
        number = problem.kinds[spot.kind].regions[spot.bin]
        assert number >= 0
        assert problem.regions[number].buffer(beyond).contains(shape)


@pytest.mark.parametrize("name", CASES)
def test_the_problem_has_every_copy_once_and_starts_from_the_plan(name: str) -> None:
    task, first, found = case(name)
    problem = found.request.problem
    parts = [found.hands[item.kind].blank.part for item in problem.items]
    assert {part: parts.count(part) for part in set(parts)} == {k: v for k, v in task.counts.items() if v}
    assert found.request.settled
    assert found.request.seed == 7
    assert problem.bins[: len(first.sheets)] == tuple(
        (sheet.bed.width_mm, sheet.bed.height_mm) for sheet in first.sheets
    )
    for item, spot in zip(problem.items, found.request.start, strict=True):
        assert spot.kind == item.kind
        assert not item.fixed
        assert found.hands[item.other].blank.part == found.hands[item.kind].blank.part


def test_a_copy_that_may_be_turned_over_has_its_other_hand_and_one_of_a_pair_has_not() -> None:
    *_, both = case("turned over")
    hands = both.hands
    assert {(hands[i.kind].blank.mirrored, hands[i.other].blank.mirrored) for i in both.request.problem.items} <= {
        (False, True), (True, False), (False, False),
    }  # fmt: skip
    assert any(item.kind != item.other for item in both.request.problem.items)
    *_, pair = case("pairs")
    assert all(item.kind == item.other for item in pair.request.problem.items)
    assert (
        sorted(pair.hands[item.kind].blank.mirrored for item in pair.request.problem.items) == [False] * 2 + [True] * 2
    )


def test_parts_and_qualities_have_the_regions_of_their_class() -> None:
    *_, found = posed([FREE, GRAINED, FREE.replace(part="any", quality="any")], [HIDE], NestOptions(4.0))
    best, first, any_ = (found.request.problem.kinds[k].regions[0] for k in range(3))
    assert first == any_ != best, "a zone of quality 2 is good enough for quality 1"
    regions = found.request.problem.regions
    assert regions[any_].area > regions[best].area
    assert len(regions) == 2, "each once, however many sheets there are"
    assert found.request.rectangle == (False,) * len(found.beds)


@given(st.lists(st.floats(0.0, 359.0), min_size=1, max_size=4, unique=True), st.integers(-1, 1))
def test_a_listed_angle_comes_back_exactly(listed: list[float], turns: int) -> None:
    apart = sorted(listed)
    for angle in apart:
        near = [one for one in apart if one == angle or abs(one - angle) > 1e-6]
        back = float(np.degrees(np.radians(angle))) + 360.0 * turns
        assert search._exact(back, Turns(tuple((one, one) for one in near))) == angle


@given(st.floats(0.0, 359.99), st.floats(0.0, 80.0), st.floats(0.0, 1.0), st.sampled_from([-1e-13, 0.0, 1e-13]))
def test_an_angle_of_a_span_stays_in_it(low: float, width: float, share: float, rounding: float) -> None:
    turns = Turns(((low, low + width),))
    angle = low + share * width + rounding
    back = search._exact(angle, turns)
    assert contains(turns, back)
    assert 0.0 <= back < 360.0 or width == 0.0
    assert_near((back - angle + 180.0) % 360.0, 180.0, bound=1e-9, why="rounding, or the end of the span")


@given(st.floats(-720.0, 720.0))
def test_any_angle_stays_as_it_is_up_to_whole_turns(angle: float) -> None:
    back = search._exact(angle, ANY)
    assert 0.0 <= back < 360.0
    assert_near((back - angle + 180.0) % 360.0, 180.0, bound=1e-9, why="the remainder of a division")


def test_any_angle_is_one_whole_turn() -> None:
    assert spans_of(ANY) == ((0.0, 360.0),)
    assert spans_of(Turns(())) == ()


def test_what_is_fixed_stays_and_comes_back_as_it_was_given() -> None:
    motion = Rigid2(123.456, 77.7, 90.0)
    held = Nesting((SheetLayout(SHEET, 1, (Placement("plate", 1, motion, fixed=True),), 0.1),))
    _, first, found = posed([LISTED, FREE], [SHEET], NestOptions(4.0), held)
    assert [item.fixed for item in found.request.problem.items].count(True) == 1
    index = [item.fixed for item in found.request.problem.items].index(True)
    spots = list(found.request.start)
    spots[index] = replace(spots[index], x=0.0, y=0.0)
    plan = plan_of(spots, found)
    kept = [one for sheet in plan.sheets for one in sheet.placed if one.given is not None]
    assert [one.motion(first.sheets[0].bed) for one in kept] == [motion]


def test_copies_without_a_place_lie_nowhere_at_first() -> None:
    task = task_of([rectangle("a", 300.0, 250.0, 3)], [replace(SHEET, quantity=2)], NestOptions(4.0), Nesting(()))
    first = first_plans(task)[0]
    assert first.left == {0: 1}
    found = pose(task, first, 1.0, 0)
    assert found is not None
    assert not found.request.settled
    assert [spot.bin for spot in found.request.start] == [0, 1, -1]


def test_there_is_nothing_to_search_for_without_copies_or_with_too_many() -> None:
    none = task_of([rectangle("a", 10.0, 10.0, 0)], [SHEET], NestOptions(), Nesting(()))
    assert pose(none, Plan((), {}), 1.0, 0) is None
    many = task_of([rectangle("a", 1.0, 1.0, MANY + 1)], [SHEET], NestOptions(), Nesting(()))
    assert pose(many, Plan((), {0: MANY + 1}), 1.0, 0) is None
    assert search_plans(many, Plan((), {0: MANY + 1}), 1.0, engine := Engine(0)) == []
    assert engine.runs == 0


def test_the_emptiest_sheet_comes_last_and_an_empty_one_not_at_all() -> None:
    part = rectangle("a", 390.0, 40.0, 6, rotations=(0.0,))
    _, first, found = posed([part, rectangle("b", 390.0, 250.0, 2)], [SHEET], NestOptions())
    assert len(first.sheets) > 1
    low = [replace(spot, bin=1) for spot in found.request.start]
    assert len(plan_of(low, found).sheets) == 1
    width = [search.used_mm(sheet) for sheet in plan_of(found.request.start, found).sheets]
    assert width == sorted(width, reverse=True)


def angles_by_hand(found: Posed) -> dict[int, set[tuple[tuple[float, float], ...]]]:
    """The spans of each kind over all bins in which it may lie."""
    return {k: {spans for spans in kind.spans if spans} for k, kind in enumerate(found.request.problem.kinds)}


def test_in_one_direction_every_hand_has_one_angle() -> None:
    *_, found = case("one direction")
    used = {spot.kind for spot in found.request.start}
    by_hand = angles_by_hand(found)
    assert len(by_hand) > len(used), "one hand is not in the first placement, and is bound as well"
    for spans in by_hand.values():
        assert len(spans) == 1
        ((low, high),) = spans.pop()
        assert low == high


def test_in_one_direction_no_part_goes_against_the_grain_of_another_sheet() -> None:
    grained = rectangle("a", 250.0, 200.0, 3).replace(axis_deg=0.0, axis_band_deg=0.0)
    stock = [replace(SHEET, grain_deg=0.0, quantity=1), replace(SHEET, id="across", grain_deg=90.0)]
    task, _, found = posed([grained], stock, NestOptions(4.0, one_direction=True))
    for spans, bed in zip(found.request.problem.kinds[0].spans, found.beds, strict=True):
        turns = task.kinds[0].allowed(bed, found.hands[0].blank)
        assert all(contains(turns, low) and contains(turns, high) for low, high in spans)


@pytest.mark.parametrize("name", ["turned over", "pairs", "a band on a hide", "one direction"])
def test_what_the_search_finds_from_nothing_passes_the_certifier(name: str) -> None:
    parts, stock, options = CASES[name]
    task, _, _ = case(name)
    engine, nothing = Engine(3), Plan((), dict(task.counts))
    found = (search_plans(task, nothing, seconds, engine) for seconds in (0.6, 2.0, 6.0))
    plans = next((plans for plans in found if plans), [])
    assert engine.failures == []
    assert plans
    for plan in plans:
        assert passed(*certify(as_nesting(plan, parts, options), parts, stock, options))


def test_a_spot_far_away_is_a_plan_that_is_far_away_and_no_trouble() -> None:
    _, _, found = case("any angle")
    far = [replace(spot, x=1e9) for spot in found.request.start]
    assert all(one.x > 1e8 for sheet in plan_of(far, found).sheets for one in sheet.placed)


def test_small_and_large_parts_are_posed_alike() -> None:
    _, first, found = posed([disc("d", 0.5, 2), disc("D", 140.0, 3)], [SHEET], NestOptions(0.1))
    assert motions(plan_of(found.request.start, found)) == [pytest.approx(one, abs=ROUNDING) for one in motions(first)]
