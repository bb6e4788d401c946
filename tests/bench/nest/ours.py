"""planish in a process of its own: an instance on standard input, its layout on standard output.

Pickled in, for an instance is a value of planish; JSON out, as from any engine.
"""

import pickle
import sys
from dataclasses import replace
from time import perf_counter

import msgspec

from stages.geometry.curves.rigid import Rigid2
from stages.model.sheet import Nesting
from stages.model.tolerances import Tolerances
from stages.nest import nest
from tests.bench.nest.layouts import Said, Spot

KIB_PER_MB = 1024.0
"""Linux counts the memory of a process in KiB."""


def main() -> None:
    """Nest once and tell the layout."""
    instance, seconds, seed = pickle.load(sys.stdin.buffer)
    options = replace(instance.options, time_limit_s=seconds, seed=seed)
    start = perf_counter()
    outcome = nest(instance.patterns, instance.stock, options, Tolerances())
    took = perf_counter() - start
    said = Said(spots(outcome.product), seconds=took, memory_mb=peak_memory_mb())
    if outcome.product is None:
        said.error = "; ".join(one.message for one in outcome.report.findings if one.fatal)
    sys.stdout.write(msgspec.json.encode(said).decode() + "\n")


def spots(nesting: Nesting | None) -> list[Spot]:
    """Return every placement as an engine tells it."""
    return [
        Spot(one.part, layout.sheet.id, layout.index, *_pose(one.motion))
        for layout in (nesting.layouts if nesting else ())
        for one in layout.placements
    ]


def _pose(motion: Rigid2) -> tuple[float, float, float, bool]:
    return motion.x, motion.y, motion.angle_deg, motion.mirrored


def peak_memory_mb() -> float | None:
    """Return the most memory that this process or one of its children has used; None where it cannot be asked."""
    try:
        import resource
    except ImportError:
        return None
    each = (resource.getrusage(who).ru_maxrss for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return max(each) / KIB_PER_MB


if __name__ == "__main__":
    main()
