"""Pictures of polygons on a grid only grow; the room that is left on them is told from above."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import Point, affinity, box

from stages.model.sheet import NestOptions, Sheet
from stages.nest.beds import bed
from stages.nest.blank import Placed, as_blank, edges, turned
from stages.nest.cells import cover, framed, widest_gap
from stages.nest.raster import cut_off, empty_board, fill_raster, free_at
from tests.near import assert_near
from tests.stages.nest.shapes import angle_piece, disc, rectangle, ring, sector
from tests.stages.nest.stock import hide, lobed, outline, roll

SHAPES = [angle_piece("l", 80.0, 20.0), disc("d", 30.0), ring("r", 40.0, 25.0), sector("s", 50.0, 90.0, 140.0)]


@given(st.sampled_from(SHAPES), st.floats(0.0, 360.0), st.floats(1.0, 30.0))
@settings(max_examples=40, deadline=None)
def test_every_cell_that_a_part_reaches_into_is_covered(shape, angle: float, cell: float) -> None:
    way = turned(as_blank(0, shape, NestOptions()), angle)
    cells = cover(way.outline, cell)
    for row, column in zip(*np.nonzero(~cells), strict=True):
        square = box(column * cell, row * cell, (column + 1) * cell, (row + 1) * cell)
        assert way.shape.intersection(square).area < 1e-3 * cell**2, "beyond the rounding at a grid line"


def test_a_box_on_grid_lines_covers_its_own_cells_and_no_others() -> None:
    cells = cover(edges(box(2.0, 1.0, 5.0, 3.0)), 1.0)
    wanted = np.zeros_like(cells)
    wanted[1:3, 2:5] = True
    assert (cells == wanted).all()


def test_a_picture_is_cut_off_or_filled_up() -> None:
    full = np.ones((3, 3), dtype=bool)
    assert framed(full, (2, 5)).tolist() == [[True, True, True, False, False]] * 2
    assert not framed(np.zeros((0, 0), dtype=bool), (2, 2)).any()


@given(st.floats(5.0, 40.0), st.floats(0.5, 3.0), st.floats(0.0, 3.0))
@settings(max_examples=30, deadline=None)
def test_a_circle_whose_cells_are_free_is_not_larger_than_the_widest_gap_tells(
    radius: float, cell: float, shift: float
) -> None:
    circle = Point(100.0 + shift, 100.0).buffer(radius, quad_segs=32)
    taken = ~framed(cover(edges(circle), cell), (int(200.0 / cell),) * 2)
    assert (widest_gap(taken) + np.sqrt(0.5)) * cell >= radius * np.cos(np.pi / 128.0)


@given(st.floats(200.0, 600.0), st.floats(0.0, 0.4), st.integers(2, 5))
@settings(max_examples=15, deadline=None)
def test_a_cell_that_is_not_blocked_lies_wholly_in_the_region(radius: float, depth: float, lobes: int) -> None:
    leather = bed(0, hide("h", lobed(radius, depth, lobes, x=9e3)), NestOptions())
    board = empty_board(leather, 1000)
    region, (blocked,) = leather.region("best"), board.blocked
    assert region is not None
    assert blocked is not None
    rows, columns = (int(size / board.cell_mm) for size in (leather.height_mm, leather.width_mm))
    free = np.argwhere(~blocked[:rows, :columns])
    assert len(free)
    corner = free[:: max(len(free) // 50, 1)] * board.cell_mm
    squares = [box(x, y, x + board.cell_mm, y + board.cell_mm) for y, x in corner]
    assert max(square.difference(region).area for square in squares) < 1e-3 * board.cell_mm**2


def test_a_part_is_pushed_against_the_rim_of_a_region() -> None:
    slope = [(0.0, 0.0), (400.0, 0.0), (400.0, 300.0), (200.0, 300.0)]
    leather = bed(0, hide("h", slope), NestOptions())
    way = turned(as_blank(0, rectangle("r", 50.0, 40.0), NestOptions()), 0.0)
    (placed,) = fill_raster(leather, [(1, (way,))])
    assert leather.region("best").distance(affinity.translate(way.shape, placed.x, placed.y)) == 0.0
    # its upper left corner rests on the slope from (0, 0) to (200, 300), its foot on the ground
    assert_near(placed.y, 0.0, bound=1e-5, why="slack")
    assert_near(placed.x, 40.0 * 200.0 / 300.0, bound=1e-4, why="slack over the sine of the slope")


def test_a_roll_cut_off_keeps_its_regions_up_to_there() -> None:
    long = bed(
        0, roll("r", 100.0, defects=(outline([(50.0, 10.0), (60.0, 10.0), (60.0, 20.0)]),)), NestOptions(), 1000.0
    )
    short = cut_off(long, 55.0)
    assert short.width_mm == 55.0
    assert_near(short.area_mm2, 5500.0 - 12.5, bound=1e-3, why="half of the defect's triangle lies before")
    assert cut_off(long, 2000.0) is long


def test_hopeless_parts_are_passed_over_and_the_next_are_placed() -> None:
    room = bed(0, Sheet("s", 100.0, 100.0), NestOptions())
    big, small = (
        turned(as_blank(number, disc("d", size), NestOptions()), 0.0) for number, size in enumerate((49.0, 4.0))
    )
    placed = fill_raster(room, [(2, (big,)), (3, (small,))])
    assert [one.turned is big for one in placed].count(True) == 1
    assert len(placed) == 4


def test_a_place_in_the_nook_of_another_part_is_free_and_one_on_its_legs_is_not() -> None:
    parts = angle_piece("l", 80.0, 20.0), rectangle("r", 50.0, 50.0)
    nook, piece = (turned(as_blank(0, one, NestOptions()), 0.0) for one in parts)
    placed = [Placed(nook, 10.0, 10.0)]
    assert free_at(placed, piece, 35.0, 35.0)
    assert not free_at(placed, piece, 25.0, 35.0)
    assert free_at(placed, piece, 200.0, 35.0)
    assert free_at([], piece, 10.0, 10.0)
