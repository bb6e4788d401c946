"""The profile of bent sheet: straight legs and circular bends end to end, smooth but for folds.

A chain is given by its first point and direction and by its legs: lengths, angles and radii.  So bends are tangent to
their neighbours whatever the numbers are, and all numbers can be fitted at once (`fitted`) to the vertices of a mesh,
with the direction of the rulings: Gauss and Newton's steps on the distances of all vertices, their slopes by central
differences.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import cos, sin

import numpy as np
from numpy.typing import NDArray

from stages.geometry.arrays import (
    Array,
    ArrayValue,
    Matrix,
    Numbers,
    Points2,
    Points3,
    Values,
    Vector2,
    cross2,
    diagonal,
    norm,
)

Flags = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Leg:
    """A straight leg, or a bend of a radius, mm, by an angle (counter-clockwise positive), rad.

    fold_rad: by how much the chain turns where the leg begins.  folded: whether it may turn there.
    held: whether the radius is known and not fitted.
    """

    length_mm: float
    turn_rad: float = 0.0
    fold_rad: float = 0.0
    folded: bool = False
    held: bool = False

    @property
    def radius_mm(self) -> float:
        """Return the radius of a bend, positive."""
        return self.length_mm / abs(self.turn_rad)


@dataclass(frozen=True, slots=True, eq=False)
class Chain(ArrayValue):
    """Legs end to end in the plane across the rulings, from a point in a direction (angle from x)."""

    start: Vector2
    heading_rad: float
    legs: tuple[Leg, ...]

    def begins(self) -> Array:
        """Return x, y, direction and length so far at the beginning of each leg and at the end, shape (legs + 1, 4)."""
        x, y, heading, far = float(self.start[0]), float(self.start[1]), self.heading_rad, 0.0
        rows = []
        for leg in self.legs:
            heading += leg.fold_rad
            rows.append((x, y, heading, far))
            half = leg.turn_rad / 2.0
            chord = leg.length_mm * float(np.sinc(half / np.pi))
            x, y = x + chord * cos(heading + half), y + chord * sin(heading + half)
            heading, far = heading + leg.turn_rad, far + leg.length_mm
        return np.array([*rows, (x, y, heading, far)])

    def places(self, points: Points2, leg_of: Numbers) -> tuple[Values, Values]:
        """Return how far along the chain points are that belong to given legs, and how far left of it, mm."""
        along, left = np.zeros(len(points)), np.zeros(len(points))
        for i, (leg, begin) in enumerate(zip(self.legs, self.begins(), strict=False)):
            here = leg_of == i
            forward = np.array([cos(begin[2]), sin(begin[2])])
            offset = points[here] - begin[:2]
            x, y = offset @ forward, cross2(np.broadcast_to(forward, offset.shape), offset)
            if leg.turn_rad == 0.0:
                along[here], left[here] = begin[3] + x, y
            else:
                side, half = np.sign(leg.turn_rad), abs(leg.turn_rad) / 2.0
                down = leg.radius_mm - side * y
                # counted from the middle of the bend, which may turn by more than half a turn
                angle = np.arctan2(x * cos(half) - down * sin(half), down * cos(half) + x * sin(half))
                along[here] = begin[3] + leg.radius_mm * (half + angle)
                left[here] = side * (leg.radius_mm - np.hypot(x, down))
        return along, left

    def distances(self, points: Points2) -> Values:
        """Return how far left of the chain points are, mm: of the nearest leg that they are beside.

        The first and the last leg go on for ever.
        """
        return self._nearest(points, np.zeros((len(self.legs), len(points)), dtype=bool))[1]

    def legs_of(self, points: Points2, before: Numbers) -> Numbers:
        """Return the leg nearest to each point: that which it was taken to belong to, or one of its neighbours."""
        other = np.abs(np.arange(len(self.legs))[:, None] - before) > 1
        return self._nearest(points, other)[0]

    def _nearest(self, points: Points2, left_out: Flags) -> tuple[Numbers, Values]:
        """Return the nearest leg of each point, and how far left of it the point is, mm."""
        begins, last = self.begins()[:, 3], len(self.legs) - 1
        leg, best = np.zeros(len(points), dtype=np.int64), np.full(len(points), np.inf)
        slack = BESIDE * begins[-1]
        for i, out in enumerate(left_out):
            along, left = self.places(points, np.full(len(points), i))
            beside = ((along >= begins[i] - slack) | (i == 0)) & ((along <= begins[i + 1] + slack) | (i == last))
            nearer = beside & ~out & (np.abs(left) < np.abs(best))
            leg, best = np.where(nearer, i, leg), np.where(nearer, left, best)
        return leg, best


BESIDE = 1e-6
"""Share of a chain's length by which a point beside the end of a leg may lie beyond it: there both legs are as near."""


