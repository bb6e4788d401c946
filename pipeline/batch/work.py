"""What crosses the border to the process that runs a job, and what comes back.

Plain strings, bytes and numbers alone: both values are pickled on every way, to a child on this machine or to a
worker on another.  No surface, no report and no exception is in them; what a job made lies in its draft folder.
"""

from dataclasses import dataclass
from typing import Literal

from pipeline.plaintext import plain

Status = Literal["made", "rejected", "no-solution", "bad-input", "internal", "crashed", "timed-out", "out-of-memory"]


LONGEST_CAUSE = 500
"""Characters: a cause is one line of a listing; all of it lies in the folder of the job."""


@dataclass(frozen=True, slots=True)
class Limits:
    """What one job may take: seconds on the wall clock, bytes of memory."""

    wall_s: float
    memory_bytes: int


@dataclass(frozen=True, slots=True)
class Work:
    """One job to run.

    `job` is its id, a safe name: that of its folder.  `file` is the absolute path of the job file, of the JSON
    Lines file or of the template; `line` counts from 1 in a JSON Lines file.  `text` is the job's bytes, None
    where the file is read by who runs it.  `settings` are those of a row of a table, as `--set` takes them;
    `allow` the folders that named files may lie in beside that of `file`; `draft` the absolute path of a folder
    that is not there yet, and that who runs the job makes and fills.
    """

    job: str
    file: str
    line: int | None
    text: bytes | None
    settings: tuple[str, ...]
    allow: tuple[str, ...]
    draft: str
    limits: Limits


@dataclass(frozen=True, slots=True)
class Record:
    """What became of a job.

    `cause` is one line: the first problem, the name of a signal, the limit that was passed.  `inputs` are the
    absolute paths and SHA-256 of the files that the job named, its own file left out.  `digest` is that of
    `digest.folder` over what lies in the draft, empty where there is none.  `own` says that the failure is the
    job's: False where the process was killed from outside, a node was lost or the disk was full, which is no
    verdict on the job.
    """

    status: Status
    cause: str
    seconds: float
    inputs: tuple[tuple[str, str], ...]
    digest: str
    own: bool


def one_line(text: str) -> str:
    """Return a text as one line that is not too long, of letters that show: it may hold names of files."""
    line = plain(" ".join(text.split()))
    return line if len(line) <= LONGEST_CAUSE else f"{line[: LONGEST_CAUSE - 3]}..."
