"""Contours with tabs, put together again from a file alone: open paths in a row, a gap between each and the next.

A path on a cut layer goes on with the next one in the file where the gap between them, along the line or the arc
that ends on one side and begins on the other, is as long as the gaps of the file are.  Where a row comes back to its
beginning by one more gap, it is a contour.  What does not is left open, for whoever judges open contours.

Nothing of the drawing that was written is used here but the length of the gap.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import asin, dist, sin, tan

import numpy as np

from stages.geometry.paths import manypaths
from stages.geometry.paths.arcpath import ArcPath
from stages.write.chains import Entity

GAP_MM = 1e-6
"""How exactly a gap must be as long as asked for: coordinates are rounded to 1e-10 mm, ends of arcs are off by 1e-6."""

CUT_LAYERS = ("CUT_INNER", "CUT_OUTER")


def bridged(entities: Sequence[Entity], gap_mm: float) -> tuple[Entity, ...]:
    """Return the entities with the open paths that make up a contour as that contour; the order stays.

    Without gaps, of length 0, nothing changes.
    """
    if gap_mm == 0.0:
        return tuple(entities)
    made: list[Entity] = []
    row: list[Tipped] = []
    for entity, tips in zip(entities, _tips(entities), strict=True):
        if tips is None:
            made += [*(one for one, _ in row), entity] if entity.layer in CUT_LAYERS else [entity]
            row = [] if entity.layer in CUT_LAYERS else row
            continue
        if row and (entity.layer != row[0][0].layer or _bend(row[-1][1], tips, gap_mm) is None):
            made, row = [*made, *(one for one, _ in row)], []
        row.append((entity, tips))
        if _bend(tips, row[0][1], gap_mm) is not None:
            made.append(_closed(row, gap_mm))
            row = []
    return (*made, *(one for one, _ in row))


@dataclass(frozen=True, slots=True)
class Tips:
    """Where an open path begins and ends, and how its first and its last piece are bent."""

    start: tuple[float, float]
    end: tuple[float, float]
    first: float
    last: float


Tipped = tuple[Entity, Tips]


def _tips(entities: Sequence[Entity]) -> list[Tips | None]:
    """Return the tips of the entities that are open paths; None for all others."""
    some = [(number, entity.path) for number, entity in enumerate(entities) if _is_open(entity) and entity.path]
    paths = [path for _, path in some]
    starts, ends = (points.tolist() for points in manypaths.ends(paths))
    bends = manypaths.end_curvatures(paths)
    found: list[Tips | None] = [None] * len(entities)
    for (number, _), start, end, (first, last) in zip(some, starts, ends, bends.tolist(), strict=True):
        found[number] = Tips((start[0], start[1]), (end[0], end[1]), first, last)
    return found


def _is_open(entity: Entity) -> bool:
    return entity.layer in CUT_LAYERS and not entity.closed and entity.path is not None


def _bend(before: Tips, after: Tips, gap_mm: float) -> float | None:
    """Return the bulge of the gap from one path to the next; None if there is none of that length."""
    chord = dist(after.start, before.end)
    if not 0.0 < chord <= gap_mm + GAP_MM or abs(before.last - after.first) * gap_mm**2 > GAP_MM:
        return None
    half = asin(min(max(chord * before.last / 2.0, -1.0), 1.0))
    long = chord * half / sin(half) if half else chord
    return tan(half / 2.0) if abs(long - gap_mm) <= GAP_MM else None


def _closed(row: Sequence[Tipped], gap_mm: float) -> Entity:
    """Return a row of open paths and the gaps between them as one closed path."""
    vertices, bulges = [], []
    for (entity, tips), (_, after) in zip(row, [*row[1:], row[0]], strict=True):
        if entity.path is not None:
            vertices.append(entity.path.vertices)
            bulges += [entity.path.bulges[:-1], np.array([_bend(tips, after, gap_mm) or 0.0])]
    path = ArcPath(np.concatenate(vertices), np.concatenate(bulges), closed=True)
    return replace(row[0][0], kind="CHAIN", path=path, closed=True, count=sum(entity.count for entity, _ in row))
