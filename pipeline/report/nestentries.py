"""What a report says of stock, wishes and parts so that others may nest the patterns again; and back to values.

A closed path is its vertices and one bulge for each (tan of a quarter of the sweep, 0 straight), at full precision.
Widths without end, those of rolls, are null.
"""

import math
from dataclasses import asdict
from typing import TYPE_CHECKING, Literal

from msgspec import Struct

from stages.model.sheet import NestOptions, Quality, Sheet, StockKind, Zone

if TYPE_CHECKING:
    from stages.geometry.paths.arcpath import ArcPath
    from stages.model.pattern import FlatPattern

Document = dict[str, object]
Pair = tuple[float, float]


class PathEntry(Struct, frozen=True):
    """A closed path."""

    vertices: tuple[Pair, ...]
    bulges: tuple[float, ...]


class ZoneEntry(Struct, frozen=True):
    """A zone of a sheet."""

    quality: int
    outline: PathEntry


class StockEntry(Struct, frozen=True):
    """One kind of stock, as `stages.model.sheet.Sheet` has it."""

    id: str
    kind: StockKind
    width_mm: float | None
    height_mm: float
    quantity: int | None
    edge_gap_mm: float
    price: float | None
    grain_deg: float | None
    outline: PathEntry | None
    defects: tuple[PathEntry, ...]
    zones: tuple[ZoneEntry, ...]


class WishEntry(Struct, frozen=True):
    """How a part wants to lie, as `stages.model.pattern.FlatPattern` has it."""

    rotations: Literal["free"] | tuple[float, ...] | None
    quality: Quality
    axis_deg: float | None
    axis_band_deg: float
    pair: bool


def stock_entry(sheet: Sheet) -> Document:
    """Return one kind of stock."""
    return {
        "id": sheet.id,
        "kind": sheet.kind,
        "width_mm": sheet.width_mm if math.isfinite(sheet.width_mm) else None,
        "height_mm": sheet.height_mm,
        "quantity": sheet.quantity,
        "edge_gap_mm": sheet.edge_gap_mm,
        "price": sheet.price,
        "grain_deg": sheet.grain_deg,
        "outline": None if sheet.outline is None else _path_entry(sheet.outline),
        "defects": [_path_entry(path) for path in sheet.defects],
        "zones": [{"quality": zone.quality, "outline": _path_entry(zone.outline)} for zone in sheet.zones],
    }


def options_entry(options: NestOptions) -> Document:
    """Return the wishes for a nest by their names."""
    return asdict(options)


def wish_entry(pattern: "FlatPattern") -> Document:
    """Return how a part wants to lie."""
    return {
        "rotations": pattern.rotations,
        "quality": pattern.quality,
        "axis_deg": pattern.axis_deg,
        "axis_band_deg": pattern.axis_band_deg,
        "pair": pattern.pair,
    }


def sheet_of(entry: StockEntry) -> Sheet:
    """Return the stock that an entry says."""
    return Sheet(
        id=entry.id,
        width_mm=math.inf if entry.width_mm is None else entry.width_mm,
        height_mm=entry.height_mm,
        quantity=entry.quantity,
        edge_gap_mm=entry.edge_gap_mm,
        price=entry.price,
        kind=entry.kind,
        outline=None if entry.outline is None else _path_of(entry.outline),
        defects=tuple(map(_path_of, entry.defects)),
        zones=tuple(Zone(_path_of(zone.outline), zone.quality) for zone in entry.zones),
        grain_deg=entry.grain_deg,
    )


def _path_entry(path: "ArcPath") -> Document:
    return {"vertices": path.vertices.tolist(), "bulges": path.bulges.tolist()}


def _path_of(entry: PathEntry) -> "ArcPath":
    import numpy as np

    from stages.geometry.paths.arcpath import ArcPath

    return ArcPath(np.array(entry.vertices).reshape(-1, 2), np.array(entry.bulges), closed=True)
