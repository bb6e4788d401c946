"""Points on formed parts are compared with the surfaces of the job that they are said to be of."""

import json
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from pipeline.asmade.document import compare_schema
from stages.geometry.arrays import Array
from stages.geometry.ruled import bestfit
from tests.near import assert_near
from tests.pipeline.asmadejobs import planish, sheet
from tests.pipeline.jobs import PLATE, write_job

Entry = dict[str, Any]
UNTURNED = np.eye(3)
POINTS = "part,what,measured,unit,uncertainty,x,y,z\n"


def shell_points(off: float, turn: Array = UNTURNED, shift: float = 0.0) -> str:
    """Return points on the outside of the shell, the middle of which has the radius 300, this far off, moved."""
    angles = np.radians([5.0, 30.0, 50.0, 80.0, 110.0, 115.0, 60.0, 20.0])
    heights = [10.0, 200.0, 120.0, 30.0, 240.0, 100.0, 180.0, 90.0]
    radius = 301.0 + off
    places = np.column_stack([radius * np.cos(angles), radius * np.sin(angles), heights]) @ turn.T + shift
    rows = [f"{x:.6f},{y:.6f},{z:.6f}" for x, y, z in places.tolist()]
    side = "minus"
    return POINTS + "".join(f"shell,point {side},,mm,0.02,{row}\n" for row in rows)


def test_points_are_compared_in_the_frame_of_the_part(made_job: Path, tmp_path: Path) -> None:
    file = sheet(tmp_path, shell_points(0.25))
    assert planish("compare", made_job / "out", file, "--job", made_job / "job.toml") == 0
    (cloud,) = json.loads((tmp_path / "compare.json").read_text("utf-8"))["points"]
    assert_near([abs(one["off_mm"]) for one in cloud["points"]], [0.25] * 8, bound=1e-6, why="six decimals")
    assert cloud["evidence"] == "sampled"


def fitted(made_job: Path, tmp_path: Path, text: str) -> tuple[int, Entry]:
    """Return exit code and points of a comparison with a best fit."""
    file = sheet(tmp_path, text)
    code = planish("compare", made_job / "out", file, "--job", made_job / "job.toml", "--best-fit")
    made = json.loads((tmp_path / "compare.json").read_text("utf-8"))
    jsonschema.validate(made, json.loads(compare_schema()))
    return code, made["points"][0]


def test_a_best_fit_takes_points_in_any_frame(
    made_job: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """Of a sheet rolled too wide by 0.25 mm a shift takes some; what is left is the same from every frame."""
    turn = Rotation.from_rotvec([0.4, -1.1, 2.0]).as_matrix()
    code, here = fitted(made_job, tmp_path, shell_points(0.25))
    code_there, there = fitted(made_job, tmp_path, shell_points(0.25, turn, 1234.5))
    assert (code, code_there) == (0, 0)
    off, off_there = ([one["off_mm"] for one in cloud["points"]] for cloud in (here, there))
    assert_near(np.abs(off), np.abs(off_there), bound=1e-5, why="six decimals, a fit over a third of a turn")
    assert 0.0 < there["rms_mm"] < 0.1
    assert there["best_fit"]["free"] == 2
    assert there["best_fit"]["angle_deg"] > 10.0
    told = capfd.readouterr().out
    assert "best fit: turned by" in told
    assert "note: 2 of 6 motions are not told by these points" in told


def test_a_best_fit_needs_more_points_than_motions(
    made_job: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    few = "".join(shell_points(0.0).splitlines(keepends=True)[:7])
    for text, told in ((few, "6 points of shell, copy 1 (a best fit needs more than 6"), ("", "no points to fit")):
        file = sheet(tmp_path, text or "part,what,measured,unit,uncertainty\nshell,width,250,mm,0.5\n")
        assert planish("compare", made_job / "out", file, "--job", made_job / "job.toml", "--best-fit") == 2
        assert told in capfd.readouterr().err


def test_a_best_fit_that_does_not_settle_is_no_result(
    made_job: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(bestfit, "MOST_STEPS", 1)
    turn = Rotation.from_rotvec([0.1, -0.2, 0.3]).as_matrix()
    file = sheet(tmp_path, shell_points(0.25, turn))
    assert planish("compare", made_job / "out", file, "--job", made_job / "job.toml", "--best-fit") == 3
    assert "the best fit of shell" in capfd.readouterr().err


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
