"""The gate: every bad input of parts, stock and options is refused at once, by name; what is merely odd passes."""

import time
from dataclasses import replace

import numpy as np
import pytest

from stages.geometry.paths.arcpath import ArcPath, area, backwards
from stages.model.pattern import Contour, FlatPattern
from stages.model.report import Outcome
from stages.model.sheet import Nesting, NestOptions, Sheet, Zone
from stages.model.tolerances import Tolerances
from stages.nest import nest
from stages.nest.gate import oriented, troubles
from tests.stages.nest.shapes import Corners, box, circle, contour, disc, pattern, rectangle, ring

PLATE = Sheet("plate", 1000.0, 500.0, edge_gap_mm=10.0)
QUICK = NestOptions(gap_mm=5.0, time_limit_s=0.0)
GOOD = rectangle("good", 100.0, 50.0)
LIMIT_S = 10.0
"""Of processor time, with checks of shapes and other work on the machine; a free core takes under a quarter of it."""


def raw(corners: Corners, *, closed: bool = True) -> Contour:
    """Return a contour as it is given, whichever way round it runs."""
    return Contour((), ArcPath(np.array(corners, dtype=float), np.zeros(len(corners)), closed), 0.0)


def bad(outer: Contour, *inner: Contour) -> FlatPattern:
    return pattern("bad", outer, *inner)


def hole(corners: Corners) -> Contour:
    return contour(corners, hole=True)


BOW_TIE: Corners = [(0.0, 0.0), (100.0, 100.0), (100.0, 0.0), (0.0, 100.0)]
LOOPED: Corners = [
    (0.0, 0.0),
    (300.0, 0.0),
    (300.0, 100.0),
    (200.0, 100.0),
    (200.0, -50.0),
    (100.0, -50.0),
    (0.0, 100.0),
]
SPIKED: Corners = [(0.0, 0.0), (100.0, 0.0), (100.0, 50.0), (100.0, 90.0), (100.0, 50.0), (0.0, 50.0)]

PARTS: dict[str, tuple[FlatPattern, str, str]] = {
    "a bow-tie without area": (bad(raw(BOW_TIE)), "contour", "the outline crosses itself"),
    "an outline that crosses itself": (bad(raw(LOOPED)), "contour", "the outline crosses itself"),
    "no area": (bad(raw([(0.0, 0.0), (100.0, 0.0), (50.0, 0.0)])), "contour", "encloses no area"),
    "two points": (bad(raw([(0.0, 0.0), (100.0, 0.0)])), "contour", "encloses no area"),
    "one point": (bad(raw([(5.0, 5.0)] * 3)), "contour", "encloses no area"),
    "a spike": (bad(raw(SPIKED)), "contour", "runs back along itself over 40 mm"),
    "an open outline": (bad(raw(box(50.0, 50.0), closed=False)), "contour", "the outline is not closed"),
    "a hole that crosses itself": (
        bad(contour(box(300.0, 300.0)), raw([(x + 50.0, y + 50.0) for x, y in BOW_TIE])),
        "contour",
        "hole 1 crosses itself",
    ),
    "a hole outside": (bad(contour(box(100.0, 50.0)), hole(box(10.0, 10.0, 200.0))), "hole-outside", "hole 1"),
    "a hole across the outline": (
        bad(contour(box(100.0, 50.0)), hole(box(20.0, 10.0, 90.0))),
        "hole-outside",
        "hole 1",
    ),
    "a hole round the part": (
        bad(contour(box(100.0, 50.0)), hole(box(300.0, 300.0, -100.0, -100.0))),
        "hole-outside",
        "",
    ),
    "holes that cross": (
        bad(contour(box(100.0, 50.0)), hole(box(20.0, 20.0, 10.0, 10.0)), hole(box(20.0, 20.0, 25.0, 15.0))),
        "hole-overlap",
        "holes 1 and 2",
    ),
    "a hole in a hole": (
        bad(contour(box(100.0, 50.0)), hole(box(40.0, 40.0, 5.0, 5.0)), hole(box(10.0, 10.0, 15.0, 15.0))),
        "hole-overlap",
        "holes 1 and 2",
    ),
    "fewer than no copies": (GOOD.replace(part="bad", quantity=-1), "quantity", "-1"),
    "an angle that is no number": (GOOD.replace(part="bad", rotations=(0.0, np.nan)), "not-finite", "angle"),
    "an axis that is not finite": (GOOD.replace(part="bad", axis_deg=np.inf), "not-finite", "angle"),
    "no angle at all": (GOOD.replace(part="bad", rotations=()), "no-angle", "no angle"),
    "too long": (rectangle("bad", 2000.0, 20.0), "part-too-large", "2000 x 20"),
    "too high as it must lie": (rectangle("bad", 20.0, 481.0, rotations=(0.0,)), "part-too-large", "20 x 481"),
}


