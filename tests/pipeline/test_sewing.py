"""Seams of a job: allowances, notches and stitches on both sides, in closed form."""

import json
from collections import Counter
from collections.abc import Sequence
from importlib.resources import files
from math import hypot, pi
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.readpatterns import read_pattern
from pipeline.run import JobResult, PartRun, run_job
from stages.geometry.arrays import Points2
from stages.geometry.curves import contours
from stages.geometry.paths import arcpath
from stages.model.cutfile import PROFILES
from stages.model.pattern import Contour, FlatPattern
from stages.model.report import Metric
from stages.model.sewing import SeamSpec
from stages.write.readback import read as readback
from tests.near import assert_near, assert_relative
from tests.pipeline.jobs import write_job

CUP = """
schema = 1
[material]
thickness = 1
[tolerance]
chord = 0.02
[report]
formats = ["json"]
[[part]]
name = "wall"
[[part.seam]]
edge = "c0"
allowance = 6
mate = "floor.outline"
[[part.seam]]
edge = "start"
kind = "lapped"
allowance = 10
[[part.seam]]
edge = "end"
kind = "cut"
mate = "wall.start"
[[part.stitch]]
seam = "c0"
pitch = 12
diameter = 1
ends = [2, 2]
[[part.stitch]]
seam = "start"
count = 11
slit = 2
angle = 45
margin = 3
ends = [5, 5]
[[part.notch]]
seam = "c0"
fraction = "1/4"
width = 3
depth = 4
[part.surface]
kind = "cylinder"
directrix = { circle = { center = [0, 0, 0], radius = 30 } }
direction = [0, 0, 1]
length = 80
[[part]]
name = "floor"
[[part.seam]]
edge = "outline"
allowance = 5
[part.surface]
kind = "flat"
outline = { circle = { center = [0, 0], radius = 30 } }
"""
"""A cup: what is wound is 60 pi long, as its floor is around."""

ROUND = 60.0 * pi


def run(folder: Path, text: str) -> JobResult:
    return run_job(job_of(read(write_job(folder, text))))


@pytest.fixture(scope="module")
def cup(tmp_path_factory: pytest.TempPathFactory) -> JobResult:
    return run(tmp_path_factory.mktemp("cup"), CUP)


def part(result: JobResult, name: str) -> PartRun:
    return next(run for run in result.parts if run.part.name == name)


def pattern(result: JobResult, name: str) -> FlatPattern:
    found = part(result, name).pattern
    assert found is not None, part(result, name).steps[-1].report.findings
    return found


def metric(result: JobResult, name: str, key: str) -> Metric:
    return part(result, name).steps[-1].report.metric(key)


def rows(result: JobResult, name: str, table: str) -> dict[str, dict[str, object]]:
    detail = part(result, name).steps[-1].report.detail[table]
    assert isinstance(detail, list)
    return {str(row["name"]): row for row in detail}


def middles(holes: Sequence[Contour]) -> Points2:
    return np.array([contours.area_and_centroid(hole.edges)[1:] for hole in holes])


def codes(result: JobResult) -> list[str]:
    return [finding.code for run in result.parts for finding in run.steps[-1].report.findings if finding.fatal]


def test_the_wall_of_a_cup_is_cut_a_rectangle_larger_by_its_allowances(cup: JobResult) -> None:
    assert cup.status == "made", codes(cup)
    wall = pattern(cup, "wall")
    low = (-6.0, -10.0, 80.0, ROUND)
    assert_near(arcpath.bounds(wall.outer.path), low, bound=1e-9, why="c0 at x = 0 and start at y = 0 are widened")
    assert wall.boundary is not None
    assert_relative([contours.area(wall.boundary.edges)], [86.0 * (ROUND + 10.0)], bound=1e-12, why="closed form")
    v_notch = 3.0 * 4.0 / 2.0
    assert_relative([contours.area(wall.outer.edges)], [86.0 * (ROUND + 10.0) - v_notch], bound=1e-12, why="its notch")


def test_the_floor_is_cut_a_larger_circle(cup: JobResult) -> None:
    floor = pattern(cup, "floor")
    assert floor.boundary is not None
    assert_relative([arcpath.area(floor.boundary.path)], [35.0**2 * pi], bound=1e-12, why="an arc stays an arc")
    (sew,) = (mark for mark in floor.marks if mark.layer == "SEW")
    assert sew.path.closed
    assert_relative([arcpath.length(sew.path)], [ROUND], bound=1e-12, why="the outline as it was given")


