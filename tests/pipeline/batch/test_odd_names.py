"""Names of files that are no text, and such as a terminal would act on: run, remembered, and harmless where told."""

import os
from hashlib import sha256
from pathlib import Path

import pytest

from pipeline.batch import journal, told
from pipeline.batch.failures import SCHEMA
from pipeline.batch.work import Record, Work
from stages.errors import BadInputError
from tests.pipeline.batch.calls import call, plain
from tests.pipeline.batch.inprocess import InProcess, made_as, tree
from tests.pipeline.batch.runs import go

NAMES = (b"\xff.toml", b"\x1b[31mred.toml", b"good.toml")
"""No UTF-8; what turns a terminal red; one like any other."""
DRAWING = b"\xff.dxf"
IDS = ["31mred", "good", "unnamed"]


@pytest.fixture
def jobs(tmp_path: Path) -> Path:
    """A folder, itself of such a name, with jobs of such names."""
    folder = tmp_path / os.fsdecode(b"in-\xfe")
    folder.mkdir()
    for name in NAMES:
        (folder / os.fsdecode(name)).write_text("schema = 1\n")
    return folder


def naming(work: Work) -> Record:
    """Make a job that has named a file beside it."""
    drawing = Path(work.file).with_suffix(".dxf")
    named = sha256(drawing.read_bytes()).hexdigest() if drawing.exists() else ""
    return made_as(work, "rejected", ((str(drawing), named),))


def test_jobs_of_odd_names_are_run_once_and_again_when_what_they_name_changes(tmp_path: Path, jobs: Path) -> None:
    out = tmp_path / "out"
    assert sorted(go(out, jobs, InProcess(job=naming), allow=(str(jobs),))) == IDS
    assert go(out, jobs, InProcess(job=naming), allow=(str(jobs),)) == []
    (jobs / os.fsdecode(DRAWING)).write_text("new")
    assert go(out, jobs, InProcess(job=naming), allow=(str(jobs),)) == ["unnamed"]
    lines = told.explain(journal.reading(out), "unnamed", out)
    assert lines[0] == f"unnamed: {jobs / os.fsdecode(NAMES[0])}"
    assert f"  ran in run 3: {jobs / os.fsdecode(DRAWING)} has changed" in lines


def test_what_is_told_of_them_holds_nothing_that_a_terminal_acts_on(
    tmp_path: Path, jobs: Path, executor: InProcess, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    executor.job = lambda work: Record("bad-input", f"{work.file}:1:1: no", 0.0, (), "", own=True)
    assert call("batch", jobs, "-o", out, "--allow", jobs) == 3
    plain("status", out)
    for name in IDS:
        plain("explain", out, name)
    output = capsys.readouterr()
    for text in (output.out, output.err):
        assert "bad-input" in text
        assert all(letter.isprintable() or letter == "\n" for letter in text)
    assert all(SCHEMA.encode() in content for content in tree(out).values())


def test_where_a_batch_is_gone_on_with_may_have_such_a_name(
    jobs: Path, executor: InProcess, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(jobs)
    assert call("batch", ".", "-o", "out") == 0
    base = journal.reading(jobs / "out")
    assert base.execute("SELECT folder FROM run").fetchone() == (str(jobs),)
    assert sorted(executor.ran) == IDS


def test_an_id_that_is_no_text_is_no_job(tmp_path: Path, jobs: Path) -> None:
    go(tmp_path / "out", jobs)
    with pytest.raises(BadInputError, match="there is no job"):
        told.explain(journal.reading(tmp_path / "out"), os.fsdecode(b"\xff"), tmp_path / "out")
