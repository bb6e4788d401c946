"""A batch disturbed for long: `python -m tests.bench.soak [kills N] [operations] [full N]`.

`kills`: the runner (7 of 10 times) or one of its workers is killed with SIGKILL at random times, until all of the
jobs are done; `operations`: a runner of 20 jobs is killed at every single one of its operations; `full`: the disk, a
small tmpfs, is full at random sizes.  In the end every output tree has to be as if nothing had happened, no job may
have been lost, published twice, or condemned for what was done to it.
"""

import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from pipeline.batch import children, journal, told
from pipeline.batch.executor import Local
from pipeline.batch.stopped import StoppedError
from pipeline.batch.work import Record, Work
from tests.pipeline.batch.faults import cases, every
from tests.pipeline.batch.inprocess import InProcess, made, tree
from tests.pipeline.batch.runs import go, go_through, lines_file

WORKERS = 2
RUNNER_SHARE = 0.7
"""Of the kills that hit the runner; the others hit a worker."""
BETWEEN_S = (0.0, 0.6)
"""Seconds between two kills, counted from when jobs run: a runner that is up for less would never get on."""
EARLY_SHARE = 0.3
"""Of the kills of a runner: they do not wait for that, and hit one that is about to begin."""
JOBS_A_KILL = 20
JOB_S = 0.1
"""Of one job while there are kills: two workers do about as many between two of them."""
MARGIN = 100
"""Jobs that are to be left for the next runner, or more are appended: what two workers do in 5 s."""
END_S = 3600
SIZES = (60_000, 3_000_000)
"""Bytes of the small disk: from too little for a journal to nearly enough for all."""
LOG = "log"
KILLING = "killing"
"""A file that is there as long as there are kills: jobs take their time."""
TOLD_EVERY = 50
ROOM = 64_000_000


def light(work: Work) -> Record:
    """Take a while for a job that is nothing else, and leave a line in a log that outlives everyone."""
    draft = Path(work.draft)
    folder = draft.parents[2]
    with (folder / LOG).open("a") as log:
        log.write(f"{draft.name.partition('-')[0]} {work.job}\n")
    if (folder / KILLING).exists():
        time.sleep(JOB_S)
    return made(work)


def serve(out: str, jobs: str) -> None:
    """Be the runner that is killed; its children load nothing, as their jobs are none."""
    children.WARM = "tests.bench.cold"
    executor = Local(WORKERS, light)
    go_through(executor, Path(out), Path(jobs))
    executor.close(now=False)


def kills(folder: Path, wanted: int, seed: int = 1) -> int:
    """Kill runner and workers that often, let the batch end, and return how often the runner was killed."""
    jobs, out = lines_file(folder, wanted * JOBS_A_KILL), folder / "out"
    (folder / KILLING).touch()
    began = time.monotonic()
    now, hits = killed(start(out, jobs), folder, wanted, random.Random(seed))
    took = time.monotonic() - began
    (folder / KILLING).unlink()
    if now.wait(END_S):
        raise AssertionError(f"the last runner ended with {now.returncode}")
    go(folder / "undisturbed", jobs)
    count, found = jobs.read_bytes().count(b"\n"), told.tally(journal.reading(out), 20)
    if not found.all_made or found.jobs != count:
        raise AssertionError("\n".join(found.lines()))
    if tree(out) != tree(folder / "undisturbed"):
        raise AssertionError("the trees differ")
    if twice := run_again(out):
        raise AssertionError(f"run again though they were published: {twice}")
    told_so = f"{hits['runner']} runners and {hits['worker']} workers killed in {took:.0f} s over {found.jobs} jobs"
    print(f"{told_so}: none lost, torn, condemned, or run again once it was published", flush=True)
    return hits["runner"]


def killed(
    now: "subprocess.Popen[bytes]", folder: Path, wanted: int, chance: random.Random
) -> "tuple[subprocess.Popen[bytes], Counter[str]]":
    """Kill a runner, those that follow it, and their workers, that often; return the last runner, and who was killed.

    A runner that comes to its end meanwhile is followed by one that has more to do.
    """
    jobs, out, log, hits = folder / "jobs.jsonl", folder / "out", folder / LOG, Counter[str]()
    while hits.total() < wanted:
        victim = "runner" if chance.random() < RUNNER_SHARE else "worker"
        if victim == "worker" or chance.random() > EARLY_SHARE:
            wait_for_jobs(now, log)
        time.sleep(chance.uniform(*BETWEEN_S))
        if victim == "worker" and killed_worker(now, chance):
            hits["worker"] += 1
        else:
            now.kill()
            if now.wait() not in (0, -signal.SIGKILL):
                raise AssertionError(f"a runner ended with {now.returncode}")
            hits["runner"] += now.returncode != 0
            lengthen(jobs, log)
            now = start(out, jobs)
        if hits.total() % TOLD_EVERY == 0:
            print(f"{hits.total()} killed", flush=True)
    return now, hits


