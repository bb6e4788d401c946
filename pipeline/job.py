"""A job ready to run: the tables of the file turned into the values that the stages take."""

from dataclasses import dataclass, field
from fractions import Fraction
from hashlib import sha256

from pipeline.decode import canonical
from pipeline.jobfile import JobFile, MaterialTable, ReadJob, Rotations
from pipeline.materials import look_up
from pipeline.provenance import Limit, limits_of
from stages.model.cutfile import Machine
from stages.model.material import Material, Part
from stages.model.sheet import NestOptions, Sheet
from stages.model.tolerances import Tolerances


@dataclass(frozen=True, slots=True)
class Job:
    """One job; the stages see nothing else.

    name: of the job, or of its file.
    digest: sha256 of the values of the job file and of the drawings it points at; layout and comments do not count.
    limits: what the parts are held against, and who said so.
    inputs: name and sha256 of the job file and of every drawing that it points at.
    notes: what was assumed where the job file leaves a choice.
    """

    name: str
    parts: tuple[Part, ...]
    material: Material
    stock: tuple[Sheet, ...] = ()
    options: NestOptions = field(default_factory=NestOptions)
    tolerances: Tolerances = field(default_factory=Tolerances)
    machine: Machine = field(default_factory=Machine)
    pictures: bool = False
    customer: str | None = None
    revision: str | None = None
    units: str = "mm"
    digest: str = ""
    limits: tuple[Limit, ...] = ()
    inputs: tuple[tuple[str, str], ...] = ()
    notes: tuple[str, ...] = ()


def job_of(read: ReadJob) -> Job:
    """Return the job that a job file describes."""
    tables = read.tables
    material, material_notes = _material(tables.material)
    return Job(
        name=tables.job.name or read.file.stem,
        parts=tuple(Part(spec, material) for spec in tables.part),
        material=material,
        stock=_stock(tables),
        options=_options(tables),
        tolerances=_tolerances(tables),
        machine=Machine(tables.dxf.flavour, tables.dxf.version),
        pictures="png" in tables.report.formats,
        customer=tables.job.customer,
        revision=tables.job.revision,
        units=tables.units,
        digest=sha256(canonical(tables)).hexdigest(),
        limits=limits_of(tables),
        inputs=read.inputs,
        notes=(*read.notes, *material_notes),
    )


def _material(table: MaterialTable) -> tuple[Material, tuple[str, ...]]:
    """Return the sheet with the table's values overridden by those given, and notes."""
    row, notes = look_up(table.name) if table.name else (None, ())
    thickness = _float(table.thickness)
    radius = _float(table.bend_radius_min)
    if radius is None and row is not None and thickness is not None:
        radius = row.bend_radius_ratio.value * thickness
    density, strain = _float(table.density), _float(table.max_strain)
    if row is not None:
        density = row.density.value if density is None else density
        strain = row.max_strain.value if strain is None else strain
    return Material(table.name, thickness, density, radius, strain), notes


def _float(value: Fraction | None) -> float | None:
    return None if value is None else float(value)


def _stock(tables: JobFile) -> tuple[Sheet, ...]:
    return tuple(
        Sheet(row.id, float(row.width), float(row.height), row.quantity, float(row.edge_gap), _float(row.price))
        for row in tables.stock
    )


def _options(tables: JobFile) -> NestOptions:
    nest = tables.nest
    return NestOptions(float(nest.gap), _angles(nest.rotations), float(nest.time_limit), nest.seed)


def _angles(rotations: Rotations) -> tuple[float, ...] | None:
    return None if isinstance(rotations, str) else tuple(float(angle) for angle in rotations)


def _tolerances(tables: JobFile) -> Tolerances:
    table = tables.tolerance
    return Tolerances(
        accept=table.accept, chord_mm=float(table.chord), join_mm=float(table.join), normalise=table.normalise
    )
