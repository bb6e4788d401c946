"""What a job leaves over is the stock of the next one: listed, drawn, and taken."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from pipeline.job import Job, job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.remnants import remnant_document
from pipeline.run import JobResult, run_job
from stages.model.sheet import Nesting, Rectangle, SheetLayout
from stages.write.readback import read as read_dxf
from tests.pipeline.jobs import PLATE, write_job

MATERIAL = """\
[material]
name = "DC01"
thickness = 2
"""

LONG_STOCK = """\
[[stock]]
id = "long plate"
width = 1000
height = 200
"""


def job(folder: Path, text: str) -> Job:
    return job_of(read(write_job(folder, text), (), lambda _: None))


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> JobResult:
    return run_job(job(tmp_path_factory.mktemp("made"), PLATE + MATERIAL + LONG_STOCK))


def offcut_of(result: JobResult) -> Rectangle:
    assert result.nest.product is not None
    offcut = result.nest.product.layouts[0].offcut
    assert offcut is not None
    return offcut


def test_the_offcut_of_a_sheet_is_listed_with_where_it_comes_from(made: JobResult) -> None:
    piece = offcut_of(made)
    document = remnant_document(made)
    assert document == {
        "schema": "planish-remnant/1",
        "remnants": [
            {
                "id": "long-plate-1",
                "width_mm": piece.width_mm,
                "height_mm": piece.height_mm,
                "material": "DC01",
                "thickness_mm": 2.0,
                "grain_deg": None,
                "from": {"job": "job", "stock": "long plate", "sheet": 1, "x": piece.x, "y": piece.y},
            }
        ],
    }
    assert piece.x + piece.width_mm == 1000.0


def test_list_and_drawing_are_among_the_outputs(made: JobResult) -> None:
    report, files = outputs(made)
    piece = offcut_of(made)
    assert json.loads(files["remnant.json"]) == remnant_document(made)
    back = read_dxf(files["remnants/long-plate-1.dxf"].decode())
    (outline,) = [one.path for one in back.entities if one.path is not None]
    assert outline.vertices[2].tolist() == pytest.approx([piece.width_mm, piece.height_mm])
    assert "remnants/long-plate-1.dxf" in json.dumps(report["write"])


def without_offcut(layout: SheetLayout) -> SheetLayout:
    return replace(layout, offcut=None)


def test_no_offcut_no_file(made: JobResult) -> None:
    assert made.nest.product is not None
    bare = Nesting(tuple(map(without_offcut, made.nest.product.layouts)))
    assert remnant_document(replace(made, nest=replace(made.nest, product=bare))) is None


def test_a_job_that_is_not_made_leaves_no_remnant(made: JobResult) -> None:
    failed = replace(made, write=replace(made.write, status="fail"))
    _, files = outputs(failed)
    assert failed.status != "made"
    assert not [name for name in files if "remnant" in name or name.startswith("cut/")]


def test_the_next_job_takes_the_remnant_as_its_stock(made: JobResult, tmp_path: Path) -> None:
    _, files = outputs(made)
    (tmp_path / "remnant.json").write_bytes(files["remnant.json"])
    stock = '[[stock]]\nfile = "remnant.json"\n'
    next_job = job(tmp_path, PLATE + MATERIAL + stock)
    (sheet,) = next_job.stock
    piece = offcut_of(made)
    assert (sheet.id, sheet.kind, sheet.quantity) == ("long-plate-1", "remnant", 1)
    assert (sheet.width_mm, sheet.height_mm) == (piece.width_mm, piece.height_mm)
    result = run_job(next_job)
    assert result.status == "made"
    assert result.nest.product is not None
    assert result.nest.product.layouts[0].sheet.id == "long-plate-1"
