"""The digest of a folder: over the names and the bytes of the files in it.

SHA-256 over one line for each file in order of its path, `<sha256 of its bytes> <its path, slashes between>`, so
that two folders have the same digest exactly where they hold the same files.  Times, owners and empty folders do
not count.  A link is not followed: what is not a plain file or a folder raises.
"""

import hashlib
import os
import stat
from collections.abc import Iterator, Mapping
from pathlib import Path

READ_BYTES = 1 << 20
"""Read at once, so that a file of any size is hashed in little memory."""


def folder(root: Path) -> str:
    """Return the digest of all files below `root`, as 64 hexadecimal digits."""
    whole = hashlib.sha256()
    for name, path in sorted(_files(root, "")):
        whole.update(f"{file(path)} {name}\n".encode("utf-8", "surrogateescape"))
    return whole.hexdigest()


def files(contents: Mapping[str, bytes]) -> str:
    """Return the digest that the folder of these files has, by their paths."""
    whole = hashlib.sha256()
    for name, content in sorted(contents.items()):
        whole.update(f"{hashlib.sha256(content).hexdigest()} {name}\n".encode("utf-8", "surrogateescape"))
    return whole.hexdigest()


def file(path: Path) -> str:
    """Return the SHA-256 of the bytes of a file, as 64 hexadecimal digits."""
    whole = hashlib.sha256()
    with os.fdopen(os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_CLOEXEC), "rb") as stream:
        while chunk := stream.read(READ_BYTES):
            whole.update(chunk)
    return whole.hexdigest()


def _files(root: Path, prefix: str) -> Iterator[tuple[str, Path]]:
    with os.scandir(root) as entries:
        for entry in entries:
            mode = entry.stat(follow_symlinks=False).st_mode
            if stat.S_ISDIR(mode):
                yield from _files(Path(entry.path), f"{prefix}{entry.name}/")
            elif stat.S_ISREG(mode):
                yield prefix + entry.name, Path(entry.path)
            else:
                raise ValueError(f"{entry.path}: neither a plain file nor a folder")
