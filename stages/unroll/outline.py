"""The outline of a developed strip: exact edges, corners, the lines and arcs that will be cut."""

import numpy as np
import shapely

from stages.geometry import arcpath, biarc
from stages.geometry.arcpath import ArcPath
from stages.geometry.arrays import Array, Points2, Vector2, cross2, dot, norm
from stages.geometry.flatmap import DevelopedEdge, Development
from stages.geometry.plane import PlaneCurve, Segment
from stages.model.pattern import Contour


def corners(development: Development) -> Points2:
    """Return c0(0), c1(0), c1(1), c0(1) in the flat frame, mm."""
    u, zero, one = np.array([0.0, 1.0]), np.zeros(2), np.ones(2)
    start = development.pieces[0].positions(u, zero)
    end = development.pieces[-1].positions(u, one)
    return np.stack([start[0], start[1], end[1], end[0]])


def edges(development: Development) -> tuple[PlaneCurve, ...]:
    """Return the outline counter-clockwise from c0(0): first ruling, c1, last ruling, c0 back."""
    a, b, c, d = corners(development)
    there = [DevelopedEdge(piece, 1.0) for piece in development.pieces]
    back = [DevelopedEdge(piece, 0.0, reverse=True) for piece in development.pieces[::-1]]
    return (Segment(a, b), *there, Segment(c, d), *back)


def piece_gap(development: Development) -> float:
    """Return the largest distance between the flat end of a piece and the flat start of the next, mm."""
    u = np.array([0.0, 1.0])
    gaps = [
        float(norm(a.positions(u, np.ones(2)) - b.positions(u, np.zeros(2))).max())
        for a, b in zip(development.pieces[:-1], development.pieces[1:], strict=True)
    ]
    return max(gaps, default=0.0)


def contour(exact: tuple[PlaneCurve, ...], chord_mm: float, name: str = "") -> Contour:
    """Return the contour with its lines and arcs.  Raises NoSolutionError if they do not keep the chord."""
    return Contour(exact, biarc.trace(exact, accuracy=chord_mm), chord_mm, name)


def overlap(path: ArcPath, chord_mm: float) -> float:
    """Return the area that the outline covers more than once or inside out, mm2; 0 for a simple outline.

    The outline is cut where it meets itself; each face counts by how often the outline winds around it.
    """
    corners = arcpath.polygon(path, accuracy=chord_mm)
    if shapely.Polygon(corners).is_valid:
        return 0.0
    sense = 1.0 if arcpath.area(path) >= 0.0 else -1.0
    faces = shapely.polygonize([shapely.node(shapely.LinearRing(corners))]).geoms
    return sum((face.area * _excess(sense * _winding(corners, face)) for face in faces), 0.0)


def _winding(corners: Points2, face: shapely.Polygon) -> float:
    """Return how often a closed polygon winds around a face, counter-clockwise positive."""
    inside = face.representative_point()
    arms = corners - np.array([inside.x, inside.y])
    following = np.roll(arms, -1, axis=0)
    return float(np.round(np.arctan2(cross2(arms, following), dot(arms, following)).sum() / (2.0 * np.pi)))


def _excess(winding: float) -> float:
    """Return how often a face is covered too often: none for 0 and 1, any inside-out cover counts."""
    return max(winding - 1.0, -winding, 0.0)


def label_place(outer: ArcPath, inner: tuple[ArcPath, ...], chord_mm: float) -> Vector2:
    """Return the point of the part that is farthest from its contours (to 1 % of the size), mm."""
    rings: list[Array] = [arcpath.polygon(path, accuracy=chord_mm) for path in (outer, *inner)]
    area = shapely.make_valid(shapely.Polygon(rings[0], rings[1:]))
    size = float(norm(np.ptp(rings[0], axis=0)))
    point = shapely.get_point(shapely.maximum_inscribed_circle(area, tolerance=size / 100.0), 0)
    return np.array([point.x, point.y])
