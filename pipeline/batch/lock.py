"""One runner for each output folder: a lock that the system takes back when its holder ends, however it ends."""

import fcntl
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager

from stages.errors import BadInputError, Problem

LOCK = ".lock"
LONGEST_HOLDER = 200


@contextmanager
def held(folder: int, path: str) -> Iterator[None]:
    """Hold the lock of an opened folder for the block; `BadInputError` says who has it already."""
    handle = os.open(LOCK, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o666, dir_fd=folder)
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            holder = os.pread(handle, LONGEST_HOLDER, 0).decode("utf-8", "replace").strip() or "another runner"
            hint = "wait until it has ended, or choose another folder with -o"
            raise BadInputError(Problem(f"{holder} is at work here", hint=hint, file=path)) from None
        os.ftruncate(handle, 0)
        os.pwrite(handle, f"process {os.getpid()} on {socket.gethostname()}\n".encode(), 0)
        yield
    finally:
        os.close(handle)
