"""What a batch costs beside its jobs: `python -m tests.bench.batch [overhead] [manifest] [unchanged] [scaling]`.

`million` beside these runs a million jobs to their end; it takes ten minutes, and runs only where it is named.  Each
figure is printed with its limit, and the run ends with 1 if one is above it.  Wall-clock figures mean something
on a machine with nothing else to do; the seconds of the processor beside them tell where it was not.
"""

import argparse
import multiprocessing
import os
import resource
import shutil
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from pipeline.batch import batch, digest, journal, told
from pipeline.batch.entries import entries
from pipeline.batch.executor import Executor, Local
from pipeline.batch.identity import program
from pipeline.batch.publish import synced
from pipeline.batch.runner import Event, Loop, Stop
from pipeline.batch.work import Limits, Record, Work
from tests.bench.batchjobs import REPEATS, mixed, one_file, places

WORKERS = 2
SHORT_S = 0.010
OVERHEAD_JOBS = 2000
MANIFEST_JOBS = 1_000_000
UNCHANGED_JOBS = 10_000
TOLD = 50_000
LIMITS = Limits(60.0, 1 << 31)
PATIENT = Limits(600.0, 1 << 31)
"""For real jobs on a machine that does something else as well."""
CONE = (
    '{{"schema":1,"part":[{{"name":"cone","surface":{{"kind":"cone","radius0":{:.3f},"radius1":125,"height":450,'
    '"sweep":180}}}}],"report":{{"formats":["json"]}}}}\n'
)


last_end = [0.0]
"""Seconds of processor time of this child at the end of its last job."""


def ten_ms(work: Work) -> Record:
    """Use 10 ms of a core and leave a report of 2 kB: what a short job is, with nothing of planish in it.

    The seconds of its record are the processor time since the last job, with what lies between the two.
    """
    before = last_end[0] or time.process_time()
    end = time.process_time() + SHORT_S
    folder = Path(work.draft)
    folder.mkdir()
    (folder / "report.json").write_bytes((work.text or b"").ljust(2000))
    mark = digest.folder(folder)
    while time.process_time() < end:
        pass
    last_end[0] = time.process_time()
    return Record("made", "", last_end[0] - before, (), mark, own=True)


def at_once(work: Work) -> Record:
    """Leave an empty folder."""
    Path(work.draft).mkdir()
    return Record("made", "", 0.0, (), digest.folder(Path(work.draft)), own=True)


def tell_nothing(_loop: Loop, _event: Event | None) -> None:
    """Tell no one."""


def manifest(folder: Path, count: int) -> Path:
    """Write a file of JSON Lines with that many jobs."""
    file = folder / "jobs.jsonl"
    with file.open("w") as stream:
        stream.writelines(CONE.format(300 + number * 0.001) for number in range(count))
    return file


def run(out: Path, jobs: Path, executor: Executor, tell: Callable[[Loop, Event | None], None], stop: Stop) -> Loop:
    """Run a batch, or as much of it as is wanted."""
    with batch.ready(batch.Order(out, LIMITS), program()) as at:
        return batch.run(at, entries([jobs]), executor, stop, tell)


@contextmanager
def timed() -> Iterator[dict[str, float]]:
    """Give the seconds on the wall and of this process's processor time that the block takes."""
    figures: dict[str, float] = {}
    wall, busy = time.perf_counter(), time.process_time()
    yield figures
    figures.update(wall=time.perf_counter() - wall, busy=time.process_time() - busy)


def overhead(folder: Path) -> bool:
    """Measure what a job of 10 ms costs beyond its 10 ms, with everything synced; and a sync by itself."""
    jobs, executor = manifest(folder, OVERHEAD_JOBS), Local(WORKERS, ten_ms)
    warm = manifest(folder / "warm", 20)
    run(folder / "warm-out", warm, executor, tell_nothing, Stop())
    inside: list[float] = []

    def tell(_loop: Loop, event: Event | None) -> None:
        if event is not None:
            inside.append(event.record.seconds - SHORT_S)

    with timed() as took:
        run(folder / "out", jobs, executor, tell, Stop())
    executor.close(now=False)
    each = (took["wall"] / OVERHEAD_JOBS - SHORT_S / WORKERS) * 1e3
    runner, child = took["busy"] / OVERHEAD_JOBS * 1e3, sum(inside) / len(inside) * 1e3
    print(f"processor time a job beside its own: runner {runner:.3f} ms, child {child:.3f} ms")
    print(f"a sync of the disk by itself: {sync_ms(folder):.1f} ms")
    return shown("overhead", each, 1.0, "ms a job")


def sync_ms(folder: Path) -> float:
    """Return how long the disk takes for one small file, the best of ten."""
    handle, times = os.open(folder, os.O_RDONLY), []
    for number in range(10):
        (folder / f"sync-{number}").write_bytes(os.urandom(2000))
        start = time.perf_counter()
        synced(handle)
        times.append(time.perf_counter() - start)
    os.close(handle)
    return min(times) * 1e3


