"""What becomes of a mutant: the tests run in a copy of the tree in which it is planted, until one fails.

A mutant is killed by a test that fails with it and passes without it; also by one that says nothing for long with it
and ends in a quarter of that time without it.  Machine code and byte code are kept from mutant to mutant, and cannot be
mistaken: kernels are kept by the digest of their sources, and a planted file has a time of its own.
"""

import os
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from tests.mutants.drawn import Mutant, found_again
from tests.mutants.operators import Change, mutated
from tests.mutants.running import SILENT_S, Ended, run

NOT_COPIED = (".git", ".venv", ".bench", "node_modules", "__pycache__", "out", "dist", ".*_cache", ".hypothesis")
PARTS = (3, 12)
"""How many files of tests are asked first, and then, before all others: most mutants do not get past the first."""
FAR_LESS = 0.25


@dataclass(frozen=True, slots=True)
class Verdict:
    """What became of a mutant, by which test, after how many; whole: whether all that may notice it were asked."""

    number: int
    verdict: Literal["killed", "timed out", "survived", "gone"]
    by: str = ""
    tests: int = 0
    whole: bool = False


def copied(root: Path, folder: Path) -> Path:
    """Return a copy of the tree without what is made from it."""
    return Path(shutil.copytree(root, folder / "tree", ignore=shutil.ignore_patterns(*NOT_COPIED)))


@contextmanager
def planted(tree: Path, mutant: Mutant, change: Change) -> Iterator[None]:
    """Plant a mutant for as long as it is wanted."""
    file = tree / mutant.file
    source, times = file.read_bytes(), file.stat()
    file.write_bytes(mutated(source, change))
    own = times.st_mtime_ns + mutant.number * 10**9
    os.utime(file, ns=(own, own))
    try:
        yield
    finally:
        file.write_bytes(source)
        os.utime(file, ns=(times.st_atime_ns, times.st_mtime_ns))


def parts(tests: Sequence[str]) -> Iterator[Sequence[str]]:
    """Yield the likeliest tests, the next ones, and the rest."""
    begin = 0
    for end in (*(sum(PARTS[: i + 1]) for i in range(len(PARTS))), len(tests)):
        if tests[begin:end]:
            yield tests[begin:end]
        begin = end


def tried(tree: Path, mutant: Mutant, tests: Sequence[str], seconds: float) -> Verdict:
    """Return what becomes of a mutant in so many seconds."""
    change = found_again(mutant, (tree / mutant.file).read_bytes()) if (tree / mutant.file).exists() else None
    if change is None:
        return Verdict(mutant.number, "gone")
    left, count, left_out = seconds, 0, []
    waiting = list(parts(tests))
    while waiting:
        words = [*waiting[0], *(f"--deselect={test}" for test in left_out)]
        with planted(tree, mutant, change):
            ended = run(tree, words, left)
        left -= ended.seconds
        if ended.how in {"failed", "silent"}:
            if passes_without(tree, ended):
                verdict: Literal["killed", "timed out"] = "killed" if ended.how == "failed" else "timed out"
                return Verdict(mutant.number, verdict, ended.test, count + ended.count)
            left_out.append(ended.test)
            continue
        count += ended.count
        if ended.how == "spent":
            return Verdict(mutant.number, "survived", "", count)
        waiting = waiting[1:]
    return Verdict(mutant.number, "survived", "", count, whole=not left_out)


def passes_without(tree: Path, ended: Ended) -> bool:
    """Return whether the test that failed or hung passes, and soon, where nothing is planted."""
    only_read = () if "::" in ended.test else ("--collect-only",)
    again = run(tree, [ended.test, *only_read], SILENT_S)
    return again.how == "passed" and (ended.how == "failed" or again.seconds < FAR_LESS * SILENT_S)
