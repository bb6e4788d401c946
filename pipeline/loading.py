"""A job from its file, and from a layout, with what was assumed told on the way."""

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pipeline.job import Job

Say = Callable[[str], None]


def load(job: Path, settings: Sequence[str], allow: Sequence[Path], say: Say, *, quiet: bool) -> "Job":
    """Return the job of a file.  allow: folders that the files which it names may lie in, beside its own."""
    from pipeline.job import job_of
    from pipeline.jobfile import Given, read
    from pipeline.reach import silent

    told = say if sys.stderr.isatty() and not quiet else silent
    ready = job_of(read(job, settings, told, Given(allow=tuple(allow))))
    for note in () if quiet else ready.notes:
        say(f"note: {note}")
    if not quiet:
        _tell_layout(ready, say)
    return ready


def laid(job: "Job", layout: Path, say: Say, *, quiet: bool) -> "Job":
    """Return the job placed by a layout file after telling how much of it stays."""
    from pipeline.layouts import with_layout

    ready = with_layout(job, layout)
    if not quiet:
        _tell_layout(ready, say)
    return ready


def _tell_layout(job: "Job", say: Say) -> None:
    """Say how much of a layout stays, if there is one."""
    if job.layout is not None:
        from pipeline.layouts import summary

        say(f"note: {summary(job.layout)}")