def refused(outcome: Outcome[Nesting | None]) -> list[str]:
    """Return the codes of a refusal."""
    assert outcome.product is None
    return [finding.code for finding in outcome.report.findings if finding.fatal]


@pytest.mark.parametrize("name", PARTS)
def test_a_part_that_cannot_be_placed_is_refused_at_once_by_name(name: str) -> None:
    part, code, reason = PARTS[name]
    start = time.process_time()
    outcome = nest([GOOD, part], [PLATE], QUICK, Tolerances())
    assert time.process_time() - start < LIMIT_S
    assert refused(outcome) == [code]
    (finding,) = outcome.report.findings
    assert "'bad'" in finding.message
    assert reason in finding.message
    assert finding.where == {"part": "bad"}


CROSSED = contour(box(100.0, 100.0)).path, raw(BOW_TIE).path
STOCK: dict[str, tuple[list[Sheet], str, str]] = {
    "none": ([], "no-stock", "no stock"),
    "none left": ([replace(PLATE, quantity=0)], "no-stock", "no stock"),
    "the same name twice": ([PLATE, PLATE], "stock-duplicate", "'plate'"),
    "no height": ([replace(PLATE, height_mm=0.0)], "stock-invalid", "1000 x 0 mm"),
    "a negative width": ([replace(PLATE, width_mm=-5.0)], "stock-invalid", "-5 x 500 mm"),
    "a height that is no number": ([replace(PLATE, height_mm=np.nan)], "stock-invalid", "nan"),
    "a sheet without end": ([replace(PLATE, width_mm=np.inf)], "stock-invalid", "only a roll"),
    "fewer than no sheets": ([replace(PLATE, quantity=-2)], "stock-invalid", "-2"),
    "a negative edge gap": ([replace(PLATE, edge_gap_mm=-1.0)], "stock-invalid", "edge gap"),
    "an edge gap that is no number": ([replace(PLATE, edge_gap_mm=np.nan)], "stock-invalid", "edge gap"),
    "an edge gap that leaves no room": ([replace(PLATE, edge_gap_mm=250.0)], "stock-no-room", "250 mm"),
    "an edge gap as wide as a hide": (
        [replace(PLATE, outline=circle(200.0).path, edge_gap_mm=201.0)],
        "stock-no-room",
        "201",
    ),
    "a grain that is no number": ([replace(PLATE, grain_deg=np.nan)], "stock-invalid", "grain"),
    "a negative price": ([replace(PLATE, price=-1.0)], "stock-invalid", "the price is -1"),
    "a price that is no number": ([replace(PLATE, price=np.nan)], "stock-invalid", "the price is nan"),
    "an outline that crosses itself": ([replace(PLATE, outline=CROSSED[1])], "stock-invalid", "the outline crosses"),
    "a defect that crosses itself": ([replace(PLATE, defects=CROSSED)], "stock-invalid", "defect 2 crosses itself"),
    "a zone that crosses itself": ([replace(PLATE, zones=(Zone(CROSSED[1], 1),))], "stock-invalid", "zone 1 crosses"),
    "a defect without area": (
        [replace(PLATE, defects=(raw([(0.0, 0.0), (9.0, 9.0)]).path,))],
        "stock-invalid",
        "defect 1",
    ),
}


