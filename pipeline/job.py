"""A job ready to run: the tables of the file turned into the values that the stages take."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from hashlib import sha256
from typing import TYPE_CHECKING

from msgspec import structs

from pipeline.decode import canonical
from pipeline.dxftables import machine_of
from pipeline.helps import help_notes, helps_of
from pipeline.jobfile import JobFile, MaterialTable, ReadJob
from pipeline.materials import Sourced, look_up
from pipeline.plaintext import plain
from pipeline.processes import limits
from pipeline.processtables import ProcessTable
from pipeline.provenance import Limit, limits_of
from pipeline.rates import Rates, rates_of
from pipeline.stock import options_of, stock_of
from stages.model.cutfile import Machine
from stages.model.kfactor import KFactor
from stages.model.material import Material, Part
from stages.model.process import Process
from stages.model.report import Finding
from stages.model.sheet import NestOptions, Sheet
from stages.model.tolerances import Tolerances

if TYPE_CHECKING:
    from hashlib import _Hash as Hash

    from pipeline.layouts import Stored
    from stages.geometry.mesh.mesh import Mesh


@dataclass(frozen=True, slots=True)
class Job:
    """One job; the stages see nothing else.

    name: of the job, or of its file.
    digest: sha256 of the values of the job file and of the drawings and meshes it points at; layout and comments do not
        count.
    limits: what the parts are held against, and who said so.
    inputs: name and sha256 of the job file and of every file that it points at.
    repairs: what of the stock had to be put right.
    notes: what was assumed where the job file leaves a choice, and the repairs in words.
    layout: where copies lie already; None: nothing is said.
    rates: what cutting takes and what is left over is worth.
    """

    name: str
    parts: tuple[Part, ...]
    material: Material
    stock: tuple[Sheet, ...] = ()
    repairs: tuple[Finding, ...] = ()
    process: Process = field(default_factory=Process)
    options: NestOptions = field(default_factory=NestOptions)
    tolerances: Tolerances = field(default_factory=Tolerances)
    machine: Machine = field(default_factory=Machine)
    formats: tuple[str, ...] = ()
    customer: str | None = None
    revision: str | None = None
    units: str = "mm"
    digest: str = ""
    limits: tuple[Limit, ...] = ()
    inputs: tuple[tuple[str, str], ...] = ()
    notes: tuple[str, ...] = ()
    layout: "Stored | None" = None
    rates: Rates = field(default_factory=Rates)


def job_of(read: ReadJob) -> Job:
    """Return the job that a job file describes, placed by the layout that it names; `BadInputError` for a wrong one."""
    job = _job(read)
    if read.layout is None:
        return job
    from pipeline.layoutfile import layout_of
    from pipeline.layouts import laid

    file, content = read.layout
    return laid(job, layout_of(content, file))


def _job(read: ReadJob) -> Job:
    tables = read.tables
    material, material_notes = _material(tables.material)
    process, process_notes = _process(tables.process, material)
    stock = stock_of(tables.stock, tables.material.grain)
    helps = helps_of(tables.process, process.kerf_mm, material)
    told_of_helps = help_notes(helps, process.kerf_mm, stock.sheets)
    return Job(
        name=tables.job.name or plain(read.file.stem),
        parts=tuple(_part(read, number, material, process, stock.sheets) for number in range(len(tables.part))),
        material=material,
        process=process,
        stock=stock.sheets,
        repairs=stock.repairs,
        options=options_of(tables.nest, process.kerf_mm),
        tolerances=_tolerances(tables),
        machine=replace(machine_of(tables.dxf), helps=helps),
        formats=tables.report.formats,
        customer=tables.job.customer,
        revision=tables.job.revision,
        units=tables.units,
        digest=_digest(read),
        limits=limits_of(tables, read.tolerances),
        inputs=read.inputs,
        notes=(*read.notes, *material_notes, *process_notes, *stock.told, *told_of_helps),
        rates=rates_of(tables.process, tables.nest),
    )


def _part(read: ReadJob, number: int, material: Material, process: Process, stock: Sequence[Sheet]) -> Part:
    """Return one part, with the mesh or the faces that its file holds if it is made from one."""
    spec, source = read.tables.part[number], read.meshes.get(number)
    if number in read.faces:
        return Part(spec, material, process, read.faces[number].body)
    if number in read.touched:
        return _touching(read, number, Part(spec, material, process))
    if source is None:
        return Part(spec, material, process)
    from pipeline.meshsources import doubts

    sheets = [(sheet.width_mm, sheet.height_mm) for sheet in stock]
    ended = all(not sheet.is_roll for sheet in stock)
    return Part(spec, material, process, source.mesh, doubts(source, sheets if ended else ()))


def _touching(read: ReadJob, number: int, part: Part) -> Part:
    """Return a part with the meshes that its surface points at; they need lie on no sheet."""
    from pipeline.meshsources import doubts

    sources = read.touched[number]
    remarks = tuple(doubt for source in sources.values() for doubt in doubts(source, ()))
    return replace(part, meshes={table: source.mesh for table, source in sources.items()}, remarks=remarks)


def _digest(read: ReadJob) -> str:
    """Return the sha256 of everything that the job is made of; where copies lie does not count."""
    tables = structs.replace(read.tables, nest=structs.replace(read.tables.nest, layout=None))
    whole = sha256(canonical(tables))
    for number, source in sorted(read.meshes.items()):
        _add_mesh(whole, number, source.mesh)
    for number, faces in sorted(read.faces.items()):
        whole.update(f"{number} {faces.digest} ".encode())
    for number, sources in sorted(read.touched.items()):
        for _, source in sorted(sources.items(), key=lambda item: (item[0].file, item[0].units or "")):
            _add_mesh(whole, number, source.mesh)
    return whole.hexdigest()


def _add_mesh(whole: "Hash", number: int, mesh: "Mesh") -> None:
    whole.update(f"{number} {len(mesh.vertices)} ".encode())
    whole.update(mesh.vertices.astype("<f8").tobytes())
    whole.update(mesh.faces.astype("<i8").tobytes())


def _material(table: MaterialTable) -> tuple[Material, tuple[str, ...]]:
    """Return the sheet with the table's values overridden by those given, and notes."""
    row, notes = look_up(table.name) if table.name else (None, ())
    thickness = _float(table.thickness)
    radius = _float(table.bend_radius_min)
    if radius is None and row is not None and thickness is not None:
        radius = row.bend_radius_ratio.value * thickness
    density, strain = _float(table.density), _float(table.max_strain)
    strength, modulus = _float(table.yield_strength), _float(table.youngs_modulus)
    if row is not None:
        density = row.density.value if density is None else density
        strain = row.max_strain.value if strain is None else strain
        strength = _or_table(strength, row.yield_strength)
        modulus = _or_table(modulus, row.youngs_modulus)
    return Material(table.name, thickness, density, radius, strain, _k_factor(table), strength, modulus), notes


