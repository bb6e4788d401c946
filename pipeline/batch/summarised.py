"""The summary of a batch beside its jobs, from its journal and their reports: `summary.html`, `.json` and `.csv`.

Reports are read one after the other, each below the opened output folder and through no link.  One that is not there,
or is none, counts as a job that left none.  Limits: the table holds every job in memory, some 150 bytes each.
"""

import os
import sqlite3
from collections.abc import Iterator
from pathlib import Path

import msgspec

from pipeline import folders
from pipeline.batch.journal import reading
from pipeline.batch.schema import PUBLISHING, STATUS_OF
from pipeline.report.summary import summary_files
from pipeline.report.summaryrows import REPORTED, JobRow, job_row
from pipeline.store import REPORT
from stages.errors import BadInputError, Problem

FEW = 10_000
"""So many jobs are summarised at the end of a batch without being asked for: some seconds."""

ENDED = "SELECT name, state, cause, seconds FROM job WHERE state > ? ORDER BY id"
FILE = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC


def summarise(out: Path) -> list[str]:
    """Write the summary of a batch into its output folder, and return the names of its files; `BadInputError`."""
    base = reading(out)
    try:
        with folders.opened(os.path.realpath(out)) as folder:
            files = summary_files(rows(base, folder))
            for name, content in files.items():
                folders.replace(folder, name, content)
    except OSError as error:
        message = f"the summary cannot be written: {error.strerror or error}"
        raise BadInputError(Problem(message, hint="make room, or the folder writable", file=str(out))) from None
    finally:
        base.close()
    return list(files)


def rows(base: sqlite3.Connection, folder: int) -> Iterator[JobRow]:
    """Yield a row for every job that has ended.  folder: the output folder, opened."""
    for name, state, cause, seconds in base.execute(ENDED, (PUBLISHING,)):
        status = STATUS_OF[state]
        report = _report(folder, name) if status in REPORTED else None
        try:
            yield job_row(name, status, cause, seconds, report)
        except msgspec.MsgspecError:
            yield job_row(name, status, cause, seconds, None)


def _report(folder: int, name: str) -> bytes | None:
    """Return the report of a job, None where there is none."""
    try:
        with folders.opened(name, folder) as inside, os.fdopen(os.open(REPORT, FILE, dir_fd=inside), "rb") as stream:
            return stream.read()
    except OSError:
        return None
