"""Overlaps looked up against shapely, against the kernels that ask the shapes, and by hand."""

from math import radians

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import MultiPolygon, Polygon, affinity

from stages.nest.separation.convolution import GRID, convolved, outline_of
from stages.nest.separation.laying import overlap, overlap_with, pose_in
from stages.nest.separation.problem import FEW, HAIR_MM, Item, Span, inner
from stages.nest.separation.separate import measure, measured, seed_all
from stages.nest.separation.tables import looked_up, wound
from stages.nest.separation.tabling import MOST_RELATIONS, _relations, tables_for
from tests.near import assert_near
from tests.stages.nest.separation.scenes import (
    BY_QUARTERS,
    FREE,
    UPRIGHT,
    Scene,
    ell,
    figures,
    frame,
    kind,
    oblong,
    posed,
    put,
    scene,
    turn,
)

AT_ALL = 1e-6
"""Of the smaller area: what shapely finds of an overlap that is none but for rounding."""

SLANTED: tuple[Span, ...] = ((0.0, 0.0), (30.0, 30.0), (123.0, 123.0))


def pieces_in_common(one: Polygon, other: Polygon) -> int:
    """How many pieces two shapes have in common."""
    common = one.intersection(other)
    parts = common.geoms if isinstance(common, MultiPolygon) else [common]
    return sum(part.area > 0.0 for part in parts)


def place_of(on: Scene, beside: int, angle: float, x: float, y: float) -> float:
    """The cost of item 1 in an angle at (x, y) beside item 0, looked up."""
    span = next(
        s for s in range(on.given.rules.turn[beside, 0], on.given.rules.turns[beside, 0])
        if np.isclose(on.given.rules.span[s, 0], radians(angle))
    )  # fmt: skip
    c, s = turn(angle)
    pose_in(on.tables, on.given.shapes, beside, span, c, s, on.pose)
    return float(overlap_with(on.tables, on.given.shapes, on.layout, 0, on.pose, beside, x, y))


def winding(on: Scene, x: float, y: float) -> int:
    """How often the convolution of kinds 0 and 1 winds about a place, by all its segments."""
    shapes = on.given.shapes
    one, one_ways = outline_of(shapes, 0, 1.0, 0.0, 1.0)
    other, other_ways = outline_of(shapes, 1, 1.0, 0.0, -1.0)
    rows = np.zeros((2 * len(one) * len(other), 4))
    rows = rows[: convolved(one, one_ways, other, other_ways, rows)]
    upward = (rows[:, 1] <= y) & (rows[:, 3] > y)
    downward = (rows[:, 1] > y) & (rows[:, 3] <= y)
    with np.errstate(divide="ignore", invalid="ignore"):
        at = rows[:, 0] + (rows[:, 2] - rows[:, 0]) * (y - rows[:, 1]) / (rows[:, 3] - rows[:, 1])
    return int((upward & (at > x)).sum() - (downward & (at > x)).sum())


PLACES = st.tuples(st.floats(-1.1, 1.1), st.floats(-1.1, 1.1))


@given(figures((30.0,)), figures((30.0, 80.0)), PLACES)
@settings(max_examples=150, deadline=None)
def test_the_convolution_winds_as_often_as_there_are_pieces_in_common(
    one: Polygon, other: Polygon, place: tuple[float, float]
) -> None:
    on = scene([kind(one), kind(other)])
    x, y = (share * (on.given.shapes.size[0] + on.given.shapes.size[1]) / 2.0 for share in place)
    first, second = inner(one), affinity.translate(inner(other), x, y)
    if first.boundary.distance(second.boundary) > HAIR_MM or not first.intersects(second):
        assert winding(on, x, y) == pieces_in_common(first, second)


