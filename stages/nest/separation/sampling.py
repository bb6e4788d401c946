"""Discs inscribed in a shape and distances to the edge of a region, from grids.

Discs are found greedily: the largest first, each next one where the distance to the edge and to the discs so far is
largest.  Both are kept for the shapes and regions asked for last.

Limits: a disc lies about the middle of a cell, so that it may be smaller than the largest one by that much.
"""

from functools import lru_cache
from typing import TypeAlias

import numpy as np
import shapely
from shapely import MultiPolygon, Polygon

from stages.nest.separation.state import Floats

Area: TypeAlias = Polygon | MultiPolygon

MOST_POLES, COVERED, LEAST_POLE = 14, 0.9, 0.05
"""Discs of a shape: so many, until they cover this share of it, none of less than this share of the largest radius."""

POLE_GRID, FIELD_GRID = 64, 220
"""Cells along the longer side of a shape for its discs, of a region for its distances."""

KEPT = 64
"""Discs and fields of so many areas are kept: every thread asks for the same ones, and they take longest of all."""


@lru_cache(maxsize=KEPT)
def poles(shape: Polygon) -> Floats:
    """Return discs inside a shape, (n, 3): middle and radius, the largest first."""
    low_x, low_y, high_x, high_y = shape.bounds
    cell = max(high_x - low_x, high_y - low_y) / POLE_GRID
    x, y = np.meshgrid(np.arange(low_x + cell / 2.0, high_x, cell), np.arange(low_y + cell / 2.0, high_y, cell))
    points = shapely.points(x, y)
    shapely.prepare(shape)
    room = np.where(shapely.contains(shape, points), shapely.distance(shape.boundary, points), -1.0)
    middle = shape.representative_point()
    found: list[tuple[float, float, float]] = []
    covered = 0.0
    while len(found) < MOST_POLES and covered < COVERED * shape.area:
        best = int(np.argmax(room))
        radius = float(room.flat[best])
        if radius <= (LEAST_POLE * found[0][2] if found else 0.0):
            break
        found.append((float(x.flat[best]), float(y.flat[best]), radius))
        covered += np.pi * radius * radius
        room = np.minimum(room, np.hypot(x - found[-1][0], y - found[-1][1]) - radius)
    if not found:
        found = [(middle.x, middle.y, float(shape.boundary.distance(middle)))]
    return np.array(found)


@lru_cache(maxsize=KEPT)
def field(region: Area) -> tuple[Floats, tuple[float, float], float]:
    """Return the distance to the edge on a grid, positive inside; where it starts, and its cell."""
    low_x, low_y, high_x, high_y = region.bounds
    cell = max(high_x - low_x, high_y - low_y) / FIELD_GRID
    x, y = np.meshgrid(
        np.arange(low_x - cell, high_x + 2.0 * cell, cell), np.arange(low_y - cell, high_y + 2.0 * cell, cell)
    )
    points = shapely.points(x, y)
    shapely.prepare(region)
    edge = region.boundary
    shapely.prepare(edge)
    away = shapely.distance(edge, points)
    field = np.where(shapely.contains(region, points), away, -away)
    return field, (low_x - cell, low_y - cell), cell
