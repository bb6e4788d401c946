"""Lines on the formed part for the page: marks, bend lines and holes as places on the net of rulings.

A place is the row of the net, with the share of the way to the next one, and u.  They are looked up in the flat pattern
as for the pictures (`pictures.features`).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from pipeline.report.pictures.features import STEPS, looked_up, sampled
from pipeline.report.pictures.net import Net
from stages.geometry.arrays import Array, ArrayValue, Points2, norm
from stages.geometry.paths.arcpath import ArcPath
from stages.model.pattern import FlatPattern
from stages.model.surface import RuledSurface

LineKind = Literal["mark", "bend", "hole"]


@dataclass(frozen=True, slots=True, eq=False)
class Line(ArrayValue):
    """A line by its places on the net; a hole's ends where it begins."""

    kind: LineKind
    name: str
    places: Points2


Lines = Sequence[Line]


def lines_on(shape: Net, flat: Array | None, pattern: FlatPattern | None) -> Lines:
    """Return marks, bend lines and holes; none where there is no map.

    flat: both ends of the rulings of the net in the flat frame, shape (n, 2, 2), mm.
    """
    if flat is None or pattern is None:
        return []
    found: list[tuple[LineKind, str, ArcPath]] = [
        ("bend" if mark.layer.startswith("BEND") else "mark", mark.name, mark.path) for mark in pattern.marks
    ]
    found += [("hole", hole.name, hole.path) for hole in pattern.inner]
    if not found:
        return []
    step = float(norm(np.ptp(flat, axis=(0, 1)))) / STEPS
    points = [sampled(path, step) for _, _, path in found]
    places = looked_up(shape, flat, np.concatenate(points))[:, 3:]
    parts = np.split(places, np.cumsum([len(one) for one in points])[:-1])
    return [Line(kind, name, place) for (kind, name, _), place in zip(found, parts, strict=True)]


def trim_rings(surface: RuledSurface, shape: Net) -> list[Points2]:
    """Return the outline and the holes of a trimmed surface as closed polygons of places; none where it has no trim."""
    if surface.trim is None:
        return []
    t = np.linspace(0.0, 1.0, SAMPLES)[:-1]
    loops = (surface.trim.outer, *surface.trim.inner)
    rings = [np.concatenate([curve.at(t) for curve in loop]) for loop in loops]
    rows = np.arange(shape.v.size, dtype=np.float64)
    placed = [np.stack([np.interp(ring[:, 1], shape.v, rows), np.clip(ring[:, 0], 0.0, 1.0)], axis=1) for ring in rings]
    return [np.vstack([ring, ring[:1]]) for ring in placed]


SAMPLES = 65
"""Places on each curve of an outline, its end included."""
