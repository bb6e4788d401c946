"""The job file: its tables, and how a file becomes a `JobFile` or a list of everything that is wrong with it.

text -> plain tables (`parse`) -> `--set` -> structs, units, rules (`decode`) -> curves of DXF files (`sources`); places
of complaints are looked up last (`locate`).  The tables of parts are those of `stages.model`.  A key is here only if
this version does what it says.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Annotated, Literal, TypeVar

from msgspec import Meta, field

from pipeline.decode import MOST_COMPLAINTS, Walk, decode
from pipeline.dxftables import DxfTable
from pipeline.helps import help_troubles
from pipeline.jobrules import repeated, taken_by_blanks, too_many_copies
from pipeline.parse import DEEP, override, parse, read_bytes, refuse_huge, text_of
from pipeline.placed import placed
from pipeline.plaintext import plain
from pipeline.processtables import ProcessTable
from pipeline.reach import Reach, Seen, silent, unnoticed
from pipeline.sources import Sources, Tell
from pipeline.stocktables import NestTable, StockTable, grain_troubles, other_material
from pipeline.units import JOB_UNITS
from stages.errors import BadInputError, Problem
from stages.model.caps import MOST_PARTS, MOST_ROWS, MOST_STOCK
from stages.model.curves import Table, Trouble, negatives, not_positive
from stages.model.ducts import blank_count
from stages.model.meshes import MeshNormals
from stages.model.part import PartSpec
from stages.model.scalars import Angle, Length, Number
from stages.model.sewing import mate_troubles
from stages.model.tolerances import Class, Tolerances

if TYPE_CHECKING:
    from pipeline.cad.files import CadSource
    from pipeline.meshsources import MeshSource

T = TypeVar("T", bound=Table)
DEFAULTS = Tolerances()
Text = Annotated[str, Meta(max_length=200)]
KRows = Annotated[tuple[tuple[Number, Number], ...], Meta(min_length=1, max_length=MOST_ROWS)]


def length_mm(text: float) -> Length:
    """Return the length that a default writes."""
    return Length(repr(text))


class JobTable(Table, frozen=True, kw_only=True):
    """Whose job it is; name: also that of the default output folder, the file's own name if absent."""

    name: Annotated[str, Meta(min_length=1, max_length=80)] | None = None
    customer: Text | None = None
    revision: Text | None = None


class MaterialTable(Table, frozen=True, kw_only=True):
    """The sheet: a name of the table (`planish materials`), values of one's own, or both.

    density in kg/m3; bend_radius_min: smallest inside radius; max_strain: of the outer fibre, as a fraction.
    k_factor: distance of the neutral line from the inside face over the thickness: one value, "din6935", or rows
        [inside radius / thickness, K] with straight lines between; absent: 0.5, rolled work.
    yield_strength in MPa, youngs_modulus in GPa: for an estimate of springback.
    grain: direction of rolling, of the line of tightness of leather, in degrees from x, of stock that states none.
    """

    name: Text = ""
    thickness: Length | None = None
    density: Number | None = None
    bend_radius_min: Length | None = None
    max_strain: Number | None = None
    k_factor: Literal["din6935"] | float | KRows | None = None
    yield_strength: Number | None = None
    youngs_modulus: Number | None = None
    grain: Angle | None = None

    def troubles(self) -> Iterator[Trouble]:
        """Yield values that no sheet has."""
        yield from not_positive(self, "thickness", "density", "max_strain", "yield_strength", "youngs_modulus")
        yield from negatives(self, "bend_radius_min")
        if self.k_factor is not None and not isinstance(self.k_factor, str):
            yield from k_factor_troubles(self.k_factor)


def k_factor_troubles(k_factor: float | KRows) -> Iterator[Trouble]:
    """Yield values of K outside 0 to 1/2, and rows that are not in the order of r/t."""
    if isinstance(k_factor, float):
        yield from _unlikely_k("k_factor", k_factor)
        return
    for i, (ratio, k) in enumerate(k_factor):
        yield from _unlikely_k(f"k_factor[{i}][1]", k)
        if ratio < 0 or (i > 0 and ratio <= k_factor[i - 1][0]):
            yield Trouble(f"k_factor[{i}][0]", f"r/t = {float(ratio):g}", "from 0 on, each above the one before")


