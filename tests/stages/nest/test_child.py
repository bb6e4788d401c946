"""The process of the engine: it answers, is killed in time, never outlives who started it; nonsense is refused."""

import _thread
import json
import subprocess
import sys
import threading
import time
from collections.abc import Sequence

import pytest
from shapely import box

from stages.nest import child
from stages.nest.child import ENGINE, EngineError, Told, last_words, layouts, solve
from stages.nest.separation.problem import NOWHERE, RECTANGLE, Item, Kind, Problem, Spot
from stages.nest.separation.wire import Request, request_line

SQUARE = Kind(box(-5.0, -5.0, 5.0, 5.0), (((0.0, 0.0),),) * 2, (RECTANGLE,) * 2)
OTHER = Kind(box(-4.0, -4.0, 4.0, 4.0), (((0.0, 0.0),),) * 2, (RECTANGLE,) * 2)
READY = json.dumps({"ready": True})
ROWS = [[0, 0, 0.0, 5.0, 5.0], [1, 1, 0.0, 5.0, 5.0]]
PLACED = json.dumps({"placed": ROWS})
BETTER = json.dumps({"placed": [[0, 0, 0.0, 5.0, 5.0], [0, 0, 0.0, 15.0, 5.0]]})


def request(seconds: float = 0.5) -> Request:
    problem = Problem((SQUARE, OTHER), (Item(0, 0), Item(0, 1)), ((90.0, 25.0), (90.0, 25.0)))
    start = (Spot(0, 0, 0.0, 5.0, 5.0), Spot(0, 0, 0.0, 80.0, 5.0))
    return Request(problem, start, True, seconds, 1, 0, (1.0, 1.0), (2250.0, 2250.0), (True, True))


def saying(*lines: str, then: str = "") -> Sequence[str]:
    """A process that reads its request, says some lines, and does something else."""
    says = "; ".join(f"print({line!r}, flush=True)" for line in lines)
    return [sys.executable, "-c", f"import os, sys, time; sys.stdin.readline(); {says or 'pass'}\n{then}"]


def heard(command: Sequence[str], seconds: float = 0.5, ready_s: float = 20.0) -> Told:
    told = Told()
    solve(request(seconds), told, command, ready_s)
    return told


def test_the_engine_is_ready_and_tells_layouts() -> None:
    told = Told()
    solve(request(1.0), told)
    assert told.ready is not None
    found = layouts(told, request())
    assert found
    assert all(len(spots) == 2 for spots in found)
    right = max(spot.x for spot in found[0])
    assert right < 80.0, "shorter than at first"


def test_the_last_layout_told_comes_first() -> None:
    found = layouts(heard(saying(READY, PLACED, BETTER)), request())
    assert [[spot.bin for spot in spots] for spots in found] == [[0, 0], [0, 1]]
    assert found[0][1] == Spot(0, 0, 0.0, 15.0, 5.0)


def test_layouts_told_before_the_kill_are_used() -> None:
    begin = time.monotonic()
    told = heard(saying(READY, PLACED, then="time.sleep(60)"), seconds=0.2)
    assert time.monotonic() - begin < 15.0
    assert len(layouts(told, request())) == 1


def test_a_line_that_was_cut_off_by_the_kill_does_no_harm() -> None:
    told = heard(
        saying(READY, PLACED, then=f"sys.stdout.write({BETTER[:30]!r}); sys.stdout.flush(); time.sleep(60)"), 0.2
    )
    assert len(layouts(told, request())) == 1


def test_the_time_counts_from_when_the_engine_is_ready() -> None:
    slow = saying(then=f"time.sleep(1.0); print({READY!r}, flush=True); print({PLACED!r}, flush=True)")
    assert len(layouts(heard(slow, seconds=0.1), request())) == 1


def test_an_engine_that_is_never_ready_is_killed_and_says_so() -> None:
    begin = time.monotonic()
    told = heard(saying(then="time.sleep(60)"), ready_s=0.3)
    assert time.monotonic() - begin < 15.0
    with pytest.raises(EngineError, match="before it was ready"):
        layouts(told, request())


def test_a_ready_engine_that_tells_nothing_has_found_nothing() -> None:
    assert layouts(heard(saying(READY)), request()) == []


def test_a_large_request_and_many_answers_do_not_block_each_other() -> None:
    fill = f"[print('{{\"placed\": []}}' + ' ' * 1000, flush=True) for _ in range(300)]; print({PLACED!r}, flush=True)"
    problem = request().problem
    long = Request(
        Problem((SQUARE, OTHER), problem.items * 4000, problem.bins), request().start * 4000, True, 5.0, 1, 0,
        (1.0, 1.0), (1.0, 1.0), (True, True),
    )  # fmt: skip
    assert len(request_line(long)) > 200_000
    told = Told()
    solve(long, told, saying(READY, then=fill))
    assert len(told.lines) == 301
    assert len(layouts(told, request())) == 1


NO_ROOM = Kind(SQUARE.shape, ((), ((0.0, 0.0),)), (RECTANGLE, NOWHERE))
"""A kind that may lie in no bin: it has no angle in the first, and no room in the second."""

