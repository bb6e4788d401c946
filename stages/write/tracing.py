"""A pattern with the contours that a pattern file holds: chords, with the vertices told apart, and points for notches.

    as_pattern(pattern) -> FlatPattern

A vertex is a turn point where the outline has a corner, and where a straight edge ends: a program that draws its own
curves through curve points would bend the edge.  All other vertices are curve points and lie on the exact curve.

The outline is the one before notches were cut into it, with a vertex at each of them: a pattern file says a notch by
place, depth and width, and whoever cuts has a tool for it.  Round drill and stitch holes become points too; a drilled
hole whose image is not round stays a contour.  The finer curve of each contour is within a quarter of its tolerance.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import pi, radians

import numpy as np

from stages.geometry.arrays import Array, Points2, Vector2, norm
from stages.geometry.curves.plane import CircularArc, PlaneCurve
from stages.geometry.flat.sampling import resolved, samples
from stages.geometry.paths.arcpath import ArcPath, distances, joint_turns, piece_count, polygon
from stages.geometry.paths.inscribed import has_length, inscribed
from stages.model.pattern import Contour, Drill, FlatPattern, Traced

CORNER_RAD = radians(0.5)
"""Arcs of a smooth curve join within 0.2 degrees; what turns by more than twice that is a corner."""

FINER = 0.25
"""The share of the tolerance for the curve that others are compared with: it must be known better than they are."""

GRID_SHARE, CHORD_SHARE = 0.01, 0.95
"""What the points that stand for an edge may be off it, and what chords may use of the tolerance besides."""

COARSE = 65
"""Points by which the turning of an edge is told."""

STEP_RAD, STRAIGHT_RAD = 0.5, 1e-9
"""No finer chord stands for a wider turn; an edge that turns by less than the other is straight."""

MORE = 1.05
"""By how much more points are tried at least, where the height says that fewer would do."""

SAME_MM = 1e-6
"""A notch as near to a vertex as this lies on it."""

ROUND = 1e-9
"""How much a full circle may miss a full turn, rad."""


def as_pattern(pattern: FlatPattern) -> FlatPattern:
    """Return the pattern as a pattern file holds it; one that is so already stays as it is."""
    if pattern.outer.traced is not None:
        return pattern
    lines = {notch.name for notch in pattern.notches if not notch.in_outline}
    return pattern.replace(
        outer=_notched(traced(pattern.boundary or pattern.outer), [notch.at for notch in pattern.notches]),
        inner=tuple(traced(hole) for hole in pattern.inner if drill_of(hole) is None),
        marks=tuple(mark for mark in pattern.marks if not (mark.name in lines and mark.layer in ("MARK", "CUT_SLIT"))),
        boundary=None,
        drills=tuple(drill for drill in map(drill_of, pattern.inner) if drill is not None),
    )


def drill_of(hole: Contour) -> Drill | None:
    """Return what a drill or punch needs to know of a hole that is made by one; None for all others."""
    if hole.purpose == "cut" or len(hole.edges) != 1:
        return None
    (edge,) = hole.edges
    if not isinstance(edge, CircularArc):
        return None
    if abs(abs(edge.sweep_rad) - 2.0 * pi) > ROUND:
        return None
    return Drill(hole.name, edge.centre, 2.0 * edge.radius, hole.purpose)


def traced(contour: Contour) -> Contour:
    """Return a contour of chords with its turn points and its finer curve."""
    if not contour.path.bulges.any():
        finer = path = contour.path
    else:
        path = inscribed(contour.edges, accuracy=contour.chord_mm)
        finer_edges = [_finer(edge, FINER * contour.chord_mm) for edge in contour.edges]
        points = np.concatenate([some[:-1] for some in finer_edges if has_length(some)])
        finer = ArcPath(points, np.zeros(points.shape[0]), closed=True)
    turns = flagged(path.vertices, turn_places(contour.path), contour.chord_mm)
    return replace(contour, path=path, traced=Traced(turns, finer))


def _finer(edge: PlaneCurve, accuracy: float) -> Points2:
    """Return points along an edge, its ends among them, whose chords are within `accuracy` mm of it.

    Chords follow each other evenly in length and turning; their height is step * turn / 8, measured on the points.
    """
    known = resolved(edge, accuracy=GRID_SHARE * accuracy)
    turn = float(np.abs(np.diff(samples(known, count=COARSE).angle)).sum())
    count = 1.0 + np.ceil(turn / STEP_RAD) if turn > STRAIGHT_RAD else 1.0
    while True:
        found = samples(known, count=int(count) + 1)
        step = norm(np.diff(found.points, axis=0))
        high = float((step * np.abs(np.diff(found.angle))).max()) / 8.0 / (CHORD_SHARE * accuracy)
        if high <= 1.0:
            return found.points
        count = np.ceil(count * max(float(np.sqrt(high)), MORE))


def chorded_line(path: ArcPath, chord_mm: float) -> tuple[ArcPath, Traced]:
    """Return the chords of a path of lines and arcs that stands for itself, and what a pattern file says of them."""
    line, finer = (_straight(path, share * chord_mm) for share in (1.0, FINER))
    return line, Traced(flagged(line.vertices, turn_places(path), SAME_MM), finer)


def _straight(path: ArcPath, accuracy: float) -> ArcPath:
    points = polygon(path, accuracy=accuracy)
    return ArcPath(points, np.zeros(points.shape[0]), path.closed)


def turn_places(path: ArcPath) -> Points2:
    """Return the vertices of a path of lines and arcs that are corners or ends: of straight pieces, or of the path."""
    count = piece_count(path)
    straight = path.bulges[:count] == 0.0
    sharp = np.abs(joint_turns(path)) > CORNER_RAD
    if path.closed:
        ends = sharp | straight | np.roll(straight, 1)
    else:
        ends = np.concatenate([[True], sharp | straight[1:] | straight[:-1], [True]])
    places: Points2 = path.vertices[ends]
    return places


def flagged(points: Points2, places: Array, within: float) -> tuple[bool, ...]:
    """Return which of the points are the nearest ones to places, shape (places, 2), as far as they are near."""
    flags = np.zeros(points.shape[0], dtype=bool)
    if places.size:
        from scipy.spatial import cKDTree

        away, nearest = cKDTree(points).query(places)
        flags[nearest[away <= within]] = True
    return tuple(flags.tolist())


def _notched(contour: Contour, places: Sequence[Vector2]) -> Contour:
    """Return a contour with a vertex at each place on it, a curve point where there was none."""
    for at in places:
        contour = _with_vertex(contour, at)
    return contour


def _with_vertex(contour: Contour, at: Vector2) -> Contour:
    path, said = contour.path, contour.traced
    if said is None or norm(path.vertices - at).min() <= SAME_MM:
        return contour
    count = piece_count(path)
    after = 1 + int(distances(np.broadcast_to(at, (count, 2)), path, np.arange(count)).argmin())
    vertices = np.insert(path.vertices, after, at, axis=0)
    turns = (*said.turns[:after], False, *said.turns[after:])
    return replace(contour, path=ArcPath(vertices, np.zeros(count + 1), closed=True), traced=Traced(turns, said.finer))
