"""A batch with poisonous jobs among good ones, through all of the runner, and what has to have become of each job."""

import json
from collections import Counter
from concurrent.futures import Future
from dataclasses import dataclass, replace
from pathlib import Path

from pipeline.batch import journal, told
from pipeline.batch.executor import Executor
from pipeline.batch.schema import CONDEMNED, STATE_OF
from pipeline.batch.work import Limits, Record, Work
from tests.pipeline.batch.inprocess import tree
from tests.pipeline.batch.poison import ENDLESS, ENDS, GOOD, KILLED_ONCE, MEMORY, WALL_S, poisoned

BAD = ("segfault", "abort", "hog", "loop", "exit 3", "stopped", "recursion", "freed twice", "SystemExit", "exit 0")
EACH = 10
"""One bad job among so many."""
COUNT = EACH * len(BAD)
ORDER = Limits(60.0, MEMORY)
LONG_S = 60.0
"""What each job says it has taken: long ones are sent to a child alone, and may have a limit of their own."""


def kinds() -> list[str]:
    """Return what each job does, in their order."""
    found = [BAD[number // EACH] if number % EACH == 3 else GOOD for number in range(COUNT)]
    found[5] = KILLED_ONCE
    return found


def jobs_file(folder: Path) -> Path:
    """Write the jobs."""
    folder.mkdir(exist_ok=True)
    file = folder / "jobs.jsonl"
    file.write_text("".join(json.dumps({"kind": kind}) + "\n" for kind in kinds()))
    return file


def kind_of(work: Work) -> str:
    """Return what a job does."""
    return str(json.loads(work.text or b"")["kind"])


def by_text(work: Work) -> Record:
    """Do what the text of a job says."""
    return replace(poisoned(replace(work, settings=(kind_of(work),))), seconds=LONG_S)


@dataclass(slots=True)
class Hurried:
    """An executor that gives little time to jobs that never end; others have what a busy machine needs."""

    executor: Executor

    @property
    def slots(self) -> int:
        """Return how many jobs to keep submitted."""
        return self.executor.slots

    def submit(self, work: Work) -> "Future[Record]":
        """Return what will become of a job."""
        if kind_of(work) in ENDLESS:
            work = replace(work, limits=Limits(WALL_S, MEMORY))
        return self.executor.submit(work)

    def close(self, *, now: bool) -> None:
        """End all processes."""
        self.executor.close(now=now)


def check(jobs: Path, out: Path) -> None:
    """Hold what became of every job against what it did; AssertionError where that is something else."""
    base = journal.reading(out)
    rows = {name: row for name, *row in base.execute("SELECT name, line, state, cause, attempts FROM job")}
    assert len(rows) == COUNT
    files = tree(out)
    for name, (line, state, cause, attempts) in rows.items():
        kind = kinds()[line - 1]
        if kind in {GOOD, KILLED_ONCE}:
            assert (state, attempts) == (STATE_OF["made"], 0), f"{name}, {kind}: {cause}"
            assert files[f"{name}/report.json"] == name.encode()
            continue
        status, said, own = ENDS[kind]
        assert own
        assert state == STATE_OF[status], f"{name}, {kind}: {cause}"
        assert cause.startswith(said.strip()), f"{name}, {kind}"
        assert f"{name}/report.json" not in files
        _check_told(told.explain(journal.reading(out), name, out), jobs, line)
        if state in CONDEMNED:
            assert json.loads(files[f"{name}/failure.json"])["cause"] == cause
            assert attempts == 2, f"{name}, {kind}: two failures before the last"
    base.close()
    _check_counts(out)


def _check_told(lines: list[str], jobs: Path, line: int) -> None:
    """Hold what is told of a bad job against what has to be: whence it comes, its cause, how to run it by itself."""
    assert lines[0].endswith(f"{jobs}:{line}")
    assert f"sed -n {line}p {jobs} > " in lines[-1]
    assert f"planish run {jobs.parent}/jobs-{line:07}.json" in lines[-1]
    assert " ran in run 1, as it had not run before" in "\n".join(lines)


def _check_counts(out: Path) -> None:
    found = told.tally(journal.reading(out), COUNT)
    wanted = Counter(ENDS[kind][0] if kind in BAD else "made" for kind in kinds())
    assert {status: count for status, count in found.ended.items() if count} == wanted
    assert found.waiting == 0
    summary = json.loads((out / "summary.json").read_bytes())
    assert summary["jobs"] == COUNT, sorted(summary)
