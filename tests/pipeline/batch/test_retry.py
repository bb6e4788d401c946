"""`planish retry`: what was not made is run again, whatever has become of it since, and nothing else."""

import os
import signal
from dataclasses import replace
from pathlib import Path

import pytest

from pipeline.batch import identity
from pipeline.batch.work import Record, Status, Work
from tests.pipeline.batch.calls import call, plain
from tests.pipeline.batch.inprocess import InProcess, made, made_as
from tests.pipeline.batch.runs import lines_file

SECOND = "jobs-0000002"


def failing(status: Status) -> InProcess:
    """An executor whose second job fails."""

    def job(work: Work) -> Record:
        return Record(status, "why", 0.0, (), "", own=True) if work.line == 2 else made(work)

    return InProcess(job=job)


@pytest.fixture
def out(tmp_path: Path, executor: InProcess) -> Path:
    """A batch whose second job was rejected; the executor makes everything from now on."""
    executor.job = lambda work: made_as(work, "rejected" if work.line == 2 else "made")
    assert call("batch", lines_file(tmp_path / "in", 3), "-o", tmp_path / "out") == 3
    executor.ran.clear()
    executor.job = made
    return tmp_path / "out"


def test_it_runs_what_was_not_made_and_nothing_else(
    out: Path, executor: InProcess, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call("retry", out) == 0
    assert executor.ran == [SECOND]
    plain("explain", out, "JOBS-0000002")
    assert "ran in run 2: planish retry asked for it" in capsys.readouterr().out


def test_another_planish_runs_the_failed_again_and_leaves_what_was_made(
    out: Path, executor: InProcess, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now = identity.program()
    monkeypatch.setattr(identity, "program", lambda: replace(now, code="mended"))
    assert call("retry", out) == 0
    assert executor.ran == [SECOND]
    capsys.readouterr()
    plain("status", out)
    said = capsys.readouterr().out
    assert "3 jobs: 1 made, 2 waiting\n" in said
    assert f"go on with: planish batch {out.parent / 'in' / 'jobs.jsonl'} -o {out}\n" in said


@pytest.mark.parametrize(
    ("status", "more"), [("timed-out", ("--timeout", 1200)), ("out-of-memory", ("--memory", 4096))]
)
def test_more_time_or_memory_is_given_to_what_ran_out_of_it(
    tmp_path: Path, executor: InProcess, status: Status, more: tuple[str, int]
) -> None:
    executor.job = failing(status).job
    assert call("batch", lines_file(tmp_path / "in", 3), "-o", tmp_path / "out") == 3
    executor.ran.clear()
    executor.job = made
    assert call("retry", tmp_path / "out", *more) == 0
    assert executor.ran == [SECOND]


def test_one_that_was_stopped_is_gone_on_with(
    tmp_path: Path, executor: InProcess, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    executor.job = lambda work: made_as(work, "rejected")
    call("batch", lines_file(tmp_path / "in", 9), "-o", out)
    executor.ran.clear()

    def job(work: Work) -> Record:
        if work.line == 4:
            os.kill(os.getpid(), signal.SIGINT)
        return made(work)

    executor.job, executor.slots = job, 1
    assert call("retry", out) == 75
    plain("status", out)
    assert capsys.readouterr().out.endswith(f"go on with: planish retry {out}\n")
    executor.job = made
    assert call("retry", out) == 0
    assert sorted(executor.ran) == [f"jobs-000000{line}" for line in range(1, 10)]
