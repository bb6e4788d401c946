"""What is rendered of a report is the same, byte for byte, in every process, whatever order its sets and maps have."""

import os
import subprocess
import sys
from pathlib import Path

from tests.pipeline.jobs import CONE, PLATE, STOCK, TWISTED

FORMATS = 'formats = ["json", "html", "traveller", "csv", "junit"]'
FILES = ("report.html", "view.json", "traveller.pdf", "results.csv", "junit.xml")
SCRIPT = """
import hashlib, sys
from pathlib import Path
from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.run import run_job
for job in sys.argv[1:]:
    files = outputs(run_job(job_of(read(Path(job), ["nest.time_limit=0.1"]))))[1]
    for path, content in sorted(files.items()):
        print(Path(job).stem, path, hashlib.sha256(content).hexdigest())
"""
STEEL = '[material]\nname = "mild steel"\nthickness = 2\n'
BENT = CONE.replace("[part.surface]", "[[part.bend]]\nmax_angle = 20\n[part.surface]")


def digests(folder: Path, seed: str) -> dict[tuple[str, str], str]:
    """Return the digest of every file of both jobs, made in a process with that seed of its hashes."""
    jobs = [str(folder / "made.toml"), str(folder / "rejected.toml")]
    surroundings = {**os.environ, "PYTHONHASHSEED": seed}
    ran = subprocess.run(
        [sys.executable, "-c", SCRIPT, *jobs], check=True, capture_output=True, timeout=600, env=surroundings, text=True
    )
    rows = [line.split() for line in ran.stdout.splitlines()]
    return {(job, path): found for job, path, found in rows}


def test_two_processes_render_the_same_bytes(tmp_path: Path) -> None:
    text = PLATE.replace('formats = ["json"]', FORMATS)
    (tmp_path / "made.toml").write_text(text + STEEL + BENT + STOCK, "utf-8")
    (tmp_path / "rejected.toml").write_text(text + TWISTED, "utf-8")
    one, other = digests(tmp_path, "0"), digests(tmp_path, "20260")
    assert {(job, file) for job in ("made", "rejected") for file in FILES} <= {*one}
    differing = [key for key in one.keys() | other.keys() if one.get(key) != other.get(key)]
    assert sorted({path for _, path in differing}) == ["report.json"], "the clock is in report.json alone"
