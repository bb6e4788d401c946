"""What the shop needs of a report and of the side files beside drawings, typed: for the traveller, and for `compare`.

What stands there besides is left aside.  Lengths are in mm, areas in mm2, angles in degrees, as they stand there.
"""

from msgspec import Struct, field

from pipeline.report.entries import JobHead, PartHead, SheetHead, StageEntry
from pipeline.report.nestentries import StockEntry
from pipeline.sideentries import ContourSide, Pair
from pipeline.sidelines import BendRow, RollRow, Thickness


class DetailEntry(Struct, frozen=True):
    """What forming needs of a stage's detail."""

    thickness: Thickness | None = None
    bends: tuple[BendRow, ...] = ()
    rolls: tuple[RollRow, ...] = ()


class FormingEntry(StageEntry, frozen=True, kw_only=True):
    """A stage of a part with what forming needs of it."""

    detail: DetailEntry = DetailEntry()


class HoleEntry(Struct, frozen=True):
    """A hole in the flat pattern."""

    name: str
    area: float
    x: float
    y: float


class MarkEntry(Struct, frozen=True):
    """A mark with a place."""

    name: str
    x: float
    y: float


class BlankEntry(Struct, frozen=True):
    """What is cut."""

    area: float
    width: float
    height: float
    outline_length: float


class FlatEntry(Struct, frozen=True):
    """Figures of a flat pattern; edges: by name, where they have one.  cut: with allowances, where there are any."""

    area: float
    outline_length: float
    width: float
    height: float
    corners: tuple[Pair, ...]
    edges: dict[str, float] | None
    marks: tuple[MarkEntry, ...]
    holes: tuple[HoleEntry, ...]
    cut: BlankEntry | None = None

    @property
    def blank(self) -> BlankEntry:
        """Return what is cut."""
        return self.cut or BlankEntry(self.area, self.width, self.height, self.outline_length)


class SpotEntry(Struct, frozen=True):
    """A corner by its letters, more than one where corners fall together, in the flat frame."""

    letters: str
    x: float
    y: float


class SpanEntry(Struct, frozen=True):
    """A distance between two corners: along the edge, nothing on a diagonal, and straight."""

    first: str = field(name="from")
    last: str = field(name="to")
    what: str
    along_mm: float | None
    straight_mm: float
    evidence: str


class TapeEntry(Struct, frozen=True):
    """What is measured on a blank with a tape."""

    spots: tuple[SpotEntry, ...]
    spans: tuple[SpanEntry, ...]


class FormedEntry(Struct, frozen=True):
    """How large a formed part is along x, y and z."""

    size_mm: tuple[float, float, float]
    evidence: str


class PartEntry(PartHead, frozen=True, kw_only=True):
    """A part."""

    flat: FlatEntry | None
    stages: tuple[FormingEntry, ...]
    tape: TapeEntry | None = None
    formed: FormedEntry | None = None


class MaterialEntry(Struct, frozen=True):
    """The sheet that parts are made of."""

    name: str
    thickness_mm: float | None


class ToleranceEntry(Struct, frozen=True):
    """What the job allows."""

    accept: str
    chord_mm: float
    join_mm: float


class ProcessEntry(Struct, frozen=True):
    """How it is cut."""

    type: str | None
    kerf_mm: float | None
    kerf_compensation: str


class LayerEntry(Struct, frozen=True):
    """How drawings call a layer."""

    name: str
    colour: int


class HelpsEntry(Struct, frozen=True):
    """Whether contours are written beside the nominal ones, for a beam so wide."""

    beam_mm: float | None = None
    compensated: bool = False


class DrawingsEntry(Struct, frozen=True):
    """How drawings are written."""

    layers: dict[str, LayerEntry]
    helps: HelpsEntry = HelpsEntry()


class JobEntry(JobHead, frozen=True, kw_only=True):
    """Whose job it is; of what was nested from drawings alone not all is known."""

    material: MaterialEntry
    customer: str | None = None
    revision: str | None = None
    process: ProcessEntry | None = None
    tolerance: ToleranceEntry | None = None
    dxf: DrawingsEntry | None = None


class OffcutEntry(Struct, frozen=True):
    """The rectangle that a sheet leaves in one piece."""

    x: float
    y: float
    width_mm: float
    height_mm: float


class PlacementEntry(Struct, frozen=True):
    """A copy on a sheet."""

    part: str
    copy: int
    x: float
    y: float
    angle: float
    mirrored: bool


class SheetEntry(SheetHead, frozen=True, kw_only=True):
    """A nested sheet."""

    file: str | None
    kind: str
    offcut: OffcutEntry | None
    placements: tuple[PlacementEntry, ...]


class NestEntry(StageEntry, frozen=True, kw_only=True):
    """The nest of a job."""

    stock: tuple[StockEntry, ...] = ()
    sheets: tuple[SheetEntry, ...] = ()


class ReportEntry(Struct, frozen=True):
    """A report."""

    status: str
    job: JobEntry
    parts: tuple[PartEntry, ...]
    nest: NestEntry


class SideEntry(Struct, frozen=True):
    """The side file of a drawing: what is cut in it, in the order in which the file has it."""

    contours: tuple[ContourSide, ...]
