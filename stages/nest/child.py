"""Start the engine, wait for its best answer until a wall-clock limit, and leave no child behind.

The child speaks lines of JSON.  Whatever it does (crash, hang, nonsense) ends as an `EngineError`; a layout that came
before the end of the time is used even if the child had to be killed.
"""

import json
import subprocess
import sys
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from time import monotonic

ENGINE = (sys.executable, "-P", str(Path(__file__).with_name("engine.py")))
"""The command of the engine: by its path, and without its folder in the search path of modules."""


POLL_S = 0.1
"""How long to wait in one go: Ctrl-C is noticed in between, on every system."""


class EngineError(Exception):
    """The engine gave nothing that can be used; the message says what it did instead."""


@dataclass(frozen=True, slots=True)
class Item:
    """One kind of part for the engine: corners of its polygon, in mm."""

    id: str
    count: int
    angles: tuple[float, ...] | None
    points: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True)
class Request:
    """A strip of `height` to be filled with all items, `seconds` long; a width of `enough` ends the search."""

    height: float
    seconds: int
    seed: int
    enough: float
    items: tuple[Item, ...]

    def line(self) -> bytes:
        """Return the request as one line of JSON."""
        items = [{"id": one.id, "count": one.count, "angles": one.angles, "points": one.points} for one in self.items]
        fields = {"height": self.height, "seconds": self.seconds, "seed": self.seed, "enough": self.enough}
        return json.dumps({**fields, "items": items}).encode() + b"\n"


@dataclass(frozen=True, slots=True)
class Spot:
    """Where the engine puts a part: turned about the origin of its polygon, then moved."""

    id: str
    angle_deg: float
    x: float
    y: float


def solve(request: Request, wall_s: float, command: Sequence[str] = ENGINE) -> tuple[Spot, ...]:
    """Return the narrowest layout the engine finds within the time.

    Raises EngineError if there is none.
    """
    try:
        child = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, bufsize=0
        )
    except OSError as error:
        raise EngineError(f"it could not be started: {error}") from error
    answers: list[bytes] = []
    talk = threading.Thread(target=_talk, args=(child, request.line(), answers), daemon=True)
    try:
        talk.start()
        end = monotonic() + wall_s
        while talk.is_alive() and monotonic() < end:
            talk.join(POLL_S)
    finally:
        child.kill()
        child.wait()
        talk.join()
        for pipe in (child.stdin, child.stdout):
            if pipe:
                pipe.close()
    return _best(answers, {one.id: one.count for one in request.items})


def _talk(child: "subprocess.Popen[bytes]", line: bytes, answers: list[bytes]) -> None:
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
        answers.extend(whole)


def _best(answers: Sequence[bytes], wanted: dict[str, int]) -> tuple[Spot, ...]:
    """Return the last layout that was told in full."""
    if not answers:
        raise EngineError("it ended, or ran out of time, without a layout")
    error = "its answer makes no sense"
    for answer in reversed(answers):
        try:
            read = json.loads(answer)
            if "error" in read:
                error = str(read["error"])
                continue
            spots = tuple(Spot(str(id_), float(angle), float(x), float(y)) for id_, angle, x, y in read["placed"])
        except (ValueError, TypeError, KeyError):
            continue
        if _sensible(spots, wanted):
            return spots
    raise EngineError(error)


def _sensible(spots: Sequence[Spot], wanted: dict[str, int]) -> bool:
    """Return whether exactly what was asked for is placed, at finite places."""
    count = dict.fromkeys(wanted, 0)
    for spot in spots:
        if spot.id not in count or not all(map(isfinite, (spot.angle_deg, spot.x, spot.y))):
            return False
        count[spot.id] += 1
    return count == wanted
