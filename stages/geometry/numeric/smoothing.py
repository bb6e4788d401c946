"""The quintic spline of least squares through many values, with as few spans as follow them as well as any.

Splines of 1, 2, 4, 8, ... equal spans, C4, periodic where the values are, are held against each other by generalised
cross-validation [1]_: what is left of the values over the share of freedom that is left.  Exact values of a smooth
function are followed until `settled`; noise is smoothed, as far as the caller knows how many of the values are
independent of each other.

.. [1] P. Craven, G. Wahba, "Smoothing noisy data with spline functions", Numerische Mathematik 31, 1979, 377-403.
"""

from dataclasses import dataclass
from math import comb

import numpy as np

from stages.geometry.arrays import Array, ArrayValue, Values

DEGREE = 5
SIMPLER = 1.25
"""Fewer spans are taken where they are worse by no more than this factor."""


@dataclass(frozen=True, slots=True, eq=False)
class Followed(ArrayValue):
    """A spline over [0, 1] near some values.

    pieces: Bezier points of its equal spans, shape (spans, 6, c).  near: its values at the places, shape (n, c).
    rms: root of the mean squared distance that it leaves.
    """

    pieces: Array
    near: Array
    rms: float


def followed(at: Values, values: Array, most: int, *, independent: float, closed: bool, settled: float) -> Followed:
    """Return the spline near values, shape (n, c), at places in [0, 1], of at most `most` spans; periodic if closed.

    independent: how many of the values are, more than the `most` + 5 coefficients.
    """
    doubled = (2**k for k in range(most.bit_length()))
    tried = [_nearest(at, values, spans, closed=closed) for spans in sorted({*(n for n in doubled if n < most), most})]
    scores = [max(one.rms / (1.0 - (len(one.pieces) + DEGREE) / independent), settled) for one in tried]
    return next(one for one, score in zip(tried, scores, strict=True) if score <= SIMPLER * min(scores))


def _nearest(at: Values, values: Array, spans: int, *, closed: bool) -> Followed:
    """Return the spline of equal spans nearest to the values."""
    design = _design(at, spans, closed=closed)
    found = np.linalg.lstsq(design, values, rcond=None)[0]
    near = design @ found
    nodes = (np.arange(spans)[:, None] + np.linspace(0.0, 1.0, DEGREE + 1)) / spans
    on_spans = (_design(nodes.ravel(), spans, closed=closed) @ found).reshape(spans, DEGREE + 1, -1)
    rms = float(np.sqrt(((values - near) ** 2).sum(axis=1).mean()))
    return Followed(np.asarray(np.linalg.solve(_bernstein(), on_spans), dtype=np.float64), near, rms)


def _design(at: Values, spans: int, *, closed: bool) -> Array:
    """Return the values of the B-splines over equal knots; periodic ones are folded into one."""
    from scipy.interpolate import BSpline

    knots = np.arange(-DEGREE, spans + DEGREE + 1) / spans
    full: Array = BSpline(knots, np.eye(spans + DEGREE), DEGREE)(at)
    if not closed:
        return full
    folded = np.zeros((len(at), spans))
    for i, column in enumerate(full.T):
        folded[:, i % spans] += column
    return folded


def _bernstein() -> Array:
    """Return the Bernstein polynomials at equal steps of a span, shape (6, 6)."""
    t = np.linspace(0.0, 1.0, DEGREE + 1)
    return np.stack([comb(DEGREE, i) * t**i * (1.0 - t) ** (DEGREE - i) for i in range(DEGREE + 1)], axis=1)
