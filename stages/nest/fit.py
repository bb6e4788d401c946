"""In which hands and angles a part fits a sheet, and in which it is tried.

A list of angles is tried as it stands.  A part that may be turned freely is tried along the rectangle of least area
about it [1]_, in four quarter turns, within an outline in sixteen steps; of a span of angles along the grain some are
tried.  Angles in which the part covers the same are tried once.

Where none of them fits, its widths decide.  The width of a convex polygon as a function of the angle is one sine arc
between the directions of two edges.  The set of angles in which both widths are small enough is therefore bounded by
edge directions and by the solutions of D cos(angle - phase) = width on each arc: if any angle fits, one of these does.

.. [1] H. Freeman, R. Shapira, "Determining the minimum-area encasing rectangle for an arbitrary closed curve",
   Communications of the ACM 18 (1975) 409-413.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from stages.geometry.arrays import Array, Points2, Values, locked
from stages.geometry.curves.rigid import Rigid2, apply
from stages.geometry.paths.arcpath import polygon
from stages.model.sheet import NestOptions
from stages.nest.blank import Bed, Blank, Turned, extent, fits, fits_turned, turned
from stages.nest.turns import ANY, Turns, allowed, contains

QUARTER_DEG, FULL_DEG = 90.0, 360.0

OUTLINE_STEP_DEG = 22.5
"""Within an outline, and beside defects and zones, no direction is better than another: 16 are tried."""

SHARES = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Where a span of angles is tried: its ends, its middle, and between."""

FINE_CHORD_MM = 1e-3
"""Chord error of the hull in the test for the last resort: what the exact box may gain is less than this."""

HULL_MORE_MM = 3.0 * FINE_CHORD_MM
"""The hull is wider than the exact box by less than this: a chord error on either side, and rounding."""

KEPT = 8
"""Hulls of the parts asked for last: every stock asks for the same one."""

ALIKE = 1e-6
"""Rectangles whose areas differ by less, relative to the larger, are the same: the smaller angle is taken."""


SAME_BOX_MM = 1e-6
"""Boxes of the same size, up to the rounding of a turn."""

NONE = Turns(())
"""No angle at all."""


@dataclass(frozen=True, eq=False)
class Kind:
    """One lot, the copies of a part that are alike, in every hand and angle in which it is tried.

    hands: the part as it is, or mirrored, or both where the copies may be either.
    ways: for each piece of stock, what fits there and is allowed.
    spans: for each piece of stock, by which angles each of the hands may be turned there.
    turns: all that was tried, of whatever stock, whether it fits or not.
    """

    hands: tuple[Blank, ...]
    ways: tuple[tuple[Turned, ...], ...]
    spans: tuple[tuple[Turns, ...], ...]
    turns: tuple[Turned, ...]

    @property
    def blank(self) -> Blank:
        """The first of the hands."""
        return self.hands[0]

    def on(self, bed: Bed) -> tuple[Turned, ...]:
        """Return what fits a bed and is allowed there."""
        return self.ways[bed.stock]

    def allowed(self, bed: Bed, blank: Blank) -> Turns:
        """Return by which angles one of the hands may be turned on a bed."""
        return self.spans[bed.stock][self.hands.index(blank)]

    def in_one_way(self, number: int) -> "Kind":
        """Return the lot with one angle left for each hand: of those that fit the most stocks, the one of that number.

        The number counts round and round.
        """
        fitting = Counter(id(one) for ways in self.ways for one in ways)
        most = max(fitting.values(), default=0)
        kept = set()
        for hand in self.hands:
            best = [one for one in self.turns if one.blank is hand and fitting[id(one)] == most]
            kept |= {id(best[number % len(best)])} if best else set()
        return self.only([one for one in self.turns if id(one) in kept])

    def only(self, wanted: Sequence[Turned]) -> "Kind":
        """Return the lot with these ways left; a hand that is not among them is not used any more."""
        allowed_ways = {id(one) for one in wanted}
        angle = {one.blank: Turns(((one.angle_deg, one.angle_deg),)) for one in wanted}
        spans = tuple(tuple(angle.get(hand, NONE) for hand in self.hands) for _ in self.spans)
        ways = tuple(tuple(one for one in ways if id(one) in allowed_ways) for ways in self.ways)
        return replace(self, ways=ways, spans=spans, turns=tuple(wanted) or self.turns)


