"""Stock, wishes for the nest, and a finished nest: where every copy lies on which sheet.

Sheet frame, mm: the lower left corner of a rectangle or of a roll at the origin, a roll running along x; an outline
lies where it was drawn.
"""

from dataclasses import dataclass
from typing import Literal

from stages.geometry.arrays import ArrayValue
from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath

StockKind = Literal["sheet", "remnant", "roll", "hide"]

Quality = int | Literal["best", "any"]
"""The least quality of a zone that a part accepts, higher is better; best: outside all zones; any: in every zone."""


@dataclass(frozen=True, slots=True, eq=False)
class Zone(ArrayValue):
    """A part of a sheet that is worse than the rest: its closed outline and its quality."""

    outline: ArcPath
    quality: int


@dataclass(frozen=True, slots=True, eq=False)
class Sheet(ArrayValue):
    """One kind of stock: a rectangle, or what an outline holds.

    width_mm, height_mm: of the rectangle, or of the box of the outline; the width of a roll, along x, is infinite.
    quantity: how many of them there are; None: as many as needed.
    edge_gap_mm: least distance between a part and the edge of the sheet, or a defect.
    price: of one sheet, of a metre of a roll, in any currency; None: not known.
    outline: closed; None: the rectangle from the origin.
    defects: closed outlines on which nothing lies, holes of a hide among them.
    zones: where they overlap the lowest quality counts.
    grain_deg: direction of rolling of a sheet, of the line of tightness of a hide, in its frame; None: not known.
    """

    id: str
    width_mm: float
    height_mm: float
    quantity: int | None = None
    edge_gap_mm: float = 0.0
    price: float | None = None
    kind: StockKind = "sheet"
    outline: ArcPath | None = None
    defects: tuple[ArcPath, ...] = ()
    zones: tuple[Zone, ...] = ()
    grain_deg: float | None = None

    @property
    def is_roll(self) -> bool:
        """Whether its length is open: only what is used of it counts."""
        return self.kind == "roll"

    @property
    def is_rectangle(self) -> bool:
        """Whether it is a rectangle without defects and zones, of finite length."""
        return not (self.is_roll or self.outline or self.defects or self.zones)


@dataclass(frozen=True, slots=True)
class NestOptions:
    """Wishes for the nest.

    gap_mm: least distance between the nominal contours of two parts, kerf included.
    rotations: angles in degrees that a part may be turned by; None: any.  A part's own list goes first.
    time_limit_s: budget of the search in seconds; not spent where the first placement already fits one sheet.
    mirror: parts may be turned over.
    one_direction: all copies of a part are laid in the same angle, for whoever bends them afterwards.
    common_line: straight edges of neighbours may be cut together; kerf_mm: the width of that cut.
    offcut_min_mm: an offcut with a shorter side than this is scrap.
    """

    gap_mm: float = 0.0
    rotations: tuple[float, ...] | None = None
    time_limit_s: float = 10.0
    seed: int = 0
    mirror: bool = False
    one_direction: bool = False
    common_line: bool = False
    kerf_mm: float = 0.0
    offcut_min_mm: float = 100.0

    @property
    def common_kerf_mm(self) -> float | None:
        """How far apart edges are that are cut together; None: none are."""
        return self.kerf_mm if self.common_line else None


@dataclass(frozen=True, slots=True)
class Placement:
    """One copy of a part: `copy` from 1 on; `motion` takes its flat frame to the sheet; fixed: put there by hand."""

    part: str
    copy: int
    motion: Rigid2
    fixed: bool = False


@dataclass(frozen=True, slots=True)
class Rectangle:
    """An upright rectangle on a sheet, from its lower left corner, mm."""

    x: float
    y: float
    width_mm: float
    height_mm: float


@dataclass(frozen=True, slots=True)
class SheetLayout:
    """One sheet as it will be cut: `index` counts from 1 within its stock.

    utilisation: area of the parts over that of the sheet; over the used length of a roll.
    offcut: what is left over in one straight piece; None: nothing worth keeping.
    """

    sheet: Sheet
    index: int
    placements: tuple[Placement, ...]
    utilisation: float
    offcut: Rectangle | None = None


@dataclass(frozen=True, slots=True)
class Nesting:
    """Every copy of every part, placed."""

    layouts: tuple[SheetLayout, ...]
