"""W3 of the shop floor's measures: written drawings against the exact development, for every sample in every flavour.

Each sample is developed once and its flat patterns are written in all flavours, contours on either side of the exact
ones and outside of them.  The table shows, of each sample, the part that uses up most of its tolerance.  The distance
is found by other programs than that of the report (`tests/bench/written.py`), which must not be smaller than it.
Of a part with a corner of 0 degrees nothing lies outside within any tolerance: it is refused, and has no row.
"""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from pipeline.files import file_names
from pipeline.job import Job, job_of
from pipeline.jobfile import read
from pipeline.run import JobResult, PartRun, Runner, cut_patterns, finish, run_job
from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, transform
from stages.model.cutfile import Flavour, Machine, Side
from stages.model.pattern import FlatPattern
from stages.model.patternlayers import PATTERN_LAYERS
from stages.write.drawing import flat_drawing
from stages.write.dxf import dxf_text
from tests.bench.written import HEIGHT, HEIGHTS, Apart, apart, furthest
from tests.near import assert_near
from tests.samples import SAMPLES
from tests.stages.write.patterns import CHORD_MM, drop, plate, sector

FLAVOURS: tuple[Flavour, ...] = ("polyline-arcs", "lines-arcs", "polylines", "r12", "aama")
SIDES: tuple[Side, ...] = ("either", "outside")
OLD = {"r12", "aama"}
NEEDLES = {"paper/job"}
"""Example 1 of the paper has two corners of 0 degrees."""

SLACK = HEIGHTS * HEIGHT
"""By how much of the tolerance two measurements of one distance may differ: by their bounds."""


class Row(NamedTuple):
    """What is found of a sample in one flavour, on one side; reported: by the program itself."""

    sample: str
    flavour: str
    side: str
    found: Apart
    reported: float


def samples() -> list[Path]:
    """Return the job files of all samples."""
    return sorted(SAMPLES.glob("*/*.toml"))


def machines(usual: Machine) -> Iterator[Machine]:
    """Yield a machine for each flavour and side that goes with it."""
    for flavour in FLAVOURS:
        layers = PATTERN_LAYERS if flavour == "aama" else usual.layers
        version = "R12" if flavour in OLD else "R2000"
        for side in SIDES if flavour != "aama" else SIDES[:1]:
            yield replace(usual, flavour=flavour, version=version, layers=layers, side=side)


def developed(file: Path) -> tuple[Job, tuple[PartRun, ...]]:
    """Return a sample's job, and those of its parts that are laid flat."""
    job = replace(job_of(read(file)), stock=(), layout=None)
    return job, tuple(run for run in run_job(job).parts if run.pattern is not None)


def written(job: Job, runs: tuple[PartRun, ...], machine: Machine) -> Row | None:
    """Return what is found of the flat drawings of a job; None where it has a needle that nothing lies outside of."""
    job = replace(job, machine=machine)
    made: JobResult = finish(Runner(), job, runs)
    if machine.side == "outside" and made.write.short:
        return None
    assert made.write.status == "pass", made.write.report.findings
    texts = {file.path: file.text for file in made.write.product or ()}
    patterns = file_names(runs, job).patterns(cut_patterns(runs, job))
    found = furthest(apart(texts[f"flat/{one.part}.dxf"], machine.layers, one) for one in patterns)
    reported = next(one.value for one in made.write.report.metrics if one.name == "max_deviation_mm")
    assert isinstance(reported, float)
    return Row(job.name, machine.flavour, machine.side, found, reported)


def rows(file: Path) -> list[Row]:
    """Return what is found of a sample."""
    job, runs = developed(file)
    name = f"{file.parent.name}/{file.stem}"
    found = [written(job, runs, machine) for machine in machines(job.machine)] if runs else []
    return [row._replace(sample=name) for row in found if row is not None]


def shown(made: list[Row]) -> str:
    """Return a table."""
    head = (
        f"{'sample':20}{'flavour':15}{'side':9}{'part':22}{'apart mm':>10}{'reported':>10}{'tolerance':>10}{'share':>7}"
    )
    lines = [
        f"{row.sample:20}{row.flavour:15}{row.side:9}{row.found.part[:21]:22}{row.found.distance_mm:10.5f}"
        f"{row.reported:10.5f}{row.found.tolerance_mm:10.4g}{row.found.distance_mm / row.found.tolerance_mm:7.2f}"
        for row in made
    ]
    return "\n".join(["", head, *lines])


def drawn(pattern: FlatPattern, machine: Machine) -> str:
    return dxf_text(flat_drawing(pattern, machine), machine)


@pytest.mark.parametrize("flavour", ["polyline-arcs", "lines-arcs", "r12"])
@pytest.mark.parametrize("part", [plate(), sector(), drop()], ids=lambda part: part.part)
def test_a_drawing_that_is_moved_is_as_far_off_as_it_was_moved(part: FlatPattern, flavour: Flavour) -> None:
    machine = Machine(flavour=flavour, version="R12" if flavour in OLD else "R2000")
    near = apart(drawn(part, machine), machine.layers, part).distance_mm
    path = part.outer.path
    moved = replace(part.outer, path=transform(path, Rigid2(0.0, 10.0 * CHORD_MM)))
    far = apart(drawn(part.replace(outer=moved), machine), machine.layers, part).distance_mm
    assert near <= CHORD_MM
    assert_near(far, 10.0 * CHORD_MM, bound=near, why="as far as it was off before")


def test_a_hole_that_is_not_drawn_is_infinitely_far_off() -> None:
    whole = plate()
    text = drawn(whole.replace(inner=()), Machine())
    assert apart(text, Machine().layers, whole).distance_mm == float("inf")


def test_one_bulge_of_the_wrong_sign_is_twice_the_height_of_its_arc_off() -> None:
    ring = sector()
    flipped = ring.outer.path.bulges.copy()
    flipped[0] = -flipped[0]
    wrong = replace(ring.outer, path=ArcPath(ring.outer.path.vertices, flipped, closed=True))
    found = apart(drawn(ring.replace(outer=wrong), Machine()), Machine().layers, ring).distance_mm
    (start, end), bulge = ring.outer.path.vertices[:2], abs(flipped[0])
    assert found >= bulge * float(np.hypot(*(end - start))) / 2.0


@pytest.mark.benchmark(group="written")
def test_every_sample_in_every_flavour_is_within_its_tolerance(
    benchmark: BenchmarkFixture, capsys: pytest.CaptureFixture[str]
) -> None:
    if benchmark.disabled:
        pytest.skip("minutes, for `dev.py bench`: tests/stages/write/test_measures.py holds small parts to the same")
    made = benchmark.pedantic(lambda: [row for file in samples() for row in rows(file)], rounds=1)
    with capsys.disabled():
        print(shown(made))
    assert {row.flavour for row in made} == {*FLAVOURS}
    assert {row.sample for row in made if row.side == "outside"} == {row.sample for row in made} - NEEDLES
    for row in made:
        distance, tolerance = row.found.distance_mm, row.found.tolerance_mm
        assert distance <= (1.0 + SLACK) * tolerance, row
        assert distance <= row.reported + SLACK * tolerance, row
