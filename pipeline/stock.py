"""Rows of `[[stock]]` -> the sheets that the nest takes, with notes on what was put right."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from pipeline.stocktables import NestTable, Rotations, StockTable
from stages.model.report import Finding
from stages.model.scalars import Angle
from stages.model.sheet import NestOptions, Sheet, Zone

if TYPE_CHECKING:
    from stages.geometry.paths.arcpath import ArcPath
    from stages.geometry.paths.usable import Blocked, Kept

SINGLE = ("hide", "remnant")
"""Kinds of which there is one unless the job says more: no two are alike."""


@dataclass(frozen=True, slots=True)
class Stock:
    """The sheets of a job, how curved contours were taken, and what had to be put right."""

    sheets: tuple[Sheet, ...] = ()
    notes: tuple[str, ...] = ()
    repairs: tuple[Finding, ...] = ()

    @property
    def told(self) -> tuple[str, ...]:
        """All of it in words."""
        return (*self.notes, *(finding.message for finding in self.repairs))


def stock_of(rows: Sequence[StockTable], grain: Angle | None) -> Stock:
    """Return the sheets of a job.  grain: that of the material, for stock that states none."""
    single = [_single(row, grain) for row in rows]
    return Stock(
        tuple(sheet for stock in single for sheet in stock.sheets),
        tuple(note for stock in single for note in stock.notes),
        tuple(finding for stock in single for finding in stock.repairs),
    )


def _single(row: StockTable, grain: Angle | None) -> Stock:
    """Return one stock."""
    shapes = _shapes(row)
    notes = [f'stock "{row.name}": {note}' for note in curved_notes(shapes)]
    repairs = [
        Finding("stock-repaired", f'stock "{row.name}": {text}', where={"stock": row.name})
        for text in repair_texts(row, shapes)
    ]
    return Stock((_sheet(row, grain, shapes),), tuple(notes), tuple(repairs))


def _sheet(row: StockTable, grain: Angle | None, shapes: "Shapes") -> Sheet:
    """Return the sheet that a row describes."""
    outline = None if shapes.outline is None else shapes.outline.path
    width, height = _size(row, outline)
    return Sheet(
        id=row.name,
        width_mm=width,
        height_mm=height,
        quantity=row.quantity or (1 if row.kind in SINGLE else None),
        edge_gap_mm=float(row.edge_gap),
        price=None if row.price is None else float(row.price),
        kind=row.kind,
        outline=outline,
        defects=shapes.defect_paths,
        zones=tuple(Zone(path, zone.quality) for zone in shapes.zones for path in zone.shape.paths),
        grain_deg=_degrees(grain if row.grain is None else row.grain),
    )


def _size(row: StockTable, outline: "ArcPath | None") -> tuple[float, float]:
    """Return width and height, mm: along and across a roll, those of the box of an outline."""
    if outline is not None:
        from stages.geometry.paths.arcpath import bounds

        low_x, low_y, high_x, high_y = bounds(outline)
        return high_x - low_x, high_y - low_y
    width = float(row.width or 0)
    return (math.inf, width) if row.kind == "roll" else (width, float(row.height or 0))


@dataclass(frozen=True, slots=True)
class ZoneShape:
    """A zone as it is taken."""

    shape: "Blocked"
    quality: int


@dataclass(frozen=True, slots=True)
class Shapes:
    """Outline, defects and zones of a stock as they are taken."""

    outline: "Kept | None" = None
    defects: "tuple[Blocked, ...]" = ()
    zones: tuple[ZoneShape, ...] = ()

    @property
    def defect_paths(self) -> "tuple[ArcPath, ...]":
        """What nothing lies on: the defects, and the holes that an outline leaves where it crosses itself."""
        holes = () if self.outline is None else self.outline.holes
        return (*holes, *(path for defect in self.defects for path in defect.paths))


def _shapes(row: StockTable) -> Shapes:
    """Return outline, defects and zones as paths on the safe side."""
    if not (row.outline or row.defects or row.zones):
        return Shapes()
    from pipeline.stockshapes import blocked, kept

    return Shapes(
        None if row.outline is None else kept(row.outline),
        tuple(blocked(defect) for defect in row.defects),
        tuple(ZoneShape(blocked(zone.outline), zone.quality) for zone in row.zones),
    )


def curved_notes(shapes: Shapes) -> Iterator[str]:
    """Yield which contours were taken as straight lines, and how far these are off."""
    if shapes.outline is not None and shapes.outline.drawn:
        yield f"the outline is curved: taken as straight lines inside it, at most {_chord()} mm off"
    for name, found in _covering(shapes).items():
        drawn = sum(shape.drawn for shape in found)
        if drawn:
            yield f"{drawn} of the {name} are curved: taken as straight lines round them, at most {_chord()} mm off"


def _chord() -> str:
    from pipeline.stockshapes import CHORD_MM

    return f"{CHORD_MM:g}"


def _covering(shapes: Shapes) -> "dict[str, tuple[Blocked, ...]]":
    """Return what lies on a stock, by the keys of the job file."""
    return {"defects": shapes.defects, "zones": tuple(zone.shape for zone in shapes.zones)}


def repair_texts(row: StockTable, shapes: Shapes) -> Iterator[str]:
    """Yield what of a stock had to be put right; the usable region never grows by it."""
    if shapes.outline is not None:
        yield from _outline_repairs(shapes.outline)
    for name, found in _covering(shapes).items():
        crossing = [i for i, shape in enumerate(found) if shape.crossing]
        if crossing:
            yield f"{name}{crossing} cross or touch themselves: all that they enclose counts"
    if shapes.defects:
        from pipeline.stockshapes import reaching

        over = reaching(row)
        if over:
            yield f"defects{over} touch or cross the edge: what they cover of it is left out"


def _outline_repairs(outline: "Kept") -> Iterator[str]:
    lost = _areas(outline.left_out_mm2)
    if outline.crossing:
        more = f"; left out, hanging on by a point: {lost}" if lost else ""
        yield f"the outline crosses or touches itself: what it encloses once is used{more}"
    elif lost:
        yield f"the outline is too thin in places; left out beyond: {lost}"


def _areas(areas: Sequence[float]) -> str:
    """Return number and area of pieces in words; nothing for none."""
    count = f"{len(areas)} piece{'s' * (len(areas) > 1)}"
    return f"{count} of {sum(areas):.6g} mm2" if areas else ""


def options_of(nest: NestTable, kerf_mm: float | None) -> NestOptions:
    """Return the wishes for the nest."""
    return NestOptions(
        gap_mm=float(nest.gap),
        rotations=_angles(nest.rotations),
        time_limit_s=float(nest.time_limit),
        seed=nest.seed,
        mirror=nest.mirror,
        one_direction=nest.one_direction,
        common_line=nest.common_line,
        kerf_mm=kerf_mm or 0.0,
        offcut_min_mm=float(nest.offcut_min),
    )


def _angles(rotations: Rotations) -> tuple[float, ...] | None:
    return None if isinstance(rotations, str) else tuple(float(angle) for angle in rotations)


def _degrees(angle: Angle | None) -> float | None:
    return None if angle is None else float(angle)
