"""The files that a job has named, with what it found in them: its result counts as long as they hold that.

A file that was read counts with the digest of the very bytes that were read.  One that could not be read (not there,
too large, out of reach) counts with what it holds once the job has ended.  Where that is not sure to be what the job
met, because it read two different contents, or because the file has changed since it was looked for, no digest says
what the job was made from: `changed` names the file, and the job is to run again.

Not seen: a file that could not be read, and was exchanged and put back, or was changed without a trace in its inode.
"""

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from pipeline.batch.identity import of_file

Stamp = tuple[int, ...]
NO_FILE: Stamp = ()


@dataclass(slots=True)
class Named:
    """Listens to the reading of a job (`pipeline.reach.Seen`).

    looked: how often each file was looked for, by its absolute path, less how often it was read.  stamps: what the
    files were when they were looked for first.  digests: of those that were read.  changed: one that has changed.
    """

    looked: Counter[str] = field(default_factory=Counter)
    stamps: dict[str, Stamp] = field(default_factory=dict)
    digests: dict[str, str] = field(default_factory=dict)
    changed: str = ""

    def seen(self, path: Path, sha256: str) -> None:
        """Note that a file is looked for, or with which digest it was read."""
        name = str(path)
        self.looked[name] += -1 if sha256 else 1
        if not sha256:
            self.stamps.setdefault(name, stamp(name))
        elif self.digests.setdefault(name, sha256) != sha256:
            self.changed = name

    def inputs(self) -> tuple[tuple[str, str], ...]:
        """Return every file with its digest, in order; `changed` is final then."""
        found: list[tuple[str, str]] = []
        for name, before in sorted(self.stamps.items()):
            found.append((name, self.digests.get(name) or of_file(name)))
            if self.looked[name] and stamp(name) != before:
                self.changed = name
        return tuple(found)


def stamp(name: str) -> Stamp:
    """Return what changes with the content of a file, as the file system tells it."""
    try:
        found = Path(name).stat()
    except (OSError, ValueError):
        return NO_FILE
    return found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns, found.st_ctime_ns
