"""Who runs the jobs: the seam between the runner of a batch and the processes, on this machine or on others."""

import threading
from concurrent.futures import Future
from queue import Empty, SimpleQueue
from typing import Protocol

from pipeline.batch import children
from pipeline.batch.children import BUNDLE_S, Run
from pipeline.batch.slot import Ran, Slot
from pipeline.batch.work import Record, Work


class Executor(Protocol):
    """Runs jobs, some at a time, in the order in which they come."""

    @property
    def slots(self) -> int:
        """Return how many jobs to keep submitted, so that none who could work has to wait."""

    def submit(self, work: Work) -> "Future[Record]":
        """Return what will become of a job; it can be cancelled until it runs."""

    def close(self, *, now: bool) -> None:
        """End all processes: once what is submitted has been run, or now."""


AHEAD = 32
"""Jobs to keep submitted for each child: what it can do while the runner waits for the disk, at 10 ms a job."""

MOST = 32
"""Jobs in a bundle, however short they are."""
LEARNT = 0.5
"""How far the seconds of one more job change what the next are expected to take."""
Asked = tuple[Work, "Future[Record]"]


class Local:
    """Jobs on this machine, in as many warm children as there are workers; they start with the first job."""

    def __init__(self, workers: int, run: Run = children.guarded) -> None:
        self.asked: SimpleQueue[Asked | None] = SimpleQueue()
        self.places = [Slot(run) for _ in range(workers)]
        self.closing = self.begun = False
        self.threads = [
            threading.Thread(target=self._serve, args=(place,), name="planish-slot", daemon=True)
            for place in self.places
        ]

    @property
    def slots(self) -> int:
        """Return how many jobs to keep submitted."""
        return AHEAD * len(self.places)

    def submit(self, work: Work) -> "Future[Record]":
        """Return what will become of a job."""
        future: Future[Record] = Future()
        self.asked.put((work, future))
        for thread in self.threads if not self.begun else ():
            thread.start()
        self.begun = True
        return future

    def _serve(self, place: Slot) -> None:
        """Run one job after the other in a place until there are no more."""
        try:
            place.ready()
        except BaseException:  # the first job meets the same, and its record tells it
            place.stop()
        pace = BUNDLE_S
        while bundle := self._bundle(pace):
            while bundle:
                ran = Ran(0, [STOPPED] * len(bundle)) if self.closing else place.run([work for work, _ in bundle])
                last = ran.first + len(ran.records)
                for (_, future), record in zip(bundle[ran.first : last], ran.records, strict=True):
                    pace += (record.seconds - pace) * LEARNT
                    future.set_result(record)
                del bundle[ran.first : last]
        place.stop()

    def _bundle(self, pace: float) -> list[Asked]:
        """Return as many jobs as are short together, and no more than leave as many to the other children.

        None once there are no more to come; the word that says so is left for the others.
        """
        bundle = list[Asked]()
        while len(bundle) < min(most(pace), 1 + self.asked.qsize() // len(self.places)):
            try:
                asked = self.asked.get(block=not bundle)
            except Empty:
                break
            if asked is None:
                self.asked.put(None)
                break
            if self.closing:
                asked[1].cancel()
            if asked[1].set_running_or_notify_cancel():
                bundle.append(asked)
        return bundle

    def close(self, *, now: bool) -> None:
        """End all children: once what is submitted has been run, or now; what did not run is cancelled then."""
        self.closing = now
        self.asked.put(None)
        for thread in self.threads if self.begun else ():
            while thread.is_alive():
                for place in self.places if now else ():
                    place.interrupt()
                thread.join(POLL_S)


def most(pace: float) -> int:
    """Return how many jobs of so many seconds are sent at a time."""
    return max(1, int(min(MOST, BUNDLE_S / pace))) if pace > 0.0 else MOST


POLL_S = 0.05
"""How often the end of the children is looked at."""
STOPPED = Record("crashed", "all was ended before it was run", 0.0, (), "", own=False)
