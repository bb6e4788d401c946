"""W1, W2, W4, W13 and W16: what tests measure on files of their own, asked of them."""

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from stages.geometry.paths.arcpath import piece_count
from stages.model.cutfile import Flavour
from tests.bench.cutfiles.rows import Row, counted
from tests.pipeline.test_same_bytes import SCRIPT
from tests.readers import test_units as units
from tests.readers.drawings import FLAVOURS, asked, kinds
from tests.readers.everyone import READERS, wrong
from tests.readers.reading import Reader
from tests.samples import SAMPLES
from tests.stages.write import test_measures as measures
from tests.stages.write.cases import Case
from tests.stages.write.goodjobs import every

GOALS: dict[Flavour, int] = {"polyline-arcs": 12, "lines-arcs": 16, "polylines": 15}
"""Readers of 16 that are to read a flavour right."""

ARCS: Case = ("polyline-arcs", "R2000")
SAME = ("bracket", "flanges", "hopper")
"""Samples of few parts, whose bytes are compared."""

PLANTED = ("faults", "faults_everywhere", "faults_flavours", "help_faults", "piecefaults", "pictureback", "finite")
GOOD_JOBS = 220


def readers() -> Iterator[Row]:
    """W1: readers that read a flavour right, in its first version, the default one in all versions."""
    here = [reader for reader in READERS if reader.available()]
    gone = ", ".join(reader.name for reader in READERS if reader not in here) or "none"
    for flavour in FLAVOURS:
        bad = [reader.name for reader in here if _faults(reader, flavour)]
        goal = GOALS.get(flavour)
        reached = f"{len(here) - len(bad)} of {len(READERS)}"
        how = f"each reader run on every kind of cut file; not installed: {gone}"
        right = goal is None or len(here) - len(bad) >= goal
        told = f"not: {', '.join(bad)}" if bad else ""
        yield Row("W1", flavour, "-" if goal is None else f">= {goal}", reached, right, "sampled", how, told)


@cache
def _faults(reader: Reader, flavour: Flavour) -> bool:
    """Return whether a reader gets anything wrong in a flavour."""
    return any(wrong(reader, *kind) for kind in asked() if kind[0] == flavour)


def unit_errors() -> Row:
    """W2: sizes in readers that know units, in every flavour and version."""
    here = [reader for reader in units.READERS if reader.available()]
    bad = []
    with tempfile.TemporaryDirectory() as folder:
        paths = {kind: Path(folder) / f"{'-'.join(kind)}.dxf" for kind in kinds()}
        for kind, path in paths.items():
            path.write_text(units.text(*kind), "ascii")
        for reader in here:
            found = reader.read(list(paths.values()))
            near = 2.0 * (reader.fineness.grid_mm + reader.fineness.stray_mm) + units.JOINED_MM
            wanted = units.WIDE_MM, units.HIGH_MM, units.LINE_MM
            for kind, path in paths.items():
                off = np.abs(np.subtract(units.sizes(found[path.stem]), wanted)).max()
                bad += [f"{reader.name} on {'-'.join(kind)}: {off:.3g} mm off"] * bool(off > near)
    how = f"a rectangle and a line of known sizes in {', '.join(reader.name for reader in here)}"
    return counted("W2", "files read in the right unit", bad, len(here) * len(paths), how)


def arcs() -> Iterator[Row]:
    """W4: arcs of three developments at a tolerance of 0.02 mm, and lines and arcs recovered one to one."""
    for name, lines, goal in (("strip", 3, 26), ("ellipse", 0, 38), ("cone", 2, 24)):
        part = next(one for one in measures.parts(ARCS) if one.part == name)
        count = piece_count(measures.outline(ARCS, part)) - lines
        how = "counted in the file; its distance to the exact curve is W3 of test_measures"
        yield Row("W4", f"arcs of the {name} at 0.02 mm", f"<= {goal}", str(count), count <= goal, "proved", how)
    wanted = {"plate": 4, "sector": 6}
    found = {part.part: piece_count(measures.outline(ARCS, part)) for part in measures.parts(ARCS)}
    bad = [f"{name}: {found[name]} instead of {count}" for name, count in wanted.items() if found[name] != count]
    yield counted("W4", "lines and arcs one to one", bad, len(wanted), "pieces of a plate and of a sector of a ring")


def same_bytes() -> Row:
    """W13: drawings of samples made in two processes with different hashes."""
    jobs = [str(SAMPLES / name / "job.toml") for name in SAME]
    one, other = (_digests(jobs, seed) for seed in ("0", "20260"))
    drawn = [key for key in one.keys() | other.keys() if key[1].startswith("flat/")]
    bad = [f"{job}: {path}" for job, path in sorted(drawn) if one.get((job, path)) != other.get((job, path))]
    how = f"sha256 of flat/ of {', '.join(SAME)} from two processes of different hash seeds"
    return counted("W13", "the same bytes", bad, len(drawn), how)


def _digests(jobs: list[str], seed: str) -> dict[tuple[str, str], str]:
    """Return the digest of every file of some jobs, made in a process with that seed of its hashes."""
    found = {}
    for job in jobs:
        surroundings = {**os.environ, "PYTHONHASHSEED": seed}
        command = [sys.executable, "-c", SCRIPT, job]
        ran = subprocess.run(command, check=True, capture_output=True, timeout=600, env=surroundings, text=True)
        for line in ran.stdout.splitlines():
            _, path, digest = line.split()
            found[Path(job).parent.name, path] = digest
    return found


def planted() -> Iterator[Row]:
    """W16: planted faults that are found, and false alarms on good jobs."""
    folder = Path(measures.__file__).parent
    files = [str(folder / f"test_{name}.py") for name in PLANTED]
    with tempfile.TemporaryDirectory() as name:
        told = Path(name) / "tests.xml"
        command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", f"--junitxml={told}", *files]
        subprocess.run(command, capture_output=True, check=False, cwd=SAMPLES.parent)
        cases = [*ElementTree.parse(told).iter("testcase")]
    bad = [case for case in cases if {one.tag for one in case} & {"failure", "error"}]
    failed = [case.get("name", "") for case in bad]
    how = f"the tests {', '.join(PLANTED)}: each breaks one thing, in every flavour and version"
    yield counted("W16", "planted faults are found", failed, len(cases), how)
    alarms = list(every(GOOD_JOBS))
    how = "random good jobs, all flavours, by turns with offset contours, leads and tabs"
    yield counted("W16", "good jobs without an alarm", alarms, GOOD_JOBS, how)
