"""A runner that is killed at one of its operations: SIGKILL just before the n-th call to the disk or the journal.

The calls are counted from outside, in a forked process; nothing in the product knows of it.  What a power cut would
do beyond that, losing what was not synced, is not seen here.
"""

import builtins
import functools
import io
import os
import shutil
import signal
import sqlite3
from collections.abc import Callable
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import ParamSpec, TypeVar

from pipeline.batch import publish, runner
from tests.pipeline.batch.inprocess import tree
from tests.pipeline.batch.runs import go, lines_file

P = ParamSpec("P")
R = TypeVar("R")

CALLS = ("open", "mkdir", "rename", "replace", "unlink", "rmdir", "remove", "fsync", "write", "ftruncate", "pwrite")
KILLED = -signal.SIGKILL


@dataclass(slots=True)
class Count:
    """Counts operations, and kills the process at one of them."""

    deadly: int
    so_far: int = 0

    def one(self) -> None:
        """Count one."""
        self.so_far += 1
        if self.so_far == self.deadly:
            os.kill(os.getpid(), signal.SIGKILL)

    def before(self, call: Callable[P, R]) -> Callable[P, R]:
        """Return a call that is counted before it is made."""

        @functools.wraps(call)
        def counted(*args: P.args, **kw: P.kwargs) -> R:
            self.one()
            return call(*args, **kw)

        return counted


def arm(count: Count) -> None:
    """Count the operations of this process from now on."""
    for name in CALLS:
        setattr(os, name, count.before(getattr(os, name)))
    io.open = builtins.open = count.before(builtins.open)  # type: ignore[assignment]
    shutil.rmtree = count.before(shutil.rmtree)  # type: ignore[assignment]
    publish.synced = count.before(publish.synced)

    class Counted(sqlite3.Connection):
        """A connection whose every statement is counted."""

        execute = count.before(sqlite3.Connection.execute)
        executemany = count.before(sqlite3.Connection.executemany)
        executescript = count.before(sqlite3.Connection.executescript)

    sqlite3.connect = functools.partial(sqlite3.connect, factory=Counted)  # type: ignore[assignment]


def killed_at(number: int, action: Callable[[], object]) -> bool:
    """Do something in a forked process that is killed at one of its operations; return whether it was."""
    child = os.fork()
    if child == 0:
        code = 1
        try:
            runner.GROUP_S = 0.0
            arm(Count(number))
            action()
            code = 0
        finally:
            os._exit(code)
    ended = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    if ended not in (0, KILLED):
        raise AssertionError(f"the runner ended with {ended}, killed at operation {number}")
    return ended == KILLED


def every(step: int, first: int, action: Callable[[int], bool]) -> int:
    """Call with first, first + step, ... until it says that nothing was killed; return how often it was."""
    number, kills = first, 0
    while action(number):
        kills += 1
        number += step
    return kills


def promised(out: Path, jobs: Path) -> set[str]:
    """Return the jobs of a file that a journal says to be done, or to be published."""
    contents = {sha256(line).digest() for line in jobs.read_bytes().splitlines()}
    if not (out / "journal.sqlite").exists():
        return set()
    base = sqlite3.connect(f"file:{out / 'journal.sqlite'}?mode=ro", uri=True)
    try:
        done = base.execute("SELECT name, content FROM job WHERE state > 0")
        return {name for name, content in done if content in contents}
    except sqlite3.OperationalError:
        return set()
    finally:
        base.close()


@dataclass(frozen=True, slots=True)
class Case:
    """A batch to be disturbed: its jobs, where it runs, what lies there before, what is to lie there in the end."""

    jobs: Path
    out: Path
    before: Path | None
    wanted: dict[str, bytes]

    def disturbed(self, *deaths: int) -> bool:
        """Kill one run after the other at these operations, let a last one end; whether the first was killed at all.

        Raises AssertionError where anything is not as if nothing had happened.
        """
        shutil.rmtree(self.out, ignore_errors=True)
        if self.before is not None:
            shutil.copytree(self.before, self.out, symlinks=True)
        killed = [killed_at(number, lambda: go(self.out, self.jobs)) for number in deaths]
        done = promised(self.out, self.jobs)
        ran = go(self.out, self.jobs)
        assert tree(self.out) == self.wanted, f"operations {deaths}"
        assert len(ran) == len(set(ran)), f"operations {deaths}"
        assert not done & set(ran), f"operations {deaths}: run though it was done"
        return killed[0]


def cases(folder: Path, count: int) -> list[Case]:
    """Return a first run, and one over the results of other jobs of the same ids and over a link in their place."""
    older, newer = (lines_file(folder / name, count, first=first) for name, first in (("older", 0), ("newer", 1000)))
    go(folder / "undisturbed", newer)
    go(folder / "before", older)
    shutil.rmtree(folder / "before" / "jobs-0000003")
    (folder / "before" / "jobs-0000003").symlink_to(folder / "older")
    wanted = tree(folder / "undisturbed")
    return [Case(newer, folder / "out", before, wanted) for before in (None, folder / "before")]