def kind(hands: Sequence[Blank], beds: Sequence[Bed], options: NestOptions) -> Kind:
    """Return a lot in every hand and angle in which it is to be tried on these beds."""
    angles: dict[tuple[Blank, float], Turned] = {}
    spans = [tuple(allowed(one.pattern, bed.sheet, options, mirrored=one.mirrored) for one in hands) for bed in beds]
    ways = []
    for bed, turns in zip(beds, spans, strict=True):
        by_hand = zip(hands, turns, strict=True)
        wanted = [(hand, angle) for hand, span in by_hand for angle in angles_on(hand, bed, span)]
        for hand, angle in wanted:
            if (hand, angle) not in angles:
                angles[hand, angle] = turned(hand, angle)
        ways.append(_unlike([angles[one] for one in wanted if fits(angles[one], bed)]))
    tried = tuple(angles.values()) or tuple(turned(hand, 0.0) for hand in hands)
    return Kind(tuple(hands), tuple(ways), tuple(spans), tried)


def _unlike(ways: Sequence[Turned]) -> tuple[Turned, ...]:
    """Return the ways without those in which the part covers the same as in one before: a square is not turned."""
    kept: list[Turned] = []
    for one in ways:
        if not any(_alike(one, other) for other in kept):
            kept.append(one)
    return tuple(kept)


def _alike(a: Turned, b: Turned) -> bool:
    """Return whether two ways cover the same; their lower left corners lie at the origin."""
    near = abs(a.width_mm - b.width_mm) + abs(a.height_mm - b.height_mm) <= SAME_BOX_MM
    return near and float(a.shape.symmetric_difference(b.shape).area) < ALIKE * float(a.shape.area)


def angles_on(blank: Blank, bed: Bed, turns: Turns) -> tuple[float, ...]:
    """Return the angles in which a part is tried on a bed."""
    if turns.angles is not None:
        return turns.angles
    tried = spread_angles(blank, bed, turns)
    if any(fits_turned(blank, angle, bed) for angle in tried):
        return tried
    return (*tried, *fitting_angles(blank, bed, turns))


def spread_angles(blank: Blank, bed: Bed, turns: Turns) -> tuple[float, ...]:
    """Return the tight angles that are allowed, more of them within an outline, and some of each span."""
    step = QUARTER_DEG if bed.plain else OUTLINE_STEP_DEG
    free = [angle for angle in steps(tight_angle(hull(blank)), step) if contains(turns, angle)]
    if turns.spans is None:
        return tuple(free)
    banded = [low + share * (high - low) for low, high in turns.spans for share in (SHARES if low < high else (0.0,))]
    return tuple(dict.fromkeys([*free, *(angle % FULL_DEG for angle in banded)]))


def steps(angle_deg: float, step_deg: float) -> tuple[float, ...]:
    """Return an angle and all that lie whole steps from it, in [0, 360) degrees."""
    return tuple((angle_deg + number * step_deg) % FULL_DEG for number in range(round(FULL_DEG / step_deg)))


@lru_cache(maxsize=KEPT)
def hull(blank: Blank) -> Points2:
    """Return the corners of the convex hull of a part, mirrored if its blank is, as one counter-clockwise loop."""
    from scipy.spatial import ConvexHull

    flat = polygon(blank.pattern.outer.path, accuracy=FINE_CHORD_MM, outside=True)
    points = apply(Rigid2(mirrored=blank.mirrored), flat)
    return locked(points[ConvexHull(points - points.mean(axis=0)).vertices])


def tight_angle(corners: Points2) -> float:
    """Return the least angle in [0, 90) degrees that lays the rectangle of least area along the axes."""
    angle = np.unique(np.round(-_directions(corners) % QUARTER_DEG, 12) % QUARTER_DEG)
    width, height = widths(corners, angle), widths(corners, angle + QUARTER_DEG)
    size = width * height
    return float(angle[np.flatnonzero(size <= size.min() * (1.0 + ALIKE))[0]])


