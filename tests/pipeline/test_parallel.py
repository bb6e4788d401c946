"""Parts of one job in several processes: the same bytes, the same messages, and an end that is told."""

import faulthandler
import os
from pathlib import Path

import pytest

from pipeline import forked, parallel
from pipeline.job import Job, job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.parallel import Ran
from pipeline.report.lines import step_line
from pipeline.run import ALONE, Way, run_job, spread
from tests.pipeline.jobs import CONE, PLATE, STOCK, TWISTED, write_job


def job(folder: Path, text: str = PLATE + CONE + TWISTED) -> Job:
    return job_of(read(write_job(folder, text)))


EVERY = 'formats = ["json", "html", "png", "traveller", "csv", "junit"]'
SOME = PLATE.replace('formats = ["json"]', EVERY)


def said(job: Job, by: Way) -> tuple[list[str], dict[str, bytes]]:
    """Return the messages of a run and its files, the seconds of its report left out."""
    lines: list[str] = []
    result = run_job(job, lambda step: lines.append(step_line(step)), by)
    result.seconds.clear()
    return lines, outputs(result, by.each)[1]


@pytest.mark.parametrize(
    "text", [PLATE + CONE + TWISTED, SOME + CONE, PLATE + CONE + STOCK], ids=["rejected", "drawn", "nested"]
)
def test_two_processes_make_what_one_makes_byte_for_byte(tmp_path: Path, text: str) -> None:
    ready = job(tmp_path, text)
    assert said(ready, spread(2)) == said(ready, ALONE)


def test_seconds_of_the_processes_are_counted(tmp_path: Path) -> None:
    assert run_job(job(tmp_path), by=spread(2)).seconds.keys() == run_job(job(tmp_path)).seconds.keys()


def ends(_job: Job, _number: int) -> Ran:
    faulthandler.disable()
    os.abort()


def fails(_job: Job, _number: int) -> Ran:
    error = ValueError("a defect")
    error.add_note("part 'plate'")
    raise error


def test_a_process_that_ends_is_an_error_with_the_name_of_the_part(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(parallel, "run_number", ends)
    with pytest.raises(RuntimeError, match="the process that ran part 'plate' has ended: SIGABRT"):
        run_job(job(tmp_path), by=spread(2))


def test_an_error_in_a_process_is_raised_here_with_its_notes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(parallel, "run_number", fails)
    with pytest.raises(ValueError, match="a defect") as caught:
        run_job(job(tmp_path), by=spread(2))
    assert caught.value.__notes__ == ["part 'plate'"]


def test_one_worker_and_one_part_need_no_process(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(forked, "_started", None)
    assert spread(1) is ALONE
    assert run_job(job(tmp_path, PLATE), by=spread(2)).status == "made"
    monkeypatch.setattr(forked, "forks", lambda: False)
    monkeypatch.setattr(parallel, "forks", lambda: False)
    assert said(job(tmp_path), spread(2)) == said(job(tmp_path), ALONE)
