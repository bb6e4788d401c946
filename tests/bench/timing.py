"""How long a call takes, on the clock, and how much memory it needs at its peak beside what was there before.

The first call warms up, unless it is so long that it counts: then it is the only one.  The memory is that of the last
call, by the mark of the kernel for the largest resident set (proc(5): VmHWM, reset through clear_refs), after what
earlier calls left free has been given back.  What the heap cannot give back (free, but below memory that is in use)
counts as there before, so the figure may be too small in a process that has done much else.  None where the system
does not tell it.
"""

import ctypes
import gc
from collections.abc import Callable
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Generic, NamedTuple, TypeVar

T = TypeVar("T")

LONG_S = 2.0
"""From here on a call is made once, and rounds end."""
PROC = Path("/proc/self")
PEAK = "5"
"""What resets the mark of the largest resident set, proc(5)."""
KB_PER_MB = 1024.0


class Took(NamedTuple, Generic[T]):
    """What a call returned, the median of its seconds, its memory, and of how many runs."""

    result: T
    seconds: float
    memory_mb: float | None
    how: str


def measured(call: Callable[[], T], rounds: int) -> Took[T]:
    """Return what a call returns and what it takes."""
    result, first, memory = once(call)
    if first >= LONG_S or rounds == 1:
        return Took(result, first, memory, "one run")
    times: list[float] = []
    while len(times) < rounds and sum(times) < LONG_S:
        result, seconds, memory = once(call)
        times.append(seconds)
    return Took(result, median(times), memory, f"median of {len(times)}")


def once(call: Callable[[], T]) -> tuple[T, float, float | None]:
    """Return what a call returns, its seconds and its memory."""
    before = settled_mb()
    start = perf_counter()
    result = call()
    seconds = perf_counter() - start
    after = status_mb("VmHWM")
    return result, seconds, None if before is None or after is None else after - before


def settled_mb() -> float | None:
    """Give back what is free, forget the largest resident set so far, and return the present one."""
    gc.collect()
    try:
        ctypes.CDLL(None).malloc_trim(0)
        (PROC / "clear_refs").write_text(PEAK)
    except (OSError, AttributeError, TypeError):
        return None
    return status_mb("VmRSS")


def status_mb(name: str) -> float | None:
    """Return a size of this process as the kernel tells it."""
    try:
        lines = (PROC / "status").read_text().splitlines()
    except OSError:
        return None
    found = [line.split()[1] for line in lines if line.startswith(f"{name}:")]
    return float(found[0]) / KB_PER_MB if found else None
