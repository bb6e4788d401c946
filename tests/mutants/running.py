"""Runs tests in a copy of the tree, in a fork of this process, and says how they ended.

The libraries are loaded once, here, and not the project: half of the time of a short run is theirs.  The copy is what
is imported, by subprocesses as well.  Linux only.
"""

import importlib
import os
import re
import resource
import signal
import sys
import time
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, NoReturn

LIBRARIES = (
    "numpy", "scipy.optimize", "scipy.sparse.linalg", "scipy.spatial", "scipy.interpolate", "shapely", "ezdxf",
    "msgspec", "click", "networkx", "mpmath", "jsonschema", "pytest",
)  # fmt: skip
"""Plugins of pytest are not among them: it wants to load those itself."""
SILENT_S = 90.0
"""After so long without a word a test hangs: 2 s are allowed, and compiling the kernels takes half a minute."""
BUSY = 10.0
"""A second counts as so much less where the process waits: the machine may be that busy with other things."""
MEMORY = 12 * 2**30
"""Of addresses, bytes: threads and compilers reserve several times what they use."""
ENDED = re.compile(r"^(FAILED|ERROR) (.+?)(?: - .*)?$", re.MULTILINE)
TOLD = re.compile(r"^(tests/\S+::.+?)(?: (PASSED|FAILED|ERROR|SKIPPED|XFAIL|XPASS|Fatal Python).*)?$", re.MULTILINE)
OPTIONS = ("-x", "-vv", "--tb=no", "-rfE", "--color=no", "-p", "no:cacheprovider")
NONE_FOUND = 5
"""What pytest ends with where all tests are deselected."""

Cut = Literal["silent", "spent"] | None


@dataclass(frozen=True, slots=True)
class Ended:
    """How a run of tests ended: all passed, one failed, one hung, or the time was over; how many were through."""

    how: Literal["passed", "failed", "silent", "spent"]
    test: str
    count: int
    seconds: float


def ready() -> None:
    """Load what all tests need, and keep to `MEMORY` from here on: a mutant may never stop asking for more."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    for name in LIBRARIES:
        importlib.import_module(name)


def run(tree: Path, words: Sequence[str], seconds: float, silent_s: float = SILENT_S) -> Ended:
    """Return how tests end in a tree."""
    log = tree / "mutant.log"
    log.write_bytes(b"")
    child = os.fork()
    if child == 0:
        _test(tree, words, log)
    used = clock(child)
    cut, code = _watched(child, used, log, seconds, silent_s)
    return judged(log.read_text("utf-8", "replace"), cut, code, used())


def _test(tree: Path, words: Sequence[str], log: Path) -> NoReturn:
    """Become a process of its own that runs tests in a tree."""
    code = 1
    try:
        os.setsid()
        os.chdir(tree)
        out = os.open(log, os.O_WRONLY | os.O_APPEND)
        os.dup2(out, 1)
        os.dup2(out, 2)
        os.environ.update({"PYTHONPATH": str(tree), "CI": "true"})
        for name in [name for name in sys.modules if name == "tests" or name.startswith("tests.")]:
            del sys.modules[name]
        sys.path.insert(0, str(tree))
        import pytest

        code = int(pytest.main([*OPTIONS, *words]))
        sys.stdout.flush()
    except BaseException:
        traceback.print_exc()
    finally:
        os._exit(code)


def clock(child: int) -> Callable[[], float]:
    """Return a clock of a process that has just begun: its processor time, or the tenth of ours if that is more."""
    begun, own = time.monotonic(), (~child << 3) | 2
    last = 0.0

    def used() -> float:
        nonlocal last
        try:
            last = max(last, time.clock_gettime(own))
        except OSError:
            return last
        last = max(last, (time.monotonic() - begun) / BUSY)
        return last

    return used


def _watched(child: int, used: Callable[[], float], log: Path, seconds: float, silent_s: float) -> tuple[Cut, int]:
    """Wait for the tests, or end them with all that they started; return why, and the exit code."""
    size, heard = -1, 0.0
    while True:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            return None, os.waitstatus_to_exitcode(status)
        now = used()
        if log.stat().st_size != size:
            size, heard = log.stat().st_size, now
        if now - heard > silent_s or now > seconds:
            os.killpg(child, signal.SIGKILL)
            os.waitpid(child, 0)
            return "silent" if now - heard > silent_s else "spent", -signal.SIGKILL
        time.sleep(0.1)


def judged(log: str, cut: Cut, code: int, seconds: float) -> Ended:
    """Return what the words and the exit code of pytest mean."""
    told = TOLD.findall(log)
    last = told[-1][0].strip() if told else ""
    count = sum(how in {"PASSED", "XFAIL"} for _, how in told)
    if cut is not None:
        return Ended(cut, last, count, seconds)
    if code in {0, NONE_FOUND}:
        return Ended("passed", "", count, seconds)
    failed = ENDED.search(log)
    if not (failed or last):
        raise RuntimeError(f"pytest ended with {code} before any test:\n{log}")
    return Ended("failed", failed[2] if failed else last, count, seconds)
