"""What lies in the folder of a job that left nothing itself: the cause, and the command that shows it again."""

import json
import shlex
from collections.abc import Sequence
from pathlib import Path

from pipeline.batch.entries import Source
from pipeline.batch.journal import Place
from pipeline.batch.work import Record

SCHEMA = "planish-failure/1"


def failure(place: Place, record: Record) -> bytes:
    """Return the document of a failure: the same for the same failure of the same job."""
    said = {
        "schema": SCHEMA,
        "job": place.name,
        "status": record.status,
        "cause": record.cause,
        "file": place.source.path,
        "line": place.line or None,
    }
    return (json.dumps(said, indent=1) + "\n").encode()


def place_of(source: Source, line: int) -> str:
    """Return where a job comes from, as messages say it."""
    if source.kind == "table":
        return f"{source.template}, row {line} of {source.path}"
    return f"{source.path}:{line}" if line else source.path


def reproduce(name: str, source: Source, line: int, settings: Sequence[str], allow: Sequence[str]) -> str:
    """Return the commands that run this job alone, with nothing around it that would hide what happens."""
    options = [word for setting in settings for word in ("--set", setting)]
    options += [word for folder in allow for word in ("--allow", folder)]
    if source.kind != "lines":
        return shlex.join(["planish", "run", source.template or source.path, *options])
    alone = str(Path(source.path).with_name(f"{name}.json"))
    taken = f"sed -n {line}p {shlex.quote(source.path)} > {shlex.quote(alone)}"
    return f"{taken} && {shlex.join(['planish', 'run', alone, *options])}"
