"""The search as it is asked: every layout it tells is legal and better than the one before, or it says what failed."""

import io
import json
import os
import subprocess
import sys
from collections.abc import Sequence

import pytest
from numba import config
from shapely import Polygon, box

from stages.nest.separation import worker
from stages.nest.separation.problem import NOWHERE, RECTANGLE, Item, Problem, Spot
from stages.nest.separation.sharing import Bench
from stages.nest.separation.wire import Request, request_line
from tests.stages.nest.separation.scenes import (
    BY_QUARTERS,
    FREE,
    UPRIGHT,
    ell,
    frame,
    inner,
    kind,
    moved,
    oblong,
    overlaps,
)

SECONDS = 0.6


@pytest.fixture(scope="module", autouse=True)
def compiled_first() -> None:
    """Kernels are compiled or loaded before the clock runs, as in the process of the search."""
    worker.ready()


def told(request: Request, monkeypatch: pytest.MonkeyPatch) -> list[Sequence[Spot]]:
    """All layouts that the search tells."""
    found: list[Sequence[Spot]] = []
    monkeypatch.setattr(worker, "tell", found.append)
    worker.answer(request)
    return found


def ask(
    problem: Problem, start: tuple[Spot, ...], *, settled: bool = True, seconds: float = SECONDS, threads: int = 1
) -> Request:
    count = len(problem.bins)
    area = tuple(width * height for width, height in problem.bins)
    plain = tuple(all(one.regions[b] in (RECTANGLE, NOWHERE) for one in problem.kinds) for b in range(count))
    return Request(problem, start, settled, seconds, threads, 1, (1.0,) * count, area, plain)


def assert_legal(problem: Problem, spots: Sequence[Spot]) -> None:
    assert len(spots) == len(problem.items)
    shapes = [moved(inner(problem.kinds[spot.kind].shape), spot.x, spot.y, spot.angle_deg) for spot in spots]
    for bin_, (width, height) in enumerate(problem.bins):
        there = [one for one, spot in zip(shapes, spots, strict=True) if spot.bin == bin_]
        assert overlaps(there) < 1e-9
        assert all(box(0.0, 0.0, width, height).buffer(1e-6).contains(one) for one in there)
    for item, spot, shape in zip(problem.items, spots, shapes, strict=True):
        assert spot.kind in (item.kind, item.other)
        number = problem.kinds[spot.kind].regions[spot.bin]
        assert number != NOWHERE
        assert number == RECTANGLE or problem.regions[number].buffer(1e-6).contains(shape)
        spans = problem.kinds[spot.kind].spans[spot.bin]
        assert any(low - 1e-9 <= spot.angle_deg <= high + 1e-9 for low, high in spans)


def used(problem: Problem, spots: Sequence[Spot]) -> tuple[int, float]:
    """How many bins are used, and the least width of those."""
    ends: dict[int, float] = {}
    for spot in spots:
        right = moved(problem.kinds[spot.kind].shape, spot.x, spot.y, spot.angle_deg).bounds[2]
        ends[spot.bin] = max(ends.get(spot.bin, 0.0), float(right))
    return len(ends), min(ends.values())


def in_a_row(count: int, step: float, y: float) -> tuple[Spot, ...]:
    return tuple(Spot(0, 0, 0.0, step * (number + 0.5), y) for number in range(count))


