"""The processes that run jobs: how they start, what they may do to others, and how their end is told apart.

All are forked from one server process that has loaded what a job needs (`multiprocessing`'s forkserver with `warm`),
so a new one costs some 10 ms.  The server is started by a thread that never ends and dies with it; the children die
with the server.  Each child leads a process group of its own: who kills it kills what it has started.  It dumps no
core, and what it prints goes nowhere.
"""

import os
import queue
import resource
import signal
import sys
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from contextlib import suppress
from ctypes import c_int
from multiprocessing.context import ForkServerContext, ForkServerProcess
from time import monotonic, perf_counter, sleep
from typing import Protocol

from pipeline.batch.work import Record, Work

Run = Callable[[Work], Record]
WARM = "pipeline.batch.warm"
RETIRED = 113
"""The exit code of a child that has run as many jobs as it should; any number that no library ends with will do."""
VANISHED = 256
"""Stands for the exit code 0 of a child that should not have ended; no process has it."""
SERVER_LOST = 255
"""What a child's exit code reads as when the server that knows it is gone."""


def guarded(work: Work) -> Record:
    """Run a job in this process, which is a child."""
    from pipeline.batch import guard

    return guard.run(work)


BUNDLE_S = 0.05
"""Jobs are sent so many at a time as take this long: to send one and to hear of it takes a tenth of a short one."""


def each(call: Run, works: Sequence[Work]) -> list[Record]:
    """Run some jobs in this process, and return the records of those that were run before the time was up.

    Which one is running can be read from outside, also after the end of this process.
    """
    start, records = perf_counter(), list[Record]()
    for work in works:
        _running.value = len(records)
        records.append(call(work))
        if perf_counter() - start > BUNDLE_S:
            break
    return records


def greeting() -> int:
    """Return the number of the server, once this child is ready."""
    return os.getppid()


_running = c_int(0)


def begin(running: c_int) -> None:
    """Make this process, just forked, one that harms no other.  running: shared memory for the number of the job."""
    global _running  # noqa: PLW0603  # what a process is told at its start and every call needs
    _running = running
    harmless()


def harmless() -> None:
    """Make this process one that dies with its server, leads a group of its own, dumps no core and prints nothing."""
    from pipeline.batch import warm

    tame(os.getppid() if os.getpid() == warm.SERVER else warm.SERVER)  # the former: loaded here, late


def tame(parent: int) -> None:
    """Make this process one that dies with its parent, leads a group of its own, dumps no core and prints nothing."""
    from pipeline.orphans import die_with_parent

    os.setpgid(0, 0)
    die_with_parent(parent)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(nowhere, stream)


class Starter:
    """A thread that lives as long as this process, and calls what it is given: what it starts dies with it alone."""

    def __init__(self) -> None:
        self.calls: queue.SimpleQueue[tuple[Callable[[], None], Future[None]]] = queue.SimpleQueue()
        threading.Thread(target=self._serve, name="planish-starter", daemon=True).start()

    def _serve(self) -> None:
        while True:
            call, done = self.calls.get()
            try:
                call()
            except BaseException as error:
                done.set_exception(error)
            else:
                done.set_result(None)

    def call(self, call: Callable[[], None]) -> None:
        """Have the thread make a call, and wait for its end."""
        done: Future[None] = Future()
        self.calls.put((call, done))
        done.result()


class Child(ForkServerProcess):
    """A child whose exit code says whether it ended as it should, and that is killed with what it has started."""

    starter: Starter | None = None
    starting = threading.Lock()

    def start(self) -> None:
        """Start it from the thread that lives as long as this process."""
        with Child.starting:
            if Child.starter is None:
                Child.starter = Starter()
        Child.starter.call(super().start)

    def run(self) -> None:
        """Work until there is to be no more; runs in the child."""
        super().run()
        sys.exit(RETIRED)

    @property
    def exitcode(self) -> int | None:
        """Return 0 for a child that has retired, `VANISHED` for one that called exit(0) in the middle of a job."""
        code = super().exitcode
        return {RETIRED: 0, 0: VANISHED}.get(code, code) if code is not None else None

    def terminate(self) -> None:
        """Kill it: it has nothing to put in order, and SIGTERM may be blocked."""
        self.kill()

    def kill(self) -> None:
        """Kill it and what it has started."""
        if self.pid is not None:
            kill_group(self.pid)
        super().kill()


def kill_group(leader: int) -> None:
    """Kill the process group that a child led, whether it still lives or not."""
    with suppress(OSError):
        os.killpg(leader, signal.SIGKILL)


class Children(ForkServerContext):
    """Where Pebble gets its processes from."""

    Process = Child


def context() -> Children:
    """Return the context that starts warm children."""
    made = Children()
    made.set_forkserver_preload([WARM])
    return made


class Ending(Protocol):
    """What is left to do with a pool."""

    def stop(self) -> None:
        """Have its child killed."""

    def join(self) -> None:
        """Wait for the end."""


def end(pool: Ending | None) -> None:
    """Stop a pool and wait for its end."""
    if pool is not None:
        pool.stop()
        pool.join()


OWN_SIGNALS = frozenset({
    signal.SIGSEGV, signal.SIGABRT, signal.SIGBUS, signal.SIGFPE, signal.SIGILL, signal.SIGSYS, signal.SIGTRAP,
    signal.SIGXCPU, signal.SIGXFSZ, signal.SIGPIPE, signal.SIGALRM, signal.SIGVTALRM, signal.SIGPROF,
})  # fmt: skip
"""What a process brings upon itself; all others come from outside."""


def end_of(exitcode: int, server: int) -> tuple[str, bool]:
    """Return what a child's exit code says in words, and whether that is the job's own doing.

    server: the number of the server that had started it.
    """
    if exitcode == SERVER_LOST and not _lives(server):
        return "the process that starts the children was killed", False
    if exitcode >= 0:
        return f"the process ended by itself, exit code {exitcode % VANISHED}", True
    name = signal.Signals(-exitcode).name if -exitcode in {*signal.Signals} else f"signal {-exitcode}"
    if -exitcode in OWN_SIGNALS:
        return name, True
    return f"killed from outside ({name})", False


def _lives(server: int) -> bool:
    """Return whether the server, a child of this process, still lives; its end may be a little later than its word."""
    end = monotonic() + LATER_S
    while monotonic() < end:
        try:
            if os.waitid(os.P_PID, server, os.WEXITED | os.WNOHANG | os.WNOWAIT) is not None:
                return False
        except OSError:
            return False
        sleep(LATER_S / 10)
    return True


LATER_S = 0.2
"""How long a killed process takes at most from closing its files to being seen as dead."""
