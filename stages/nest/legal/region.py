"""Regions bounded by lines and arcs: whether one runs into another, decided on the exact contours.

Regions whose contours are apart overlap only where a contour of one lies within the other: a point of each contour
tells.  Where contours touch or cross, each region in turn is shrunk by `GAP_TOLERANCE_MM`: they overlap if its contour
then still meets the other region.  So regions that touch do not overlap, and whatever reaches further into another
does, however small its area.  A region lies within another if its contour does not reach that of the other, grown by as
much, nor its contour shrunk by as much that of the other as it is.  Only the area of an overlap that is certain is
measured on polygons.

A shrunk or grown region is known by its pieces alone, each moved along its normals and cut off at the bisectors of
corners.  Where they move apart at a corner they leave a gap through which what is aligned with the corner slips: so two
regions are always asked both ways.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from shapely import Polygon, STRtree, box

from stages.geometry.arrays import Array, Mask, Points2, Values, Vector2
from stages.geometry.paths.arcpath import (
    ArcPath,
    along,
    area,
    backwards,
    bounds,
    directions,
    joint_turns,
    lengths,
    polygon,
    sweeps,
)
from stages.geometry.paths.clearance import Pieces, between, clearance, joined, pieces, point_distances
from stages.geometry.paths.enclosed import inside

GAP_TOLERANCE_MM = 1e-6
"""A gap may fall short by this: above the rounding of coordinates, below what any machine can cut."""

CONTACT_MM = 1e-10
"""Contours nearer than this touch: it is their rounding at 10 m, squared distances included."""

NO_PIECE_MM = 1e-8
"""A shorter piece, such as between vertices that are one but for rounding, has no direction that means anything."""

ASIDE_MOST_MM = 1.0
ASIDE = (0.5403, 0.8415)
"""Unit step by which a point is moved before asking what it lies in: no contour of a shop runs along it."""

FINE_MM = 1e-3
"""Chord error of the polygons on which the area of an overlap is measured."""

LEAST_OVERLAP_MM2 = 1e-9
"""Reported for an overlap that is certain but too small for its area to be measured."""

SHARPEST = np.radians(179.9)
"""A corner that turns by more is cut off as this one is."""


@dataclass(frozen=True, eq=False)
class Region:
    """A closed contour, counter-clockwise, less its holes, clockwise."""

    contours: tuple[ArcPath, ...]

    @cached_property
    def pieces(self) -> tuple[Pieces, ...]:
        """The lines and arcs of each contour."""
        return tuple(pieces(path) for path in self.contours)

    @cached_property
    def outline(self) -> Pieces:
        """The lines and arcs of all contours."""
        return joined(self.pieces)

    @cached_property
    def box(self) -> tuple[float, float, float, float]:
        """Its exact extent: x least, y least, x most, y most, in mm."""
        return bounds(self.contours[0])


def region(outer: ArcPath, inner: Sequence[ArcPath] = ()) -> Region:
    """Return the region within a contour and outside of others, whichever way round they run."""
    return Region((_sensed(outer, 1.0), *(_sensed(path, -1.0) for path in inner)))


def _sensed(path: ArcPath, sense: float) -> ArcPath:
    return path if area(path) * sense > 0.0 else backwards(path)


def overlap_mm2(a: Region, b: Region, gap_mm: float) -> float:
    """Return the area common to two regions whose contours are at least `gap_mm` apart; exactly 0 if there is none."""
    if not (_into(a, b, gap_mm) or _into(b, a, gap_mm)):
        return 0.0
    return max(float(_polygon(a).intersection(_polygon(b)).area), LEAST_OVERLAP_MM2)


def within(a: Region, b: Region, gap_mm: float) -> bool:
    """Return whether a region lies in another that has no holes, given how far apart the contours are."""
    if gap_mm > CONTACT_MM:
        return bool(holds(b, _aside(a, gap_mm)).all())
    return (
        clearance(a.outline, grown(b), within=0.0) > 0.0
        and clearance(shrunk(a), b.outline, within=0.0) > 0.0
        and bool(holds(b, _deep_points(a, b)).all())
    )


def boxes_meet(a: Region, b: Region) -> bool:
    """Return whether the boxes of two regions meet."""
    (a_x, a_y, a_right, a_top), (b_x, b_y, b_right, b_top) = a.box, b.box
    return a_x <= b_right and b_x <= a_right and a_y <= b_top and b_y <= a_top


def meeting(regions: Sequence[Region]) -> list[tuple[int, int]]:
    """Return the pairs of regions, by number, whose boxes meet."""
    frames = box(*np.array([one.box for one in regions]).reshape(-1, 4).T)
    first, second = STRtree(frames).query(frames, predicate="intersects")
    return sorted((i, j) for i, j in zip(first.tolist(), second.tolist(), strict=True) if i < j)


def holds(some: Region, points: Points2) -> Mask:
    """Return which points lie in a region; a point on a contour may go either way."""
    held = inside(points, some.pieces[0])
    for hole in some.pieces[1:]:
        held &= ~inside(points, hole)
    return held


def shrunk(some: Region) -> Pieces:
    """Return the pieces of the contours of a region that is smaller by the tolerance all round."""
    return joined([_moved_in(path) for path in some.contours])


def grown(some: Region) -> Pieces:
    """Return the pieces of the contours of a region that is larger by the tolerance all round."""
    return joined([_moved_in(backwards(path)) for path in some.contours])


def _into(a: Region, b: Region, gap_mm: float) -> bool:
    """Return whether a contour of `a` reaches into `b`."""
    if gap_mm > CONTACT_MM:
        return bool(holds(b, _aside(a, gap_mm)).any())
    return clearance(shrunk(a), b.outline, within=0.0) <= 0.0 or bool(holds(b, _deep_points(a, b)).any())


def _aside(some: Region, gap_mm: float) -> Points2:
    """Return a point near each contour that no contour at least so far away separates from it."""
    step = min(gap_mm, ASIDE_MOST_MM) / 2.0 * np.array(ASIDE)
    return np.stack([path.vertices[0] for path in some.contours]) + step


def _deep_points(a: Region, b: Region) -> Points2:
    """Return of each contour of the shrunk region `a` a point that is as far as any from the contours of `b`."""
    points = [_on_pieces(_moved_in(path)) for path in a.contours]
    return np.stack([_furthest(some[:: 1 + some.shape[0] // SOME], b.outline) for some in points if some.size])


def _on_pieces(some: Pieces) -> Points2:
    """Return a point of each piece, on no chord of it or of one that is alike."""
    loose = ArcPath(np.stack([some.start, some.end], axis=1).reshape(-1, 2), np.repeat(some.bulge, 2), closed=True)
    points: Points2 = along(loose, np.arange(0, 2 * some.bulge.size, 2), np.full(some.bulge.size, ODD_SHARE))
    return points


ODD_SHARE = 0.3719
"""Of a piece: at its start or its middle a point may well lie on the chord of another arc."""


def _furthest(points: Points2, to: Pieces) -> Vector2:
    """Return the point that is furthest from all pieces."""
    furthest: Vector2 = points[int(np.argmax(least_distances(points, to)))]
    return furthest


def least_distances(points: Points2, to: Pieces) -> Values:
    """Return the distance of each point to the nearest of all pieces, in mm."""
    count, many = points.shape[0], to.bulge.size
    every = point_distances(np.repeat(points, many, axis=0), to.take(np.tile(np.arange(many), count)))
    least: Values = every.reshape(count, many).min(axis=1)
    return least


SOME = 64
"""About so many points of a contour are looked at: any would do that is not within rounding of the other contour."""


def _moved_in(contour: ArcPath) -> Pieces:
    """Return the pieces of a contour moved to the left, what is left of them between the bisectors of its corners."""
    path = _directed(contour)
    whole = lengths(path)
    cut = GAP_TOLERANCE_MM * np.tan(np.clip(joint_turns(path), 0.0, SHARPEST) / 2.0)
    gone = np.full_like(whole, np.inf)
    low = np.divide(cut, whole, out=gone.copy(), where=whole > 0.0)
    high = 1.0 - np.divide(np.roll(cut, -1), whole, out=gone, where=whole > 0.0)
    kept = np.flatnonzero(low < high)
    ends = [along(path, kept, f[kept]) + GAP_TOLERANCE_MM * _left(path, f)[kept] for f in (low, high)]
    return between(ends[0], ends[1], np.tan(sweeps(path)[kept] * (high - low)[kept] / 4.0))


def _directed(path: ArcPath) -> ArcPath:
    """Return a contour without the pieces that have no direction."""
    kept = lengths(path) > NO_PIECE_MM
    return path if kept.all() or not kept.any() else ArcPath(path.vertices[kept], path.bulges[kept], closed=True)


def _left(path: ArcPath, fraction: Array) -> Array:
    """Return the unit normals to the left of each piece at a share of its sweep, shape (pieces, 2)."""
    first, _ = directions(path)
    angle = first + sweeps(path) * np.clip(fraction, 0.0, 1.0)
    return np.stack([-np.sin(angle), np.cos(angle)], axis=1)


def _polygon(some: Region) -> Polygon:
    """Return the region as a polygon with holes."""
    rings = [polygon(path, accuracy=FINE_MM) for path in some.contours]
    return Polygon(rings[0], rings[1:]).buffer(0.0)
