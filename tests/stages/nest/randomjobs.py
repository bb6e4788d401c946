"""Random jobs for the nest: parts of lines and arcs, holes, pairs, grain; sheets, rolls, hides, defects, zones.

As a script it nests many of them without a search, writes them, and lets the certifier judge the files as they read:

    python -m tests.stages.nest.randomjobs 1000
"""

import sys
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator, default_rng

from pipeline.certified import certified_files
from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, transform
from stages.model.cutfile import CutFile, Machine
from stages.model.pattern import Contour, FlatPattern
from stages.model.report import Finding, Outcome
from stages.model.sheet import Nesting, NestOptions, Quality, Sheet, Zone
from stages.model.tolerances import Tolerances
from stages.nest import nest
from stages.nest.gate import troubles
from stages.write.drawing import sheet_drawing
from stages.write.dxf import dxf_text
from tests.stages.nest.shapes import angle_piece, circle, contour, pattern, rectangle, ring, sector

FAILURES = frozenset({"layout-discarded", "no-layout"})
"""What the nest says where a placement of its own did not pass the certifier."""

REFUSALS = frozenset({"part-too-large", "stock-exhausted", "no-angle", "stock-no-room"})
"""What a random job may be refused for."""


@dataclass(frozen=True, slots=True)
class RandomJob:
    """What is given to the nest."""

    parts: tuple[FlatPattern, ...]
    stock: tuple[Sheet, ...]
    options: NestOptions


def random_job(seed: int, most: int = 5) -> RandomJob:
    """Return the job of a seed, of so many different parts at most; they pass the gate."""
    rng = default_rng(seed)
    stock = tuple(_sheet(rng, number) for number in range(int(rng.integers(1, 4))))
    options = NestOptions(
        gap_mm=float(rng.choice([0.0, 0.3, 2.0, 8.0])),
        rotations=_angles(rng),
        time_limit_s=0.0,
        mirror=bool(rng.random() < 0.3),
        one_direction=bool(rng.random() < 0.2),
    )
    parts = tuple(_part(rng, number) for number in range(int(rng.integers(1, most + 1))))
    return RandomJob(parts, stock, options)


def nested(job: RandomJob) -> Outcome[Nesting | None]:
    """Return the first placement of a job."""
    return nest(job.parts, job.stock, job.options, Tolerances())


def _angles(rng: Generator) -> tuple[float, ...] | None:
    lists: list[tuple[float, ...] | None] = [None, (0.0, 180.0), (0.0, 90.0, 180.0, 270.0), (0.0, 33.0)]
    return lists[int(rng.integers(len(lists)))]


def _part(rng: Generator, number: int) -> FlatPattern:
    size = float(rng.uniform(30.0, 160.0))
    shapes = [
        rectangle("p", size, size * float(rng.uniform(0.2, 1.0))),
        angle_piece("p", size, size * float(rng.uniform(0.1, 0.6))),
        sector("p", size * 0.5, size, float(rng.uniform(20.0, 200.0))),
        ring("p", size / 2.0, size * float(rng.uniform(0.1, 0.45))),
        _blob_part(rng, size),
        _blob_part(rng, size),
    ]
    qualities: list[Quality] = ["best", "any", 1, 2, 3]
    grained = rng.random() < 0.3
    return shapes[int(rng.integers(len(shapes)))].replace(
        part=f"part-{number}",
        quantity=int(rng.integers(1, 5)),
        quality=qualities[int(rng.integers(len(qualities)))],
        axis_deg=float(rng.uniform(0.0, 360.0)) if grained else None,
        axis_band_deg=float(rng.uniform(0.0, 40.0)) if grained else 0.0,
        rotations="free" if grained else None,
        pair=bool(rng.random() < 0.2),
    )


def _blob_part(rng: Generator, size: float) -> FlatPattern:
    """Return a part with a wild outline, some with a hole, that passes the gate."""
    while True:
        holes = [_blob(rng, size * 0.12, hole=True)] if rng.random() < 0.5 else []
        part = pattern("p", _blob(rng, size / 2.0), *holes)
        if not troubles([part], [Sheet("s", 1e4, 1e4)], NestOptions()):
            return part


