"""A job whose part is a shell that bends in several directions: report, cut file, picture."""

import json
from functools import cache
from importlib.resources import files
from pathlib import Path
from tempfile import TemporaryDirectory

import jsonschema
import numpy as np

from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.report.pictures.branched import as_mesh
from pipeline.report.pictures.part import part_picture
from pipeline.run import JobResult, run_job
from stages.geometry.arrays import norm
from stages.model.surface import BranchedSurface
from tests import cad, cadmeasured, cadshells
from tests.near import assert_relative
from tests.pipeline.jobs import write_job

JOB = """\
schema = 1
[report]
formats = ["json"]
[material]
name = "mild steel"
thickness = 1
[[part]]
name = "bend"
face = "outer"
[part.surface]
kind = "face"
file = "bend.step"
all = true
[[part.bend]]
max_angle = 15
"""


@cache
def result() -> tuple[JobResult, dict[str, bytes], float]:
    """Return what becomes of a conical bend between two planes, its files, and its area as OpenCASCADE measures it."""
    shape = cadshells.sewn(cadshells.conical_bend())
    with TemporaryDirectory() as folder:
        cad.step(Path(folder) / "bend.step", shape)
        made = run_job(job_of(read(write_job(Path(folder), JOB))))
        return made, outputs(made)[1], cadmeasured.area(shape)


def test_it_is_cut_as_one_blank_and_its_report_keeps_the_schema() -> None:
    made, produced, area = result()
    assert made.exit_code == 0, [step.report.findings for run in made.parts for step in run.steps]
    report = json.loads(produced["report.json"])
    schema = json.loads(files("pipeline").joinpath("data", "report-schema.json").read_text("utf-8"))
    jsonschema.Draft202012Validator(schema).validate(report)
    (part,) = report["parts"]
    assert (part["name"], part["class"]) == ("bend", "exact")
    detail = part["stages"][2]["detail"]
    assert {"bends", "rolls", "flat_faces", "thickness"} <= set(detail)
    assert {row["face"] for row in detail["bends"]} == {0}
    assert_relative(part["surface"]["area"], area, bound=1e-2, why="the neutral surface lies 0.5 mm inside 34 mm")
    assert b"BEND_" in produced["flat/bend.dxf"]


def test_its_bend_lines_add_up_to_the_bend() -> None:
    report = json.loads(result()[1]["report.json"])
    detail = report["parts"][0]["stages"][2]["detail"]
    total = sum(row["angle_deg"] for row in detail["bends"])
    assert_relative(total, detail["flat_faces"][0]["angle_deg"], bound=1e-9, why="the same turning")
    assert_relative(abs(total), np.degrees(1.2 * np.cos(np.pi / 6)), bound=1e-9, why="closed form")


def test_its_picture_shows_the_faces_as_they_are_trimmed() -> None:
    made, _, area = result()
    surface = made.parts[0].surface
    assert isinstance(surface, BranchedSurface)
    shown = as_mesh(surface)
    corners = shown.mesh.vertices[shown.mesh.faces]
    sides = norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])) / 2.0
    assert_relative(float(sides.sum()), area, bound=2e-3, why="chords of 1.2 / 8 rad")
    assert len(shown.loops) == 3


def test_a_picture_is_made_of_it() -> None:
    part = result()[0].parts[0]
    assert part.surface is not None
    accepted, rejected = (part_picture(part.surface, pattern, ["a note"]) for pattern in (part.pattern, None))
    assert accepted.startswith(b"\x89PNG")
    assert accepted != rejected
