"""One warm child, and one job after the other in it; a job that takes it down is told from those lost with it.

Pebble's pool of a single process does the work: it kills what takes too long and starts anew what has ended.  Each
child has a pool to itself since those of one pool share locks: one killed at the wrong instant would hold up all.  A
pool whose child was killed from outside is given up for a new one for the same reason.

Pebble measures the wall limit by the clock of the day: one that is set forward by more than the limit ends a job.
"""

import threading
from collections.abc import Sequence
from concurrent.futures import Future
from ctypes import c_int
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

from pebble import ProcessExpired, ProcessPool

from pipeline.batch import children, draft
from pipeline.batch.children import Run
from pipeline.batch.work import Record, Status, Work

RETIREMENT = 1000
"""Messages after which a child is replaced, so that what libraries leak does not add up."""
PATIENCE_S = 600.0
"""Beyond its wall limit, for a child to start on a machine that does much else; then the pool is given up."""


@dataclass(frozen=True, slots=True)
class Ran:
    """The records of some jobs that follow each other, the first of which has that number."""

    first: int
    records: Sequence[Record]


class Slot:
    """A place where one job at a time is run.  run: what the child does with it."""

    def __init__(self, run: Run = children.guarded) -> None:
        self.call = run
        self.context = children.context()
        self.running = self.context.RawValue(c_int, 0)
        self.pool: ProcessPool | None = None
        self.server = 0
        self.pending: Future[list[Record]] | None = None

    def ready(self) -> ProcessPool:
        """Return the pool; a new one, its child on the way, where there is none."""
        if self.pool is None:
            self.pool = ProcessPool(1, RETIREMENT, children.begin, (self.running,), self.context)
            self.pool.schedule(children.greeting).add_done_callback(self._met)
        return self.pool

    def _met(self, greeted: "Future[int]") -> None:
        """Note the number of the server that the child was forked from."""
        if not greeted.cancelled() and greeted.exception() is None:
            self.server = greeted.result()

    def run(self, works: Sequence[Work]) -> Ran:
        """Run some jobs, and return what became of at least one of them; raises nothing.

        Where the child ends that is the one it was at; those before it are to be run once more, as the child told of
        none.  They are short, or they would have come alone.
        """
        start = perf_counter()
        limit = max(work.limits.wall_s for work in works) + (children.BUNDLE_S if len(works) > 1 else 0.0)
        self.running.value = 0
        try:
            self.pending = self.ready().schedule(children.each, (self.call, tuple(works)), timeout=limit)
            return Ran(0, self.pending.result(limit + PATIENCE_S))
        except BaseException as error:
            at = self.running.value % len(works)
            culprit = works[at]
            status, said, own = self._verdict(error, culprit)
        finally:
            self.pending = None
        draft.clear(Path(culprit.draft))
        return Ran(at, [Record(status, said, perf_counter() - start, (), "", own)])

    def _verdict(self, error: BaseException, work: Work) -> tuple[Status, str, bool]:
        """Return what an error of the pool means: status, cause, and whether it is the job's own failure."""
        if isinstance(error, ProcessExpired):
            children.kill_group(error.pid or 0)
            said, own = children.end_of(error.exitcode, self.server)
            if not own:
                self.give_up()
            return "crashed", said, own
        if isinstance(error, TimeoutError) and self.pending is not None and self.pending.done():
            return "timed-out", f"more than {work.limits.wall_s:g} s", True
        self.give_up()
        first = error.__cause__ or error  # Pebble says only that the pool is broken
        return "crashed", f"lost with its pool ({type(first).__name__}: {first})", False

    def interrupt(self) -> None:
        """Have the job that runs, if any, killed; its record says that it was no failure of its own."""
        if self.pending is not None:
            self.pending.cancel()

    def give_up(self) -> None:
        """Leave the pool and its child to their end, which no one waits for; the next job gets new ones."""
        threading.Thread(target=children.end, name="planish-ending", daemon=True, args=(self._taken(),)).start()

    def stop(self) -> None:
        """End the child."""
        children.end(self._taken())

    def _taken(self) -> ProcessPool | None:
        pool, self.pool = self.pool, None
        return pool
