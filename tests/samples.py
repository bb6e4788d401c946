"""Runs a sample's job and finds figures in its report: for the tests of the samples."""

import json
from collections.abc import Sequence
from pathlib import Path

import jsonschema

from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.report.schema import report_schema
from pipeline.run import JobResult, run_job
from tests.near import assert_relative

SAMPLES = Path(__file__).parent.parent / "samples"
LAST_DIGITS = 1e-12
"""What the program promises for lengths and areas, relative."""
KEEPS_SCHEMA = jsonschema.Draft202012Validator(json.loads(report_schema()))
"""The published schema: the report of every sample is held against it."""
SHORT_SEARCH = "nest.time_limit=0.2"
"""For samples whose figures do not depend on how well the parts are nested."""


def result_of(name: str, *changes: str) -> JobResult:
    """Return what becomes of a sample, without pictures."""
    return run_job(job_of(read(SAMPLES / name, ["report.formats=['json']", *changes])))


def run(name: str, *changes: str) -> tuple[dict, int, dict[str, bytes]]:
    """Return the report, the exit code and the files of a sample."""
    return told(result_of(name, *changes))


def told(result: JobResult) -> tuple[dict, int, dict[str, bytes]]:
    """Return the report, the exit code and the files of a job, the report held against the schema."""
    report, files = outputs(result)
    KEEPS_SCHEMA.validate(json.loads(files["report.json"]))
    return json.loads(json.dumps(report)), result.exit_code, files


def made(name: str) -> dict[str, dict]:
    """Return the parts of a sample that is made, each of class `exact`."""
    report, code, files = run(name, SHORT_SEARCH)
    assert (code, report["status"]) == (0, "made"), report
    assert any(file.startswith("cut/") for file in files)
    assert {part["class"] for part in report["parts"]} == {"exact"}
    return {part["name"]: part for part in report["parts"]}


def stage(part: dict, name: str) -> dict:
    return next(entry for entry in part["stages"] if entry["stage"] == name)


def figure(part: dict, name: str, metric: str) -> dict:
    return next(entry for entry in stage(part, name)["metrics"] if entry["name"] == metric)


def proved(part: dict) -> bool:
    """Return whether the part is known to have no warp and no curvature at any point."""
    found = [figure(part, "verify", name) for name in ("max_warp_deg", "max_gaussian_curvature")]
    return all((metric["value"], metric["evidence"]) == (0.0, "proved") for metric in found)


def both_sides(part: dict, key: str) -> list[float]:
    """Return the surface's and the flat pattern's figure, which are measured separately."""
    if key == "area":
        return [part["surface"]["area"], part["flat"]["area"]]
    return [part["surface"]["edges"][key], part["flat"]["edges"][key]]


def assert_figures(part: dict, expected: dict[str, object], why: str = "closed form") -> None:
    """Fail unless surface and pattern both have these areas and lengths of edges, mm2 and mm."""
    for key, value in expected.items():
        wanted: Sequence[float] = [float(str(value))] * 2
        assert_relative(both_sides(part, key), wanted, bound=LAST_DIGITS, why=f"{part['name']} {key}: {why}")
