"""What of a net of rulings belongs to a part that has holes or an outline of its own, cell by cell.

Places are a row, counted over the rulings of the net with fractions between two of them, and u along the ruling.  The
net is cut into cells between two rulings and two u; a cell is whole, empty, or triangles of what the outline leaves of
it.  Since the surface that is shown is linear between rulings, no triangle reaches over one.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from stages.geometry.arrays import Array, ArrayValue, Mask, Points2

COLUMNS = 6
"""Cells along a ruling: curvature is not linear along it."""


@dataclass(frozen=True, slots=True, eq=False)
class Cells(ArrayValue):
    """Cells of a net: whether each is whole, shape (rows - 1, COLUMNS); corners of triangles, three rows each."""

    whole: Array
    corners: Points2


def cells(outer: Points2 | None, holes: Sequence[Points2], joined: Mask) -> Cells:
    """Return the cells of a net inside an outline (None: all of the net) and outside holes, polygons of places."""
    rows = joined.size
    area = shapely.box(0.0, 0.0, float(rows), 1.0) if outer is None else _filled(outer)
    for hole in holes:
        area = shapely.difference(area, _filled(hole))
    low = np.repeat(np.flatnonzero(joined), COLUMNS).astype(np.float64)
    left = np.tile(np.arange(COLUMNS) / COLUMNS, int(joined.sum()))
    boxes = shapely.box(low, left, low + 1.0, left + 1.0 / COLUMNS)
    shapely.prepare(area)
    whole = np.zeros((rows, COLUMNS))
    inside = shapely.covers(area, boxes)
    whole[joined] = inside.reshape(-1, COLUMNS)
    cut = shapely.intersection(boxes[~inside & shapely.intersects(area, boxes)], area)
    return Cells(whole, _triangles(cut))


def _filled(ring: Points2) -> shapely.Geometry:
    """Return a polygon of places, mended where rounding lets it cross itself."""
    return shapely.make_valid(shapely.Polygon(ring))


def _triangles(pieces: Sequence[shapely.Geometry]) -> Points2:
    """Return the corners of triangles that fill the pieces, three rows each."""
    found = shapely.get_parts(shapely.constrained_delaunay_triangles(np.asarray(pieces, dtype=object)))
    if found.size == 0:
        return np.zeros((0, 2))
    corners: Points2 = shapely.get_coordinates(shapely.orient_polygons(found)).reshape(-1, CLOSED, 2)[:, :-1]
    return corners.reshape(-1, 2)


CLOSED = 4
"""Corners of a triangle as a ring, whose last is the first."""
