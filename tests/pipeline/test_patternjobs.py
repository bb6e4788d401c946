"""Jobs in the flavour aama from their file to their folder: which files, certified how, refused when, pooled again."""

import json
from pathlib import Path

import jsonschema
import pytest

import pipeline
from pipeline.cli import main
from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.run import run_job
from stages.errors import BadInputError
from stages.geometry.paths.arcpath import area
from stages.write.readpieces import read_pieces
from tests.near import assert_near
from tests.pipeline.jobs import PLATE, STOCK, TWISTED, write_job

STYLE = """\
[job]
name = "Bag \u00e4"
[dxf]
flavour = "aama"
size = "M"
[nest]
time_limit = 0.001
"""
HOLE = """\
[[part.hole]]
kind = "circle"
at = [20, 15]
diameter = 8
"""
NOTCH = """\
[[part.notch]]
edge = "outline"
distance = 20
"""
SCHEMA = Path(pipeline.__file__).parent / "data" / "report-schema.json"


def made(folder: Path, text: str) -> dict[str, bytes]:
    _, files = outputs(run_job(job_of(read(write_job(folder, text)))))
    return files


@pytest.fixture(scope="module")
def nested(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    text = PLATE.replace("schema = 1\n", f"schema = 1\n{STYLE}") + HOLE + NOTCH + STOCK
    return made(tmp_path_factory.mktemp("nested"), text)


def test_a_job_has_its_pieces_in_one_file_in_flat_files_and_on_sheets(nested: dict[str, bytes]) -> None:
    drawings = sorted(path for path in nested if path.endswith(".dxf"))
    assert drawings == ["cut/sheet-1.dxf", "flat/plate.dxf", "pieces/Bag-a.dxf"]
    assert [block.name for block in read_pieces(nested["pieces/Bag-a.dxf"].decode()).blocks] == ["PLATE_M"]
    assert [block.name for block in read_pieces(nested["cut/sheet-1.dxf"].decode()).blocks] == ["PLATE-1_M"]


def test_its_report_is_one_and_its_sheets_were_certified_as_they_read(nested: dict[str, bytes]) -> None:
    report = json.loads(nested["report.json"])
    jsonschema.validate(report, json.loads(SCHEMA.read_text("utf-8")))
    assert report["status"] == "made"
    names = {metric["name"]: metric for metric in report["write"]["metrics"]}
    assert names["max_deviation_mm"]["pass"]
    assert names["overlap_mm2"]["value"] == 0.0
    listed = [file["path"] for file in report["write"]["files"]]
    assert "pieces/Bag-a.dxf" in listed
    assert report["write"]["detail"]["pieces"]["flat/plate.dxf"]["notches"] == 1


def test_the_notch_is_a_point_on_the_whole_outline(nested: dict[str, bytes]) -> None:
    block = read_pieces(nested["flat/plate.dxf"].decode()).blocks[0]
    outline = next(line.path for line in block.lines if line.layer == "1")
    assert outline is not None
    assert_near(area(outline), 1200.0, bound=1e-6, why="40 x 30, nothing cut out of it")
    (notch,) = [point for point in block.points if point.layer == "4"]
    assert (notch.x, notch.y, notch.angle_deg) == (20.0, 0.0, 90.0)


def test_its_side_files_say_what_is_cut(nested: dict[str, bytes]) -> None:
    side = json.loads(nested["cut/sheet-1.json"])
    assert [(row["part"], row["copy"], row["layer"]) for row in side["contours"]] == [
        ("plate", 1, "CUT_INNER"), ("plate", 1, "CUT_OUTER"),
    ]  # fmt: skip
    assert side["layers"]["CUT_OUTER"]["name"] == "1"


def test_a_job_with_a_rejected_part_has_no_file_of_its_pieces(tmp_path: Path) -> None:
    files = made(tmp_path, PLATE.replace("schema = 1\n", f"schema = 1\n{STYLE}") + TWISTED)
    assert [path for path in files if path.endswith(".dxf")] == ["flat/plate.dxf"]


def test_finished_jobs_are_nested_together_from_their_pattern_files(tmp_path: Path, nested: dict[str, bytes]) -> None:
    for path, content in nested.items():
        (tmp_path / "job" / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "job" / path).write_bytes(content)
    with pytest.raises(SystemExit) as ended:
        main(["nest", str(tmp_path / "job"), "-o", str(tmp_path / "pool")])
    assert ended.value.code == 0
    (sheet,) = (tmp_path / "pool").glob("**/cut/*.dxf")
    block = read_pieces(sheet.read_text("ascii")).blocks[0]
    assert [point.layer for point in block.points if point.layer not in ("2", "3")] == ["4"]


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ('[dxf]\nflavour = "aama"\nlayers = "inventor"\n', "dxf.layers"),
        ('[dxf]\nflavour = "aama"\nversion = "R2010"\n', "leave version out"),
        ('[dxf]\nflavour = "aama"\nsise = "M"\n', 'did you mean "size"'),
        ('[dxf]\nflavour = "aama"\n[nest]\ncommon_line = true\n[process]\nkerf = 0.2\n', "whole outline"),
        ('[dxf]\nsize = "M"\n', 'flavour = "aama" does'),
    ],
)
def test_what_pattern_files_do_not_hold_is_refused_with_a_remedy(tmp_path: Path, table: str, words: str) -> None:
    with pytest.raises(BadInputError) as refused:
        read(write_job(tmp_path, PLATE.replace("schema = 1\n", f"schema = 1\n{table}")))
    assert any(words in f"{one.path}: {one.message} {one.hint}" for one in refused.value.problems), (
        refused.value.problems
    )
