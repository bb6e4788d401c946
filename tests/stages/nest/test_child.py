"""The process of the engine: it answers, it is killed in time, it never outlives who started it."""

import _thread
import subprocess
import sys
import threading
import time

import pytest

from stages.nest import child
from stages.nest.child import ENGINE, EngineError, Item, Request, solve

SQUARE = ((0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0))


def request(seconds: int, enough: float, count: int = 4) -> Request:
    return Request(25.0, seconds, 1, enough, (Item("0", count, (0.0, 90.0), SQUARE),))


def test_the_engine_packs_squares_and_stops_when_it_is_enough() -> None:
    start = time.monotonic()
    spots = solve(request(30, 40.0), 60.0)
    assert len(spots) == 4
    assert {spot.id for spot in spots} == {"0"}
    assert time.monotonic() - start < 25.0


def test_a_layout_told_before_the_kill_is_used() -> None:
    assert len(solve(request(30, 0.0, 10), 3.0)) == 10


def test_what_the_engine_panics_on_is_an_error_that_quotes_it() -> None:
    flat = Request(25.0, 1, 1, 0.0, (Item("0", 1, None, ((0.0, 0.0), (10.0, 0.0), (20.0, 0.0))),))
    with pytest.raises(EngineError, match="Panic"):
        solve(flat, 20.0)


def test_ctrl_c_kills_the_child(monkeypatch: pytest.MonkeyPatch) -> None:
    started: list[subprocess.Popen[bytes]] = []
    popen = subprocess.Popen

    def kept(*args: object, **kwargs: object) -> "subprocess.Popen[bytes]":
        started.append(popen(*args, **kwargs))
        return started[-1]

    monkeypatch.setattr(child.subprocess, "Popen", kept)
    threading.Timer(0.5, _thread.interrupt_main).start()
    with pytest.raises(KeyboardInterrupt):
        solve(request(1, 0.0), 60.0, [sys.executable, "-c", "import time; time.sleep(60)"])
    assert started[0].poll() is not None


def test_the_engine_ends_when_its_parent_is_gone() -> None:
    engine = subprocess.Popen(ENGINE, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL)
    assert engine.stdin is not None
    engine.stdin.write(request(60, 0.0).line())
    engine.stdin.flush()
    time.sleep(0.5)
    assert engine.poll() is None
    engine.stdin.close()
    assert engine.wait(10.0) == 1
