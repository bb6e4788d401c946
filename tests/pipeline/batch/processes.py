"""The processes of this machine, as Linux lists them."""

import time
from pathlib import Path


def below(parent: int) -> set[int]:
    """Return a process, all that it has started, and those that these have started."""
    parents = {int(entry.name): _parent(entry) for entry in Path("/proc").iterdir() if entry.name.isdecimal()}
    found, new = set[int](), {parent}
    while new:
        found |= new
        new = {pid for pid, its in parents.items() if its in new} - found
    return found


def _parent(entry: Path) -> int:
    try:
        return int(_fields(entry)[1])
    except OSError:
        return -1


def _fields(entry: Path) -> list[str]:
    return (entry / "stat").read_text().rpartition(")")[2].split()


def lives(pid: int) -> bool:
    """Return whether a process runs; one that is dead and not buried does not."""
    try:
        return _fields(Path(f"/proc/{pid}"))[0] not in "ZX"
    except OSError:
        return False


def alive_after(pids: set[int], seconds: float) -> set[int]:
    """Return those that still live after some time, sooner if there are none."""
    end = time.monotonic() + seconds
    while time.monotonic() < end and any(map(lives, pids)):
        time.sleep(0.05)
    return {pid for pid in pids if lives(pid)}
