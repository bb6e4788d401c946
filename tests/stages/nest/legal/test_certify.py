"""The certifier: a good layout passes with known figures, each planted fault gives its finding and no other."""

import tracemalloc
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, transform
from stages.model.pattern import Contour, FlatPattern
from stages.model.sheet import Nesting, NestOptions, Placement, Sheet, SheetLayout
from stages.nest.legal.certify import certify, passed
from tests.stages.nest.shapes import box, circle, contour, disc, pattern, rectangle, ring

SHEET = Sheet("plate", 300.0, 200.0, quantity=1, edge_gap_mm=10.0)
OPTIONS = NestOptions(gap_mm=5.0, rotations=(0.0, 180.0))
PARTS = (rectangle("a", 100.0, 50.0, quantity=2), disc("d", 40.0))
GOOD = (
    Placement("a", 1, Rigid2(10.0, 10.0)),
    Placement("a", 2, Rigid2(110.0, 115.0, 180.0)),
    Placement("d", 1, Rigid2(160.0, 60.0)),
)


def codes(placed: Sequence[Placement], parts: Sequence[FlatPattern] = PARTS) -> list[str]:
    layout = SheetLayout(SHEET, 1, tuple(placed), 0.0)
    metrics, findings = certify(Nesting((layout,)), parts, [SHEET], OPTIONS)
    assert passed(metrics, findings) == (not findings)
    assert all(finding.fatal for finding in findings)
    return [finding.code for finding in findings]


def figures(placed: Sequence[Placement], parts: Sequence[FlatPattern]) -> dict[str, float]:
    metrics, _ = certify(Nesting((SheetLayout(SHEET, 1, tuple(placed), 0.0),)), parts, [SHEET], OPTIONS)
    return {metric.name: metric.value for metric in metrics}


def with_one(number: int, placement: Placement) -> list[Placement]:
    return [placement if i == number else one for i, one in enumerate(GOOD)]


def test_a_good_layout_passes_with_the_figures_known_by_hand() -> None:
    assert codes(GOOD) == []
    found = figures(GOOD, PARTS)
    assert found["min_gap_mm"] == pytest.approx(5.0, abs=1e-12)
    assert found["min_edge_gap_mm"] == pytest.approx(10.0, abs=1e-12)
    assert found["overlap_mm2"] == 0.0
    assert found["rigid_error_mm"] < 1e-12
    assert found["utilisation"] == pytest.approx((2 * 5000.0 + np.pi * 1600.0) / 60000.0, abs=1e-12)


def test_every_metric_of_a_good_layout_is_proved() -> None:
    metrics, _ = certify(Nesting((SheetLayout(SHEET, 1, GOOD, 0.0),)), PARTS, [SHEET], OPTIONS)
    assert {metric.evidence for metric in metrics} == {"proved"}
    names = ["utilisation", "min_gap_mm", "min_edge_gap_mm", "overlap_mm2", "rigid_error_mm"]
    assert [metric.name for metric in metrics] == names


FAULTS = {
    "gap": with_one(1, Placement("a", 2, Rigid2(110.0, 114.9, 180.0))),
    "edge-gap": with_one(0, Placement("a", 1, Rigid2(9.9, 10.0))),
    "missing-copy": GOOD[:2],
    "unknown-copy": [*GOOD, Placement("a", 3, Rigid2(180.0, 120.0))],
    "mirrored": with_one(2, Placement("d", 1, Rigid2(160.0, 60.0, 0.0, mirrored=True))),
    "rotation": with_one(2, Placement("d", 1, Rigid2(160.0, 60.0, 90.0))),
}


@pytest.mark.parametrize("code", FAULTS)
def test_one_fault_gives_its_finding_and_no_other(code: str) -> None:
    assert codes(FAULTS[code]) == [code]


def test_a_gap_that_is_short_by_less_than_the_tolerance_passes() -> None:
    assert codes(with_one(1, Placement("a", 2, Rigid2(110.0, 115.0 - 9e-7, 180.0)))) == []
    assert codes(with_one(1, Placement("a", 2, Rigid2(110.0, 115.0 - 2e-6, 180.0)))) == ["gap"]


def test_a_copy_placed_twice_is_found_even_on_the_same_spot() -> None:
    found = codes([*GOOD, GOOD[2]])
    assert set(found) == {"duplicate-copy", "gap", "overlap"}


def test_parts_that_cross_overlap_by_their_common_area() -> None:
    crossed = with_one(1, Placement("a", 2, Rigid2(110.0, 90.0, 180.0)))
    assert codes(crossed) == ["gap", "overlap"]
    assert figures(crossed, PARTS)["overlap_mm2"] == pytest.approx(100.0 * 20.0, rel=1e-9)


def test_a_part_inside_another_overlaps_though_no_edges_cross() -> None:
    parts = (rectangle("plate", 200.0, 100.0), rectangle("chip", 20.0, 20.0))
    placed = [Placement("plate", 1, Rigid2(20.0, 20.0)), Placement("chip", 1, Rigid2(100.0, 60.0))]
    assert codes(placed, parts) == ["overlap"]
    assert figures(placed, parts)["overlap_mm2"] == pytest.approx(400.0)
    assert codes(placed[::-1], parts[::-1]) == ["overlap"]


def test_a_part_in_the_hole_of_another_is_legal_and_its_gap_counts() -> None:
    parts = (ring("ring", 80.0, 60.0), disc("chip", 20.0))
    placed = [Placement("ring", 1, Rigid2(100.0, 100.0)), Placement("chip", 1, Rigid2(120.0, 100.0))]
    assert codes(placed, parts) == []
    assert figures(placed, parts)["min_gap_mm"] == pytest.approx(20.0, abs=1e-12)
    assert codes([placed[0], Placement("chip", 1, Rigid2(138.0, 100.0))], parts) == ["gap"]


