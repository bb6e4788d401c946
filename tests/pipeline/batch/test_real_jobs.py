"""A batch of real jobs through the command line and real children: killed, gone on with, as if nothing had been."""

import json
import subprocess
import sys
import time
from pathlib import Path

from tests.pipeline.batch.inprocess import tree

COUNT = 12
CONE = {
    "schema": 1,
    "part": [
        {"name": "cone", "surface": {"kind": "cone", "radius0": 400, "radius1": 125, "height": 450, "sweep": 180}}
    ],
    "report": {"formats": ["json"]},
}


def started(jobs: Path, out: Path) -> "subprocess.Popen[str]":
    """Start a batch."""
    command = [sys.executable, "-m", "pipeline", "batch", jobs, "-o", out, "--workers", "2"]
    return subprocess.Popen([str(word) for word in command], stderr=subprocess.PIPE, text=True)


def through(jobs: Path, out: Path) -> tuple[int, str]:
    """Run a batch to its end."""
    with started(jobs, out) as batch:
        _, told = batch.communicate(timeout=300)
    return batch.returncode, told


def without_run(files: dict[str, bytes]) -> dict[str, object]:
    """Return the files, of reports all but what is of the run and not of the job."""
    reports = {name: json.loads(content) for name, content in files.items() if name.endswith("report.json")}
    return {**files, **{name: {**report, "run": None} for name, report in reports.items()}}


def test_a_batch_of_real_jobs_that_is_killed_goes_on_as_if_it_had_not_been(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    jobs = [json.dumps(CONE).replace("400", str(300 + number)) for number in range(COUNT)]
    jobs[7] = jobs[7].replace("cone", "kone")
    (tmp_path / "in" / "cones.jsonl").write_text("\n".join(jobs))
    out = tmp_path / "out"
    with started(tmp_path / "in", out) as batch:
        end = time.monotonic() + 60
        while not (out / "cones-0000001").exists() and time.monotonic() < end:
            time.sleep(0.01)
        batch.kill()
    code, told = through(tmp_path / "in", out)
    assert code == 3
    assert "cones-0000008: bad-input: " in told
    assert 'did you mean "cone"?' in told
    assert f"{COUNT} jobs: {COUNT - 1} made, 1 bad-input, 0 waiting" in told
    assert through(tmp_path / "in", tmp_path / "undisturbed")[0] == 3
    assert without_run(tree(out)) == without_run(tree(tmp_path / "undisturbed"))
    assert {name.split("/")[0] for name in tree(out)} == {f"cones-{number:07}" for number in range(1, COUNT + 1)}
