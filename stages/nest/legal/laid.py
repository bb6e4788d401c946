"""Copies where they lie on a sheet, and the sheet they lie on, as regions of exact contours."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from stages.geometry.arrays import Indices
from stages.geometry.paths.arcpath import ArcPath, transform
from stages.geometry.paths.clearance import Pieces, joined
from stages.model.pattern import FlatPattern
from stages.model.report import Finding
from stages.model.sheet import Placement, Quality, Sheet, SheetLayout, Zone
from stages.nest.legal.region import Region, region


@dataclass(frozen=True, eq=False)
class Laid:
    """One placed copy; `quality` is the least quality of a zone that it accepts."""

    part: str
    copy: int
    quality: Quality
    region: Region

    @property
    def name(self) -> str:
        """What to call it in a message."""
        return f"'{self.part}' copy {self.copy}"


@dataclass(frozen=True, eq=False)
class Ground:
    """A sheet and its number; its outline (None: a rectangle), its defects and zones as regions."""

    sheet: Sheet
    index: int
    outline: Region | None
    defects: tuple[Region, ...]
    zones: tuple[tuple[Zone, Region], ...]

    @property
    def name(self) -> str:
        """Its stock and number."""
        return f"{self.sheet.id}-{self.index}"

    @property
    def label(self) -> str:
        """What to call it in a message."""
        return f"sheet {self.name}"


@dataclass(frozen=True, eq=False)
class Spread:
    """A sheet with what lies on it."""

    ground: Ground
    laid: tuple[Laid, ...]

    @cached_property
    def owned(self) -> tuple[Pieces, Indices]:
        """All lines and arcs of all copies, and the number of the copy that each belongs to; there must be a copy."""
        some = [one.region.outline for one in self.laid]
        return joined(some), np.repeat(np.arange(len(some)), [one.bulge.size for one in some])


def lay(pattern: FlatPattern, placement: Placement) -> Laid:
    """Return a part where it is placed."""
    paths = [transform(path, placement.motion) for path in paths_of(pattern)]
    return Laid(pattern.part, placement.copy, pattern.quality, region(paths[0], paths[1:]))


def paths_of(pattern: FlatPattern) -> list[ArcPath]:
    """Return the contours of a part, the outer one first."""
    return [pattern.outer.path, *(contour.path for contour in pattern.inner)]


def ground(layout: SheetLayout) -> Ground:
    """Return the sheet of a layout."""
    sheet = layout.sheet
    outline = None if sheet.outline is None else region(sheet.outline)
    zones = tuple((zone, region(zone.outline)) for zone in sheet.zones)
    return Ground(sheet, layout.index, outline, tuple(map(region, sheet.defects)), zones)


def fatal(code: str, message: str, **where: float | str) -> Finding:
    """Return a finding that stops the nest."""
    return Finding(code, message, fatal=True, where=dict(where) or None)


def spread(layout: SheetLayout, laid: Sequence[Laid]) -> Spread:
    """Return a sheet with what lies on it."""
    return Spread(ground(layout), tuple(laid))
