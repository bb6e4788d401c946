"""Cut order: what lies in a hole comes first, the way is short, and nothing but the order changes."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, backwards, transform
from stages.model.pattern import FlatPattern, Mark
from stages.model.sheet import Nesting, Placement, Sheet, SheetLayout
from stages.model.strokes import strokes
from stages.nest.order import as_listed, cut_order, holders, in_cut_order, travel
from tests.near import assert_near
from tests.stages.nest.shapes import contour, disc, pattern, rectangle, ring

SHEET = Sheet("sheet", 3000.0, 1500.0)


def layout(*placed: tuple[str, float, float]) -> SheetLayout:
    places = [Placement(part, number + 1, Rigid2(x, y)) for number, (part, x, y) in enumerate(placed)]
    return SheetLayout(SHEET, 1, tuple(places), 0.5)


def by_name(*patterns: FlatPattern) -> dict[str, FlatPattern]:
    return {one.part: one for one in patterns}


def order_of(made: SheetLayout) -> list[int]:
    return [placed.copy for placed in made.placements]


def test_a_row_is_cut_from_the_corner_outwards() -> None:
    parts = by_name(rectangle("a", 50.0, 20.0))
    shuffled = layout(*(("a", 100.0 * x, 10.0) for x in (3, 0, 4, 1, 2)))
    made = cut_order(shuffled, parts)
    assert [placed.motion.x for placed in made.placements] == [0.0, 100.0, 200.0, 300.0, 400.0]
    assert_near(travel(made, parts), 10.0 + 400.0, bound=1e-9, why="up to the row, then along it")


def test_what_lies_in_a_hole_comes_before_it_through_three_levels() -> None:
    parts = by_name(ring("large", 100.0, 80.0), ring("middle", 60.0, 40.0), disc("small", 5.0), disc("free", 5.0))
    made = cut_order(
        layout(
            ("large", 500.0, 500.0),
            ("free", 10.0, 10.0),
            ("middle", 500.0, 510.0),
            ("small", 490.0, 510.0),
            ("small", 510.0, 510.0),
            ("small", 500.0, 430.0),
        ),
        parts,
    )
    names = [placed.part for placed in made.placements]
    place = {copy: k for k, copy in enumerate(order_of(made))}
    assert names[0] == "free"
    assert names[-1] == "large"
    assert max(place[4], place[5]) < place[3] < place[1]
    assert place[6] < place[1]


def test_a_part_is_held_by_the_smallest_hole_around_it() -> None:
    parts = [ring("large", 100.0, 80.0), ring("middle", 60.0, 40.0), disc("small", 5.0), disc("beside", 5.0)]
    at = [Rigid2(0.0, 0.0), Rigid2(0.0, 10.0), Rigid2(3.0, 3.0, 50.0, mirrored=True), Rigid2(150.0, 0.0)]
    places = [Placement(one.part, 1, motion) for one, motion in zip(parts, at, strict=True)]
    assert holders(parts, places) == [None, 0, 1, None]


@pytest.mark.parametrize("turned_round", [False, True])
def test_no_part_is_held_by_a_hole_smaller_than_itself_whichever_way_round_it_runs(turned_round: bool) -> None:
    """Each begins in a hole of the other: taken for its holder, each would hold the other for ever."""
    whole = ring("a", 40.0, 5.0)
    one = whole.replace(outer=replace(whole.outer, path=backwards(whole.outer.path))) if turned_round else whole
    x, y = one.outer.path.vertices[0].tolist()
    places = [Placement("a", 1, Rigid2()), Placement("a", 2, Rigid2(x, y, 180.0))]
    assert holders([one, one], places) == [None, None]


def test_rings_that_are_linked_like_a_chain_are_still_ordered() -> None:
    """Such a layout is illegal; whether one may order it must not depend on that."""
    parts = by_name(ring("a", 100.0, 80.0), ring("b", 70.0, 69.0))
    made = cut_order(layout(("a", 0.0, 0.0), ("b", 30.0, 0.0), ("b", 35.0, 0.0)), parts)
    assert sorted(order_of(made)) == [1, 2, 3]


def test_the_head_goes_along_marks_and_holes_before_the_outline() -> None:
    """A mark from 20 to 80, a hole begun at 60, the outline begun at 0: hops of 20, 20 and 60 mm."""
    mark = Mark("m", ArcPath(np.array([[20.0, 0.0], [80.0, 0.0]]), np.zeros(2), closed=False))
    unseen = Mark("bend", ArcPath(np.array([[0.0, 9.0], [90.0, 9.0]]), np.zeros(2), closed=False), "BEND_UP")
    hole = contour([(60.0, 0.0), (60.0, 5.0), (65.0, 5.0)], hole=True)
    part = pattern("p", contour([(0.0, 0.0), (100.0, 0.0), (100.0, 10.0), (0.0, 10.0)]), hole)
    marked = part.replace(marks=(mark, unseen))
    start = float(hole.path.vertices[0, 0]), float(hole.path.vertices[0, 1])
    way = 20.0 + float(np.hypot(80.0 - start[0], start[1])) + float(np.hypot(*start))
    assert_near(travel(layout(("p", 0.0, 0.0)), by_name(marked)), way, bound=1e-9, why="closed form")
    assert [stroke.layer for stroke in strokes(marked)] == ["MARK", "BEND_UP", "CUT_INNER", "CUT_OUTER"]


@pytest.mark.parametrize("mirrored", [False, True])
def test_travel_is_that_between_the_paths_as_they_are_moved(mirrored: bool) -> None:
    """Second method: the moved paths themselves, a mirrored one running the other way."""
    mark = Mark("m", ArcPath(np.array([[2.0, 1.0], [8.0, 3.0]]), np.zeros(2), closed=False))
    parts = by_name(ring("r", 30.0, 20.0).replace(marks=(mark,)), rectangle("q", 10.0, 20.0))
    motions = [Rigid2(100.0, 40.0, 25.0, mirrored), Rigid2(300.0, 40.0, 70.0, mirrored)]
    placed = tuple(Placement(part, 1, motion) for part, motion in zip("rq", motions, strict=True))
    paths = [transform(one.path, place.motion) for place in placed for one in strokes(parts[place.part])]
    ends = [(path.vertices[0], path.vertices[0 if path.closed else -1]) for path in paths]
    hops = [np.zeros(2), *(end for _, end in ends)], [start for start, _ in ends]
    way = sum(float(np.hypot(*(start - end))) for end, start in zip(hops[0][:-1], hops[1], strict=True))
    assert_near(travel(SheetLayout(SHEET, 1, placed, 0.1), parts), way, bound=1e-9, why="the same distances")


@settings(max_examples=20, deadline=None)
@given(st.integers(1, 40), st.integers(0, 10_000))
def test_only_the_order_changes_and_whatever_it_was_to_the_same(count: int, seed: int) -> None:
    parts = [ring("r", 30.0, 20.0), disc("d", 5.0), rectangle("q", 10.0, 20.0)]
    places = np.random.default_rng(seed).uniform(0.0, 1000.0, (count, 2))
    given_one = layout(*(("rdq"[k % 3], float(x), float(y)) for k, (x, y) in enumerate(places)))
    made, (after, listed) = in_cut_order(Nesting((given_one,)), parts)
    assert sorted(order_of(made.layouts[0])) == sorted(order_of(given_one))
    assert after.value == travel(made.layouts[0], by_name(*parts))
    assert listed.value == travel(as_listed(given_one, by_name(*parts)), by_name(*parts))
    shuffled = [given_one.placements[k] for k in np.random.default_rng(seed).permutation(count)]
    again, metrics = in_cut_order(Nesting((replace(given_one, placements=tuple(shuffled)),)), parts)
    assert order_of(again.layouts[0]) == order_of(made.layouts[0])
    assert [metric.value for metric in metrics] == [after.value, listed.value]


def test_a_grid_of_a_thousand_parts_is_ordered_in_a_second_and_travels_little_more_than_its_pitch() -> None:
    from time import process_time

    parts = by_name(rectangle("a", 50.0, 20.0))
    places = [("a", 90.0 * i, 40.0 * j) for i in range(32) for j in range(32)]
    shuffled = layout(*(places[k] for k in np.random.default_rng(3).permutation(len(places))))
    start = process_time()
    made = cut_order(shuffled, parts)
    assert process_time() - start < 15.0
    assert len({placed.copy for placed in made.placements}) == len(places)
    assert travel(made, parts) < 1.25 * 40.0 * len(places)


def test_more_parts_than_one_tour_holds_are_cut_in_bands(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("stages.nest.order.LONGEST_TOUR", 5)
    parts = by_name(rectangle("a", 8.0, 8.0))
    made = cut_order(layout(*(("a", 10.0 * (k % 4), 100.0 * (k // 4)) for k in range(12))), parts)
    assert sorted(order_of(made)) == list(range(1, 13))
    columns = [placed.motion.x for placed in made.placements]
    assert all(max(columns[k : k + 5]) <= min(columns[k + 5 :], default=np.inf) for k in (0, 5))
    assert any(a != b for a, b in pairwise(columns))
