"""Batch: what a job of 10 ms costs beyond its 10 ms, with two workers, beside other ways to run many.

The same job everywhere: 10 ms of a core and a folder with a report of 2 kB (`tests/bench/batch.py`).  Only planish
keeps a journal, has every folder synced to the disk, runs each job under limits of time and memory, and goes on after
a kill; the pools hand jobs out and collect what comes back.  All are warm before they count.
"""

import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from time import perf_counter

from pipeline.batch import journal, told
from pipeline.batch.children import Run, guarded
from pipeline.batch.executor import Local
from pipeline.batch.runner import Stop
from pipeline.batch.work import Work
from tests.bench.batch import CONE, LIMITS, SHORT_S, WORKERS, manifest, run, tell_nothing, ten_ms
from tests.bench.rows import Asked, Extent, Row
from tests.bench.surroundings import ROOT, version

ABOUT = (
    "Overhead: the time of all jobs over their number, less 10 ms over two workers. Every job uses 10 ms of a core and "
    "writes a folder. planish journals and syncs each, under limits of time and memory; the pools do not. Rate: cones "
    "to report and DXF, beside one process for each job, two at a time."
)
JOBS: dict[Extent, int] = {"quick": 40, "usual": 1000, "full": 5000}
REAL: dict[Extent, int] = {"quick": 4, "usual": 200, "full": 1000}
ALONE: dict[Extent, int] = {"quick": 1, "usual": 20, "full": 40}
"""Jobs that are run in a process each."""
WARM = 20
CHUNK = 32
"""Jobs that are sent at once: as many as planish sends at most."""
WHAT = "overhead of a job of 10 ms"
RATE = "cones to report and DXF"


def rows(asked: Asked) -> Iterator[Row]:
    """Yield the overheads, and how fast whole jobs are made."""
    count = JOBS[asked.extent]
    with tempfile.TemporaryDirectory(prefix="planish-bench-") as name:
        folder = Path(name)
        yield overhead("planish batch", version("planish"), count, by_planish(folder / "batch", count))
        for chunk in (1,) if asked.extent == "quick" else (1, CHUNK):
            program = "ProcessPoolExecutor" + (f", {chunk} at a time" if chunk > 1 else "")
            yield overhead(program, sys.version.split()[0], count, by_pool(folder / f"pool-{chunk}", count, chunk))
        if version("distributed") and asked.extent != "quick":
            yield overhead("Dask LocalCluster", version("distributed"), count, by_dask(folder / "dask", count))
        yield rate("planish batch", REAL[asked.extent], by_planish(folder / "whole", REAL[asked.extent], guarded))
        yield rate("planish run, each by itself", ALONE[asked.extent], one_by_one(folder / "one", ALONE[asked.extent]))


def overhead(program: str, found: str, count: int, wall_s: float) -> Row:
    """Return the row of what a job costs beside itself."""
    each_ms = (wall_s / count - SHORT_S / WORKERS) * 1e3
    return Row(WHAT, f"{count} jobs", program, found, each_ms, "ms a job", wall_s, None, f"{WORKERS} workers, one run")


def rate(program: str, count: int, wall_s: float) -> Row:
    """Return the row of how many whole jobs are made in a second."""
    how = f"{WORKERS} workers, one run"
    return Row(RATE, f"{count} jobs", program, version("planish"), count / wall_s, "jobs/s", wall_s, None, how)


def by_planish(folder: Path, count: int, call: Run = ten_ms) -> float:
    """Return the seconds of a batch; one that does not make all its jobs is an error."""
    executor = Local(WORKERS, call)
    (folder / "warm").mkdir(parents=True)
    run(folder / "warm-out", manifest(folder / "warm", WARM), executor, tell_nothing, Stop())
    jobs = manifest(folder, count)
    start = perf_counter()
    run(folder / "out", jobs, executor, tell_nothing, Stop())
    wall = perf_counter() - start
    executor.close(now=False)
    found = told.tally(journal.reading(folder / "out"), 1)
    if not found.all_made:
        raise RuntimeError(f"not made: {found.failed[0]}")
    return wall


def by_pool(folder: Path, count: int, chunk: int) -> float:
    """Return the seconds of a pool of processes."""
    with ProcessPoolExecutor(WORKERS, get_context("forkserver")) as pool:
        list(pool.map(ten_ms, works(folder / "warm", WARM)))
        jobs = works(folder, count)
        start = perf_counter()
        list(pool.map(ten_ms, jobs, chunksize=chunk))
        return perf_counter() - start


def by_dask(folder: Path, count: int) -> float:
    """Return the seconds of Dask's cluster on this machine."""
    from distributed import Client, LocalCluster

    cluster = partial(LocalCluster, n_workers=WORKERS, threads_per_worker=1, dashboard_address=":0")
    with cluster() as workers, Client(workers) as client:
        client.gather(client.map(ten_ms, works(folder / "warm", WARM), pure=False))
        jobs = works(folder, count)
        start = perf_counter()
        client.gather(client.map(ten_ms, jobs, pure=False))
        return perf_counter() - start


def works(folder: Path, count: int) -> list[Work]:
    """Return jobs, each with a folder of its own to be made."""
    folder.mkdir(parents=True, exist_ok=True)
    text = CONE.format(300.0).encode()
    return [
        Work(str(number), "/", None, text, (), (), str(folder / f"job-{number}"), LIMITS) for number in range(count)
    ]


def one_by_one(folder: Path, count: int) -> float:
    """Return the seconds of so many processes of `planish run`, two at a time."""
    folder.mkdir()
    files = [folder / f"job-{number}.json" for number in range(count)]
    for file in files:
        file.write_text(CONE.format(300.0))
    start = perf_counter()
    with ThreadPoolExecutor(WORKERS) as pool:
        list(pool.map(alone, [(str(file), str(file.with_suffix(""))) for file in files]))
    return perf_counter() - start


def alone(names: Sequence[str]) -> None:
    """Run one job in a process."""
    job, out = names
    subprocess.run([sys.executable, "-m", "pipeline", "run", job, "-o", out, "--quiet"], check=True, cwd=ROOT)
