"""What the rivals are told: polygons, gaps and beds, on the safe side."""

from dataclasses import replace

import pytest
from shapely import Polygon

from stages.model.sheet import NestOptions, Quality, Sheet, Zone
from tests.bench.nest.instances import FOLDER, Instance, load
from tests.bench.nest.tasks import Bed, closed, task
from tests.near import assert_near
from tests.stages.nest.shapes import box, contour, disc, pattern, rectangle

EDGE = 5.0
HOLE = contour(box(10.0, 10.0, 40.0, 20.0)).path
ZONE = Zone(contour(box(30.0, 50.0, 70.0, 0.0)).path, 1)
SHEET = Sheet("sheet", 100.0, 50.0, 2, EDGE, defects=(HOLE,), zones=(ZONE,))


def beds(quality: Quality, sheet: Sheet = SHEET) -> list[Bed]:
    part = replace(rectangle("part", 4.0, 2.0), quality=quality)
    return task(Instance("made", (part,), (sheet,), NestOptions()), 1.0, 1).beds


def area(bed: Bed) -> float:
    return float(Polygon(bed.outer, bed.blocked).area)


def test_a_bed_is_the_sheet_inside_the_gap_less_the_defects_grown_by_it() -> None:
    (bed,) = beds("any")
    assert (bed.stock, bed.count, len(bed.blocked)) == ("sheet", 2, 1)
    assert_near(area(bed), 90.0 * 40.0 - 20.0 * 20.0, bound=1e-9, why="upright boxes with mitred corners")


def test_a_zone_closed_to_a_part_is_taken_off_the_bed() -> None:
    (open_,), (shut,) = beds(1), beds(2)
    assert_near(area(open_) - area(shut), 25.0 * 40.0, bound=1e-9, why="the zone inside the edge gap")


@pytest.mark.parametrize(
    ("zone", "part", "expected"), [(1, 2, True), (2, 2, False), (9, "best", True), (0, "any", False)]
)
def test_a_zone_is_closed_to_parts_that_need_better(zone: int, part: Quality, expected: bool) -> None:
    assert closed(zone, part) is expected


def test_a_hide_cut_in_two_by_a_zone_is_two_beds_of_one_stock() -> None:
    across = Zone(contour(box(10.0, 50.0, 60.0, 0.0)).path, 1)
    found = beds("best", replace(SHEET, zones=(across,)))
    assert [one.stock for one in found] == ["sheet", "sheet"]


def test_a_strip_is_told_by_where_parts_may_lie() -> None:
    strip = next(one for one in load(FOLDER) if one.is_strip)
    gapped = replace(strip, stock=(replace(strip.stock[0], edge_gap_mm=EDGE),))
    told = task(gapped, 3.0, 7)
    assert told.strip == (EDGE, strip.stock[0].height_mm - EDGE, EDGE)
    assert (told.seconds, told.seed, told.beds, len(told.parts)) == (3.0, 7, [], 20)


def test_parts_are_told_with_count_angles_and_holes() -> None:
    ring = pattern("ring", contour(box(9.0, 9.0)), contour(box(3.0, 3.0, 3.0, 3.0), hole=True), quantity=4)
    bar = rectangle("bar", 4.0, 2.0, 2, (0.0, 90.0))
    told = task(Instance("made", (ring, bar), (SHEET,), NestOptions(2.0)), 1.0, 1)
    assert [(one.count, one.angles, len(one.outer), len(one.holes)) for one in told.parts] == [
        (4, None, 4, 1),
        (2, [0.0, 90.0], 4, 0),
    ]
    assert told.gap_mm == 2.0


def test_a_part_with_arcs_is_refused() -> None:
    with pytest.raises(ValueError, match="polygons only"):
        task(Instance("made", (disc("disc", 5.0),), (SHEET,), NestOptions()), 1.0, 1)
