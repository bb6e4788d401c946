"""Kept layouts: they replay byte for byte, and a person may edit them."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pipeline.cli import main
from pipeline.job import Job, job_of
from pipeline.jobfile import read
from pipeline.layoutfile import read_layout
from pipeline.layouts import kept, summary, with_layout
from pipeline.outputs import outputs
from pipeline.run import JobResult, run_job
from stages.errors import BadInputError
from tests.pipeline.jobs import PLATE, STOCK, write_job

Layout = dict[str, object]
NEST = "[nest]\ngap = 2\ntime_limit = 0.001\n"
MANY = NEST + PLATE.replace("[[part]]\n", "[[part]]\nquantity = 5\n", 1).replace("schema = 1\n", "")
STRIP = PLATE.partition("[[part]]")[2].replace("plate", "strip").replace("40", "80")
TEXT = "schema = 1\n" + MANY + STOCK + "[[part]]" + STRIP.replace("30]", "5]")
"""Five plates and a strip on sheets that hold two plates each."""
Rows = dict[tuple[str, int], tuple[object, ...]]


@pytest.fixture(scope="module")
def job(tmp_path_factory: pytest.TempPathFactory) -> Job:
    return job_of(read(write_job(tmp_path_factory.mktemp("job"), TEXT)))


@pytest.fixture(scope="module")
def first(job: Job) -> dict[str, bytes]:
    """The files of the job, made once."""
    return written(run_job(job))


@pytest.fixture
def made(first: dict[str, bytes]) -> Layout:
    """The layout of the job as it was made, to be edited."""
    layout: Layout = json.loads(first["layout.json"])
    return layout


def without_run(files: dict[str, bytes]) -> dict[str, object]:
    """Return the files of a job, its report without what differs from run to run."""
    report = {key: value for key, value in json.loads(files["report.json"]).items() if key != "run"}
    return {**files, "report.json": json.dumps(report)}


def written(result: JobResult) -> dict[str, bytes]:
    return outputs(result)[1]


def layout_of(result: JobResult) -> Layout:
    layout: Layout = json.loads(written(result)["layout.json"])
    return layout


def stored(folder: Path, layout: object, name: str = "layout.json") -> Path:
    file = folder / name
    file.write_text(json.dumps(layout, indent=1), "utf-8")
    return file


def sheets_of(layout: Layout) -> list[dict[str, object]]:
    sheets = layout["sheets"]
    assert isinstance(sheets, list)
    return sheets


def placements_of(layout: Layout) -> list[dict[str, object]]:
    return [placed for sheet in sheets_of(layout) for placed in sheet["placements"]]  # type: ignore[attr-defined]


def rows(layout: Layout) -> Rows:
    """Return where every copy lies."""
    return {
        (placed["part"], placed["copy"]): (sheet["stock"], sheet["index"], placed["x"], placed["y"], placed["angle"])
        for sheet in sheets_of(layout)
        for placed in sheet["placements"]  # type: ignore[attr-defined]
    }


@pytest.mark.parametrize("source", ["layout.json", "report.json"])
def test_a_layout_that_holds_every_copy_replays_byte_for_byte_without_a_search(
    tmp_path: Path, job: Job, first: dict[str, bytes], source: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / source).write_bytes(first[source])

    def searched(*_: object, **__: object) -> None:
        raise AssertionError("a stored layout is not searched")

    monkeypatch.setattr("stages.nest._searched", searched)
    again = written(run_job(with_layout(job, tmp_path / source)))
    assert without_run(again) == without_run(first)


def test_two_processes_write_the_same_bytes_from_a_layout(tmp_path: Path, made: Layout) -> None:
    write_job(tmp_path, TEXT)
    file = stored(tmp_path, made)
    for out in ("a", "b"):
        command = [sys.executable, "-m", "pipeline", "run", str(tmp_path / "job.toml"), "--layout", str(file)]
        done = subprocess.run([*command, "-o", str(tmp_path / out), "--quiet"], check=True, capture_output=True)
        assert (done.stdout, done.stderr) == (b"", b"")
    a, b = (
        {path.relative_to(tmp_path / out): path.read_bytes() for path in (tmp_path / out).rglob("*") if path.is_file()}
        for out in ("a", "b")
    )
    (report,) = {path for path in a if a[path] != b[path]}
    assert str(report) == "report.json"
    one, two = (json.loads(files[report]) for files in (a, b))
    assert {key for key in one if one[key] != two[key]} == {"run"}


def test_a_copy_moved_by_a_hair_changes_the_bytes(
    tmp_path: Path, job: Job, first: dict[str, bytes], made: Layout
) -> None:
    last = placements_of(made)[-1]
    last["x"] = float(str(last["x"])) + 1e-6
    again = run_job(with_layout(job, stored(tmp_path, made)))
    assert again.status == "made"
    changed = {name for name, content in written(again).items() if content != first[name]}
    assert "layout.json" in changed
    assert sorted(name.rpartition(".")[2] for name in changed if name.startswith("cut/")) == ["dxf", "json"]


def test_fixed_copies_stay_and_the_others_are_placed_anew(tmp_path: Path, job: Job, made: Layout) -> None:
    one = placements_of(made)[0]
    one.update(fixed=True, x=float(str(one["x"])) + 3.0, y=float(str(one["y"])) + 4.0)
    result = run_job(with_layout(job, stored(tmp_path, made)))
    assert result.status == "made"
    before, after = rows(made), rows(layout_of(result))
    key = (str(one["part"]), int(str(one["copy"])))
    assert after[key] == before[key]
    assert after.keys() == before.keys()
    assert not any("fixed" in placed for placed in placements_of(layout_of(result))), "a wish is never written"


def test_copies_that_are_left_out_are_placed_around_all_that_stay(tmp_path: Path, job: Job, made: Layout) -> None:
    for sheet in sheets_of(made):
        sheet["placements"] = sheet["placements"][:1]  # type: ignore[index]
    result = run_job(with_layout(job, stored(tmp_path, made)))
    assert result.status == "made"
    after = rows(layout_of(result))
    assert after.items() >= rows(made).items()
    assert len(after) == 6


def test_the_layout_of_a_job_with_fixed_copies_replays_like_any_other(tmp_path: Path, job: Job, made: Layout) -> None:
    placements_of(made)[1]["fixed"] = True
    first = written(run_job(with_layout(job, stored(tmp_path, made))))
    (tmp_path / "next.json").write_bytes(first["layout.json"])
    again = written(run_job(with_layout(job, tmp_path / "next.json")))
    assert without_run(again) == without_run(first)


def test_who_placed_the_copies_is_kept_while_nothing_is_added(tmp_path: Path, job: Job, made: Layout) -> None:
    made["engine"] = {"name": "a pair of scissors", "version": "1"}
    again = layout_of(run_job(with_layout(job, stored(tmp_path, made))))
    assert again["engine"] == made["engine"]
    placements_of(made)[0]["fixed"] = True
    anew = layout_of(run_job(with_layout(job, stored(tmp_path, made))))
    assert anew["engine"] == {**anew["engine"], "name": "planish"}  # type: ignore[dict-item]


def test_the_layout_is_an_input_of_the_run(tmp_path: Path, job: Job, made: Layout) -> None:
    file = stored(tmp_path, made)
    report = json.loads(written(run_job(with_layout(job, file)))["report.json"])
    assert [entry["name"] for entry in report["run"]["inputs"]] == ["job.toml", "layout.json"]


def test_a_layout_that_overlaps_is_no_solution_and_nothing_is_cut(tmp_path: Path, job: Job, made: Layout) -> None:
    first, second = next(sheet["placements"] for sheet in sheets_of(made) if len(sheet["placements"]) > 1)[:2]  # type: ignore[arg-type, index]
    second.update({key: first[key] for key in ("x", "y", "angle")})
    result = run_job(with_layout(job, stored(tmp_path, made)))
    assert (result.status, result.exit_code) == ("no-solution", 3)
    assert any("overlap" in finding.message for finding in result.nest.report.findings)
    assert not any(name.startswith("cut/") or name == "layout.json" for name in written(result))


def test_sheets_on_which_nothing_stays_go_and_the_others_move_up(tmp_path: Path, job: Job, made: Layout) -> None:
    sheets_of(made)[-1]["placements"][0]["fixed"] = True  # type: ignore[index]
    file = stored(tmp_path, made)
    (only,) = kept(read_layout(file).sheets)
    assert [row.fixed for row in only.rows] == [True]
    left = with_layout(job, file).layout
    assert left is not None
    assert summary(left) == f"{file}: 6 copies lie on its sheets, 5 that are not fixed are placed anew"


def test_sheets_of_a_stock_go_by_their_numbers_in_whatever_order_the_file_has_them(
    tmp_path: Path, job: Job, made: Layout
) -> None:
    assert len(sheets_of(made)) > 1
    wanted = rows(made)
    sheets_of(made).reverse()
    assert rows(layout_of(run_job(with_layout(job, stored(tmp_path, made))))) == wanted


ELBOW = """\
[[part]]
name = "bend"
[part.surface]
kind = "elbow"
diameter = 20
angle = 90
gores = 3
bend_radius = 30
"""


def test_blanks_are_known_by_their_numbers_once_they_are_made(tmp_path: Path) -> None:
    job = job_of(read(write_job(tmp_path, PLATE + NEST + STOCK.replace("100", "200") + ELBOW)))
    first = written(run_job(job))
    layout = json.loads(first["layout.json"])
    assert {placed["part"] for placed in placements_of(layout)} == {"plate", "bend.1", "bend.2", "bend.3"}
    assert without_run(written(run_job(with_layout(job, stored(tmp_path, layout))))) == without_run(first)
    for placed in placements_of(layout):
        placed["part"] = str(placed["part"]).replace("bend.3", "bend.4")
    ready = with_layout(job, stored(tmp_path, layout))
    with pytest.raises(BadInputError, match=r'the job has no part "bend\.4"'):
        run_job(ready)


@given(st.floats(allow_nan=False, allow_infinity=False, min_value=-1e9, max_value=1e9))
@settings(max_examples=200, deadline=None)
def test_every_double_comes_back_bit_by_bit(tmp_path_factory: pytest.TempPathFactory, value: float) -> None:
    file = tmp_path_factory.getbasetemp() / "one.json"
    row = {"part": "plate", "copy": 1, "x": value, "y": 0, "angle": -0.0}
    sheet = {"stock": "sheet", "index": 1, "placements": [row]}
    (found,) = read_layout(stored(file.parent, {"schema": "planish-layout/1", "sheets": [sheet]}, file.name)).sheets
    assert found.rows[0].motion.x.hex() == value.hex()
    assert found.rows[0].motion.angle_deg.hex() == (-0.0).hex()


def test_the_command_line_replays_and_says_what_is_wrong(
    tmp_path: Path, made: Layout, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    write_job(tmp_path, TEXT)
    stored(tmp_path, made)

    def planish(*words: str) -> int:
        with pytest.raises(SystemExit) as caught:
            main(["run", "job.toml", "--layout", *words])
        return int(caught.value.code or 0)

    assert planish("layout.json", "-o", "out") == 0
    assert json.loads((tmp_path / "out" / "layout.json").read_text("utf-8")) == made
    assert planish("out/layout.json", "-o", "out") == 2
    assert "the output folder would replace" in capfd.readouterr().err
    placements_of(made)[0]["part"] = "plato"
    stored(tmp_path, made)
    assert planish("layout.json", "-o", "new", "--json") == 2
    (error,) = json.loads(capfd.readouterr().out)["errors"]
    assert (error["file"], error["path"]) == ("layout.json", "sheets[0].placements[0].part")
    assert error["line"] > 1
    assert planish("none.json") == 2
    assert sorted(path.name for path in tmp_path.iterdir()) == ["job.toml", "layout.json", "out"]
