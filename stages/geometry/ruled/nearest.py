"""The place (u, v) of a strip of ruled patches that is nearest to a point in space.

On one ruling the nearest place is known in closed form, so only v is sought.  Along v the distance to the ruling
changes no faster than the faster end of the ruling moves; intervals that cannot hold the nearest ruling by that bound
are dropped, the others divided (branch and bound [1]_), until each is so short that the slope of the distance,
(S - X) . S_v, has one zero in it, which is bisected to the last digit.  Every other place at the same distance is
returned as well: on the axis of a cylinder there is no nearest place, on a seam there are two.

The bound on the speed is measured at seven points of an interval, with a margin: sampled, not proved.

.. [1] E. Hansen, G. W. Walster, "Global Optimization Using Interval Analysis", 2nd ed., ch. 9, 2004.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from stages.geometry.arrays import EPS, Array, ArrayValue, Points2, Points3, Values, Vector2, Vector3, dot, norm
from stages.geometry.ruled.strip import Strip, jet, size

FIRST_CELLS = 64
"""Intervals of v per patch to begin with."""
HALVINGS = 12
"""An interval that is left is 2^-18 of a patch: the distance has one minimum in it, or is constant to rounding."""
MOST_CELLS = 2048
"""More intervals than these at a time are rulings all equally far, as from the axis of a cylinder."""
SPEED_MARGIN = 1.25
"""What the largest of seven speeds on an interval of 1/64 patch is multiplied by to bound them all."""
BISECTIONS = 44
"""From 2^-16 of a patch, neighbours of the interval included, to the last digit."""
SAME = 1e-9
"""Two distances or places that differ by less than this share of the size are the same."""
ROUNDING = 1e-14
"""Share of the size that two ways to compute one distance may differ by."""


@dataclass(frozen=True, slots=True, eq=False)
class Nearest(ArrayValue):
    """The nearest place (u, v), its distance in mm, and all places as near as it, itself first, shape (n, 2)."""

    place: Vector2
    distance_mm: float
    equals: Points2


def nearest(strip: Strip, point: Vector3) -> Nearest:
    """Return the nearest place; exact to rounding: the place within some 1e-15 of the size."""
    v = _candidates(strip, point)
    u, distance = _on_rulings(point, *_four(strip, v)[:2])
    order = np.argsort(distance, kind="stable")
    places = np.stack([u, v], axis=1)[order]
    equal = distance[order] <= distance[order[0]] + SAME * size(strip)
    return Nearest(places[0], float(distance[order[0]]), places[equal])


def _candidates(strip: Strip, point: Vector3) -> Values:
    """Return a v for each interval that is left, at the least distance; ends and middle too where it is a wide one."""
    low, high = _surviving(strip, point)
    starts = np.flatnonzero(np.append(True, low[1:] > high[:-1] + (high[:-1] - low[:-1]) / 2.0))
    ends = np.append(starts[1:], low.size) - 1
    reach = high[starts] - low[starts]
    first, last = strip.knots[0], strip.knots[-1]
    before, after = np.maximum(low[starts] - reach, first), np.minimum(high[ends] + reach, last)
    wide = high[ends] - low[starts] > WIDE * (last - first)
    among = np.stack([before, (before + after) / 2.0, after])[:, wide].ravel()
    return np.concatenate([_bisected(strip, point, before, after), among])


WIDE = 1e-3
"""So long an interval of v without a nearest ruling in it is one of equally near ones."""


def _surviving(strip: Strip, point: Vector3) -> tuple[Values, Values]:
    """Return the intervals of v, in order, that may hold the nearest ruling."""
    knots = strip.knots
    edges = [np.linspace(a, b, FIRST_CELLS + 1) for a, b in pairwise(knots)]
    low, high = np.concatenate([edge[:-1] for edge in edges]), np.concatenate([edge[1:] for edge in edges])
    speed = _speed_bound(strip, low, high)
    for _ in range(HALVINGS):
        middle = (low + high) / 2.0
        _, distance = _on_rulings(point, *_four(strip, middle)[:2])
        keep = distance - speed * (high - low) / 2.0 <= distance.min()
        low, middle, high = low[keep], middle[keep], high[keep]
        if low.size > MOST_CELLS:
            break
        speed = np.repeat(speed[keep], 2)
        low, high = np.stack([low, middle], axis=1).ravel(), np.stack([middle, high], axis=1).ravel()
    return low, high


def _speed_bound(strip: Strip, low: Values, high: Values) -> Values:
    """Return a bound on how fast the points of the rulings of each interval move, mm per unit of v."""
    # just inside, so that an interval beside a knot sees its own patch
    share = np.linspace(INSIDE, 1.0 - INSIDE, 7)
    _, _, c0_d1, p_d1 = _four(strip, (low[:, None] + share * (high - low)[:, None]).ravel())
    fastest = np.maximum(norm(c0_d1), norm(c0_d1 + p_d1)).reshape(low.size, -1).max(axis=1)
    return np.asarray(SPEED_MARGIN * fastest)


INSIDE = 1e-3
"""Of an interval; what its very ends do beyond that is in the margin of the bound."""


def _four(strip: Strip, v: Values) -> tuple[Points3, Points3, Points3, Points3]:
    """Return c0, p, c0' and p' at v, mm and mm per unit of v."""
    found = jet(strip, np.zeros_like(v), v)
    return found.s, found.s_u, found.s_v, found.s_uv


def _on_rulings(point: Array, c0: Points3, p: Points3) -> tuple[Values, Values]:
    """Return u of the nearest place on each ruling, and its distance, mm."""
    length = dot(p, p)
    u = np.divide(dot(point - c0, p), length, out=np.zeros_like(length), where=length > 0.0).clip(0.0, 1.0)
    return u, norm(c0 + u[:, None] * p - point)


def nearest_within(strip: Strip, every: Points3, low: Values, high: Values, halvings: int) -> Points2:
    """Return for each point the nearest place of an interval of v of its own in which the distance has one minimum.

    The v is within 2^-halvings of the interval; the distance is off by its square.
    """
    v = _bisected(strip, every, low, high, halvings)
    return np.stack([_on_rulings(every, *_four(strip, v)[:2])[0], v], axis=1)


def _bisected(strip: Strip, point: Array, low: Values, high: Values, halvings: int = BISECTIONS) -> Values:
    """Return the v in each interval at which the distance stops falling; an end of the strip where it falls on.

    point: one, or one for each interval.
    """
    for _ in range(halvings):
        middle = (low + high) / 2.0
        falls = _slope(strip, point, middle) < 0.0
        low, high = np.where(falls, middle, low), np.where(falls, high, middle)
    # the ends of the strip themselves, which no bisection reaches
    first, last = strip.knots[0], strip.knots[-1]
    width = (last - first) * 2.0 * EPS
    v: Values = np.where(low >= last - width, last, np.where(high <= first + width, first, (low + high) / 2.0))
    return v


def _slope(strip: Strip, point: Array, v: Values) -> Values:
    """Return (S - X) . S_v at the nearest place of each ruling: half the derivative of the squared distance."""
    c0, p, c0_d1, p_d1 = _four(strip, v)
    u, _ = _on_rulings(point, c0, p)
    return dot(c0 + u[:, None] * p - point, c0_d1 + u[:, None] * p_d1)


def rivals(strip: Strip, found: Nearest) -> Points2:
    """Return the equally near places that are really others: elsewhere in space, or at the other end of a seam.

    Rulings that meet in an apex are one place.
    """
    place = jet(strip, found.equals[:, 0], found.equals[:, 1])
    scale = size(strip)
    elsewhere = norm(place.s - place.s[0]) > APART * scale
    across = np.abs(found.equals[:, 1] - found.place[1]) > WIDE * (strip.knots[-1] - strip.knots[0])
    apex = norm(place.s_v) <= SAME * scale
    others: Points2 = found.equals[elsewhere | (across & ~apex)]
    return others


APART = 1e-3
"""Places nearer than this share of the size are one flat minimum: a distance keeps half the digits of its place."""


def by_rulings(strip: Strip, every: Points3) -> tuple[Points2, Values]:
    """Return for each point the nearest place on `FIRST_CELLS` rulings of each patch, and its distance, mm."""
    v = np.concatenate([np.linspace(a, b, FIRST_CELLS) for a, b in pairwise(strip.knots)])
    c0, p, *_ = _four(strip, v)
    found = [_on_rulings(point, c0, p) for point in every]
    best = [int(np.argmin(distance)) for _, distance in found]
    places = [(u[i], v[i]) for (u, _), i in zip(found, best, strict=True)]
    return np.array(places), np.array([distance[i] for (_, distance), i in zip(found, best, strict=True)])