def lengthen(jobs: Path, log: Path) -> None:
    """Append jobs where so few are left that they may run out before there is another kill."""
    count = jobs.read_bytes().count(b"\n")
    begun = log.read_bytes().count(b"\n") if log.exists() else 0
    if count - begun < MARGIN:
        with jobs.open("a") as stream:
            stream.writelines(f'{{"number": {number}}}\n' for number in range(count, begun + 2 * MARGIN))


def wait_for_jobs(runner: "subprocess.Popen[bytes]", log: Path) -> None:
    """Wait until more jobs have run, or the runner has ended."""
    before = log.stat().st_size if log.exists() else 0
    while runner.poll() is None and not (log.exists() and log.stat().st_size > before):
        time.sleep(0.01)


def run_again(out: Path) -> list[str]:
    """Return the jobs that ran in a run after the one that published them."""
    published = dict(journal.reading(out).execute("SELECT name, run FROM job"))
    ran = (line.split() for line in (out.parent / LOG).read_text().splitlines())
    return [name for run, name in ran if int(run) > published[name]]


def start(out: Path, jobs: Path) -> "subprocess.Popen[bytes]":
    """Start a runner."""
    return subprocess.Popen([sys.executable, "-W", "ignore", "-m", "tests.bench.soak", "serve", str(out), str(jobs)])


def killed_worker(runner: "subprocess.Popen[bytes]", chance: random.Random) -> bool:
    """Kill one of the children that run jobs for a runner, once it has any; False where it ended before."""
    while runner.poll() is None:
        workers = [pid for server in offspring(runner.pid) for pid in offspring(server)]
        try:
            os.kill(chance.choice(workers), signal.SIGKILL)
        except (IndexError, ProcessLookupError):
            time.sleep(0.01)
        else:
            return True
    return False


def offspring(parent: int) -> list[int]:
    """Return the processes that a process has started."""
    found = []
    for task in Path(f"/proc/{parent}/task").glob("*/children"):
        try:
            found += [int(word) for word in task.read_text().split()]
        except OSError:
            continue
    return found


def operations(folder: Path, step: int = 1) -> None:
    """Kill a runner at every operation of a first run, and of one over older results."""
    for case in cases(folder, 20):
        print(f"killed at {every(step, 1, case.disturbed)} operations in turn: every resume the same")


@contextmanager
def small_disk(folder: Path, size: int) -> Iterator[Path]:
    """Give a disk of that size; PermissionError where none can be mounted."""
    folder.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", f"size={size}", "planish-test", str(folder)]
    if subprocess.run(command, capture_output=True, check=False).returncode:
        raise PermissionError("a tmpfs cannot be mounted here")
    try:
        yield folder
    finally:
        subprocess.run(["umount", str(folder)], check=True)


def full(folder: Path, size: int, count: int = 200) -> bool:
    """Run a batch on a disk of that size; make room; run it again.  Return whether the disk was full."""
    jobs = folder / "in" / "jobs.jsonl"
    if not jobs.exists():
        go(folder / "undisturbed", lines_file(folder / "in", count))
    with small_disk(folder / f"disk-{size}", size) as disk:
        try:
            go(disk / "out", jobs, InProcess(job=on_a_full_disk))
            was_full = False
        except StoppedError:
            was_full = True
        subprocess.run(["mount", "-o", f"remount,size={ROOM}", str(disk)], check=True)
        go(disk / "out", jobs, InProcess(job=on_a_full_disk))
        if tree(disk / "out") != tree(folder / "undisturbed"):
            raise AssertionError(f"the trees differ, disk of {size} bytes")
    return was_full


def on_a_full_disk(work: Work) -> Record:
    """Do a job as the guard does: a disk that takes no files is not its failure."""
    try:
        return made(work)
    except OSError as error:
        return Record("crashed", f"not written: {error.strerror}", 0.0, (), "", own=False)


def main() -> None:
    """Disturb as the command line says."""
    words = sys.argv[1:] or ["kills", "500", "operations", "full", "30"]
    if words[0] == "serve":
        serve(*words[1:])
        return
    if not {"kills", "operations", "full"} & {*words}:
        sys.exit("usage: dev.py soak [kills N] [operations] [full N]")
    folder = Path(tempfile.mkdtemp(prefix="planish-soak-"))
    try:
        if "kills" in words:
            kills(folder, int(words[words.index("kills") + 1]))
        if "operations" in words:
            operations(folder)
        if "full" in words:
            chance = random.Random(1)
            sizes = [chance.randint(*SIZES) for _ in range(int(words[words.index("full") + 1]))]
            print(f"the disk was full {sum(full(folder, size) for size in sizes)} times of {len(sizes)}: nothing torn")
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
