"""Which hands and angles of a part are tried on which stock."""

from time import process_time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import Polygon

from stages.geometry.curves.rigid import Rigid2, apply
from stages.geometry.paths.arcpath import polygon, transform
from stages.model.sheet import NestOptions, Sheet
from stages.nest.beds import bed
from stages.nest.blank import Placed, as_blank, turned
from stages.nest.fit import Kind, angles_on, fitting_angles, hull, kind, tight_angle, widths
from stages.nest.lots import task_of
from stages.nest.turns import Turns, allowed, contains
from tests.near import assert_near
from tests.stages.nest.shapes import angle_piece, box, disc, rectangle, ring, sector
from tests.stages.nest.stock import hide

FREE = NestOptions()
PLATE = Sheet("s", 1000.0, 500.0, grain_deg=90.0)
LEATHER = hide("h", box(1000.0, 500.0))


def lots(*parts: object, options: NestOptions = FREE, stock: tuple[Sheet, ...] = (PLATE,)) -> list[Kind]:
    return list(task_of(parts, stock, options).kinds)


@given(st.floats(0.0, 360.0), st.floats(-50.0, 50.0))
@settings(max_examples=40, deadline=None)
def test_a_mirrored_blank_lies_where_its_motion_takes_the_part(angle: float, x: float) -> None:
    part = sector("s", 50.0, 90.0, 140.0)
    way = turned(as_blank(0, part, FREE, mirrored=True), angle)
    motion = Placed(way, x, 2.0 * x).motion(bed(0, PLATE, FREE))
    assert motion.mirrored
    exact = Polygon(polygon(transform(part.outer.path, motion), accuracy=1e-3))
    drawn = Polygon(way.shape.exterior)
    assert_near(exact.bounds[:2], (x, 2.0 * x), bound=1e-2, why="chord error 1e-3 and the bed's hair")
    apart = exact.symmetric_difference(Polygon(np.array(drawn.exterior.coords) + np.array([x, 2.0 * x]))).area
    assert apart < 1e-2 * exact.area, "the grown polygon is within its chord error"


def test_the_hull_of_a_mirrored_blank_is_the_mirrored_hull() -> None:
    part = sector("s", 50.0, 90.0, 140.0)
    plain, mirrored = (Polygon(hull(as_blank(0, part, FREE, mirrored=hand))) for hand in (False, True))
    flipped = Polygon(np.array(plain.exterior.coords) * [-1.0, 1.0])
    assert mirrored.symmetric_difference(flipped).area < 1e-6
    assert mirrored.symmetric_difference(plain).area > 1.0


def test_a_list_of_angles_is_tried_as_it_stands_and_others_along_the_tight_rectangle() -> None:
    (listed,) = lots(angle_piece("a", 80.0, 20.0).replace(rotations=(10.0, 370.0, 90.0)))
    assert [one.angle_deg for one in listed.turns] == [10.0, 90.0]
    (free,) = lots(angle_piece("a", 80.0, 20.0))
    assert len(free.turns) == 4
    assert np.ptp([one.angle_deg % 90.0 for one in free.turns]) == 0.0


def test_within_an_outline_more_angles_are_tried() -> None:
    (one,) = lots(angle_piece("a", 80.0, 20.0), stock=(LEATHER,))
    assert_near(np.diff(sorted(way.angle_deg for way in one.turns)), np.full(15, 22.5), bound=1e-9, why="16 of them")


@pytest.mark.parametrize(("part", "ways"), [(rectangle("r", 30.0, 10.0), 2), (rectangle("q", 30.0, 30.0), 1)])
def test_what_covers_the_same_is_tried_once(part: object, ways: int) -> None:
    (one,) = lots(part)
    assert len(one.on(bed(0, PLATE, FREE))) == ways


def test_a_band_along_the_grain_is_tried_at_its_ends_in_its_middle_and_between() -> None:
    (one,) = lots(angle_piece("a", 80.0, 20.0).replace(axis_deg=0.0, axis_band_deg=10.0))
    angles = {round(way.angle_deg, 9) for way in one.turns}
    assert {80.0, 85.0, 90.0, 95.0, 100.0, 260.0, 265.0, 270.0, 275.0, 280.0} <= angles
    spans = one.allowed(bed(0, PLATE, FREE), one.blank)
    assert all(contains(spans, angle) for angle in angles)


def test_the_grain_of_each_stock_counts_by_itself() -> None:
    across = Sheet("t", 1000.0, 500.0, grain_deg=0.0)
    (one,) = lots(angle_piece("a", 80.0, 20.0).replace(axis_deg=0.0), stock=(PLATE, across))
    first, second = ({round(way.angle_deg, 9) for way in ways} for ways in one.ways)
    assert first == {90.0, 270.0}
    assert second == {0.0, 180.0}


