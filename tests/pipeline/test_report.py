"""The report of a job, through the real stages: its schema, its figures, its bytes."""

import json
import math
from functools import cache
from hashlib import sha256
from importlib.resources import files
from math import pi
from pathlib import Path
from tempfile import TemporaryDirectory

import jsonschema
import numpy as np
import pytest

from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.report.document import encoded, plain
from pipeline.run import run_job
from tests.meshes import cylinder
from tests.pipeline.jobs import CONE, PLATE, STOCK, TWISTED, write_job

STEEL = '[material]\nname = "mild steel"\nthickness = 2\n'


@cache
def files_of(text: str) -> dict[str, bytes]:
    """Return all files of a job, which is run once."""
    with TemporaryDirectory() as below:
        folder = Path(below)
        if "fine.ply" in text:
            import trimesh

            mesh = cylinder(0, 80, 24).mesh
            trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).export(folder / "fine.ply")
        return outputs(run_job(job_of(read(write_job(folder, text)))))[1]


def made(text: str) -> tuple[dict[str, object], dict[str, bytes]]:
    """Return the report as JSON reads it, and all files."""
    produced = files_of(text)
    return json.loads(produced["report.json"]), dict(produced)


def entry(report: dict[str, object], *path: str | int) -> object:
    value: object = report
    for step in path:
        assert isinstance(value, dict | list)
        value = value[step]  # type: ignore[index]
    return value


NO_PICTURES = 'schema = 1\n[report]\nformats = ["json"]\n[[part]]\nname = "part"\n[part.surface]\n'
MESH = NO_PICTURES + 'kind = "mesh"\nfile = "sample:frustum.stl"\n'
FACE = NO_PICTURES + 'kind = "face"\nfile = "sample:channel.step"\nall = true\n'
BENDS = "[[part.bend]]\nmax_angle = 30\n"
SLIGHTLY_TWISTED = """\
[[part]]
name = "slightly twisted"
[part.surface]
kind = "ruled"
c0 = { line = [[0, 0, 0], [100, 0, 0]] }
c1 = { line = [[0, 0, 50], [100, 0.02, 50]] }
"""

JOBS = {
    "nested": PLATE + STOCK + STEEL + CONE,
    "flat only": PLATE,
    "rejected": PLATE + STOCK + TWISTED,
    "too large": PLATE + STOCK.replace("100", "10"),
    "mesh": MESH,
    "mesh as it is": MESH.replace("sample:frustum.stl", "fine.ply") + "recognise = false\n",
    "face": FACE,
    "bent and rolled": PLATE + STEEL + CONE + BENDS,
    "by least strain": PLATE + SLIGHTLY_TWISTED,
}


@pytest.mark.parametrize("name", JOBS)
def test_a_report_keeps_its_schema(name: str) -> None:
    schema = json.loads(files("pipeline").joinpath("data", "report-schema.json").read_text("utf-8"))
    report, _ = made(JOBS[name])
    jsonschema.Draft202012Validator(schema).validate(report)
    assert list(report) == schema["required"]


@pytest.mark.parametrize(
    ("name", "stage", "told"),
    [
        ("mesh", 0, {"loops", "recognised"}),
        ("mesh as it is", 2, {"flattened_on"}),
        ("face", 0, {"faces"}),
        ("bent and rolled", 2, {"bends", "rolls", "given"}),
        ("by least strain", 2, {"strain_field"}),
    ],
)
def test_what_the_schema_describes_is_what_the_stages_say(name: str, stage: int, told: set[str]) -> None:
    schema = json.loads(files("pipeline").joinpath("data", "report-schema.json").read_text("utf-8"))
    report, _ = made(JOBS[name])
    detail = entry(report, "parts", -1, "stages", stage, "detail")
    assert isinstance(detail, dict)
    assert told <= set(detail)
    assert told <= set(schema["$defs"]["detail"]["properties"])
    edges = entry(report, "parts", -1, "flat", "edges")
    assert (edges is None) == (name in ("mesh as it is", "face"))


@pytest.mark.parametrize(
    ("name", "statuses", "files"),
    [
        ("nested", ["made", "pass", "pass"], {"layout.json", "flat/plate.dxf", "flat/cone.dxf", "cut/sheet-1.dxf"}),
        ("flat only", ["made", "skipped", "skipped"], {"flat/plate.dxf"}),
        ("rejected", ["rejected", "skipped", "skipped"], {"flat/plate.dxf"}),
        ("too large", ["no-solution", "fail", "skipped"], {"flat/plate.dxf"}),
    ],
)
def test_status_and_files_agree(name: str, statuses: list[str], files: set[str]) -> None:
    report, produced = made(JOBS[name])
    assert [report["status"], entry(report, "nest", "status"), entry(report, "write", "status")] == statuses
    drawings = [path for path in produced if path.endswith(".dxf")]
    assert set(produced) == {"report.json", *files, *(path.replace(".dxf", ".json") for path in drawings)}
    listed = entry(report, "write", "files")
    assert listed == [{"path": path, "sha256": sha256(produced[path]).hexdigest()} for path in drawings]


