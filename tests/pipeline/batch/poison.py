"""Jobs that harm the process that runs them, by what their first setting says; the others are made at once."""

import ctypes
import os
import signal
import subprocess
import threading
import time
from pathlib import Path
from typing import NoReturn
from unittest.mock import patch

from pipeline.batch import guard
from pipeline.batch.guard import Files
from pipeline.batch.named import Named
from pipeline.batch.work import Limits, Record, Status, Work
from pipeline.jobfile import ReadJob

WALL_S = 0.6
MEMORY = 400 << 20
GOOD = "good"
ONCE = "waits the first time that it is run"
KILLED_ONCE = "is killed from outside the first time that it is run"
PARENT = "starts another process and waits for it"


def segfault() -> None:
    ctypes.string_at(0)


def loop() -> NoReturn:
    signal.pthread_sigmask(signal.SIG_BLOCK, {*signal.Signals} - {signal.SIGKILL, signal.SIGSTOP})
    while True:
        pass


def stop_itself() -> None:
    os.kill(os.getpid(), signal.SIGSTOP)


def hog() -> None:
    held = []
    while True:
        held.append(bytearray(64 << 20))


def recurse(depth: int = 0) -> int:
    return recurse(depth + 1) + 1


def stack() -> None:
    """Recurse in C until the stack is full, which no exception tells."""
    compare = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)
    qsort = ctypes.CDLL(None).qsort

    def again(_a: int | None, _b: int | None) -> int:
        import sys

        sys.setrecursionlimit(1 << 30)
        two = (ctypes.c_int * 2)()
        qsort(two, 2, 4, compare(again))
        return 0

    again(None, None)


def freed_twice() -> None:
    library = ctypes.CDLL(None)
    library.malloc.restype, library.free.argtypes = ctypes.c_void_p, [ctypes.c_void_p]
    block = library.malloc(64)
    library.free(block)
    library.free(block)


def raise_exit() -> None:
    raise SystemExit(0)


def raise_interrupt() -> None:
    raise KeyboardInterrupt


def close_everything() -> None:
    os.closerange(3, 256)


def end_from_a_thread() -> None:
    threading.Thread(target=lambda: os._exit(7)).start()
    time.sleep(3600)


ACTS = {
    "segfault": segfault,
    "abort": os.abort,
    "freed twice": freed_twice,
    "exit 0": lambda: os._exit(0),
    "exit 3": lambda: os._exit(3),
    "exit 255": lambda: os._exit(255),
    "exit from a thread": end_from_a_thread,
    "loop": loop,
    "sleep": lambda: time.sleep(3600),
    "stopped": stop_itself,
    "hog": hog,
    "recursion": recurse,
    "stack": stack,
    "SystemExit": raise_exit,
    "KeyboardInterrupt": raise_interrupt,
    "closed pipes": close_everything,
    "killed": lambda: os.kill(os.getpid(), signal.SIGKILL),
}
"""What a job does, by name."""


ENDS: dict[str, tuple[Status, str, bool]] = {
    "segfault": ("crashed", "SIGSEGV", True),
    "abort": ("crashed", "SIGABRT", True),
    "freed twice": ("crashed", "SIGABRT", True),
    "exit 0": ("crashed", "the process ended by itself, exit code 0", True),
    "exit 3": ("crashed", "the process ended by itself, exit code 3", True),
    "exit 255": ("crashed", "the process ended by itself, exit code 255", True),
    "exit from a thread": ("crashed", "the process ended by itself, exit code 7", True),
    "loop": ("timed-out", f"more than {WALL_S} s", True),
    "sleep": ("timed-out", f"more than {WALL_S} s", True),
    "stopped": ("timed-out", f"more than {WALL_S} s", True),
    "hog": ("out-of-memory", "needs more than 400 MB of memory", True),
    "recursion": ("internal", "RecursionError: maximum recursion depth exceeded", True),
    "stack": ("crashed", "SIGSEGV", True),
    "SystemExit": ("internal", "SystemExit: 0", True),
    "KeyboardInterrupt": ("internal", "KeyboardInterrupt: ", True),
    "closed pipes": ("crashed", "the process ended by itself, exit code 9", True),
    "killed": ("crashed", "killed from outside (SIGKILL)", False),
}
"""What becomes of each: status, how the cause begins, whether it is the job's own failure."""


def wait_once(begun: Path) -> None:
    """Wait for ever, unless it has been begun before."""
    if not begun.exists():
        begun.touch()
        time.sleep(3600)


def killed_once(begun: Path) -> None:
    """Be killed as by a system that runs out of memory, unless it has been begun before."""
    if not begun.exists():
        begun.touch()
        os.kill(os.getpid(), signal.SIGKILL)


def wait_for_another(told: Path) -> None:
    """Start a process that does not end, tell its number, and wait for it."""
    with subprocess.Popen(("sleep", "3600")) as other:
        told.write_text(str(other.pid))


def poisoned(work: Work) -> Record:
    """Run a job in a child, doing what its first setting says."""
    kind = work.settings[0]
    if kind == ONCE:
        wait_once(Path(f"{work.draft}.begun"))
    if kind == PARENT:
        wait_for_another(Path(f"{work.draft}.started"))
    if kind == KILLED_ONCE:
        killed_once(Path(work.file).with_name(f"{work.job}.begun"))
    if kind in {GOOD, ONCE, KILLED_ONCE}:
        with patch.object(guard, "_ended", _made):
            return guard.run(work)

    def act(_work: Work, _named: Named) -> ReadJob:
        ACTS[kind]()
        raise ValueError(f"{kind} has done no harm")

    with patch.object(guard, "_read", act):
        return guard.run(work)


def _made(work: Work, _named: Named) -> tuple[Record, Files]:
    return Record("made", "", 0.0, (), "", own=True), {"report.json": work.job.encode()}


ENDLESS = {"loop", "sleep", "stopped"}


def work(folder: Path, number: int, kind: str = GOOD, wall_s: float | None = None) -> Work:
    """Return a job of a kind; one that ends by itself may take as long as a busy machine needs."""
    limits = Limits(wall_s or (WALL_S if kind in ENDLESS else 60.0), MEMORY)
    return Work(f"job-{number}", str(folder / "job.toml"), None, b"", (kind,), (), str(folder / f"{number}"), limits)


def ends(_work: Work) -> NoReturn:
    """End the child, whatever the job."""
    os.abort()
