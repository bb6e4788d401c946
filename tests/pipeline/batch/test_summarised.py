"""The summary of a batch: every job of the journal, with what its report says."""

import csv
import json
from pathlib import Path

import pytest

from pipeline.batch.entries import job_id
from pipeline.batch.summarised import summarise
from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.report.document import encoded
from pipeline.reports import again
from pipeline.run import run_job
from stages.errors import BadInputError
from tests.pipeline.batch.runs import go, lines_file
from tests.pipeline.jobs import write_job


def summary(out: Path) -> dict[str, object]:
    """Return the summary of a batch as JSON has it."""
    summarise(out)
    found = json.loads((out / "summary.json").read_bytes())
    assert isinstance(found, dict)
    return found


def test_every_job_is_counted_and_listed(tmp_path: Path) -> None:
    out = tmp_path / "out"
    go(out, lines_file(tmp_path / "in", 5))
    assert summarise(out) == ["summary.html", "summary.json", "summary.csv"]
    rows = (out / "summary.csv").read_text().splitlines()
    assert [row.split(",")[0] for row in rows] == ["job", *(f"jobs-000000{number}" for number in range(1, 6))]


def test_a_report_that_is_none_is_no_report(tmp_path: Path) -> None:
    out = tmp_path / "out"
    go(out, lines_file(tmp_path / "in", 2))
    (out / "jobs-0000001" / "report.json").write_text("{")
    assert len((summary(out), (out / "summary.csv").read_text().splitlines())[1]) == 3


def parts_told(out: Path) -> str:
    """Return how many parts the only job of a batch has, by the table of its summary."""
    summarise(out)
    return next(csv.DictReader((out / "summary.csv").open(newline="")))["parts"]


def test_what_a_report_says_is_in_the_summary_but_not_through_a_link(tmp_path: Path) -> None:
    out, elsewhere = tmp_path / "out", tmp_path / "elsewhere"
    go(out, lines_file(tmp_path / "in", 1))
    report, _ = outputs(run_job(job_of(read(write_job(tmp_path)))))
    (out / "jobs-0000001" / "report.json").write_bytes(encoded(report))
    assert parts_told(out) == "1"
    (out / "jobs-0000001").rename(elsewhere)
    (out / "jobs-0000001").symlink_to(elsewhere, target_is_directory=True)
    assert parts_told(out) == "0"


def test_planish_report_of_a_batch_is_its_summary(tmp_path: Path) -> None:
    out = tmp_path / "out"
    go(out, lines_file(tmp_path / "in", 3))
    content, paths = again(out)
    assert paths[0] == "summary.html"
    assert json.loads(content) == summary(out)
    with pytest.raises(BadInputError, match="a batch has a summary only"):
        again(out, ["csv"])


@pytest.mark.parametrize("name", ["summary.html", "Summary.JSON", "journal.sqlite-wal"])
def test_no_job_takes_the_name_of_the_summary_or_the_journal(name: str) -> None:
    assert job_id(name) == f"_{name}"
