"""The outline of a developed strip: exact edges, corners, the lines and arcs that will be cut."""

import numpy as np
import shapely

from stages.geometry.arrays import Array, Points2, Vector2, diagonal
from stages.geometry.curves.plane import PlaneCurve, Segment
from stages.geometry.flat.flatmap import DevelopedEdge, DevelopedRuling, Development
from stages.geometry.paths import arcpath, biarc
from stages.geometry.paths.arcpath import ArcPath
from stages.model.pattern import Contour, EdgeRun


def corners(development: Development) -> Points2:
    """Return c0(0), c1(0), c1(1), c0(1) in the flat frame, mm."""
    u, zero, one = np.array([0.0, 1.0]), np.zeros(2), np.ones(2)
    start = development.pieces[0].positions(u, zero)
    end = development.pieces[-1].positions(u, one)
    return np.stack([start[0], start[1], end[1], end[0]])


def edges(development: Development) -> tuple[PlaneCurve, ...]:
    """Return the outline counter-clockwise from c0(0): first ruling, c1, last ruling, c0 back."""
    first, last = development.pieces[0], development.pieces[-1]
    there = [DevelopedEdge(piece, 1.0) for piece in development.pieces]
    back = [DevelopedEdge(piece, 0.0, reverse=True) for piece in development.pieces[::-1]]
    start, end = DevelopedRuling(first, 0.0), DevelopedRuling(last, 1.0, reverse=True)
    return (_ruling(start), *there, _ruling(end), *back)


def sides(pieces: int) -> tuple[EdgeRun, ...]:
    """Return the four sides of a strip in that outline; c0 and c1 run with v, start and end with u."""
    last = 1 + pieces
    return (
        EdgeRun("start", 0, 1),
        EdgeRun("c1", 1, last),
        EdgeRun("end", last, last + 1, backwards=True),
        EdgeRun("c0", last + 1, last + 1 + pieces, backwards=True),
    )


def _ruling(edge: DevelopedRuling) -> PlaneCurve:
    """Return the edge, as a segment where it is straight."""
    if not edge.is_straight():
        return edge
    start, end = edge.at(np.array([0.0, 1.0]))
    return Segment(start, end)


def contour(exact: tuple[PlaneCurve, ...], chord_mm: float, name: str = "") -> Contour:
    """Return the contour with its lines and arcs.  Raises NoSolutionError if they do not keep the chord."""
    return Contour(exact, biarc.trace(exact, accuracy=chord_mm), chord_mm, name)


def label_place(outer: ArcPath, inner: tuple[ArcPath, ...], chord_mm: float) -> Vector2:
    """Return the point of the part that is farthest from its contours (to 1 % of the size), mm."""
    rings: list[Array] = [arcpath.polygon(path, accuracy=chord_mm) for path in (outer, *inner)]
    valid = shapely.get_parts(shapely.make_valid(shapely.Polygon(rings[0], rings[1:])))
    # a contour that runs back along itself leaves lines beside the area
    area = max(valid, key=lambda part: part.area)
    size = diagonal(rings[0])
    point = shapely.get_point(shapely.maximum_inscribed_circle(area, tolerance=size / 100.0), 0)
    return np.array([point.x, point.y])
