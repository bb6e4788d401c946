"""The loop of a batch: jobs are taken in, handed out, collected, published; what is done is never done again.

One process, one thread: it reads the jobs in chunks while the first are running already, keeps as many in flight as
the executor asks for, and publishes what ended in groups, as syncing costs the same for one as for many.  A job that
crashes, or passes a limit, is tried three times; then it is put aside with its cause.  A failure that is not the
job's own is not counted: it runs again.
"""

from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Future
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import islice
from queue import Empty, SimpleQueue
from time import monotonic
from typing import TYPE_CHECKING

from pipeline import folders
from pipeline.batch import publish
from pipeline.batch.entries import Entries, Entry, Source
from pipeline.batch.failures import failure
from pipeline.batch.journal import Finished, Journal, Place
from pipeline.batch.places import ChangedError, Places, UnfitError
from pipeline.batch.publish import Tree
from pipeline.batch.schema import CONDEMNED, STATE_OF
from pipeline.batch.stale import is_folder
from pipeline.batch.stopped import SPACE, StoppedError, says_full
from pipeline.batch.work import Record, one_line

if TYPE_CHECKING:
    from pipeline.batch.executor import Executor

OWN_TRIES = 3
"""Failures of a job by itself after which it is put aside: one may be bad luck with memory, three are not."""
MOST_STRAYS = 50
"""Failures in a row that were no job's own: then something is wrong with the machine, and the batch stops."""
FIRST_CHUNK, LARGEST_CHUNK = 256, 8192
"""Jobs taken in at once: few at first, so that the first run soon; many take some 60 ms."""
FETCHED = 512
GROUP_S = 0.25
"""A job that ended waits this long for others to be published with."""
LARGEST_GROUP = 1024
POLL_S = 0.05
"""How long to wait for a job to end in one go: a signal is noticed in between."""

NO_DRAFT = "its draft is not there: does every worker see the output folder?"


@dataclass(slots=True)
class Stop:
    """How often the user has asked for an end."""

    asked: int = 0


@dataclass(frozen=True, slots=True)
class Event:
    """What has happened to a job.  tries: how often it has run; final: whether it will not be run again."""

    job: str
    record: Record
    tries: int
    final: bool


Chunks = Iterator[list[tuple[Source, Entry]]]
Listener = Callable[["Loop", Event | None], None]
"""Is told of each event, and now and then of none, to say how far things are."""


