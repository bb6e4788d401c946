"""The certifier on sheets of any outline: edge, defects, zones, rolls; each planted fault beside a near miss."""

from dataclasses import replace
from math import sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.curves.rigid import Rigid2
from stages.model.pattern import FlatPattern
from stages.model.report import Metric
from stages.model.sheet import Nesting, NestOptions, Placement, Quality, Sheet, SheetLayout, Zone
from stages.nest.legal.certify import certify, passed
from stages.nest.legal.ground import accepts
from tests.near import assert_near
from tests.stages.nest.shapes import angle_piece, box, circle, contour, disc, pattern, rectangle, ring

OPTIONS = NestOptions(gap_mm=5.0)
HAIR = 1e-6
HIDE = Sheet("hide", 400.0, 400.0, 1, edge_gap_mm=10.0, kind="hide", outline=circle(200.0).path)
"""A round hide about the origin."""

NOTCHED = Sheet("el", 300.0, 300.0, 1, outline=angle_piece("el", 300.0, 100.0).outer.path)
"""The shape of an L, without an edge gap."""


def judged(
    part: FlatPattern, x: float, y: float, sheet: Sheet, angle: float = 0.0
) -> tuple[list[str], dict[str, Metric]]:
    """Return the findings' codes and the metrics of one part on one sheet."""
    layout = SheetLayout(sheet, 1, (Placement(part.part, 1, Rigid2(x, y, angle)),), 0.0)
    metrics, findings = certify(Nesting((layout,)), [part], [sheet], OPTIONS)
    assert passed(metrics, findings) == (not findings)
    return [finding.code for finding in findings], {metric.name: metric for metric in metrics}


def codes(part: FlatPattern, x: float, y: float, sheet: Sheet) -> list[str]:
    return judged(part, x, y, sheet)[0]


def figure(part: FlatPattern, x: float, y: float, sheet: Sheet, name: str) -> float:
    value = judged(part, x, y, sheet)[1][name].value
    assert value is not None
    return float(value)


def test_the_edge_gap_to_a_round_outline_is_that_of_circles() -> None:
    assert_near(figure(disc("d", 50.0), 80.0, 60.0, HIDE, "min_edge_gap_mm"), 50.0, bound=1e-12, why="200 - 100 - 50")


@pytest.mark.parametrize("turn", [0.0, 33.0, 200.0])
def test_a_part_may_come_to_the_edge_gap_of_an_outline_and_no_nearer(turn: float) -> None:
    way = np.array([np.cos(np.radians(turn)), np.sin(np.radians(turn))])
    near, far = (140.0 + by for by in (HAIR / 2.0, 2.0 * HAIR))
    assert codes(disc("d", 50.0), *(near * way), HIDE) == []
    assert codes(disc("d", 50.0), *(far * way), HIDE) == ["edge-gap"]


def test_a_part_across_an_outline_or_beyond_it_is_found_without_an_edge_gap() -> None:
    bare = replace(HIDE, edge_gap_mm=0.0)
    assert codes(disc("d", 50.0), 150.0, 0.0, bare) == [], "touches from within"
    assert codes(disc("d", 50.0), 150.0 + 2.0 * HAIR, 0.0, bare) == ["edge-gap"]
    assert codes(disc("d", 50.0), 250.0, 0.0, bare) == ["edge-gap"], "touches from outside"
    assert codes(disc("d", 50.0), 600.0, 0.0, bare) == ["edge-gap"]
    assert figure(disc("d", 50.0), 600.0, 0.0, bare, "min_edge_gap_mm") == pytest.approx(-350.0)
    assert codes(disc("d", 250.0), 0.0, 0.0, bare) == ["edge-gap"], "holds the hide"


def test_a_part_in_the_notch_of_an_outline_is_outside_of_it() -> None:
    assert codes(rectangle("a", 300.0, 100.0), 0.0, 0.0, NOTCHED) == [], "along three edges"
    assert codes(rectangle("a", 100.0, 300.0), 0.0, 0.0, NOTCHED) == []
    assert codes(rectangle("a", 150.0, 150.0), 150.0, 150.0, NOTCHED) == ["edge-gap"]
    assert codes(rectangle("a", 101.0, 101.0), 0.0, 0.0, NOTCHED) == ["edge-gap"], "a corner beyond the inner corner"