NONSENSE = {
    "no JSON": "hello",
    "no object": "[1, 2]",
    "a number": "3",
    "no rows": json.dumps({"placed": 3}),
    "nothing placed": json.dumps({}),
    "too few": json.dumps({"placed": ROWS[:1]}),
    "too many": json.dumps({"placed": [*ROWS, ROWS[0]]}),
    "a bin that there is not": json.dumps({"placed": [ROWS[0], [2, 0, 0.0, 5.0, 5.0]]}),
    "no bin": json.dumps({"placed": [ROWS[0], [-1, 0, 0.0, 5.0, 5.0]]}),
    "a kind of another": json.dumps({"placed": [[0, 1, 0.0, 5.0, 5.0], ROWS[1]]}),
    "a kind that there is not": json.dumps({"placed": [ROWS[0], [0, 2, 0.0, 5.0, 5.0]]}),
    "not a number": json.dumps({"placed": [ROWS[0], [0, 0, float("nan"), 5.0, 5.0]]}),
    "infinite": json.dumps({"placed": [ROWS[0], [0, 0, 0.0, float("inf"), 5.0]]}),
    "an infinite bin": json.dumps({"placed": [ROWS[0], [float("inf"), 0, 0.0, 5.0, 5.0]]}),
    "no number": json.dumps({"placed": [ROWS[0], [0, 0, "a", None, 5.0]]}),
    "beyond all sheets": json.dumps({"placed": [ROWS[0], [0, 0, 0.0, 1e300, 5.0]]}),
    "short rows": json.dumps({"placed": [[0, 0], [0, 0]]}),
}


@pytest.mark.parametrize("name", NONSENSE)
def test_nonsense_is_refused(name: str) -> None:
    told = Told([NONSENSE[name].encode()], ready=1.0)
    with pytest.raises(EngineError, match="makes no sense"):
        layouts(told, request())


@pytest.mark.parametrize("name", NONSENSE)
def test_nonsense_does_not_spoil_what_was_told_before(name: str) -> None:
    told = Told([PLACED.encode(), NONSENSE[name].encode()], ready=1.0)
    assert len(layouts(told, request())) == 1


@pytest.mark.parametrize("bin_", [0, 1])
def test_a_bin_where_a_part_may_not_lie_is_nonsense(bin_: int) -> None:
    one = request()
    problem = Problem((SQUARE, NO_ROOM), one.problem.items, one.problem.bins)
    asked = Request(problem, one.start, True, 0.1, 1, 0, one.cost, one.area, one.rectangle)
    rows = {"placed": [ROWS[0], [bin_, 1, 0.0, 5.0, 5.0]]}
    with pytest.raises(EngineError, match="makes no sense"):
        layouts(Told([json.dumps(rows).encode()], ready=1.0), asked)


def test_bytes_that_are_no_text_are_nonsense() -> None:
    with pytest.raises(EngineError, match="makes no sense"):
        layouts(Told([b"\xff\xfe"], ready=1.0), request())


def test_an_error_is_quoted_unless_there_is_a_layout() -> None:
    wrong = json.dumps({"error": 'ValueError: it is not "ready"'}).encode()
    with pytest.raises(EngineError, match="it is not"):
        layouts(Told([wrong], ready=1.0), request())
    told = Told([PLACED.encode(), wrong], ready=1.0)
    assert len(layouts(told, request())) == 1
    assert last_words(told) == 'ValueError: it is not "ready"'


@pytest.mark.parametrize("lines", [[], [PLACED], ["hello"], ["3"]])
def test_an_engine_that_did_not_fail_has_no_last_words(lines: list[str]) -> None:
    assert last_words(Told([line.encode() for line in lines], ready=1.0)) is None


def test_what_the_engine_cannot_read_is_an_error_that_it_names() -> None:
    broken = request()
    told = Told()
    none = Request(Problem((), (), ()), (), True, 0.1, 1, 0, (), (), ())
    solve(none, told)
    with pytest.raises(EngineError, match="Error"):
        layouts(told, broken)


@pytest.mark.parametrize("command", [["no-such-engine"], ["/"]])
def test_what_cannot_be_started_is_an_error(command: list[str]) -> None:
    with pytest.raises(EngineError, match="could not be started"):
        solve(request(), Told(), command)


@pytest.mark.parametrize("what", ["os.abort()", "sys.exit(3)", "pass"])
def test_an_engine_that_ends_early_has_told_nothing(what: str) -> None:
    with pytest.raises(EngineError, match="it ended"):
        layouts(heard(saying(then=what)), request())


def test_an_engine_that_does_not_read_is_no_trouble() -> None:
    told = heard([sys.executable, "-c", "pass"])
    with pytest.raises(EngineError):
        layouts(told, request())


def test_ctrl_c_kills_the_child_and_keeps_what_was_told(monkeypatch: pytest.MonkeyPatch) -> None:
    started: list[subprocess.Popen[bytes]] = []
    popen = subprocess.Popen

    def kept(*args: object, **kwargs: object) -> subprocess.Popen[bytes]:
        started.append(popen(*args, **kwargs))
        return started[-1]

    monkeypatch.setattr(child.subprocess, "Popen", kept)
    told = Told()

    def interrupt() -> None:
        while not told.lines:
            time.sleep(0.02)
        _thread.interrupt_main()

    threading.Thread(target=interrupt, daemon=True).start()
    with pytest.raises(KeyboardInterrupt):
        solve(request(60.0), told, saying(READY, PLACED, then="time.sleep(60)"))
    assert started[0].poll() is not None
    assert len(layouts(told, request())) == 1


def test_the_engine_ends_when_its_parent_is_gone() -> None:
    with subprocess.Popen(ENGINE, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL) as engine:
        assert engine.stdin is not None
        engine.stdin.write(request_line(request(60.0)))
        engine.stdin.flush()
        time.sleep(0.3)
        assert engine.poll() is None
        engine.stdin.close()
        assert engine.wait(60.0) == 1
