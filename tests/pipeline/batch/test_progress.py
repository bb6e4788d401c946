"""What a user hears of a batch while it runs."""

import json
from typing import cast

import pytest

from pipeline.batch import progress
from pipeline.batch.progress import Progress, duration
from pipeline.batch.runner import Event, Loop
from pipeline.batch.work import Record, Status


class StandIn:
    """What of a run progress looks at."""

    accepted = 100
    left: int | None = None


def ended(status: Status, job: str = "job") -> Event:
    return Event(job, Record(status, "why", 1.0, (), "", own=True), 1, final=True)


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """A clock that stands still unless it is set."""
    now = [0.0]
    monkeypatch.setattr(progress, "monotonic", lambda: now[0])
    return now


def test_rate_and_time_left_are_those_of_the_last_half_minute(clock: list[float]) -> None:
    said: list[str] = []
    loop = StandIn()
    listener = Progress(said.append)
    listener(cast(Loop, loop), None)
    for second in range(1, 101):
        clock[0] = float(second)
        for _ in range(1 if second <= 50 else 3):
            listener(cast(Loop, loop), ended("made"))
    loop.left = 600
    clock[0] = 110.0
    listener(cast(Loop, loop), None)
    assert said[0] == "10 done, 100 jobs taken in, 1/s"
    assert len(said) == 11
    assert said[-1] == "200 done, 600 left, 2.3/s, 4 min to go", "(200 - 108) in the 40 s since the line at 70 s"


def test_only_some_failures_are_told_one_by_one(clock: list[float]) -> None:
    said: list[str] = []
    listener = Progress(said.append)
    for number in range(50):
        listener(cast(Loop, StandIn()), ended("rejected", f"job-{number}"))
    assert said[0] == "job-0: rejected: why"
    assert len(said) == 20
    clock[0] = 10.0
    listener(cast(Loop, StandIn()), None)
    assert said[-1].endswith("50 not made")


def test_that_the_workers_start_is_said_once(clock: list[float]) -> None:
    """Before the first job has ended there is no rate, and little to say; a long first job is heard of each minute."""
    said: list[str] = []
    loop = StandIn()
    loop.left = 5
    listener = Progress(said.append)
    for second in range(0, 76, 5):
        clock[0] = float(second)
        listener(cast(Loop, loop), None)
    assert said == ["5 left, the workers start", "5 left, none done yet"]
    listener(cast(Loop, loop), ended("made"))
    clock[0] = 80.0
    listener(cast(Loop, loop), None)
    assert said[2].startswith("1 done, 5 left, ")


def test_a_terminal_has_one_line_that_is_written_over(clock: list[float]) -> None:
    said: list[str] = []
    listener = Progress(said.append, terminal=True)
    listener(cast(Loop, StandIn()), None)
    clock[0] = 1.0
    listener(cast(Loop, StandIn()), ended("made"))
    listener(cast(Loop, StandIn()), ended("rejected"))
    clock[0] = 2.0
    listener(cast(Loop, StandIn()), None)
    assert said[0] == "\r1 done, 100 jobs taken in, 1/s"
    assert said[1].strip("\r ") == ""
    assert said[2] == "job: rejected: why\n"
    assert said[3].startswith("\r2 done")


def test_quiet_says_nothing_and_json_is_one_document_a_line(clock: list[float]) -> None:
    said: list[str] = []
    written: list[str] = []
    listener = Progress(said.append, written.append, quiet=True)
    listener(cast(Loop, StandIn()), ended("crashed", "<script>\n"))
    clock[0] = 20.0
    listener(cast(Loop, StandIn()), None)
    assert said == []
    assert [json.loads(line)["event"] for line in written] == ["ended", "progress"]
    assert not any("\n" in line for line in written)


@pytest.mark.parametrize(
    ("seconds", "text"), [(3.2, "3 s"), (119, "119 s"), (600, "10 min"), (7200, "2 h"), (3.5 * 86400, "3.5 days")]
)
def test_a_time_is_said_as_people_say_it(seconds: float, text: str) -> None:
    assert duration(seconds) == text
