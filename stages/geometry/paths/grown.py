"""A closed path moved to its right, piece by piece, so that what lies on its left only grows.

Each piece moves along its normals by a shift of its own: a line stays a line of the same direction, an arc keeps its
centre and sweep.  Where two pieces meet smoothly they must move alike, and then meet smoothly again; elsewhere they are
cut, or run on, to where their lines and circles cross: corners stay corners.  Nothing is rounded off, and nothing is
put in between, so there are as many pieces as before.

Not for a shift that uses up a piece, or an arc that bends to the right with a smaller radius than it: None then.
"""

from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import EPS, Mask, Points2, Values, cross2, dot, norm
from stages.geometry.paths.arcpath import (
    ArcPath,
    carrier_distance,
    centres,
    chords,
    curvatures,
    directions,
    joint_turns,
    sweeps,
)

SMOOTH_RAD = np.radians(20.0)
"""Pieces that meet at less than this move alike: where their shifts differ, the crossing would be far away."""

PARALLEL_RAD = 1e-5
"""Below this turn two pieces of one shift touch rather than cross: the point between their shifted ends is off both by
its square, 1e-10 of the shift."""

NEWTON_STEPS = 8
ROUNDING = 64.0 * EPS
"""As a share of the coordinates: how near to both carriers a crossing must come."""


@dataclass(frozen=True, slots=True, eq=False)
class _Carriers:
    """Lines and circles through points with a direction: unit tangents, and curvatures in 1/mm."""

    points: Points2
    tangents: Points2
    curvatures: Values

    def far(self, places: Points2) -> Values:
        """Return how far to the left of each its place is, mm."""
        return carrier_distance(places - self.points, self.tangents, self.curvatures)

    def normals(self, places: Points2) -> Points2:
        """Return the directions in which those distances grow."""
        offset = places - self.points
        left = np.stack([-self.tangents[:, 1], self.tangents[:, 0]], axis=1)
        slope = left - self.curvatures[:, None] * offset
        normals: Points2 = slope / np.maximum(norm(slope), EPS)[:, None]
        return normals


def grown(path: ArcPath, shifts: Values) -> ArcPath | None:
    """Return the closed path with its pieces moved to the right by at least their shifts, mm; None if one is used up.

    Pieces that meet smoothly move by the largest of their shifts.
    """
    turn = joint_turns(path)
    shifts = _alike(shifts, np.abs(turn) < SMOOTH_RAD)
    curvature = curvatures(path)
    room = 1.0 + curvature * shifts
    if not (room > 0.0).all():
        return None
    vertices = _vertices(path, shifts, turn, curvature / room)
    return None if vertices is None else _between(path, vertices)


def _alike(shifts: Values, smooth: Mask) -> Values:
    """Return the largest shift of each run of smoothly meeting pieces; smooth: whether each so meets the one before."""
    corners = np.flatnonzero(~smooth)
    if corners.size == 0:
        return np.full_like(shifts, shifts.max())
    turned = np.roll(shifts, -corners[0])
    starts = corners - corners[0]
    highest = np.maximum.reduceat(turned, starts)
    spread: Values = np.roll(np.repeat(highest, np.diff(np.append(starts, shifts.size))), corners[0])
    return spread


def _vertices(path: ArcPath, shifts: Values, turn: Values, curvature: Values) -> Points2 | None:
    """Return where the shifted pieces meet; None where they do not."""
    first, last = directions(path)
    before, after = _tangents(np.roll(last, 1)), _tangents(first)
    aside, ahead = np.roll(shifts, 1), shifts
    one = _Carriers(path.vertices + aside[:, None] * _right(before), before, np.roll(curvature, 1))
    other = _Carriers(path.vertices + ahead[:, None] * _right(after), after, curvature)
    places: Points2 = (one.points + other.points) / 2.0
    crossing = np.flatnonzero(np.abs(turn) >= PARALLEL_RAD)
    at = path.vertices[crossing] + _of_lines(before, after, aside, ahead)[crossing]
    one, other = (_Carriers(c.points[crossing], c.tangents[crossing], c.curvatures[crossing]) for c in (one, other))
    found = _crossings(one, other, at)
    if found is None:
        return None
    places[crossing] = found
    return places


def _of_lines(before: Points2, after: Points2, aside: Values, ahead: Values) -> Points2:
    """Return from each vertex where lines of those tangents cross, so far to the right of it; 0 for parallel ones."""
    sine = cross2(before, after)
    safe = np.where(np.abs(sine) > 0.0, sine, np.inf)
    crossing: Points2 = (ahead[:, None] * before - aside[:, None] * after) / safe[:, None]
    return crossing


def _crossings(one: _Carriers, other: _Carriers, places: Points2) -> Points2 | None:
    """Return where carriers cross near given places, by Newton's method; None if one pair does not."""
    allowed = ROUNDING * (1.0 + float(np.abs(places).max(initial=0.0)))
    for _ in range(NEWTON_STEPS):
        far = one.far(places), other.far(places)
        if max(np.abs(far[0]).max(initial=0.0), np.abs(far[1]).max(initial=0.0)) <= allowed:
            return places
        p, q = one.normals(places), other.normals(places)
        sine = cross2(p, q)
        if (np.abs(sine) < PARALLEL_RAD / 2.0).any():
            return None
        step = np.stack([far[0] * q[:, 1] - far[1] * p[:, 1], far[1] * p[:, 0] - far[0] * q[:, 0]], axis=1)
        places = places - step / sine[:, None]
    return None


def _between(path: ArcPath, vertices: Points2) -> ArcPath | None:
    """Return the path through the moved vertices, arcs about the same centres; None if a piece runs backwards."""
    start, end = vertices, np.roll(vertices, -1, axis=0)
    sweep = sweeps(path)
    bent = sweep != 0.0
    centre = np.where(bent[:, None], centres(path), 0.0)
    left, arrive = start - centre, end - centre
    angle = np.arctan2(cross2(left, arrive), dot(left, arrive))
    swept = sweep + np.pi - np.mod(np.pi - (angle - sweep), 2.0 * np.pi)
    was, now = chords(path), end - start
    forward = np.where(bent, swept * np.sign(sweep), dot(was[1] - was[0], now))
    if not (forward > 0.0).all():
        return None
    return ArcPath(vertices, np.where(bent, np.tan(swept / 4.0), 0.0), closed=True)


def _tangents(angle: Values) -> Points2:
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _right(tangents: Points2) -> Points2:
    return np.stack([tangents[:, 1], -tangents[:, 0]], axis=1)
