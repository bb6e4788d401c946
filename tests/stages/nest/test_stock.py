"""The first placement on any stock: hides, zones, grain, rolls, remnants, prices, pairs, fixed copies, offcuts."""

import math
from collections.abc import Sequence
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import Polygon

from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import bounds, polygon, transform
from stages.model.pattern import FlatPattern
from stages.model.report import Outcome
from stages.model.sheet import Nesting, NestOptions, Placement, Rectangle, Sheet, SheetLayout
from stages.model.tolerances import Tolerances
from stages.nest import nest
from tests.stages.nest.shapes import angle_piece, box, disc, rectangle, ring, sector
from tests.stages.nest.stock import hide, lobed, outline, roll, zone
from tests.stages.nest.test_nest import mixture

TOL = Tolerances()
QUICK = NestOptions(gap_mm=4.0, time_limit_s=0.0)
EXACT = NestOptions(time_limit_s=0.0)
FINE_MM = 0.01


def run(
    parts: Sequence[FlatPattern], stock: Sequence[Sheet], options: NestOptions = QUICK, fixed: Nesting | None = None
) -> Outcome[Nesting | None]:
    return nest(parts, stock, options, TOL, fixed)


def made(outcome: Outcome[Nesting | None]) -> Nesting:
    assert outcome.product is not None, outcome.report.findings
    assert not outcome.report.findings
    assert outcome.report.passed
    return outcome.product


def where(layout: SheetLayout, parts: Sequence[FlatPattern]) -> list[tuple[Placement, Polygon]]:
    """Each placement with the polygon of its outer contour on the sheet."""
    paths = {part.part: part.outer.path for part in parts}
    return [
        (one, Polygon(polygon(transform(paths[one.part], one.motion), accuracy=FINE_MM))) for one in layout.placements
    ]


@given(st.integers(2, 5), st.floats(0.0, 0.35), st.floats(0.0, 12.0), st.floats(0.0, 12.0), st.booleans())
@settings(max_examples=3, deadline=None)
def test_every_first_placement_on_a_hide_passes_the_certifier(
    lobes: int, depth: float, gap: float, edge: float, mirror: bool
) -> None:
    leather = hide(
        "hide",
        lobed(500.0, depth, lobes, x=2000.0, y=-700.0),
        edge_gap=edge,
        quantity=9,
        defects=(outline(box(60.0, 40.0, x=1900.0, y=-700.0)),),
        zones=(zone(lobed(150.0, 0.2, 3, x=2200.0, y=-800.0), 2),),
        grain_deg=30.0,
    )
    first, angle, _, hollow, _ = mixture(1)
    parts = [first.replace(quality="any", axis_deg=90.0, axis_band_deg=10.0), angle, hollow]
    layout = made(run(parts, [leather], NestOptions(gap, mirror=mirror, time_limit_s=0.0)))
    for one in layout.layouts:
        true = Polygon(lobed(500.0, depth, lobes, x=2000.0, y=-700.0))
        assert all(true.buffer(2.0 * FINE_MM).contains(shape) for _, shape in where(one, parts)), "on polygons too"


def test_parts_lie_around_a_defect_and_keep_the_edge_gap_to_it() -> None:
    hole = outline(box(20.0, 200.0, x=140.0, y=-50.0))
    plate = Sheet("s", 300.0, 100.0, 1, 5.0, defects=(hole,))
    parts = [rectangle("a", 128.0, 90.0, 2, rotations=(0.0,))]
    outcome = run(parts, [plate])
    first, second = (bounds(transform(parts[0].outer.path, one.motion)) for one in made(outcome).layouts[0].placements)
    assert first[0] == pytest.approx(5.0, abs=1e-5)
    assert second[0] == pytest.approx(165.0, abs=1e-5)


def test_only_parts_that_accept_its_quality_lie_in_a_zone() -> None:
    plate = Sheet("s", 200.0, 100.0, 1, zones=(zone(box(100.0, 100.0), 2),))
    good = rectangle("good", 98.0, 98.0)
    for quality, ok in (("best", True), (3, True), (2, False), ("any", False)):
        parts = [good, rectangle("poor", 98.0, 98.0).replace(quality="any")]
        layout = made(run([parts[0].replace(quality=quality), parts[1]], [plate], EXACT)).layouts[0]
        x = {one.part: bounds(transform(good.outer.path, one.motion))[0] for one in layout.placements}
        assert not ok or (x["good"] >= 100.0 - 1e-6 and x["poor"] < 100.0)
    assert run([good.replace(quantity=2)], [plate], EXACT).product is None


