"""Pooled parts keep what their drawings do not say: holes that a tool makes, stitch holes, notches and names."""

import json
from collections.abc import Callable
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

from pipeline.finished import Finished, finished
from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.pooled import Pool, pool
from pipeline.run import JobResult, run_job
from pipeline.store import write_files
from pipeline.supply import supply_of
from stages.geometry.paths.arcpath import area, length
from stages.model.cutfile import Flavour
from stages.model.pattern import FlatPattern
from stages.model.patternlayers import DRILL, NOTCH_LAYERS
from stages.write.readpieces import read_pieces
from tests.near import assert_near
from tests.pipeline.jobs import write_job

JOB = """\
schema = 1
[job]
name = "sewn"
[material]
name = "calf"
thickness = 1.5
[tolerance]
chord = {chord}
accept = "leather"
[dxf]
flavour = "{flavour}"
[report]
formats = ["json"]
[[stock]]
id = "side"
width = 400
height = 300
[nest]
gap = 2
[[part]]
name = "pocket"
[part.surface]
kind = "flat"
outline = {{ chain = [
    {{ polyline = [[0, 0], [100, 0], [100, 60]] }},
    {{ arc = {{ center = [50, 60, 0], radius = 50, normal = [0, 0, 1], start = 0, end = 180 }} }},
    {{ line = [[0, 60, 0], [0, 0, 0]] }} ] }}
[[part.hole]]
name = "rivet"
kind = "drill"
at = [30, 50]
diameter = 5
[[part.hole]]
name = "window"
kind = "circle"
at = [70, 50]
diameter = 5
[[part.mark]]
name = "note"
kind = "text"
text = "UP"
at = [50, 80]
height = 4
[[part.seam]]
edge = "outline"
name = "round"
from = 110
to = 310
allowance = 6
[[part.stitch]]
seam = "round"
pitch = 5
diameter = 1
[[part.notch]]
name = "v"
seam = "round"
fraction = "1/4"
[[part.notch]]
name = "cut slit"
kind = "slit"
seam = "round"
fraction = "1/2"
cut = true
depth = 4
[[part.notch]]
name = "castle"
kind = "castle"
seam = "round"
fraction = "3/4"
"""
CHORD_MM = 0.05
STOCK = """\
schema = 1
[dxf]
flavour = "{flavour}"
[report]
formats = ["json"]
[[stock]]
id = "hide"
width = 400
height = 300
"""
FLAVOURS: list[Flavour] = ["polyline-arcs", "lines-arcs", "polylines", "r12", "aama"]


@cache
def ran(flavour: Flavour) -> JobResult:
    with TemporaryDirectory() as folder:
        result = run_job(job_of(read(write_job(Path(folder), JOB.format(flavour=flavour, chord=CHORD_MM)))))
    assert result.status == "made", [run.steps[-1].report.findings for run in result.parts]
    return result


@cache
def files(flavour: Flavour) -> dict[str, bytes]:
    return outputs(ran(flavour))[1]


def original(flavour: Flavour) -> FlatPattern:
    (run,) = ran(flavour).parts
    assert run.pattern is not None
    return run.pattern


def job(folder: Path, flavour: Flavour, change: Callable[[dict[str, bytes]], None] = lambda _: None) -> Finished:
    content = dict(files(flavour))
    change(content)
    write_files(folder, content)
    return finished(folder)


@cache
def pooled(flavour: Flavour, into: Flavour) -> Pool:
    with TemporaryDirectory() as below:
        folder = Path(below)
        stock = folder / "stock.toml"
        stock.write_text(STOCK.format(flavour=into), "utf-8")
        (folder / "out").mkdir()
        return pool([job(folder / "out", flavour)], supply_of(stock))


def pattern_of(result: Pool) -> FlatPattern:
    ((group, made),) = result.results
    assert made.status == "made", (made.nest.report.findings, made.write.report.findings)
    assert not [note for note in group.notes if "no side file" in note]
    (pattern,) = group.patterns
    return pattern


def purposes(pattern: FlatPattern) -> list[tuple[str, str]]:
    return sorted((hole.name, hole.purpose) for hole in (*pattern.inner, *pattern.drills))


@pytest.mark.parametrize("flavour", FLAVOURS)
@pytest.mark.parametrize("into", ["polyline-arcs", "aama"])
def test_holes_and_notches_are_what_they_were(flavour: Flavour, into: Flavour) -> None:
    wanted, found = original(flavour), pattern_of(pooled(flavour, into))
    assert len(purposes(wanted)) > 30
    assert purposes(found) == purposes(wanted)
    assert [(one.name, one.kind, one.in_outline, one.is_cut) for one in found.notches] == [
        (one.name, one.kind, one.in_outline, one.is_cut) for one in wanted.notches
    ]
    for one, other in zip(found.notches, wanted.notches, strict=True):
        assert_near(one.at, other.at, bound=1e-9, why="decimals")
        assert (one.depth_mm, one.width_mm) == (other.depth_mm, other.width_mm)
    assert [text.name for text in found.texts] == ["note"]
    if flavour != "aama" or into != "aama":
        assert sorted({mark.name for mark in found.marks}) == sorted({mark.name for mark in wanted.marks})


