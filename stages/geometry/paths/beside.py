"""The curve beside a closed path, at a constant distance to its right: the way of a cutter's middle, exact.

An offset of a line is a line, that of an arc an arc about the same centre.  Where the path turns left, a corner, the
gap is closed by an arc about the corner, or by the corner of two tangents (three beyond a right angle, and so on);
where it turns right, or leads into a notch, the offsets cross and what lies beyond the crossing is nearer than the
distance [1]_.  So all offsets are strung into one closed path, it is cut wherever it meets itself (`cover`), and those
of its pieces stay whose distance to the path, in closed form, is the distance asked for.  What stays closes again, as
one curve or as several: a notch with a mouth narrower than twice the distance is cut off, a hole as narrow vanishes.

Joints that would take an arc shorter than `least_mm` are met by running the offsets on to where they cross, so that no
piece arises that is too short to cut.  Not for a path that crosses itself.

.. [1] X.-Z. Liu, J.-H. Yong, G.-Q. Zheng, J.-G. Sun, "An offset algorithm for polyline curves", Computers in Industry
   58, 2007.
"""

from dataclasses import dataclass

import numpy as np
from shapely import STRtree, box, points

from stages.errors import NoSolutionError
from stages.geometry.arrays import Indices, Points2, Values, Vector2, cross2, norm, unit
from stages.geometry.paths.arcpath import (
    ArcPath,
    along,
    bounds,
    carrier_distance,
    chords,
    curvatures,
    directions,
    joint_turns,
    lengths,
    split,
)
from stages.geometry.paths.clearance import boxes, pieces, point_distances
from stages.geometry.paths.cover import COINCIDENT, divided, meetings
from stages.geometry.paths.overlap import QUARTER_BULGE

NEAR_MM = 1e-6
"""A piece this much nearer than the distance is beyond a crossing: what stays is exact to 1e-8, what goes, by 1e-4."""

MEET_MM = 1e-5
"""Pieces that stay follow each other to rounding; where the next one is farther than this, the curve does not close."""

TANGENT_RAD = 1e-4
"""Below this turn both offsets pass the point that the bisector gives by 1e-8 of the distance, and Newton's steps would
divide by the turn."""

STEPS = 4
"""Newton's steps, from a start that is off by the square of the joint's length: each squares the error."""

STRAIGHT_RAD = 1e-9
"""Lines that turn less go straight on: over 10 m that is 1e-5 mm."""

MITRE_RAD = np.pi / 2.0
"""The most that one corner of tangents turns: its tip is 1.41 times the distance away, not farther."""


@dataclass(frozen=True, slots=True)
class Corners:
    """How the gap at a corner is closed: tangents if `mitred`, else an arc unless it is shorter than `least_mm`."""

    mitred: bool = False
    least_mm: float = 0.0


ROUND = Corners()


def beside(path: ArcPath, distance: float, corners: Corners = ROUND) -> tuple[ArcPath, ...]:
    """Return the closed curves at `distance` mm to the right of a closed path, in its order; there may be none.

    Of an outline, counter-clockwise, that is outside of it, of a hole, clockwise, inside the hole.
    """
    if distance == 0.0:
        return (path,)
    gentle = split(path, max_bulge=QUARTER_BULGE)
    strung = _strung(gentle, distance, corners)
    if strung is None:
        return ()
    low_x, low_y, high_x, high_y = bounds(strung)
    apart = COINCIDENT * max(high_x - low_x, high_y - low_y)
    cut = divided(strung, meetings(strung, apart), apart)
    every = np.arange(lengths(cut).size)
    far = nearest(along(cut, every, np.full(every.size, 0.5)), gentle, distance)
    return tuple(_lines_joined(one) for one in _closed(cut, np.flatnonzero(far >= distance - NEAR_MM)))


def nearest(places: Points2, path: ArcPath, within: float) -> Values:
    """Return the distance of each place to a path, mm, exact; inf where it is more than about `within`."""
    some = pieces(path)
    low_high = boxes(some)
    reach = within + MEET_MM
    tree = STRtree(box(*(low_high[:, :2] - reach).T, *(low_high[:, 2:] + reach).T))
    place, piece = tree.query(points(places))
    least = np.full(places.shape[0], np.inf)
    np.minimum.at(least, place, point_distances(places[place], some.take(piece.astype(np.int64))))
    return least


def _strung(path: ArcPath, distance: float, corners: Corners) -> ArcPath | None:
    """Return all offsets of a path as one closed path, what crosses and all; None if nothing is left."""
    turn = joint_turns(path)
    first, last = directions(path)
    start, end = chords(path)
    begin, finish = start + distance * _right(first), end + distance * _right(last)
    run_on = np.abs(turn) * distance <= max(corners.least_mm, TANGENT_RAD * distance)
    meets = _meeting(path, distance, turn)
    begin = np.where(run_on[:, None], meets, begin)
    finish = np.where(np.roll(run_on, -1)[:, None], np.roll(meets, -1, axis=0), finish)
    bulge = _bulges(path, distance, norm(finish - begin))
    vertices, bulges = [], []
    for i in range(turn.size):
        if not run_on[i]:
            gap, bends = _gap(path.vertices[i], distance, (float(first[i] - turn[i]), float(turn[i])), corners)
            vertices += [finish[i - 1], *gap]
            bulges += bends
        vertices.append(begin[i])
        bulges.append(bulge[i])
    return _without_empty(np.stack(vertices), np.array(bulges))