def test_a_part_too_large_for_every_good_spot_is_named() -> None:
    plate = Sheet("s", 200.0, 100.0, zones=(zone(box(100.0, 100.0), 2),))
    outcome = run([rectangle("wide", 120.0, 20.0, rotations=(0.0, 90.0))], [plate], EXACT)
    assert [finding.code for finding in outcome.report.findings] == ["part-too-large"]
    assert "'wide'" in outcome.report.findings[0].message


def test_grain_turns_a_part_within_its_band_and_no_further() -> None:
    plate = Sheet("s", 400.0, 400.0, grain_deg=90.0)
    parts = [rectangle("a", 300.0, 20.0, 3).replace(axis_deg=0.0, axis_band_deg=20.0)]
    for one in made(run(parts, [plate])).layouts[0].placements:
        assert abs(one.motion.angle_deg % 180.0 - 90.0) <= 20.0 + 1e-9
    narrow = Sheet("s", 400.0, 285.0, grain_deg=90.0)
    outcome = run(parts, [narrow])
    assert [finding.code for finding in outcome.report.findings] == ["part-too-large"]
    assert "70 to 110" in outcome.report.findings[0].message


def test_a_part_that_fits_only_inside_its_band_is_laid_there() -> None:
    length, thick, size = 380.0, 2.0, 350.0
    parts = [rectangle("bar", length, thick).replace(axis_deg=0.0, axis_band_deg=45.0)]
    plate = Sheet("s", 400.0, size, grain_deg=90.0)
    angle = made(run(parts, [plate], EXACT)).layouts[0].placements[0].motion.angle_deg
    turn = math.radians(angle)
    assert length * abs(math.sin(turn)) + thick * abs(math.cos(turn)) <= size + 1e-6


def test_every_second_copy_of_a_pair_is_mirrored_and_no_other_part_is() -> None:
    parts = [angle_piece("pair", 100.0, 30.0, 5).replace(pair=True), angle_piece("single", 90.0, 20.0, 3)]
    layout = made(run(parts, [Sheet("s", 500.0, 500.0)]))
    mirrored = {(one.part, one.copy) for sheet in layout.layouts for one in sheet.placements if one.motion.mirrored}
    assert mirrored == {("pair", 2), ("pair", 4)}


def test_mirroring_lets_a_part_lie_where_it_does_not_fit_otherwise() -> None:
    hand = [(0.0, 0.0), (300.0, 0.0), (300.0, 50.0), (50.0, 50.0), (50.0, 150.0), (0.0, 150.0)]
    other = [(300.0 - x, y) for x, y in reversed(hand)]
    part = rectangle("hand", 1.0, 1.0)
    part = part.replace(outer=type(part.outer)((), outline(hand), 0.0), rotations=(0.0,))
    leather = hide("h", [(x * 1.02, y * 1.02) for x, y in other], quantity=None)
    assert run([part], [leather], EXACT).product is None
    layout = made(run([part], [leather], NestOptions(mirror=True, time_limit_s=0.0)))
    assert layout.layouts[0].placements[0].motion.mirrored


def test_all_copies_lie_in_one_direction_on_request_over_all_sheets() -> None:
    parts = [sector("bow", 100.0, 160.0, 100.0, 2), angle_piece("angle", 140.0, 30.0, 3).replace(pair=True)]
    plate = Sheet("s", 280.0, 180.0)
    angles = set()
    for option in (False, True):
        layout = made(run(parts, [plate], NestOptions(4.0, one_direction=option, time_limit_s=0.0)))
        motions = [(one.part, one.motion) for sheet in layout.layouts for one in sheet.placements]
        angles = {(part, motion.mirrored, motion.angle_deg) for part, motion in motions}
        assert len(layout.layouts) > 1
        assert (len(angles) == 3) == option, "one for the bow, one for each hand of the angle"


def test_a_roll_is_used_from_its_left_end_and_as_short_as_boxes_allow() -> None:
    parts = [rectangle("a", 100.0, 50.0, 12, rotations=(0.0,))]
    outcome = run(parts, [roll("r", 220.0, edge_gap=10.0)], NestOptions(10.0 / 3.0, time_limit_s=0.0))
    layout = made(outcome).layouts[0]
    end = max(bounds(transform(parts[0].outer.path, one.motion))[2] for one in layout.placements)
    assert end == pytest.approx(10.0 + 4 * 100.0 + 3 * 10.0 / 3.0 + 0.0, abs=1.0) or end < 430.0
    assert layout.sheet.is_roll
    assert layout.offcut is None
    assert 0.0 < layout.utilisation < 1.0


