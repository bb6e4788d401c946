"""The nest stage with its engine: what it finds is certified, and neither its failures nor its lies do any harm."""

import json
import sys
import time

import pytest

from stages.model.pattern import FlatPattern
from stages.model.sheet import NestOptions, Sheet
from stages.nest import nest_with
from stages.nest.blank import Placed
from stages.nest.child import Told
from stages.nest.search import Engine
from stages.nest.sheets import Filled, Plan, Task
from tests.stages.nest.shapes import contour, pattern, rectangle, sector
from tests.stages.nest.test_nest import PLATE, TOL, codes, made, run


def jigsaw(count: int) -> list[FlatPattern]:
    """Right triangles and hats that interlock in a strip, but not as boxes."""
    triangle = contour([(0.0, 0.0), (300.0, 0.0), (0.0, 180.0)])
    return [pattern("triangle", triangle, quantity=count), sector("bow", 150.0, 190.0, 120.0, count)]


def test_the_engine_is_asked_for_several_sheets_and_its_result_is_certified() -> None:
    engine = Engine(0)
    options = NestOptions(gap_mm=4.0, time_limit_s=1.5)
    outcome = nest_with(jigsaw(12), [Sheet("s", 600.0, 400.0, edge_gap_mm=5.0)], options, TOL, engine)
    layout = made(outcome)
    assert engine.runs > 0
    assert engine.failures == []
    first = made(run(jigsaw(12), [Sheet("s", 600.0, 400.0, edge_gap_mm=5.0)], NestOptions(4.0, time_limit_s=0.0)))
    assert len(layout.layouts) <= len(first.layouts)
    assert outcome.report.metric("min_gap_mm").value >= 4.0 - 1e-6
    assert outcome.report.metric("min_edge_gap_mm").value >= 5.0 - 1e-6


def answering(*lines: str, then: str = "") -> list[str]:
    """An engine that is ready, says some lines, and does something else."""
    says = "; ".join(f"print({line!r}, flush=True)" for line in (json.dumps({"ready": True}), *lines))
    return [sys.executable, "-c", f"import sys, time; sys.stdin.readline(); {says}\n{then}"]


def placing(*rows: list[float]) -> str:
    return json.dumps({"placed": rows})


THERE = [0, 0, 0.0, 310.0, 160.0]
NONSENSE = {
    "crash": [sys.executable, "-c", "import os; os.abort()"],
    "no such program": ["no-such-engine"],
    "silent end": [sys.executable, "-c", "pass"],
    "not JSON": answering("hello"),
    "an error": answering(json.dumps({"error": "ValueError: no such kind"})),
    "too few parts": answering(placing(THERE)),
    "no such bin": answering(placing(THERE, THERE, [9, 0, 0.0, 310.0, 160.0])),
    "not finite": answering(placing(THERE, THERE, [0, 0, float("nan"), 310.0, 160.0])),
    "beyond all sheets": answering(placing(THERE, THERE, [0, 0, 0.0, 1e300, 160.0])),
    "infinite": answering(placing(THERE, THERE, [float("inf"), 0, 0.0, 310.0, 160.0])),
}


@pytest.mark.parametrize("name", NONSENSE)
def test_a_failing_engine_leaves_the_first_placement_and_a_finding(name: str) -> None:
    options = NestOptions(gap_mm=5.0, time_limit_s=2.0)
    parts = [rectangle("a", 600.0, 300.0, 3)]
    outcome = nest_with(parts, [PLATE], options, TOL, Engine(0, command=NONSENSE[name]))
    assert repr(made(outcome)) == repr(made(run(parts, [PLATE])))
    assert codes(outcome) == ["engine-failed"]
    assert not outcome.report.findings[0].fatal


def test_a_hanging_engine_is_killed_at_the_time_limit() -> None:
    start = time.monotonic()
    parts = [rectangle("a", 600.0, 300.0, 2)]
    engine = Engine(0, command=answering(then="time.sleep(60)"))
    outcome = nest_with(parts, [PLATE], NestOptions(5.0, time_limit_s=0.3), TOL, engine)
    assert len(made(outcome).layouts) == 2
    assert codes(outcome) == [], "it was ready, and found nothing better"
    assert time.monotonic() - start < 20.0


