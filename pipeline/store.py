"""Files that are there as a whole or not at all: safe names, digests, and an output folder replaced in one go.

A new output folder grows beside the old one, is flushed to disk, and takes its place by renaming; the old one is
removed last.  Between the two renames there is an instant without an output folder: no single call of the standard
library exchanges two folders.  A folder that planish did not write is never replaced.
"""

import json
import os
import re
import unicodedata
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from pipeline import folders
from stages.errors import BadInputError, Problem

REPORT = "report.json"
REPORT_SCHEMA = "planish-report/"
POOL_SCHEMA = "planish-pool/"
OURS = frozenset({
    REPORT, "cut", "flat", "pieces", "preview", "layout.json", "remnant.json", "remnants", "report.html",
    "traveller.pdf", "results.csv", "junit.xml", "report", "view.json",
})  # fmt: skip
"""What an output folder may hold at its top."""
HARMLESS = frozenset({".DS_Store", "Thumbs.db", "desktop.ini"})
"""What file managers leave behind without being asked."""

LONGEST_NAME = 60
RESERVED = frozenset({"con", "prn", "aux", "nul", *(f"{port}{i}" for port in ("com", "lpt") for i in range(1, 10))})
"""Names that Windows gives to devices."""


def digest(content: bytes) -> str:
    """Return the sha256 of some bytes, in hexadecimal."""
    return sha256(content).hexdigest()


def safe_name(name: str) -> str:
    """Return a file name of letters, digits, dot, dash and underscore that every system takes."""
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
    plain = re.sub(r"[^A-Za-z0-9._-]+", "-", plain).strip(".-")[:LONGEST_NAME].rstrip(".-")
    if not plain:
        return "unnamed"
    return f"_{plain}" if plain.split(".")[0].casefold() in RESERVED else plain


def safe_names(names: Iterable[str]) -> dict[str, str]:
    """Return a file name for each name, no two the same even where upper and lower case are."""
    taken: set[str] = set()
    chosen: dict[str, str] = {}
    for name in names:
        base = candidate = safe_name(name)
        count = 1
        while candidate.casefold() in taken:
            count += 1
            candidate = f"{base}-{count}"
        taken.add(candidate.casefold())
        chosen[name] = candidate
    return chosen


def refuse_foreign(out: Path, keep: Iterable[Path] = ()) -> None:
    """Raise `BadInputError` if `out` is not free and not an output folder of planish, or holds a file to keep."""
    hint = "choose another folder with -o"
    inside = next((path for path in (*keep, Path.cwd()) if out in (path, *path.parents)), None)
    if inside is not None:
        raise BadInputError(Problem(f"the output folder would replace {inside}", hint=hint, file=str(out)))
    if not out.exists():
        return
    if not out.is_dir():
        raise BadInputError(Problem("the output folder is a file", hint=hint, file=str(out)))
    entries = {entry.name for entry in out.iterdir()} - HARMLESS
    ours = _written(out / REPORT)
    strangers = sorted(entries - (OURS if ours is None else ours))
    if entries and (strangers or ours is None):
        what = f"holds {strangers[0]}, which planish did not write" if strangers else "is no output folder of planish"
        raise BadInputError(Problem(what, hint=f"it would be lost; {hint}", file=str(out)))


def _written(file: Path) -> frozenset[str] | None:
    """Return what may lie beside a report of planish, the folders of its groups included; None: it is none."""
    try:
        content = json.loads(file.read_bytes())
    except (OSError, ValueError, RecursionError):
        return None
    schema = str(content.get("schema")) if isinstance(content, dict) else ""
    if schema.startswith(REPORT_SCHEMA):
        return OURS
    groups = content.get("groups") if schema.startswith(POOL_SCHEMA) else None
    if not isinstance(groups, list):
        return None
    return frozenset({REPORT, *(str(group.get("name")) for group in groups if isinstance(group, dict))})


@dataclass(frozen=True, slots=True)
class Draft:
    """A new output folder while it grows: what it becomes, its name, the handles of the folder it lies in and of it."""

    target: Path
    name: str
    parent: int
    handle: int


@contextmanager
def replacement(out: Path, keep: Iterable[Path] = ()) -> Iterator[Draft]:
    """Give an empty folder that becomes `out` if the block ends well, and vanishes if it does not.

    keep: files that must not be replaced, such as the job file.  Raises `BadInputError` if `out` cannot be written,
    before the block begins.  Where `out` leads is looked up once: what becomes of the links on the way while the block
    runs changes nothing.
    """
    target = Path(os.path.realpath(out))
    made: list[Path] = []
    with ExitStack() as stack:
        try:
            refuse_foreign(target, [Path(os.path.realpath(path)) for path in keep])
            made = [folder for folder in target.parents if not folder.exists()]
            target.parent.mkdir(parents=True, exist_ok=True)
            draft = stack.enter_context(_drafted(target))
        except OSError as error:
            _remove_empty(made)
            raise _unwritable(out, error) from None
        try:
            yield draft
            _swap(draft, out)
        except BaseException:
            stack.close()
            _remove_empty(made)
            raise


@contextmanager
def _drafted(target: Path) -> Iterator[Draft]:
    """Give a new folder beside a target; what is left of it in the end goes."""
    name = folders.unlikely(target.name, ".part")
    with folders.opened(target.parent) as parent, folders.grown(name, parent) as handle:
        yield Draft(target, name, parent, handle)


def _unwritable(out: Path, error: OSError) -> BadInputError:
    reason = error.strerror or str(error)
    message = f"the output folder cannot be written: {reason}"
    return BadInputError(Problem(message, hint="choose another with -o", file=str(out)))


def _remove_empty(folders: Iterable[Path]) -> None:
    """Remove the folders made on the way, innermost first, as far as they are empty."""
    for folder in folders:
        with suppress(OSError):
            folder.rmdir()


def _swap(draft: Draft, out: Path) -> None:
    """Put the draft in the place of its target; on failure the old one is back."""
    name, old, parent = draft.target.name, folders.unlikely(draft.target.name, ".old"), draft.parent
    try:
        folders.sync(draft.handle)
        folders.put(draft.name, parent, name, parent, old)
    except OSError as error:
        raise _unwritable(out, error) from None
    folders.remove(old, parent)
    if not folders.is_same(draft.handle, name, parent):
        folders.remove_link(name, parent)
        message = "another program changed the output folder while it was written"
        raise BadInputError(Problem(message, hint="run again, or choose another with -o", file=str(out)))


def write_files(folder: Draft | Path, files: Mapping[str, bytes]) -> None:
    """Write new files below a folder; `BadInputError` if the disk does not take them."""
    try:
        if isinstance(folder, Draft):
            _write_all(folder.handle, files)
            return
        folder.mkdir(parents=True, exist_ok=True)
        with folders.opened(folder) as handle:
            _write_all(handle, files)
    except OSError as error:
        raise _unwritable(folder.target if isinstance(folder, Draft) else folder, error) from None


def _write_all(folder: int, files: Mapping[str, bytes]) -> None:
    for path, content in files.items():
        folders.write(folder, path, content)
