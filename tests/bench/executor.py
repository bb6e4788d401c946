"""What the guarded child costs: `python -m tests.bench.executor [WORKERS]`.

Overhead of a 10 ms job: the processor time that runner and child take beside the job's own, which a busy machine does
not change much, and the wall time of all of it, which it does.  Memory: of a child after its first job, and its share
of it where pages that several hold are divided among them (Pss, proc(5)).
"""

import os
import sys
import tempfile
import time
from pathlib import Path

from pipeline.batch.executor import Local
from pipeline.batch.work import Limits, Record, Work
from pipeline.kinds import template

JOB_S = 0.010
JOBS = 500


def spin(work: Work) -> Record:
    """Take 10 ms of the processor, and tell the time of the processor that this child has taken so far."""
    end = time.process_time() + JOB_S
    while time.process_time() < end:
        pass
    return Record("made", f"{os.getpid()} {time.process_time()}", JOB_S, (), work.draft, own=True)


def asked(file: str, draft: str) -> Work:
    """Return a job."""
    return Work("job", file, None, None, ("stock=[]",), (), draft, Limits(60.0, 1 << 31))


def overhead(workers: int) -> str:
    """Return what the way to the child and back takes."""
    local = Local(workers, spin)
    for future in [local.submit(asked("/", "")) for _ in range(8 * workers)]:
        future.result()
    cpu, wall = time.process_time(), time.perf_counter()
    said = [future.result().cause.split() for future in [local.submit(asked("/", "")) for _ in range(JOBS)]]
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    local.close(now=True)
    times: dict[str, list[float]] = {}
    for pid, seconds in said:
        times.setdefault(pid, []).append(float(seconds))
    child = sum(max(each) - min(each) for each in times.values()) / (len(said) - len(times)) - JOB_S
    took = wall * workers / JOBS - JOB_S
    return (
        f"{1e3 * (cpu / JOBS + child):.2f} ms of the processor beside a job of {1e3 * JOB_S:.0f} ms "
        f"({1e3 * cpu / JOBS:.2f} in the runner), {1e3 * took:.2f} ms on the clock, {workers} workers"
    )


def first(folder: Path) -> str:
    """Return when the first job is made, and what its child holds then."""
    file = folder / "job.toml"
    file.write_text(template("cone"), "utf-8")
    start = time.perf_counter()
    local = Local(1)
    record = local.submit(asked(str(file), str(folder / "draft"))).result()
    took = time.perf_counter() - start
    pool = local.places[0].server
    children = Path(f"/proc/{pool}/task/{pool}/children").read_text().split()
    sizes = [
        f"{name[:-1]} {int(size) / 1024:.0f} MB"
        for child in children
        for name, size, *_ in map(str.split, Path(f"/proc/{child}/smaps_rollup").read_text().splitlines()[1:])
        if name in {"Rss:", "Pss:", "Private_Dirty:"}
    ]
    local.close(now=True)
    return f"first job {record.status} after {took:.1f} s ({record.seconds:.2f} s of it the job); {', '.join(sizes)}"


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as name:
        print(first(Path(name)))
    print(overhead(int(sys.argv[1]) if sys.argv[1:] else 2))
