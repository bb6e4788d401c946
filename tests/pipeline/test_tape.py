"""What is measured on a blank with a tape, and how large a part is when it is formed."""

from math import hypot, pi, sqrt
from pathlib import Path

import numpy as np
import pytest

from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.report.tape import tape_entry
from pipeline.run import JobResult, run_job
from tests.near import assert_near
from tests.pipeline.jobs import CONE, PLATE, TWISTED, write_job

ROUND = """\
[[part]]
name = "disc"
[part.surface]
kind = "flat"
outline = { circle = { center = [0, 0], radius = 20 } }
[[part]]
name = "eye"
[part.surface]
kind = "flat"
outline = { polyline = [[0, 0], [40, 0], [20, 1], [0, 0]] }
"""
LAST_DIGITS = "lengths below 100 mm"


@pytest.fixture(scope="module")
def job(tmp_path_factory: pytest.TempPathFactory) -> JobResult:
    return run_job(job_of(read(write_job(tmp_path_factory.mktemp("job"), PLATE + CONE + ROUND))))


@pytest.fixture(scope="module")
def parts(job: JobResult) -> dict[str, dict]:
    listed = outputs(job)[0]["parts"]
    assert isinstance(listed, list)
    return {part["name"]: part for part in listed}


def test_a_plate_has_its_sides_and_its_diagonals_as_they_are_cut(parts: dict[str, dict]) -> None:
    spans = parts["plate"]["tape"]["spans"]
    assert [(one["what"], one["straight_mm"]) for one in spans] == [
        ("edge", 40.0), ("edge", 30.0), ("edge", 40.0), ("edge", 30.0), ("diagonal", 50.0), ("diagonal", 50.0),
    ]  # fmt: skip
    assert {one["evidence"] for one in spans} == {"proved"}
    assert [one["along_mm"] for one in spans[4:]] == [None, None]


def test_a_cone_has_the_edges_of_its_sector(parts: dict[str, dict]) -> None:
    spans = {one["what"]: one for one in parts["cone"]["tape"]["spans"]}
    slant = hypot(15.0, 6.0)
    outer = slant / 0.6
    assert_near(spans["c0"]["along_mm"], 20.0 * pi, bound=1e-9, why=LAST_DIGITS)
    assert_near(spans["start"]["straight_mm"], slant, bound=1e-9, why=LAST_DIGITS)
    angle = 20.0 * pi / outer
    across = sqrt(outer**2 + (0.4 * outer) ** 2 - 2.0 * outer * 0.4 * outer * np.cos(angle))
    assert_near(spans["diagonal"]["straight_mm"], across, bound=1e-9, why=LAST_DIGITS)
    assert {one["evidence"] for one in spans.values()} == {"sampled"}


def test_letters_name_the_ends_of_what_is_measured(parts: dict[str, dict]) -> None:
    for part in parts.values():
        at = {letter: (spot["x"], spot["y"]) for spot in part["tape"]["spots"] for letter in spot["letters"]}
        for span in part["tape"]["spans"]:
            (x, y), (to_x, to_y) = at[span["from"]], at[span["to"]]
            assert_near(hypot(to_x - x, to_y - y), span["straight_mm"], bound=1e-9, why=LAST_DIGITS)


def test_a_blank_without_corners_has_nothing_to_measure(parts: dict[str, dict]) -> None:
    assert parts["disc"]["tape"] == {"spots": [], "spans": []}
    assert len(parts["eye"]["tape"]["spots"]) == 2


def test_corners_that_are_not_on_the_outline_are_not_measured(job: JobResult) -> None:
    """An allowance around the surface: what is cut has corners of its own."""
    (cone,) = (run.pattern for run in job.parts if run.part.name == "cone")
    assert cone is not None
    grown = cone.replace(corners=cone.corners + np.array([0.0, 1.0]))
    edges = {"c0": 1.0, "c1": 2.0, "start": 3.0, "end": 4.0}
    spans = tape_entry(grown, edges)["spans"]
    assert isinstance(spans, list)
    assert {one["what"] for one in spans} == {"edge", "diagonal"}
    assert {one["evidence"] for one in spans} == {"proved"}


LAPPED = """\
schema = 1
[[part]]
name = "sleeve"
  [part.surface]
  kind = "cylinder"
  directrix = { circle = { center = [0, 0, 0], radius = 50 } }
  direction = [0, 0, 1]
  length = 200
  [[part.seam]]
  edge = "start"
  kind = "lapped"
  allowance = 12
  [[part.notch]]
  seam = "start"
  fraction = "1/2"
"""


def test_a_blank_is_measured_from_cut_to_cut_and_over_its_notches(tmp_path: Path) -> None:
    """The corners of the surface lie on the cut edges c0 and c1, 12 mm from the corners of the blank."""
    (sleeve,) = outputs(run_job(job_of(read(write_job(tmp_path, LAPPED)))))[0]["parts"]
    spans = sleeve["tape"]["spans"]
    wide, high = 200.0, 100.0 * pi + 12.0
    along = [one["along_mm"] for one in spans if one["along_mm"] is not None]
    assert_near(sorted(along), [wide, wide, high, high], bound=1e-9, why=LAST_DIGITS)
    assert_near([one["straight_mm"] for one in spans[4:]], [hypot(wide, high)] * 2, bound=1e-9, why=LAST_DIGITS)
    assert {one["evidence"] for one in spans} == {"proved"}


def test_corners_that_fall_together_are_one(job: JobResult) -> None:
    (cone,) = (run.pattern for run in job.parts if run.part.name == "cone")
    assert cone is not None
    to_a_point = cone.replace(corners=cone.corners[[0, 1, 1, 3]])
    made = tape_entry(to_a_point, {"c0": 1.0, "c1": 0.0, "start": 3.0, "end": 4.0})
    assert isinstance(made["spots"], list)
    assert [one["letters"] for one in made["spots"]] == ["A", "BC", "D"]


def test_a_formed_cone_is_as_large_as_its_circle_and_its_height(parts: dict[str, dict]) -> None:
    assert parts["cone"]["formed"]["evidence"] == "proved"
    assert_near(parts["cone"]["formed"]["size_mm"], (20.0, 20.0, 15.0), bound=1e-9, why=LAST_DIGITS)
    assert parts["plate"]["formed"] is None


def test_a_part_that_was_rejected_has_no_blank_to_measure(
    job: JobResult, tmp_path_factory: pytest.TempPathFactory
) -> None:
    made = run_job(job_of(read(write_job(tmp_path_factory.mktemp("twisted"), PLATE + TWISTED))))
    parts = outputs(made)[0]["parts"]
    assert isinstance(parts, list)
    assert parts[1]["tape"] is None
    assert_near(parts[1]["formed"]["size_mm"], (100.0, 40.0, 50.0), bound=1e-9, why=LAST_DIGITS)


def test_a_margin_is_what_is_left_to_the_limit(parts: dict[str, dict]) -> None:
    metrics = [metric for part in parts.values() for stage in part["stages"] for metric in stage["metrics"]]
    with_margin = [metric for metric in metrics if metric["margin"] is not None]
    assert with_margin
    for metric in with_margin:
        assert metric["margin"] == metric["limit"] - metric["value"]
        assert (metric["margin"] >= 0.0) is metric["pass"]
    for metric in metrics:
        numbers = [metric[key] for key in ("limit", "value") if not isinstance(metric[key], bool | None)]
        assert (metric["margin"] is None) is (len(numbers) < 2)