def _right(angle: Values) -> Points2:
    """Return the unit vectors to the right of directions."""
    right: Points2 = np.stack([np.sin(angle), -np.cos(angle)], axis=1)
    return right


def _bulges(path: ArcPath, distance: float, chord: Values) -> Values:
    """Return the bulges of offset pieces with those chords: 0 for arcs that the distance turns inside out."""
    curvature = curvatures(path)
    room = 1.0 + curvature * distance
    bend = np.divide(curvature, room, out=np.zeros_like(room), where=room > 0.0)
    bulge: Values = np.tan(np.arcsin(np.clip(chord * bend / 2.0, -1.0, 1.0)) / 2.0)
    return bulge


def _gap(
    vertex: Vector2, distance: float, turning: tuple[float, float], corners: Corners
) -> tuple[list[Vector2], list[float]]:
    """Return the vertices between two offsets at a corner, and the bulges from the end of the first on.

    turning: the direction in which the path arrives, and how much it turns, rad.
    """
    arriving, turn = turning
    if turn < 0.0:
        return [], [0.0]
    if not corners.mitred:
        return [], [float(np.tan(turn / 4.0))]
    count = int(np.ceil(turn / MITRE_RAD - COINCIDENT))
    step = turn / count
    angle = arriving + step * (np.arange(count) + 0.5)
    tips = vertex + distance / np.cos(step / 2.0) * _right(angle)
    return list(tips), [0.0] * (count + 1)


def _meeting(path: ArcPath, distance: float, turn: Values) -> Points2:
    """Return where the offsets of the pieces before and after each vertex cross, near the bisector of the corner."""
    first, last = directions(path)
    before, bend = np.roll(last, 1), curvatures(path)
    bends = np.roll(bend, 1)
    away = distance / np.cos(np.minimum(np.abs(turn), MITRE_RAD) / 2.0)
    place: Points2 = path.vertices + away[:, None] * _right(before + turn / 2.0)
    steep = np.abs(turn) > TANGENT_RAD
    for _ in range(STEPS):
        one, p = _off(place - path.vertices, before, bends, distance)
        other, q = _off(place - path.vertices, first, bend, distance)
        sine = np.where(steep, cross2(p, q), 1.0)
        step = np.stack([one * q[:, 1] - other * p[:, 1], other * p[:, 0] - one * q[:, 0]], axis=1)
        place = np.where(steep[:, None], place - step / sine[:, None], place)
    return place


def _off(offset: Points2, angle: Values, curvature: Values, distance: float) -> tuple[Values, Points2]:
    """Return how far places are to the left of an offset, mm, and the unit directions in which that grows.

    offset: of the places from a point of the piece, where its direction is `angle`.
    """
    left = -_right(angle)
    tangent = np.stack([left[:, 1], -left[:, 0]], axis=1)
    far = carrier_distance(offset, tangent, curvature) + distance
    return far, unit(left - curvature[:, None] * offset)


def _without_empty(vertices: Points2, bulges: Values) -> ArcPath | None:
    """Return the closed path without its pieces of no length; None if that leaves none."""
    long = norm(np.roll(vertices, -1, axis=0) - vertices) > 0.0
    if np.count_nonzero(long) < 2:  # noqa: PLR2004  no path
        return None
    return ArcPath(vertices[long], bulges[long], closed=True)


def _closed(cut: ArcPath, kept: Indices) -> list[ArcPath]:
    """Return the kept pieces of a path as closed curves, each from its first piece on."""
    start, end = chords(cut)
    left, curves = dict.fromkeys(kept.tolist()), list[ArcPath]()
    while left:
        run = [next(iter(left))]
        while norm(end[run[-1]] - start[run[0]]) > MEET_MM:
            del left[run[-1]]
            run.append(_next(run[-1], left, start, end))
        del left[run[-1]]
        if len(run) > 1:
            curves.append(ArcPath(start[run], cut.bulges[run], closed=True))
    return curves


def _lines_joined(path: ArcPath) -> ArcPath:
    """Return the closed path with lines that go straight on as one."""
    straight = (path.bulges == 0.0) & (np.roll(path.bulges, 1) == 0.0) & (np.abs(joint_turns(path)) <= STRAIGHT_RAD)
    if not straight.any():
        return path
    return ArcPath(path.vertices[~straight], path.bulges[~straight], closed=True)


def _next(piece: int, left: dict[int, None], start: Points2, end: Points2) -> int:
    """Return the kept piece that goes on where one ends: the next one, or that beyond the crossing."""
    follows: int = (piece + 1) % start.shape[0]
    if follows in left:
        return follows
    others = [*left]
    away: Values = norm(start[others] - end[piece])
    least = float(away.min(initial=np.inf))
    if least > MEET_MM:
        raise NoSolutionError("the curve beside a contour", reached=least, wanted=MEET_MM, unit="mm")
    return others[int(away.argmin())]
