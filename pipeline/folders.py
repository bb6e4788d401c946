"""Folders by their handles: what is written, renamed and removed below one stays below it.

A path is looked up anew at every call, and whoever may write to a folder on the way can make it lead elsewhere between
two calls.  Here a folder is opened once and all else is named relative to it, step by step, no link followed; a file
is always made new.  A step that has become a link, or a file that is there already, is an `OSError`.
"""

import errno
import os
import shutil
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path, PurePosixPath
from typing import BinaryIO

FOLDER = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC
NEW = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC
NEW_FOLDER, NEW_FILE = 0o777, 0o666
"""What the user's mask leaves of these is what everyone may do: as of any folder and file."""
UNLIKELY = 8
"""Random bytes that make a name no other has."""
TAKEN = frozenset({errno.EEXIST, errno.ENOTEMPTY, errno.ENOTDIR})
"""What the renaming of a folder says where something lies that it does not replace."""


@contextmanager
def opened(name: str | Path, parent: int | None = None) -> Iterator[int]:
    """Give the handle of a folder, in another one if its handle is given."""
    handle = os.open(name, FOLDER, dir_fd=parent)
    try:
        yield handle
    finally:
        os.close(handle)


def unlikely(name: str, ending: str) -> str:
    """Return a hidden name that begins like this one and that nothing has."""
    return f".{name}-{os.urandom(UNLIKELY).hex()}{ending}"


@contextmanager
def grown(name: str, parent: int) -> Iterator[int]:
    """Give the handle of a new folder; what still goes by its name when the block ends is removed."""
    os.mkdir(name, NEW_FOLDER, dir_fd=parent)
    try:
        with opened(name, parent) as handle:
            yield handle
    finally:
        remove(name, parent)


def put(name: str, inside: int, place: str, parent: int, aside: str) -> bool:
    """Rename a folder to its place in another one; what lies there goes `aside`, to where the folder was.

    Return whether anything did.  It is moved as what it is, a link as a link, and is back if the renaming fails.
    """
    try:
        os.rename(name, place, src_dir_fd=inside, dst_dir_fd=parent)
    except OSError as error:
        if error.errno not in TAKEN:
            raise
    else:
        return False
    remove(aside, inside)
    os.rename(place, aside, src_dir_fd=parent, dst_dir_fd=inside)
    try:
        os.rename(name, place, src_dir_fd=inside, dst_dir_fd=parent)
    except OSError:
        os.rename(aside, place, src_dir_fd=inside, dst_dir_fd=parent)
        raise
    return True


@contextmanager
def within(name: str, folder: int) -> Iterator[int]:
    """Give the handle of a folder in another one, made where it is missing."""
    with suppress(FileExistsError):
        os.mkdir(name, NEW_FOLDER, dir_fd=folder)
    with opened(name, folder) as inner:
        yield inner


@contextmanager
def new_file(folder: int, path: str) -> Iterator[BinaryIO]:
    """Give a new file below a folder, its own folders made where they are missing."""
    first, *rest = steps(path)
    if rest:
        with within(first, folder) as inner, new_file(inner, "/".join(rest)) as stream:
            yield stream
        return
    with os.fdopen(os.open(first, NEW, NEW_FILE, dir_fd=folder), "wb") as stream:
        yield stream


def create(folder: int, path: str, content: bytes) -> None:
    """Write a new file below a folder; when it is on disk is left to who syncs many at once."""
    with new_file(folder, path) as stream:
        stream.write(content)


def write(folder: int, path: str, content: bytes) -> None:
    """Write a new file below a folder, and have it on disk."""
    with new_file(folder, path) as stream:
        stream.write(content)
        stream.flush()
        os.fsync(stream.fileno())


def replace(folder: int, path: str, content: bytes) -> None:
    """Write a file below a folder, in place of an earlier one, as a whole or not at all."""
    first, *rest = steps(path)
    if rest:
        with within(first, folder) as inner:
            replace(inner, "/".join(rest), content)
        return
    draft = unlikely(first, ".part")
    try:
        write(folder, draft, content)
        os.rename(draft, first, src_dir_fd=folder, dst_dir_fd=folder)
    except BaseException:
        with suppress(OSError):
            os.unlink(draft, dir_fd=folder)
        raise


def steps(path: str) -> tuple[str, ...]:
    """Return the steps of a path below a folder; ValueError for one that leads out of it."""
    found = PurePosixPath(path).parts
    if not found or ".." in found or found[0] == "/":
        raise ValueError(f"{path!r} is no path below a folder")
    return found


def is_same(folder: int, name: str, parent: int) -> bool:
    """Return whether an opened folder still goes by that name."""
    try:
        there = os.stat(name, dir_fd=parent, follow_symlinks=False)
    except OSError:
        return False
    return os.path.samestat(there, os.fstat(folder))


def sync(folder: int) -> None:
    """Have the entries of a folder, and of the folders in it, on disk; as far as the file system can do that."""
    with suppress(OSError):
        os.fsync(folder)
    with os.scandir(folder) as entries:
        names = [entry.name for entry in entries if entry.is_dir(follow_symlinks=False)]
    for name in names:
        with opened(name, folder) as inner:
            sync(inner)


def remove(name: str, parent: int) -> None:
    """Remove what goes by a name, as far as that can be done; of a link what it leads to stays."""
    try:
        mode = os.stat(name, dir_fd=parent, follow_symlinks=False).st_mode
    except OSError:
        return
    if stat.S_ISDIR(mode):
        shutil.rmtree(name, ignore_errors=True, dir_fd=parent)
    remove_link(name, parent)


def remove_link(name: str, parent: int) -> None:
    """Remove a link, or a file; a folder stays."""
    with suppress(OSError):
        os.unlink(name, dir_fd=parent)
