"""Reports of finished jobs: read back from their folders, refused where they are broken, and rendered again.

A report is refused that is no JSON, that a newer version wrote, or in which something has not the type that the
formats need; the message names the place.  Values are not judged again.
"""

import json
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

import msgspec

from pipeline import folders
from pipeline.report.entries import entries
from pipeline.report.render import FORMATS, Made, Report, by_format, each
from pipeline.store import POOL_SCHEMA, REPORT, REPORT_SCHEMA
from stages.errors import BadInputError, Problem

VERSION = "1"
"""The version of both schemas that is written, and the only one there has been."""
RUN_AGAIN = "run the job again"
FOLDER = "give the output folder of planish run or planish nest"


class Folder(Mapping[str, bytes]):
    """The files below a folder by their paths there, read when asked for.  A file that cannot be read is not there."""

    def __init__(self, root: Path) -> None:
        self._root = root

    def __getitem__(self, path: str) -> bytes:
        try:
            return (self._root / PurePosixPath(path)).read_bytes()
        except OSError:
            raise KeyError(path) from None

    def __iter__(self) -> Iterator[str]:
        found = (path for path in self._root.rglob("*") if path.is_file())
        return iter(sorted(path.relative_to(self._root).as_posix() for path in found))

    def __len__(self) -> int:
        return sum(1 for _ in self)


@dataclass(frozen=True, slots=True)
class Stored:
    """A report as it was stored: its bytes, and what lies beside it."""

    content: bytes
    made: Made


def stored(out: Path) -> Stored:
    """Return the report of an output folder; `BadInputError` where there is none that can be read."""
    file = out / REPORT
    try:
        content = file.read_bytes()
    except OSError as error:
        raise BadInputError(Problem(f"cannot be read: {error.strerror}", hint=FOLDER, file=str(file))) from None
    report = _decoded(content, file)
    made = Made(report, Folder(out))
    _check_version(report, file)
    try:
        for _, one in each(made):
            entries(one.report)
    except (msgspec.ValidationError, KeyError, TypeError, ValueError) as error:
        raise BadInputError(_broken(error, file)) from None
    return Stored(content, made)


def _decoded(content: bytes, file: Path) -> Report:
    """Return a document that is an object."""
    try:
        report = json.loads(content, parse_constant=_refused)
    except json.JSONDecodeError as error:
        problem = Problem(f"is no JSON: {error.msg}", "", RUN_AGAIN, str(file), error.lineno, error.colno)
        raise BadInputError(problem) from None
    except (ValueError, RecursionError) as error:
        raise BadInputError(Problem(f"is no JSON: {error}", hint=RUN_AGAIN, file=str(file))) from None
    if not isinstance(report, dict):
        raise BadInputError(Problem("is no report: not an object", hint=FOLDER, file=str(file)))
    return report


def _refused(name: str) -> None:
    """Refuse what Python reads as a number and JSON does not have: NaN and the infinities."""
    raise ValueError(f"{name} is no number")


def _check_version(report: Report, file: Path) -> None:
    """Raise `BadInputError` for a document of another sort or of another version."""
    schema = report.get("schema")
    for prefix in (REPORT_SCHEMA, POOL_SCHEMA):
        if isinstance(schema, str) and schema.startswith(prefix):
            if schema.removeprefix(prefix) == VERSION:
                return
            message = f'"{schema}" was written by a newer planish; this one reads {prefix}{VERSION}'
            raise BadInputError(Problem(message, "schema", f"use that version, or {RUN_AGAIN}", str(file)))
    raise BadInputError(Problem("is no report of planish", "schema", FOLDER, str(file)))


def _broken(error: Exception, file: Path) -> Problem:
    """Return what is broken, with its place if that is known."""
    if isinstance(error, msgspec.ValidationError):
        message, _, place = str(error).partition(" - at ")
        return Problem(f"is broken: {message}", place.strip("`").removeprefix("$."), RUN_AGAIN, str(file))
    missing = f"{error} is missing" if isinstance(error, KeyError) else str(error)
    return Problem(f"is broken: {missing}", "", RUN_AGAIN, str(file))


def again(out: Path, also: Sequence[str] = ()) -> tuple[bytes, list[str]]:
    """Write the formats of a report, or the summary of a batch; return it as JSON, and the paths written."""
    from pipeline.batch.entries import JOURNAL

    if not (out / JOURNAL).is_file():
        report, paths = render_again(out, also)
        return report.content, paths
    from pipeline.batch.summarised import summarise

    if also:
        raise BadInputError(Problem("a batch has a summary only", "--format", "give the folder of one of its jobs"))
    paths = summarise(out)
    return (out / "summary.json").read_bytes(), paths


def render_again(out: Path, also: Sequence[str] = ()) -> tuple[Stored, list[str]]:
    """Write the formats of a report that its job asked for, and others; return it and the paths written."""
    report = stored(out)
    found = by_format(report.made, _known(also))
    lacking = [name for name in also if not found.get(name)]
    if lacking:
        hint = f'{RUN_AGAIN} with "{lacking[0]}" in report.formats'
        message = f"{lacking[0]} needs files that the run did not write"
        raise BadInputError(Problem(message, "--format", hint, str(out)))
    files = {path: content for one in found.values() for path, content in one.items()}
    try:
        with folders.opened(os.path.realpath(out)) as folder:
            for path, content in files.items():
                folders.replace(folder, path, content)
    except OSError as error:
        message = f"cannot be written: {error.strerror or error}"
        raise BadInputError(Problem(message, hint="make the folder writable", file=str(out))) from None
    return report, list(files)


def compared(folders: Sequence[Path], also: Sequence[str], *, as_json: bool) -> tuple[str, bool]:
    """Return what changed from one run to another, for people or as JSON, and whether the second is worse."""
    from pipeline.report.comparison import compare, comparison_document
    from pipeline.report.comparisontable import comparison_lines
    from pipeline.report.document import encoded

    if len(folders) != len(("A", "B")):
        raise BadInputError(Problem("more than two folders", hint="planish report A B compares two runs"))
    if also:
        raise BadInputError(Problem("two runs are compared, not rendered", "--format", "give one folder"))
    a, b = (stored(folder).made.report for folder in folders)
    found = compare(a, b)
    lines = "".join(f"{line}\n" for line in comparison_lines(found))
    return encoded(comparison_document(found)).decode() if as_json else lines, found.worse


def _known(names: Iterable[str]) -> list[str]:
    """Return names of formats; `BadInputError` with those that are none."""
    listed = list(names)
    hint = f"one of {', '.join(FORMATS)}"
    wrong = [Problem(f'"{name}" is no format of a report', "--format", hint) for name in listed if name not in FORMATS]
    if wrong:
        raise BadInputError(*wrong)
    return listed
