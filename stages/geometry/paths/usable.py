"""What of a piece of stock may be used: closed contours taken from the safe side, and put right where they cross.

A contour of lines and arcs that does not cross itself stays what it is.  Any other becomes a polygon: an outline is
never larger than what was drawn, a defect never smaller, neither by more than the accuracy.  Of an outline that crosses
itself the points count that it goes round an odd number of times, and of several pieces the largest; of a defect
everything that it encloses counts.

The arcs are within a fifth of the accuracy of a curve, the polygon is within 15 % of it of the arcs, and is then moved
by 40 %, at corners by 60 % at most, to the safe side.  Its corners are mitred: rounded ones would be pieces so short
that they are taken for faults.  Whether arcs cross is looked at on the polygon, not proved.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from shapely import LinearRing, LineString, Polygon, make_valid, polygonize, unary_union
from shapely.geometry.base import BaseGeometry

from stages.geometry.arrays import Points2, Vector2, norm
from stages.geometry.curves.plane import CircularArc, PlaneCurve, Segment
from stages.geometry.paths.arcpath import ArcPath, area, backwards, polygon
from stages.geometry.paths.biarc import trace

TRACE_SHARE, POLYGON_SHARE, MOVED_SHARE, MITRE = 0.2, 0.15, 0.4, 1.5
"""Of the accuracy: arcs to curve, polygon to arcs, how far the polygon is moved; and how much further at corners."""

NO_AREA = 1e-9
"""A contour round less than this share of the square of its size encloses nothing: 1 mm2 of a sheet of 30 m."""


LEAST_CORNERS = 3
SAME_POINT = 0.01
"""Points nearer than this share of the accuracy are one: the moved polygon has 5 % to spare."""


class NoAreaError(ValueError):
    """A contour that encloses nothing."""


@dataclass(frozen=True, slots=True)
class Kept:
    """What is kept of an outline: its path, counter-clockwise, holes that its crossings leave, and what became of it.

    left_out_mm2: areas of the pieces that hang on by a point or less, falling.
    crossing: it crosses or touches itself; drawn: it is not made of lines and arcs and was approximated.
    """

    path: ArcPath
    holes: tuple[ArcPath, ...] = ()
    left_out_mm2: tuple[float, ...] = ()
    crossing: bool = False
    drawn: bool = False


@dataclass(frozen=True, slots=True)
class Blocked:
    """What a defect or a zone covers: closed paths, counter-clockwise; crossing and drawn as for an outline."""

    paths: tuple[ArcPath, ...]
    crossing: bool = False
    drawn: bool = False


def inside(edges: Sequence[PlaneCurve], *, accuracy: float) -> Kept:
    """Return the outline from inside; `NoAreaError`, or NoSolutionError where the accuracy cannot be met."""
    path, drawn = _traced(edges, accuracy)
    ring = _ring(polygon(backwards(path), accuracy=POLYGON_SHARE * accuracy, outside=True))
    if ring.is_valid and not drawn:
        return Kept(path)
    shape = make_valid(ring)
    if drawn or path.bulges.any():
        shape = _moved(shape, -MOVED_SHARE * accuracy)
    pieces = sorted(_polygons(shape), key=lambda piece: -piece.area)
    if not pieces:
        raise NoAreaError
    holes = tuple(_path(hole, accuracy) for hole in pieces[0].interiors)
    left_out = tuple(float(piece.area) for piece in pieces[1:])
    return Kept(_path(pieces[0].exterior, accuracy), holes, left_out, not ring.is_valid, drawn)


def outside(edges: Sequence[PlaneCurve], *, accuracy: float) -> Blocked:
    """Return a defect or a zone from outside; `NoAreaError`, or NoSolutionError where the accuracy cannot be met."""
    path, drawn = _traced(edges, accuracy)
    ring = _ring(polygon(path, accuracy=POLYGON_SHARE * accuracy, outside=True))
    if ring.is_valid and not drawn:
        return Blocked((path,))
    shape = unary_union(polygonize([unary_union(LineString(ring.exterior.coords))]))
    if drawn or path.bulges.any():
        shape = _moved(shape, MOVED_SHARE * accuracy)
    whole = unary_union([Polygon(piece.exterior) for piece in _polygons(shape)])
    paths = tuple(_path(piece.exterior, accuracy) for piece in _polygons(whole))
    if not paths:
        raise NoAreaError
    return Blocked(paths, not ring.is_valid, drawn)


def touch(one: ArcPath, other: ArcPath, *, accuracy: float) -> bool:
    """Return whether two closed contours, or what they enclose, have a point in common, to the accuracy."""
    return bool(_shape(one, accuracy).intersects(_shape(other, accuracy)))


def within(one: ArcPath, other: ArcPath, *, accuracy: float) -> bool:
    """Return whether what a closed contour encloses lies in another without a point on its edge, to the accuracy."""
    return bool(_shape(other, accuracy).contains_properly(_shape(one, accuracy)))


def holds(path: ArcPath, point: Vector2, *, accuracy: float) -> bool:
    """Return whether a point lies in a closed contour or on it, to the accuracy."""
    from shapely import Point

    return bool(_shape(path, accuracy).covers(Point(point)))


def _shape(path: ArcPath, accuracy: float) -> Polygon:
    return Polygon(polygon(path, accuracy=accuracy))


def _traced(edges: Sequence[PlaneCurve], accuracy: float) -> tuple[ArcPath, bool]:
    """Return lines and arcs for the edges, counter-clockwise, and whether any of them is neither line nor arc."""
    path = trace(edges, accuracy=TRACE_SHARE * accuracy)
    drawn = not all(isinstance(edge, Segment | CircularArc) for edge in edges)
    return backwards(path) if area(path) < 0.0 else path, drawn


def _ring(points: Points2) -> Polygon:
    """Return the polygon of the points; `NoAreaError` for what encloses nothing without crossing itself."""
    if len(points) < LEAST_CORNERS:
        raise NoAreaError
    ring = Polygon(points)
    if ring.is_valid and ring.area <= NO_AREA * ring.length**2:
        raise NoAreaError
    return ring


def _polygons(shape: BaseGeometry) -> list[Polygon]:
    """Return the polygons of a shape that have an area; lines and points have none."""
    parts = getattr(shape, "geoms", [shape])
    flat = [inner for part in parts for inner in getattr(part, "geoms", [part])]
    return [part for part in flat if isinstance(part, Polygon) and part.area > NO_AREA * part.length**2]


def _moved(shape: BaseGeometry, distance: float) -> BaseGeometry:
    moved: BaseGeometry = shape.buffer(distance, join_style="mitre", mitre_limit=MITRE)
    return moved


def _path(ring: LinearRing, accuracy: float) -> ArcPath:
    """Return a ring, whose last point repeats the first, as a path, counter-clockwise."""
    points = np.array(ring.coords)
    apart = norm(np.diff(points, axis=0)) > SAME_POINT * accuracy
    path = ArcPath(points[:-1][apart], np.zeros(int(apart.sum())), closed=True)
    return path if area(path) > 0.0 else backwards(path)