def test_mass_cut_length_and_pierces_have_closed_forms() -> None:
    hole = "holes = [{ circle = { center = [20, 15], radius = 5 } }]\n"
    report, _ = made(PLATE + hole + STOCK + STEEL)
    part = entry(report, "parts", 0)
    assert isinstance(part, dict)
    area = 40 * 30 - 25 * pi
    assert part["mass_kg"] == pytest.approx(area * 2 * 7850e-9, rel=1e-12)
    assert part["cut_length_mm"] == pytest.approx(140 + 10 * pi, rel=1e-12)
    assert part["pierces"] == 2
    sheet = entry(report, "nest", "sheets", 0)
    assert isinstance(sheet, dict)
    assert (sheet["mass_kg"], sheet["pierces"], sheet["cost"]) == (part["mass_kg"], 2, 12.5)


def test_the_figures_of_a_sheet_are_those_of_all_its_parts() -> None:
    report, _ = made(PLATE.replace('"plate"', '"plate"\nquantity = 2') + STOCK + STEEL)
    assert entry(report, "nest", "sheets", 0, "pierces") == 2
    assert entry(report, "nest", "sheets", 0, "cut_length_mm") == pytest.approx(280, rel=1e-12)
    placed = entry(report, "nest", "sheets", 0, "placements")
    assert isinstance(placed, list)
    assert [(row["part"], row["copy"]) for row in placed] == [("plate", 1), ("plate", 2)]


def test_mass_is_null_where_thickness_is_not_known() -> None:
    report, _ = made(PLATE)
    assert entry(report, "parts", 0, "mass_kg") is None


def test_names_that_no_file_system_takes_stay_in_the_report_and_leave_the_files() -> None:
    report, produced = made(PLATE.replace('"plate"', '"../Bö/ß"') + STOCK.replace('"sheet"', '"S/1"'))
    assert entry(report, "parts", 0, "name") == "../Bö/ß"
    assert entry(report, "nest", "sheets", 0, "stock") == "S/1"
    assert entry(report, "nest", "sheets", 0, "file") == "cut/S-1-1.dxf"
    assert entry(report, "nest", "sheets", 0, "placements", 0, "part") == "../Bö/ß"
    drawn = {"flat/Bo.dxf", "flat/Bo.json", "cut/S-1-1.dxf", "cut/S-1-1.json"}
    assert set(produced) == {"report.json", "layout.json", *drawn}


WOUND = """\
[[part]]
name = "wound"
quantity = 2
cut = "auto"
[part.surface]
kind = "cone"
apex = [0, 0, 0]
fraction = [0, 0.5]
directrix = { polyline = [[10, 0, 0], [5, 5, 8], [0, 10, 0], [-5, 5, -8], [-10, 0, 0], [-5, -5, 8], [0, -10, 0],
                          [5, -5, -8], [10, 0, 0]] }
"""
"""A cone of 496 deg: two blanks."""


def test_a_divided_part_has_an_entry_and_a_drawing_for_each_blank() -> None:
    report, produced = made(PLATE + STOCK + WOUND)
    assert report["status"] == "made"
    parts = report["parts"]
    assert isinstance(parts, list)
    assert [(part["name"], part["quantity"]) for part in parts] == [("plate", 1), ("wound.1", 2), ("wound.2", 2)]
    assert {"flat/wound.1.dxf", "flat/wound.2.dxf"} < set(produced)
    for number, row in enumerate(parts[1:]):
        assert [step["stage"] for step in row["stages"]] == ["construct", "verify", "unroll"]
        (found,) = [finding for finding in row["stages"][2]["findings"] if finding["code"] == "divided"]
        assert found["where"] == {"v": 4.0 * number, "v_end": 4.0 * number + 4.0}
        assert row["flat"]["area"] == pytest.approx(0.75 * 4 * 0.5 * 10 * 114**0.5 * sin_of_a_triangle(), rel=1e-12)
    placed = entry(report, "nest", "sheets", 0, "placements")
    assert isinstance(placed, list)
    assert sorted(row["part"] for row in placed) == ["plate", *["wound.1"] * 2, *["wound.2"] * 2]


def sin_of_a_triangle() -> float:
    """Return the sine of the angle at the apex of the triangles of WOUND: between (10, 0, 0) and (5, 5, 8)."""
    cosine = 50.0 / (10.0 * 114.0**0.5)
    return float((1.0 - cosine**2) ** 0.5)


def test_the_same_job_gives_the_same_bytes_but_for_run() -> None:
    text = JOBS["nested"]
    (first, one), (second, two) = made(text), made("# a remark\n" + text)
    assert first.pop("run") != second.pop("run")
    assert encoded(first) == encoded(second)
    assert {name: one[name] for name in one if name != "report.json"} == {
        name: two[name] for name in two if name != "report.json"
    }


def test_the_digest_sees_every_value() -> None:
    one, _ = made(PLATE)
    two, _ = made(PLATE.replace("[40, 30]", "[40, 30.000000001]"))
    assert entry(one, "job", "digest") != entry(two, "job", "digest")


def test_numbers_that_are_not_finite_become_null_and_arrays_lists() -> None:
    value = {"a": math.nan, "b": (math.inf, 0.1), "c": np.array([1.0, math.nan]), "d": np.float64(2.0), "e": True}
    assert json.loads(encoded(value)) == {"a": None, "b": [None, 0.1], "c": [1.0, None], "d": 2.0, "e": True}
    assert plain(np.int64(3)) == 3
