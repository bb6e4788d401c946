"""What the adapters share: the task from standard input, layouts as lines of JSON on standard output, the probes.

Adapters are scripts, run by the Python of the environment that holds the rival; they import nothing of planish.
"""

import contextlib
import json
import math
import os
import sys
import time
from collections.abc import Callable, Iterator

Ring = list[tuple[float, float]]
Table = dict[str, object]

LIKELY, WIDER = 0.75, 1.2
"""Density aimed at by the first probe, and how much wider the next is while none succeeded."""
PROBES, LEAST_S = 8, 1.0
"""A probe takes this share of the time, and not less than so many seconds."""
NEAR = 1e-3
"""The search ends where the widths known to do and not to do are this near."""


def task() -> dict:
    """Return the task; what the rival prints meanwhile goes to standard error."""
    return json.load(sys.stdin)


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Turn standard output to standard error, the C level included."""
    sys.stdout.flush()
    kept = os.dup(1)
    os.dup2(2, 1)
    try:
        yield
    finally:
        sys.stdout.flush()
        os.dup2(kept, 1)
        os.close(kept)


def say(**answer: object) -> None:
    """Tell a layout (`placed`), an `error`, or what the rival is `unable` to do."""
    print(json.dumps(answer), flush=True)


def spot(part: str, sheet: tuple[str, int], at: tuple[float, float], angle_deg: float) -> Table:
    """Return one copy as the benchmark reads it; a sheet is its stock and a number."""
    return {"part": part, "stock": sheet[0], "sheet": sheet[1], "x": at[0], "y": at[1], "angle_deg": angle_deg}


def equal_steps(angles: list[float]) -> int:
    """Return the largest number of equal steps of a turn, from 0, that are all among the angles."""
    allowed = {round(angle % 360.0, 6) for angle in angles}
    counts = range(1, len(allowed) + 1)
    return max([1, *(n for n in counts if {round(k * 360.0 / n, 6) for k in range(n)} <= allowed)])


def area(ring: Ring) -> float:
    """Return the area of a polygon."""
    return abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(ring, ring[1:] + ring[:1], strict=True))) / 2.0


def parts_area(given: dict) -> float:
    """Return the area of all copies without their holes."""
    return sum((area(one["outer"]) - sum(map(area, one["holes"]))) * one["count"] for one in given["parts"])


def sheets_enough(given: dict, bed: dict) -> int:
    """Return how many of a bed there are, or a number that will do."""
    if bed["count"] is not None:
        return bed["count"]
    return 3 + 2 * math.ceil(parts_area(given) / (area(bed["outer"]) - sum(map(area, bed["blocked"]))))


def turned(ring: Ring, angle_deg: float) -> Ring:
    """Return a polygon turned about the origin."""
    c, s = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    return [(c * x - s * y, s * x + c * y) for x, y in ring]


def most_x(given: dict, placed: list[Table]) -> float:
    """Return the largest x of all placed parts."""
    rings = {one["id"]: one["outer"] for one in given["parts"]}
    return max(x + one["x"] for one in placed for x, _ in turned(rings[one["part"]], one["angle_deg"]))


def narrowest(given: dict, fill: Callable[[float, float], list[Table]]) -> None:
    """Tell ever shorter layouts of a strip, for an engine that fills a rectangle: bisection on its width.

    fill(width, seconds) returns the copies it placed in a rectangle from the origin, shifted as the strip wants them.
    """
    low_y, high_y, least_x = given["strip"]
    copies, end = sum(one["count"] for one in given["parts"]), time.monotonic() + given["seconds"]
    low, high = parts_area(given) / (high_y - low_y), math.inf
    width = low / LIKELY
    each = max(LEAST_S, given["seconds"] / PROBES)
    while (left := end - time.monotonic()) > LEAST_S / 2.0 and high - low > NEAR * low:
        placed = fill(width, min(each, left))
        if len(placed) == copies:
            say(placed=placed)
            high = min(width, most_x(given, placed) - least_x)
        else:
            low = max(low, width)
        width = (low + high) / 2.0 if high < math.inf else width * WIDER
