"""The files of one job, as a folder that is there as a whole or not at all.

They are written into a folder beside the draft and that is renamed, so that a child which is killed half-way, or a
second one that runs the same job on another machine, leaves no draft with half of its files.  They are not synced one
by one: the runner has all drafts of a group on disk at once before any of them counts.
"""

import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from pipeline import folders
from pipeline.batch import digest

PART, OLD = ".part-", ".old"


def write(draft: Path, files: Mapping[str, bytes]) -> str:
    """Make the folder with these files, by their paths with slashes, and return its digest; `OSError` where not."""
    with folders.opened(draft.parent) as parent:
        return made(draft.name, parent, files)


def made(name: str, parent: int, files: Mapping[str, bytes]) -> str:
    """Make the folder in an opened one; the draft of an attempt whose end no one heard of makes way."""
    part = f"{name}{PART}{os.urandom(folders.UNLIKELY).hex()}"
    with folders.grown(part, parent) as handle:
        for path, content in files.items():
            folders.create(handle, path, content)
        if folders.put(part, parent, name, parent, f"{part}{OLD}"):
            folders.remove(f"{part}{OLD}", parent)
    return digest.files(files)


def clear(draft: Path) -> None:
    """Remove what a job that did not end left of its draft; nothing is said where that fails, it is only litter."""
    with suppress(OSError), folders.opened(draft.parent) as parent:
        with os.scandir(parent) as entries:
            names = [entry.name for entry in entries if entry.name.partition(PART)[0] == draft.name]
        for name in names:
            folders.remove(name, parent)
