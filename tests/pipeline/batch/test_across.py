"""A batch of real jobs begun on this machine, gone on with on a cluster, and finished here: as if nothing had been."""

import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from pipeline.batch import journal
from tests.pipeline.batch.daskprocesses import dask
from tests.pipeline.batch.inprocess import tree
from tests.pipeline.jobs import CONE, PLATE, STOCK

pytest.importorskip("distributed")
RESUMABLE, ALL_MADE = 75, 0
MILD_STEEL = '[material]\nname = "mild steel"\nthickness = 1\n'
NAMED = '[nest]\nlayout = "kept/{}.json"\n'
COUNT = 10


def copies(shift: float) -> str:
    """Return a layout of two plates and a cone."""
    places = [("plate", 1, 5.0, 5.0), ("plate", 2, 50.0 + shift, 5.0), ("cone", 1, 160.0, 100.0)]
    rows = [{"part": part, "copy": copy, "x": x, "y": y, "angle": 0.0} for part, copy, x, y in places]
    sheets = [{"stock": "sheet", "index": 1, "placements": rows}]
    return json.dumps({"schema": "planish-layout/1", "sheets": sheets})


def jobs_in(folder: Path) -> Path:
    """Write the jobs: without stock, laid by the first placement alone, and by a layout that each names."""
    (folder / "kept").mkdir(parents=True)
    wide = STOCK.replace("width = 100", "width = 260").replace("height = 60", "height = 160")
    two = PLATE.replace("[[part]]\n", "[[part]]\nquantity = 2\n")
    for number in range(COUNT):
        cone = CONE.replace("15", str(15 + number))
        sort = number % 3
        text = (PLATE + cone, PLATE + STOCK, two + cone + wide + NAMED.format(number))[sort]
        (folder / f"job-{number:02}.toml").write_text(text.replace('["json"]', '["json", "html"]') + MILD_STEEL)
        (folder / "kept" / f"{number}.json").write_text(copies(0.125 * number))
    return folder


def started(jobs: Path, out: Path, *words: str) -> "subprocess.Popen[str]":
    """Start a batch that tells each event."""
    command = [sys.executable, "-m", "pipeline", "batch", str(jobs), "-o", str(out), "--json", *words]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def ended(batch: "subprocess.Popen[str]") -> int:
    """Return the exit code of a batch that ends."""
    batch.communicate(timeout=300)
    return batch.returncode


def stopped(jobs: Path, out: Path, *words: str) -> int:
    """Start a batch, ask for its end once a job has ended, and return how many jobs are done then."""
    with started(jobs, out, *words) as batch:
        assert batch.stdout is not None
        while (said := batch.stdout.readline()) and '"event": "ended"' not in said:
            pass
        batch.send_signal(signal.SIGTERM)
        _, told = batch.communicate(timeout=300)
    assert batch.returncode == RESUMABLE, told
    assert "go on with: " in told
    return done(out)


def done(out: Path) -> int:
    """Return how many jobs of a batch are made."""
    base = journal.reading(out)
    try:
        return int(base.execute("SELECT count(*) FROM job WHERE state = 2").fetchone()[0])
    finally:
        base.close()


def test_a_batch_goes_on_on_a_cluster_and_back_byte_for_byte(tmp_path: Path) -> None:
    jobs, out = jobs_in(tmp_path / "in"), tmp_path / "out"
    with dask(tmp_path) as running, started(jobs, tmp_path / "undisturbed", "--workers", "1") as undisturbed:
        running.worker()
        here = stopped(jobs, out, "--workers", "1")
        there = stopped(jobs, out, "--cluster", running.address)
        assert 0 < here < there < COUNT
        assert ended(started(jobs, out, "--workers", "1")) == ALL_MADE
        assert ended(undisturbed) == ALL_MADE
    wanted = tree(tmp_path / "undisturbed")
    assert tree(out) == wanted
    assert done(out) == COUNT
    runs = {run for (run,) in journal.reading(out).execute("SELECT DISTINCT run FROM job")}
    assert runs == {1, 2, 3}
    (sheet,) = json.loads(wanted["job-02/layout.json"])["sheets"]
    assert [copy["x"] for copy in sheet["placements"]] == [5.0, 50.25, 160.0], "as the job's own layout says"
