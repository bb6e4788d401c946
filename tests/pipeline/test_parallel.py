"""Parts of one job in several processes: the same bytes, the same messages, and an end that is told."""

import os
from pathlib import Path

import pytest

from pipeline import parallel, run
from pipeline.job import Job, job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.parallel import Ran, spread_over
from pipeline.report.lines import step_line
from pipeline.run import Spread, one_after_the_other, run_job
from tests.pipeline.jobs import CONE, PLATE, STOCK, TWISTED, write_job


def job(folder: Path, text: str = PLATE + CONE + TWISTED) -> Job:
    return job_of(read(write_job(folder, text)))


def said(job: Job, by: Spread) -> tuple[list[str], dict[str, bytes]]:
    """Return the messages of a run and its files, the seconds of its report left out."""
    lines: list[str] = []
    result = run_job(job, lambda step: lines.append(step_line(step)), by)
    result.seconds.clear()
    return lines, outputs(result)[1]


@pytest.mark.parametrize(
    "text", [PLATE + CONE + TWISTED, PLATE + CONE, PLATE + CONE + STOCK], ids=["rejected", "flat", "nested"]
)
def test_two_processes_make_what_one_makes_byte_for_byte(tmp_path: Path, text: str) -> None:
    ready = job(tmp_path, text)
    assert said(ready, spread_over(2)) == said(ready, one_after_the_other)


def test_seconds_of_the_processes_are_counted(tmp_path: Path) -> None:
    assert run_job(job(tmp_path), by=spread_over(2)).seconds.keys() == run_job(job(tmp_path)).seconds.keys()


def ends(_number: int) -> Ran:
    os.abort()


def fails(_number: int) -> Ran:
    error = ValueError("a defect")
    error.add_note("part 'plate'")
    raise error


def test_a_process_that_ends_is_an_error_with_the_name_of_the_part(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(parallel, "run_number", ends)
    with pytest.raises(RuntimeError, match="the process that ran part 'plate' has ended: SIGABRT"):
        run_job(job(tmp_path), by=spread_over(2))


def test_an_error_in_a_process_is_raised_here_with_its_notes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(parallel, "run_number", fails)
    with pytest.raises(ValueError, match="a defect") as caught:
        run_job(job(tmp_path), by=spread_over(2))
    assert caught.value.__notes__ == ["part 'plate'"]


def test_one_worker_and_one_part_need_no_process(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(parallel, "ProcessPool", None)
    assert run.spread(1) is one_after_the_other
    assert run_job(job(tmp_path, PLATE), by=run.spread(2)).status == "made"
