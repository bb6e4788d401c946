"""A finished job as its output folder holds it: the patterns of its parts, its stock, and how it was to be nested.

`report.json` says what the parts are and how they want to lie; `flat/<part>.dxf` holds their contours, marks and texts,
which come back as they were written: lines and arcs to half the last decimal of a drawing, 5e-11 mm.  A file that is
not the one the report lists, by its sha256, is refused.  Names of marks and holes are not in drawings and are lost.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import msgspec
from msgspec import Meta, Struct, field

from pipeline.rates import Rates
from pipeline.report.nestentries import StockEntry, WishEntry, sheet_of
from pipeline.store import REPORT, digest, safe_names
from stages.errors import BadInputError, Problem
from stages.model.cutfile import FilePer, Flavour, Layer, Lettering, Machine, Paper, Picture, Side, Style, Version
from stages.model.helps import Helps
from stages.model.sheet import NestOptions, Sheet

if TYPE_CHECKING:
    from stages.model.pattern import FlatPattern

SCHEMA = "planish-report/1"
RUN_AGAIN = "run the job again with this version"


class MaterialEntry(Struct, frozen=True):
    """The sheet of a job."""

    name: str
    thickness_mm: float | None
    density_kg_m3: float | None


class ToleranceEntry(Struct, frozen=True):
    """What the contours were held to."""

    chord_mm: float


class LayerEntry(Struct, frozen=True):
    """What its drawings call a layer."""

    name: str
    colour: int


class DxfEntry(Struct, frozen=True):
    """How its drawings were written."""

    flavour: Flavour
    version: Version
    layers: dict[str, LayerEntry]
    text: Lettering
    one_file_per: FilePer
    name: str
    also: tuple[Picture, ...] = ()
    paper: Paper = "fit"
    side: Side = "either"
    size: str = Style().size
    helps: Helps = field(default_factory=Helps)

    def machine(self) -> Machine:
        """Return what drawings of that sort are like."""
        layers = {meaning: Layer(layer.name, layer.colour) for meaning, layer in self.layers.items()}
        how = Machine(self.flavour, self.version, layers, side=self.side, style=Style(size=self.size), helps=self.helps)
        named = replace(how, text=self.text, file_per=self.one_file_per, file_name=self.name)
        return replace(named, also=self.also, paper=self.paper)


class JobEntry(Struct, frozen=True):
    """A job."""

    name: str
    customer: str | None
    revision: str | None
    digest: str
    material: MaterialEntry
    tolerance: ToleranceEntry
    dxf: DxfEntry
    formats: tuple[str, ...] = ("json", "png")


class FlatEntry(Struct, frozen=True):
    """Figures of a flat pattern."""

    corners: Annotated[tuple[tuple[float, float], ...], Meta(min_length=4, max_length=4)]


class PartEntry(Struct, frozen=True):
    """A part that passed."""

    name: str
    quantity: Annotated[int, Meta(ge=1)]
    flat: FlatEntry
    nest: WishEntry


class CostEntry(Struct, frozen=True):
    """What its cost was reckoned with."""

    rates: Rates = field(default_factory=Rates)


class NestEntry(Struct, frozen=True):
    """Stock and wishes; absent without stock."""

    options: NestOptions = field(default_factory=NestOptions)
    stock: tuple[StockEntry, ...] = ()
    cost: CostEntry = CostEntry()


class FileEntry(Struct, frozen=True):
    """A drawing of the job."""

    path: str
    sha256: str


class WriteEntry(Struct, frozen=True):
    """The drawings of a job."""

    files: tuple[FileEntry, ...]


class StatusEntry(Struct, frozen=True):
    """What became of a job; read before all else of a report."""

    schema: str
    status: str


class ReportEntry(Struct, frozen=True):
    """What is needed of a report."""

    job: JobEntry
    parts: tuple[PartEntry, ...]
    nest: NestEntry
    write: WriteEntry


@dataclass(frozen=True, slots=True)
class Finished:
    """A finished job: its patterns by the names of its parts, and what they were to be cut from.

    paths: of the drawings of the parts below the folder, by their names.
    """

    folder: Path
    job: JobEntry
    patterns: "tuple[FlatPattern, ...]"
    stock: tuple[Sheet, ...]
    options: NestOptions
    machine: Machine
    rates: Rates
    paths: dict[str, str]
    report_digest: str


def finished(folder: Path) -> Finished:
    """Return the job whose output folder this is; `BadInputError` with everything that stands against it."""
    file = folder / REPORT
    try:
        content = file.read_bytes()
    except OSError as error:
        hint = "give the output folders of finished jobs"
        raise BadInputError(Problem(f"cannot be read: {error.strerror}", hint=hint, file=str(file))) from None
    report = _report(content, file)
    drawings = dict(_drawings(report, folder))
    problems = [*_changed(report, drawings, folder)]
    if problems:
        raise BadInputError(*problems)
    job = report.job
    return Finished(
        folder,
        job,
        _patterns(report, drawings, folder),
        tuple(_sheets(report, file)),
        report.nest.options,
        job.dxf.machine(),
        report.nest.cost.rates,
        _paths(report),
        digest(content),
    )


def _report(content: bytes, file: Path) -> ReportEntry:
    """Return what is needed of a report that says that its job was made."""
    hint = "give the output folders of finished jobs"
    try:
        said = msgspec.json.decode(content, type=StatusEntry)
        if said.schema != SCHEMA:
            raise BadInputError(Problem(f'"{said.schema}" is not the report of a job', "schema", hint, str(file)))
        if said.status != "made":
            message = f"the job is {said.status}, not made"
            raise BadInputError(Problem(message, "status", "only what may be cut is nested", str(file)))
        return msgspec.json.decode(content, type=ReportEntry)
    except (msgspec.DecodeError, RecursionError) as error:
        message = f"is no report that can be read: {error}"
        raise BadInputError(Problem(message, hint=RUN_AGAIN, file=str(file))) from None


def _sheets(report: ReportEntry, file: Path) -> Iterator[Sheet]:
    """Yield the stock of a report; `BadInputError` for a path that is none."""
    for number, entry in enumerate(report.nest.stock):
        try:
            yield sheet_of(entry)
        except ValueError as error:
            raise BadInputError(Problem(str(error), f"nest.stock[{number}]", RUN_AGAIN, str(file))) from None


def _paths(report: ReportEntry) -> dict[str, str]:
    """Return the path of the drawing of every part by its name, as the job chose it."""
    return {name: f"flat/{safe}.dxf" for name, safe in safe_names(part.name for part in report.parts).items()}


def _drawings(report: ReportEntry, folder: Path) -> Iterator[tuple[str, bytes | None]]:
    """Yield the drawings of all parts by their paths; None for one that cannot be read."""
    for path in _paths(report).values():
        try:
            yield path, (folder / path).read_bytes()
        except OSError:
            yield path, None


def _changed(report: ReportEntry, drawings: dict[str, bytes | None], folder: Path) -> Iterator[Problem]:
    """Yield the drawings that are missing, or not those that the report lists."""
    listed = {file.path: file.sha256 for file in report.write.files}
    hint = "run the job again, or put the drawing back"
    for path, content in drawings.items():
        if content is None:
            yield Problem("the drawing is missing", hint=hint, file=str(folder / path))
        elif digest(content) != listed.get(path):
            yield Problem("the drawing was changed after the job had been made", hint=hint, file=str(folder / path))


def _patterns(report: ReportEntry, drawings: dict[str, bytes | None], folder: Path) -> "tuple[FlatPattern, ...]":
    """Return the patterns of all parts; `BadInputError` for drawings that do not hold one."""
    from pipeline.readpatterns import read_pattern
    from pipeline.readpieces import NoPatternError

    paths, patterns, problems = _paths(report), [], []
    machine = report.job.dxf.machine()
    for part in report.parts:
        path = paths[part.name]
        try:
            text = (drawings[path] or b"").decode("ascii")
            drawn = read_pattern(text, report.job.tolerance.chord_mm, machine.layers)
        except (NoPatternError, UnicodeDecodeError) as error:
            problems.append(Problem(f"holds no pattern: {error}", file=str(folder / path)))
            continue
        patterns.append(_wished(drawn, part, report.job.material))
    if problems:
        raise BadInputError(*problems)
    return tuple(patterns)


def _wished(drawn: "FlatPattern", part: PartEntry, material: MaterialEntry) -> "FlatPattern":
    """Return a pattern with what its report says of it."""
    import numpy as np

    wish = part.nest
    return drawn.replace(
        part=part.name,
        quantity=part.quantity,
        corners=np.array(part.flat.corners),
        rotations=wish.rotations,
        thickness_mm=material.thickness_mm,
        density_kg_m3=material.density_kg_m3,
        quality=wish.quality,
        axis_deg=wish.axis_deg,
        axis_band_deg=wish.axis_band_deg,
        pair=wish.pair,
    )


def all_finished(folders: Sequence[Path]) -> tuple[Finished, ...]:
    """Return all jobs; `BadInputError` with what stands against any of them."""
    jobs: list[Finished] = []
    problems: list[Problem] = []
    for folder in folders:
        try:
            jobs.append(finished(folder))
        except BadInputError as error:
            problems += error.problems
    if problems:
        raise BadInputError(*problems)
    return tuple(jobs)
