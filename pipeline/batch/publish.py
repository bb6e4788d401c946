"""Drafts of finished jobs become output folders: all of a group synced, written down, renamed, then committed.

    drafts synced -> journal: what ended and which drafts take which places -> renamed -> folder synced -> committed

A power cut at any point leaves each job either as it was or published; `settle` tells which, by the digest that the
journal holds.  Only names in two opened folders are used, so that a link put into the output tree is replaced, and
nothing is ever read or written through it (`folders`).
"""

import ctypes
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from pipeline import folders
from pipeline.batch import digest
from pipeline.batch.draft import made
from pipeline.batch.journal import Finished, Journal
from pipeline.batch.stale import is_folder
from pipeline.batch.stopped import FULL
from stages.errors import BadInputError, Problem

DRAFTS = ".drafts"
FAILURE = "failure.json"


@dataclass(frozen=True, slots=True)
class Tree:
    """An output folder and the folder of its drafts, both opened; path: of the output folder."""

    path: Path
    out: int
    drafts: int

    def draft(self, name: str) -> str:
        """Return the path of a draft, for who makes it."""
        return f"{self.path}/{DRAFTS}/{name}"

    def close(self) -> None:
        """Close both folders."""
        os.close(self.drafts)
        os.close(self.out)


def opened(path: Path) -> Tree:
    """Return an output folder with its drafts, made where they are not there; `BadInputError` where that cannot be."""
    with refusing(path):
        path.mkdir(parents=True, exist_ok=True)
        out = os.open(path, folders.FOLDER)
    try:
        with refusing(path / DRAFTS):
            with suppress(FileExistsError):
                os.mkdir(DRAFTS, folders.NEW_FOLDER, dir_fd=out)
            return Tree(path, out, os.open(DRAFTS, folders.FOLDER, dir_fd=out))
    except BaseException:
        os.close(out)
        raise


@contextmanager
def refusing(path: Path) -> Iterator[None]:
    """Raise `BadInputError` where the block cannot have what it writes to; a full disk is another matter."""
    try:
        yield
    except OSError as error:
        if error.errno in FULL:
            raise
        foreign = path.is_symlink() or (path.exists() and not path.is_dir())
        what = "a link or a file where a folder of the batch belongs" if foreign else error.strerror or str(error)
        hint = "remove it, or choose another folder with -o" if foreign else "choose another folder with -o"
        raise BadInputError(Problem(what, hint=hint, file=str(path))) from None


def synced(folder: int) -> None:
    """Have everything written to the file system of a folder on disk; `OSError` where that fails."""
    library = ctypes.CDLL(None, use_errno=True)
    if not hasattr(library, "syncfs"):
        os.sync()
    elif library.syncfs(folder):
        number = ctypes.get_errno()
        raise OSError(number, os.strerror(number))


def publish(tree: Tree, journal: Journal, group: Sequence[Finished]) -> None:
    """Put the drafts of some finished jobs in their places, in this order and no other."""
    synced(tree.out)
    journal.intend(group)
    replaced = [each.draft for each in group if put(tree, each.draft, each.place.name)]
    os.fsync(tree.out)
    journal.settle()
    for name in replaced:
        folders.remove(old(name), tree.drafts)


def put(tree: Tree, draft: str, name: str) -> bool:
    """Rename a draft to its place, and return whether something lay there, which is now among the drafts."""
    return folders.put(draft, tree.drafts, name, tree.out, old(draft))


def old(draft: str) -> str:
    """Return the name among the drafts of what lay where a draft was put."""
    return f"{draft}.old"


def settle(tree: Tree, journal: Journal) -> None:
    """Bring to its end what a runner had begun to publish, and remove the drafts of jobs that it had not."""
    lost = [row for row, name, draft, wanted in journal.unsettled() if not _stands(tree, name, draft, wanted)]
    os.fsync(tree.out)
    journal.give_up(lost)
    journal.settle()
    with os.scandir(tree.drafts) as left:
        for entry in left:
            folders.remove(entry.name, tree.drafts)


def _stands(tree: Tree, name: str, draft: str, wanted: str) -> bool:
    """Return whether a job's place holds what was intended, after putting its draft there where that is it."""
    if _digest(tree.path / name, name, tree.out) == wanted:
        return True
    if _digest(tree.path / DRAFTS / draft, draft, tree.drafts) != wanted:
        return False
    put(tree, draft, name)
    return True


def _digest(path: Path, name: str, inside: int) -> str | None:
    """Return the digest of a folder, None where there is none or something is in it that no job makes."""
    try:
        return digest.folder(path) if is_folder(name, inside) else None
    except (OSError, ValueError):
        return None


def own_draft(tree: Tree, name: str, content: bytes) -> str:
    """Make a draft that holds a failure alone, and return its digest."""
    return made(name, tree.drafts, {FAILURE: content})