def test_layouts_grow_shorter_and_every_one_of_them_is_legal(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = Problem((kind(ell(30.0, 10.0), BY_QUARTERS),), (Item(0, 0),) * 6, ((300.0, 62.0),))
    start = in_a_row(6, 40.0, 31.0)
    found = told(ask(problem, start), monkeypatch)
    assert found
    widths = [used(problem, spots)[1] for spots in (start, *found)]
    assert widths == sorted(widths, reverse=True)
    assert widths[-1] < 150.0, "two rows of hooks, of 230 mm at first"
    for spots in found:
        assert_legal(problem, spots)


def test_two_threads_tell_legal_layouts_too(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = Problem((kind(oblong(30.0, 10.0), FREE),), (Item(0, 0),) * 5, ((300.0, 45.0),))
    found = told(ask(problem, in_a_row(5, 40.0, 20.0), threads=2), monkeypatch)
    widths = [used(problem, spots)[1] for spots in found]
    assert widths == sorted(widths, reverse=True)
    for spots in found:
        assert_legal(problem, spots)


def test_fewer_bins_are_found_where_all_fits_into_one(monkeypatch: pytest.MonkeyPatch) -> None:
    one = kind(oblong(30.0, 10.0), BY_QUARTERS, (RECTANGLE,) * 2)
    problem = Problem((one,), (Item(0, 0),) * 4, ((60.0, 25.0),) * 2)
    start = tuple(Spot(number % 2, 0, 0.0, 15.0, 5.0 if number < 2 else 17.0) for number in range(4))
    found = told(ask(problem, start), monkeypatch)
    assert used(problem, found[-1])[0] == 1
    for spots in found:
        assert_legal(problem, spots)


def test_what_lies_nowhere_yet_finds_a_place(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = Problem(
        (kind(oblong(30.0, 10.0)), kind(oblong(8.0, 8.0))), (Item(0, 0), Item(0, 0), Item(1, 1)), ((45.0, 25.0),)
    )
    start = (Spot(0, 0, 0.0, 20.0, 12.0), Spot(-1, 0, 0.0, 0.0, 0.0), Spot(-1, 1, 0.0, 0.0, 0.0))
    found = told(ask(problem, start, settled=False), monkeypatch)
    assert found
    for spots in found:
        assert_legal(problem, spots)


def test_what_does_not_fit_at_all_brings_no_layout(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = Problem((kind(oblong(30.0, 10.0)),), (Item(0, 0),) * 3, ((31.0, 25.0),))
    start = (Spot(0, 0, 0.0, 15.0, 5.0), Spot(0, 0, 0.0, 15.0, 16.0), Spot(-1, 0, 0.0, 0.0, 0.0))
    assert told(ask(problem, start, settled=False), monkeypatch) == []


def test_no_item_is_told_in_an_angle_in_which_it_sticks_out(monkeypatch: pytest.MonkeyPatch) -> None:
    one = kind(oblong(50.0, 20.0), BY_QUARTERS, (RECTANGLE,) * 2)
    problem = Problem((one,), (Item(0, 0),) * 3, ((120.0, 45.0),) * 2)
    start = (Spot(0, 0, 0.0, 25.0, 10.0), Spot(0, 0, 0.0, 25.0, 32.0), Spot(1, 0, 0.0, 25.0, 10.0))
    found = told(ask(problem, start), monkeypatch)
    assert used(problem, found[-1])[0] == 1
    for spots in found:
        assert_legal(problem, spots)


def test_fixed_items_are_told_where_they_were(monkeypatch: pytest.MonkeyPatch) -> None:
    items = (Item(0, 0, fixed=True), *(Item(0, 0),) * 4)
    problem = Problem((kind(oblong(20.0, 20.0), UPRIGHT),), items, ((300.0, 45.0),))
    start = tuple(Spot(0, 0, 0.0, x, 22.0) for x in (40.0, 80.0, 120.0, 160.0, 200.0))
    found = told(ask(problem, start), monkeypatch)
    assert found
    assert {spots[0] for spots in found} == {start[0]}
    for spots in found:
        assert_legal(problem, spots)


def test_regions_holes_and_other_hands_are_kept_to(monkeypatch: pytest.MonkeyPatch) -> None:
    hook = ell(24.0, 8.0)
    back = Polygon([(-x, y) for x, y in hook.exterior.coords])
    region = Polygon(box(0, 0, 160, 80).exterior, [box(60, 30, 80, 50).exterior])
    kinds = (kind(hook, FREE, (0, 0)), kind(back, FREE, (0, 0)), kind(frame(40.0, 30.0), UPRIGHT, (0, 0)))
    items = (*(Item(0, 1),) * 3, Item(2, 2))
    problem = Problem(kinds, items, ((160.0, 80.0),) * 2, (region,))
    start = (
        Spot(0, 0, 0.0, 20.0, 20.0), Spot(1, 0, 0.0, 20.0, 20.0), Spot(1, 1, 0.0, 20.0, 60.0),
        Spot(1, 2, 0.0, 120.0, 40.0),
    )  # fmt: skip
    found = told(ask(problem, start, seconds=8.0), monkeypatch)
    assert used(problem, found[-1])[0] == 1
    for spots in found:
        assert_legal(problem, spots)


def said(line: bytes | str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> list[object]:
    """What the process would say to a line, in this one."""

    def end(code: int) -> None:
        raise SystemExit(code)

    monkeypatch.setattr(worker, "_end_with_parent", lambda: None)
    monkeypatch.setattr("os._exit", end)
    monkeypatch.setattr("signal.signal", lambda *_: None)
    monkeypatch.setattr(sys, "stdin", io.StringIO(line if isinstance(line, str) else line.decode()))
    with pytest.raises(SystemExit) as ended:
        worker.main()
    assert ended.value.code == 0
    return [json.loads(one) for one in capsys.readouterr().out.splitlines()]


def test_it_says_that_it_is_ready_and_then_layouts(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    problem = Problem((kind(oblong(10.0, 10.0)),), (Item(0, 0),) * 2, ((90.0, 25.0),))
    start = (Spot(0, 0, 0.0, 5.0, 5.0), Spot(0, 0, 0.0, 80.0, 5.0))
    first, *others = said(request_line(ask(problem, start, seconds=0.3)), monkeypatch, capsys)
    assert first == {"ready": True}
    assert others
    assert all(isinstance(one, dict) and [len(row) for row in one["placed"]] == [5, 5] for one in others)


@pytest.mark.parametrize("threads", [1, 2])
def test_a_thread_that_fails_is_an_error_that_it_names(
    threads: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def failing(bench: Bench, *_: object) -> None:
        raise IndexError("planted")

    problem = Problem((kind(oblong(10.0, 10.0)),), (Item(0, 0),) * 2, ((90.0, 25.0),))
    start = (Spot(0, 0, 0.0, 5.0, 5.0), Spot(0, 0, 0.0, 80.0, 5.0))
    monkeypatch.setattr("stages.nest.separation.strategy.shorter", failing)
    *_, last = said(request_line(ask(problem, start, seconds=0.1, threads=threads)), monkeypatch, capsys)
    assert last == {"error": "IndexError: planted"}


@pytest.mark.parametrize("line", ["hello\n", "", "{}\n"])
def test_what_it_cannot_read_is_an_error_that_it_names(
    line: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (only,) = said(line, monkeypatch, capsys)
    assert isinstance(only, dict)
    assert "Error" in only["error"]


# How many threads


@pytest.mark.parametrize(("told_numba", "wanted"), [(3, 3), (1, 1), (0, 1), (64, 3)])
def test_no_more_threads_search_than_cores_may_be_used_and_fewer_where_numba_is_told_so(
    told_numba: int, wanted: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(config, "NUMBA_DEFAULT_NUM_THREADS", 3)
    monkeypatch.setattr(config, "NUMBA_NUM_THREADS", told_numba)
    assert worker.cores() == wanted
    asked: list[Request] = []
    monkeypatch.setattr(worker, "answer", asked.append)
    monkeypatch.setattr(worker, "ready", lambda: None)
    said(request_line(ask(Problem((kind(oblong(10.0, 10.0)),), (Item(0, 0),), ((90.0, 25.0),)),
                          (Spot(0, 0, 0.0, 5.0, 5.0),), threads=8)), monkeypatch, capsys)  # fmt: skip
    assert [one.threads for one in asked] == [wanted]


def test_the_environment_tells_numba() -> None:
    code = "from stages.nest.separation.worker import cores; print(cores())"
    environment = {**os.environ, "NUMBA_NUM_THREADS": "1"}
    ran = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, check=True)
    assert ran.stdout.split() == [b"1"]
