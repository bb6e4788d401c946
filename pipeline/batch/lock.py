"""One runner for each output folder: a lock that the system takes back when its holder ends, however it ends."""

import errno
import fcntl
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from time import monotonic, sleep

from stages.errors import BadInputError, Problem

LOCK = ".lock"
FLAGS = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
FOREIGN = frozenset({errno.ELOOP, errno.EISDIR})
"""What opening says of a link, and of a folder."""
LONGEST_HOLDER = 200
LOOK = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
LOOKED_S, AGAIN_S = 0.5, 0.02
"""How long to try to get the lock, as one who looks who has it holds it for an instant; and how often."""


@contextmanager
def held(folder: int, path: str) -> Iterator[None]:
    """Hold the lock of an opened folder for the block; `BadInputError` says who has it already."""
    handle = _opened(folder, path)
    try:
        if not _taken(handle):
            hint = "wait until it has ended, or choose another folder with -o"
            raise BadInputError(Problem(f"{_name(handle)} is at work here", hint=hint, file=path))
        os.ftruncate(handle, 0)
        os.pwrite(handle, f"process {os.getpid()} on {socket.gethostname()}\n".encode(), 0)
        yield
    finally:
        os.close(handle)


def _taken(handle: int) -> bool:
    """Return whether the lock could be had within a time."""
    end = monotonic() + LOOKED_S
    while True:
        with suppress(BlockingIOError):
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            return True
        if monotonic() > end:
            return False
        sleep(AGAIN_S)


def holder(out: Path) -> str:
    """Return who is at work in an output folder; nothing where no one is, or no one can tell."""
    try:
        handle = os.open(out / LOCK, LOOK)
    except OSError:
        return ""
    try:
        fcntl.flock(handle, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return _name(handle)
    except OSError:
        return ""
    finally:
        os.close(handle)
    return ""


def _name(handle: int) -> str:
    """Return what the holder of a lock has written into it."""
    return os.pread(handle, LONGEST_HOLDER, 0).decode("utf-8", "replace").strip() or "another runner"


def _opened(folder: int, path: str) -> int:
    """Return the handle of the file of the lock, made where it is missing; `BadInputError` for a link or a folder."""
    try:
        return os.open(LOCK, FLAGS, 0o666, dir_fd=folder)
    except OSError as error:
        if error.errno not in FOREIGN:
            raise
        message = f"a link or a folder where the lock {LOCK} belongs"
        raise BadInputError(Problem(message, hint="remove it", file=path)) from None