@dataclass(slots=True)
class Loop:
    """One run of a batch.

    flying: the jobs that are run, by their drafts.  again: those that are to be tried again.  group: what ended and
    is not published.  after: the last row handed out.  left: how many jobs wait, known once all are taken in.
    """

    journal: Journal
    tree: Tree
    executor: "Executor"
    places: Places
    stop: Stop
    tell: Listener
    flying: dict[str, tuple[Place, "Future[Record]"]] = field(default_factory=dict)
    again: deque[Place] = field(default_factory=deque)
    fetched: deque[Place] = field(default_factory=deque)
    ended: "SimpleQueue[str]" = field(default_factory=SimpleQueue)
    group: list[Finished] = field(default_factory=list)
    group_since: float = 0.0
    after: int = 0
    drafts: int = 0
    strays: int = 0
    accepted: int = 0
    left: int | None = None

    def run(self, entries: Entries) -> None:
        """Run all jobs until none waits or an end is asked for; `StoppedError` where it cannot go on."""
        chunks = chunked(entries)
        try:
            while self._round(chunks):
                self.tell(self, None)
        except ChangedError as error:
            self._publish()
            raise StoppedError(f"{error} has changed while the batch ran", "run the same command again") from None

    def _round(self, chunks: Chunks) -> bool:
        """Do a bit of everything; return whether there is more; `KeyboardInterrupt` if asked for an end twice."""
        if self.stop.asked:
            self._wind_down()
        else:
            if self.left is None:
                self._accept(chunks)
            self._fill()
        hurried = self.left is None and not self.stop.asked
        self._collect(0.0 if hurried or not self.flying else POLL_S)
        if self.stop.asked > 1:
            raise KeyboardInterrupt
        more = not self.stop.asked and (self.left is None or self._waits())
        if self.group and (not (self.flying or more) or self._due()):
            self._publish()
        return bool(self.flying or more)

    def _accept(self, chunks: Chunks) -> None:
        """Take the next jobs in; once there are no more, count what waits."""
        chunk = next(chunks, None)
        if chunk is None:
            self.journal.all_taken_in()
            self.left = self.journal.waiting() - len(self.group)
        else:
            self.journal.accept(chunk)
            self.accepted += len(chunk)

    def _waits(self) -> bool:
        """Return whether a job waits to be handed out."""
        if not (self.again or self.fetched):
            self.fetched.extend(self.journal.pending(self.after, FETCHED))
            self.after = self.fetched[-1].row if self.fetched else self.after
        return bool(self.again or self.fetched)

    def _fill(self) -> None:
        """Hand jobs out until enough are in flight, or many have ended without it."""
        while len(self.flying) < self.executor.slots and len(self.group) < LARGEST_GROUP and self._waits():
            place = (self.again or self.fetched).popleft()
            self.drafts += 1
            draft = f"{self.journal.run}-{self.drafts}"
            try:
                place, work = self.places.work(place, self.tree.draft(draft))
            except UnfitError as error:
                self._end(error.place, Record("bad-input", one_line(str(error)), 0.0, (), "", own=True), draft)
                continue
            future = self.executor.submit(work)
            self.flying[draft] = place, future
            future.add_done_callback(partial(_landed, self.ended, draft))

    def _wind_down(self) -> None:
        """Call back what is handed out and does not run yet."""
        for _, future in self.flying.values():
            if not future.running():
                future.cancel()

    def _collect(self, wait_s: float) -> None:
        """Take what has ended; wait so long for the first."""
        try:
            draft = self.ended.get(block=wait_s > 0, timeout=wait_s or None)
            while True:
                self._landed(draft, *self.flying.pop(draft))
                draft = self.ended.get(block=False)
        except Empty:
            return

    def _landed(self, draft: str, place: Place, future: "Future[Record]") -> None:
        """Decide what follows from how a job ended: it is finished, tried again, or as if it had not been run."""
        try:
            record = future.result()
        except CancelledError:
            return
        except Exception as error:  # whatever an executor lost a job by, it is not the job's own failure
            record = Record("internal", f"{type(error).__name__}: {error}", 0.0, (), "", own=False)
        if record.digest and not is_folder(draft, self.tree.drafts):
            record = replace(record, own=False, cause=NO_DRAFT)
        record = replace(record, cause=one_line(record.cause))
        if not record.own:
            self._stray(place, record, draft)
            return
        self.strays = 0
        if STATE_OF[record.status] in CONDEMNED and place.attempts + 1 < OWN_TRIES:
            self.journal.failed(place)
            self.again.append(replace(place, attempts=place.attempts + 1))
            folders.remove(draft, self.tree.drafts)
            self.tell(self, Event(place.name, record, place.attempts + 1, final=False))
            return
        self._end(place, record, draft)

    def _stray(self, place: Place, record: Record, draft: str) -> None:
        """Have a job run again whose failure was not its own; `StoppedError` where that is all that happens."""
        self.strays += 1
        folders.remove(draft, self.tree.drafts)
        if says_full(record.cause):
            raise StoppedError(f"{self.tree.path}: {record.cause}", SPACE)
        if self.strays >= MOST_STRAYS:
            raise StoppedError(f"{self.strays} jobs were lost in a row, at last: {record.cause}", "planish doctor")
        self.again.append(place)
        self.tell(self, Event(place.name, record, place.attempts, final=False))

    def _end(self, place: Place, record: Record, draft: str) -> None:
        """Put a job among those to be published; one that left nothing gets a folder that says why."""
        if not record.digest:
            record = replace(record, digest=publish.own_draft(self.tree, draft, failure(place, record)))
        if not self.group:
            self.group_since = monotonic()
        self.group.append(Finished(place, record, draft))
        self.left = None if self.left is None else self.left - 1
        self.tell(self, Event(place.name, record, place.attempts + 1, final=True))

    def _due(self) -> bool:
        return len(self.group) >= LARGEST_GROUP or monotonic() - self.group_since > GROUP_S

    def _publish(self) -> None:
        """Publish what has ended."""
        publish.publish(self.tree, self.journal, self.group)
        self.group.clear()


def _landed(ended: "SimpleQueue[str]", draft: str, _future: "Future[Record]") -> None:
    """Say from whatever thread that a job has ended."""
    ended.put(draft)


def chunked(entries: Entries) -> Chunks:
    """Yield the jobs in chunks, each twice as large as the one before."""
    size = FIRST_CHUNK
    while chunk := list(islice(entries, size)):
        yield chunk
        size = min(2 * size, LARGEST_CHUNK)
