"""Nest: what `tests/bench/nest` tells of the stored instances, in short."""

import sys
from collections.abc import Iterator

from tests.bench.nest.__main__ import once
from tests.bench.nest.engines import ENGINES, core_limit, version
from tests.bench.nest.instances import FOLDER, Instance, instance, load
from tests.bench.nest.made import ring
from tests.bench.nest.table import Row as NestRow
from tests.bench.nest.table import figure
from tests.bench.rows import Asked, Row

ABOUT = (
    "Density of the layout after the same time on the same two cores, each layout held against the certifier: area of "
    "the parts over the strip used, or over the sheets or hides, the last cut straight. Made instances (a jigsaw of 20 "
    "pieces, parts of ducts on sheets, a hide with faults and zones). Public sets: `python3 dev.py bench nest FOLDER`."
)
CORES, SEED = 2, 1
QUICK_S = 0.5
REMARK = 60
"""Letters of what an engine says instead of a layout."""


def rows(asked: Asked) -> Iterator[Row]:
    """Yield what every engine that is there reaches on every stored instance; quick: ours alone on one that is made."""
    quick = asked.extent == "quick"
    there = {one: found for one in ENGINES if (one.ours or not quick) and (found := version(one))}
    instances: list[Instance] = [instance("ring_gap2", ring())] if quick else load(FOLDER)
    with core_limit(CORES):
        for one in instances:
            for engine, found in there.items():
                print(f"{one.name}: {engine.name}", file=sys.stderr, flush=True)
                yield told(once(one, engine, found, SEED, QUICK_S if quick else asked.seconds))


def told(one: NestRow) -> Row:
    """Return a row of the nesting benchmark as one of ours; a layout that is not valid has no figure."""
    found = figure(one)
    where = "" if one.sheets <= 1 else f" on {one.sheets} sheets"
    how = f"seed {one.seed}" if found is not None else f"{one.valid}: {one.remark}"[:REMARK]
    density = None if found is None else round(100.0 * found, 2)
    return Row(
        one.instance,
        f"{one.parts} parts, {one.seconds:g} s",
        one.engine,
        one.version,
        density,
        f"%{where}",
        one.wall_s,
        one.memory_mb,
        how,
    )
