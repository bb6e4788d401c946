"""The shapes of notches: what takes the place of a stretch of an outline, or is drawn beside it.

A notch has a place on the outline, a unit vector into the part there, and the stretch of the outline that it takes,
from `start` to `end`.  V: two lines to the tip, `depth` from the place.  Castle: a slot with a square end, U: one with
a half circle for its end, both across the chord of the stretch and `depth` deep.  A slit is one line, a T has a bar of
the stretch's width across its end.
"""

from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import ArrayValue, Vector2, norm, unit
from stages.geometry.curves.plane import CircularArc, PlaneCurve, Segment
from stages.geometry.paths.arcpath import ArcPath
from stages.model.features import NotchSpec


@dataclass(frozen=True, slots=True, eq=False)
class Opening(ArrayValue):
    """Where a notch opens: its place, the unit vector into the part, and the ends of the stretch that it takes."""

    place: Vector2
    inward: Vector2
    start: Vector2
    end: Vector2


def sides(spec: NotchSpec, opening: Opening) -> tuple[PlaneCurve, ...]:
    """Return the edges of a notch that encloses an area, from the start of its opening to the end."""
    depth = float(spec.depth)
    if spec.kind == "v":
        tip = opening.place + depth * opening.inward
        return Segment(opening.start, tip), Segment(tip, opening.end)
    across = opening.end - opening.start
    inward = unit(np.array([-across[1], across[0]]))
    if spec.kind == "castle":
        first, last = opening.start + depth * inward, opening.end + depth * inward
        return Segment(opening.start, first), Segment(first, last), Segment(last, opening.end)
    if spec.kind == "u":
        return _round_end(opening, inward, depth)
    raise ValueError(f"a notch of the kind {spec.kind!r} encloses no area")


def _round_end(opening: Opening, inward: Vector2, depth: float) -> tuple[PlaneCurve, ...]:
    """Return a slot with a half circle for its end; on a hollow edge the slot is a little narrower than asked."""
    across = opening.end - opening.start
    radius = float(norm(across)) / 2.0
    straight = (depth - radius) * inward
    middle = (opening.start + opening.end) / 2.0 + straight
    back = float(np.arctan2(-across[1], -across[0]))
    half = CircularArc(middle, radius, back, -np.pi)
    if depth - radius <= NO_WALL * radius:
        return (CircularArc((opening.start + opening.end) / 2.0, radius, back, -np.pi),)
    return Segment(opening.start, opening.start + straight), half, Segment(opening.end + straight, opening.end)


NO_WALL = 1e-6
"""A U whose walls are shorter than this share of its radius is a half circle."""


def lines(spec: NotchSpec, opening: Opening) -> tuple[ArcPath, ...]:
    """Return the lines of a slit or a T."""
    foot = opening.place + float(spec.depth) * opening.inward
    slit = _line(opening.place, foot)
    if spec.kind == "slit":
        return (slit,)
    along = np.array([opening.inward[1], -opening.inward[0]])
    half = float(spec.width) / 2.0 * along
    return slit, _line(foot - half, foot + half)


def _line(start: Vector2, end: Vector2) -> ArcPath:
    return ArcPath(np.stack([start, end]), np.zeros(2), closed=False)
