"""What a job leaves in its folder after someone interrupted its search."""

from dataclasses import replace
from pathlib import Path

from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import left_out_lines, outputs
from pipeline.run import JobResult, run_job
from stages.model.report import Finding
from tests.pipeline.jobs import PLATE, STOCK, write_job

EVERY = PLATE.replace('["json"]', '["json", "png", "csv", "junit", "html", "traveller"]') + STOCK


def result(folder: Path, *findings: Finding) -> JobResult:
    made = run_job(job_of(read(write_job(folder, EVERY))))
    report = replace(made.nest.report, findings=(*made.nest.report.findings, *findings))
    return replace(made, nest=replace(made.nest, report=report))


def test_an_interrupted_job_leaves_out_what_takes_seconds_and_nothing_else(tmp_path: Path) -> None:
    whole = outputs(result(tmp_path))[1]
    stopped = outputs(result(tmp_path, Finding("interrupted", "stopped")))[1]
    missing = {name.partition("/")[0] for name in whole.keys() - stopped.keys()}
    assert missing == {"preview", "traveller.pdf"}
    assert stopped.keys() <= whole.keys()


def test_what_is_left_out_is_said_with_the_way_to_have_it(tmp_path: Path) -> None:
    assert list(left_out_lines(result(tmp_path))) == []
    (line,) = left_out_lines(result(tmp_path, Finding("interrupted", "stopped")))
    assert "png and traveller" in line
    assert "--layout layout.json" in line


def test_formats_that_were_not_asked_for_are_not_said_to_be_left_out(tmp_path: Path) -> None:
    stopped = result(tmp_path, Finding("interrupted", "stopped"))
    plain = replace(stopped, job=replace(stopped.job, formats=("json", "html")))
    assert list(left_out_lines(plain)) == []
