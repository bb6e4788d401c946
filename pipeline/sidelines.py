"""Bend lines and rulings of the copies in a drawing, from the tables that the unroll stage made of their parts."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import radians
from typing import TYPE_CHECKING, Literal

import msgspec
from msgspec import Struct, field

from pipeline.sideentries import BendSide, Ends, Pair, RollSide, Row3, Side

if TYPE_CHECKING:
    from pipeline.run import PartRun
    from stages.geometry.curves.rigid import Rigid2

Radii = tuple[float | None, float | None]


class BendRow(Struct, frozen=True):
    """A row of the bend table of a part."""

    name: str
    v: float
    start: Pair = field(name="from")
    end: Pair = field(name="to")
    angle_deg: float
    side: Side
    radius_mm: Radii
    facet_error_mm: float
    fold: bool
    pieces: tuple[Ends, ...]
    pitch_mm: Pair | None = None
    face: int | None = None


class RollRow(Struct, frozen=True):
    """A row of the roll schedule of a part."""

    v: float
    distance_mm: float
    side: Side
    radius_mm: Radii
    start: Pair = field(name="from")
    end: Pair = field(name="to")
    cone_tilt_deg: float | None = None
    tool_radius_mm: Radii | None = None
    tool_radius_by: str | None = None
    note: str | None = None
    face: int | None = None


class Thickness(Struct, frozen=True):
    """Where the neutral surface lies; nothing where no thickness is known."""

    k_factor: float | None = None
    thickness_mm: float = 0.0


class FaceThickness(Struct, frozen=True):
    """The same of one face of a blank that bends in several directions."""

    face: int
    thickness: Thickness = Thickness()


@dataclass(frozen=True, slots=True)
class Copy:
    """A part in a drawing: its run, which copy it is (None: in its own flat frame), and how it was moved there."""

    run: "PartRun"
    number: int | None
    motion: "Rigid2"

    @property
    def name(self) -> str:
        """The name of the part."""
        return self.run.part.name

    @property
    def turned_over(self) -> bool:
        """Whether it lies with its lower side up."""
        from stages.model.strokes import turned_over

        return self.run.pattern is not None and turned_over(self.run.pattern, self.motion)

    def matrix(self) -> tuple[Row3, Row3]:
        """Return what takes a point of the flat frame to the drawing."""
        from stages.geometry.curves.rigid import matrix

        (a, c), (b, d) = matrix(self.motion).tolist()
        return (a, c, self.motion.x), (b, d, self.motion.y)

    def moved(self, ends: Ends) -> Ends:
        """Return two points of the flat frame in the drawing."""
        (a, c, e), (b, d, f) = self.matrix()
        (x0, y0), (x1, y1) = ends
        return (a * x0 + c * y0 + e, b * x0 + d * y0 + f), (a * x1 + c * y1 + e, b * x1 + d * y1 + f)


def bends(copy: Copy) -> Iterator[BendSide]:
    """Yield the bend lines of a copy."""
    sheets = _sheets(copy)
    for order, row in enumerate(msgspec.convert(_table(copy, "bends"), list[BendRow]), 1):
        sheet = sheets.get(row.face, Thickness())
        up = (row.side == "up") != copy.turned_over
        yield BendSide(
            part=copy.name,
            copy=copy.number,
            order=order,
            name=row.name,
            v=row.v,
            face=row.face,
            side=row.side,
            layer="BEND_UP" if up else "BEND_DOWN",
            angle_deg=row.angle_deg,
            fold=row.fold,
            radius_mm=row.radius_mm,
            k_factor=sheet.k_factor,
            allowance_mm=_allowance(row, sheet),
            facet_error_mm=row.facet_error_mm,
            pitch_mm=row.pitch_mm,
            ends=(row.start, row.end),
            pieces=row.pieces,
            in_drawing=copy.moved((row.start, row.end)),
            pieces_in_drawing=tuple(map(copy.moved, row.pieces)),
        )


def _allowance(row: BendRow, sheet: Thickness) -> Radii:
    """Return what a bend takes of the flat pattern at both ends, mm; nothing at a fold, None without a radius."""
    if row.fold:
        return 0.0, 0.0
    turn = abs(radians(row.angle_deg))
    inward = (sheet.k_factor or 0.0) * sheet.thickness_mm
    first, last = (None if radius is None else turn * (radius + inward) for radius in row.radius_mm)
    return first, last


def rolls(copy: Copy) -> Iterator[RollSide]:
    """Yield the rulings of a part at which the roll is set."""
    for order, row in enumerate(msgspec.convert(_table(copy, "rolls"), list[RollRow]), 1):
        yield RollSide(
            part=copy.name,
            order=order,
            v=row.v,
            face=row.face,
            side=row.side,
            distance_mm=row.distance_mm,
            radius_mm=row.radius_mm,
            cone_tilt_deg=row.cone_tilt_deg,
            tool_radius_mm=row.tool_radius_mm,
            tool_radius_by=row.tool_radius_by,
            note=row.note,
            ends=(row.start, row.end),
        )


def _detail(copy: Copy) -> Mapping[str, object]:
    """Return the details of the unroll stage of a part."""
    return next((step.report.detail for step in copy.run.steps if step.report.stage == "unroll"), {})


def _table(copy: Copy, name: Literal["bends", "rolls"]) -> object:
    return _detail(copy).get(name, [])


def _sheets(copy: Copy) -> dict[int | None, Thickness]:
    """Return where the neutral surface lies, for each face of a blank of several."""
    found = _detail(copy).get("thickness", {})
    if isinstance(found, dict) and "faces" in found:
        return {one.face: one.thickness for one in msgspec.convert(found["faces"], list[FaceThickness])}
    return {None: msgspec.convert(found, Thickness)}