@dataclass(frozen=True, slots=True, eq=False)
class Fitted(ArrayValue):
    """The chain of least squares and the frame of x, y and the rulings' direction that it is seen in, as rows."""

    chain: Chain
    frame: Matrix


def fitted(points: Points3, leg_of: Numbers, start: Fitted) -> Fitted:
    """Return the chain nearest to points in space of which the legs are known, its ends beside the outermost points."""
    found, off = start, _off(start, points, leg_of)
    size = diagonal(points)
    for _ in range(MOST_STEPS):
        scale = _scales(found, size)
        slopes = np.column_stack(
            [
                _off(_moved(found, step), points, leg_of) - _off(_moved(found, -step), points, leg_of)
                for step in np.diag(STEP * scale)
            ]
        ) / (2.0 * STEP)
        move = scale * np.linalg.lstsq(slopes, -off, rcond=LEAST_SLOPE)[0]
        tried = _moved(found, move)
        off_tried = _off(tried, points, leg_of)
        if not off_tried @ off_tried < off @ off:
            break
        found, off = tried, off_tried
    return found


MOST_STEPS = 20
STEP = 1e-5
"""Of the size, of a radius, and rad: differences are exact to its square, and rounding to 1e-11."""
LEAST_SLOPE = 1e-10
"""What moves the points by less is not known by them, and stays."""


def rounded(chain: Chain, near_mm: float) -> Chain:
    """Return the chain with radii held that are within rounding of a number with few decimals, as people give them.

    So few that by accident a radius is as near to one once in ten times at most.
    """
    legs = []
    for leg in chain.legs:
        radius = _few_decimals(leg.radius_mm, near_mm) if leg.turn_rad != 0.0 else None
        legs.append(leg if radius is None else replace(leg, length_mm=radius * abs(leg.turn_rad), held=True))
    return Chain(chain.start, chain.heading_rad, tuple(legs))


def _few_decimals(radius: float, near_mm: float) -> float | None:
    for places in range(MOST_DECIMALS + 1):
        if 10.0**-places < ACCIDENT * near_mm:
            return None
        if round(radius, places) > 0.0 and abs(round(radius, places) - radius) <= near_mm:
            return round(radius, places)
    return None


MOST_DECIMALS = 4
"""Of a radius that a person gives: 1/16 in is 1.5875 mm."""
ACCIDENT = 20.0
"""A number between two of those is within rounding of one of them with 2 in so many."""


def _off(at: Fitted, points: Points3, leg_of: Numbers) -> Array:
    """Return the distances of points, and those of the ends from the outermost ones, mm, shape (n + 2,)."""
    seen = points @ at.frame[:2].T
    along, left = at.chain.places(seen, leg_of)
    length = sum(leg.length_mm for leg in at.chain.legs)
    return np.append(left, [along[leg_of == 0].min(), along[leg_of == leg_of.max()].max() - length])


def _scales(at: Fitted, size: float) -> Values:
    """Return the unit of each unknown."""
    units = [1.0, 1.0, size, size, 1.0]
    for leg in at.chain.legs:
        units += [size] if leg.turn_rad == 0.0 else [1.0] if leg.held else [leg.radius_mm, 1.0]
        units += [1.0] if leg.folded else []
    return np.array(units)


def _moved(at: Fitted, move: Values) -> Fitted:
    """Return a chain with changed numbers: two tilts, the start, its direction, then those of the legs."""
    x, y, d = at.frame
    tilted = d + move[0] * x + move[1] * y
    tilted = tilted / norm(tilted)
    x = x - (x @ tilted) * tilted
    x = x / norm(x)
    rest = iter(move[5:].tolist())
    legs = [_changed(leg, rest) for leg in at.chain.legs]
    chain = Chain(at.chain.start + move[2:4], at.chain.heading_rad + float(move[4]), tuple(legs))
    return Fitted(chain, np.stack([x, np.cross(tilted, x), tilted]))


def _changed(leg: Leg, moves: Iterator[float]) -> Leg:
    """Return a leg with changed numbers: length, or radius and angle; then its fold."""
    if leg.turn_rad == 0.0:
        leg = replace(leg, length_mm=leg.length_mm + next(moves))
    else:
        radius, turn = leg.radius_mm + (0.0 if leg.held else next(moves)), leg.turn_rad + next(moves)
        leg = replace(leg, length_mm=radius * abs(turn), turn_rad=turn)
    return replace(leg, fold_rad=leg.fold_rad + next(moves)) if leg.folded else leg
