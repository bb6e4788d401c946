"""The curve in which a cylinder about a normal of a strip of ruled patches meets the strip.

Along the angle theta about the axis, from the tangent direction X of the ruling towards Y = N x X, the place (u, v)
solves (S - A) . X = r cos theta and (S - A) . Y = r sin theta, by Newton's method from a table of places that was
grown out of the axis: 0 to r in equal steps of the radius.  Of a surface that the cylinder meets more than once only
the sheet about A counts.
"""

from dataclasses import dataclass

import numpy as np

from stages.errors import NoSolutionError
from stages.geometry.arrays import Array, ArrayValue, Points2, Values, Vector2, Vector3, norm, unit
from stages.geometry.ruled.strip import Strip, divided, jet, size

DIRECTIONS = 256
RADIUS_STEPS = 16
MOST_STEPS = 40
SETTLED = 1e-11
"""After a step of this length in u and v the next one would be its square, which is rounding."""
MET = 1e-12
"""How far from the cylinder, as a share of the size, a place may be that counts as on it."""


@dataclass(frozen=True, slots=True, eq=False)
class Drilled(ArrayValue):
    """The curve (u, v)(t), t = theta / 2 pi, of a cylinder about the normal at `centre`; axes: X and Y, shape (2, 3).

    table: places at even steps of t, ends included.  `at` and `derivative` are those of an edge, in u and v.
    """

    strip: Strip
    centre: Vector3
    axes: Array
    radius: float
    table: Points2

    def at(self, t: Values) -> Points2:
        """Return the places (u, v) at t.  Raises NoSolutionError where Newton's method does not settle."""
        steps = np.linspace(0.0, 1.0, len(self.table))
        start = np.stack([np.interp(t, steps, column) for column in self.table.T], axis=1)
        place, off = _solved(self.strip, self.centre, self.axes, self.radius * _circle(t), start)
        scale = size(self.strip)
        if off > MET * scale:
            raise NoSolutionError("a drilled hole", reached=off, wanted=MET * scale, unit="mm")
        return place

    def derivative(self, t: Values) -> Points2:
        """Return d/dt of the places."""
        place = self.at(t)
        turning = 2.0 * np.pi * self.radius * _circle(t + QUARTER)
        return divided(_across(self.strip, self.centre, self.axes, place)[1], turning)


QUARTER = 0.25
"""Of a turn: the derivative of a point of a circle is the point a quarter on."""


def drilled(strip: Strip, place: Vector2, radius: float) -> Drilled | None:
    """Return the curve about the place, radius in mm; None where the cylinder leaves the strip before it closes."""
    found = jet(strip, place[:1], place[1:])
    normal = unit(np.cross(found.s_u, found.s_v))[0]
    # where S_v runs along the ruling (an apex, a stop of the directrices) there is no normal
    if norm(normal) == 0.0:
        return None
    x = unit(found.s_u)[0]
    axes, centre = np.stack([x, np.cross(normal, x)]), found.s[0]
    t = np.arange(DIRECTIONS) / DIRECTIONS
    table = np.tile(place, (DIRECTIONS, 1))
    for share in np.arange(1, RADIUS_STEPS + 1) / RADIUS_STEPS:
        table, off = _solved(strip, centre, axes, share * radius * _circle(t), table)
        if off > MET * size(strip):
            return None
    return Drilled(strip, centre, axes, radius, np.vstack([table, table[:1]]))


def _circle(t: Values) -> Points2:
    """Return the unit circle, t in turns."""
    angle = 2.0 * np.pi * t
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _solved(strip: Strip, centre: Vector3, axes: Array, wanted: Points2, place: Points2) -> tuple[Points2, float]:
    """Return the places whose points lie at `wanted` across the axis, and how far off the worst is, mm."""
    low, high = np.array([0.0, strip.knots[0]]), np.array([1.0, strip.knots[-1]])
    for _ in range(MOST_STEPS):
        across, slopes = _across(strip, centre, axes, place)
        fresh = np.clip(place - divided(slopes, across - wanted), low, high)
        moved, place = float(np.abs(fresh - place).max()), fresh
        if moved <= SETTLED:
            break
    return place, float(norm(_across(strip, centre, axes, place)[0] - wanted).max())


def _across(strip: Strip, centre: Vector3, axes: Array, place: Points2) -> tuple[Points2, Array]:
    """Return the points relative to the axis, in X and Y, mm, and their derivatives by u and v, shape (n, 2, 2)."""
    found = jet(strip, place[:, 0], place[:, 1])
    return (found.s - centre) @ axes.T, np.stack([found.s_u @ axes.T, found.s_v @ axes.T], axis=-1)