def _blob(rng: Generator, radius: float, *, hole: bool = False, bend: float = 0.5) -> Contour:
    """Return a contour about the origin that may be hollow and has arcs either way."""
    count = int(rng.integers(3, 10))
    angle = (np.arange(count) + rng.uniform(-0.3, 0.3, count)) * 2.0 * np.pi / count
    reach = radius * rng.uniform(0.45, 1.0, count)
    corners = list(zip((reach * np.cos(angle)).tolist(), (reach * np.sin(angle)).tolist(), strict=True))
    bulges = np.where(rng.random(count) < 0.5, rng.uniform(-bend, bend, count), 0.0).tolist()
    return contour(corners, bulges, hole=hole)


def _sheet(rng: Generator, number: int) -> Sheet:
    width, height = rng.uniform(300.0, 900.0), rng.uniform(200.0, 500.0)
    edge = float(rng.choice([0.0, 3.0, 10.0]))
    grain = float(rng.uniform(0.0, 180.0)) if rng.random() < 0.7 else None
    plain = Sheet(f"stock-{number}", float(width), float(height), edge_gap_mm=edge, grain_deg=grain)
    sort = int(rng.integers(4))
    if sort == 0:
        return replace(plain, width_mm=np.inf, kind="roll", quantity=1)
    if sort == 1:
        return replace(plain, kind="remnant", quantity=2)
    spoiled = replace(plain, defects=_spots(rng, plain, 2), zones=_zones(rng, plain))
    return spoiled if sort == 2 else _hide(rng, spoiled)


def _hide(rng: Generator, spoiled: Sheet) -> Sheet:
    """Return a sheet with an outline that passes the gate."""
    while True:
        path = transform(_blob(rng, 450.0, bend=0.3).path, Rigid2(300.0, 200.0))
        hide = replace(spoiled, kind="hide", outline=path, quantity=3)
        if not troubles([], [hide], NestOptions()):
            return hide


def _spots(rng: Generator, sheet: Sheet, most: int) -> tuple[ArcPath, ...]:
    def spot() -> ArcPath:
        path = circle(float(rng.uniform(3.0, 60.0))).path if rng.random() < 0.5 else _simple(rng)
        return transform(path, Rigid2(*rng.uniform((0.0, 0.0), (sheet.width_mm, sheet.height_mm)).tolist()))

    return tuple(spot() for _ in range(int(rng.integers(0, most + 1))))


def _simple(rng: Generator) -> ArcPath:
    """Return a small outline without arcs, which does not cross itself."""
    return _blob(rng, 60.0, bend=0.0).path


def _zones(rng: Generator, sheet: Sheet) -> tuple[Zone, ...]:
    return tuple(Zone(path, int(rng.integers(0, 4))) for path in _spots(rng, sheet, 3))


def read_back(job: RandomJob, nesting: Nesting) -> tuple[Finding, ...]:
    """Return what the certifier finds in the drawings of a nest as their texts read."""
    by_name, machine = {part.part: part for part in job.parts}, Machine()
    drawings = [sheet_drawing(layout, by_name, machine) for layout in nesting.layouts]
    files = [CutFile(drawing.path, dxf_text(drawing, machine)) for drawing in drawings]
    return certified_files(files, nesting, job.parts, job.options)[1]


def verdict(seed: int) -> tuple[str, list[str]]:
    """Return what became of the job of a seed, in a word or two, and what the certifier has against it."""
    job = random_job(seed)
    outcome = nested(job)
    codes = {finding.code for finding in outcome.report.findings}
    if codes & FAILURES:
        return "failed", [finding.message for finding in outcome.report.findings]
    if outcome.product is None:
        return f"refused: {', '.join(sorted(codes))}", []
    wrong = [finding.message for finding in read_back(job, outcome.product)]
    return ("failed as read" if wrong else "certified"), wrong


def main(arguments: Sequence[str]) -> int:
    """Nest and write random jobs; return how many failed.  An interrupted run tells how far it came."""
    count, first = int(arguments[0]) if arguments else 100, int(arguments[1]) if len(arguments) > 1 else 0
    told: Counter[str] = Counter()
    start = time.monotonic()
    try:
        for seed in range(first, first + count):
            word, wrong = verdict(seed)
            told[word] += 1
            if wrong:
                print(f"seed {seed}: {word}: {wrong}", flush=True)
    except KeyboardInterrupt:
        print("interrupted")
    print(f"{told.total()} jobs from seed {first} in {time.monotonic() - start:.0f} s: {dict(told)}")
    return told["failed"] + told["failed as read"]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
