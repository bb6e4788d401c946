"""Lots of drawn job files, run one after the other in a process that stays warm, and ended from outside if it hangs.

A job file that was drawn before is not run again, and counts for nothing.
"""

import os
import shutil
from collections.abc import Callable, Generator
from contextlib import closing, suppress
from dataclasses import dataclass
from hashlib import blake2b
from itertools import count as numbers
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path

from hypothesis import HealthCheck, Phase, given, seed, settings

from tests.fuzz.grammar import Drawn, job_files
from tests.fuzz.rendering import as_toml
from tests.fuzz.seeds import SEEDS
from tests.fuzz.trial import Fault, exit_code, fault_of

LOT = 250
"""Jobs of one seed: a lot can be drawn again by itself."""
COMPUTED_S = 20.0
"""Of the processor for one job: what signals do not end is inside one call of a library."""
WAITED = 12
"""Looks in a row at a child that neither computes nor wants to: it waits for something."""
LOOK_S = 5.0
QUIET = settings(database=None, deadline=None, phases=[Phase.generate], suppress_health_check=list(HealthCheck))


@dataclass(frozen=True, slots=True)
class Find:
    """A job file and what went wrong with it."""

    drawn: Drawn
    fault: Fault


def draw(number: int, count: int, take: Callable[[Drawn], None]) -> None:
    """Hand over the job files of a seed."""

    @seed(number)
    @settings(QUIET, max_examples=count)
    @given(job_files())
    def each(drawn: Drawn) -> None:
        take(drawn)

    each()


def run_one(drawn: Drawn, root: Path) -> Fault | None:
    """Return what goes wrong with a job file in an empty folder; one that is slow is slow each time that it is run."""
    for _ in range(TRIES):
        shutil.rmtree(root, ignore_errors=True)
        root.mkdir(parents=True)
        fault = fault_of(drawn, root)
        if fault is None or fault.sort != "slow":
            break
    return fault


TRIES = 3
"""Seconds of the processor are longer while others use the same core and its caches: the least of some counts."""


def warm(root: Path) -> None:
    """Load what jobs need, and let libraries make the folders that they make once for every user."""
    for name in ("plate", "shell", "sewn", "turns"):
        root.mkdir(parents=True)
        file = root / "job.toml"
        file.write_text(as_toml(SEEDS[name] | {"report": {}}), "utf-8")
        exit_code(file, root)
        shutil.rmtree(root)


def _child(pipe: Connection, root: str, first: int, count: int, seen: bytes) -> None:
    """Run lots until it is ended; tell each job before it is run, and what went wrong after it."""
    silent = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silent, 1)
    os.dup2(silent, 2)
    warm(Path(root) / "root")
    known = {seen[i : i + MARK] for i in range(0, len(seen), MARK)}

    def take(drawn: Drawn) -> None:
        mark = mark_of(drawn)
        if mark not in known:
            known.add(mark)
            pipe.send(drawn)
            pipe.send(run_one(drawn, Path(root) / "root"))

    for number in numbers(first):
        draw(number, count, take)
        pipe.send("lot")


MARK = 8
"""Bytes that tell a job file from all others: two of a million are taken for one less than once in ten million runs."""


def mark_of(drawn: Drawn) -> bytes:
    """Return what tells a job file from others."""
    return blake2b(f"{drawn.name}\n".encode() + drawn.content, digest_size=MARK).digest()


class Looks:
    """What is seen of a child from outside while it is at one job: a busy machine makes it slow, not hang."""

    def __init__(self, pid: int) -> None:
        self.pid, self.waited = pid, 0
        self.start, _ = self._seen()

    def _seen(self) -> tuple[float, bool]:
        """Return the seconds it has computed, and whether it wants to go on."""
        fields = Path(f"/proc/{self.pid}/stat").read_text("utf-8").rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK"), fields[0] in "RD"

    def hangs(self) -> bool:
        """Return whether it has computed too long at one job, or has waited at many looks in a row."""
        computed, wants = self._seen()
        self.waited = 0 if wants else self.waited + 1
        return computed - self.start > COMPUTED_S or self.waited >= WAITED


def run_lots(first: int, root: Path, count: int = LOT) -> Generator[Find | None]:
    """Yield for each job file what went wrong with it, or None, without an end.

    A child that hangs or crashes loses the rest of its lot.
    """
    lot, seen = first, bytearray()
    while True:
        with closing(_one_child(lot, root, count, seen)) as telling:
            for found in telling:
                if isinstance(found, str):
                    lot += 1
                else:
                    yield found
        lot += 1


def _one_child(first: int, root: Path, count: int, seen: bytearray) -> "Generator[Find | str | None]":
    """Yield what one child tells until it ends.  seen: the marks of all job files so far."""
    context = get_context("spawn")
    here, there = context.Pipe()
    process = context.Process(target=_child, args=(there, str(root), first, count, bytes(seen)), daemon=True)
    process.start()
    there.close()
    drawn: Drawn | None = None
    watch = Looks(process.pid or 0)
    try:
        with suppress(EOFError):
            while True:
                if not here.poll(LOOK_S):
                    if watch.hangs():
                        process.kill()
                        break
                    continue
                told = here.recv()
                watch = Looks(process.pid or 0)
                if isinstance(told, Drawn):
                    drawn = told
                    seen += mark_of(drawn)
                    continue
                yield told if told == "lot" else _find(drawn, told)
                drawn = None
        process.join()
    finally:
        process.kill()
        process.join()
    if drawn is None:
        raise SystemExit(f"the child ended with {process.exitcode} outside of a job; lot {first}")
    sort = "hangs" if process.exitcode == -9 else "crash"
    yield Find(drawn, Fault(sort, f"exit {process.exitcode}", sort))


def _find(drawn: Drawn | None, fault: Fault | None) -> Find | None:
    return None if drawn is None or fault is None else Find(drawn, fault)