@pytest.mark.parametrize("flavour", FLAVOURS)
@pytest.mark.parametrize("into", ["polyline-arcs", "polylines"])
def test_what_is_cut_has_the_size_of_the_development(flavour: Flavour, into: Flavour) -> None:
    """An outline within the chord of the exact one encloses no more or less than the chord times its length."""
    exact, found = original("polyline-arcs"), pattern_of(pooled(flavour, into))
    around = length(exact.outer.path)
    allowed = CHORD_MM * around + TURNED_MM2
    assert_near(area(found.outer.path), area(exact.outer.path), bound=allowed, why="chords of the tolerance")
    holes = {hole.name: abs(area(hole.path)) for hole in found.inner}
    for hole in exact.inner:
        bound = 1e-9 if hole.purpose != "cut" else CHORD_MM * length(hole.path)
        assert_near(holes[hole.name], abs(area(hole.path)), bound=bound, why="a circle again, or its chords")


TURNED_MM2 = 2.0 * 3.0 * 3.0 * 0.05
"""Two notches of 3 x 3 mm that stand across a chord turned by at most 0.05 rad."""


@pytest.mark.parametrize("flavour", ["polyline-arcs", "r12", "polylines"])
def test_a_pattern_file_of_a_pool_says_them_by_points(flavour: Flavour) -> None:
    ((_, made),) = pooled(flavour, "aama").results
    text = next(file.text for file in made.write.product or () if file.path.startswith("cut/"))
    (block,) = read_pieces(text).blocks
    layers = [point.layer for point in block.points]
    tooled = [hole for hole in original(flavour).inner if hole.purpose != "cut"]
    assert layers.count(DRILL) == len(tooled)
    assert [layers.count(NOTCH_LAYERS[kind]) for kind in ("v", "castle")] == [2, 1]
    widths = sorted(point.width_mm for point in block.points if point.layer == DRILL)
    assert_near(np.array(widths), [1.0] * (len(tooled) - 1) + [5.0], bound=1e-9, why="their diameters")


def no_side(files: dict[str, bytes]) -> None:
    del files["flat/pocket.json"]


def of_another_drawing(files: dict[str, bytes]) -> None:
    side = json.loads(files["flat/pocket.json"])
    for file in side["files"]:
        file["sha256"] = "0" * 64
    files["flat/pocket.json"] = json.dumps(side).encode()


def a_hole_less(files: dict[str, bytes]) -> None:
    side = json.loads(files["flat/pocket.json"])
    side["contours"].remove(next(one for one in side["contours"] if one["layer"] == "CUT_INNER"))
    files["flat/pocket.json"] = json.dumps(side).encode()


def no_json(files: dict[str, bytes]) -> None:
    files["flat/pocket.json"] = b"[" * 100_000


def no_features(files: dict[str, bytes]) -> None:
    side = json.loads(files["flat/pocket.json"])
    del side["features"]
    files["flat/pocket.json"] = json.dumps(side).encode()


@pytest.mark.parametrize("change", [no_side, of_another_drawing, a_hole_less, no_json, no_features])
def test_a_part_without_its_side_file_is_told(tmp_path: Path, change: Callable[[dict[str, bytes]], None]) -> None:
    assert job(tmp_path / "whole", "polyline-arcs").unrecalled == ()
    told = job(tmp_path / "less", "polyline-arcs", change)
    assert told.unrecalled == ("pocket",)
    assert {hole.purpose for hole in told.patterns[0].inner} == {"cut"}
    ((group, _),) = pool([told], None).results
    assert group.notes[-1] == (
        'no side file tells notches and what holes are for of "sewn/pocket": they are cut as drawn'
    )


STROKES = ("[report]", 'text = "strokes"\n[report]')
GRAIN = ('name = "pocket"\n', 'name = "pocket"\ngrain = 0\n')


@pytest.mark.parametrize(
    ("flavour", "change"), [("polyline-arcs", STROKES), ("aama", GRAIN)], ids=["texts as strokes", "a grain line"]
)
def test_lines_that_are_no_marks_of_the_part_do_not_hide_its_features(
    tmp_path: Path, flavour: Flavour, change: tuple[str, str]
) -> None:
    text = JOB.format(flavour=flavour, chord=CHORD_MM).replace("height = 300", "height = 300\ngrain = 0")
    result = run_job(job_of(read(write_job(tmp_path, text.replace(*change)))))
    write_files(tmp_path / "out", outputs(result)[1])
    found = finished(tmp_path / "out")
    ((pattern,), wanted) = found.patterns, result.parts[0].pattern
    assert wanted is not None
    assert found.unrecalled == ()
    assert purposes(pattern) == purposes(wanted)
    assert [notch.name for notch in pattern.notches] == [notch.name for notch in wanted.notches]
