"""Paths of lines and circular arcs, as a cutting machine takes them.

A path is an array of vertices and one bulge per vertex: the bulge b_i = tan(sweep / 4) bends the piece from vertex i
to vertex i + 1 (the last one closes the path), positive counter-clockwise, 0 straight.

Points on a piece are computed from its chord and sweep, never from its centre: the centre of a nearly straight arc is
so far away that differences from it lose all digits.  A single piece cannot be a full circle; two of them can.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stages.geometry.arrays import Array, ArrayValue, Indices, Points2, Values, Vector2, cross2, dot, norm, unit
from stages.geometry.curves.rigid import Rigid2, apply
from stages.geometry.paths import arcs


@dataclass(frozen=True, slots=True, eq=False)
class ArcPath(ArrayValue):
    """Vertices in mm, shape (n, 2), bulges, shape (n,), and whether the last vertex joins the first.

    On an open path the last bulge means nothing and is 0.
    """

    vertices: Points2
    bulges: Values
    closed: bool

    def check(self) -> None:
        """Refuse what no machine can follow: unequal counts, too few vertices, numbers that are not finite."""
        if self.vertices.shape != (self.bulges.size, 2) or self.bulges.size < 2:  # noqa: PLR2004
            raise ValueError(f"a path needs n >= 2 vertices and n bulges: {self.vertices.shape}, {self.bulges.shape}")
        if not (np.isfinite(self.vertices).all() and np.isfinite(self.bulges).all()):
            raise ValueError("a path must be finite")
        if not self.closed and self.bulges[-1] != 0.0:
            raise ValueError("the last bulge of an open path must be 0")


def sweeps(path: ArcPath) -> Values:
    """Return the signed sweep of each piece in rad, closing piece included on a closed path."""
    return arcs.sweeps(path.bulges[: piece_count(path)])


def _bends(path: ArcPath) -> Values:
    """Return the bulges of the pieces, those of lines in all but name set to 0."""
    return arcs.bends(path.bulges[: piece_count(path)])


def piece_count(path: ArcPath) -> int:
    """Return the number of lines and arcs."""
    return path.bulges.size if path.closed else path.bulges.size - 1


def chords(path: ArcPath) -> tuple[Points2, Points2]:
    """Return start and end points of the pieces, each of shape (pieces, 2)."""
    vertices = path.vertices
    if path.closed:
        return vertices, np.concatenate([vertices[1:], vertices[:1]])
    return vertices[:-1], vertices[1:]


def centres(path: ArcPath) -> Points2:
    """Return the centres of the arcs, shape (pieces, 2); NaN for straight pieces."""
    start, end = chords(path)
    bulge = _bends(path)
    straight = bulge == 0.0
    safe = np.where(straight, 1.0, bulge)
    offset = (1.0 / safe - safe) / 4.0
    chord = end - start
    centre = (start + end) / 2.0 + offset[:, None] * np.stack([-chord[:, 1], chord[:, 0]], axis=1)
    return np.where(straight[:, None], np.nan, centre)


def radii(path: ArcPath) -> Values:
    """Return the radii of the pieces in mm; infinite for straight ones."""
    return arcs.radii(*chords(path), _bends(path))


def curvatures(path: ArcPath) -> Values:
    """Return the signed curvature of each piece in 1/mm, positive counter-clockwise; 0 for a piece of no length."""
    return arcs.curvatures(*chords(path), _bends(path))


def lengths(path: ArcPath) -> Values:
    """Return the length of each piece in mm; exact."""
    start, end = chords(path)
    return arcs.lengths(start, end, sweeps(path)) if path.bulges.any() else norm(end - start)


def length(path: ArcPath) -> float:
    """Return the length in mm; exact."""
    return float(np.sum(lengths(path)))


def area(path: ArcPath) -> float:
    """Return the signed area of a closed path in mm2, positive counter-clockwise; exact."""
    return float(np.sum(swept(path, path.vertices.mean(axis=0))))


def swept(path: ArcPath, about: Vector2) -> Values:
    """Return the area in mm2 that the line from a point sweeps over along each piece, counter-clockwise; exact."""
    return arcs.areas(*chords(path), sweeps(path), about)


def directions(path: ArcPath) -> tuple[Values, Values]:
    """Return the direction angles at the start and at the end of each piece, in rad."""
    return arcs.directions(*chords(path), sweeps(path))


def joint_turns(path: ArcPath) -> Values:
    """Return the turn at each joint between two pieces in rad, in (-pi, pi]; 0 where they join smoothly.

    Closed: joint i lies at vertex i.  Open: at vertex i + 1.
    """
    first, last = directions(path)
    turn = first - np.roll(last, 1) if path.closed else first[1:] - last[:-1]
    wrapped: Values = np.pi - np.mod(np.pi - turn, 2.0 * np.pi)
    return wrapped


def along(path: ArcPath, piece: Indices, fraction: Values) -> Points2:
    """Return the points at `fraction` of the sweep of the pieces, in mm; exact for any sweep, 0 included."""
    start, end = chords(path)
    return arcs.between(start[piece], end[piece], sweeps(path)[piece], fraction)


def distances(points: Points2, path: ArcPath, piece: Indices) -> Values:
    """Return the distance of each point to its piece of the path, in mm; exact for sweeps up to a half circle.

    To the carrier where the point lies between the normals at both ends of the piece, to the nearer end elsewhere, as
    for a piece of no length.
    """
    start, end = (ends[piece] for ends in chords(path))
    half = (sweeps(path) / 2.0)[piece]
    forward = unit(end - start)
    leaving, arriving = arcs.turned(forward, -half), arcs.turned(forward, half)
    between = (dot(points - start, leaving) >= 0.0) & (dot(points - end, arriving) <= 0.0) & forward.any(axis=1)
    carrier = carrier_distance(points - start, leaving, curvatures(path)[piece])
    return np.where(between, np.abs(carrier), np.minimum(norm(points - start), norm(points - end)))


def carrier_distance(offset: Array, tangent: Array, curvature: Array) -> Array:
    """Return the signed distance to the circle through the origin with that unit tangent and curvature, in mm.

    Positive on the left of the tangent.  No centre is used, so it is stable from straight lines to tight arcs.
    """
    twice = 2.0 * cross2(tangent, offset) - curvature * dot(offset, offset)
    root: Array = np.sqrt(np.maximum(1.0 - curvature * twice, 0.0))
    distance: Array = twice / (1.0 + root)
    return distance


def split(path: ArcPath, *, max_bulge: float) -> ArcPath:
    """Return the same path with its arcs cut into equal parts, none with a bulge above `max_bulge`; exact."""
    count = np.maximum(np.ceil(np.abs(sweeps(path)) / (4.0 * np.arctan(max_bulge)) - arcs.ROUNDING), 1.0).astype(
        np.int64
    )
    return divided(path, count)


def divided(path: ArcPath, count: Indices) -> ArcPath:
    """Return the same path with every piece cut into so many equal parts; exact."""
    if (count == 1).all():
        return path
    piece = np.repeat(np.arange(count.size), count)
    within = np.arange(piece.size) - np.repeat(np.cumsum(count) - count, count)
    vertices = along(path, piece, within / count[piece])
    vertices[within == 0] = path.vertices[: count.size]
    bulges = np.tan(sweeps(path) / (4.0 * count))[piece]
    if path.closed:
        return ArcPath(vertices, bulges, closed=True)
    return ArcPath(np.vstack([vertices, path.vertices[-1:]]), np.append(bulges, 0.0), closed=False)


def transform(path: ArcPath, motion: Rigid2) -> ArcPath:
    """Return the moved path; a mirror turns it round, so that a contour keeps its sense."""
    vertices = apply(motion, path.vertices)
    if not motion.mirrored:
        return ArcPath(vertices, path.bulges, path.closed)
    return backwards(ArcPath(vertices, -path.bulges, path.closed))


def backwards(path: ArcPath) -> ArcPath:
    """Return the same path run the other way."""
    if path.closed:
        return ArcPath(path.vertices[::-1], np.roll(-path.bulges[::-1], -1), closed=True)
    return ArcPath(path.vertices[::-1], np.append(-path.bulges[-2::-1], 0.0), closed=False)


def bounds(path: ArcPath) -> tuple[float, float, float, float]:
    """Return the exact extent (x least, y least, x most, y most) in mm, arcs included."""
    every = np.concatenate([path.vertices, furthest(path)[1]]) if path.bulges.any() else path.vertices
    (low_x, low_y), (high_x, high_y) = every.min(axis=0), every.max(axis=0)
    return float(low_x), float(low_y), float(high_x), float(high_y)


def furthest(path: ArcPath) -> tuple[Indices, Points2]:
    """Return the points at which arcs are furthest out along x and y, mm, with the pieces that they lie on."""
    return arcs.furthest(*chords(path), sweeps(path))


def polygon(path: ArcPath, *, accuracy: float, outside: bool = False) -> Points2:
    """Return points along the path, mm, such that the polygon is within `accuracy` of it.

    The last point of a closed path is not repeated.  With `outside`, the polygon of a closed counter-clockwise path
    contains it: arcs that swell outward are replaced by tangents, hollow ones by chords (a part may only grow).
    """
    sweep = sweeps(path)
    steps = arcs.steps(np.abs(sweep), radii(path), accuracy)
    swelling = (sweep > 0.0) if outside else np.zeros(sweep.size, dtype=bool)
    # a piece gives its start and, if it swells, the corner of two tangents in each step, else the inner chord points
    count = np.where(swelling, steps + 1, steps)
    piece = np.repeat(np.arange(count.size), count)
    within = np.arange(piece.size) - np.repeat(np.cumsum(count) - count, count)
    corner = swelling[piece] & (within > 0)
    fraction = np.where(corner, within - 0.5, within) / steps[piece]
    points = along(path, piece, fraction)
    points[corner] += _overshoot(path, steps, piece[corner], fraction[corner])
    points[within == 0] = path.vertices[: count.size]
    return points if path.closed else np.vstack([points, path.vertices[-1:]])


def _overshoot(path: ArcPath, steps: NDArray[np.int64], piece: Indices, fraction: Values) -> Points2:
    """Return how far the corner of two tangents lies beyond the middle of its step, to the right of the path."""
    first, _ = directions(path)
    sweep = sweeps(path)[piece]
    angle = first[piece] + sweep * fraction - arcs.QUARTER
    half = sweep / steps[piece] / 2.0
    reach = radii(path)[piece] * 2.0 * np.sin(half / 2.0) ** 2 / np.cos(half)
    beyond: Points2 = reach[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return beyond
