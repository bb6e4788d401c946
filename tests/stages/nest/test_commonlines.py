"""Neighbours moved together: grids by closed forms, what must not move, and that the certifier has the last word."""

from dataclasses import replace

import pytest

from stages.geometry.curves.rigid import Rigid2
from stages.model.pattern import FlatPattern
from stages.model.sheet import Nesting, NestOptions, Placement, Sheet, SheetLayout
from stages.model.tolerances import Tolerances
from stages.nest import nest
from stages.nest.commonlines import aligned, common_line
from stages.nest.finish import finished
from stages.nest.legal.certify import certify, passed
from tests.near import assert_near
from tests.stages.nest.shapes import contour, disc, pattern, rectangle, ring

KERF_MM, GAP_MM = 0.15, 2.0
OPTIONS = NestOptions(gap_mm=GAP_MM, common_line=True, kerf_mm=KERF_MM)
SHEET = Sheet("sheet", 600.0, 400.0, edge_gap_mm=5.0)
ROUNDING = 1e-9
"""Coordinates of up to 1e3 mm, moved some ten times."""

Placed = tuple[str, float, float]


def laid(*placed: Placed, sheet: Sheet = SHEET) -> Nesting:
    copies: dict[str, int] = {}
    places = []
    for part, x, y in placed:
        copies[part] = copies.get(part, 0) + 1
        places.append(Placement(part, copies[part], Rigid2(x, y)))
    return Nesting((SheetLayout(sheet, 1, tuple(places), 0.5),))


def grid(columns: int, rows: int) -> Nesting:
    return laid(*(("a", 5.0 + 52.0 * i, 5.0 + 32.0 * j) for i in range(columns) for j in range(rows)))


def places(nesting: Nesting) -> list[tuple[float, float]]:
    return [(one.motion.x, one.motion.y) for layout in nesting.layouts for one in layout.placements]


def is_legal(nesting: Nesting, *patterns: FlatPattern, options: NestOptions = OPTIONS) -> bool:
    return passed(*certify(nesting, patterns, [layout.sheet for layout in nesting.layouts], options))


def test_a_grid_closes_up_to_the_kerf_in_both_directions() -> None:
    part = rectangle("a", 50.0, 30.0, 12)
    made = aligned(grid(4, 3), [part], OPTIONS)
    wanted = [(5.0 + 50.15 * i, 5.0 + 30.15 * j) for i in range(4) for j in range(3)]
    assert_near(places(made), wanted, bound=ROUNDING, why="closed form")
    shared = common_line(made, [part], OPTIONS).value
    assert_near(float(shared or 0.0), 3 * 3 * 30.0 + 4 * 2 * 50.0, bound=ROUNDING, why="all inner sides")
    assert is_legal(made, part)


def test_the_same_layout_without_the_wish_is_illegal() -> None:
    part = rectangle("a", 50.0, 30.0, 12)
    made = aligned(grid(4, 3), [part], OPTIONS)
    assert not is_legal(made, part, options=replace(OPTIONS, common_line=False))


def test_moving_together_twice_changes_nothing() -> None:
    part = rectangle("a", 50.0, 30.0, 6)
    once = aligned(grid(3, 2), [part], OPTIONS)
    assert places(aligned(once, [part], OPTIONS)) == places(once)


def test_fixed_and_held_copies_stay_and_others_come_to_them() -> None:
    part = rectangle("a", 50.0, 30.0, 2)
    nesting = laid(("a", 5.0, 5.0), ("a", 57.0, 5.0))
    layout = nesting.layouts[0]
    fixed = tuple(replace(one, fixed=one.copy == 2) for one in layout.placements)
    for made in (
        aligned(Nesting((replace(layout, placements=fixed),)), [part], OPTIONS),
        aligned(nesting, [part], OPTIONS, {("a", 2)}),
    ):
        assert_near(places(made), [(57.0 - 50.15, 5.0), (57.0, 5.0)], bound=ROUNDING, why="the first one moves")
    assert places(aligned(nesting, [part], OPTIONS, {("a", 1), ("a", 2)})) == places(nesting)


def test_a_stored_layout_comes_out_as_it_went_in() -> None:
    part = rectangle("a", 50.0, 30.0, 6)
    first = next(iter(finished(grid(3, 2), [part], OPTIONS)))
    again = next(iter(finished(first.nesting, [part], OPTIONS, first.nesting)))
    assert again.nesting.layouts[0].placements == first.nesting.layouts[0].placements
    assert [metric.value for metric in again.metrics] == [metric.value for metric in first.metrics]


def test_edges_too_short_or_too_far_apart_are_left_alone() -> None:
    small = rectangle("a", 50.0, 19.0, 2)
    apart = laid(("a", 5.0, 5.0), ("a", 57.0, 5.0))
    assert places(aligned(apart, [small], OPTIONS)) == places(apart)
    large = rectangle("a", 50.0, 30.0, 2)
    far = laid(("a", 5.0, 5.0), ("a", 75.0, 5.0))
    assert places(aligned(far, [large], OPTIONS)) == places(far)