def test_a_concentric_disc_within_a_disc_overlaps() -> None:
    parts = (disc("large", 60.0), disc("small", 20.0))
    placed = [Placement("large", 1, Rigid2(100.0, 100.0)), Placement("small", 1, Rigid2(100.0, 100.0))]
    assert codes(placed, parts) == ["overlap"]


def test_a_plate_over_the_hole_of_another_overlaps_though_little() -> None:
    frame = pattern("frame", contour(box(150.0, 150.0)), contour(box(90.0, 90.0, 30.0, 30.0), hole=True))
    parts = (frame, rectangle("lid", 104.0, 104.0))
    placed = [Placement("frame", 1, Rigid2(20.0, 20.0)), Placement("lid", 1, Rigid2(43.0, 43.0))]
    assert codes(placed, parts) == ["overlap"]
    assert figures(placed, parts)["overlap_mm2"] == pytest.approx(104.0**2 - 90.0**2, rel=1e-6)


def test_holes_of_a_part_do_not_count_as_gaps_to_itself() -> None:
    found = figures([Placement("r", 1, Rigid2(100.0, 100.0))], (ring("r", 50.0, 49.0),))
    assert found["min_gap_mm"] is None


def test_the_gap_between_arcs_is_exact() -> None:
    parts = (disc("d", 40.0, quantity=2),)
    placed = [Placement("d", 1, Rigid2(50.0, 50.0)), Placement("d", 2, Rigid2(50.0 + 51.0, 50.0 + 68.0))]
    assert figures(placed, parts)["min_gap_mm"] == pytest.approx(5.0, abs=1e-12)
    assert codes(placed, parts) == []


def test_the_gap_of_parts_far_apart_is_still_told() -> None:
    parts = (disc("d", 10.0, quantity=2),)
    placed = [Placement("d", 1, Rigid2(20.0, 20.0)), Placement("d", 2, Rigid2(280.0, 20.0))]
    assert figures(placed, parts)["min_gap_mm"] == pytest.approx(240.0, abs=1e-11)


def test_a_sheet_on_which_nothing_lies_is_judged_like_any_other() -> None:
    assert codes(()) == ["missing-copy"] * 3
    assert codes([Placement("x", 1, Rigid2())], ()) == ["unknown-copy"]


def test_more_sheets_than_the_stock_has_are_found() -> None:
    layouts = tuple(SheetLayout(SHEET, index, (one,), 0.0) for index, one in ((1, GOOD[0]), (2, GOOD[2])))
    parts = (rectangle("a", 100.0, 50.0), PARTS[1])
    _, findings = certify(Nesting(layouts), parts, [SHEET], OPTIONS)
    assert [finding.code for finding in findings] == ["stock-exceeded"]


def test_a_sheet_that_is_not_in_the_stock_or_misnumbered_is_found() -> None:
    wider = Sheet("plate", 400.0, 200.0, quantity=1, edge_gap_mm=10.0)
    _, findings = certify(Nesting((SheetLayout(wider, 1, GOOD, 0.0),)), PARTS, [SHEET], OPTIONS)
    assert [finding.code for finding in findings] == ["unknown-sheet"]
    _, findings = certify(Nesting((SheetLayout(SHEET, 2, GOOD, 0.0),)), PARTS, [SHEET], OPTIONS)
    assert [finding.code for finding in findings] == ["sheet-index"]


@given(st.floats(0.0, 360.0), st.floats(-20.0, 20.0), st.floats(-20.0, 20.0))
@settings(max_examples=30, deadline=None)
def test_turned_parts_stay_rigid(angle: float, x: float, y: float) -> None:
    half_moon = pattern("m", contour([(0.0, 0.0), (60.0, 0.0), (30.0, 20.0)], [0.4, -0.2, 0.0]))
    placed = [Placement("m", 1, Rigid2(150.0 + x, 100.0 + y, angle))]
    assert 0.0 <= figures(placed, (half_moon,))["rigid_error_mm"] < 1e-12


def test_the_helper_circle_runs_as_a_hole_should() -> None:
    assert circle(3.0, hole=True).path.bulges[0] == -1.0


def test_a_placement_that_changes_the_size_of_a_part_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    def stretched(path: ArcPath, motion: Rigid2) -> ArcPath:
        return transform(ArcPath(path.vertices * (1.0 + 1e-7), path.bulges, path.closed), motion)

    monkeypatch.setattr("stages.nest.legal.certify.transform", stretched)
    assert codes(GOOD) == ["rigid"]
    assert figures(GOOD, PARTS)["rigid_error_mm"] == pytest.approx(1e-7 * np.hypot(100.0, 50.0), rel=1e-5)


def test_of_a_contour_of_many_vertices_some_distances_are_compared_and_it_is_said() -> None:
    angle = 2.0 * np.pi * np.arange(20_000) / 20_000
    path = ArcPath(50.0 * np.stack([np.cos(angle), np.sin(angle)], axis=1), np.zeros(angle.size), closed=True)
    part = pattern("round", Contour((), path, 0.0))
    layout = SheetLayout(SHEET, 1, (Placement("round", 1, Rigid2(150.0, 100.0, 30.0, mirrored=True)),), 0.0)
    tracemalloc.start()
    metrics, findings = certify(Nesting((layout,)), [part], [SHEET], NestOptions(mirror=True))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert findings == ()
    rigid = next(metric for metric in metrics if metric.name == "rigid_error_mm")
    assert (rigid.evidence, rigid.value < 1e-11) == ("sampled", True)
    assert peak < 200e6, "all pairs are 1.6 GB"