def test_the_sew_line_stays_and_the_surface_keeps_its_figures(cup: JobResult) -> None:
    flat = part(cup, "wall").steps[-1].report.detail["flat"]
    assert isinstance(flat, dict)
    assert_relative([flat["area"]], [80.0 * ROUND], bound=1e-12, why="what was laid flat")
    stitches = 16 * pi / 4.0
    assert_relative([flat["cut"]["area"]], [86.0 * (ROUND + 10.0) - 6.0 - stitches], bound=1e-12, why="what is cut")
    lines = {mark.name: arcpath.length(mark.path) for mark in pattern(cup, "wall").marks if mark.layer == "SEW"}
    assert set(lines) == {"c0", "start"}, "an edge without an allowance is no line of its own"
    assert_relative([lines["c0"], lines["start"]], [ROUND, 80.0], bound=1e-9, why="along the edges")


def test_both_sides_of_a_seam_have_as_many_stitches_at_equal_fractions(cup: JobResult) -> None:
    found = {
        name: [hole for hole in pattern(cup, name).inner if hole.purpose == "stitch"] for name in ("wall", "floor")
    }
    assert [len(holes) for holes in found.values()] == [16, 16], "(60 pi - 4) / 12, rounded, and one more"
    along = middles(found["wall"])
    want = np.stack([np.zeros(16), np.linspace(2.0, ROUND - 2.0, 16)], axis=1)
    assert_near(along, want, bound=1e-9, why="on c0, evenly")
    angle = np.linspace(2.0, ROUND - 2.0, 16) / 30.0
    around = 30.0 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    assert_near(middles(found["floor"]), around, bound=1e-9, why="on the circle, evenly, begun at x")


def test_the_report_says_length_mate_and_pitch_of_every_seam(cup: JobResult) -> None:
    seams, stitches = rows(cup, "wall", "seams"), rows(cup, "wall", "stitches")
    assert (seams["c0"]["mate"], seams["c0"]["allowance"], seams["start"]["mate"]) == ("floor.outline", 6.0, None)
    assert_near([float(str(seams["c0"]["difference"]))], [0.0], bound=1e-10, why="one circle twice")
    assert (stitches["stitch-c0"]["count"], stitches["stitch-start"]["count"]) == (16, 11)
    assert_relative([float(str(stitches["stitch-c0"]["pitch"]))], [(ROUND - 4.0) / 15.0], bound=1e-12, why="15 steps")
    assert metric(cup, "wall", "seam_difference_mm").passed
    assert float(metric(cup, "wall", "allowance_error_mm").value or 0.0) <= 1e-9


def test_the_report_keeps_its_schema_and_says_what_that_describes(cup: JobResult) -> None:
    schema = json.loads(files("pipeline").joinpath("data", "report-schema.json").read_text("utf-8"))
    report, _ = outputs(cup)
    found = json.loads(json.dumps(report))
    jsonschema.Draft202012Validator(schema).validate(found)
    wall = next(one for one in found["parts"] if one["name"] == "wall")
    told = {"seams", "stitches"}
    assert told <= set(wall["stages"][-1]["detail"]) and told <= set(schema["$defs"]["detail"]["properties"])
    assert "cut" in wall["flat"]


def test_slits_lie_across_the_seam_at_their_angle_on_both_edges_that_meet(cup: JobResult) -> None:
    slits = [mark.path.vertices for mark in pattern(cup, "wall").marks if mark.layer == "CUT_SLIT"]
    assert len(slits) == 22, "start and end of the wall are sewn to each other"
    at = np.linspace(5.0, 75.0, 11)
    begin, end = (
        np.array([line.mean(axis=0) for line in slits[:11]]),
        np.array([line.mean(axis=0) for line in slits[11:]]),
    )
    assert_near(begin, np.stack([at, np.full(11, 3.0)], axis=1), bound=1e-9, why="3 into the part from y = 0")
    assert_near(end, np.stack([at, np.full(11, ROUND - 3.0)], axis=1), bound=1e-9, why="3 into the part from the end")
    step = slits[0][1] - slits[0][0]
    assert_near(step, [hypot(1.0, 1.0), hypot(1.0, 1.0)], bound=1e-9, why="2 long at 45 degrees to x")


