"""The files of one job, as a folder that is there as a whole or not at all.

They are written into a folder beside the draft and that is renamed, so that a child which is killed half-way, or a
second one that runs the same job on another machine, leaves no draft with half of its files.  Everything is named
relative to the opened parent folder; no link is followed, no file is opened that is there already.
"""

import os
import shutil
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from pipeline.batch import digest

PART = ".part-"
NEW_FOLDER = 0o777
NEW_FILE = 0o666
"""What the user's mask leaves of these is what everyone may do: as of any folder and file."""
FOLDER = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC
FILE = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC


def write(draft: Path, files: Mapping[str, bytes]) -> str:
    """Make the folder with these files, by their paths with slashes, and return its digest; `OSError` where not."""
    parent = os.open(draft.parent, FOLDER)
    part = f"{draft.name}{PART}{os.urandom(8).hex()}"
    try:
        os.mkdir(part, NEW_FOLDER, dir_fd=parent)
        _fill(parent, part, files)
        _take_place(parent, part, draft.name)
    except BaseException:
        with suppress(OSError):
            shutil.rmtree(part, dir_fd=parent)
        raise
    finally:
        os.close(parent)
    return digest.files(files)


def _fill(parent: int, name: str, files: Mapping[str, bytes]) -> None:
    """Write files into a folder; those of a folder in it by themselves."""
    inside: dict[str, dict[str, bytes]] = {}
    handle = os.open(name, FOLDER, dir_fd=parent)
    try:
        for path, content in files.items():
            first, slash, rest = path.partition("/")
            if slash:
                inside.setdefault(first, {})[rest] = content
            else:
                _write(handle, first, content)
        for folder, within in inside.items():
            os.mkdir(folder, NEW_FOLDER, dir_fd=handle)
            _fill(handle, folder, within)
    finally:
        os.close(handle)


def _write(folder: int, name: str, content: bytes) -> None:
    handle = os.open(name, FILE, NEW_FILE, dir_fd=folder)
    with os.fdopen(handle, "wb", buffering=0) as stream:
        rest = memoryview(content)
        while rest:
            rest = rest[stream.write(rest) :]


def _take_place(parent: int, part: str, name: str) -> None:
    """Rename; the draft of an attempt whose end no one heard of makes way."""
    try:
        os.rename(part, name, src_dir_fd=parent, dst_dir_fd=parent)
    except OSError:
        aside = f"{part}.old"
        os.rename(name, aside, src_dir_fd=parent, dst_dir_fd=parent)
        os.rename(part, name, src_dir_fd=parent, dst_dir_fd=parent)
        _remove(parent, aside)


def _remove(parent: int, name: str) -> None:
    """Remove a folder with all that is in it, or a file or link that has its place."""
    try:
        os.unlink(name, dir_fd=parent)
    except (IsADirectoryError, PermissionError):
        shutil.rmtree(name, dir_fd=parent)


def clear(draft: Path) -> None:
    """Remove what a job that did not end left of its draft; nothing is said where that fails, it is only litter."""
    with suppress(OSError):
        parent = os.open(draft.parent, FOLDER)
        try:
            with os.scandir(parent) as entries:
                names = [entry.name for entry in entries if entry.name.partition(PART)[0] == draft.name]
            for name in names:
                shutil.rmtree(name, ignore_errors=True, dir_fd=parent)
        finally:
            os.close(parent)
