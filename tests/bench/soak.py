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
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from pipeline.batch import journal, told
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
EARLY_SHARE = 0.2
"""Of the kills that do not wait for that, and hit a runner that is about to begin."""
JOBS_A_KILL = 20
JOB_S = 0.04
"""Of one job: 20 of them on two workers take as long as a runner has between two kills."""
END_S = 3600
SIZES = (60_000, 3_000_000)
"""Bytes of the small disk: from too little for a journal to nearly enough for all."""
LOG = "log"
ROOM = 64_000_000


def light(work: Work) -> Record:
    """Take 40 ms for a job that is nothing else, and leave a line in a log that outlives everyone."""
    draft = Path(work.draft)
    with (draft.parents[2] / LOG).open("a") as log:
        log.write(f"{draft.name.partition('-')[0]} {work.job}\n")
    time.sleep(JOB_S)
    return made(work)


def serve(out: str, jobs: str) -> None:
    """Be the runner that is killed."""
    executor = Local(WORKERS, light)
    go_through(executor, Path(out), Path(jobs))
    executor.close(now=False)


def kills(folder: Path, wanted: int, seed: int = 1) -> int:
    """Kill runner and workers that often, let the batch end, and return how often the runner was killed."""
    chance = random.Random(seed)
    jobs, out = lines_file(folder, wanted * JOBS_A_KILL), folder / "out"
    go(folder / "undisturbed", jobs)
    hits = {"runner": 0, "worker": 0}
    now = start(out, jobs)
    while sum(hits.values()) < wanted and now.poll() is None:
        if chance.random() > EARLY_SHARE:
            wait_for_jobs(now, folder / LOG)
        time.sleep(chance.uniform(*BETWEEN_S))
        if chance.random() < RUNNER_SHARE:
            now.kill()
            now.wait()
            hits["runner"] += 1
            now = start(out, jobs)
        else:
            hits["worker"] += killed_worker(now.pid, chance)
    if now.wait(END_S):
        raise AssertionError(f"the last runner ended with {now.returncode}")
    found = told.tally(journal.reading(out), 20)
    if not found.all_made or found.jobs != wanted * JOBS_A_KILL:
        raise AssertionError("\n".join(found.lines()))
    if tree(out) != tree(folder / "undisturbed"):
        raise AssertionError("the trees differ")
    if twice := run_again(out):
        raise AssertionError(f"run again though they were published: {twice}")
    told_so = f"{hits['runner']} runners and {hits['worker']} workers killed over {found.jobs} jobs"
    print(f"{told_so}: none lost, torn, condemned, or run again once it was published")
    return hits["runner"]


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


def killed_worker(runner: int, chance: random.Random) -> bool:
    """Kill one of the children that run jobs for a runner; return whether there was one."""
    children = [pid for server in offspring(runner) for pid in offspring(server)]
    if not children:
        return False
    try:
        os.kill(chance.choice(children), signal.SIGKILL)
    except ProcessLookupError:
        return False
    return True


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
