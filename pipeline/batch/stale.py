"""Which jobs of a journal are to be run again before a run begins, and why: nothing is parsed to find out.

A result stands until the program, a file that the job named, or the job itself changes; the last is seen when the job
is taken in again.  A folder that is gone is made again.  A failure that a limit or a folder not allowed was the cause
of is no verdict once these are others.
"""

import os
import stat
from collections.abc import Iterator, Sequence

from pipeline.batch import schema
from pipeline.batch.identity import Program, of_file
from pipeline.batch.journal import Journal, as_held
from pipeline.batch.schema import PUBLISHING, STATE_OF, WAITING
from pipeline.batch.work import Limits

CHUNK = 10_000
ENDED = f"state > {PUBLISHING}"
GONE = "its output folder was gone"


def outdate(journal: Journal, by: Program, allow: Sequence[str], limits: Limits, out: int) -> None:
    """Have all jobs wait whose results stand no longer.  out: the output folder, opened."""
    if not journal.base.execute(f"SELECT 1 FROM job WHERE {ENDED} LIMIT 1").fetchone():
        return
    _programs(journal, by)
    _circumstances(journal, allow, limits)
    _files(journal)
    _folders(journal, out)


def _programs(journal: Journal, by: Program) -> None:
    """Outdate what another program made."""
    for number, *row in journal.base.execute("SELECT id, code, tables, libraries FROM program").fetchall():
        changes = by.changes(Program(*row))
        if changes:
            where = f"{ENDED} AND run IN (SELECT id FROM run WHERE program = ?)"
            _wait(journal, f"{' and '.join(changes)} changed", where, (number,))


def _circumstances(journal: Journal, allow: Sequence[str], limits: Limits) -> None:
    """Outdate failures whose cause may be a folder that was not allowed, or a limit that is higher now."""
    bad, timed, memory = STATE_OF["bad-input"], STATE_OF["timed-out"], STATE_OF["out-of-memory"]
    of_run = "run IN (SELECT id FROM run WHERE {})"
    allowed = f"state = {bad} AND {of_run.format('allow <> CAST(? AS TEXT)')}"
    _wait(journal, "other folders are allowed", allowed, (as_held("\n".join(allow)),))
    _wait(journal, "it may take longer", f"state = {timed} AND {of_run.format('wall_s < ?')}", (limits.wall_s,))
    more = f"state = {memory} AND {of_run.format('memory_bytes < ?')}"
    _wait(journal, "it may take more memory", more, (limits.memory_bytes,))


def _files(journal: Journal) -> None:
    """Outdate what was made from files that are not as they were."""
    with journal.writing():
        journal.base.execute("DELETE FROM file WHERE id NOT IN (SELECT file FROM input)")
    for number, path in list(_changed(journal)):
        where = f"{ENDED} AND id IN (SELECT job FROM input WHERE file = ?)"
        _wait(journal, f"{path} has changed", where, (number,))


def _changed(journal: Journal) -> Iterator[tuple[int, str]]:
    """Yield the named files that are not as they were; each file is read once."""
    last, now = None, ""
    for number, path, before in journal.base.execute("SELECT id, path, sha256 FROM file ORDER BY path"):
        if path != last:
            last, now = path, of_file(path)
        if now != before:
            yield number, path


def _folders(journal: Journal, out: int) -> None:
    """Outdate jobs whose output folder is no folder, or not there."""
    after = 0
    while rows := journal.base.execute(
        f"SELECT id, name FROM job WHERE {ENDED} AND id > ? ORDER BY id LIMIT {CHUNK}", (after,)
    ).fetchall():
        after = rows[-1][0]
        lost = [(GONE, row) for row, name in rows if not is_folder(name, out)]
        if lost:
            with journal.writing():
                journal.base.executemany(schema.AGAIN, lost)


def is_folder(name: str, inside: int) -> bool:
    """Return whether a name in an opened folder is a folder itself, and no link to one."""
    try:
        return stat.S_ISDIR(os.stat(name, dir_fd=inside, follow_symlinks=False).st_mode)
    except OSError:
        return False


def _wait(journal: Journal, why: str, where: str, values: tuple[object, ...]) -> None:
    with journal.writing():
        again = f"UPDATE job SET state = {WAITING}, attempts = 0, why = CAST(? AS TEXT) WHERE {where}"
        journal.base.execute(again, (as_held(why), *values))
