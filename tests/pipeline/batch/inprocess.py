"""An executor that runs every job in the process of the test: what the runner is tested with."""

import json
import os
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass, field
from pathlib import Path

from pipeline.batch import digest
from pipeline.batch.work import Record, Status, Work


def made(work: Work) -> Record:
    """Make a folder with a report that depends on the job alone."""
    return made_as(work, "made")


def made_as(work: Work, status: Status, inputs: tuple[tuple[str, str], ...] = ()) -> Record:
    """Make a folder with a report of this status."""
    Path(work.draft, "flat").mkdir(parents=True)
    report = {"status": status, "job": work.job, "text": (work.text or b"").decode(), "set": work.settings}
    Path(work.draft, "report.json").write_text(json.dumps(report))
    Path(work.draft, "flat", "part.dxf").write_text(work.job)
    return Record(status, "" if status == "made" else "no", 0.01, inputs, digest.folder(Path(work.draft)), own=True)


@dataclass(slots=True)
class InProcess:
    """Runs a job when it is submitted.  ran: the ids, in order."""

    job: Callable[[Work], Record] = made
    slots: int = 4
    ran: list[str] = field(default_factory=list)

    def submit(self, work: Work) -> "Future[Record]":
        """Run a job and return its record."""
        future: Future[Record] = Future()
        self.ran.append(work.job)
        try:
            future.set_result(self.job(work))
        except Exception as error:
            future.set_exception(error)
        return future

    def close(self, *, now: bool) -> None:
        """Nothing is open."""


def tree(out: Path) -> dict[str, bytes]:
    """Return the files of an output folder but those of the journal and the summary, which tells how long it took."""
    found = {}
    for folder, _, names in os.walk(out):
        for name in names:
            path = Path(folder, name)
            if not path.name.startswith(("journal.sqlite", ".lock", "summary.")):
                found[str(path.relative_to(out))] = path.read_bytes()
    return found
