"""The class in the report is the worse of those by warp and by strain; a part refused at any stage is `rejected`."""

from math import radians, tan
from pathlib import Path

import pytest

from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.run import run_job

WARP_DEG = 7.0
"""Metal by warp (at most 8 deg); the least strain of a long strip is W2 / 12 = 1.24e-3, leather (above 1e-3)."""


def saddle(folder: Path, accept: str) -> Path:
    """A job for a long hyperbolic paraboloid whose largest warp, on the middle ruling, is WARP_DEG."""
    z = 1000.0 * tan(radians(WARP_DEG / 2.0))
    file = folder / "job.toml"
    file.write_text(
        f"""schema = 1
[report]
formats = ["json"]
[tolerance]
accept = "{accept}"
[[part]]
name = "saddle"
[part.surface]
kind = "ruled"
c0 = {{ bezier = [[-1000, -100, {z}], [1000, -100, {-z}]] }}
c1 = {{ bezier = [[-1000, 100, {-z}], [1000, 100, {z}]] }}
"""
    )
    return file


@pytest.mark.parametrize(("accept", "code", "reached"), [("leather", 0, "leather"), ("metal", 1, "rejected")])
def test_strain_lowers_the_class_that_warp_alone_would_give(
    tmp_path: Path, accept: str, code: int, reached: str
) -> None:
    result = run_job(job_of(read(saddle(tmp_path, accept))))
    report, _ = outputs(result)
    (part,) = report["parts"]
    assert (result.exit_code, part["class"]) == (code, reached)
    verified = next(stage for stage in part["stages"] if stage["stage"] == "verify")
    assert verified["status"] == "pass"
