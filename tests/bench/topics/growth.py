"""Growth: how time and memory rise with the number of patches, triangles, parts and jobs.

The exponent is that between a size and the one before: 1 is in proportion.  Caps: 1000 points of a strip, 400 000
triangles that nothing explains; a mesh that is recognised may have any number.
"""

import itertools
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from math import log, sqrt
from pathlib import Path

from pipeline.batch import journal, told
from pipeline.batch.executor import Local
from pipeline.batch.runner import Stop
from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.run import run_job
from stages.geometry.mesh.mesh import Mesh
from stages.model.tolerances import Tolerances
from stages.nest import nest
from tests.bench.batch import WORKERS, at_once, manifest, run, tell_nothing
from tests.bench.manyparts import job_text
from tests.bench.nest.instances import Instance, instance
from tests.bench.nest.made import many
from tests.bench.rows import Asked, Extent, Row
from tests.bench.surroundings import version
from tests.bench.timing import measured
from tests.bench.topics.flatteners import planish
from tests.meshes import oblique_cone, right_cone
from tests.pipeline.test_meshfiles import binary_stl

ABOUT = (
    "Whole jobs from the file to report and DXF text, without stock, but where a row says otherwise; memory beyond "
    "what the process had before. The exponent is that from the size before: 1 is in proportion. A strip has 1000 "
    "points at most; a mesh is laid flat up to 400 000 triangles, one that is recognised has no such cap. "
    "The smallest batch starts the pool, the others find it there."
)
HEAD = 'schema = 1\n[report]\nformats = ["json"]\n[[part]]\nname = "part"\n[part.surface]\n'
STRIP = 'kind = "quintic-strip"\nruling = [0, 0, 500]\nthrough = [\n'
STATION = "    {{ point = [{x}, 0, 0], tangent = [0.8, {y}, 0] }},\n"
BAY_MM = 100
"""Between two points of the wave."""
MESH = 'kind = "mesh"\nfile = "part.stl"\nunits = "mm"\n'
LONGER = 5.0
"""Cells along a mesh for each across it."""
SEED = 1

Call = Callable[[], bool]
Prepare = Callable[[Path, int], Call]
"""Return the call to be timed for a size; it tells whether all went well."""


def rows(asked: Asked) -> Iterator[Row]:
    """Yield every series."""
    for what, unit, prepare, sizes in SERIES:
        yield from series(what, unit, prepare, sizes[asked.extent], asked.rounds)


def series(what: str, unit: str, prepare: Prepare, sizes: tuple[int, ...], rounds: int) -> Iterator[Row]:
    """Yield the row of every size."""
    before: tuple[int, float] | None = None
    for size in sizes:
        with tempfile.TemporaryDirectory(prefix="planish-bench-") as name:
            took = measured(prepare(Path(name), size), rounds)
        if not took.result:
            raise RuntimeError(f"{what}, {size} {unit}: not made")
        exponent = log(took.seconds / before[1]) / log(size / before[0]) if before else None
        before = size, took.seconds
        found = version("planish")
        yield Row(
            what, f"{size} {unit}", "planish", found, exponent, "exponent", took.seconds, took.memory_mb, took.how
        )


def made(file: Path) -> bool:
    """Run a job from its file to its report and DXF text."""
    return run_job(job_of(read(file))).status == "made"


def job(folder: Path, text: str) -> Call:
    """Return the run of a job file with that text."""
    file = folder / "job.toml"
    file.write_text(text)
    return partial(made, file)


def wave(folder: Path, patches: int) -> Call:
    """Return a corrugated sheet: one patch between each two points."""
    stations = (STATION.format(x=BAY_MM * i, y="-0.6" if i % 2 else "0.6") for i in range(patches + 1))
    return job(folder, "".join([HEAD, STRIP, *stations, "]\n"]))


def cells(triangles: int) -> tuple[int, int]:
    """Return columns and rows of a mesh of about so many triangles."""
    across = max(round(sqrt(triangles / (2.0 * LONGER))), 1)
    return round(triangles / (2 * across)), across


def recognised(folder: Path, triangles: int) -> Call:
    """Return a right cone from an STL file."""
    (folder / "part.stl").write_bytes(binary_stl(right_cone(SEED, *cells(triangles)).mesh))
    return job(folder, HEAD + MESH)


def laid_flat(_folder: Path, triangles: int) -> Call:
    """Return the flattening of a mesh that nothing explains."""
    return partial(flat, oblique_cone(SEED, *cells(triangles)).mesh)


def flat(mesh: Mesh) -> bool:
    """Lay a mesh flat."""
    return len(planish(mesh)) == len(mesh.vertices)


def parts(folder: Path, count: int) -> Call:
    """Return a job of different parts."""
    return job(folder, job_text(count))


def first_layout(_folder: Path, count: int) -> Call:
    """Return the first certified layout of different parts."""
    return partial(placed, instance("first", many(count)))


def placed(one: Instance) -> bool:
    """Nest parts without searching."""
    options = replace(one.options, time_limit_s=0.0, seed=SEED)
    return nest(one.patterns, one.stock, options, Tolerances()).product is not None


def jobs(folder: Path, count: int) -> Call:
    """Return a batch of jobs that do nothing."""
    listed, number = manifest(folder, count), itertools.count()
    return lambda: batched(folder / f"out-{next(number)}", listed, count)


def batched(out: Path, listed: Path, count: int) -> bool:
    """Run a batch to its end."""
    executor = Local(WORKERS, at_once)
    run(out, listed, executor, tell_nothing, Stop())
    executor.close(now=False)
    found = told.tally(journal.reading(out), 1)
    return found.all_made and found.jobs == count


def sizes(quick: tuple[int, ...], usual: tuple[int, ...], *more: int) -> dict[Extent, tuple[int, ...]]:
    """Return the sizes by extent; more: those that take long."""
    return {"quick": quick, "usual": usual, "full": (*usual, *more)}


SERIES: tuple[tuple[str, str, Prepare, dict[Extent, tuple[int, ...]]], ...] = (
    ("patches of one strip", "patches", wave, sizes((1, 2), (1, 10, 100, 999))),
    ("mesh that is recognised", "triangles", recognised, sizes((200, 400), (1000, 10_000, 100_000), 1_000_000)),
    ("mesh laid flat, the map alone", "triangles", laid_flat, sizes((200, 400), (1000, 10_000, 100_000), 400_000)),
    ("different parts", "parts", parts, sizes((2, 4), (10, 100, 1000))),
    ("first certified layout", "parts", first_layout, sizes((2, 4), (10, 100), 1000)),
    ("batch of empty jobs", "jobs", jobs, sizes((4, 8), (10, 100, 1000, 10_000), 100_000, 1_000_000)),
)