@pytest.mark.parametrize("name", STOCK)
def test_stock_that_is_no_stock_is_refused_at_once_by_name(name: str) -> None:
    stock, code, reason = STOCK[name]
    start = time.process_time()
    outcome = nest([GOOD], stock, QUICK, Tolerances())
    assert time.process_time() - start < LIMIT_S
    assert refused(outcome) == [code]
    assert reason in outcome.report.findings[0].message


OPTIONS = {
    "a negative gap": (NestOptions(gap_mm=-1.0), "gap_mm"),
    "a gap that is no number": (NestOptions(gap_mm=np.nan), "gap_mm"),
    "a gap without end": (NestOptions(gap_mm=np.inf), "gap_mm"),
    "a gap wider than the sheet": (NestOptions(gap_mm=1200.0), "gap_mm"),
    "a negative time": (NestOptions(time_limit_s=-1.0), "time_limit_s"),
    "a negative kerf": (NestOptions(kerf_mm=-0.1), "kerf_mm"),
    "no angles": (NestOptions(rotations=()), "rotations"),
    "an angle that is no number": (NestOptions(rotations=(np.nan,)), "rotations"),
}


@pytest.mark.parametrize("name", OPTIONS)
def test_wishes_that_mean_nothing_are_refused_at_once(name: str) -> None:
    options, which = OPTIONS[name]
    outcome = nest([GOOD], [PLATE], replace(options, time_limit_s=min(options.time_limit_s, 0.0)), Tolerances())
    assert refused(outcome) == ["option"]
    assert outcome.report.findings[0].where == {"option": which}


def test_two_parts_of_one_name_are_refused() -> None:
    outcome = nest([GOOD, GOOD], [PLATE], QUICK, Tolerances())
    assert refused(outcome) == ["part-duplicate"]
    assert "'good'" in outcome.report.findings[0].message


def test_numbers_that_are_not_finite_make_no_contour_at_all() -> None:
    for value in (np.nan, np.inf):
        with pytest.raises(ValueError, match="finite"):
            raw([(0.0, 0.0), (value, 0.0), (1.0, 1.0)])


def test_every_trouble_is_told_not_the_first() -> None:
    parts = [GOOD.replace(part="a", quantity=-1), bad(raw(BOW_TIE))]
    found = troubles(parts, [replace(PLATE, edge_gap_mm=-1.0)], NestOptions(gap_mm=-2.0))
    assert {finding.code for finding in found} == {"quantity", "contour", "stock-invalid", "option"}


def test_a_list_that_no_grain_allows_is_refused_with_both() -> None:
    part = GOOD.replace(part="bad", rotations=(0.0, 90.0), axis_deg=0.0, axis_band_deg=5.0)
    sheet = replace(PLATE, grain_deg=45.0)
    outcome = nest([part], [sheet], QUICK, Tolerances())
    assert refused(outcome) == ["no-angle"]
    assert all(word in outcome.report.findings[0].message for word in ("'bad'", "0, 90", "45"))
    assert troubles([part], [sheet, replace(PLATE, id="other", grain_deg=92.0)], QUICK) == []
    assert troubles([part], [sheet, replace(PLATE, id="other")], QUICK) == []


def test_a_mirrored_copy_may_have_an_angle_where_the_other_has_none() -> None:
    part = GOOD.replace(rotations=(0.0,), axis_deg=30.0)
    sheet = replace(PLATE, grain_deg=150.0)
    assert [finding.code for finding in troubles([part], [sheet], QUICK)] == ["no-angle"]
    assert troubles([part], [sheet], replace(QUICK, mirror=True)) == []


