"""The room on stock: exact for rectangles, never too large for anything else, classes of zones apart."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import MultiPolygon, Point, Polygon, affinity

from stages.geometry.paths.arcpath import area, backwards
from stages.model.sheet import NestOptions, Sheet
from stages.nest.beds import bed, beds, roll_length
from stages.nest.blank import SLACK_MM, Bed
from tests.near import assert_near
from tests.stages.nest.shapes import box, disc, rectangle
from tests.stages.nest.stock import hide, lobed, outline, roll, round_outline, zone

SQUARE = box(200.0, 100.0, x=50.0, y=-30.0)

ROUND = Sheet(
    "s", 400.0, 400.0, outline=round_outline(200.0, 200.0, 200.0), defects=(round_outline(50.0, 200.0, 200.0),)
)


def on_sheet(one: Bed, quality: int | str = "best") -> Polygon | MultiPolygon:
    region = one.region(quality)
    assert region is not None
    return affinity.translate(region, one.x_mm, one.y_mm)


def test_a_sheet_is_its_rectangle_less_edge_gap_and_plus_half_the_gap() -> None:
    one = bed(0, Sheet("s", 1000.0, 500.0, edge_gap_mm=10.0), NestOptions(gap_mm=6.0))
    assert one.plain
    assert one.region("best") is None
    sizes = (one.x_mm, one.y_mm, one.width_mm, one.height_mm)
    assert_near(sizes, (7.0, 7.0, 986.0, 486.0), bound=1e-6, why="slack and hair are under 1e-6")


def test_an_outlined_rectangle_lies_where_it_was_drawn_and_has_the_same_room() -> None:
    one = bed(0, hide("h", SQUARE, edge_gap=10.0), NestOptions(gap_mm=6.0))
    assert_near(on_sheet(one).bounds, (57.0, -23.0, 243.0, 63.0), bound=1e-6, why="slack and hair are under 1e-6")


@pytest.mark.parametrize("edge_gap", [0.0, 2.0])
def test_a_convex_outline_grows_where_half_the_gap_is_more_than_the_edge_gap(edge_gap: float) -> None:
    one = bed(0, hide("h", SQUARE, edge_gap=edge_gap), NestOptions(gap_mm=10.0))
    grown = 5.0 - edge_gap
    wanted = (50.0 - grown, -30.0 - grown, 250.0 + grown, 70.0 + grown)
    assert_near(on_sheet(one).bounds, wanted, bound=1e-6, why="slack and hair are under 1e-6")


def test_a_hollow_outline_never_grows_as_its_narrow_bays_would_close() -> None:
    bay = [(104.0, 100.0), (104.0, 20.0), (96.0, 20.0), (96.0, 100.0)]
    bay += [(0.0, 100.0), (0.0, 0.0), (200.0, 0.0), (200.0, 100.0)]
    one = bed(0, hide("h", bay), NestOptions(gap_mm=20.0))
    assert Polygon(bay).buffer(SLACK_MM).contains(on_sheet(one))


@given(st.floats(200.0, 900.0), st.floats(0.0, 0.4), st.integers(2, 6), st.floats(0.0, 30.0), st.floats(0.0, 20.0))
@settings(max_examples=40, deadline=None)
def test_the_region_of_an_outline_keeps_the_edge_gap(
    radius: float, depth: float, lobes: int, edge_gap: float, gap: float
) -> None:
    corners = lobed(radius, depth, lobes, x=-100.0, y=4000.0)
    one = bed(0, hide("h", corners, edge_gap=edge_gap), NestOptions(gap_mm=gap))
    true = Polygon(corners)
    region = on_sheet(one)
    inset = edge_gap - gap / 2.0
    if inset >= 0.0 and not region.is_empty:
        assert true.exterior.distance(region) >= inset - SLACK_MM
        assert true.contains(region.buffer(-SLACK_MM))
    half = region.buffer(-gap / 2.0)
    if not half.is_empty:
        assert true.exterior.distance(half) >= edge_gap - 1e-3 * max(gap, 1.0), "round buffers err by 1e-3"


def test_arcs_of_an_outline_are_kept_within_and_those_of_a_defect_without() -> None:
    region = on_sheet(bed(0, ROUND, NestOptions()))
    assert np.hypot(*(np.array(region.exterior.coords) - 200.0).T).max() <= 200.0 + SLACK_MM
    assert Point(200.0, 200.0).buffer(50.0, quad_segs=64).intersection(region).area < 1e-6
    assert_near(region.area, np.pi * (200.0**2 - 50.0**2), bound=2.0 * np.pi * 250.0 * 0.3, why="chord error 0.3 mm")


def test_the_sense_of_an_outline_does_not_matter() -> None:
    assert ROUND.outline is not None
    assert area(ROUND.outline) > 0.0
    turned = ROUND.replace(outline=backwards(ROUND.outline), defects=tuple(map(backwards, ROUND.defects)))
    first, second = (on_sheet(bed(0, one, NestOptions(gap_mm=3.0))) for one in (ROUND, turned))
    assert first.symmetric_difference(second).area < 1e-6


@pytest.mark.parametrize(("edge_gap", "grown"), [(8.0, 5.0), (1.0, 0.0)])
def test_defects_grow_by_the_edge_gap_less_half_the_gap_and_never_shrink(edge_gap: float, grown: float) -> None:
    plate = Sheet("s", 100.0, 100.0, edge_gap_mm=edge_gap, defects=(outline(box(20.0, 20.0, 40.0, 40.0)),))
    one = bed(0, plate, NestOptions(gap_mm=6.0))
    (hole,) = on_sheet(one).interiors
    assert_near(Polygon(hole).area, (20.0 + 2.0 * grown) ** 2, bound=1e-4, why="80 mm of edge times the slack")


def test_zones_are_taken_out_for_parts_that_are_better_and_for_no_others() -> None:
    zones = (zone(box(30.0, 100.0), 1), zone(box(30.0, 100.0, x=20.0), 3), zone(box(10.0, 100.0, x=90.0), 3))
    one = bed(0, Sheet("s", 100.0, 100.0, zones=zones), NestOptions())
    areas = {quality: one.room_mm2(quality) for quality in ("any", 0, 1, 2, 3, 4, "best")}
    whole, without_1, without_3 = 10000.0, 7000.0, 4000.0
    wanted = [whole, whole, whole, without_1, without_1, without_3, without_3]
    assert_near(list(areas.values()), wanted, bound=1e-3, why="400 mm of edge times the slack")
    assert one.region("any") is not None
    assert isinstance(one.region("best"), Polygon)


def test_a_thin_zone_never_vanishes() -> None:
    line = zone(box(0.01, 300.0, x=50.0, y=-100.0), 1)
    one = bed(0, Sheet("s", 100.0, 100.0, edge_gap_mm=0.0, zones=(line,)), NestOptions(gap_mm=20.0))
    assert isinstance(one.region("best"), MultiPolygon)
    assert isinstance(one.region("any"), Polygon)


def test_an_outline_with_no_room_left_is_empty() -> None:
    one = bed(0, hide("h", box(20.0, 20.0), edge_gap=15.0), NestOptions())
    assert on_sheet(one).is_empty
    assert (one.width_mm, one.height_mm) == (0.0, 0.0)


def test_a_defect_that_crosses_itself_is_taken_out_with_all_it_encloses() -> None:
    bow = outline([(20.0, 20.0), (40.0, 40.0), (40.0, 20.0), (20.0, 40.0)])
    one = bed(0, Sheet("s", 100.0, 100.0, defects=(bow,)), NestOptions())
    assert_near(on_sheet(one).area, 10000.0 - 200.0, bound=1e-3, why="two triangles of 100 mm2")


def test_a_roll_is_as_long_as_all_its_parts_in_a_row() -> None:
    parts = [disc("d", 50.0, 3), rectangle("r", 300.0, 400.0, 2)]
    options = NestOptions(gap_mm=5.0)
    assert roll_length(parts, options) == pytest.approx(3 * (100.0 * np.sqrt(2.0) + 5.0) + 2 * 505.0)
    (one,) = beds(parts, [roll("r", 600.0, edge_gap=10.0)], options)
    assert np.isfinite(one.width_mm)
    assert one.plain
    assert one.height_mm == pytest.approx(585.0, abs=1e-5)


def costs(*stock: Sheet) -> list[tuple[float, float]]:
    return [(one.cost, one.cost_mm) for one in beds([], stock, NestOptions())]


def test_sheets_count_one_each_unless_all_new_stock_has_a_price_and_remnants_are_free() -> None:
    remnant = Sheet("r", 10.0, 10.0, kind="remnant", price=3.0)
    sheets = Sheet("a", 10.0, 10.0, price=7.0), Sheet("b", 10.0, 10.0)
    assert costs(*sheets, remnant) == [(1.0, 0.0), (1.0, 0.0), (0.0, 0.0)]
    assert costs(sheets[0], remnant, roll("c", 10.0, price=20.0)) == [(7.0, 0.0), (0.0, 0.0), (0.0, 0.02)]
    given = Sheet("g", 10.0, 10.0, price=0.0)
    assert costs(sheets[0], given) == [(7.0, 0.0), (0.0, 0.0)]
    assert costs(given, given) == [(1.0, 0.0)] * 2, "where nothing has a price fewer sheets are still better"