def one_on_each_sheet(task: Task) -> list[Plan]:
    """A first placement that anything is better than."""
    one = Placed(task.kinds[0].on(task.beds[0])[0], 0.0, 0.0)
    return [Plan((Filled(task.beds[0], (one,)),) * task.counts[0], {})]


LYING = [0, 0, 0.0, 203.0, 103.0]
TRUE = placing(LYING, [0, 0, 0.0, 609.0, 103.0])
LIES = {
    "stacked": placing(LYING, LYING),
    "across the edge": placing(LYING, [0, 0, 0.0, 790.0, 103.0]),
    "far away": placing(LYING, [0, 0, 0.0, 1e9, 1e9]),
    "too near": placing(LYING, [0, 0, 0.0, 607.9, 103.0]),
}
TWO = [rectangle("a", 400.0, 200.0, 2, rotations=(0.0, 90.0))]
BRIEF = NestOptions(5.0, time_limit_s=1.0)


@pytest.mark.parametrize("name", LIES)
def test_an_engine_that_lies_is_not_believed(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("stages.nest.first_plans", one_on_each_sheet)
    outcome = nest_with(TWO, [PLATE], BRIEF, TOL, Engine(0, command=answering(LIES[name])))
    assert len(made(outcome).layouts) == 2
    assert set(codes(outcome)) == {"layout-discarded"}
    assert outcome.report.metric("overlap_mm2").value == 0.0


def test_an_engine_that_tells_the_truth_is_believed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("stages.nest.first_plans", one_on_each_sheet)
    outcome = nest_with(TWO, [PLATE], BRIEF, TOL, Engine(0, command=answering(TRUE)))
    assert len(made(outcome).layouts) == 1
    assert codes(outcome) == []
    assert outcome.report.metric("min_gap_mm").value == pytest.approx(6.0)


def test_an_engine_that_fails_after_a_layout_is_believed_and_told_of(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("stages.nest.first_plans", one_on_each_sheet)
    failing = answering(TRUE, json.dumps({"error": "IndexError: planted"}))
    outcome = nest_with(TWO, [PLATE], BRIEF, TOL, Engine(0, command=failing))
    assert len(made(outcome).layouts) == 1
    assert [finding.message for finding in outcome.report.findings] == [
        "the nesting engine failed: IndexError: planted"
    ]


def test_where_the_last_layout_is_a_lie_the_one_before_it_is_used(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("stages.nest.first_plans", one_on_each_sheet)
    outcome = nest_with(TWO, [PLATE], BRIEF, TOL, Engine(0, command=answering(TRUE, LIES["stacked"])))
    assert len(made(outcome).layouts) == 1
    assert set(codes(outcome)) == {"layout-discarded"}


def test_what_was_told_before_an_interrupt_is_used(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(_: object, told: Told, *__: object) -> None:
        told.lines.append(TRUE.encode())
        raise KeyboardInterrupt

    monkeypatch.setattr("stages.nest.first_plans", one_on_each_sheet)
    monkeypatch.setattr("stages.nest.search.solve", interrupted)
    outcome = run(TWO, [PLATE], BRIEF)
    assert len(made(outcome).layouts) == 1
    assert codes(outcome) == ["interrupted"]


def test_parts_as_high_as_the_sheet_do_not_upset_the_engine() -> None:
    parts = [rectangle("column", 200.0, 480.0, 3, rotations=(0.0,)), *jigsaw(6)]
    engine = Engine(0)
    outcome = nest_with(parts, [PLATE], NestOptions(5.0, time_limit_s=1.0), TOL, engine)
    made(outcome)
    assert engine.failures == []


def test_an_interrupt_gives_the_first_placement_and_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("stages.nest.search.solve", interrupted)
    outcome = run([rectangle("a", 600.0, 300.0, 2)], [PLATE], NestOptions(5.0, time_limit_s=2.0))
    assert len(made(outcome).layouts) == 2
    assert codes(outcome) == ["interrupted"]
