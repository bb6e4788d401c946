"""A curve in space as a curve (u, v) of its nearest places on a strip of ruled patches.

It is pulled back point by point: by Newton's method from a table of places, on the condition that X - S is normal to
the surface.  Jumps are for the caller to judge.
"""

from dataclasses import dataclass

import numpy as np

from stages.errors import NoSolutionError
from stages.geometry.arrays import Array, ArrayValue, Points2, Points3, Values, dot, norm
from stages.geometry.curves.curves import Curve
from stages.geometry.ruled.nearest import ROUNDING, SAME, by_rulings, nearest
from stages.geometry.ruled.strip import Jet, Strip, divided, jet, rulings, size


@dataclass(frozen=True, slots=True, eq=False)
class PulledBack(ArrayValue):
    """A space curve as the curve (u, v)(t) of its nearest places; `table` are places at even steps of t, ends included.

    `at` and `derivative` are those of an edge, in u and v instead of mm.
    """

    strip: Strip
    curve: Curve
    table: Points2

    def at(self, t: Values) -> Points2:
        """Return the places (u, v) at t.  Raises NoSolutionError where Newton's method does not settle."""
        steps = np.linspace(0.0, 1.0, len(self.table))
        start = np.stack([np.interp(t, steps, column) for column in self.table.T], axis=1)
        return settled(self.strip, self.curve.jet(t, 0)[0], start)

    def derivative(self, t: Values) -> Points2:
        """Return d/dt of the places; 0 across an edge of the surface that the nearest place runs along."""
        place = self.at(t)
        x, x_d1 = self.curve.jet(t, 1)
        found = jet(self.strip, place[:, 0], place[:, 1])
        right = np.stack([dot(x_d1, found.s_u), dot(x_d1, found.s_v)], axis=1)
        return divided(_hessian(found, x), right)


def pulled_back(strip: Strip, curve: Curve, count: int) -> PulledBack:
    """Return the curve of nearest places, from the nearest places at `count` + 1 even steps of t.

    Newton's method from the nearest of many rulings finds nearly all of them; what it finds is never farther than
    that ruling, or the place is sought by `nearest`.
    """
    every = curve.jet(np.linspace(0.0, 1.0, count + 1), 0)[0]
    start, distance = by_rulings(strip, every)
    table, moved = newton(strip, every, start)
    reached = norm(jet(strip, table[:, 0], table[:, 1]).s - every)
    for i in np.flatnonzero((moved > SETTLED) | (reached > distance + ROUNDING * size(strip))):
        table[i] = nearest(strip, every[i]).place
    return PulledBack(strip, curve, _unseamed(strip, _over_seam(strip, every, table)))


def lying_on(strip: Strip, curve: Curve, count: int, *, within_mm: float) -> PulledBack:
    """Return a curve that is known to lie on the strip, to within a distance, as a curve of u and v.

    Newton's method is enough where it arrives on the surface; only what it does not find is sought by `nearest`.
    """
    every = curve.jet(np.linspace(0.0, 1.0, count + 1), 0)[0]
    start, distance = by_rulings(strip, every)
    table = _over_seam(strip, every, newton(strip, every, start)[0])
    off = norm(jet(strip, table[:, 0], table[:, 1]).s - every)
    for i in np.flatnonzero((off > within_mm) & (off > distance + ROUNDING * size(strip))):
        table[i] = nearest(strip, every[i]).place
    return PulledBack(strip, curve, _unseamed(strip, table))


def _over_seam(strip: Strip, every: Points3, table: Points2) -> Points2:
    """Return the places with those at an end of the strip sought from its other end as well, where that is nearer.

    Beside a seam the nearest of many rulings may be the one beyond it, from which Newton's method finds no way back.
    """
    first, last = strip.knots[0], strip.knots[-1]
    at_end = np.flatnonzero(np.minimum(table[:, 1] - first, last - table[:, 1]) <= SAME * (last - first))
    if not at_end.size:
        return table
    here, points_there = table[at_end], every[at_end]
    there, _ = newton(strip, points_there, np.stack([here[:, 0], first + last - here[:, 1]], axis=1))
    off, off_there = (norm(jet(strip, *places.T).s - points_there) for places in (here, there))
    fresh = table.copy()
    fresh[at_end] = np.where((off_there < off - SAME * size(strip))[:, None], there, here)
    return fresh


def _unseamed(strip: Strip, table: Points2) -> Points2:
    """Return the places with those on a seam taken to the end of the strip that their neighbours are at."""
    first, last = strip.knots[0], strip.knots[-1]
    width = last - first
    v = table[:, 1].copy()
    at_end = np.minimum(v - first, last - v) <= SAME * width
    inner = np.flatnonzero(~at_end)
    closes = norm(np.subtract(*(rulings(strip, np.array([end]))[0] for end in (first, last))))[0]
    if closes > SAME * size(strip):
        return table
    for i in np.flatnonzero(at_end) if inner.size else ():
        beside = v[inner[np.argmin(np.abs(inner - i))]]
        if abs(beside - v[i]) > width / 2.0:
            v[i] = last if v[i] < first + width / 2.0 else first
    return np.stack([table[:, 0], v], axis=1)


def settled(strip: Strip, x: Points3, place: Points2) -> Points2:
    """Return the places nearest to the points x, by Newton's method from places near them, kept on the surface.

    Raises NoSolutionError where the last step is not rounding.
    """
    place, moved = newton(strip, x, place)
    worst = float(moved.max())
    if worst > SETTLED:
        raise NoSolutionError("pulling a curve back onto the surface", reached=worst, wanted=SETTLED, unit="of u, v")
    return place


def newton(strip: Strip, x: Points3, place: Points2) -> tuple[Points2, Values]:
    """Return the places after Newton's method, and the last step of each."""
    low, high = np.array([0.0, strip.knots[0]]), np.array([1.0, strip.knots[-1]])
    moved = np.zeros(len(place))
    for _ in range(MOST_STEPS):
        found = jet(strip, place[:, 0], place[:, 1])
        fresh = np.clip(place - divided(_hessian(found, x), _gradient(found, x)), low, high)
        moved, place = np.abs(fresh - place).max(axis=1), fresh
        if (moved <= SETTLED).all():
            break
    return place, moved


MOST_STEPS = 30
SETTLED = 1e-11
"""After a step of this length in u and v the next one would be its square, which is rounding."""


def _gradient(found: Jet, x: Points3) -> Points2:
    off = found.s - x
    return np.stack([dot(off, found.s_u), dot(off, found.s_v)], axis=1)


def _hessian(found: Jet, x: Points3) -> Array:
    """Return the second derivatives of half the squared distance of places from points, shape (n, 2, 2)."""
    off = found.s - x
    mixed = dot(found.s_u, found.s_v) + dot(off, found.s_uv)
    twice_v = dot(found.s_v, found.s_v) + dot(off, found.s_vv)
    return np.stack([dot(found.s_u, found.s_u), mixed, mixed, twice_v], axis=1).reshape(-1, 2, 2)
