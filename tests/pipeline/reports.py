"""Reports for the tests of their formats: small, whole, and spoilt in one place."""

import copy
import json
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.run import JobResult, run_job
from pipeline.store import write_files
from tests.pipeline.jobs import CONE, PLATE, STOCK, TWISTED, write_job

Report = dict[str, object]
ALL = 'formats = ["json", "csv", "junit"]'
STEEL = '[material]\nname = "mild steel"\nthickness = 2\n'
HOLE = "holes = [{ circle = { center = [20, 15], radius = 5 } }]\n"
JOBS = {
    "nested": PLATE + HOLE + STOCK + STEEL + CONE,
    "flat only": PLATE,
    "rejected": PLATE + STOCK + TWISTED,
    "too large": PLATE + STOCK.replace("100", "10"),
}


@cache
def ran(name: str) -> JobResult:
    """Return what became of the job of that name; it is run once."""
    text = JOBS[name].replace('formats = ["json"]', ALL)
    with TemporaryDirectory() as folder:
        return run_job(job_of(read(write_job(Path(folder), text), ["nest.time_limit=0.1"])))


@cache
def _files(name: str) -> dict[str, bytes]:
    return outputs(ran(name))[1]


def made(name: str) -> tuple[Report, dict[str, bytes]]:
    """Return the report of a job of that name as JSON has it, and all its files."""
    files = dict(_files(name))
    return json.loads(files["report.json"]), files


def output(folder: Path, name: str) -> Path:
    """Return the output folder of a job of that name."""
    _, files = made(name)
    write_files(folder / "out", files)
    return folder / "out"


def changed(report: Report, value: object, *path: str | int) -> Report:
    """Return a report with another value in one place."""
    other = copy.deepcopy(report)
    within: object = other
    for step in path[:-1]:
        assert isinstance(within, dict | list)
        within = within[step]  # type: ignore[index]
    assert isinstance(within, dict | list)
    within[path[-1]] = value  # type: ignore[index]
    return other


def numbers(value: object) -> set[float]:
    """Return every number of a document."""
    if isinstance(value, dict):
        return {one for item in value.values() for one in numbers(item)}
    if isinstance(value, list):
        return {one for item in value for one in numbers(item)}
    return {float(value)} if isinstance(value, int | float) else set()
