"""A smooth curve of u and v as Chebyshev series on panels: evaluated once, then as cheap as a polynomial.

    tabled(curve, strip) -> PlaneCurve

A place pulled back onto a surface takes some Newton steps with the jets of both directrices.  An edge that is traced,
measured and compared is asked for thousands of them, all on one smooth curve.  Panels are halved until the last
coefficients of each are rounding; the series is then as near to the curve as these are.  A curve that does not come to
that within `MOST_PANELS` (it has a kink, or is noisy) is returned as it is.

Numbers are those of u and v, some 1 in size, not mm.
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

from stages.geometry.arrays import Array, ArrayValue, Points2, Values
from stages.geometry.curves.plane import PlaneCurve
from stages.geometry.ruled.strip import Strip

NODES = 20
"""Coefficients on a panel; of a curve with a pole at half a panel's width beside it they fall by 1e-13."""
ROUNDING = 2e-14
"""What the last coefficients may be, as a share of the largest place on the curve (at least 1)."""
LAST = 3
"""Coefficients that must be rounding: an even or odd curve has every other one 0."""
FIRST_PANELS, MOST_PANELS, MOST_HALVINGS = 4, 128, 8
"""Panels to begin with, and at most; a curve that would take more, or more halvings, is evaluated itself instead."""

POINTS = chebyshev.chebpts1(NODES)
TO_SERIES = np.linalg.inv(chebyshev.chebvander(POINTS, NODES - 1))
TO_SLOPES = np.stack([np.append(chebyshev.chebder(row), 0.0) for row in np.eye(NODES)], axis=1)
"""From the coefficients of a series to those of its derivative, shape (n, n)."""


@dataclass(frozen=True, slots=True, eq=False)
class Tabled(ArrayValue):
    """The curve: ends of panels from 0 to 1, shape (m + 1,), and Chebyshev series, shape (m, NODES, 2).

    ends: its first and its last place, to the last digit: those of a loop meet.
    corners: the least and the largest u and v that there are, shape (2, 2), which rounding does not go beyond.
    `at` and `derivative` are those of an edge, in u and v instead of mm.
    """

    panels: Values
    series: Array
    slopes: Array
    ends: Array
    corners: Array

    def at(self, t: Values) -> Points2:
        """Return the places (u, v) at t."""
        places: Points2 = np.clip(_sums(self.panels, self.series, t), *self.corners)
        for end, place in zip((0.0, 1.0), self.ends, strict=True):
            places[t == end] = place
        return places

    def derivative(self, t: Values) -> Points2:
        """Return d/dt of the places."""
        return _sums(self.panels, self.slopes, t)


def tabled(curve: PlaneCurve, strip: Strip) -> PlaneCurve:
    """Return a curve of places on a strip as series, or itself where they do not come to rounding."""
    low, high = np.linspace(0.0, 1.0, FIRST_PANELS + 1)[:-1], np.linspace(0.0, 1.0, FIRST_PANELS + 1)[1:]
    starts: list[Values] = []
    found: list[Array] = []
    for _ in range(MOST_HALVINGS):
        series = _series(curve, low, high)
        scale = max(float(np.abs(series).max()), 1.0)
        smooth = np.abs(series[:, -LAST:]).max(axis=(1, 2)) <= ROUNDING * scale
        starts.append(low[smooth])
        found.append(series[smooth])
        low, high = low[~smooth], high[~smooth]
        if not low.size:
            return _made(curve, strip, np.concatenate(starts), np.concatenate(found))
        middle = (low + high) / 2.0
        low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
        if low.size + sum(one.size for one in starts) > MOST_PANELS:
            break
    return curve


def _series(curve: PlaneCurve, low: Values, high: Values) -> Array:
    """Return the series on panels, shape (m, NODES, 2)."""
    t = ((low + high) / 2.0)[:, None] + ((high - low) / 2.0)[:, None] * POINTS
    return np.asarray(np.einsum("kn,mnc->mkc", TO_SERIES, curve.at(t.ravel()).reshape(low.size, NODES, 2)))


def _made(curve: PlaneCurve, strip: Strip, starts: Values, series: Array) -> Tabled:
    """Return the curve of panels in any order."""
    corners = np.array([[0.0, strip.knots[0]], [1.0, strip.knots[-1]]])
    order = np.argsort(starts)
    panels = np.append(starts[order], 1.0)
    rates = np.einsum("kn,mnc->mkc", TO_SLOPES, series[order]) * (2.0 / np.diff(panels))[:, None, None]
    return Tabled(panels, series[order], rates, curve.at(np.array([0.0, 1.0])), corners)


def _sums(panels: Array, series: Array, t: Values) -> Points2:
    """Return the sums of the series at t."""
    index = np.clip(np.searchsorted(panels, t, side="right") - 1, 0, panels.size - 2)
    x = (2.0 * t - panels[index] - panels[index + 1]) / (panels[index + 1] - panels[index])
    sums: Points2 = np.einsum("nk,nkc->nc", chebyshev.chebvander(x, NODES - 1), series[index])
    return sums