def test_a_defect_keeps_the_edge_gap() -> None:
    holed = replace(HIDE, defects=(circle(20.0).path,))
    assert codes(disc("d", 30.0), 60.0, 0.0, holed) == []
    assert codes(disc("d", 30.0), 60.0 - 2.0 * HAIR, 0.0, holed) == ["edge-gap"]
    assert figure(disc("d", 30.0), 60.0, 0.0, holed, "min_edge_gap_mm") == pytest.approx(10.0, abs=1e-12)


def test_a_part_on_a_defect_or_around_it_is_found_though_the_edges_are_apart() -> None:
    holed = replace(HIDE, defects=(circle(20.0).path,))
    assert codes(disc("d", 40.0), 30.0, 0.0, holed) == ["defect"], "across"
    assert codes(disc("d", 100.0), 0.0, 0.0, holed) == ["defect"], "around"
    assert codes(disc("d", 5.0), 0.0, 0.0, holed) == ["defect"], "within"
    assert figure(disc("d", 100.0), 0.0, 0.0, holed, "min_edge_gap_mm") == pytest.approx(-80.0)
    assert codes(ring("r", 100.0, 30.0), 0.0, 0.0, holed) == [], "the defect lies in the hole of the part"
    assert codes(ring("r", 100.0, 29.0), 0.0, 0.0, holed) == ["edge-gap"]


def test_a_defect_on_a_rectangle_keeps_the_edge_gap_too() -> None:
    sheet = Sheet("s", 300.0, 200.0, 1, edge_gap_mm=10.0, defects=(contour(box(20.0, 200.0, 140.0, 0.0)).path,))
    assert codes(rectangle("a", 120.0, 180.0), 10.0, 10.0, sheet) == []
    assert codes(rectangle("a", 120.0, 180.0), 10.0 + 2.0 * HAIR, 10.0, sheet) == ["edge-gap"]
    assert codes(rectangle("a", 120.0, 180.0), 120.0, 10.0, sheet) == ["defect"]


ZONED = Sheet(
    "z",
    300.0,
    200.0,
    1,
    zones=(Zone(contour(box(100.0, 200.0, 100.0)).path, 3), Zone(contour(box(100.0, 200.0, 200.0)).path, 1)),
)
"""The best third on the left, then quality 3, then quality 1."""

ENTERS: dict[Quality, tuple[bool, bool, bool]] = {
    "best": (True, False, False),
    4: (True, False, False),
    3: (True, True, False),
    1: (True, True, True),
    "any": (True, True, True),
}


@pytest.mark.parametrize("quality", ENTERS)
def test_a_part_lies_in_zones_of_its_quality_or_better_and_in_no_others(quality: Quality) -> None:
    part = rectangle("a", 100.0, 200.0).replace(quality=quality)
    for x, wanted in zip((0.0, 100.0, 200.0), ENTERS[quality], strict=True):
        assert (codes(part, x, 0.0, ZONED) == []) == wanted
        assert (codes(part, x, 0.0, ZONED) == ["zone"]) != wanted


def test_a_zone_may_be_touched_but_not_entered_by_more_than_the_tolerance() -> None:
    part = rectangle("a", 100.0, 200.0)
    assert codes(part, HAIR / 2.0, 0.0, ZONED) == []
    assert codes(part, 2.0 * HAIR, 0.0, ZONED) == ["zone"]
    assert figure(part, 0.5, 0.0, ZONED, "zone_overlap_mm2") == pytest.approx(100.0, abs=1e-9)
    assert figure(part, 0.0, 0.0, ZONED, "zone_overlap_mm2") == 0.0


def test_where_zones_overlap_the_lowest_counts() -> None:
    over = replace(ZONED, zones=(*ZONED.zones, Zone(contour(box(50.0, 200.0, 150.0)).path, 0)))
    part = rectangle("a", 100.0, 200.0).replace(quality=3)
    assert codes(part, 100.0, 0.0, over) == ["zone"]
    assert codes(part.replace(quality=0), 100.0, 0.0, over) == []


def test_a_zone_within_a_part_is_found_and_one_in_its_hole_is_not() -> None:
    spot = replace(ZONED, zones=(Zone(contour(circle_corners(10.0, 150.0, 100.0), [1.0, 1.0]).path, 1),))
    assert codes(disc("d", 50.0), 150.0, 100.0, spot) == ["zone"]
    assert codes(ring("r", 50.0, 10.0), 150.0, 100.0, spot) == [], "the hole is the zone"
    assert codes(ring("r", 50.0, 10.0 - 2.0 * HAIR), 150.0, 100.0, spot) == ["zone"]


