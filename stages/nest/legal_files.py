"""The certifier on contours as they were read back from cut files: what will be cut, not what was meant.

Which contour of a file belongs to which copy is found by its box, whatever the order in the file; every contour must be
that of one copy, and every copy must be there.  After that only the contours read are looked at.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from stages.geometry.arcpath import ArcPath, area, bounds, length, transform
from stages.model.pattern import FlatPattern
from stages.model.report import Finding, Metric
from stages.model.sheet import NestOptions, SheetLayout
from stages.nest.legal import measured
from stages.nest.legal_laid import Laid, fatal, paths_of, spread
from stages.nest.legal_region import region

SAME_MM = 1e-5
"""How far a box may be off, and an area per length: contours put together from common lines are off by 2e-6."""


class ReadSheet(NamedTuple):
    """A sheet as it was placed, and the outer and inner contours that were read from its file."""

    layout: SheetLayout
    outer: Sequence[ArcPath]
    inner: Sequence[ArcPath]


def certify_contours(
    sheets: Sequence[ReadSheet], patterns: Sequence[FlatPattern], options: NestOptions
) -> tuple[tuple[Metric, ...], tuple[Finding, ...]]:
    """Return gaps, overlaps and what is wrong with them, measured on contours as read; every finding is fatal."""
    by_name = {pattern.part: pattern for pattern in patterns}
    found = [_matched(sheet, by_name) for sheet in sheets]
    faults = tuple(fault for _, some in found for fault in some)
    if faults:
        return (), faults
    return measured([spread(sheet.layout, laid) for sheet, (laid, _) in zip(sheets, found, strict=True)], options)


def _matched(sheet: ReadSheet, by_name: Mapping[str, FlatPattern]) -> tuple[list[Laid], list[Finding]]:
    """Return the copies on a sheet by the contours read, and what does not belong together."""
    placed = sheet.layout.placements
    moved = [[transform(path, one.motion) for path in paths_of(by_name[one.part])] for one in placed]
    outer = _pairs([paths[0] for paths in moved], sheet.outer)
    inner = iter(_pairs([path for paths in moved for path in paths[1:]], sheet.inner))
    laid, lost = [], []
    for one, paths, at in zip(placed, moved, outer, strict=True):
        holes = [next(inner) for _ in paths[1:]]
        if at is None or None in holes:
            lost.append(f"'{one.part}' copy {one.copy}")
        else:
            cut = [sheet.inner[hole] for hole in holes if hole is not None]
            laid.append(Laid(one.part, one.copy, by_name[one.part].quality, region(sheet.outer[at], cut)))
    return laid, list(_faults(sheet, lost, sum(map(len, moved))))


def _faults(sheet: ReadSheet, lost: Sequence[str], wanted: int) -> Iterator[Finding]:
    """Yield which copies are not in the file as they were placed, or that there is more in it."""
    label = f"sheet {sheet.layout.sheet.id}-{sheet.layout.index}"
    for name in lost:
        yield fatal("file-copies", f"{name} is not in the file of {label} as it was placed", sheet=label)
    there = len(sheet.outer) + len(sheet.inner)
    if not lost and there != wanted:
        yield fatal("file-copies", f"the file of {label} has {there} contours, placed are {wanted}", sheet=label)


def _pairs(wanted: Sequence[ArcPath], read: Sequence[ArcPath]) -> list[int | None]:
    """Return which contour read is which that is wanted, by box and area; None where there is none, or it is taken."""
    if not (wanted and read):
        return [None] * len(wanted)
    tree = cKDTree(np.array([bounds(path) for path in read]))
    off, nearest = tree.query(np.array([bounds(path) for path in wanted]), p=np.inf)
    taken: set[int] = set()
    found: list[int | None] = []
    for path, away, at in zip(wanted, off.tolist(), nearest.tolist(), strict=True):
        same = away <= SAME_MM and at not in taken and _alike(path, read[at])
        found.append(at if same else None)
        taken |= {at} if same else set()
    return found


def _alike(a: ArcPath, b: ArcPath) -> bool:
    """Return whether two contours enclose the same area, whichever way round they run."""
    return abs(abs(area(a)) - abs(area(b))) <= SAME_MM * length(a)
