"""Random good jobs, to see that reading back raises no false alarm: `python -m tests.stages.write.goodjobs 300`.

A job is a star-shaped part with round holes and a mark, two copies of it on a sheet, in a flavour and version, and by
turns with offset contours, start points, leads and tabs.
"""

import sys
from collections.abc import Iterator

import numpy as np

from stages.geometry.curves.rigid import Rigid2
from stages.model.cutfile import PROFILES, Machine
from stages.model.helps import Helps, Lead, Tabs
from stages.model.pattern import FlatPattern
from stages.model.patternlayers import PATTERN_LAYERS
from stages.model.sheet import Nesting, Placement, Sheet, SheetLayout
from stages.write import write
from stages.write.flavours import as_cut
from tests.readers.drawings import kinds
from tests.stages.write.patterns import contour, hole, line_mark, pattern, polygon_edges

PLAIN = Helps()
HELPS = (
    PLAIN,
    Helps(beam_mm=0.2, compensated=True, start="corner", lead_in=Lead("line", 2.0, 60.0)),
    Helps(beam_mm=0.2, lead_in=Lead("arc", 1.5, 90.0), tabs=Tabs(0.4, count=3)),
    PLAIN,
)


def star(rng: np.random.Generator) -> FlatPattern:
    """Return a star-shaped part of 5 to 12 corners with up to three holes about its centre, and a mark."""
    count = int(rng.integers(5, 13))
    angles = 2.0 * np.pi * (np.arange(count) + rng.uniform(-0.3, 0.3, count)) / count
    radii = rng.uniform(60.0, 100.0, count)
    corners = np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1)
    turns = rng.uniform(0.0, 2.0 * np.pi) + 2.0 * np.pi * np.arange(3) / 3.0
    holes = [hole(12.0 * np.cos(a), 12.0 * np.sin(a), rng.uniform(4.0, 8.0)) for a in turns[: rng.integers(0, 4)]]
    mark = line_mark((-10.0, 26.0), (10.0, 26.0))
    return pattern("star", contour(polygon_edges(*map(tuple, corners.tolist()))), (0.0, -26.0), *holes, marks=(mark,))


def alarms(seed: int) -> list[str]:
    """Return what stops a good job, which nothing should."""
    rng = np.random.default_rng(seed)
    flavour, version = kinds()[seed % len(kinds())]
    pattern_file = flavour == "aama"
    helps = PLAIN if pattern_file else HELPS[seed // len(kinds()) % len(HELPS)]
    layers = PATTERN_LAYERS if pattern_file else PROFILES["planish"]
    machine = Machine(flavour=flavour, version=version, helps=helps, layers=layers)
    mirrored = bool(rng.integers(0, 2))
    places = (Rigid2(120.0, 120.0, rng.uniform(0.0, 360.0)), Rigid2(360.0, 120.0, rng.uniform(0.0, 360.0), mirrored))
    copies = tuple(Placement("star", number + 1, place) for number, place in enumerate(places))
    nest = Nesting((SheetLayout(Sheet("sheet", 500.0, 250.0), 1, copies, 0.3),))
    report = write([as_cut(star(rng), machine)], nest, machine).report
    said = [finding.message for finding in report.findings if finding.fatal]
    said += [f"{metric.name} {metric.value} > {metric.limit}" for metric in report.metrics if metric.passed is False]
    return [f"{seed} {flavour} {version}: {one}" for one in said]


def every(count: int) -> Iterator[str]:
    """Yield the false alarms of so many jobs."""
    for seed in range(count):
        yield from alarms(seed)


if __name__ == "__main__":
    found = list(every(int(sys.argv[1])))
    print("\n".join([*found, f"{len(found)} false alarms"]))
