"""The files that a job file names: found where they may lie, opened without waiting, read up to a size.

A name leads into the folder of the job file, or into a folder that is allowed besides (`--allow`).  Links on the way
are followed first; where that ends is looked at, and then opened step by step from the allowed folder with no link
followed any more: a folder that is exchanged for a link meanwhile is an error and no way out.  What is no regular file
(a device, a pipe, a folder) is refused before it is opened, since opening it may wait for ever.

A hard link to a file elsewhere is a file of its folder: whoever made it could read it.
"""

import os
import stat
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from pipeline.decode import ResolveError

FOLDER = getattr(os, "O_PATH", os.O_RDONLY) | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC
FILE = os.O_RDONLY | os.O_NONBLOCK | os.O_NOCTTY | os.O_NOFOLLOW | os.O_CLOEXEC
"""Not to wait for the other end of a pipe, should one have taken the place of the file since it was looked at."""
PLAIN = os.O_RDONLY | os.O_NONBLOCK | os.O_NOCTTY | os.O_CLOEXEC


class NotRegularError(OSError):
    """A device, a pipe, a socket or a folder where a file belongs."""

    def __init__(self, mode: int) -> None:
        self.what = next((name for test, name in SORTS if test(mode)), "no regular file")
        super().__init__(None, f"it is {self.what}")


SORTS = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
    (stat.S_ISSOCK, "a socket"),
)


TOLD = 20_000_000
"""Bytes of a file above which reading takes so long that it is told."""


class TooLargeError(Exception):
    """A file of more bytes than it may have."""


def silent(_text: str) -> None:
    """Tell no one."""


Seen = Callable[[Path, str], None]
"""Is told of a file that is looked for, and again with the sha256 of its bytes once they are read."""


def unnoticed(_file: Path, _sha256: str) -> None:
    """Note nothing."""


@dataclass(frozen=True, slots=True)
class Reach:
    """Where the files that a job names may lie.

    folder: of the job file, where their names begin.  allow: what they may lie in besides; None: anywhere.
    tell: is told what takes long.  seen: is told of every file that is looked for, also of one that is not there.
    """

    folder: Path
    allow: tuple[Path, ...] | None = ()
    tell: Callable[[str], None] = silent
    seen: Seen = unnoticed

    def content(self, name: str, largest: int, hint: str) -> bytes:
        """Return the bytes of a file, `largest` at most; `ResolveError` with the remedy where it cannot be had.

        hint: what to do about a file that is too large.
        """
        self.seen(self.folder / name, "")
        try:
            handle = self._opened(name)
            if largest >= os.fstat(handle).st_size > TOLD:
                self.tell(f"reading {name}, {os.fstat(handle).st_size // 10**6} MB")
            content = limited(handle, largest)
        except TooLargeError:
            raise ResolveError("file", f"{name} is larger than {largest // 10**6} MB", hint) from None
        except FileNotFoundError:
            raise ResolveError("file", f"there is no file {name}", f"looked for {self.folder / name}") from None
        except NotRegularError as error:
            hint = "name the file in it" if error.what == "a folder" else "name a file that lies on a disk"
            raise ResolveError("file", f"{name} is {error.what}", hint) from None
        except OSError as error:
            raise ResolveError("file", f"{name} cannot be read: {error.strerror or error}", "") from None
        except ValueError:
            hint = "letters that a file name may have"
            raise ResolveError("file", "the name of the file is none that a system takes", hint) from None
        self.seen(self.folder / name, sha256(content).hexdigest())
        return content

    def _opened(self, name: str) -> int:
        """Return the handle of a file that lies where it may."""
        end = Path(os.path.realpath(self.folder / name))
        if self.allow is None:
            return opened(end.parent, (end.name,))
        for root in (self.folder, *self.allow):
            start = Path(os.path.realpath(root))
            if end.is_relative_to(start):
                return opened(start, end.relative_to(start).parts)
        message = f"{name} lies outside of the folder of the job file"
        raise ResolveError("file", message, f"copy it there, or run with --allow {end.parent}")


def opened(root: Path, steps: Sequence[str]) -> int:
    """Return the handle of a regular file below a folder; no link is followed on the way down."""
    here = os.open(root, FOLDER)
    try:
        for step in steps[:-1]:
            inner = os.open(step, FOLDER, dir_fd=here)
            os.close(here)
            here = inner
        if not steps:
            raise NotRegularError(stat.S_IFDIR)
        refuse_special(os.stat(steps[-1], dir_fd=here, follow_symlinks=False))
        return os.open(steps[-1], FILE, dir_fd=here)
    finally:
        os.close(here)


def refuse_special(found: os.stat_result) -> None:
    """Raise `NotRegularError` unless it is a regular file."""
    if not stat.S_ISREG(found.st_mode):
        raise NotRegularError(found.st_mode)


def plain(file: Path) -> int:
    """Return the handle of a file that the user named; links are followed, nothing but a regular file is opened."""
    refuse_special(file.stat())
    return os.open(file, PLAIN)


def limited(handle: int, largest: int) -> bytes:
    """Return the bytes behind a handle, which is closed; `TooLargeError` before more than `largest` are read."""
    with open(handle, "rb") as stream:
        found = os.fstat(handle)
        refuse_special(found)
        if found.st_size > largest:
            raise TooLargeError
        content = stream.read(largest + 1)
    if len(content) > largest:
        raise TooLargeError
    return content
