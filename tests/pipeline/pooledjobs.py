"""Finished jobs for the tests that nest several of them together, each made once."""

import json
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

from pipeline.finished import all_finished
from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.pooled import Pool, pool
from pipeline.report.pooldocument import pool_outputs
from pipeline.run import run_job
from pipeline.store import write_files
from pipeline.supply import supply_of
from stages.errors import BadInputError
from tests.pipeline.jobs import PLATE, STOCK, write_job

STEEL = '[material]\nname = "mild steel"\nthickness = 2\n'
THIN = STEEL.replace("2", "1.5")
HOLED = """\
[[part]]
name = "holed"
quantity = 2
rotations = [0, 90]
[part.surface]
kind = "flat"
outline = { polyline = [[0, 0], [20, 0], [20, 10], [0, 10], [0, 0]] }
holes = [{ circle = { center = [10, 5], radius = 3 } }]
[[part.mark]]
name = "note"
kind = "text"
text = "UP"
at = [3, 5]
height = 2
"""
PLATES = PLATE + "[nest]\ngap = 1\n"
JOBS = {
    "first": PLATES + STEEL + STOCK + '[job]\nname = "first"\ncustomer = "Smith & Co"\n',
    "second": PLATES + STEEL + '[job]\nname = "second"\n' + HOLED,
    "again": PLATES + STEEL + '[job]\nname = "first"\n',
    "thin": PLATES + THIN + STOCK + '[job]\nname = "thin"\n',
}
FILE = """\
schema = 1
[nest]
gap = 2
offcut_credit = 0.5
[process]
speed = "2 m"
pierce_time = 1
[report]
formats = ["json"]
[[stock]]
id = "big"
width = 200
height = 100
price = 8
"""
Folders = Callable[..., list[Path]]


@cache
def made(name: str) -> dict[str, bytes]:
    """Return the output files of a job."""
    with tempfile.TemporaryDirectory() as folder:
        return outputs(run_job(job_of(read(write_job(Path(folder), JOBS[name])))))[1]


def folders_in(below: Path) -> Folders:
    """Return what puts the output folders of some jobs below a folder, in which it is called."""

    def put(*names: str) -> list[Path]:
        for name in names:
            (below / name).mkdir()
            write_files(below / name, made(name))
        return [Path(name) for name in names]

    return put


def pooled(folders: list[Path], stock: str | None = None) -> Pool:
    if stock is not None:
        Path("stock.toml").write_text(stock, "utf-8")
    return pool(all_finished(folders), None if stock is None else supply_of(Path("stock.toml")))


def report_of(result: Pool) -> dict[str, object]:
    report: dict[str, object] = json.loads(pool_outputs(result)[1]["report.json"])
    return report


def group_of(report: dict[str, object], number: int = 0) -> dict[str, object]:
    group: dict[str, object] = report["groups"][number]  # type: ignore[index]
    return group


def problems_of(call: Callable[[], object]) -> list[str]:
    with pytest.raises(BadInputError) as caught:
        call()
    return [str(problem) for problem in caught.value.problems]
