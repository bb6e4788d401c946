"""What `planish nest` needs of the report of a finished job, typed: its parts, their wishes, stock, and files."""

from dataclasses import replace
from typing import Annotated

from msgspec import Meta, Struct, field

from pipeline.rates import Rates
from pipeline.report.nestentries import StockEntry, WishEntry
from stages.model.cutfile import FilePer, Flavour, Layer, Lettering, Machine, Paper, Picture, Side, Style, Version
from stages.model.helps import Helps
from stages.model.sheet import NestOptions


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
