"""The nest stage as a whole: certified layouts, refusals that name the part, same bytes, engine and its failures."""

import time
from collections.abc import Sequence
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.model.pattern import FlatPattern
from stages.model.report import Outcome
from stages.model.sheet import Nesting, NestOptions, Sheet
from stages.model.tolerances import Tolerances
from stages.nest import nest, nest_with
from stages.nest.search import Engine
from tests.stages.nest.shapes import angle_piece, box, circle, contour, disc, pattern, rectangle, ring, sector

TOL = Tolerances()
PLATE = Sheet("plate", 1000.0, 500.0, edge_gap_mm=10.0)
QUICK = NestOptions(gap_mm=5.0, time_limit_s=0.0)


def run(parts: Sequence[FlatPattern], stock: Sequence[Sheet], options: NestOptions = QUICK) -> Outcome[Nesting | None]:
    return nest(parts, stock, options, TOL)


def made(outcome: Outcome[Nesting | None]) -> Nesting:
    assert outcome.product is not None, outcome.report.findings
    assert outcome.report.passed
    return outcome.product


def codes(outcome: Outcome[Nesting | None]) -> list[str]:
    return [finding.code for finding in outcome.report.findings]


def mixture(quantity: int) -> list[FlatPattern]:
    return [
        rectangle("plate", 120.0, 80.0, quantity),
        angle_piece("angle", 140.0, 30.0, quantity),
        sector("sector", 100.0, 160.0, 100.0, quantity),
        ring("ring", 70.0, 45.0, quantity),
        disc("disc", 25.0, quantity),
    ]


def test_a_mixture_on_one_sheet_is_certified_without_the_engine() -> None:
    outcome = nest_with(mixture(1), [PLATE], NestOptions(gap_mm=5.0), TOL, Engine(0, command=["no such engine"]))
    layout = made(outcome)
    assert len(layout.layouts) == 1
    assert outcome.report.metric("min_gap_mm").value >= 5.0 - 1e-6
    assert outcome.report.metric("min_edge_gap_mm").value >= 10.0 - 1e-6
    assert outcome.report.metric("overlap_mm2").value == 0.0
    assert codes(outcome) == []


def test_the_same_job_twice_gives_the_same_placements() -> None:
    first, second = (repr(made(run(mixture(3), [PLATE]))) for _ in range(2))
    assert first == second


def test_copies_and_sheets_count_from_one() -> None:
    layout = made(run([rectangle("a", 600.0, 300.0, 3)], [PLATE]))
    assert [(one.sheet.id, one.index) for one in layout.layouts] == [("plate", 1), ("plate", 2), ("plate", 3)]
    assert [one.placements[0].copy for one in layout.layouts] == [1, 2, 3]


def test_each_sheet_tells_how_much_of_it_is_used() -> None:
    layout = made(run([rectangle("a", 600.0, 300.0, 2)], [PLATE]))
    assert [one.utilisation for one in layout.layouts] == [pytest.approx(0.36)] * 2


def test_boxes_that_fit_exactly_fill_the_sheet() -> None:
    sheet = Sheet("s", 4 * 100.0 + 3 * 5.0 + 20.0, 3 * 50.0 + 2 * 5.0 + 20.0, quantity=1, edge_gap_mm=10.0)
    outcome = run([rectangle("a", 100.0, 50.0, 12, rotations=(0.0,))], [sheet])
    assert len(made(outcome).layouts) == 1
    assert outcome.report.metric("min_gap_mm").value == pytest.approx(5.0, abs=1e-6)


def test_without_a_gap_boxes_tile_the_sheet() -> None:
    outcome = run([rectangle("a", 100.0, 50.0, 20)], [Sheet("s", 500.0, 200.0, 1)], NestOptions(time_limit_s=0.0))
    assert made(outcome).layouts[0].utilisation == pytest.approx(1.0)


def test_the_edge_gap_may_be_smaller_than_half_the_gap() -> None:
    sheet = Sheet("s", 210.0, 50.0, quantity=1, edge_gap_mm=0.0)
    outcome = run([rectangle("a", 100.0, 50.0, 2, rotations=(0.0,))], [sheet], NestOptions(10.0, time_limit_s=0.0))
    assert outcome.report.metric("min_gap_mm").value == pytest.approx(10.0, abs=1e-6)
    assert outcome.report.metric("min_edge_gap_mm").value == pytest.approx(0.0, abs=1e-6)


