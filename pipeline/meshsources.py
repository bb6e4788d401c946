"""The mesh files that a job points at: found, read once, put into mm, and their units doubted where the size says so.

STL, OBJ, PLY and OFF state no unit: that of the key `units` is taken, else that of the job, with a note.  A unit is
doubted (finding `mesh-units`) where the part would be smaller than 1 mm or larger than 10 m, which shops do not make,
and, if it was assumed, where the part cannot lie on any sheet of the stock or is less than a hundredth of the
largest.  Two points of a part are in its flat pattern at least as far apart as in space, so a diagonal longer than
that of the sheet settles it.  The cures that are named are the usual slips: millimetres taken for inches or metres,
and the other way."""

from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

import numpy as np

from pipeline.decode import ResolveError
from pipeline.meshfiles import LARGEST_FILE, MeshFileError, format_of, parsed
from pipeline.reach import Reach
from pipeline.units import MM_PER
from stages.geometry.mesh.mesh import Mesh
from stages.model.meshes import MeshFile, MeshNormals
from stages.model.report import Finding

SAMPLE = "sample:"
"""Names that begin so are meshes that come with planish."""
SMALLEST_MM, LARGEST_MM = 1.0, 10_000.0
LEAST_SHARE = 0.01
"""Of the largest sheet's diagonal."""
SLIPS = (25.4, 1000.0, 1.0 / 25.4, 1.0 / 1000.0)


@dataclass(frozen=True, slots=True)
class MeshSource:
    """A mesh in mm; unit: what its numbers were in; assumed: whether that is only the job's own."""

    mesh: Mesh
    unit: str
    assumed: bool

    @property
    def size_mm(self) -> float:
        """Return the diagonal of the bounding box."""
        return float(np.linalg.norm(np.ptp(self.mesh.vertices[np.unique(self.mesh.faces)], axis=0)))


def content_of(reach: Reach, name: str) -> bytes:
    """Return the bytes of a mesh file; ResolveError where there is no such file."""
    if name.startswith(SAMPLE):
        found = files("pipeline").joinpath("data", "meshes", Path(name[len(SAMPLE) :]).name)
        if not found.is_file():
            known = sorted(file.name for file in files("pipeline").joinpath("data", "meshes").iterdir())
            raise ResolveError("file", f'no mesh "{name}" comes with planish', f"there are: {', '.join(known)}")
        return found.read_bytes()
    return reach.content(name, LARGEST_FILE, "export it coarser, or as binary STL")


def mesh_source(content: bytes, table: MeshFile | MeshNormals, job_unit: str) -> MeshSource:
    """Return the mesh of a file in mm; ResolveError where there is none, or two units contradict each other."""
    name = Path(table.file).name
    try:
        format_of(name)
        found = parsed(content, name)
    except MeshFileError as error:
        raise ResolveError("file", error.message, error.hint) from None
    if found.unit is not None and table.units not in (None, found.unit):
        raise ResolveError("units", f'"{table.units}", but {name} says {found.unit}', "leave it out")
    unit = found.unit or table.units or job_unit
    scaled = Mesh(found.mesh.vertices * float(MM_PER[unit]), found.mesh.faces)
    return MeshSource(scaled, unit, assumed=found.unit is None and table.units is None)


def doubts(source: MeshSource, sheets_mm: Sequence[tuple[float, float]]) -> tuple[Finding, ...]:
    """Return the finding that the unit of a mesh may be wrong, with what else it may be, or nothing.

    sheets_mm: width and height of every sheet of the stock.
    """
    size = source.size_mm
    sheet = max((float(np.hypot(*one)) for one in sheets_mm), default=None)
    reason = _reason(size, sheet if source.assumed else None)
    if not reason:
        return ()
    low = SMALLEST_MM if sheet is None else LEAST_SHARE * sheet
    high = LARGEST_MM if sheet is None else sheet
    likely = [slip for slip in SLIPS if low <= size * slip <= high]
    units = [unit for unit in MM_PER if any(abs(_ratio(unit, source.unit) / slip - 1.0) < ALIKE for slip in likely)]
    sizes = " or ".join(f"as {unit} it would be {size * _ratio(unit, source.unit):.4g} mm" for unit in units)
    cure = f"; {sizes}: set `units`" if units else ""
    how = "assumed to be" if source.assumed else "in"
    message = f"the mesh, {how} {source.unit}, has a diagonal of {size:.6g} mm: {reason}{cure}"
    return (Finding("mesh-units", message, False, {"size_mm": size}),)


ALIKE = 1e-6
"""Ratios of units are exact but for rounding."""


def _ratio(unit: str, other: str) -> float:
    return float(MM_PER[unit] / MM_PER[other])


def _reason(size: float, sheet: float | None) -> str:
    """Return why a size is doubtful; empty where it is not."""
    if size < SMALLEST_MM:
        return "less than 1 mm"
    if size > LARGEST_MM:
        return "more than 10 m"
    if sheet is not None and size > sheet:
        return f"no sheet of the stock, {sheet:.6g} mm at most, holds it"
    if sheet is not None and size < LEAST_SHARE * sheet:
        return f"less than a hundredth of the sheet's {sheet:.6g} mm"
    return ""
