"""How much faster `planish run` is in two processes: `python -m tests.bench.workers [PARTS] [FORMATS]`.

One job of many parts of mixed kinds without stock, run as a user runs it, from the start of the program to its end,
in one process and in two by turns; the best of each counts, since a machine that does something else only adds.
FORMATS is `json` (reports and drawings alone) or `all` (pictures, page and traveller too).
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.bench.manyparts import job_text

PARTS, TURNS = 200, 3
FORMATS = {"json": '"json"', "all": '"json", "png", "csv", "junit", "html", "traveller"'}
WANTED = 1.6


def seconds(job: Path, workers: int) -> float:
    """Return how long a run takes."""
    out = job.parent / f"out-{workers}"
    words = ("-m", "pipeline", "run", str(job), "-o", str(out), "--workers", str(workers), "--quiet")
    start = time.perf_counter()
    subprocess.run((sys.executable, *words), check=True)
    return time.perf_counter() - start


def main(count: int, formats: str) -> float:
    """Measure, and return how many times as fast two processes are."""
    with tempfile.TemporaryDirectory(prefix="planish-bench-") as name:
        job = Path(name, "many.toml")
        job.write_text(job_text(count, FORMATS[formats]), "utf-8")
        found = [(seconds(job, 1), seconds(job, 2)) for _ in range(TURNS)]
    one, two = (min(times) for times in zip(*found, strict=True))
    print(f"{count} parts, {formats}: {one:.1f} s in one process, {two:.1f} s in two: {one / two:.2f} times as fast")
    return one / two


if __name__ == "__main__":
    ratio = main(int(sys.argv[1]) if sys.argv[1:] else PARTS, sys.argv[2] if sys.argv[2:] else "json")
    sys.exit(0 if ratio >= WANTED else f"less than {WANTED} times")