@given(figures((30.0,)), figures((30.0, 80.0)), PLACES, st.sampled_from([angle for angle, _ in SLANTED]), st.booleans())
@settings(max_examples=150, deadline=None)
def test_what_is_looked_up_overlaps_just_where_the_shapes_do(
    one: Polygon, other: Polygon, place: tuple[float, float], angle: float, swapped: bool
) -> None:
    kinds = [kind(one, SLANTED), kind(other, SLANTED)]
    on = scene(kinds, [Item(1, 1), Item(0, 0)] if swapped else None)
    put(on, 0, 500.0, 300.0)
    beside = 0 if swapped else 1
    x, y = (share * (on.given.shapes.size[0] + on.given.shapes.size[1]) / 2.0 for share in place)
    found = place_of(on, beside, angle, 500.0 + x, 300.0 + y)
    exact = float(
        overlap(on.given.shapes, on.layout, 0, posed(on, beside, angle), beside, 500.0 + x, 300.0 + y)
    )  # fmt: skip
    lying = affinity.translate(affinity.rotate(other if not swapped else one, angle, origin=(0, 0)), x, y)
    common = lying.intersection(one if not swapped else other).area
    assert (found > 0.0) == (exact > 0.0) or common < AT_ALL * min(one.area, other.area)


@given(st.integers(0, GRID), st.integers(0, GRID))
@settings(max_examples=60, deadline=None)
def test_at_the_corners_of_cells_the_cost_is_that_of_the_shapes(column: int, row: int) -> None:
    on = scene([kind(ell(60.0, 20.0)), kind(oblong(50.0, 30.0))])
    put(on, 0, 0.0, 0.0)
    table = int(on.tables.number[0, 1, on.tables.relation[0, 0]])
    x, y = (on.tables.frame[table, k] + step / on.tables.frame[table, k + 2] for k, step in ((0, column), (1, row)))
    exact = float(overlap(on.given.shapes, on.layout, 0, posed(on, 1), 1, x, y))
    found = float(looked_up(on.tables, table, x + 1e-9, y + 1e-9))
    if exact > 0.0 and 0 < column < GRID and 0 < row < GRID:
        assert_near(found, exact, bound=1e-5 * exact, why="single precision, and a place beside it")


def test_one_beside_the_other_is_the_other_beside_the_one() -> None:
    on = scene([kind(ell(60.0, 20.0), BY_QUARTERS), kind(oblong(50.0, 30.0), BY_QUARTERS)])
    put(on, 0, 10.0, 20.0)
    there = place_of(on, 1, 90.0, 25.0, 30.0)
    back = scene([kind(ell(60.0, 20.0), BY_QUARTERS), kind(oblong(50.0, 30.0), BY_QUARTERS)], [Item(1, 1), Item(0, 0)])
    put(back, 0, 25.0, 30.0, 90.0)
    back.layout.span[0] = next(s for s in range(4) if np.isclose(back.given.rules.span[s, 0], np.pi / 2.0))
    assert there > 0.0
    assert_near(place_of(back, 0, 0.0, 10.0, 20.0), there, bound=1e-9 * there, why="the same table")


def test_what_touches_along_an_edge_or_interlocks_does_not_overlap() -> None:
    on = scene([kind(oblong(60.0, 20.0)), kind(oblong(40.0, 20.0))])
    put(on, 0, 0.0, 0.0)
    for x, y in ((50.0, 0.0), (-50.0, 0.0), (0.0, 20.0), (30.0, -20.0), (50.0, 20.0)):
        assert place_of(on, 1, 0.0, x, y) == 0.0
        assert place_of(on, 1, 0.0, x * 0.999, y * 0.999) > 0.0
    bay = scene([kind(ell(60.0, 20.0)), kind(oblong(40.0, 40.0))])
    put(bay, 0, 0.0, 0.0)
    assert place_of(bay, 1, 0.0, 10.0, 10.0) == 0.0, "in the bay of the L"
    assert place_of(bay, 1, 0.0, 9.999, 10.0) > 0.0


def test_shapes_with_holes_and_ranges_of_angles_have_no_tables() -> None:
    on = scene([kind(frame(60.0, 40.0)), kind(oblong(10.0, 10.0))])
    assert len(on.tables.cost) == 0, "one copy of each: the square has nothing beside it but the frame"
    banded = ((10.0, 20.0),)
    ranged = scene([kind(oblong(60.0, 40.0), banded), kind(oblong(10.0, 10.0), banded)])
    assert len(ranged.tables.cost) == 0
    free = scene([kind(oblong(60.0, 40.0), FREE), kind(oblong(10.0, 10.0), FREE)])
    assert len(free.tables.cost) == FEW[0], "for the few angles that stand for any"
    c, s = turn(22.0)
    wide = int(free.given.rules.turn[1, 0])
    pose_in(free.tables, free.given.shapes, 1, wide, c, s, free.pose)
    assert free.pose.span[0] == -1, "any angle itself has none"
    put(on, 0, 0.0, 0.0)
    assert place_of(on, 1, 0.0, 0.0, 0.0) == 0.0, "in the hole: the shapes themselves are asked"
    assert place_of(on, 1, 0.0, 20.0, 0.0) > 0.0


