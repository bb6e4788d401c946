"""Folders by their handles: what is written, renamed and removed below one stays below it.

A path is looked up anew at every call, and whoever may write to a folder on the way can make it lead elsewhere between
two calls.  Here a folder is opened once and all else is named relative to it, step by step, no link followed; a file
is always made new.  A step that has become a link, or a file that is there already, is an `OSError`.
"""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path, PurePosixPath

FOLDER = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC
NEW = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC
NEW_FOLDER, NEW_FILE = 0o777, 0o666
"""What the user's mask leaves of these is what everyone may do: as of any folder and file."""
UNLIKELY = 8
"""Random bytes that make a name no other has."""


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


def write(folder: int, path: str, content: bytes) -> None:
    """Write a new file below a folder, its own folders made where they are missing, and have it on disk."""
    first, *rest = steps(path)
    if rest:
        with suppress(FileExistsError):
            os.mkdir(first, NEW_FOLDER, dir_fd=folder)
        with opened(first, folder) as inner:
            write(inner, "/".join(rest), content)
        return
    with os.fdopen(os.open(first, NEW, NEW_FILE, dir_fd=folder), "wb") as stream:
        stream.write(content)
        stream.flush()
        os.fsync(stream.fileno())


def replace(folder: int, path: str, content: bytes) -> None:
    """Write a file below a folder, in place of an earlier one, as a whole or not at all."""
    first, *rest = steps(path)
    if rest:
        with suppress(FileExistsError):
            os.mkdir(first, NEW_FOLDER, dir_fd=folder)
        with opened(first, folder) as inner:
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
    with suppress(OSError):
        shutil.rmtree(name, dir_fd=parent)
    remove_link(name, parent)


def remove_link(name: str, parent: int) -> None:
    """Remove a link, or a file; a folder stays."""
    with suppress(OSError):
        os.unlink(name, dir_fd=parent)
