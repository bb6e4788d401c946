"""A flat map along the rulings with a displacement added, as it is found by `relaxed`."""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from stages.geometry.arrays import Array, ArrayValue, Points2, Values, similarities
from stages.geometry.flat import strainenergy
from stages.geometry.flat.development import RulingMap
from stages.geometry.numeric.elements import evaluate
from stages.geometry.ruled.ruled import RuledPatch


@dataclass(frozen=True, slots=True, eq=False)
class RelaxedMap(ArrayValue):
    """One piece laid flat along its rulings and then displaced.

    elements: ends of the elements in v, shape (m + 1,).
    series: Legendre coefficients of the displacement on each, mm, shape (m, nv + 1, nu + 1, 2).
    """

    base: RulingMap
    elements: Values
    series: Array

    @property
    def patch(self) -> RuledPatch:
        """The patch that is mapped."""
        return self.base.patch

    @property
    def breaks(self) -> Values:
        """Ends of the panels in v on which positions are smooth."""
        return np.unique(np.concatenate([self.base.breaks, self.elements]))

    def positions(self, u: Values, v: Values) -> Points2:
        """Return the flat positions of S(u, v), mm."""
        flat: Points2 = self.base.positions(u, v) + self.displacement(u, v)
        return flat

    def chords(self, u0: Values, v0: Values, u: Values, v: Values) -> Points2:
        """Return the vectors from the flat S(u0, v0) to the flat S(u, v), mm, both on one panel."""
        gained = self.displacement(u, v) - self.displacement(u0, v0)
        chord: Points2 = self.base.chords(u0, v0, u, v) + gained
        return chord

    def velocities(self, u: Values, v: Values) -> Points2:
        """Return d/dv of the flat positions, mm: the exact derivative of the displacement, the rates of the base."""
        velocities: Points2 = self.base.velocities(u, v) + summed(self.elements, slopes(self)[1], u, v)
        return velocities

    def displacement(self, u: Values, v: Values) -> Points2:
        """Return how far S(u, v) is from its place along the rulings, mm."""
        return summed(self.elements, self.series, u, v)


def slopes(piece: RelaxedMap) -> tuple[Array, Array]:
    """Return the series of the displacement's derivatives by u and by v."""
    by_u = np.asarray(2.0 * legendre.legder(piece.series, axis=2), dtype=np.float64)
    by_v = legendre.legder(piece.series, axis=1) * (2.0 / np.diff(piece.elements))[:, None, None, None]
    return by_u, by_v


def summed(elements: Array, series: Array, u: Values, v: Values) -> Points2:
    """Return the sums of the elements' series, shape (n, 2), at the points."""
    index = np.clip(np.searchsorted(elements, v, side="right") - 1, 0, elements.size - 2)
    low, high = elements[index], elements[index + 1]
    x, y = 2.0 * u - 1.0, ((v - low) - (high - v)) / (high - low)
    total = np.zeros((v.size, 2))
    for element in np.unique(index):
        here = index == element
        total[here] = evaluate(series[element], x[here], y[here])
    return total


def principal(piece: RelaxedMap, u: Values, v: Values) -> Points2:
    """Return the larger and the smaller principal strain at the points, from the displacement's derivatives.

    0 where the ruling has almost no length, or encloses almost no angle with the directrix: no frame is defined there.
    """
    at = strainenergy.metric(piece.base, u, v)
    clear = (at.length > CLEAR * at.length.max()) & (at.aside > CLEAR * at.aside.max())
    length, aside = np.where(clear, at.length, 1.0), np.where(clear, at.aside, 1.0)
    d_u, d_v = (summed(piece.elements, series, u, v) for series in slopes(piece))
    d_e = d_u / length[:, None]
    d_w = (d_v - at.along[:, None] * d_e) / aside[:, None]
    c, s = at.cos, at.sin
    e = np.stack([1.0 + c * d_e[:, 0] + s * d_e[:, 1], c * d_e[:, 1] - s * d_e[:, 0]], axis=1)
    w = np.stack([c * d_w[:, 0] + s * d_w[:, 1], 1.0 - at.kappa + c * d_w[:, 1] - s * d_w[:, 0]], axis=1)
    similar, mirrored = similarities(e, w)
    strains = np.stack([similar + mirrored - 1.0, similar - mirrored - 1.0], axis=1)
    return np.where(clear[:, None], strains, 0.0)


CLEAR = 1e-3
"""A ruling, or a width across it, below this share of the longest magnifies the rounding of derivatives as much."""
