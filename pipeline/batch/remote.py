"""What runs in the workers of a cluster: the same guarded child as on one machine, one for each of their threads.

A worker may join at any time, so what must hold of it is looked at there and with every job: the same planish and
libraries as the runner has, and no daemon, which may not have children.
"""

import multiprocessing
import os
import socket
import threading
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from pipeline.batch.children import Run
from pipeline.batch.identity import Program, program
from pipeline.batch.slot import Ran, Slot
from pipeline.batch.work import Record, Work

_here = threading.local()


@dataclass(frozen=True, slots=True)
class Host:
    """A worker as it sees itself: its program, whether it may start children, what it found of the probe.

    answered: whether it could write beside the probe.
    """

    name: str
    program: Program
    daemon: bool
    found: str
    answered: bool


own_program = cache(program)


def run(call: Run, by: Program, work: Work) -> Record:
    """Run a job in the child of this thread; one that the runner's program would not run so comes back unrun."""
    changes = own_program().changes(by)
    if changes:
        return _unrun(f"another planish than the runner's: {', '.join(changes)}")
    if is_daemon():
        return _unrun("it is a daemon, which may have no children")
    ran: Ran = _slot(call).run((work,))
    return ran.records[0]


def _slot(call: Run) -> Slot:
    """Return the place of this thread, with a new child where the one that is there does something else."""
    slot: Slot | None = getattr(_here, "slot", None)
    if slot is None or slot.call is not call:
        if slot is not None:
            slot.stop()
        slot = _here.slot = Slot(call)
    return slot


def _unrun(why: str) -> Record:
    return Record("crashed", f"worker {_name()}: {why}", 0.0, (), "", own=False)


def look(probe: str) -> Host:
    """Return this worker as it is, after answering a probe: a file that the runner has written where outputs go."""
    path, found, answered = Path(probe), "", False
    with suppress(OSError):
        found = path.read_text("ascii")
        answer = path.with_name(f"{path.name}.{socket.gethostname()}-{os.getpid()}")
        answer.write_text(found, "ascii")
        answered = True
    return Host(_name(), own_program(), is_daemon(), found, answered)


def _name() -> str:
    return f"{socket.gethostname()}:{os.getpid()}"


def is_daemon() -> bool:
    """Return whether this process may not start others."""
    return bool(multiprocessing.current_process().daemon)
