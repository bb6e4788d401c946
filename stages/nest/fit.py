"""In which angles a part fits a sheet, and in which it is tried.

A list of angles is tried as it stands.  A part that may be turned freely is tried along the rectangle of least area
about it [1]_, in four quarter turns; where none of them fits, its widths decide.  The width of a convex polygon as a
function of the angle is one sine arc between the directions of two edges.  The set of angles in which both widths are
small enough is therefore bounded by edge directions and by the solutions of D cos(angle - phase) = width on each arc:
if any angle fits, one of these does.

.. [1] H. Freeman, R. Shapira, "Determining the minimum-area encasing rectangle for an arbitrary closed curve",
   Communications of the ACM 18 (1975) 409-413.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from stages.geometry.arcpath import polygon
from stages.geometry.arrays import Array, Points2, Values
from stages.nest.blank import Bed, Blank, Turned, fits, turned

QUARTER_DEG = 90.0
FINE_CHORD_MM = 1e-3
"""Chord error of the hull in the test for the last resort: what the exact box may gain is less than this."""

ALIKE = 1e-6
"""Rectangles whose areas differ by less, relative to the larger, are the same: the smaller angle is taken."""


class Kind(NamedTuple):
    """One part in every angle in which it is tried."""

    blank: Blank
    turns: tuple[Turned, ...]

    def on(self, bed: Bed) -> tuple[Turned, ...]:
        """Return the angles in which it fits a bed."""
        return tuple(one for one in self.turns if fits(one, bed))


def kind(blank: Blank, beds: Sequence[Bed]) -> Kind:
    """Return a part in every angle in which it is to be tried on these beds."""
    if blank.angles is not None:
        return Kind(blank, tuple(turned(blank, angle) for angle in blank.angles))
    base = [turned(blank, angle) for angle in quarter_turns(tight_angle(hull(blank)))]
    refused = [bed for bed in beds if not any(fits(one, bed) for one in base)]
    extra = dict.fromkeys(angle for bed in refused for angle in fitting_angles(blank, bed))
    return Kind(blank, (*base, *(turned(blank, angle) for angle in extra)))


def quarter_turns(angle_deg: float) -> tuple[float, ...]:
    """Return an angle and its quarter turns, in [0, 360) degrees."""
    return tuple((angle_deg + quarter * QUARTER_DEG) % 360.0 for quarter in range(4))


def hull(blank: Blank) -> Points2:
    """Return the corners of the convex hull of a part, counter-clockwise, as one loop without its last point."""
    from scipy.spatial import ConvexHull

    points = polygon(blank.pattern.outer.path, accuracy=FINE_CHORD_MM, outside=True)
    corners: Points2 = points[ConvexHull(points - points.mean(axis=0)).vertices]
    return corners


def tight_angle(corners: Points2) -> float:
    """Return the least angle in [0, 90) degrees that lays the rectangle of least area along the axes."""
    angle = np.unique(np.round(-_directions(corners) % QUARTER_DEG, 12) % QUARTER_DEG)
    width, height = widths(corners, angle), widths(corners, angle + QUARTER_DEG)
    size = width * height
    return float(angle[np.flatnonzero(size <= size.min() * (1.0 + ALIKE))[0]])


def widths(corners: Points2, angle_deg: Array) -> Array:
    """Return how wide, along x, the corners are after each turn; mm."""
    turn = np.radians(angle_deg)
    x = corners[:, 0, None] * np.cos(turn) - corners[:, 1, None] * np.sin(turn)
    extent: Array = x.max(axis=0) - x.min(axis=0)
    return extent


def fitting_angles(blank: Blank, bed: Bed) -> tuple[float, ...]:
    """Return the angle of least height in which a part fits a bed, and its half turn; nothing if there is none."""
    corners = hull(blank)
    grow = 2.0 * blank.grow_mm
    wanted = (bed.width_mm - grow, bed.height_mm - grow)
    exact = np.concatenate(list(_critical_angles(corners, wanted)))
    candidates = np.unique(np.concatenate([exact, exact - INSIDE_DEG, exact + INSIDE_DEG]))
    fitting = [angle for angle in candidates.tolist() if fits(turned(blank, angle), bed)]
    if not fitting:
        return ()
    best = min(fitting, key=lambda angle: turned(blank, angle).height_mm)
    return best, (best + 2.0 * QUARTER_DEG) % 360.0


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
    turn = np.radians(middle_deg)
    x = corners[:, 0, None] * np.cos(turn) - corners[:, 1, None] * np.sin(turn)
    span = corners[np.argmax(x, axis=0)] - corners[np.argmin(x, axis=0)]
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
