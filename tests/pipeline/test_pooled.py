"""Finished jobs nested together: groups, traces, and the command line."""

import json
from importlib.resources import files
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from pipeline.cli import main
from pipeline.finished import all_finished
from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.pooled import told_apart
from pipeline.report.pooldocument import pool_lines, pool_outputs
from pipeline.run import run_job
from pipeline.store import write_files
from stages.geometry.paths import arcpath
from tests.near import assert_near
from tests.pipeline.jobs import STOCK, write_job
from tests.pipeline.pooledjobs import (
    FILE,
    JOBS,
    Folders,
    folders_in,
    group_of,
    pooled,
    problems_of,
    report_of,
)


@pytest.fixture
def folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Folders:
    """Return the output folders of some jobs, below the folder where the test runs."""
    monkeypatch.chdir(tmp_path)
    return folders_in(tmp_path)


def test_every_placement_is_traced_to_its_order(folders: Folders) -> None:
    group = group_of(report_of(pooled(folders("first", "second"))))
    traced = [
        (one["part"], one["copy"], *one["order"].values())
        for sheet in group["nest"]["sheets"]  # type: ignore[index]
        for one in sheet["placements"]
    ]
    assert sorted(traced) == [
        ("first/plate", 1, "first", "Smith & Co", "plate", 1),
        ("second/holed", 1, "second", None, "holed", 1),
        ("second/holed", 2, "second", None, "holed", 2),
        ("second/plate", 1, "second", None, "plate", 1),
    ]


def test_patterns_come_back_with_all_that_the_nest_asks_of_them(folders: Folders) -> None:
    (job,) = all_finished(folders("second"))
    plate, holed = job.patterns
    assert (plate.part, plate.quantity, plate.rotations) == ("plate", 1, None)
    assert (holed.part, holed.quantity, holed.rotations) == ("holed", 2, (0.0, 90.0))
    assert (holed.thickness_mm, holed.density_kg_m3) == (2.0, 7850.0)
    assert [text.text for text in holed.texts] == ["UP"]
    area = arcpath.area(holed.outer.path) + arcpath.area(holed.inner[0].path)
    assert_near(area, 200.0 - 9.0 * np.pi, bound=1e-9, why="the decimals of a drawing on 80 mm of contour")
    assert_near(holed.corners, [[0, 0], [20, 0], [20, 10], [0, 10]], bound=0.0, why="as reported")


def test_stock_and_wishes_are_those_of_the_first_job_that_has_stock(folders: Folders) -> None:
    result = pooled(folders("second", "first"))
    ((group, _),) = result.results
    assert [(sheet.id, sheet.width_mm, sheet.price) for sheet in group.stock] == [("sheet", 100.0, 12.5)]
    assert group.supply.options.gap_mm == 1.0
    assert group.notes == ('stock and wishes for the nest are those of job "first"',)


def test_jobs_whose_drawings_hold_chords_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    job = write_job(tmp_path, JOBS["second"] + STOCK + '[dxf]\nflavour = "polylines"\n')
    (tmp_path / "chords").mkdir()
    write_files(tmp_path / "chords", outputs(run_job(job_of(read(job))))[1])
    ((group, _),) = pooled([Path("chords")]).results
    (note,) = group.notes[1:]
    assert note.startswith('parts of "second" are nested and written as the chords that their drawings hold')
    assert 'flavour = "polyline-arcs"' in note


def test_groups_are_of_one_material_and_thickness_each(folders: Folders) -> None:
    result = pooled(folders("first", "thin", "second"))
    assert [group.name for group, _ in result.results] == ["mild-steel-2mm", "mild-steel-1.5mm"]
    assert [sorted(group.orders) for group, _ in result.results] == [
        ["first/plate", "second/holed", "second/plate"],
        ["thin/plate"],
    ]
    _, produced = pool_outputs(result)
    assert {"mild-steel-2mm/cut/sheet-1.dxf", "mild-steel-1.5mm/cut/sheet-1.dxf", "report.json"} <= set(produced)
    label = produced["mild-steel-2mm/cut/sheet-1.dxf"].decode()
    assert all(f"\n{name}\n" in label for name in ("first-plate", "second-holed", "second-plate"))


def test_jobs_of_one_name_are_told_apart(folders: Folders) -> None:
    report = report_of(pooled(folders("first", "again")))
    assert [(job["name"], job["job"]) for job in report["jobs"]] == [  # type: ignore[attr-defined]
        ("first", "first"),
        ("first-2", "first"),
    ]
    assert [part["name"] for part in group_of(report)["parts"]] == [  # type: ignore[attr-defined]
        "first/plate",
        "first-2/plate",
    ]


def test_names_are_told_apart_whatever_they_are() -> None:
    assert told_apart(["a", "A", "a-2", "b", "a"]) == ["a", "A-2", "a-2-2", "b", "a-3"]


def test_a_file_of_stock_goes_before_that_of_the_jobs(folders: Folders) -> None:
    report = report_of(pooled(folders("first", "second"), FILE))
    nest = group_of(report)["nest"]
    assert [sheet["stock"] for sheet in nest["sheets"]] == ["big"]  # type: ignore[index]
    assert nest["options"]["gap_mm"] == 2.0  # type: ignore[index]
    total = nest["cost"]["total"]  # type: ignore[index]
    length = 2 * 140.0 + 2 * (60.0 + 6.0 * np.pi)
    assert_near(total["cut_length_mm"], length, bound=1e-8, why="decimals of the drawing")
    assert_near(total["time_s"], length / 2000.0 * 60.0 + 6.0, bound=1e-8, why="closed form")
    assert total["price"] == 8.0