def accepting(folder: Path) -> bool:
    """Measure a manifest of a million jobs: taken in, first result, status, memory, size of the journal."""
    jobs, out = manifest(folder, MANIFEST_JOBS), folder / "out"
    start = time.perf_counter()
    first: list[float] = []
    stop = Stop()

    def tell(loop: Loop, event: Event | None) -> None:
        if event is not None and not first:
            first.append(time.perf_counter() - start)
        if loop.left is not None:
            stop.asked = 1

    executor = Local(WORKERS, ten_ms)
    with timed() as took:
        run(out, jobs, executor, tell, stop)
    executor.close(now=False)
    with timed() as asked:
        found = told.tally(journal.reading(out), 20)
    print(f"taken in {found.jobs}, made meanwhile {found.ended['made']}; processor time {took['busy']:.1f} s")
    figures = (
        ("all taken in", took["wall"], 15.0, "s"),
        ("first result", first[0], 3.0, "s"),
        ("status", asked["wall"], 0.5, "s"),
        ("memory of the runner", largest_mb(), 250.0, "MB"),
        ("journal", journal_mb(out), 400.0, "MB"),
    )
    kept = [shown(*figure) for figure in figures]
    return all(kept)


def unchanged(folder: Path) -> bool:
    """Measure a run that has nothing to do."""
    jobs, executor = manifest(folder, UNCHANGED_JOBS), Local(WORKERS, at_once)
    run(folder / "out", jobs, executor, tell_nothing, Stop())
    with timed() as took:
        loop = run(folder / "out", jobs, executor, tell_nothing, Stop())
    executor.close(now=False)
    print(f"processor time {took['busy']:.2f} s, {loop.drafts} jobs run")
    return shown("unchanged run of 10 000", took["wall"], 2.0, "s") and loop.drafts == 0


def scaling(folder: Path) -> bool:
    """Measure how much faster two workers are than one on the samples, after a run that warms both up."""
    once = list(mixed(folder, 1))
    jobs = list(mixed(folder, REPEATS))
    walls = {}
    for name, workers, taken in (("warm", WORKERS, once), ("one", 1, jobs), ("two", WORKERS, jobs)):
        executor = Local(workers)
        with timed() as took, batch.ready(batch.Order(folder / name, PATIENT), program()) as at:
            batch.run(at, iter(taken), executor, Stop(), tell_nothing)
        executor.close(now=False)
        walls[name] = took["wall"]
        print(f"{name}: {len(taken)} jobs in {took['wall']:.1f} s, {workers} workers", flush=True)
        left = told.tally(journal.reading(folder / name), 20)
        print("\n".join(left.lines()))
    ratio = walls["one"] / walls["two"]
    print(f"two workers are {ratio:.3f} times as fast as one")
    return shown("short of 1.9 times", max(1.9 - ratio, 0.0), 0.0, "times")


def million(folder: Path) -> bool:
    """Run a million jobs to their end that leave a file and do nothing else; what the batch itself takes then."""
    jobs, executor = places(folder, MANIFEST_JOBS), Local(WORKERS, one_file)
    run(folder / "warm-out", places(folder / "warm", 20), executor, tell_nothing, Stop())
    since, ended = time.perf_counter(), [0]

    def tell(_loop: Loop, event: Event | None) -> None:
        if event is not None:
            ended[0] += 1
            if ended[0] % TOLD == 0:
                took = time.perf_counter() - since
                print(
                    f"  {ended[0]} jobs in {took:.0f} s, {ended[0] / took:.0f} jobs/s, {largest_mb():.0f} MB",
                    flush=True,
                )

    with timed() as took:
        run(folder / "out", jobs, executor, tell, Stop())
    executor.close(now=False)
    found = told.tally(journal.reading(folder / "out"), 20)
    print(f"{found.ended['made']} of {found.jobs} made: {MANIFEST_JOBS / took['wall']:.0f} jobs/s")
    print(f"processor time of the runner {took['busy'] / MANIFEST_JOBS * 1e3:.3f} ms a job")
    figures = (
        ("all of it", took["wall"], 720.0, "s"),
        ("memory of the runner", largest_mb(), 250.0, "MB"),
        ("journal", journal_mb(folder / "out"), 400.0, "MB"),
    )
    kept = [shown(*figure) for figure in figures]
    return all(kept) and found.all_made


def largest_mb() -> float:
    """Return the most memory that this process has had."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def journal_mb(out: Path) -> float:
    """Return what a journal takes on disk, with what SQLite keeps beside it."""
    return sum(file.stat().st_size for file in out.glob("journal.sqlite*")) / 1e6


def shown(what: str, value: float, limit: float, unit: str) -> bool:
    """Print a figure with its limit, and return whether it keeps it."""
    print(f"{what}: {value:.3g} {unit}, limit {limit:g}{'' if value <= limit else ' - ABOVE IT'}")
    return value <= limit


BENCHES = {"overhead": overhead, "manifest": accepting, "unchanged": unchanged, "scaling": scaling, "million": million}
UNASKED = ("overhead", "manifest", "unchanged", "scaling")
"""What is run where nothing is named: a million jobs take ten minutes and two million files."""


def alone(name: str) -> None:
    """Run one bench in a folder of its own and end the process with its verdict."""
    folder = Path(tempfile.mkdtemp(prefix="planish-bench-", dir=os.environ.get("TMPDIR")))
    (folder / "warm").mkdir()
    try:
        kept = BENCHES[name](folder)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    sys.exit(0 if kept else 1)


def main() -> None:
    """Run the benches that are named, or all but the longest, each in a process of its own."""
    asks = argparse.ArgumentParser("dev.py bench batch", description=__doc__.partition("\n")[0])
    asks.add_argument("benches", nargs="*", choices=[*BENCHES, []], help="all but million if absent")
    failed = []
    for name in asks.parse_args().benches or UNASKED:
        print(f"\n{name}", flush=True)
        child = multiprocessing.get_context("spawn").Process(target=alone, args=(name,))
        child.start()
        child.join()
        failed += [name] if child.exitcode else []
    sys.exit(f"above the limit: {', '.join(failed)}" if failed else 0)


if __name__ == "__main__":
    main()
