"""Contours with tabs, put together again from a file alone: open paths in a row, a gap between each and the next.

A path on a cut layer goes on with the next one in the file where the gap between them, along the line or the arc
that ends on one side and begins on the other, is as long as the gaps of the file are.  Where a row comes back to its
beginning by one more gap, it is a contour.  What does not is left open, for whoever judges open contours.

Nothing of the drawing that was written is used here but the length of the gap.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stages.geometry.arcpath import ArcPath, curvatures
from stages.geometry.arrays import Vector2, norm
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
    row: list[Entity] = []
    for entity in entities:
        if not _is_open(entity):
            made += [*row, entity] if entity.layer in CUT_LAYERS else [entity]
            row = [] if entity.layer in CUT_LAYERS else row
            continue
        if row and (entity.layer != row[0].layer or _bend(row[-1], entity, gap_mm) is None):
            made, row = [*made, *row], []
        row.append(entity)
        if _bend(entity, row[0], gap_mm) is not None:
            made.append(_closed(row, gap_mm))
            row = []
    return (*made, *row)


def _is_open(entity: Entity) -> bool:
    return entity.layer in CUT_LAYERS and not entity.closed and entity.path is not None


def _bend(before: Entity, after: Entity, gap_mm: float) -> float | None:
    """Return the bulge of the gap from one path to the next; None if there is none of that length."""
    if before.path is None or after.path is None:
        return None
    chord = float(norm(_start(after.path) - before.path.vertices[-1]))
    bend, other = float(curvatures(before.path)[-1]), float(curvatures(after.path)[0])
    if not 0.0 < chord <= gap_mm + GAP_MM or abs(bend - other) * gap_mm**2 > GAP_MM:
        return None
    half = float(np.arcsin(np.clip(chord * bend / 2.0, -1.0, 1.0)))
    long = chord / float(np.sinc(half / np.pi))
    return float(np.tan(half / 2.0)) if abs(long - gap_mm) <= GAP_MM else None


def _start(path: ArcPath) -> Vector2:
    start: Vector2 = path.vertices[0]
    return start


def _closed(row: Sequence[Entity], gap_mm: float) -> Entity:
    """Return a row of open paths and the gaps between them as one closed path."""
    vertices, bulges = [], []
    for entity, after in zip(row, [*row[1:], row[0]], strict=True):
        if entity.path is not None:
            vertices.append(entity.path.vertices)
            bulges += [entity.path.bulges[:-1], np.array([_bend(entity, after, gap_mm) or 0.0])]
    path = ArcPath(np.concatenate(vertices), np.concatenate(bulges), closed=True)
    return replace(row[0], kind="CHAIN", path=path, closed=True, count=sum(entity.count for entity in row))