ODD: dict[str, FlatPattern] = {
    "far from the origin": pattern("odd", contour(box(100.0, 50.0, 1e5, -1e5))),
    "a vertex twice": pattern("odd", raw([(0.0, 0.0), (0.0, 0.0), (100.0, 0.0), (100.0, 50.0)])),
    "exactly as large as the room": rectangle("odd", 980.0, 480.0, rotations=(0.0,)),
    "a hole that touches the outline": bad(contour(box(100.0, 50.0)), hole(box(20.0, 20.0, 0.0, 10.0))),
    "a ring": ring("odd", 60.0, 40.0),
    "a sharp needle": pattern("odd", raw([(0.0, 0.0), (200.0, 0.0), (0.0, 1.0)])),
    "no copies": GOOD.replace(quantity=0),
}


@pytest.mark.parametrize("name", ODD)
def test_what_is_merely_odd_is_placed(name: str) -> None:
    outcome = nest([ODD[name]], [PLATE], QUICK, Tolerances())
    assert outcome.product is not None, outcome.report.findings
    assert outcome.report.findings == ()


def test_contours_that_run_the_wrong_way_round_are_turned_and_that_is_said() -> None:
    part = ring("odd", 60.0, 40.0)
    turned = part.replace(
        outer=replace(part.outer, path=backwards(part.outer.path)),
        inner=tuple(replace(one, path=backwards(one.path)) for one in part.inner),
    )
    right = oriented(turned)
    assert area(right.outer.path) > 0.0 > area(right.inner[0].path)
    assert oriented(part) is part
    outcome = nest([turned], [PLATE], QUICK, Tolerances())
    assert [(finding.code, finding.fatal) for finding in outcome.report.findings] == [("contour-turned", False)]
    straight = nest([part], [PLATE], QUICK, Tolerances())
    assert repr(outcome.product) == repr(straight.product)


def test_a_sheet_without_room_beside_one_that_has_some_is_said_and_left_out() -> None:
    outcome = nest([GOOD], [replace(PLATE, id="scrap", height_mm=20.0), PLATE], QUICK, Tolerances())
    assert outcome.product is not None
    assert [one.sheet.id for one in outcome.product.layouts] == ["plate"]
    assert [(finding.code, finding.fatal) for finding in outcome.report.findings] == [("stock-no-room", False)]


def test_nothing_to_place_needs_no_stock() -> None:
    assert troubles([], [], QUICK) == []
    assert troubles([GOOD.replace(quantity=0)], [], QUICK) == []


def test_many_different_parts_are_looked_at_quickly() -> None:
    start = time.process_time()
    assert troubles([disc(f"d{i}", 10.0 + i) for i in range(50)], [PLATE], QUICK) == []
    assert time.process_time() - start < 50 * 0.02, "about 1 ms a part"


def test_a_perforated_plate_is_looked_at_quickly_and_what_is_wrong_with_it_found() -> None:
    """Of 900 holes only those whose boxes meet are held against each other."""
    places = [(10.0 * i, 10.0 * j + 5.0) for i in range(30) for j in range(30)]
    sieve = [contour([(x + 7.0, y), (x + 3.0, y)], [1.0, 1.0], hole=True) for x, y in places]
    good = bad(contour(box(300.0, 300.0)), *sieve)
    start = time.process_time()
    assert troubles([good], [PLATE], QUICK) == []
    assert time.process_time() - start < 25.0
    wider = [hole(box(7.0, 1.0, 111.0, 115.0)), hole(box(4.0, 4.0, 298.0, 50.0))]
    found = troubles([good.replace(inner=(*good.inner, *wider))], [PLATE], QUICK)
    assert [finding.message.removeprefix("part 'bad': ") for finding in found] == [
        "hole 902 is not within the outline",
        "holes 342 and 901 run into each other",
    ]
