"""A face of a CAD file as ground that places and curves in space are put on: its strip, and what its edges enclose.

The edges are a polygon in u and v, drawn to about its size in the middle of the face; a full circle is 64 chords, which
leave out up to 1.2e-3 of its radius.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from stages.construct.faces.based import Based
from stages.construct.features import tangential
from stages.geometry.arrays import Array, ArrayValue, Points2, Points3, Values, Vector2, norm
from stages.geometry.ruled.nearest import by_rulings
from stages.geometry.ruled.pullback import newton
from stages.geometry.ruled.strip import Strip, jet, points, size

if TYPE_CHECKING:
    from shapely import Polygon

EDGE_SAMPLES = 65
BOX_MARGIN = 0.1
"""Share of the size of a face by which the box about the samples of its rulings may be too small."""


@dataclass(frozen=True, slots=True, eq=False)
class Ground(ArrayValue):
    """A face: its strip, its edges as a polygon of u and v in about mm, by `scale`, and a box about it, (2, 3), mm."""

    side: Based
    strip: Strip
    scale: Vector2
    polygon: "Polygon"
    size_mm: float
    box: Array

    def inside(self, places: Points2) -> Points2:
        """Return the places of the polygon that are nearest to places of the strip."""
        from shapely import get_coordinates, shortest_line
        from shapely import points as drawn

        ways = get_coordinates(shortest_line(self.polygon, drawn(places * self.scale))).reshape(-1, 2, 2)
        inner: Points2 = np.where(norm(ways[:, 0] - ways[:, 1])[:, None] > 0.0, ways[:, 0] / self.scale, places)
        return inner

    def reach(self, every: Points3) -> tuple[Values, Values]:
        """Return how far points are from the face, and the part of it along the face, both mm.

        The latter is 0 where the face has a normal through the point, and grows evenly beyond its edges.  Of a face
        whose nearest place is on its edge the distance is a little more than the least one.
        """
        here = jet(self.strip, *self.inside(_about_nearest(self.strip, every)).T)
        off = every - here.s
        return norm(off), tangential(off, here.s_u, here.s_v)

    def beyond_box(self, every: Points3) -> Values:
        """Return how far points lie outside the box, mm: the face is no nearer."""
        return norm(np.maximum(np.maximum(self.box[0] - every, every - self.box[1]), 0.0))


def ground_of(side: Based) -> Ground:
    """Return a face as ground."""
    from shapely import Polygon

    strip, t = side.strip, np.linspace(0.0, 1.0, EDGE_SAMPLES)
    outer, *inner = (np.concatenate([curve.at(t)[:-1] for curve in loop]) for loop in side.loops.curves)
    middle = jet(strip, *((outer.min(axis=0) + outer.max(axis=0)) / 2.0)[:, None])
    scale = np.array([float(norm(middle.s_u)[0]), float(norm(middle.s_v)[0])])
    v = np.linspace(strip.knots[0], strip.knots[-1], EDGE_SAMPLES)
    ends = np.concatenate([points(strip, np.full_like(v, u), v) for u in (0.0, 1.0)])
    reach, extent = np.array([ends.min(axis=0), ends.max(axis=0)]), size(strip)
    box = reach + BOX_MARGIN * extent * np.array([[-1.0], [1.0]])
    return Ground(side, strip, scale, Polygon(outer * scale, [ring * scale for ring in inner]), extent, box)


def _about_nearest(strip: Strip, every: Points3) -> Points2:
    """Return for each point a place that is nearest to it if that is no end of the strip, else one that is about so.

    Newton's method from the nearest of many rulings; that ruling where the method leads no nearer.
    """
    start, distance = by_rulings(strip, every)
    table, _ = newton(strip, every, start)
    farther = norm(points(strip, *table.T) - every) > distance
    places: Points2 = np.where(farther[:, None], start, table)
    return places
