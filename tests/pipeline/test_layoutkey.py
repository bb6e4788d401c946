"""A layout that the job file names: as if it had been given on the command line, and no further off than its folder."""

import json
from pathlib import Path

import pytest

from pipeline.cli import main
from pipeline.job import Job, job_of
from pipeline.jobfile import Given, read
from pipeline.layouts import with_layout
from pipeline.outputs import outputs
from pipeline.run import run_job
from pipeline.supply import supply_of
from stages.errors import BadInputError
from tests.pipeline.jobs import PLATE, STOCK, write_job

NEST = '[nest]\nlayout = "kept.json"\n'
TEXT = PLATE + STOCK


def copies(**changes: object) -> str:
    """Return a layout of the one plate, in a place of its own."""
    plate = {"part": "plate", "copy": 1, "x": 31.0, "y": 17.5, "angle": 0.0, "mirrored": False} | changes
    sheets = [{"stock": "sheet", "index": 1, "placements": [plate]}]
    return json.dumps({"schema": "planish-layout/1", "sheets": sheets}, indent=1)


def job(folder: Path, text: str = TEXT + NEST, layout: str | None = None, given: Given | None = None) -> Job:
    (folder / "kept.json").write_text(layout or copies(), "utf-8")
    return job_of(read(write_job(folder, text), given=given or Given()))


def said(caught: "pytest.ExceptionInfo[BadInputError]") -> str:
    return "\n".join(map(str, caught.value.problems))


def test_a_layout_that_the_job_names_is_the_one_of_the_command_line(tmp_path: Path) -> None:
    named = run_job(job(tmp_path))
    given = run_job(with_layout(job(tmp_path, TEXT), tmp_path / "kept.json"))
    for result in (named, given):
        result.seconds.clear()
    assert named.job.inputs[1] == given.job.inputs[1] == ("kept.json", named.job.inputs[1][1])
    (_, one), (_, two) = outputs(named), outputs(given)
    assert one.keys() == two.keys()
    different = {name for name in one if one[name] != two[name]}
    assert different <= {"report.json"}, "the digest of the job file is in the report"
    assert b'"x": 31.0' in one["layout.json"]


def test_where_copies_lie_is_not_what_the_job_is(tmp_path: Path) -> None:
    assert job(tmp_path).digest == job(tmp_path, TEXT).digest
    assert job(tmp_path).digest != job(tmp_path, TEXT.replace("40", "41") + NEST).digest


def test_the_command_line_comes_first_and_says_what_stays(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    job(tmp_path)
    (tmp_path / "other.json").write_text(copies(x=45.0), "utf-8")
    monkeypatch.chdir(tmp_path)
    for words, place in (([], 31.0), (["--layout", "other.json"], 45.0)):
        with pytest.raises(SystemExit) as caught:
            main(["run", "job.toml", "-o", "out", *words])
        assert caught.value.code == 0
        assert "1 copy lies on its sheets" in capfd.readouterr().err
        made = json.loads((tmp_path / "out" / "layout.json").read_text("utf-8"))
        assert made["sheets"][0]["placements"][0]["x"] == place


def test_what_is_wrong_with_it_is_said_with_its_place(tmp_path: Path) -> None:
    with pytest.raises(BadInputError) as caught:
        job(tmp_path, layout=copies(part="plato"))
    (problem,) = caught.value.problems
    assert (problem.file, problem.path) == (str(tmp_path / "kept.json"), "sheets[0].placements[0].part")
    with pytest.raises(BadInputError, match="nested too deeply"):
        job(tmp_path, layout='{"sheets": ' + "[" * 50 + "]" * 50 + "}")
    with pytest.raises(BadInputError, match="no stock to lay parts on"):
        job(tmp_path, PLATE + NEST)


@pytest.mark.parametrize(
    ("name", "message"),
    [("none.json", "there is no file none.json"), ("../out.json", "lies outside of the folder of the job file")],
)
def test_a_layout_that_cannot_be_had_is_said_at_the_key(tmp_path: Path, name: str, message: str) -> None:
    (tmp_path / "out.json").write_text(copies(), "utf-8")
    (tmp_path / "in").mkdir()
    with pytest.raises(BadInputError) as caught:
        job(tmp_path / "in", TEXT + NEST.replace("kept.json", name))
    assert message in said(caught)
    assert {problem.path for problem in caught.value.problems} == {"nest.layout"}


def test_a_folder_that_is_allowed_may_hold_it(tmp_path: Path) -> None:
    (tmp_path / "out.json").write_text(copies(), "utf-8")
    (tmp_path / "in").mkdir()
    found = job(tmp_path / "in", TEXT + NEST.replace("kept.json", "../out.json"), given=Given(allow=(tmp_path,)))
    assert found.layout is not None


def test_the_stock_of_pooled_jobs_has_no_layout(tmp_path: Path) -> None:
    (tmp_path / "kept.json").write_text(copies(), "utf-8")
    stock = write_job(tmp_path, f"schema = 1\n{STOCK}{NEST}", "stock.toml")
    with pytest.raises(BadInputError, match="a layout is that of one job"):
        supply_of(stock)