def test_a_part_exactly_as_large_as_the_usable_sheet_fits() -> None:
    assert made(run([rectangle("a", 980.0, 480.0)], [PLATE]))


def test_a_part_that_is_too_large_is_named_with_its_size_and_the_room() -> None:
    outcome = run([disc("ok", 30.0), rectangle("beam", 1200.0, 30.0)], [PLATE, Sheet("tiny", 10.0, 10.0)])
    assert outcome.product is None
    assert codes(outcome) == ["part-too-large"]
    message = outcome.report.findings[0].message
    assert all(word in message for word in ("'beam'", "1200 x 30", "980 x 480"))
    assert not outcome.report.passed


def test_the_room_is_that_of_a_roll_of_any_length_and_never_negative() -> None:
    roll = Sheet("roll", np.inf, 300.0, kind="roll", edge_gap_mm=10.0)
    cramped = Sheet("cramped", 900.0, 900.0, edge_gap_mm=800.0)
    wide = [rectangle("wide", 400.0, 400.0)]
    for stock, room in (([roll], "any length x 280 mm"), ([Sheet("s", 200.0, 200.0), cramped], "200 x 200 mm")):
        outcome = run(wide, stock)
        assert "part-too-large" in codes(outcome)
        assert outcome.report.findings[-1].message.endswith(f"has room for {room}")


def test_a_part_that_finds_no_place_beside_defects_is_not_said_to_fit_nowhere() -> None:
    eaten = Sheet("s", 200.0, 100.0, defects=(contour(box(20.0, 100.0, 90.0, 0.0)).path,))
    outcome = run([rectangle("a", 120.0, 80.0)], [eaten])
    assert codes(outcome) == ["part-too-large"]
    assert "found no place even on an empty sheet" in outcome.report.findings[0].message


def test_a_part_may_fit_along_the_diagonal_only_if_it_may_be_turned() -> None:
    square = Sheet("s", 900.0, 900.0)
    assert made(run([rectangle("beam", 1100.0, 40.0)], [square]))
    assert codes(run([rectangle("beam", 1100.0, 40.0, rotations=(0.0, 90.0))], [square])) == ["part-too-large"]


def test_a_part_that_must_not_be_turned_is_too_large_upright() -> None:
    assert codes(run([rectangle("a", 400.0, 900.0, rotations=(0.0,))], [PLATE])) == ["part-too-large"]
    assert made(run([rectangle("a", 400.0, 900.0, rotations=(0.0, 90.0))], [PLATE]))


def test_stock_that_does_not_suffice_is_told_with_the_copies_left() -> None:
    few = Sheet("plate", 1000.0, 500.0, quantity=2, edge_gap_mm=10.0)
    outcome = run([rectangle("a", 600.0, 300.0, 5)], [few])
    assert outcome.product is None
    assert codes(outcome) == ["stock-exhausted"]
    assert "3 of 'a' (600 x 300 mm)" in outcome.report.findings[0].message


def test_no_stock_at_all_is_a_finding() -> None:
    assert codes(run([disc("d", 5.0)], [])) == ["no-stock"]