def _or_table(given: float | None, sourced: Sourced | None) -> float | None:
    return given if given is not None or sourced is None else sourced.value


def _k_factor(table: MaterialTable) -> KFactor:
    """Return the rule for K, as the job gives it or that of rolled work."""
    if table.k_factor is None:
        return KFactor()
    if isinstance(table.k_factor, str):
        return KFactor(table.k_factor, given=True)
    if isinstance(table.k_factor, tuple):
        return KFactor(tuple((float(ratio), float(k)) for ratio, k in table.k_factor), given=True)
    return KFactor(float(table.k_factor), given=True)


def _process(table: ProcessTable, material: Material) -> tuple[Process, tuple[str, ...]]:
    """Return the process with the limits that it sets at that thickness, and a note where that is not known."""
    thickness = material.thickness_mm
    known = {name: limit.value for name, limit in limits(table, thickness).items()}
    found = Process(
        table.type or "",
        known.get("kerf"),
        known.get("min_hole"),
        known.get("min_web"),
        refuses_narrow=table.on_narrow == "refuse",
        slat_pitch_mm=_float(table.slat_pitch),
        compensated=table.kerf_compensation == "offset",
        tabs=helps_of(table, None, material).tabs,
    )
    if table.type is None:
        return found, ()
    note = f"no thickness is known: the limits of {table.type} are those of the thinnest sheet"
    return found, (note,) if thickness is None else ()


def _float(value: Fraction | None) -> float | None:
    return None if value is None else float(value)


def _tolerances(tables: JobFile) -> Tolerances:
    table = tables.tolerance
    return Tolerances(
        accept=table.accept, chord_mm=float(table.chord), join_mm=float(table.join), normalise=table.normalise
    )