def _unlikely_k(key: str, k: float | Number) -> Iterator[Trouble]:
    if not 0 <= k <= LARGEST_K:
        yield Trouble(key, f"K = {float(k):g}", "from 0 to 0.5; the k of DIN 6935 is twice this K")


LARGEST_K = 0.5
"""A neutral line beyond the middle of the sheet would be stretched by bending on both of its sides."""


class ToleranceTable(Table, frozen=True, kw_only=True):
    """What the shop accepts; accept: the worst class that is cut; chord: contour to exact contour; join: of a strip."""

    accept: Class = DEFAULTS.accept
    chord: Length = field(default_factory=lambda: length_mm(DEFAULTS.chord_mm))
    join: Length = field(default_factory=lambda: length_mm(DEFAULTS.join_mm))
    normalise: bool = DEFAULTS.normalise

    def troubles(self) -> Iterator[Trouble]:
        """Yield tolerances that nothing can meet."""
        yield from not_positive(self, "chord")
        yield from negatives(self, "join")


FormatName = Literal["json", "png", "csv", "junit", "html", "traveller"]


class ReportTable(Table, frozen=True, kw_only=True):
    """What is reported: report.json always; png: a picture of every part and sheet in preview/; csv: results.csv.

    junit: junit.xml, for systems that show the results of tests.  html: report.html, and view.json, what it draws.
    traveller: traveller.pdf, the pages that go with the job through the shop.
    """

    formats: Annotated[tuple[FormatName, ...], Meta(max_length=MOST_ROWS)] = (
        "json",
        "png",
        "csv",
        "junit",
        "html",
        "traveller",
    )

    def troubles(self) -> Iterator[Trouble]:
        """Yield a list without json: the report is the record of the job."""
        if "json" not in self.formats:
            yield Trouble("formats", "json is missing", "report.json is always written; add other formats to it")


class JobFile(Table, frozen=True, kw_only=True):
    """A whole job file."""

    schema: Literal[1]
    part: Annotated[tuple[PartSpec, ...], Meta(min_length=1, max_length=MOST_PARTS)]
    units: Literal["mm", "cm", "m", "in"] = "mm"
    job: JobTable = JobTable()
    material: MaterialTable = MaterialTable()
    process: ProcessTable = ProcessTable()
    stock: Annotated[tuple[StockTable, ...], Meta(max_length=MOST_STOCK)] = ()
    nest: NestTable = field(default_factory=NestTable)
    tolerance: ToleranceTable = field(default_factory=ToleranceTable)
    dxf: DxfTable = DxfTable()
    report: ReportTable = ReportTable()

    def troubles(self) -> Iterator[Trouble]:
        """Yield names that occur twice: they become file names, so upper and lower case are the same."""
        yield from repeated("part", "name", [part.name for part in self.part])
        yield from repeated("stock", "id", [stock.name for stock in self.stock])
        yield from too_many_copies([part.quantity for part in self.part])
        yield from taken_by_blanks(self.part)
        yield from mate_troubles([(part.name, part.seam, blank_count(part.surface)) for part in self.part])
        yield from grain_troubles(self.part, self.stock, self.material.grain)
        yield from other_material(self.stock, self.material.name, self.material.thickness)
        thickness = None if self.material.thickness is None else float(self.material.thickness)
        yield from help_troubles(self.process, self.dxf, self.nest, self.stock, thickness)
        for i, part in enumerate(self.part):
            if part.face != "middle" and self.material.thickness is None:
                hint = "give material.thickness: the neutral surface lies that far in the sheet"
                yield Trouble(f"part[{i}].face", f'"{part.face}" of a sheet of no known thickness', hint)
            if part.rotations == ():
                yield Trouble(f"part[{i}].rotations", "no angle is allowed", 'list at least one, or write "free"')