def test_more_copies_than_are_searched_are_placed_all_the_same_and_that_is_said(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    engine = Engine(0, command=["no such engine"])
    parts, options = [rectangle("a", 600.0, 300.0, 5)], NestOptions(gap_mm=5.0, time_limit_s=1.0)
    monkeypatch.setattr("stages.nest.MANY", 4)
    monkeypatch.setattr("stages.nest.search.MANY", 4)
    outcome = nest_with(parts, [PLATE], options, TOL, engine)
    assert len(made(outcome).layouts) == 5
    assert (codes(outcome), engine.runs) == (["not-searched"], 0)
    assert "5 copies" in outcome.report.findings[0].message


def test_nothing_to_place_is_an_empty_nest() -> None:
    assert made(run([], [PLATE])).layouts == ()
    assert made(run([disc("d", 5.0, 0)], [PLATE])).layouts == ()


def test_the_smallest_sheet_that_takes_all_is_used() -> None:
    stock = [Sheet("large", 2000.0, 1000.0), Sheet("small", 300.0, 300.0), Sheet("middle", 600.0, 500.0)]
    assert [one.sheet.id for one in made(run([rectangle("a", 250.0, 400.0)], stock)).layouts] == ["middle"]


def test_a_limited_stock_is_followed_by_the_next_one() -> None:
    stock = [Sheet("large", 620.0, 310.0, quantity=1), Sheet("small", 310.0, 310.0)]
    layout = made(run([rectangle("a", 290.0, 290.0, 4, rotations=(0.0,))], stock))
    assert [one.sheet.id for one in layout.layouts] == ["large", "small", "small"]


def test_parts_that_fit_the_large_sheets_only_go_there_first() -> None:
    stock = [Sheet("large", 620.0, 310.0, quantity=1), Sheet("small", 310.0, 310.0)]
    layout = made(run([rectangle("a", 290.0, 290.0, 1), rectangle("long", 600.0, 200.0)], stock))
    where = {one.part: sheet.sheet.id for sheet in layout.layouts for one in sheet.placements}
    assert where == {"long": "large", "a": "small"}


def test_a_small_part_goes_into_the_hole_of_a_ring_and_is_cut_before_it() -> None:
    sheet = Sheet("s", 220.0, 220.0, quantity=1, edge_gap_mm=5.0)
    outcome = run([ring("ring", 100.0, 80.0), disc("chip", 60.0)], [sheet])
    assert [one.part for one in made(outcome).layouts[0].placements] == ["chip", "ring"]
    assert outcome.report.metric("min_gap_mm").value >= 5.0 - 1e-6


def test_listed_angles_are_kept_and_nothing_is_mirrored() -> None:
    parts = [part.replace(rotations=(0.0, 180.0)) for part in mixture(2)]
    layout = made(run(parts, [PLATE]))
    motions = [one.motion for sheet in layout.layouts for one in sheet.placements]
    assert {motion.angle_deg for motion in motions} <= {0.0, 180.0}
    assert not any(motion.mirrored for motion in motions)


def test_hollow_parts_lie_in_one_another() -> None:
    arcs = [sector("arc", 180.0, 220.0, 120.0, 9)]
    layout = made(run(arcs, [Sheet("s", 1000.0, 500.0)], NestOptions(gap_mm=2.0, time_limit_s=0.0)))
    assert len(layout.layouts) == 1, "as boxes, 381 x 130, only seven fit"


@given(st.lists(st.sampled_from(mixture(1)), min_size=1, max_size=5), st.floats(0.0, 12.0), st.floats(0.0, 12.0))
@settings(max_examples=12, deadline=None)
def test_every_first_placement_passes_the_certifier(parts: list[FlatPattern], gap: float, edge: float) -> None:
    named = [part.replace(part=f"{part.part}-{number}", quantity=2) for number, part in enumerate(parts)]
    outcome = run(named, [Sheet("s", 400.0, 350.0, edge_gap_mm=edge)], NestOptions(gap, time_limit_s=0.0))
    made(outcome)
    assert codes(outcome) == []


def test_hundred_parts_come_quickly() -> None:
    start = time.monotonic()
    made(run(mixture(20), [PLATE]))
    assert time.monotonic() - start < 20.0, "about 1 s on an idle core"


def test_all_corners_of_a_tiled_sheet_are_taken() -> None:
    sheet = Sheet("s", 210.0, 110.0, quantity=1, edge_gap_mm=5.0)
    frame = pattern("f", contour(box(95.0, 45.0)), quantity=4, rotations=(0.0,))
    layout = made(run([frame], [sheet], NestOptions(10.0, time_limit_s=0.0)))
    corners = {(round(one.motion.x, 6), round(one.motion.y, 6)) for one in layout.layouts[0].placements}
    assert corners == set(product((5.0, 110.0), (5.0, 60.0)))


def test_the_circle_helper_has_the_area_of_a_circle() -> None:
    outcome = run([pattern("c", circle(50.0))], [Sheet("s", 200.0, 200.0)])
    assert outcome.report.metric("utilisation").value == pytest.approx(np.pi * 2500.0 / 40000.0)
