"""Jobs of meshes of bent sheet: what whoever bends them is told in the side files, without asking for bend lines."""

import json
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.run import run_job
from stages.write.readback import read as read_drawing
from tests.bentmeshes import Bend, Flat, Legs, bent, rectangle
from tests.meshregions import moved
from tests.near import assert_near
from tests.pipeline.jobs import write_job
from tests.pipeline.test_meshfiles import text_stl

LEGS: Legs = (Flat(40.0), Bend(5.0, 80.0), Flat(60.0), Bend(4.0, -100.0), Flat(30.0))
T, K, WIDTH = 2.0, 0.4, 100.0
FILE_MM = 1e-3
"""What six digits of a file leave of a sheet of 1000 mm, over a bend of 5 mm."""
JOB = """\
schema = 1
[material]
name = "steel"
thickness = 2
k_factor = 0.4
[report]
formats = ["json"]
[[stock]]
id = "sheet"
width = 400
height = 300
[nest]
time_limit = 0.1
[[part]]
name = "bracket"
quantity = 2
[part.surface]
kind = "mesh"
file = "bracket.stl"
"""


@cache
def files() -> dict[str, bytes]:
    """Return the files of the job."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "bracket.stl").write_bytes(text_stl(moved(bent(LEGS, rectangle(WIDTH, LEGS), 10.0))))
        result = run_job(job_of(read(write_job(folder, JOB))))
    assert result.status == "made", [step.report.findings for run in result.parts for step in run.steps]
    return outputs(result)[1]


def bends(path: str) -> list[dict]:
    found = json.loads(files()[path])["bends"]
    assert isinstance(found, list)
    return found


def test_the_side_file_of_the_part_has_a_row_for_each_bend_with_its_allowance() -> None:
    rows = sorted(bends("flat/bracket.json"), key=lambda row: abs(row["angle_deg"]))
    assert [row["fold"] for row in rows] == [False, False]
    assert {row["layer"] for row in rows} == {"BEND_UP", "BEND_DOWN"}
    for row, angle, radius in zip(rows, (80.0, 100.0), (5.0, 4.0), strict=True):
        inside = radius - T / 2.0
        assert_near(abs(row["angle_deg"]), angle, bound=FILE_MM, why="the mesh")
        assert_near(row["radius_mm"], [inside, inside], bound=FILE_MM, why="the mesh is the middle of the sheet")
        allowance = np.radians(angle) * (inside + K * T)
        assert_near(row["allowance_mm"], [allowance, allowance], bound=FILE_MM, why="theta (r + K t)")
    first, second = bends("flat/bracket.json")
    apart = 60.0 + sum(row["allowance_mm"][0] for row in (first, second)) / 2.0
    assert_near(first["pitch_mm"], [apart, apart], bound=FILE_MM, why="half of each, and the leg between")


@pytest.mark.parametrize("path", ["flat/bracket", "cut/sheet-1"])
def test_every_row_is_a_line_of_the_drawing(path: str) -> None:
    entities = read_drawing(files()[f"{path}.dxf"].decode("ascii")).entities
    drawn = [(one.layer, one.path.vertices) for one in entities if one.layer.startswith("BEND_") and one.path]
    rows = bends(f"{path}.json")
    assert len(rows) == (2 if path.startswith("flat/") else 4)
    for row in rows:
        (ends,) = row["pieces_in_drawing"]
        near = [min(np.abs(line - ends).max(), np.abs(line[::-1] - ends).max()) for layer, line in drawn
                if layer == row["layer"]]  # fmt: skip
        assert_near(min(near), 0.0, bound=1e-9, why="decimals of the drawing")
