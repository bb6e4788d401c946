"""Stock, wishes for the nest, and a finished nest: where every copy lies on which sheet."""

from dataclasses import dataclass

from stages.geometry.rigid import Rigid2


@dataclass(frozen=True, slots=True)
class Sheet:
    """A rectangle of stock, corner at the origin, mm.

    quantity: how many of them there are; None: as many as needed.
    edge_gap_mm: least distance between a part and the edge of the sheet.
    price: of one sheet, in any currency; None: not known.
    """

    id: str
    width_mm: float
    height_mm: float
    quantity: int | None = None
    edge_gap_mm: float = 0.0
    price: float | None = None


@dataclass(frozen=True, slots=True)
class NestOptions:
    """Wishes for the nest.

    gap_mm: least distance between the nominal contours of two parts, kerf included.
    rotations: angles in degrees that a part may be turned by; None: any.  A part's own list goes first.
    time_limit_s: budget of the search in seconds; not spent where the first placement already fits one sheet.
    """

    gap_mm: float = 0.0
    rotations: tuple[float, ...] | None = None
    time_limit_s: float = 10.0
    seed: int = 0


@dataclass(frozen=True, slots=True)
class Placement:
    """One copy of a part: `copy` counts from 1; `motion` takes its flat frame to the sheet."""

    part: str
    copy: int
    motion: Rigid2


@dataclass(frozen=True, slots=True)
class SheetLayout:
    """One sheet as it will be cut: `index` counts from 1 within its stock."""

    sheet: Sheet
    index: int
    placements: tuple[Placement, ...]
    utilisation: float


@dataclass(frozen=True, slots=True)
class Nesting:
    """Every copy of every part, placed."""

    layouts: tuple[SheetLayout, ...]
