"""Jobs whose stock lies in other files, and these files."""

import json
from collections.abc import Callable
from pathlib import Path

import ezdxf
import pytest
from ezdxf.layouts import Modelspace

from pipeline.job import Job, job_of
from pipeline.jobfile import read
from stages.errors import BadInputError
from tests.pipeline.jobs import PLATE, write_job

SIDE = [(0, 0), (900, 0), (900, 600), (0, 600)]
ROW = '[[stock]]\nid = "skin"\nkind = "hide"\nfile = "{}"\nedge_gap = 5\n'


def job(folder: Path, stock: str) -> Job:
    """Return the job of a plate with this stock."""
    return job_of(read(write_job(folder, PLATE + stock)))


def refused(folder: Path, stock: str) -> str:
    """Return the only complaint about a job of a plate with this stock."""
    with pytest.raises(BadInputError) as caught:
        job(folder, stock)
    (problem,) = caught.value.problems
    return str(problem).removeprefix(f"{folder}/")


def drawing(folder: Path, draw: Callable[[Modelspace], None], name: str = "skin.dxf") -> None:
    """Write a drawing."""
    document = ezdxf.new("R2000", units=ezdxf.units.MM)
    draw(document.modelspace())
    document.saveas(folder / name)


def outline(space: Modelspace, layer: str = "SHEET", dx: float = 0.0) -> None:
    """Draw the outline of a hide."""
    space.add_lwpolyline([(x + dx, y) for x, y in SIDE], close=True, dxfattribs={"layer": layer})


REMNANTS = {
    "schema": "planish-remnant/1",
    "remnants": [
        {
            "id": f"plate-{i}", "width_mm": 812.5, "height_mm": 100.25 * i, "material": "DC01", "thickness_mm": 2.0,
            "grain_deg": 90.0, "from": {"job": "hoppers", "stock": "plate", "sheet": i, "x": 1687.5, "y": 0.0},
        }
        for i in (1, 2)
    ],
}  # fmt: skip
FROM_REMNANTS = '[[stock]]\nfile = "remnant.json"\nedge_gap = 4\n'


def remnants(folder: Path, **changes: object) -> None:
    """Write what is left over of two plates."""
    entries = [entry | changes for entry in REMNANTS["remnants"]]  # type: ignore[operator]
    (folder / "remnant.json").write_text(json.dumps(REMNANTS | {"remnants": entries}))
