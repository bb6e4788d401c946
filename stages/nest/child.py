"""Start the engine, collect its layouts until a wall-clock limit, and leave no child behind.

The child speaks lines of JSON.  Whatever it does (crash, hang, nonsense) ends as an `EngineError`; a layout that came
before the end of the time is used even if the child had to be killed.
"""

import json
import subprocess
import sys
import threading
from collections.abc import Sequence
from dataclasses import dataclass, field
from time import monotonic

from stages.nest.separation.problem import NOWHERE, Kind, Spot
from stages.nest.separation.wire import Request, as_spot, request_line

ENGINE = (sys.executable, "-P", "-m", "stages.nest.separation.worker")
"""The command of the engine; without the current folder in the search path of modules."""

POLL_S = 0.1
"""How long to wait in one go: Ctrl-C is noticed in between, on every system."""

READY_S = 240.0
"""How long the engine may take to be ready: once on a machine it is compiled, for some 20 s of a free core."""

FAR_MM = 1e9
"""No item lies so far from the origin of its bin; what does would upset whoever measures it."""

GRACE_S = 0.5
"""What a search may take beyond its seconds before it is killed; it has told its layouts by then."""

READY = b'"ready"'


class EngineError(Exception):
    """The engine gave nothing that can be used; the message says what it did instead."""


@dataclass(slots=True)
class Told:
    """What the engine has said so far, and when it was ready."""

    lines: list[bytes] = field(default_factory=list)
    ready: float | None = None


def solve(request: Request, told: Told, command: Sequence[str] = ENGINE, ready_s: float = READY_S) -> None:
    """Have a problem searched for its seconds; what the engine says is in `told`, also after Ctrl-C.

    Raises EngineError if it cannot be started.
    """
    line = request_line(request)
    try:
        child = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, bufsize=0
        )
    except OSError as error:
        raise EngineError(f"it could not be started: {error}") from error
    talk = threading.Thread(target=_talk, args=(child, line, told), daemon=True)
    start = monotonic()
    try:
        talk.start()
        while talk.is_alive() and monotonic() < _end(told, start, request.seconds, ready_s):
            talk.join(POLL_S)
    finally:
        child.kill()
        child.wait()
        talk.join()
        for pipe in (child.stdin, child.stdout):
            if pipe:
                pipe.close()


def _end(told: Told, start: float, seconds: float, ready_s: float) -> float:
    """Return when the child is killed: its time counts from when it is ready."""
    return start + ready_s if told.ready is None else told.ready + seconds + GRACE_S


def _talk(child: "subprocess.Popen[bytes]", line: bytes, told: Told) -> None:
    """Write the request and collect the answers until the child ends."""
    if child.stdin is None or child.stdout is None:
        return
    try:
        rest = memoryview(line)
        while rest:
            rest = rest[child.stdin.write(rest) :]
    except OSError:
        return
    pending = b""
    while block := child.stdout.read(1 << 16):
        *whole, pending = (pending + block).split(b"\n")
        if told.ready is None and any(READY in one for one in whole):
            told.ready = monotonic()
        told.lines.extend(one for one in whole if READY not in one)


def layouts(told: Told, request: Request) -> list[tuple[Spot, ...]]:
    """Return the layouts that were told in full, the best (the last) first.

    Raises EngineError if the engine failed, or said what makes no sense, and told none.
    """
    error, found = None, []
    for line in reversed(told.lines):
        try:
            read = json.loads(line)
            if "error" in read:
                error = str(read["error"])
                continue
            spots = tuple(as_spot(row) for row in read["placed"])
        except (ValueError, TypeError, KeyError):
            error = "its answer makes no sense"
            continue
        if _sensible(spots, request):
            found.append(spots)
        else:
            error = "its answer makes no sense"
    if told.ready is None and not found:
        error = error or "it ended, or ran out of time, before it was ready"
    if error is not None and not found:
        raise EngineError(error)
    return found


def last_words(told: Told) -> str | None:
    """Return what the engine ended with if it failed, whatever layouts it had told before."""
    try:
        read = json.loads(told.lines[-1]) if told.lines else None
    except ValueError:
        return None
    return str(read["error"]) if isinstance(read, dict) and "error" in read else None


def _sensible(spots: Sequence[Spot], request: Request) -> bool:
    """Return whether every item is placed, as one of its kinds, in a bin that there is, and where it may lie in it."""
    kinds, items, bins = request.problem.kinds, request.problem.items, request.problem.bins
    return len(spots) == len(items) and all(
        0 <= spot.bin < len(bins)
        and spot.kind in (item.kind, item.other)
        and _may_lie(kinds[spot.kind], spot.bin)
        and max(abs(spot.x), abs(spot.y)) <= FAR_MM
        for spot, item in zip(spots, items, strict=True)
    )


def _may_lie(kind: Kind, bin_: int) -> bool:
    """Return whether a kind may lie in a bin in any angle."""
    return kind.regions[bin_] != NOWHERE and bool(kind.spans[bin_])
