"""What a job does to its process takes down that job alone, and its record says what it was."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from pipeline.batch import digest
from pipeline.batch.executor import MOST, Local, most
from tests.pipeline.batch.poison import ACTS, ENDS, GOOD, PARENT, WALL_S, poisoned, work
from tests.pipeline.batch.processes import alive_after, below

WAIT_S = 300.0
"""A machine that does much else is no failure."""


@pytest.fixture(scope="module")
def local() -> Iterator[Local]:
    executor = Local(2, poisoned)
    yield executor
    executor.close(now=True)


@pytest.mark.parametrize("kind", ACTS)
def test_a_poisonous_job_is_named_with_its_cause_and_leaves_nothing_that_looks_made(
    tmp_path: Path, local: Local, kind: str
) -> None:
    record = local.submit(work(tmp_path, 0, kind)).result(WAIT_S)
    status, cause, own = ENDS[kind]
    assert (record.status, record.own) == (status, own), record
    assert record.cause.startswith(cause.strip())
    left = sorted(path.name for path in tmp_path.rglob("*") if path.is_file())
    assert left == (["traceback.txt"] if status == "internal" else [])


def test_good_jobs_among_poisonous_ones_are_all_made(tmp_path: Path, local: Local) -> None:
    kinds = [GOOD] * 40
    kinds[3::10] = ["segfault", "exit 0", "hog", "abort"]
    futures = [local.submit(work(tmp_path, number, kind)) for number, kind in enumerate(kinds)]
    records = [future.result(WAIT_S) for future in futures]
    assert [record.status == "made" for record in records] == [kind == GOOD for kind in kinds]
    made = [number for number, kind in enumerate(kinds) if kind == GOOD]
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(map(str, made))
    assert all(records[number].digest == digest.folder(tmp_path / str(number)) for number in made)


def test_a_job_in_flight_ends_at_once_when_all_is_closed_and_is_not_blamed(tmp_path: Path) -> None:
    executor = Local(1, poisoned)
    assert executor.submit(work(tmp_path, 0)).result(WAIT_S).status == "made"
    running, waiting = executor.submit(work(tmp_path, 1, "loop", 600.0)), executor.submit(work(tmp_path, 2))
    while not running.running():
        time.sleep(0.01)
    executor.close(now=True)
    assert not running.result(0.0).own
    assert waiting.cancelled()


def test_a_job_is_not_blamed_for_the_end_of_the_process_that_children_are_forked_from(tmp_path: Path) -> None:
    executor = Local(1, poisoned)
    assert executor.submit(work(tmp_path, 0)).result(WAIT_S).status == "made"
    running = executor.submit(work(tmp_path, 1, "sleep", 600.0))
    while not running.running():
        time.sleep(0.01)
    time.sleep(0.3)
    os.kill(executor.places[0].server, signal.SIGKILL)
    assert not running.result(WAIT_S).own
    assert executor.submit(work(tmp_path, 2)).result(WAIT_S).status == "made"
    executor.close(now=True)


def test_what_a_job_has_started_ends_with_the_job_that_takes_too_long(tmp_path: Path) -> None:
    executor = Local(1, poisoned)
    assert executor.submit(work(tmp_path, 0, PARENT, WALL_S)).result(WAIT_S).status == "timed-out"
    (told,) = tmp_path.glob("*.started")
    assert not alive_after({int(told.read_text())}, 5.0)
    executor.close(now=True)


def test_nothing_starts_before_there_is_a_job() -> None:
    before = threading.active_count()
    Local(2, poisoned).close(now=False)
    assert threading.active_count() == before


@pytest.mark.parametrize(("pace", "jobs"), [(0.0, MOST), (1e-6, MOST), (0.01, 5), (0.03, 1), (600.0, 1)])
def test_short_jobs_are_sent_together_and_long_ones_alone(pace: float, jobs: int) -> None:
    assert most(pace) == jobs


def test_what_is_submitted_is_run_before_the_end(tmp_path: Path) -> None:
    executor = Local(1, poisoned)
    futures = [executor.submit(work(tmp_path, number)) for number in range(3)]
    executor.close(now=False)
    assert [future.result(0.0).status for future in futures] == ["made"] * 3


RUNNER = """
import sys, time
from pathlib import Path
from pipeline.batch.executor import Local
from tests.pipeline.batch.poison import poisoned, work
if __name__ == "__main__":
    folder = Path(sys.argv[1])
    executor = Local(2, poisoned)
    executor.submit(work(folder, 0)).result()
    for number, kind in enumerate(("loop", "sleep"), 1):
        executor.submit(work(folder, number, kind, 600.0))
    time.sleep(0.5)
    print("running", flush=True)
    time.sleep(600)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="the kernel's help is that of Linux")
def test_no_child_outlives_a_runner_that_is_killed(tmp_path: Path) -> None:
    words = (sys.executable, "-c", RUNNER, str(tmp_path))
    with subprocess.Popen(words, stdout=subprocess.PIPE, cwd=Path.cwd()) as runner:
        assert runner.stdout is not None
        assert runner.stdout.readline() == b"running\n"
        started = below(runner.pid)
        assert len(started) >= 3
        os.kill(runner.pid, signal.SIGKILL)
        assert not alive_after(started, 5.0)