def circle_corners(radius: float, x: float, y: float) -> list[tuple[float, float]]:
    return [(x + radius, y), (x - radius, y)]


@pytest.mark.parametrize(
    ("quality", "zone", "wanted"), [("any", -5, True), ("best", 99, False), (2, 2, True), (2, 1, False)]
)
def test_which_zone_a_part_accepts(quality: Quality, zone: int, wanted: bool) -> None:
    assert accepts(quality, zone) == wanted


ROLL = Sheet("coil", np.inf, 150.0, 1, edge_gap_mm=5.0, kind="roll")


def test_a_roll_has_three_edges_and_counts_by_the_length_that_is_used() -> None:
    part = rectangle("a", 4000.0, 140.0)
    assert codes(part, 5.0, 5.0, ROLL) == []
    assert codes(part, 4.9, 5.0, ROLL) == codes(part, 5.0, 4.9, ROLL) == codes(part, 5.0, 5.1, ROLL) == ["edge-gap"]
    share = 4000.0 * 140.0 / (4010.0 * 150.0)
    assert_near(figure(part, 5.0, 5.0, ROLL, "utilisation"), share, bound=1e-14, why="used length and gap beyond it")


def test_the_utilisation_of_an_outline_is_exact_and_without_its_defects() -> None:
    holed = replace(HIDE, defects=(circle(20.0).path,))
    _, metrics = judged(disc("d", 50.0), 100.0, 0.0, holed)
    assert metrics["utilisation"].evidence == "proved"
    assert_near(metrics["utilisation"].value, 2500.0 / (40000.0 - 400.0), bound=1e-14, why="areas of circles")


def test_defects_that_overlap_each_other_or_the_edge_count_once() -> None:
    twice = replace(ZONED, zones=(), defects=tuple(contour(box(100.0, 200.0, x)).path for x in (-50.0, 0.0)))
    _, metrics = judged(rectangle("a", 100.0, 200.0), 150.0, 0.0, twice)
    assert metrics["utilisation"].evidence == "sampled"
    assert_near(metrics["utilisation"].value, 0.5, bound=1e-12, why="100 of 300 mm are gone, half of the rest is used")


@given(st.floats(0.0, 360.0), st.floats(0.0, 260.0), st.floats(0.0, 360.0))
@settings(max_examples=40, deadline=None)
def test_squares_on_a_round_hide_by_a_second_method(turn: float, away: float, angle: float) -> None:
    square = pattern("q", contour(box(60.0, 60.0, -30.0, -30.0)))
    x, y = away * np.cos(np.radians(turn)), away * np.sin(np.radians(turn))
    corners = np.array(box(60.0, 60.0, -30.0, -30.0)) @ _turned(angle).T + np.array([x, y])
    furthest = float(np.hypot(*corners.T).max())
    if abs(furthest - 190.0) > 1e-9:
        assert judged(square, x, y, HIDE, angle)[0] == ([] if furthest < 190.0 else ["edge-gap"])


def _turned(angle_deg: float) -> np.ndarray:
    c, s = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    return np.array([[c, -s], [s, c]])


def test_a_square_in_a_circle_touches_it_with_four_corners() -> None:
    half = 200.0 / sqrt(2.0)
    part = pattern("q", contour(box(2.0 * half, 2.0 * half, -half, -half)))
    assert codes(part, 0.0, 0.0, replace(HIDE, edge_gap_mm=0.0)) == []
    assert codes(part, 2.0 * HAIR, 0.0, replace(HIDE, edge_gap_mm=0.0)) == ["edge-gap"]


def test_a_part_as_high_as_its_outline_that_sticks_out_is_found() -> None:
    sheet = Sheet("s", 100.0, 100.0, 1, outline=contour(box(100.0, 100.0)).path)
    part = rectangle("a", 61.0, 100.0 + 2e-13)
    for x, wanted in ((39.0, []), (50.0, ["edge-gap"])):
        layout = SheetLayout(sheet, 1, (Placement("a", 1, Rigid2(x, -1e-13)),), 0.0)
        _, findings = certify(Nesting((layout,)), [part], [sheet], NestOptions())
        assert [finding.code for finding in findings] == wanted