def test_parts_on_a_roll_lie_around_its_defects() -> None:
    bad = outline(box(50.0, 300.0, x=100.0, y=-50.0))
    parts = [rectangle("a", 95.0, 190.0, 3, rotations=(0.0,))]
    layout = made(run(parts, [roll("r", 200.0, defects=(bad,))], EXACT)).layouts[0]
    low = sorted(bounds(transform(parts[0].outer.path, one.motion))[0] for one in layout.placements)
    assert low[0] < 5.0 + 1e-6
    assert low[1] == pytest.approx(150.0, abs=1e-5)
    assert low[2] == pytest.approx(245.0, abs=1e-5)


def test_stock_on_which_nothing_fits_is_left_aside() -> None:
    stock = [roll("narrow", 20.0), Sheet("none", 8.0, 300.0, edge_gap_mm=4.0), Sheet("s", 320.0, 320.0)]
    outcome = run([rectangle("a", 300.0, 300.0)], stock)
    assert outcome.product is not None
    assert [one.sheet.id for one in outcome.product.layouts] == ["s"]
    assert [finding.code for finding in outcome.report.findings] == ["stock-no-room"]


def test_remnants_are_used_before_new_sheets() -> None:
    stock = [Sheet("new", 1000.0, 1000.0), Sheet("rest", 320.0, 320.0, 2, kind="remnant")]
    layout = made(run([rectangle("a", 300.0, 300.0, 3)], stock))
    assert [one.sheet.id for one in layout.layouts] == ["rest", "rest", "new"]


def test_with_prices_the_least_total_counts_and_not_the_fewest_sheets() -> None:
    large, small = Sheet("large", 640.0, 320.0, price=100.0), Sheet("small", 320.0, 320.0, price=30.0)
    parts = [rectangle("a", 300.0, 300.0, 2)]
    assert [one.sheet.id for one in made(run(parts, [large, small])).layouts] == ["small", "small"]
    cheap = [large.replace(price=50.0), small]
    assert [one.sheet.id for one in made(run(parts, cheap)).layouts] == ["large"]
    unknown = [large, small.replace(price=None)]
    assert [one.sheet.id for one in made(run(parts, unknown)).layouts] == ["large"]


def test_hard_parts_take_the_good_hide_and_the_others_the_bad_one() -> None:
    poor = hide("poor", box(310.0, 310.0), zones=(zone(box(310.0, 310.0), 1),))
    good = hide("good", box(310.0, 310.0, x=1000.0))
    parts = [rectangle("easy", 300.0, 300.0).replace(quality="any"), rectangle("hard", 290.0, 290.0)]
    layout = made(run(parts, [poor, good]))
    assert {one.placements[0].part: one.sheet.id for one in layout.layouts} == {"easy": "poor", "hard": "good"}


FIXED = Placement("a", 2, Rigid2(123.456, 78.9, 17.0), fixed=True)


def test_a_fixed_copy_stays_and_the_others_are_placed_around_it() -> None:
    plate = Sheet("s", 600.0, 400.0, edge_gap_mm=5.0)
    parts = [rectangle("a", 200.0, 100.0, 3), ring("ring", 60.0, 30.0, 2), disc("d", 20.0, 4)]
    layout = made(run(parts, [plate], QUICK, Nesting((SheetLayout(plate, 1, (FIXED,), 0.0),))))
    placements = [one for sheet in layout.layouts for one in sheet.placements]
    assert FIXED in placements
    assert sorted(one.copy for one in placements if one.part == "a") == [1, 2, 3]
    assert sum(one.fixed for one in placements) == 1


def test_a_whole_layout_given_back_comes_out_as_it_went_in() -> None:
    parts, plates = mixture(3), [Sheet("s", 400.0, 350.0, edge_gap_mm=5.0)]
    first = made(run(parts, plates))
    assert len(first.layouts) > 1
    assert repr(made(run(parts, plates, QUICK, first))) == repr(first)
    shuffled = Nesting(tuple(replace(one, placements=one.placements[::-1]) for one in first.layouts))
    again = made(run(parts, plates, QUICK, shuffled))
    assert [one.placements for one in again.layouts] == [one.placements for one in first.layouts]