def test_an_angle_that_fits_is_found_within_the_band_only() -> None:
    bar = rectangle("bar", 110.0, 4.0).replace(axis_deg=0.0, axis_band_deg=30.0)
    square = Sheet("q", 90.0, 90.0, grain_deg=0.0)
    room = bed(0, square, FREE)
    blank = as_blank(0, bar, FREE)
    assert fitting_angles(blank, room)
    assert fitting_angles(blank, room, allowed(bar, square, FREE)) == ()
    wider = bar.replace(axis_band_deg=50.0)
    angles = angles_on(as_blank(0, wider, FREE), room, allowed(wider, square, FREE))
    assert any(one.width_mm <= 90.0 and one.height_mm <= 90.0 for one in (turned(blank, angle) for angle in angles))


def test_a_pair_has_two_lots_and_a_part_that_may_be_mirrored_two_hands() -> None:
    pair = angle_piece("pair", 80.0, 20.0, 5).replace(pair=True)
    uneven = sector("uneven", 50.0, 90.0, 140.0, 3)
    task = task_of([pair, uneven, disc("d", 5.0, 2)], [PLATE], FREE)
    assert [(one.blank.mirrored, task.counts[one.blank.part]) for one in task.kinds] == [
        (False, 3),
        (True, 2),
        (False, 3),
        (False, 2),
    ]
    hand = rectangle("hand", 1.0, 1.0)
    three = [(0.0, 0.0), (90.0, 0.0), (0.0, 40.0)]
    hand = hand.replace(outer=type(hand.outer)((), hide("x", three).outline, 0.0))
    kinds = task_of([pair, hand, uneven, ring("o", 9.0, 4.0)], [PLATE], NestOptions(mirror=True)).kinds
    assert [len(one.hands) for one in kinds] == [1, 1, 2, 1, 1], "a sector and a ring are their own mirror images"


def test_one_way_is_an_angle_that_fits_the_most_stocks_for_each_hand() -> None:
    low = Sheet("low", 1000.0, 60.0)
    (one,) = lots(angle_piece("a", 80.0, 20.0).replace(rotations=(0.0, 90.0, 45.0)), stock=(PLATE, low))
    bar = as_blank(0, rectangle("b", 80.0, 20.0, rotations=(90.0, 0.0)), FREE)
    tall = kind([bar], [bed(0, PLATE, FREE), bed(1, low, FREE)], FREE)
    assert {way.angle_deg for ways in tall.in_one_way(0).ways for way in ways} == {0.0}
    for number in range(4):
        chosen = one.in_one_way(number)
        (way,) = chosen.turns
        assert {each.angle_deg for ways in chosen.ways for each in ways} <= {way.angle_deg}
        assert chosen.allowed(bed(0, PLATE, FREE), way.blank) == Turns(((way.angle_deg, way.angle_deg),))


def test_the_tight_angle_of_a_mirrored_part_is_the_mirrored_one() -> None:
    base = rectangle("a", 100.0, 30.0)
    part = base.replace(outer=type(base.outer)((), transform(base.outer.path, Rigid2(angle_deg=20.0)), 0.0))
    plain, mirrored = (tight_angle(hull(as_blank(0, part, FREE, mirrored=hand))) for hand in (False, True))
    assert_near([plain, mirrored], [70.0, 20.0], bound=1e-6, why="rounding of the hull")


@given(st.integers(3, 40), st.integers(0, 10_000), st.sampled_from([1.0, 1e3]))
@settings(max_examples=60, deadline=None)
def test_the_width_of_a_loop_is_that_of_all_its_corners(count: int, seed: int, size: float) -> None:
    """Second method: every corner turned."""
    rng = np.random.default_rng(seed)
    corners = np.array(Polygon(rng.uniform(-size, size, (count, 2))).convex_hull.exterior.coords)[:-1]
    loop = corners if Polygon(corners).exterior.is_ccw else corners[::-1]
    edges = np.degrees(np.arctan2(*(np.roll(loop, -1, axis=0) - loop).T[::-1]))
    angles = np.concatenate([rng.uniform(-720.0, 720.0, 20), -edges, 90.0 - edges, [0.0, 90.0, 360.0]])
    x = [apply(Rigid2(angle_deg=angle), loop)[:, 0] for angle in angles]
    assert_near(widths(loop, angles), [np.ptp(one) for one in x], bound=1e-12 * size, why="rounding of a turn")


def test_a_disc_too_large_for_all_sheets_is_told_at_once() -> None:
    """Its hull has 5000 corners: all of them turned to all of its edges were 600 MB and half a minute."""
    sheets = tuple(Sheet(f"s{number}", 2000.0, 1000.0 + number) for number in range(20))
    start = process_time()
    (one,) = lots(disc("tank floor", 5000.0), stock=sheets)
    assert process_time() - start < 5.0, "0.3 s on an idle core"
    assert not any(one.ways)