def test_a_row_of_another_thickness_or_material_does_not_serve(folders: Folders) -> None:
    jobs = folders("first", "thin")
    rows = FILE + "thickness = 2\n" + FILE.partition("[[stock]]")[2].join(["[[stock]]", ""]).replace("big", "other")
    result = pooled(jobs, rows + 'material = "mild steel"\nthickness = 1.5\n')
    assert [[sheet.id for sheet in group.stock] for group, _ in result.results] == [["big"], ["other"]]
    (text,) = problems_of(lambda: pooled(jobs, FILE + "thickness = 2\n"))
    assert 'no stock for "mild-steel-1.5mm" in stock.toml' in text


def test_stock_that_several_groups_count_on_is_noted(folders: Folders) -> None:
    jobs = folders("first", "thin")
    told = [group.notes[1:] for group, _ in pooled(jobs, FILE + "quantity = 3\n").results]
    assert told == [('"big" may be of every material and thickness: each group counts on all of it',)] * 2
    assert [group.notes[1:] for group, _ in pooled(jobs, FILE).results] == [(), ()]
    assert [group.notes[1:] for group, _ in pooled(jobs[:1], FILE + "quantity = 3\n").results] == [()]


def test_a_group_that_does_not_fit_leaves_the_others_to_be_cut(folders: Folders) -> None:
    small = FILE.replace("width = 200", "width = 45").replace("height = 100", "height = 35\nthickness = 2")
    rows = small + FILE.partition("[[stock]]")[2].join(["[[stock]]", ""]).replace("big", "tiny")
    result = pooled(
        folders("first", "thin"), rows.replace("width = 200\nheight = 100", "width = 9\nheight = 9\nthickness = 1.5")
    )
    assert (result.status, result.exit_code) == ("no-solution", 3)
    report, produced = pool_outputs(result)
    assert [group["status"] for group in report["groups"]] == ["made", "no-solution"]  # type: ignore[attr-defined, index]
    cut = {path for path in produced if "/cut/" in path}
    assert cut == {"mild-steel-2mm/cut/big-1.dxf", "mild-steel-2mm/cut/big-1.json"}
    assert "mild-steel-1.5mm could not be nested and written" in pool_lines(result, "out")[-1]


def test_the_parts_of_the_report_keep_the_schema_of_a_job(folders: Folders) -> None:
    schema = json.loads(files("pipeline").joinpath("data", "report-schema.json").read_text("utf-8"))
    group = group_of(report_of(pooled(folders("first", "second"))))
    for sheet in group["nest"]["sheets"]:  # type: ignore[index]
        for placed in sheet["placements"]:
            del placed["order"]
    for name in ("nest", "write"):
        wanted = {**schema["properties"][name], "$defs": schema["$defs"]}
        jsonschema.Draft202012Validator(wanted).validate(group[name])


def test_the_same_jobs_give_the_same_files(folders: Folders) -> None:
    jobs = folders("first", "second")
    one, two = (pool_outputs(pooled(jobs))[1] for _ in range(2))
    reports = [json.loads(files.pop("report.json")) for files in (one, two)]
    assert one == two
    assert [report.pop("run") is not None for report in reports] == [True, True]
    assert reports[0] == reports[1]


def planish(*words: str) -> int:
    with pytest.raises(SystemExit) as caught:
        main(list(words))
    return int(caught.value.code or 0)


def test_the_command_nests_and_replaces_what_it_wrote(folders: Folders, capfd: pytest.CaptureFixture[str]) -> None:
    folders("first", "second")
    Path("stock.toml").write_text(FILE, "utf-8")
    for _ in range(2):
        assert planish("nest", "first", "second", "-o", "both", "--stock", "stock.toml") == 0
    shown = capfd.readouterr()
    assert shown.out == ""
    assert shown.err.splitlines()[-1] == "made: 4 pieces of 2 jobs on 1 sheet and report.json in both"
    assert Path("both/mild-steel-2mm/cut/big-1.dxf").exists()
    assert not Path("both/mild-steel-2mm/preview").exists()
    assert planish("nest", "first", "second", "-o", "both", "--stock", "stock.toml", "--json", "--quiet") == 0
    shown = capfd.readouterr()
    assert (shown.out, shown.err) == (Path("both/report.json").read_text("utf-8"), "")


def test_a_wrong_use_of_the_command_ends_with_2(folders: Folders, capfd: pytest.CaptureFixture[str]) -> None:
    folders("first")
    Path("stock.toml").write_text(FILE.replace("width = 200", "width = -1\nhight = 3"), "utf-8")
    for words in (
        ("nest",),
        ("nest", "first", "none"),
        ("nest", "first", "-o", "first"),
        ("nest", "first", "--stock", "none.toml"),
        ("nest", "first", "--stock", "stock.toml"),
        ("nest", "first", "--stock", "first/report.json"),
    ):
        assert planish(*words) == 2, words
        assert "Traceback" not in capfd.readouterr().err
    assert sorted(path.name for path in Path().iterdir()) == ["first", "stock.toml"]
