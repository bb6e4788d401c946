"""What a journal says when it is asked: how far a batch is, and why a job is as it is."""

import sqlite3
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from pipeline.batch import identity, schema
from pipeline.batch.asked import Asked
from pipeline.batch.entries import Source
from pipeline.batch.failures import place_of, reproduce
from pipeline.batch.identity import Program
from pipeline.batch.journal import as_held, reading, version_of
from pipeline.batch.lock import holder
from pipeline.batch.places import settings_at
from pipeline.batch.schema import CONDEMNED, PUBLISHING, STATE_OF, STATUS_OF, STATUSES, WAITING
from pipeline.batch.work import Limits
from stages.errors import BadInputError, Problem

SCHEMA = "planish-batch/1"
LISTED = 20
"""Failed jobs that are named in a listing for people; a document names a thousand."""
LISTED_IN_DOCUMENT = 1000
MADE = STATE_OF["made"]


@dataclass(frozen=True, slots=True)
class Tally:
    """How many jobs of a journal there are in each state.  failed: some that were not made, with status and cause."""

    jobs: int
    waiting: int
    ended: Mapping[str, int]
    failed: tuple[tuple[str, str, str], ...]

    @property
    def all_made(self) -> bool:
        """Whether there is no job that was not made."""
        return self.jobs == self.ended["made"]

    def document(self) -> dict[str, object]:
        """Return it for machines."""
        rows = [dict(zip(("job", "status", "cause"), row, strict=True)) for row in self.failed]
        return {"schema": SCHEMA, "jobs": self.jobs, "waiting": self.waiting, **self.ended, "failed": rows}

    def lines(self) -> list[str]:
        """Return it for people."""
        several = "s" if self.jobs != 1 else ""
        counts = ", ".join(f"{count} {status}" for status, count in self.ended.items() if count)
        head = f"{self.jobs} job{several}: {', '.join(filter(None, (counts, f'{self.waiting} waiting')))}"
        more = sum(self.ended.values()) - self.ended["made"] - len(self.failed)
        rest = [f"  and {more} more that were not made"] if more > 0 else []
        return [head, *(f"  {job}: {status}: {cause}" for job, status, cause in self.failed), *rest]


def tally(base: sqlite3.Connection, listed: int) -> Tally:
    """Return how far a batch is."""
    counts = base.execute("SELECT state, count(*) FROM job GROUP BY state").fetchall()
    some = "SELECT name, state, cause FROM job WHERE state > ? ORDER BY state, id LIMIT ?"
    failed = base.execute(some, (MADE, listed))
    return _tally(counts, failed)


def tally_of_run(base: sqlite3.Connection, run: int) -> Tally:
    """Return how many of the jobs that a run was asked for are in which state, those it found done among them."""
    counts = base.execute("SELECT state, count(*) FROM job WHERE seen = ? GROUP BY state", (run,)).fetchall()
    some = "SELECT name, state, cause FROM job WHERE state > ? AND seen = ? ORDER BY state, id LIMIT ?"
    return _tally(counts, base.execute(some, (MADE, run, LISTED)))


def _tally(found: Iterable[tuple[int, int]], failed: Iterable[tuple[str, int, str]]) -> Tally:
    counts = dict(found)
    waiting = counts.get(WAITING, 0) + counts.get(PUBLISHING, 0)
    ended: dict[str, int] = {status: counts.get(STATE_OF[status], 0) for status in STATUSES}
    named = tuple((name, STATUS_OF[state], cause) for name, state, cause in failed)
    return Tally(sum(counts.values()), waiting, ended, named)


def unfinished(base: sqlite3.Connection) -> list[Asked]:
    """Return what was asked for and is not at its end; a journal of version 1 does not tell."""
    if version_of(base) < schema.VERSION:
        return []
    return [Asked(command, folder or "") for command, folder in base.execute(schema.UNFINISHED) if command]


