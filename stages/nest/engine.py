"""The strip packing engine in a process of its own: one request in, every better layout out, as lines of JSON.

spyrrow runs in a thread here: a panic, a hang or a kill ends this process and no other.  The process ends by itself
when its standard input closes, so it never outlives the one that started it.  This file imports nothing of planish: it
is run by its path.

Request: {"height", "seconds", "seed", "enough", "items": [{"id", "count", "angles", "points"}]}.
Answers: {"width", "placed": [[id, angle in degrees, x, y], ...]}, better ones later; {"error"} if it failed.
"""

import json
import os
import signal
import sys
import threading
import time
from typing import Any

import spyrrow

POLL_S = 0.05
"""How often the progress of the engine is looked at."""

FEASIBLE = (spyrrow.ReportType.ExplFeas, spyrrow.ReportType.CmprFeas, spyrrow.ReportType.Final)


def main() -> None:
    """Answer the one request on standard input."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    request = json.loads(sys.stdin.readline())
    threading.Thread(target=_end_with_parent, daemon=True).start()
    queue = spyrrow.ProgressQueue()
    solver = threading.Thread(target=_solve, args=(request, queue), daemon=True)
    solver.start()
    least = float("inf")
    while solver.is_alive() and least > request["enough"]:
        time.sleep(POLL_S)
        least = _report_better(queue, least)
    _report_better(queue, least)
    os._exit(0)


def _end_with_parent() -> None:
    sys.stdin.read()
    os._exit(1)


def _solve(request: dict[str, Any], queue: spyrrow.ProgressQueue) -> None:
    """Run the engine; a panic is no Exception, so everything is caught and told."""
    try:
        items = [_item(one) for one in request["items"]]
        instance = spyrrow.StripPackingInstance("strip", request["height"], items)
        config = spyrrow.StripPackingConfig(
            total_computation_time=request["seconds"], num_workers=1, seed=request["seed"]
        )
        _say(_answer(instance.solve(config, progress=queue)))
    except BaseException as error:
        _say({"error": f"{type(error).__name__}: {error}"})


def _item(one: dict[str, Any]) -> spyrrow.Item:
    return spyrrow.Item(one["id"], [(x, y) for x, y in one["points"]], one["count"], one["angles"])


def _report_better(queue: spyrrow.ProgressQueue, least: float) -> float:
    """Tell the narrowest new layout if it is narrower than all before, and return the least width."""
    feasible = [solution for kind, solution in queue.drain() if kind in FEASIBLE]
    best = min(feasible, key=lambda solution: solution.width, default=None)
    if best is None or best.width >= least:
        return least
    _say(_answer(best))
    return float(best.width)


def _answer(solution: spyrrow.StripPackingSolution) -> dict[str, Any]:
    placed = [[one.id, one.rotation, *one.translation] for one in solution.placed_items]
    return {"width": solution.width, "placed": placed}


def _say(answer: dict[str, Any]) -> None:
    sys.stdout.write(json.dumps(answer) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