@dataclass(frozen=True, slots=True)
class ReadJob:
    """A job file as read: its tables, where it lies, and what was noted on the way.

    inputs: name and sha256 of the job file and of every drawing and mesh that it points at.
    meshes, faces: those of the parts that have them, by their numbers; touched: the meshes that else they point at.
    layout: file and bytes of where copies lie already, if the job says so.
    tolerances: the keys of [tolerance] that the job gives itself, be it the default value.
    """

    tables: JobFile
    file: FilePath
    notes: tuple[str, ...]
    inputs: tuple[tuple[str, str], ...]
    meshes: Mapping[int, "MeshSource"] = field(default_factory=dict)
    faces: Mapping[int, "CadSource"] = field(default_factory=dict)
    touched: Mapping[int, "Mapping[MeshNormals, MeshSource]"] = field(default_factory=dict)
    layout: tuple[FilePath, bytes] | None = None
    tolerances: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True)
class Given:
    """How a job is given that does not lie in a file of its own, and what it may point at.

    text: its bytes, where they are not those of the file; line: its number in a file of JSON Lines, for messages.
    allow: the folders that the files it names may lie in, beside its own; None: anywhere.
    seen: is told of every file that is looked for, and read.
    """

    text: bytes | None = None
    line: int | None = None
    allow: tuple[FilePath, ...] | None = ()
    seen: Seen = unnoticed


FROM_FILE = Given()


def read(file: FilePath, settings: Iterable[str] = (), tell: Tell = silent, given: Given = FROM_FILE) -> ReadJob:
    """Return the job; `BadInputError` with every problem, each with its place.  tell: is told what takes long."""
    try:
        tables, sources, inputs = read_as(JobFile, file, settings, tell, given)
    except BadInputError as error:
        if given.line is None:
            raise
        raise BadInputError(*(_on_line(problem, str(file), given.line) for problem in error.problems)) from None
    laid = None if sources.layout is None else (file.parent / sources.layout[0], sources.layout[1])
    return ReadJob(
        tables,
        file,
        tuple(sources.notes),
        inputs,
        sources.meshes,
        sources.faces,
        sources.touched,
        laid,
        sources.tolerances,
    )


def _on_line(problem: Problem, file: str, line: int) -> Problem:
    """Return a problem of a text that is one line of a file, with its number there."""
    return replace(problem, line=line) if problem.file == file else problem


def read_as(
    wanted: type[T],
    file: FilePath,
    settings: Iterable[str] = (),
    tell: Tell = silent,
    given: Given = FROM_FILE,
) -> tuple[T, Sources, tuple[tuple[str, str], ...]]:
    """Return the tables of a file of that sort, what it points at, and name and sha256 of all of it."""
    content = read_bytes(file) if given.text is None else given.text
    text = text_of(content, file)
    raw = parse(text, file)
    refuse_huge(raw, file)
    set_paths = override(raw, settings)
    walk = Walk(unit=_unit(raw))
    sources = Sources(Reach(file.parent, given.allow, tell, given.seen), walk.unit, tolerances=_tolerances(raw))
    walk.resolve = sources.resolve
    try:
        tables = decode(walk, wanted, raw)
    except RecursionError:
        raise BadInputError(Problem(DEEP, file=str(file))) from None
    if tables is None:
        raise BadInputError(*placed(walk.complaints, text, file, set_paths), *_more(walk, file))
    return tables, sources, ((plain(file.name), sha256(content).hexdigest()), *sources.digests)


def _more(walk: Walk, file: FilePath) -> Iterator[Problem]:
    """Yield that there may be more problems, where so many were found that looking for them ended."""
    if len(walk.complaints) >= MOST_COMPLAINTS:
        yield Problem(f"there may be more: only the first {MOST_COMPLAINTS} problems are told", file=str(file))


def _tolerances(raw: dict[str, object]) -> frozenset[str]:
    """Return the keys of the tolerances that the file gives."""
    table = raw.get("tolerance")
    return frozenset(table) if isinstance(table, dict) else frozenset()


def _unit(raw: dict[str, object]) -> str:
    """Return the unit of bare lengths; a wrong one is complained about when its turn comes."""
    unit = raw.get("units")
    return unit if isinstance(unit, str) and unit in JOB_UNITS else "mm"