def widths(corners: Points2, angle_deg: Array) -> Array:
    """Return how wide, along x, the corners are after each turn; mm."""
    turn, span = np.radians(angle_deg), _spans(corners, angle_deg)
    extent: Array = span[:, 0] * np.cos(turn) - span[:, 1] * np.sin(turn)
    return extent


def _spans(corners: Points2, angle_deg: Array) -> Array:
    """Return the way from the leftmost to the rightmost corner after each turn, in the frame before it; mm.

    Along a convex loop the corner that is furthest in a direction lies where the edges turn past the normal to it.
    """
    edge = _directions(corners) % FULL_DEG
    order = np.argsort(edge)
    right, left = (
        corners[order[np.searchsorted(edge[order], (normal - angle_deg) % FULL_DEG) % order.size]]
        for normal in (QUARTER_DEG, -QUARTER_DEG)
    )
    span: Array = right - left
    return span


def fitting_angles(blank: Blank, bed: Bed, turns: Turns = ANY) -> tuple[float, ...]:
    """Return the allowed angle of least height in which a part fits a bed, and its half turn if that is allowed too."""
    corners = hull(blank)
    grow = 2.0 * blank.grow_mm
    wanted = (bed.width_mm - grow, bed.height_mm - grow)
    exact = np.concatenate(list(_critical_angles(corners, wanted)))
    candidates = np.unique(np.concatenate([exact, exact - INSIDE_DEG, exact + INSIDE_DEG]))
    wide, high = widths(corners, candidates), widths(corners, candidates + QUARTER_DEG)
    candidates = candidates[(wide <= wanted[0] + HULL_MORE_MM) & (high <= wanted[1] + HULL_MORE_MM)]
    both = (tuple(one for one in _half_turns(angle) if contains(turns, one)) for angle in candidates.tolist())
    fitting = [ways for ways in both if ways and fits_turned(blank, ways[0], bed)]
    return min(fitting, key=lambda ways: extent(blank, ways[0])[3], default=())


def _half_turns(angle_deg: float) -> tuple[float, float]:
    """Return an angle and its half turn: the part has the same box in both."""
    return angle_deg % FULL_DEG, (angle_deg + 2.0 * QUARTER_DEG) % FULL_DEG


INSIDE_DEG = 1e-9
"""A bound of the angles that fit may itself be refused by rounding, and so may the other; this far inside it is not.
A part of 10 m changes its width by 2e-10 m over it."""


def _critical_angles(corners: Points2, wanted: tuple[float, float]) -> Iterator[Array]:
    """Yield the angles in [0, 180) where a width changes its sine arc or equals what is wanted."""
    edge = -_directions(corners)
    breaks = np.unique(np.concatenate([edge, edge + QUARTER_DEG]) % (2.0 * QUARTER_DEG))
    yield breaks
    middle = (breaks + np.append(breaks[1:], breaks[0] + 2.0 * QUARTER_DEG)) / 2.0
    half = (np.append(breaks[1:], breaks[0] + 2.0 * QUARTER_DEG) - breaks) / 2.0
    for turn, size in zip((0.0, QUARTER_DEG), wanted, strict=True):
        for solution in _solutions(corners, middle + turn, size):
            inside = np.abs(solution - middle - turn) <= half
            yield (solution - turn)[inside] % (2.0 * QUARTER_DEG)


def _solutions(corners: Points2, middle_deg: Array, size: float) -> tuple[Array, Array]:
    """Return the two angles nearest each middle at which the width of its sine arc is `size`; NaN where none is."""
    turn, span = np.radians(middle_deg), _spans(corners, middle_deg)
    length, phase = np.hypot(span[:, 0], span[:, 1]), np.arctan2(span[:, 1], span[:, 0])
    with np.errstate(invalid="ignore"):
        away = np.arccos(size / length)
    near = [(sign * away - phase - turn + np.pi) % (2.0 * np.pi) - np.pi for sign in (1.0, -1.0)]
    return np.degrees(near[0]) + middle_deg, np.degrees(near[1]) + middle_deg


def _directions(corners: Points2) -> Values:
    """Return the directions of the edges of a loop in degrees."""
    edge = np.roll(corners, -1, axis=0) - corners
    direction: Values = np.degrees(np.arctan2(edge[:, 1], edge[:, 0]))
    return direction
