"""Curves in (u, v) carried through a flat map: exact edges of holes and marks in the plane.

A curve of u and v is itself an edge in the plane of u and v (`plane.PlaneCurve`, its numbers not mm).  Its image is
evaluated through the flat positions wherever it is asked for, so it is as exact as they are.  It is smooth where the
curve does not pass from one patch to the next; `images` cuts it there.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

from stages.geometry.arrays import Array, ArrayValue, Indices, Mask, Points2, Values
from stages.geometry.curves.plane import Piecewise, PlaneCurve
from stages.geometry.flat.development import RulingMap
from stages.geometry.flat.flatmap import FlatPiece
from stages.geometry.ruled.strip import locate

ACROSS = 12
"""Chebyshev nodes across the rulings: d/du is exact for maps of a degree below 12 in u; along rulings it is 1."""
SAMPLES = 513
"""Places at which a curve is asked on which patch it is; a visit to another one between two of them is not cut."""
BISECTIONS = 52
"""Halvings of a stretch of 1/512, which leave nothing between two doubles of t."""


@dataclass(frozen=True, slots=True, eq=False)
class FlatStrip(ArrayValue):
    """The flat pieces of a strip, and the v at their ends, shape (pieces + 1,)."""

    pieces: tuple[FlatPiece, ...]
    knots: Values

    def positions(self, u: Values, v: Values) -> Points2:
        """Return the flat positions, mm."""
        index, local, _ = locate(self.knots, v)
        flat = np.zeros((v.size, 2))
        for i in np.unique(index):
            here = index == i
            flat[here] = self.pieces[i].positions(u[here], local[here])
        return flat

    def slopes(self, u: Values, v: Values) -> tuple[Points2, Points2]:
        """Return d/du and d/dv of the flat positions, mm."""
        index, local, width = locate(self.knots, v)
        by_u, by_v = np.zeros((v.size, 2)), np.zeros((v.size, 2))
        for i in np.unique(index):
            here = index == i
            by_u[here] = _across(self.pieces[i], u[here], local[here])
            by_v[here] = self.pieces[i].velocities(u[here], local[here]) / width[here][:, None]
        return by_u, by_v


def _across(piece: FlatPiece, u: Values, v: Values) -> Points2:
    """Return d/du of the flat positions of one piece, from positions alone."""
    if isinstance(piece, RulingMap):  # straight between both edges
        return piece.chords(np.zeros_like(v), v, np.ones_like(v), v)
    x = chebyshev.chebpts1(ACROSS)
    nodes = (x + 1.0) / 2.0
    flat = piece.positions(np.repeat(nodes, v.size), np.tile(v, ACROSS)).reshape(ACROSS, v.size, 2)
    series = np.linalg.solve(chebyshev.chebvander(x, ACROSS - 1), flat.reshape(ACROSS, -1))
    slopes = np.asarray(chebyshev.chebder(series, axis=0)).reshape(ACROSS - 1, v.size, 2)
    basis = chebyshev.chebvander(2.0 * u - 1.0, ACROSS - 2)
    return np.asarray(2.0 * np.einsum("nk,knc->nc", basis, slopes))


@dataclass(frozen=True, slots=True, eq=False)
class MappedEdge(ArrayValue):
    """The flat image of the stretch of a curve of u and v from t = `low` to `high`; run backwards if high < low."""

    strip: FlatStrip
    curve: PlaneCurve
    low: float
    high: float

    @property
    def breaks(self) -> Values:
        """Where it is not smooth, ends included: at those of a curve that has them."""
        if not isinstance(self.curve, Piecewise):
            return np.array([0.0, 1.0])
        inner = (self.curve.breaks - self.low) / (self.high - self.low)
        within = inner[(inner > LEAST_STRETCH) & (inner < 1.0 - LEAST_STRETCH)]
        return np.concatenate([[0.0], np.sort(within), [1.0]])

    def at(self, t: Values) -> Points2:
        """Return the points at t, mm."""
        place = self.curve.at(self.low + (self.high - self.low) * t)
        return self.strip.positions(place[:, 0], place[:, 1])

    def derivative(self, t: Values) -> Points2:
        """Return d/dt of the points, mm."""
        inner = self.low + (self.high - self.low) * t
        place, rate = self.curve.at(inner), (self.high - self.low) * self.curve.derivative(inner)
        by_u, by_v = self.strip.slopes(place[:, 0], place[:, 1])
        image: Points2 = rate[:, :1] * by_u + rate[:, 1:] * by_v
        return image


def images(strip: FlatStrip, curves: Sequence[PlaneCurve]) -> tuple[MappedEdge, ...]:
    """Return the images of curves end to end, cut where they pass from one piece to the next."""
    return tuple(
        MappedEdge(strip, curve, low, high)
        for curve in curves
        for low, high in zip(*_stretches(strip.knots[1:-1], curve), strict=True)
    )


def backwards(edges: Sequence[MappedEdge]) -> tuple[MappedEdge, ...]:
    """Return the same edges run the other way."""
    return tuple(MappedEdge(edge.strip, edge.curve, edge.high, edge.low) for edge in edges[::-1])


def _stretches(inner: Array, curve: PlaneCurve) -> tuple[list[float], list[float]]:
    """Return the starts and ends in t of the stretches between crossings of the inner knots."""
    t = np.linspace(0.0, 1.0, SAMPLES)
    v = curve.at(t)[:, 1]
    crossings: list[float] = []
    for knot in inner:
        side = v >= knot
        before: Indices = np.flatnonzero(side[1:] != side[:-1])
        if before.size:
            crossings += _crossings(curve, knot, t[before], t[before + 1], side[before]).tolist()
    breaks = [0.0, *sorted(c for c in crossings if LEAST_STRETCH < c < 1.0 - LEAST_STRETCH), 1.0]
    return breaks[:-1], breaks[1:]


LEAST_STRETCH = 1e-9
"""A curve that ends this close to a knot ends on it."""


def _crossings(curve: PlaneCurve, knot: float, low: Values, high: Values, above: Mask) -> Values:
    """Return the t in each interval where v passes the knot."""
    for _ in range(BISECTIONS):
        middle = (low + high) / 2.0
        same = (curve.at(middle)[:, 1] >= knot) == above
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    crossing: Values = (low + high) / 2.0
    return crossing