def onward(base: sqlite3.Connection, out: Path) -> dict[str, object]:
    """Return who is at work on a batch, and how to go on with what no one is at work on."""
    who = holder(out)
    return {"at_work": who, "go_on": [] if who else [asked.line() for asked in unfinished(base)]}


def onward_lines(base: sqlite3.Connection, out: Path) -> list[str]:
    """Return the same for people."""
    who = holder(out)
    return [f"at work: {who}"] if who else [f"go on with: {asked.line()}" for asked in unfinished(base)]


def last_run(out: Path) -> tuple[Limits, tuple[str, ...]]:
    """Return the limits of the last run, and the folders that it allowed."""
    row = reading(out).execute("SELECT wall_s, memory_bytes, allow FROM run ORDER BY id DESC LIMIT 1").fetchone()
    if row is None:
        raise BadInputError(Problem("no batch has run here", hint="planish batch begins one", file=str(out)))
    return Limits(row[0], row[1]), _allowed(row[2])


def _allowed(text: str) -> tuple[str, ...]:
    """Return the folders that the journal has one a line."""
    return tuple(filter(None, text.split("\n")))


JOB = """
SELECT job.id AS id, name, kind, path, template, offset, length, line, content, state, attempts, why, cause, seconds,
       job.run AS run, command, allow, wall_s, memory_bytes, code, tables, libraries
FROM job JOIN source ON source.id = job.source LEFT JOIN run ON run.id = job.run
LEFT JOIN program ON program.id = run.program WHERE name = CAST(? AS TEXT)
"""


def explain(base: sqlite3.Connection, name: str, out: Path) -> list[str]:
    """Return what is known of a job, why it ran, and how to run it alone; `BadInputError` where there is none."""
    base.row_factory = sqlite3.Row
    row = base.execute(JOB, (as_held(name),)).fetchone()
    if row is None:
        hint = f"the ids are the names of the folders in {out}"
        raise BadInputError(Problem(f'there is no job "{name}"', hint=hint, file=str(out)))
    source = Source(row["kind"], row["path"], row["template"])
    told = [f"{row['name']}: {place_of(source, row['line'])}", f"  {_state(row)}"]
    if row["run"] is not None:
        told += [f"  {line}" for line in _result(base, row)]
    settings = settings_at(source, row["offset"], row["length"])
    allow = _allowed(row["allow"] or "")
    return [*told, f"  by itself: {reproduce(row['name'], source, row['line'], settings, allow)}"]


def _state(row: sqlite3.Row) -> str:
    """Return how a job is."""
    if row["state"] <= PUBLISHING:
        again = f", to run again as {row['why']}" if row["why"] else ""
        return f"waiting{again}"
    cause = f": {row['cause']}" if row["cause"] else ""
    tries = f", put aside after {row['attempts'] + 1} failures" if row["state"] in CONDEMNED else ""
    return f"{STATUS_OF[row['state']]}{cause}{tries} ({row['seconds']:.3g} s)"


def _result(base: sqlite3.Connection, row: sqlite3.Row) -> list[str]:
    """Return why a job ran the last time, and what its result depends on."""
    by = Program(row["code"], row["tables"], row["libraries"])
    named = base.execute(
        "SELECT path, sha256 FROM input JOIN file ON file.id = input.file WHERE job = ? ORDER BY path", (row["id"],)
    ).fetchall()
    why = row["why"] if row["state"] > PUBLISHING else None
    ran = f"ran in run {row['run']}{f': {why}' if why else ', as it had not run before'}"
    files = [f"{path} sha256 {digest or 'none: it was not there'}" for path, digest in named]
    changed = [f"{path} has changed since" for path, digest in named if identity.of_file(path) != digest]
    programs = [f"{what} changed since" for what in identity.program().changes(by)]
    key = identity.key(row["content"], [tuple(each) for each in named], by)
    return [ran, f"key {key}", f"own sha256 {row['content'].hex()}", *files, *changed, *programs]
