"""Points on formed parts are compared with the surfaces of the job that they are said to be of."""

import json
from pathlib import Path

import numpy as np
import pytest

from tests.near import assert_near
from tests.pipeline.asmadejobs import planish, sheet
from tests.pipeline.jobs import PLATE, write_job

POINTS = "part,what,measured,unit,uncertainty,x,y,z\n"


def shell_points(off: float) -> str:
    """Return points on the outside of the shell, the middle of which has the radius 300, this far off."""
    angles = np.radians([5.0, 30.0, 50.0, 80.0, 110.0, 115.0, 60.0, 20.0])
    heights = [10.0, 200.0, 120.0, 30.0, 240.0, 100.0, 180.0, 90.0]
    radius = 301.0 + off
    rows = [f"{radius * np.cos(a):.6f},{radius * np.sin(a):.6f},{z}" for a, z in zip(angles, heights, strict=True)]
    side = "minus"
    return POINTS + "".join(f"shell,point {side},,mm,0.02,{row}\n" for row in rows)


def test_points_are_compared_in_the_frame_of_the_part(made_job: Path, tmp_path: Path) -> None:
    file = sheet(tmp_path, shell_points(0.25))
    assert planish("compare", made_job / "out", file, "--job", made_job / "job.toml") == 0
    (cloud,) = json.loads((tmp_path / "compare.json").read_text("utf-8"))["points"]
    assert_near([abs(one["off_mm"]) for one in cloud["points"]], [0.25] * 8, bound=1e-6, why="six decimals")
    assert cloud["evidence"] == "sampled"


def test_points_need_the_job_of_the_folder(made_job: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    file = sheet(tmp_path, shell_points(0.0))
    assert planish("compare", made_job / "out", file) == 2
    assert "add --job JOB.toml" in capfd.readouterr().err
    assert planish("compare", made_job / "out", file, "--job", write_job(tmp_path, PLATE)) == 2
    assert "not the one of this report" in capfd.readouterr().err
    assert (
        planish(
            "compare",
            made_job / "out",
            sheet(tmp_path, POINTS + "'=plate(),point plus,,mm,0.1,1,2,3\n"),
            "--job",
            made_job / "job.toml",
        )
        == 2
    )
    assert "is no ruled surface" in capfd.readouterr().err
