"""What a job's result depends on, as digests: two jobs of one key have the same result.

Three things make the key: the job itself (its bytes, and its row where it is one of a table), every file that it
named with its bytes, and the program (its modules, its tables, the libraries that compute).  The files that a job
names are known once it has been read; they are recorded then, and looked at again before anything is parsed.
"""

import os
import stat
from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import file_digest, sha256

ABSENT = ""
"""Stands for the digest of a file that is not there, or that is no plain file."""


@dataclass(frozen=True, slots=True)
class Program:
    """The program that runs the jobs: digests of its modules and of its tables, versions of what computes."""

    code: str
    tables: str
    libraries: str

    def changes(self, since: "Program") -> list[str]:
        """Return what is not as it was, in words."""
        said = (
            ("the code of planish", self.code, since.code),
            ("the tables of materials and processes", self.tables, since.tables),
            (f"the libraries ({since.libraries} then)", self.libraries, since.libraries),
        )
        return [what for what, now, then in said if now != then]


def program() -> Program:
    """Return the program as it is now."""
    from pipeline import provenance

    every_reader = [suffix for suffixes in provenance.CAD_LIBRARIES.values() for suffix in suffixes]
    libraries = provenance.environment(f"x{suffix}" for suffix in every_reader)
    tables = "".join(f"{name} {digest}\n" for name, digest in provenance.tables())
    return Program(
        provenance.code_digest(),
        sha256(tables.encode()).hexdigest(),
        ", ".join(f"{name} {version}" for name, version in sorted(libraries.items())),
    )


def content(own: bytes) -> bytes:
    """Return the digest of a job's own bytes: their plain SHA-256."""
    return sha256(own).digest()


def of_file(path: str) -> str:
    """Return the SHA-256 of a named file as it is now, `ABSENT` where there is none."""
    try:
        handle = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except (OSError, ValueError):
        return ABSENT
    with os.fdopen(handle, "rb") as stream:
        if not stat.S_ISREG(os.fstat(handle).st_mode):
            return ABSENT
        return file_digest(stream, "sha256").hexdigest()


def key(own: bytes, inputs: Sequence[tuple[str, str]], by: Program) -> str:
    """Return the key of a job: the digest of everything that its result depends on."""
    whole = sha256(own)
    for path, digest in sorted(inputs):
        whole.update(f"{digest} {path}\n".encode("utf-8", "surrogateescape"))
    whole.update(f"{by.code} {by.tables} {by.libraries}".encode())
    return whole.hexdigest()
