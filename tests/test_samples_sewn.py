"""The sewn bag: every seam of it measured against the curves that it is made of, and stitched hole on hole."""

import json
from functools import cache
from importlib.resources import files

import jsonschema
import numpy as np
import pytest

from pipeline.job import Job, job_of
from pipeline.jobfile import read
from pipeline.run import PartRun, Runner, run_set
from pipeline.sewing import sewn_runs
from stages.geometry.arrays import Points2
from stages.geometry.curves import contours
from stages.geometry.paths import arcpath
from tests.near import assert_near, assert_relative
from tests.samples import SAMPLES

SEWN = SAMPLES / "bag" / "sewn.toml"


@cache
def sewn() -> Job:
    """Return the job."""
    return job_of(read(SEWN, []))


@cache
def runs() -> dict[str, PartRun]:
    """Return the parts as they are cut; nothing is nested, which takes longer than all else."""
    runner = Runner()
    every = [run for part in sewn().parts for run in run_set(runner, part, sewn())]
    return {run.part.name: run for run in sewn_runs(runner, every, sewn().tolerances)}


def table(part: str, name: str) -> dict[str, dict]:
    detail = runs()[part].steps[-1].report.detail[name]
    assert isinstance(detail, list)
    return {row["name"]: row for row in detail}


def middles(part: str, row: str) -> Points2:
    pattern = runs()[part].pattern
    assert pattern is not None
    holes = [hole for hole in pattern.inner if hole.name.rpartition("-")[0] == row]
    return np.array([contours.area_and_centroid(hole.edges)[1:] for hole in holes])


def test_every_part_is_made() -> None:
    assert {run.steps[-1].status for run in runs().values()} == {"pass"}
    assert not [f for run in runs().values() for f in run.steps[-1].report.findings if f.fatal]


def test_the_base_is_drawn_with_the_very_curves_of_the_bodies_bottom() -> None:
    for name in ("front", "back"):
        row = table("base", "seams")[name]
        assert_near([row["difference"]], [0.0], bound=1e-10, why="one curve, as a surface's edge and as an outline")
    for name in ("left", "right"):
        assert_near([table("base", "seams")[name]["length"]], [95.0], bound=1e-10, why="from y = -95 to 0")


@pytest.mark.parametrize(("side", "half"), [("start", -0.5), ("end", 0.5)])
def test_the_gussets_are_as_long_as_the_sides_of_the_bodies_but_for_half_a_millimetre(side: str, half: float) -> None:
    row = table("body", "seams")[side]
    assert_near([row["difference"] + half], [0.0], bound=0.02, why="252.4 is the mean of both edges, as typed")


@pytest.mark.parametrize(
    ("seams", "count"),
    [
        ((("body", "c0"), ("base", "front"), ("base", "back")), 89),
        ((("body", "start"), ("gusset", "c0")), 62),
        ((("body", "end"), ("gusset", "c1")), 62),
        ((("gusset", "start"), ("base", "left"), ("base", "right")), 23),
    ],
)
def test_all_sides_of_a_seam_have_as_many_holes(seams: tuple[tuple[str, str], ...], count: int) -> None:
    assert {table(part, "stitches")[f"stitch-{seam}"]["count"] for part, seam in seams} == {count}
    assert {len(middles(part, f"stitch-{seam}")) for part, seam in seams} == {count}


def test_holes_of_the_base_lie_where_those_of_the_body_come_to_lie() -> None:
    """Equal lengths: the distance along the seam from hole to hole is the same, counted from the other end."""
    body, front = middles("body", "stitch-c0"), middles("base", "stitch-front")
    pitch = table("body", "stitches")["stitch-c0"]["pitch"]
    assert_relative([table("base", "stitches")["stitch-front"]["pitch"]], [pitch], bound=1e-12, why="equal lengths")
    chords = [np.hypot(*np.diff(row, axis=0).T) for row in (body, front)]
    assert (chords[0] <= pitch + 1e-9).all() and (chords[1] <= pitch + 1e-9).all()
    assert chords[1].min() >= 0.999 * pitch, "chords of a curve of 60 mm radius or more"


def test_every_cut_contour_holds_its_sew_lines_and_is_wider_by_the_allowances() -> None:
    for name, extra in (("body", (8 + 5, 8 + 8)), ("base", (16, None))):
        pattern, detail = runs()[name].pattern, runs()[name].steps[-1].report.detail["flat"]
        assert pattern is not None and isinstance(detail, dict)
        for key, more in zip(("width", "height"), extra, strict=True):
            if more is not None:
                assert_near([detail["cut"][key] - detail[key]], [more], bound=0.01, why="straight edges on both sides")
        assert detail["cut"]["area"] > detail["area"]
        assert {mark.layer for mark in pattern.marks} >= {"SEW"}


def test_notches_stand_on_both_sides_at_one_share_of_the_seam() -> None:
    kinds = {name: [place.kind for place in run.pattern.notches] for name, run in runs().items() if run.pattern}
    assert kinds["body"] == ["v", "castle", "v", "slit", "slit"]
    assert sorted(kinds["base"]) == ["castle", "castle", "v", "v", "v", "v"]
    assert kinds["gusset"] == ["slit", "slit"]
    base = runs()["base"].pattern
    assert base is not None
    tops = [place.at for place in base.notches if place.kind == "castle"]
    assert_near(
        [abs(at[0] - 170.0) for at in tops], [0.0, 0.0], bound=0.2, why="the middle of a curve nearly symmetric"
    )


def test_what_the_report_says_of_seams_keeps_its_schema() -> None:
    schema = json.loads(files("pipeline").joinpath("data", "report-schema.json").read_text("utf-8"))
    for name in ("seams", "stitches"):
        part = schema["$defs"]["detail"]["properties"][name]
        for one in ("body", "gusset", "base"):
            jsonschema.Draft202012Validator(part).validate([*table(one, name).values()])


def test_nothing_of_the_bag_is_covered_twice() -> None:
    for run in runs().values():
        assert run.pattern is not None
        assert arcpath.area(run.pattern.outer.path) > 0.0


def test_the_skins_are_hides_with_defects_zones_and_a_backbone_along_x() -> None:
    stock = sewn().stock
    assert [sheet.kind for sheet in stock] == ["hide", "hide"]
    for sheet in stock:
        assert sheet.outline is not None and sheet.defects and sheet.grain_deg == 0.0
        assert {zone.quality for zone in sheet.zones} == {4}
        sound = arcpath.area(sheet.outline) - sum(arcpath.area(zone.outline) for zone in sheet.zones)
        assert 0.4e6 < sound < 0.6e6, "a calf skin, mm2"


def test_what_shows_lies_on_sound_leather_and_the_straps_along_the_backbone() -> None:
    parts = {part.spec.name: part.spec for part in sewn().parts}
    assert {name for name, spec in parts.items() if spec.quality == 4} == {"gusset", "base"}
    assert {name for name, spec in parts.items() if spec.quality == "best"} == {"body", "flap", "strap"}
    assert float(parts["strap"].stretch_axis or 0) == 90.0
