"""The tables of the journal, and the statements that are too long to read in passing.

A job's row holds its place and what became of it; a million of them take some 200 MB.  `state` goes from waiting over
publishing to one of the final states.  `ends` is the final state that a published draft leads to: written before
the draft is renamed, so that a rename without a commit after it can be recognised.
"""

from typing import Final, get_args

from pipeline.batch.work import Status

VERSION = 1
"""Of these tables; a journal of another version is not touched."""

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
                 command TEXT, accepted INTEGER NOT NULL DEFAULT 0);
CREATE TABLE source(id INTEGER PRIMARY KEY, kind TEXT, path TEXT, template TEXT, UNIQUE(kind, path, template));
CREATE TABLE job(id INTEGER PRIMARY KEY, name TEXT NOT NULL COLLATE NOCASE UNIQUE, source INTEGER, offset INTEGER,
                 length INTEGER, line INTEGER, content BLOB, seen INTEGER, state INTEGER NOT NULL, attempts INTEGER,
                 why TEXT, run INTEGER, ends INTEGER, draft TEXT, cause TEXT, seconds REAL, digest BLOB);
CREATE INDEX job_state ON job(state);
CREATE TABLE file(id INTEGER PRIMARY KEY, path TEXT, sha256 TEXT, UNIQUE(path, sha256));
CREATE TABLE input(job INTEGER, file INTEGER, PRIMARY KEY(job, file)) WITHOUT ROWID;
CREATE INDEX input_file ON input(file);
"""

BEGIN = "INSERT INTO run(program, allow, wall_s, memory_bytes, command) VALUES(?, ?, ?, ?, ?)"

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

NAMES = "INSERT OR IGNORE INTO input(job, file) SELECT ?, id FROM file WHERE path = ? AND sha256 = ?"
