"""The journal of a batch: which jobs there are, where each one lies, what became of it.

SQLite in WAL mode, written by one runner and read by whoever asks.  It holds places and digests, never texts, so that
a million jobs take a few hundred MB.  What is accepted may be lost with the power, as it is accepted again; a result
is on disk before anything depends on it (`durable`).  Not for a file system without shared memory between processes,
such as most network ones: `planish doctor` tells.

.. [1] SQLite, "Write-Ahead Logging", sqlite.org/wal.html.
"""

import sqlite3
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from pipeline.batch import schema
from pipeline.batch.asked import Asked
from pipeline.batch.entries import JOURNAL, Entry, Source
from pipeline.batch.identity import Program
from pipeline.batch.schema import PUBLISHING, STATE_OF, WAITING
from pipeline.batch.work import Limits, Record
from stages.errors import BadInputError, Problem

BESIDE = ("-wal", "-shm")
"""What SQLite calls the files that it keeps beside a journal [1]_."""
CACHE_KB = 16_384
BUSY_MS = 10_000
"""How long a reader may keep a checkpoint waiting."""
NAMES = "surrogateescape"
"""How names of files that are no UTF-8 are told as text: in the journal they are the bytes that they are."""

RETRIED = "planish retry asked for it"


@dataclass(frozen=True, slots=True)
class Place:
    """A job that waits: its row, its id, where its bytes lie, their digest, and how often it has failed by itself."""

    row: int
    name: str
    source: Source
    offset: int
    length: int
    line: int
    content: bytes
    attempts: int


@dataclass(frozen=True, slots=True)
class Finished:
    """A job that ended: its place, what became of it, the name of its draft."""

    place: Place
    record: Record
    draft: str


@dataclass(slots=True)
class Journal:
    """The journal of one output folder, open for the one runner that writes it.

    run: number of this run.  taken: how often an id was asked for that another job of this run has.
    """

    base: sqlite3.Connection
    run: int = 0
    taken: dict[str, int] = field(default_factory=dict)
    sources: dict[Source, int] = field(default_factory=dict)

    def begin(self, by: Program, allow: Sequence[str], limits: Limits, asked: Asked) -> None:
        """Begin a run: the jobs that are taken in from now on are of this one."""
        with self.writing():
            self.base.execute("INSERT OR IGNORE INTO program(code, tables, libraries) VALUES(?, ?, ?)", _row(by))
            same = "SELECT id FROM program WHERE code = ? AND tables = ? AND libraries = ?"
            found = self.base.execute(same, _row(by)).fetchone()
            bounds = as_held("\n".join(allow)), limits.wall_s, limits.memory_bytes
            row = (found[0], *bounds, as_held(asked.command), as_held(asked.folder))
            self.run = self.base.execute(schema.BEGIN, row).lastrowid or 0

    def accept(self, chunk: Sequence[tuple[Source, Entry]]) -> None:
        """Take jobs in: new ones wait, changed ones wait again, others are as they were."""
        rows = [(entry.name, self._source(source), *entry[1:], self.run) for source, entry in chunk]
        with self.writing():
            self.base.execute("SAVEPOINT chunk")
            if self.base.executemany(schema.ACCEPT, rows).rowcount != len(rows):
                self.base.execute("ROLLBACK TO chunk")
                for row in rows:
                    self._accept_one(row)

    def all_taken_in(self) -> None:
        """Write down that no job of this run is missing from the journal."""
        with self.writing():
            self.base.execute("UPDATE run SET whole = 1 WHERE id = ? AND whole = 0", (self.run,))

    def _accept_one(self, row: tuple[object, ...]) -> None:
        """Take a job in; where another one of this run has its id, with a number behind it."""
        name = str(row[0])
        count = self.taken.get(name.casefold(), 1)
        candidate = name if count == 1 else f"{name}-{count}"
        while not self.base.execute(schema.ACCEPT, (candidate, *row[1:])).rowcount:
            count += 1
            candidate = f"{name}-{count}"
            self.taken[name.casefold()] = count

    def _source(self, source: Source) -> int:
        """Return the number of a source; one file of many jobs is looked up once."""
        if source not in self.sources:
            row = source.kind, as_held(source.path), as_held(source.template)
            self.base.execute(schema.SOURCE, row)
            self.sources = {source: self.base.execute(schema.SOURCE_ID, row).fetchone()[0]}
        return self.sources[source]

    def pending(self, after: int, count: int) -> list[Place]:
        """Return the next jobs of this run that wait, in the order in which they were taken in."""
        rows = self.base.execute(schema.PENDING, (after, self.run, count))
        return [
            Place(row, name, Source(kind, path, template), offset, length, line, content, attempts)
            for row, name, kind, path, template, offset, length, line, content, attempts in rows
        ]

    def failed(self, place: Place) -> None:
        """Count a failure of a job that is tried again."""
        with self.writing():
            self.base.execute("UPDATE job SET attempts = attempts + 1 WHERE id = ?", (place.row,))

    def retry(self) -> None:
        """Have all jobs wait that were not made, those that an earlier run left waiting among them."""
        with self.writing():
            self.base.execute("UPDATE run SET whole = NULL WHERE id = ?", (self.run,))
            self.base.execute(schema.RETRY, (self.run, RETRIED))

    def intend(self, group: Sequence[Finished]) -> None:
        """Write down, durably, what became of some jobs and which drafts are to take their places."""
        with self.writing(durable=True):
            self.base.executemany(schema.INTEND, [self._ending(each) for each in group])
            self.base.executemany("DELETE FROM input WHERE job = ?", [(each.place.row,) for each in group])
            files = [(each.place.row, as_held(path), digest) for each in group for path, digest in each.record.inputs]
            self.base.executemany(schema.FILE, [row[1:] for row in files])
            self.base.executemany(schema.NAMES, files)

    def _ending(self, each: Finished) -> tuple[object, ...]:
        record = each.record
        digest = bytes.fromhex(record.digest)
        ended = STATE_OF[record.status], each.draft, record.cause, record.seconds, digest
        return *ended, self.run, each.place.content, each.place.row

    def settle(self) -> None:
        """What was intended is done."""
        with self.writing():
            self.base.execute(schema.SETTLE)

    def unsettled(self) -> list[tuple[int, str, str, str]]:
        """Return row, id, draft and digest of the jobs that were being published when a runner ended."""
        rows = self.base.execute("SELECT id, name, draft, digest FROM job WHERE state = ?", (PUBLISHING,))
        return [(row, name, draft, digest.hex()) for row, name, draft, digest in rows]

    def give_up(self, rows: Iterable[int]) -> None:
        """Have jobs wait whose drafts are not what was intended."""
        with self.writing(durable=True):
            self.base.executemany("UPDATE job SET state = ? WHERE id = ?", [(WAITING, row) for row in rows])

    def waiting(self) -> int:
        """Return how many jobs of this run wait."""
        found = self.base.execute("SELECT count(*) FROM job WHERE state = ? AND seen = ?", (WAITING, self.run))
        return int(found.fetchone()[0])

    @contextmanager
    def writing(self, *, durable: bool = False) -> Iterator[None]:
        """Commit what the block writes, all or nothing; durable: on disk when the block ends."""
        self.base.execute(f"PRAGMA synchronous = {'FULL' if durable else 'NORMAL'}")
        self.base.execute("BEGIN IMMEDIATE")
        try:
            yield
        except BaseException:
            if self.base.in_transaction:
                self.base.execute("ROLLBACK")
            raise
        self.base.execute("COMMIT")