def test_only_pairs_that_there_are_get_tables() -> None:
    single = scene([kind(oblong(60.0, 40.0), BY_QUARTERS), kind(oblong(10.0, 10.0), BY_QUARTERS)])
    assert len(single.tables.cost) == len(BY_QUARTERS), "one beside the other, by their relative angle"
    twice = scene([kind(oblong(60.0, 40.0), BY_QUARTERS)], [Item(0, 0), Item(0, 0)])
    assert len(twice.tables.cost) == len(BY_QUARTERS), "beside itself"
    assert len(scene([kind(oblong(60.0, 40.0), BY_QUARTERS)]).tables.cost) == 0


def test_where_there_would_be_too_many_the_kinds_with_most_copies_have_theirs(monkeypatch: pytest.MonkeyPatch) -> None:
    kinds = [kind(oblong(10.0, 10.0 + k)) for k in range(3)]
    on = scene(kinds, [Item(0, 0), *[Item(1, 1)] * 3, *[Item(2, 2)] * 3])
    monkeypatch.setattr("stages.nest.separation.tabling.MOST_TABLES", 1)
    few = tables_for(on.problem, on.given)
    assert few.number[1, 2, 0] == 0
    assert (few.number >= 0).sum() == 1
    assert (on.tables.number >= 0).sum() == 5


def test_too_many_relative_angles_are_not_tabled() -> None:
    rng = np.random.default_rng(1)
    angles = rng.uniform(0.0, 6.0, 20)
    rows = np.stack([angles, angles, np.cos(angles), np.sin(angles)], axis=1)
    relation, turns = _relations(rows)
    assert len(turns) == 0, "20 * 19 + 1 of them"
    assert (relation == -1).all()
    assert MOST_RELATIONS < 20 * 19 + 1
    relation, turns = _relations(rows[:5])
    assert len(turns) == 21
    assert len(set(np.diag(relation))) == 1, "beside itself: no angle"


def test_threads_fill_the_same_tables() -> None:
    on = scene(
        [kind(ell(60.0, 20.0), SLANTED), kind(oblong(50.0, 30.0), SLANTED)], [Item(0, 0), Item(0, 0), Item(1, 1)]
    )
    for one, other in zip(on.tables, tables_for(on.problem, on.given, threads=2), strict=True):
        assert np.array_equal(one, other)


def test_tables_that_see_nothing_do_not_make_a_layout_count_as_parted() -> None:
    on = scene([kind(oblong(10.0, 10.0), UPRIGHT)] * 2)
    put(on, 0, 50.0, 50.0)
    put(on, 1, 54.0, 54.0)
    blind = on.tables._replace(winding=np.zeros_like(on.tables.winding), start=np.zeros_like(on.tables.start))
    pairs, walls, given_ = np.zeros((2, 2)), np.zeros(2), on.given
    rest = (given_.shapes, given_.rules, given_.regions, given_.items, on.layout, given_.bins, on.pose, pairs, walls)
    assert measure(blind, *rest, False) == 0.0
    assert measured(blind, *rest) == measure(on.tables, *rest, True) > 0.0


def test_the_winding_number_of_a_place_does_not_depend_on_the_point_of_its_cell() -> None:
    on = scene([kind(ell(60.0, 20.0)), kind(ell(50.0, 10.0))])
    table = int(on.tables.number[0, 1, on.tables.relation[0, 0]])
    seed_all(1)
    rng = np.random.default_rng(1)
    start = on.tables.start[table]
    for cell in np.flatnonzero(np.diff(start))[::7]:
        row, column = divmod(int(cell), GRID)
        u, v = rng.uniform(0.0, 1.0, 2)
        x, y = (
            on.tables.frame[table, k] + (step + part) / on.tables.frame[table, k + 2]
            for k, step, part in ((0, column, u), (1, row, v))
        )
        more = wound(on.tables, table, start[cell], start[cell + 1], column, row, x, y)
        assert on.tables.winding[table, cell] + more == winding(on, x, y)