def test_fixed_copies_of_a_pair_leave_the_numbers_of_their_hand() -> None:
    plate = Sheet("s", 600.0, 400.0)
    parts = [angle_piece("a", 100.0, 30.0, 4).replace(pair=True)]
    fixed = Placement("a", 4, Rigid2(300.0, 200.0, 0.0, mirrored=True), fixed=True)
    layout = made(run(parts, [plate], QUICK, Nesting((SheetLayout(plate, 1, (fixed,), 0.0),)))).layouts[0]
    assert sorted((one.copy, one.motion.mirrored) for one in layout.placements) == [
        (1, False),
        (2, True),
        (3, False),
        (4, True),
    ]


def test_fixed_copies_give_the_direction_of_the_others() -> None:
    plate = Sheet("s", 900.0, 900.0)
    parts = [rectangle("a", 200.0, 100.0, 4)]
    fixed = Nesting((SheetLayout(plate, 1, (FIXED,), 0.0),))
    layout = made(run(parts, [plate], NestOptions(4.0, one_direction=True, time_limit_s=0.0), fixed))
    assert {one.motion.angle_deg for sheet in layout.layouts for one in sheet.placements} == {17.0}


def test_a_fixed_copy_that_lies_on_another_is_found_by_the_certifier() -> None:
    plate = Sheet("s", 600.0, 400.0)
    parts = [rectangle("a", 200.0, 100.0, 2)]
    both = (FIXED, Placement("a", 1, Rigid2(130.0, 80.0, 17.0)))
    outcome = run(parts, [plate], QUICK, Nesting((SheetLayout(plate, 1, both, 0.0),)))
    assert outcome.product is None
    *faults, last = outcome.report.findings
    assert {(one.where or {}).get("sheet") for one in faults} == {"s-1"}
    assert (last.code, last.fatal) == ("no-layout", True)
    assert "in the one that is given move the copies that are named" in last.message


@pytest.mark.parametrize("wrong", ["part", "sheet"])
def test_fixed_placements_of_what_is_not_there_are_a_mistake_of_the_caller(wrong: str) -> None:
    plate = Sheet("s", 600.0, 400.0)
    sheet = plate if wrong == "part" else Sheet("other", 600.0, 400.0)
    placement = Placement("b" if wrong == "part" else "a", 1, Rigid2())
    with pytest.raises(ValueError, match="which"):
        run([rectangle("a", 20.0, 10.0)], [plate], QUICK, Nesting((SheetLayout(sheet, 1, (placement,), 0.0),)))


def offcut(options: NestOptions, plate: Sheet, *parts: FlatPattern) -> Rectangle | None:
    return made(run(parts, [plate], options)).layouts[-1].offcut


def test_the_offcut_is_the_larger_straight_rest_a_gap_away_from_the_parts() -> None:
    options = NestOptions(gap_mm=8.0, time_limit_s=0.0)
    wide = offcut(options, Sheet("s", 1000.0, 400.0, edge_gap_mm=10.0), rectangle("a", 300.0, 380.0, rotations=(0.0,)))
    assert wide is not None
    assert (wide.x, wide.y, wide.height_mm) == (pytest.approx(318.0, abs=1e-5), 0.0, 400.0)
    assert wide.x + wide.width_mm == pytest.approx(1000.0)
    high = offcut(options, Sheet("s", 400.0, 1000.0, edge_gap_mm=10.0), rectangle("a", 380.0, 300.0, rotations=(0.0,)))
    assert high is not None
    assert (high.x, high.y, high.width_mm) == (0.0, pytest.approx(318.0, abs=1e-5), 400.0)


def test_what_is_left_is_scrap_below_the_least_size_and_on_hides() -> None:
    part = rectangle("a", 300.0, 380.0, rotations=(0.0,))
    plate = Sheet("s", 450.0, 400.0, edge_gap_mm=10.0)
    assert offcut(NestOptions(offcut_min_mm=139.0, time_limit_s=0.0), plate, part) is not None
    assert offcut(NestOptions(offcut_min_mm=141.0, time_limit_s=0.0), plate, part) is None
    assert offcut(EXACT, hide("h", box(1000.0, 400.0)), part) is None
    full = rectangle("a", 450.0, 400.0, rotations=(0.0,))
    whole = NestOptions(offcut_min_mm=0.0, time_limit_s=0.0)
    assert offcut(whole, Sheet("s", 450.0, 400.0), full) is None, "a strip of no width is no rest"