def test_a_notch_is_cut_across_from_its_place_on_both_sides(cup: JobResult) -> None:
    (here,), (there,) = pattern(cup, "wall").notches, pattern(cup, "floor").notches
    assert (here.name, there.name) == ("notch-1", "wall.notch-1")
    assert_near(here.at, [-6.0, ROUND / 4.0], bound=1e-9, why="a quarter along c0, 6 outside it")
    assert_near(here.inward, [1.0, 0.0], bound=1e-12, why="into the part")
    assert_near(there.at, [0.0, 35.0], bound=1e-9, why="a quarter around the circle")


def test_what_is_cut_is_what_the_drawings_hold_when_they_are_read_again(cup: JobResult) -> None:
    _, written = outputs(cup)
    for name in ("wall", "floor"):
        back = read_pattern(written[f"flat/{name}.dxf"].decode("ascii"), 0.02)
        made = pattern(cup, name)
        assert_relative(
            [arcpath.area(back.outer.path)], [arcpath.area(made.outer.path)], bound=1e-9, why="ten decimals"
        )
        assert len(back.inner) == len(made.inner) == 16
        layers = [sorted(mark.layer for mark in one.marks) for one in (back, made)]
        assert layers[0] == layers[1]


def test_slits_count_as_cuts_in_the_report_and_in_the_file(cup: JobResult) -> None:
    report, _ = outputs(cup)
    found = json.loads(json.dumps(report))
    wall = next(one for one in found["parts"] if one["name"] == "wall")
    made = pattern(cup, "wall")
    whole = sum(arcpath.length(one.path) for one in (made.outer, *made.inner)) + 22 * 2.0
    assert_relative([wall["cut_length_mm"]], [whole], bound=1e-12, why="outline, 16 holes, 22 slits of 2 mm")
    assert wall["pierces"] == 1 + 16 + 22


def test_a_part_without_seams_is_left_as_it_was(cup: JobResult, tmp_path: Path) -> None:
    plain = run(
        tmp_path,
        CUP[: CUP.index("[[part.seam]]")] + CUP[CUP.index("[part.surface]") : CUP.index('[[part]]\nname = "floor"')],
    )
    wall = pattern(plain, "wall")
    assert (wall.notches, wall.boundary, wall.marks) == ((), None, ())
    assert_relative([contours.area(wall.outer.edges)], [80.0 * ROUND], bound=1e-12, why="nothing is added")


def test_a_seam_goes_by_its_name_or_else_by_its_edge() -> None:
    assert SeamSpec(edge="c0").called == "c0"
    assert SeamSpec(edge="c0", name="bottom").called == "bottom"


NESTED = """
[[stock]]
id = "hide"
width = 400
height = 300
[nest]
gap = 2
mirror = true
time_limit = 0.2
[dxf]
layers = "inventor"
"""


def test_mirrored_copies_keep_their_seams_holes_and_slits_in_the_nest_and_its_drawing(tmp_path: Path) -> None:
    few = CUP.replace("pitch = 12", "pitch = 40").replace("count = 11", "count = 3")
    result = run(tmp_path, few.replace('name = "wall"\n', 'name = "wall"\nquantity = 2\npair = true\n') + NESTED)
    assert result.status == "made" and result.nest.product is not None
    (layout,) = result.nest.product.layouts
    assert sorted((one.part, one.motion.mirrored) for one in layout.placements) == [
        ("floor", False), ("wall", False), ("wall", True),
    ]  # fmt: skip
    drawing = readback(outputs(result)[1]["cut/hide-1.dxf"].decode("ascii"), PROFILES["inventor"])
    counts = Counter(entity.layer for entity in drawing.entities)
    parts = {name: pattern(result, name) for name in ("wall", "floor")}
    holes = 2 * len(parts["wall"].inner) + len(parts["floor"].inner)
    assert (counts["CUT_OUTER"], counts["CUT_INNER"], counts["SEW"], counts["CUT_SLIT"]) == (3, holes, 5, 12)
    outer = [entity.path for entity in drawing.entities if entity.layer == "CUT_OUTER" and entity.path is not None]
    want = 2.0 * arcpath.area(parts["wall"].outer.path) + arcpath.area(parts["floor"].outer.path)
    assert_relative([sum(arcpath.area(path) for path in outer)], [want], bound=1e-9, why="ten decimals, rigid motions")
