"""The tables of the journal, and the statements that are too long to read in passing.

A job's row holds its place and what became of it; a million of them take some 200 MB.  `state` goes from waiting over
publishing to one of the final states.  `ends` is the final state that a published draft leads to: written before
the draft is renamed, so that a rename without a commit after it can be recognised.
"""

from typing import Final, get_args

from pipeline.batch.work import Status

VERSION = 2
"""Of these tables; a journal of a later version is not touched."""

WAITING, PUBLISHING = 0, 1
STATUSES: Final[tuple[Status, ...]] = get_args(Status)
STATE_OF: dict[Status, int] = {status: number for number, status in enumerate(STATUSES, 2)}
STATUS_OF: dict[int, Status] = {number: status for status, number in STATE_OF.items()}
CONDEMNED = tuple(STATE_OF[status] for status in ("crashed", "timed-out", "out-of-memory"))

OWN_CHANGED = "the job itself has changed"

TABLES = f"""
PRAGMA user_version = {VERSION};
CREATE TABLE program(id INTEGER PRIMARY KEY, code TEXT, tables TEXT, libraries TEXT, UNIQUE(code, tables, libraries));
CREATE TABLE run(id INTEGER PRIMARY KEY, program INTEGER, allow TEXT, wall_s REAL, memory_bytes INTEGER,
                 command TEXT, folder TEXT, whole INTEGER);
CREATE TABLE source(id INTEGER PRIMARY KEY, kind TEXT, path TEXT, template TEXT, UNIQUE(kind, path, template));
CREATE TABLE job(id INTEGER PRIMARY KEY, name TEXT NOT NULL COLLATE NOCASE UNIQUE, source INTEGER, offset INTEGER,
                 length INTEGER, line INTEGER, content BLOB, seen INTEGER, state INTEGER NOT NULL, attempts INTEGER,
                 why TEXT, run INTEGER, ends INTEGER, draft TEXT, cause TEXT, seconds REAL, digest BLOB);
CREATE INDEX job_state ON job(state);
CREATE TABLE file(id INTEGER PRIMARY KEY, path TEXT, sha256 TEXT, UNIQUE(path, sha256));
CREATE TABLE input(job INTEGER, file INTEGER, PRIMARY KEY(job, file)) WITHOUT ROWID;
CREATE INDEX input_file ON input(file);
"""

UPGRADE = f"""
PRAGMA user_version = {VERSION};
ALTER TABLE run ADD COLUMN folder TEXT;
ALTER TABLE run ADD COLUMN whole INTEGER;
"""
"""From version 1, which did not write down where a command was given, nor whether all of its jobs were taken in."""

BEGIN = """
INSERT INTO run(program, allow, wall_s, memory_bytes, command, folder, whole)
VALUES(?, CAST(? AS TEXT), ?, ?, CAST(? AS TEXT), CAST(? AS TEXT), 0)
"""
"""whole: 1 once all jobs that the command names are taken in, NULL for a run that takes none in."""

SOURCE = "INSERT OR IGNORE INTO source(kind, path, template) VALUES(?, CAST(? AS TEXT), CAST(? AS TEXT))"
SOURCE_ID = "SELECT id FROM source WHERE kind = ? AND path = CAST(? AS TEXT) AND template = CAST(? AS TEXT)"

RETRY = f"""
UPDATE job SET state = {WAITING}, attempts = 0, seen = ?, why = CASE WHEN run IS NULL THEN why ELSE ? END
WHERE state <> {STATE_OF["made"]} AND (run IS NULL OR ends > {STATE_OF["made"]})
"""
"""A job that was made and is out of date is left to the batch that it is of."""

UNFINISHED = f"""
SELECT command, folder FROM run WHERE id IN (
    SELECT * FROM (SELECT seen FROM job WHERE state = {WAITING} ORDER BY id LIMIT 1)
    UNION SELECT * FROM (SELECT seen FROM job WHERE state = {WAITING} ORDER BY id DESC LIMIT 1)
    UNION SELECT * FROM (SELECT seen FROM job WHERE state = {PUBLISHING} LIMIT 1)
) OR (whole = 0 AND id = (SELECT max(id) FROM run WHERE whole IS NOT NULL))
GROUP BY command, folder ORDER BY max(id)
"""
"""What was asked for and did not come to its end: the first or the last job that waits is of it, or it is the last
one that takes jobs in and did not take in all of them.  No more are looked at, so that a million are told of at once.
"""

ACCEPT = f"""
INSERT INTO job(name, source, offset, length, line, content, seen, state, attempts)
VALUES(?, ?, ?, ?, ?, ?, ?, {WAITING}, 0)
ON CONFLICT(name) DO UPDATE SET
    source = excluded.source, offset = excluded.offset, length = excluded.length, line = excluded.line,
    state = CASE WHEN content = excluded.content THEN state ELSE {WAITING} END,
    attempts = CASE WHEN content = excluded.content THEN attempts ELSE 0 END,
    why = CASE WHEN content = excluded.content OR run IS NULL THEN why ELSE '{OWN_CHANGED}' END,
    content = excluded.content, seen = excluded.seen
WHERE seen < excluded.seen
"""

PENDING = f"""
SELECT job.id, name, kind, path, template, offset, length, line, content, attempts
FROM job JOIN source ON source.id = job.source
WHERE state = {WAITING} AND job.id > ? AND seen = ? ORDER BY job.id LIMIT ?
"""

INTEND = f"""
UPDATE job SET state = {PUBLISHING}, ends = ?, draft = ?, cause = ?, seconds = ?, digest = ?, run = ?, content = ?
WHERE id = ?
"""

SETTLE = f"UPDATE job SET state = ends, draft = NULL WHERE state = {PUBLISHING}"

AGAIN = f"UPDATE job SET state = {WAITING}, attempts = 0, why = ? WHERE id = ? AND state > {PUBLISHING}"

FILE = "INSERT OR IGNORE INTO file(path, sha256) VALUES(CAST(? AS TEXT), ?)"
NAMES = "INSERT OR IGNORE INTO input(job, file) SELECT ?, id FROM file WHERE path = CAST(? AS TEXT) AND sha256 = ?"
