"""Why a batch cannot go on now though nothing is wrong with it: a full disk, a lost cluster."""

import errno
import os
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

FULL = frozenset({errno.ENOSPC, errno.EDQUOT})
SPACE = "make space there, and run the same command again"
NO_ROOM = frozenset({sqlite3.SQLITE_FULL, sqlite3.SQLITE_IOERR})
"""What SQLite says where the disk takes no more; the lower byte of its codes."""
BASIC = 0xFF


class StoppedError(Exception):
    """The batch cannot go on now, and nothing is lost: why, and what to do."""

    def __init__(self, why: str, remedy: str) -> None:
        super().__init__(f"{why} ({remedy})")


@contextmanager
def full_disk_stops(path: Path) -> Iterator[None]:
    """Raise `StoppedError` where the block meets a disk that takes no more."""
    try:
        yield
    except OSError as error:
        if error.errno not in FULL:
            raise
        raise StoppedError(f"{path}: {os.strerror(error.errno)}", SPACE) from None
    except sqlite3.OperationalError as error:
        if error.sqlite_errorcode & BASIC not in NO_ROOM:
            raise
        raise StoppedError(f"the journal in {path}: {error}", SPACE) from None


def says_full(cause: str) -> bool:
    """Return whether the cause of a failure is a disk that takes no more."""
    return any(os.strerror(number) in cause for number in FULL)
