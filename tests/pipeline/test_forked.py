"""Calls made by forked processes: in order, each once, errors in their turn, and no process left behind."""

import faulthandler
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from pipeline.forked import EndedError, each_by, forked, forks
from tests.pipeline.batch.processes import alive_after, below

pytestmark = pytest.mark.skipif(not forks(), reason="processes are forked on Linux alone")


@pytest.mark.parametrize("workers", [1, 2, 3, 50])
@pytest.mark.parametrize("count", [0, 1, 2, 20])
def test_results_come_in_order_whoever_made_them(workers: int, count: int) -> None:
    assert list(each_by(workers)(lambda number: number * number, count)) == [n * n for n in range(count)]


def test_the_calls_are_spread_and_none_is_made_here(tmp_path: Path) -> None:
    def met(number: int) -> int:
        (tmp_path / str(number)).touch()
        while number < 2 and len(list(tmp_path.iterdir())) < 2:
            time.sleep(0.01)
        return os.getpid()

    who = set(forked(met, 20, 2))
    assert len(who) == 2
    assert os.getpid() not in who
    assert not alive_after(who, 0.0)


def test_a_long_call_does_not_hold_up_the_others(tmp_path: Path) -> None:
    def call(number: int) -> int:
        (tmp_path / str(number)).touch()
        while number == 0 and not (tmp_path / "9").exists():
            time.sleep(0.01)
        return os.getpid()

    first, *others = forked(call, 10, 2)
    assert first not in others


def test_results_larger_than_a_pipe_come_through() -> None:
    found = forked(lambda number: bytes(number * 1_000_000), 4, 2)
    assert [len(content) for content in found] == [0, 1_000_000, 2_000_000, 3_000_000]


def aborts() -> None:
    faulthandler.disable()
    os.abort()


class AwkwardError(Exception):
    """Cannot be built from what it says."""

    def __init__(self, one: int, *, two: int) -> None:
        super().__init__(f"{one} and {two}")


def awkward() -> None:
    error = AwkwardError(1, two=2)
    error.add_note("part 'a'")
    raise error


def missing() -> None:
    raise FileNotFoundError(2, "not there", "file")


@pytest.mark.parametrize(
    ("act", "kind", "message"),
    [
        (awkward, RuntimeError, "AwkwardError: 1 and 2"),
        (missing, FileNotFoundError, "not there: 'file'"),
        (lambda: sys.exit(3), SystemExit, "3"),
        (aborts, EndedError, "the process at number 2 has ended: SIGABRT"),
        (lambda: os._exit(3), EndedError, "the process ended by itself, exit code 3"),
        (lambda: os.kill(os.getpid(), signal.SIGKILL), EndedError, "killed from outside"),
    ],
)
def test_an_error_is_raised_when_its_turn_has_come(
    act: Callable[[], object], kind: type[BaseException], message: str
) -> None:
    def call(number: int) -> int:
        if number == 2:
            act()
        return number

    made = []
    with pytest.raises(kind, match=message):
        for value in forked(call, 6, 2):
            made.append(value)
    assert made == [0, 1]


def test_notes_come_along_where_the_error_cannot() -> None:
    with pytest.raises(RuntimeError) as caught:
        list(forked(lambda _: awkward(), 2, 2))
    assert caught.value.__notes__ == ["part 'a'"]


def test_a_result_that_cannot_be_sent_is_an_error() -> None:
    with pytest.raises(RuntimeError, match="lambda"):
        list(forked(lambda _: lambda: None, 2, 2))


def test_no_process_is_left_when_the_results_are_no_longer_wanted() -> None:
    made = forked(lambda number: (number, os.getpid(), time.sleep(0.0 if number < 2 else 3600.0)), 6, 2)
    first = next(made)
    assert first[0] == 0
    children = below(os.getpid()) - {os.getpid()}
    made.close()  # type: ignore[attr-defined]
    assert first[1] in children
    assert not alive_after({first[1]}, 0.0)


PARENT = """
import os, sys, time
from pipeline.forked import forked
def call(number):
    os.write(int(sys.argv[1]), b"x")
    time.sleep(600)
list(forked(call, 2, 2))
"""


def test_no_process_outlives_a_parent_that_is_killed() -> None:
    read, write = os.pipe()
    words = (sys.executable, "-c", PARENT, str(write))
    with subprocess.Popen(words, pass_fds=(write,), cwd=Path.cwd()) as parent:
        assert os.read(read, 1) + os.read(read, 1) == b"xx"
        started = below(parent.pid)
        assert len(started) == 3
        os.kill(parent.pid, signal.SIGKILL)
        assert not alive_after(started, 5.0)
    for handle in (read, write):
        os.close(handle)
