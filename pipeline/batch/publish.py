"""Drafts of finished jobs become output folders: all of a group synced, written down, renamed, then committed.

    drafts synced -> journal: what ended and which drafts take which places -> renamed -> folder synced -> committed

A power cut at any point leaves each job either as it was or published; `settle` tells which, by the digest that the
journal holds.  Only names in two opened folders are used, so that a link put into the output tree is replaced, and
nothing is ever read or written through it.
"""

import ctypes
import errno
import os
import shutil
import stat
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from pipeline.batch import digest
from pipeline.batch.journal import Finished, Journal
from pipeline.batch.stale import is_folder

DRAFTS = ".drafts"
FAILURE = "failure.json"
NEW_FOLDER = 0o777
TAKEN = frozenset({errno.EEXIST, errno.ENOTEMPTY, errno.ENOTDIR})
"""What a rename says where something lies that it does not replace."""
FOLDER = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC


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
    """Return an output folder with its drafts, made where they are not there."""
    path.mkdir(parents=True, exist_ok=True)
    out = os.open(path, FOLDER)
    with suppress(FileExistsError):
        os.mkdir(DRAFTS, NEW_FOLDER, dir_fd=out)
    return Tree(path, out, os.open(DRAFTS, FOLDER, dir_fd=out))


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
    for each in group:
        put(tree, each.draft, each.place.name)
    os.fsync(tree.out)
    journal.settle()
    for each in group:
        removed(old(each.draft), tree.drafts)


def put(tree: Tree, draft: str, name: str) -> None:
    """Rename a draft to its place; what lies there is moved among the drafts first, a link as the link it is."""
    try:
        os.rename(draft, name, src_dir_fd=tree.drafts, dst_dir_fd=tree.out)
    except OSError as error:
        if error.errno not in TAKEN:
            raise
        removed(old(draft), tree.drafts)
        os.rename(name, old(draft), src_dir_fd=tree.out, dst_dir_fd=tree.drafts)
        os.rename(draft, name, src_dir_fd=tree.drafts, dst_dir_fd=tree.out)


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
            removed(entry.name, tree.drafts)


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


def removed(name: str, inside: int) -> None:
    """Remove a name from an opened folder with all that is below it; no link is followed."""
    try:
        mode = os.stat(name, dir_fd=inside, follow_symlinks=False).st_mode
    except FileNotFoundError:
        return
    if stat.S_ISDIR(mode):
        shutil.rmtree(name, ignore_errors=True, dir_fd=inside)
    else:
        os.unlink(name, dir_fd=inside)


def own_draft(tree: Tree, name: str, content: bytes) -> str:
    """Make a draft that holds a failure alone, and return its digest."""
    removed(name, tree.drafts)
    os.mkdir(name, NEW_FOLDER, dir_fd=tree.drafts)
    folder = os.open(name, FOLDER, dir_fd=tree.drafts)
    try:
        handle = os.open(FAILURE, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o666, dir_fd=folder)
        with os.fdopen(handle, "wb") as stream:
            stream.write(content)
    finally:
        os.close(folder)
    return digest.folder(tree.path / DRAFTS / name)
