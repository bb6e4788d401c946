"""What the command line names -> the jobs it stands for, one after the other, none of them parsed.

A job is told by its place: a source (a file), where its bytes begin there and how many they are, and their digest.
A million jobs stream through without a list of them anywhere.  From a folder come its files `*.toml` and `*.jsonl`,
at any depth, in the order of their names, links to folders and names that begin with a dot left out; a job file in
JSON is taken where it is named, or by a glob: what lies in `*.json` beside jobs is as often stock or a layout.
"""

import os
import stat
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from glob import has_magic
from hashlib import sha256
from pathlib import Path
from typing import BinaryIO, Literal, NamedTuple

from pipeline.batch.identity import content
from pipeline.parse import LARGEST_FILE
from pipeline.store import LONGEST_NAME, safe_name
from stages.errors import BadInputError, Problem

Kind = Literal["file", "lines", "table"]

JOB_ENDS = (".toml", ".json")
LINE_ENDS = (".jsonl", ".ndjson")
IN_FOLDERS = (".toml", *LINE_ENDS)
JOURNAL = "journal.sqlite"
"""A folder that holds one is the output of a batch, and none of its files is a job."""
TAKEN = (JOURNAL, "summary.html", "summary.json", "summary.csv")
"""What lies beside the folders of jobs, and is the name of none."""

DIGITS = 7
"""Of the number in a job id: ten million lines of one file stay in order; more have longer numbers."""
MARK = 8
"""Letters of the digest that a name too long ends with: two of them meet once in four thousand million."""


@dataclass(frozen=True, slots=True)
class Source:
    """A file that jobs come from; template: absolute path of the job file that the rows of a table are put into."""

    kind: Kind
    path: str
    template: str = ""


class Entry(NamedTuple):
    """One job: the id it asks for, where its bytes lie, their digest.  line: from 1, 0 for a job file."""

    name: str
    offset: int
    length: int
    line: int
    content: bytes


Tell = Callable[[str], None]
Entries = Iterator[tuple[Source, Entry]]


def silent(_text: str) -> None:
    """Tell no one."""


def entries(paths: Sequence[Path], tell: Tell = silent) -> Entries:
    """Return all jobs that the paths name; `BadInputError` at once for a path that names none.

    tell: is told how many files of a folder might be jobs and are left out.
    """
    found = [_named(path) for path in paths]
    problems = [problem for each in found for problem in each if isinstance(problem, Problem)]
    if problems:
        raise BadInputError(*problems)
    return _stream([each for some in found for each in some if isinstance(each, Path)], tell)


def _named(path: Path) -> "list[Path | Problem]":
    """Return what a path of the command line stands for: itself, or what a glob finds, in order."""
    text = str(path)
    if has_magic(text) and not path.exists():
        matches = sorted(Path(path.anchor or ".").glob(str(path.relative_to(path.anchor))))
        return [*matches] or [Problem("nothing matches", file=text)]
    if not path.exists():
        return [Problem("no such file or folder", file=text)]
    if path.is_dir() or path.suffix.lower() in (*JOB_ENDS, *LINE_ENDS):
        return [path]
    hint = f"jobs lie in files that end in {', '.join((*JOB_ENDS, *LINE_ENDS))}, or in folders of them"
    return [Problem("no job file by its name", hint=hint, file=text)]


def _stream(paths: Iterable[Path], tell: Tell) -> Entries:
    for path in paths:
        if path.is_dir():
            for file, below in _below(path, (), tell):
                yield from _of(file, below)
        else:
            yield from _of(path, (path.name,))


def _below(folder: Path, names: tuple[str, ...], tell: Tell) -> Iterator[tuple[Path, tuple[str, ...]]]:
    """Yield the files of a folder that hold jobs, each with the names that lead to it."""
    with os.scandir(folder) as found:
        inside = sorted((entry.name, entry.is_dir(follow_symlinks=False)) for entry in found)
    if (JOURNAL, False) in inside:
        return
    left = sum(name.lower().endswith(".json") for name, is_folder in inside if not is_folder)
    if left:
        tell(f"{folder}: {left} *.json left out: jobs among them are to be named, or found by a glob")
    for name, is_folder in inside:
        if name.startswith("."):
            continue
        if is_folder:
            yield from _below(folder / name, (*names, name), tell)
        elif name.lower().endswith(IN_FOLDERS):
            yield folder / name, (*names, name)


def _of(file: Path, names: tuple[str, ...]) -> Entries:
    """Yield the jobs of one file."""
    named = job_id("-".join((*names[:-1], Path(names[-1]).stem)))
    if file.suffix.lower() in LINE_ENDS:
        source = Source("lines", str(file.absolute()))
        for entry in lines(file, named):
            yield source, entry
    else:
        yield Source("file", str(file.absolute())), job_file(file, named)


def job_file(file: Path, named: str) -> Entry:
    """Return the place of a job that is a file by itself; of one too large, as far as it is looked at."""
    own = read_some(file) or b""
    return Entry(named, 0, len(own), 0, content(own))


def read_some(file: Path | str) -> bytes | None:
    """Return the bytes of a file as far as a job file may be long, and one more; None where it is no plain file."""
    try:
        handle = os.open(file, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except (OSError, ValueError):
        return None
    with os.fdopen(handle, "rb") as stream:
        return stream.read(LARGEST_FILE + 1) if stat.S_ISREG(os.fstat(handle).st_mode) else None


def lines(file: Path, named: str) -> Iterator[Entry]:
    """Yield the jobs of a JSON Lines file; empty lines are none."""
    offset = 0
    with file.open("rb") as stream:
        for number, (text, size) in enumerate(capped(stream), 1):
            own = text.strip()
            if own:
                start = offset + len(text) - len(text.lstrip())
                yield Entry(f"{named}-{number:0{DIGITS}}", start, len(own), number, sha256(own).digest())
            offset += size


def capped(stream: BinaryIO) -> Iterator[tuple[bytes, int]]:
    """Yield each line as far as a job may be long, and one byte more; and how long the line is."""
    while text := stream.readline(LARGEST_FILE + 1):
        size = len(text)
        while not text.endswith(b"\n") and (more := stream.readline(LARGEST_FILE + 1)):
            size += len(more)
            if more.endswith(b"\n"):
                break
        yield text, size


def job_id(name: str) -> str:
    """Return the id of a job that is called so: a safe name, told apart by a digest where it had to be cut."""
    safe = safe_name(name)
    if safe.casefold().startswith(TAKEN):
        safe = f"_{safe}"
    if len(name) <= LONGEST_NAME:
        return safe
    mark = sha256(name.encode("utf-8", "surrogateescape")).hexdigest()[:MARK]
    return f"{safe[: LONGEST_NAME - MARK - 1].rstrip('.-')}-{mark}"
