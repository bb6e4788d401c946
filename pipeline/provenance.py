"""Where a report comes from: digests of input, tables and code, and the source of every limit.

Whoever signs a report can tell from this block what was judged, by which program, against which numbers, and who chose
them.  The digest of the input is that of its values: layout and comments of the job file do not count (the file's own
digest is told in `run`, as the file is of this run and not of the job).  A limit that the job gives is the job's, even
where planish takes the same.  Same job and same program, same block.
"""

from collections.abc import Container, Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import PurePath
from platform import python_version

from pipeline import __version__
from pipeline.jobfile import JobFile, MaterialTable, ToleranceTable
from pipeline.materials import MaterialRow, look_up
from pipeline.processes import limits
from stages.model.tolerances import STRAIN_LIMIT, WARP_LIMIT_DEG, Tolerances

LIBRARIES = ("ezdxf", "numba", "numpy", "scipy", "shapely", "trimesh")
"""What reads, computes or writes numbers of a report beside planish itself."""
CAD_LIBRARIES = {
    "cadquery-ocp-novtk": (".step", ".stp", ".iges", ".igs"),
    "rhino3dm": (".3dm",),
}
"""The distributions that read CAD files, an extra, by the ends of their names: told where a job points at one."""
PACKAGES = ("pipeline", "stages")
JOB = "job file"
DEFAULT = "default of planish"


@dataclass(frozen=True, slots=True)
class Limit:
    """A number that something is held against, and who said so."""

    name: str
    value: float
    unit: str
    source: str

    def row(self) -> dict[str, object]:
        """Return it for a report."""
        return {"name": self.name, "value": self.value, "unit": self.unit, "source": self.source}


def provenance(digest: str, limits: tuple[Limit, ...]) -> dict[str, object]:
    """Return the block of a report for a job with this digest and these limits."""
    return {
        "input": {"values_sha256": digest},
        "tables": [{"name": name, "sha256": found} for name, found in tables()],
        "code": {"version": __version__, "sha256": code_digest()},
        "limits": [limit.row() for limit in limits],
    }


def environment(inputs: Iterable[str] = ()) -> dict[str, str]:
    """Return the versions of the interpreter and of the libraries that compute: for `run`.

    inputs: names of the files that the job is made of.
    """
    ends = {PurePath(name).suffix.lower() for name in inputs}
    readers = [library for library, suffixes in CAD_LIBRARIES.items() if ends.intersection(suffixes)]
    return {"python": python_version(), **{name: _version(name) for name in (*LIBRARIES, *readers)}}


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


@cache
def tables() -> tuple[tuple[str, str], ...]:
    """Return name and sha256 of every table that comes with the program."""
    data = sorted(files("pipeline").joinpath("data").iterdir(), key=lambda file: file.name)
    return tuple((file.name, _digest(file)) for file in data if file.name.endswith(".toml"))


@cache
def code_digest() -> str:
    """Return one sha256 over the names and texts of all modules: the same on every machine for the same code."""
    whole = sha256()
    for package in PACKAGES:
        for path, file in sorted(_modules(files(package), package)):
            whole.update(f"{path} {_digest(file)}\n".encode())
    return whole.hexdigest()


def _modules(folder: Traversable, path: str) -> Iterator[tuple[str, Traversable]]:
    for entry in folder.iterdir():
        below = f"{path}/{entry.name}"
        if entry.is_dir():
            yield from _modules(entry, below)
        elif entry.name.endswith(".py"):
            yield below, entry


def _digest(file: Traversable) -> str:
    """Return the sha256 of a text, whatever its line ends."""
    return sha256(file.read_bytes().replace(b"\r\n", b"\n")).hexdigest()


def limits_of(job: JobFile, stated: Container[str]) -> tuple[Limit, ...]:
    """Return every number that the parts of a job are held against, with its source.

    stated: the keys of `tolerance` that the job gives: its own, even where they are what planish takes too.
    """
    row = look_up(job.material.name)[0] if job.material.name else None
    return (*_tolerances(job.tolerance, stated), *_material(job.material, row), *_process(job))


def _process(job: JobFile) -> Iterator[Limit]:
    thickness = None if job.material.thickness is None else float(job.material.thickness)
    for name, found in limits(job.process, thickness).items():
        yield Limit(name, found.value, "mm", found.source)


def _tolerances(table: ToleranceTable, stated: Container[str]) -> Iterator[Limit]:
    sources = {key: f"{JOB}, tolerance.{key}" if key in stated else DEFAULT for key in ("accept", "chord", "join")}
    by = f"class {table.accept!r}, {sources['accept']}"
    yield Limit("max_warp_deg", WARP_LIMIT_DEG[table.accept], "deg", by)
    yield Limit("max_strain", STRAIN_LIMIT[table.accept], "", by)
    yield Limit("chord", float(table.chord), "mm", sources["chord"])
    yield Limit("join", float(table.join), "mm", sources["join"])
    yield Limit("tangent_norm", Tolerances().tangent_norm, "", DEFAULT)


def _material(table: MaterialTable, row: MaterialRow | None) -> Iterator[Limit]:
    if table.thickness is not None:
        yield _given("thickness", table.thickness, "mm")
    if table.bend_radius_min is not None:
        yield _given("bend_radius_min", table.bend_radius_min, "mm")
    elif row is not None and table.thickness is not None:
        ratio = row.bend_radius_ratio
        source = f"materials.toml, {row.name}: {ratio.value:g} x thickness; {ratio.source}"
        yield Limit("bend_radius_min", ratio.value * float(table.thickness), "mm", source)
    if table.max_strain is not None:
        yield _given("outer_fibre_strain", table.max_strain, "", key="max_strain")
    elif row is not None:
        yield Limit(
            "outer_fibre_strain", row.max_strain.value, "", f"materials.toml, {row.name}: {row.max_strain.source}"
        )


def _given(name: str, value: Fraction, unit: str, key: str = "") -> Limit:
    return Limit(name, float(value), unit, f"{JOB}, material.{key or name}")
