"""Common lines from the job file to the report, and a stored layout that gives them again."""

import json
from pathlib import Path

import pytest

from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.run import run_job
from tests.near import assert_near
from tests.pipeline.jobs import PLATE, write_job

JOB = """\
[nest]
gap = 4
common_line = {wish}
rotations = [0]
[process]
kerf = 0.2
[[stock]]
id = "sheet"
width = 300
height = 200
edge_gap = 5
"""


def made(folder: Path, wish: str) -> dict[str, bytes]:
    folder.mkdir(exist_ok=True)
    text = PLATE.replace('name = "plate"', 'name = "plate"\nquantity = 4') + JOB.format(wish=wish)
    result = run_job(job_of(read(write_job(folder, text), (), lambda _: None)))
    assert result.status == "made"
    return outputs(result)[1]


@pytest.fixture(scope="module")
def reports(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, object], dict[str, object]]:
    folder = tmp_path_factory.mktemp("jobs")
    apart, shared = (json.loads(made(folder / wish, wish)["report.json"]) for wish in ("false", "true"))
    return apart, shared


def metrics(report: dict[str, object]) -> dict[str, float]:
    return {row["name"]: row["value"] for row in report["nest"]["metrics"]}  # type: ignore[index]


def test_what_is_shared_is_cut_once_in_the_figures_of_the_sheet(
    reports: tuple[dict[str, object], dict[str, object]],
) -> None:
    apart, shared = (list(report["nest"]["sheets"]) for report in reports)  # type: ignore[index]
    assert_near(apart[0]["cut_length_mm"], 4.0 * 140.0, bound=1e-8, why="four plates of 40 x 30")
    saved = metrics(reports[1])["common_line_mm"]
    assert saved >= 3.0 * 30.0
    assert_near(shared[0]["cut_length_mm"], 560.0 - saved, bound=4.0 * 0.2, why="at most four crossings of a kerf")
    assert "common_line_mm" not in metrics(reports[0])


def test_the_finding_says_what_is_shared(reports: tuple[dict[str, object], dict[str, object]]) -> None:
    codes = [[row["code"] for row in report["write"]["findings"]] for report in reports]  # type: ignore[index]
    assert "common-lines" not in codes[0]
    assert "common-lines" in codes[1]


def test_the_way_of_the_head_is_told_and_is_no_longer_than_part_by_part(
    reports: tuple[dict[str, object], dict[str, object]],
) -> None:
    for report in reports:
        assert 0.0 < metrics(report)["travel_mm"] <= metrics(report)["travel_listed_mm"] * (1.0 + 1e-9)


BRICKS = """\
schema = 1
[material]
thickness = 1
[process]
kerf = 0.25
kerf_compensation = "offset"
kerf_corners = "{corners}"
[nest]
gap = 6
common_line = true
layout = "bricks.json"
[report]
formats = ["json"]
[[stock]]
id = "sheet"
width = 300
height = 200
edge_gap = 5
[[part]]
name = "brick"
quantity = 4
[part.surface]
kind = "flat"
outline = {{ polyline = [[0, 0], [100, 0], [100, 50], [0, 50], [0, 0]] }}
"""
"""The third brick reaches 9.75 mm over the second: too short to be a common line, and part of one that runs on."""


@pytest.mark.parametrize(("corners", "told"), [("mitre", []), ("round", ["rounded-corners"])])
def test_a_common_line_that_rounded_corners_end_is_refused_with_the_remedy(
    tmp_path: Path, corners: str, told: list[str]
) -> None:
    at = [(10.0, 10.0), (110.25, 10.0), (20.0, 60.25), (120.25, 60.25)]
    copies = [
        {"part": "brick", "copy": i, "x": x, "y": y, "angle": 0.0, "mirrored": False} for i, (x, y) in enumerate(at, 1)
    ]
    sheets = [{"stock": "sheet", "index": 1, "placements": copies}]
    stored = {"schema": "planish-layout/1", "job": "bricks", "engine": {"name": "planish", "version": "0", "seed": 0}}
    (tmp_path / "bricks.json").write_text(json.dumps({**stored, "sheets": sheets}), "utf-8")
    result = run_job(job_of(read(write_job(tmp_path, BRICKS.format(corners=corners)))))
    assert result.nest.status == "pass"
    assert [one.code for one in result.write.report.findings if one.code == "rounded-corners"] == told
    assert (result.status == "made") == (not told)