def _row(by: Program) -> tuple[str, str, str]:
    return by.code, by.tables, by.libraries


def as_held(text: str) -> bytes:
    """Return a name of a file as the journal holds it."""
    return text.encode("utf-8", NAMES)


def opened(out: Path) -> Journal:
    """Return the journal of an output folder for its runner, made if there is none."""
    base = _connected(f"{(out / JOURNAL).absolute().as_uri()}?mode=rwc", out)
    try:
        _prepare(base, out)
    except BaseException:
        base.close()
        raise
    return Journal(base)


def _prepare(base: sqlite3.Connection, out: Path) -> None:
    """Make the tables of a new journal, and bring those of an earlier version up to this one."""
    version = version_of(base)
    base.execute("PRAGMA journal_mode = WAL")
    base.execute(f"PRAGMA cache_size = -{CACHE_KB}")
    if version < schema.VERSION:
        base.executescript(f"BEGIN; {schema.TABLES if version == 0 else schema.UPGRADE} COMMIT;")


def reading(out: Path) -> sqlite3.Connection:
    """Return the journal of an output folder for reading; `BadInputError` where there is none, or nothing in it."""
    base = None
    if (out / JOURNAL).is_file():
        base = _connected(f"{(out / JOURNAL).absolute().as_uri()}?mode=ro", out)
    if base is None or version_of(base) == 0:
        hint = "give the folder that planish batch wrote into"
        raise BadInputError(Problem("no batch has run here: there is no journal", hint=hint, file=str(out)))
    return base


def version_of(base: sqlite3.Connection) -> int:
    """Return the version of the tables of a journal; 0 where it has none yet."""
    return int(base.execute("PRAGMA user_version").fetchone()[0])


def _connected(uri: str, out: Path) -> sqlite3.Connection:
    for file in (out / f"{JOURNAL}{ending}" for ending in ("", *BESIDE)):
        if file.is_symlink():
            raise BadInputError(Problem("the journal is a link", hint="remove it", file=str(file)))
    try:
        base = sqlite3.connect(uri, uri=True, isolation_level=None, timeout=BUSY_MS / 1000)
        version = version_of(base)
    except sqlite3.Error as error:
        hint = "planish doctor tells whether this file system can hold a journal"
        raise BadInputError(Problem(f"the journal: {error}", hint=hint, file=str(out / JOURNAL))) from None
    if version > schema.VERSION:
        base.close()
        hint = "go on with the version that began it, or choose another folder with -o"
        raise BadInputError(Problem(f"the journal has tables of version {version}", hint=hint, file=str(out / JOURNAL)))
    base.text_factory = _text
    return base


def _text(stored: bytes) -> str:
    return stored.decode("utf-8", NAMES)
