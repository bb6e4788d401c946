"""The search in a process of its own: one request in, every better layout out, as lines of JSON.

The first line it says is `{"ready": true}`: kernels that have to be compiled first, once on a machine, cost none of the
time.  It ends by itself when its standard input closes, so it never outlives the one that started it.

Answers: {"placed": [[bin, kind, angle in degrees, x, y], ...]} by item, better ones later; {"error"} if it failed.
"""

import json
import os
import signal
import sys
import threading
from collections.abc import Sequence
from dataclasses import replace
from time import monotonic

from numba import config
from shapely import box

from stages.nest.separation.problem import RECTANGLE, Item, Kind, Problem, Spot
from stages.nest.separation.sharing import Wish
from stages.nest.separation.strategy import improve, warm_up
from stages.nest.separation.wire import Request, as_request, spot_rows


def main() -> None:
    """Answer the one request on standard input."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    line = sys.stdin.readline()
    threading.Thread(target=_end_with_parent, daemon=True).start()
    try:
        request = as_request(line)
        ready()
        _say({"ready": True})
        answer(replace(request, threads=min(request.threads, cores())))
    except Exception as error:
        _say({"error": f"{type(error).__name__}: {error}"})
    sys.stdout.flush()
    os._exit(0)


def cores() -> int:
    """Return how many threads may search: the cores of this process, or fewer where numba was told so from outside."""
    usable, told = config.NUMBA_DEFAULT_NUM_THREADS, config.NUMBA_NUM_THREADS  # type: ignore[attr-defined]
    return max(min(int(usable), int(told)), 1)


def answer(request: Request) -> None:
    """Tell every better layout until the time of the request is over."""
    end = monotonic() + request.seconds
    held = {spot.bin for item, spot in zip(request.problem.items, request.start, strict=True) if item.fixed}
    wish = Wish(
        end, request.settled, request.threads, request.seed, request.cost, request.area, request.rectangle, tuple(held)
    )
    improve(request.problem, request.start, wish, tell)


def tell(spots: Sequence[Spot]) -> None:
    """Say a layout."""
    _say({"placed": spot_rows(spots)})


def ready() -> None:
    """Have all kernels compiled: two squares on one spot of a strip, parted."""
    square = Kind(box(-1.0, -1.0, 1.0, 1.0), (((0.0, 0.0),),), (RECTANGLE,))
    problem = Problem((square,), (Item(0, 0), Item(0, 0)), ((8.0, 3.0),))
    warm_up(problem, (Spot(0, 0, 0.0, 2.0, 1.5), Spot(0, 0, 0.0, 2.5, 1.5)))


def _end_with_parent() -> None:
    sys.stdin.read()
    os._exit(1)


def _say(answer_: dict[str, object]) -> None:
    sys.stdout.write(json.dumps(answer_) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