def test_a_move_that_would_bring_others_too_near_is_not_made() -> None:
    """The right panel cannot come nearer for the disc beside its upper half, nor can the left one, which is held."""
    parts = [rectangle("a", 50.0, 60.0, 2), disc("d", 10.0, 1)]
    left = rectangle("b", 50.0, 30.0, 1)
    nesting = laid(("b", 5.0, 5.0), ("a", 65.0, 5.0), ("d", 53.0 - 0.1, 52.0), sheet=SHEET)
    made = aligned(nesting, [*parts, left], OPTIONS, {("b", 1), ("d", 1)})
    assert places(made) == places(nesting)
    without = aligned(laid(("b", 5.0, 5.0), ("a", 65.0, 5.0)), [*parts, left], OPTIONS, {("b", 1)})
    assert_near(places(without), [(5.0, 5.0), (55.15, 5.0)], bound=ROUNDING, why="nothing in the way")
    free = aligned(nesting, [*parts, left], OPTIONS, {("b", 1)})
    assert is_legal(free, left.replace(quantity=1), parts[0].replace(quantity=1), parts[1])


def test_what_lies_in_a_hole_moves_with_the_part_around_it() -> None:
    frame = pattern(
        "f",
        contour([(0.0, 0.0), (60.0, 0.0), (60.0, 60.0), (0.0, 60.0)]),
        contour([(10.0, 10.0), (50.0, 10.0), (50.0, 50.0), (10.0, 50.0)], hole=True),
    )
    parts = [frame, disc("d", 15.0, 1), rectangle("a", 50.0, 60.0, 1)]
    made = aligned(laid(("a", 5.0, 5.0), ("f", 57.0, 5.0), ("d", 87.0, 35.0)), parts, OPTIONS)
    moved = 57.0 - 55.15
    assert_near(places(made), [(5.0, 5.0), (57.0 - moved, 5.0), (87.0 - moved, 35.0)], bound=ROUNDING, why="together")
    assert is_legal(made, *parts)


def test_turned_parts_close_up_along_their_own_normals() -> None:
    part = rectangle("a", 50.0, 30.0, 2)
    first, second = Rigid2(100.0, 100.0, 30.0), Rigid2(100.0 + 52.0 * 3.0**0.5 / 2.0, 100.0 + 26.0, 30.0)
    places_ = (Placement("a", 1, first), Placement("a", 2, second))
    made = aligned(Nesting((SheetLayout(SHEET, 1, places_, 0.1),)), [part], OPTIONS)
    assert_near(float(common_line(made, [part], OPTIONS).value or 0.0), 30.0, bound=ROUNDING, why="one side")
    assert is_legal(made, part)


def test_a_knife_without_kerf_lets_parts_touch() -> None:
    options = replace(OPTIONS, kerf_mm=0.0)
    part = rectangle("a", 50.0, 30.0, 4)
    made = aligned(grid(2, 2), [part], options)
    assert_near(float(common_line(made, [part], options).value or 0.0), 160.0, bound=ROUNDING, why="2 x 30 + 2 x 50")
    assert is_legal(made, part, options=options)


def test_the_whole_stage_saves_the_inner_sides_and_its_offcut_grows() -> None:
    parts = [rectangle("a", 90.0, 60.0, 8, rotations=(0.0,)), ring("r", 20.0, 10.0, 2)]
    apart, shared = (
        nest(parts, [SHEET], replace(OPTIONS, common_line=wish, time_limit_s=0.0), Tolerances())
        for wish in (False, True)
    )
    assert apart.product is not None
    assert shared.product is not None
    assert shared.report.metric("common_line_mm").value > 400.0
    assert "common_line_mm" not in {metric.name for metric in apart.report.metrics}
    before, after = (one.product.layouts[0].offcut for one in (apart, shared) if one.product is not None)
    assert before is not None
    assert after is not None
    assert after.width_mm * after.height_mm >= before.width_mm * before.height_mm


@pytest.mark.parametrize("strict", [False, True])
def test_the_quick_way_and_the_strict_one_agree_on_a_grid(monkeypatch: pytest.MonkeyPatch, *, strict: bool) -> None:
    if strict:
        from stages.nest.commonrules import apart_by_the_rules

        monkeypatch.setattr("stages.nest.commonlines.roughly_apart", apart_by_the_rules)
    part = rectangle("a", 50.0, 30.0, 6)
    made = aligned(grid(3, 2), [part], OPTIONS)
    wanted = [(5.0 + 50.15 * i, 5.0 + 30.15 * j) for i in range(3) for j in range(2)]
    assert_near(places(made), wanted, bound=ROUNDING, why="closed form")


def test_where_the_certifier_refuses_the_outcome_nothing_is_moved(monkeypatch: pytest.MonkeyPatch) -> None:
    from stages.nest.legal.gaps import between_copies
    from stages.nest.legal.laid import fatal

    def refusing(*given: object) -> object:
        return between_copies(*given)._replace(findings=(fatal("gap", "planted"),))  # type: ignore[arg-type]

    monkeypatch.setattr("stages.nest.commonlines.between_copies", refusing)
    nesting = grid(2, 2)
    assert places(aligned(nesting, [rectangle("a", 50.0, 30.0, 4)], OPTIONS)) == places(nesting)
