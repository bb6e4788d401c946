"""The certifier on contours as they were read back from cut files: what will be cut, not what was meant.

Which contour of a file belongs to which copy is found by its box, whatever the order in the file; it must have the area
of the placed one and go through its vertices and the middles of its arcs, as one that was turned or mirrored within its
box does not.  Every contour must be that of one copy, and every copy must be there.  So angles and hands, on which
`copies` judges the placements, are those of the file.  After that only the contours read are looked at.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from stages.geometry.arrays import Points2
from stages.geometry.paths.arcpath import ArcPath, along, area, bounds, length, transform
from stages.geometry.paths.clearance import pieces
from stages.model.pattern import FlatPattern
from stages.model.report import Finding, Metric
from stages.model.sheet import NestOptions, SheetLayout
from stages.nest.legal.certify import measured
from stages.nest.legal.laid import Laid, fatal, paths_of, spread
from stages.nest.legal.region import least_distances, region

SAME_MM = 1e-5
"""How far a box and a place may be off, and an area per length: contours put together from common lines are off by
2e-6."""

MIDDLE = 0.5
"""Of an arc, as a share of its sweep."""

PAIRS = 1_000_000
"""Distances of points to pieces worked out in one go: some 100 MB."""


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
    label = f"{sheet.layout.sheet.id}-{sheet.layout.index}"
    for name in lost:
        yield fatal("file-copies", f"{name} is not in the file of sheet {label} as it was placed", sheet=label)
    there = len(sheet.outer) + len(sheet.inner)
    if not lost and there != wanted:
        yield fatal("file-copies", f"the file of sheet {label} has {there} contours, placed are {wanted}", sheet=label)


def _pairs(wanted: Sequence[ArcPath], read: Sequence[ArcPath]) -> list[int | None]:
    """Return which contour read is which that is wanted; None where there is none that is not taken yet."""
    if not (wanted and read):
        return [None] * len(wanted)
    tree = cKDTree(np.array([bounds(path) for path in read]))
    near = tree.query_ball_point(np.array([bounds(path) for path in wanted]), SAME_MM, p=np.inf, return_sorted=True)
    taken: set[int] = set()
    found: list[int | None] = []
    for path, places in zip(wanted, near, strict=True):
        at = next((place for place in places if place not in taken and _alike(path, read[place])), None)
        found.append(at)
        taken |= set() if at is None else {at}
    return found


def _alike(wanted: ArcPath, read: ArcPath) -> bool:
    """Return whether contours of one box enclose the same area, either way round, and the one read misses no place."""
    if _as_drawn(wanted, read):
        return True
    return abs(abs(area(wanted)) - abs(area(read))) <= SAME_MM * length(wanted) and _goes_through(read, _marks(wanted))


def _as_drawn(wanted: ArcPath, read: ArcPath) -> bool:
    """Return whether contours have the same vertices, one by one, and bulges that move no point of an arc by more."""
    if wanted.bulges.size != read.bulges.size:
        return False
    bent = np.abs(wanted.bulges - read.bulges).max() * np.ptp(wanted.vertices, axis=0).sum()
    return bool(max(np.abs(wanted.vertices - read.vertices).max(), bent) <= SAME_MM)


def _marks(path: ArcPath) -> Points2:
    """Return the vertices of a contour, and the middles of its arcs."""
    arcs = np.flatnonzero(path.bulges)
    return np.concatenate([path.vertices, along(path, arcs, np.full(arcs.size, MIDDLE))])


def _goes_through(path: ArcPath, points: Points2) -> bool:
    """Return whether a contour goes through points; only those that are not at marks of it are measured."""
    off, _ = cKDTree(_marks(path)).query(points)
    far, some = points[off > SAME_MM], pieces(path)
    block = max(PAIRS // some.bulge.size, 1)
    return all(
        bool((least_distances(far[start : start + block], some) <= SAME_MM).all())
        for start in range(0, len(far), block)
    )
