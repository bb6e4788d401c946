"""The largest value of a function on [0, 1], by sampling and zooming in.

The function is sampled at Chebyshev points of several equal cells; the neighbourhoods of the highest peaks are sampled
again until their width is below rounding.  Finds a maximum that is wider than a cell; `sampled`, not proved.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from stages.geometry.arrays import Values

CELLS = 48
"""Cells of the first pass, 8 points each: a quintic patch has at most some 20 extrema of warp or curvature."""
PER_CELL = 8
ZOOMS = 9
"""Each pass narrows the interval by 4: after 9 it is 1e-7 wide, where a smooth maximum is flat to 1e-14."""


PEAKS = 6
"""The highest so many peaks of the first pass are zoomed into: of two nearly equal ones, the lower may show higher."""


def maximum(function: Callable[[Values], Values]) -> tuple[float, float]:
    """Return (largest value, where) of a function that takes an array of v in [0, 1]; NaN values are passed over."""
    angle = (2.0 * np.arange(PER_CELL) + 1.0) * np.pi / (2.0 * PER_CELL)
    offsets = (1.0 - np.cos(angle)) / 2.0
    v = np.concatenate([[0.0], ((np.arange(CELLS)[:, None] + offsets) / CELLS).ravel(), [1.0]])
    values = _numbers(function(v))
    peaks = _peaks(values)
    best, places = values[peaks], v[peaks]
    half = 1.0 / (CELLS * PER_CELL / 4)
    rows = np.arange(places.size)
    for _ in range(ZOOMS):
        around = np.clip(places[:, None] + half * np.linspace(-1.0, 1.0, 4 * PER_CELL + 1), 0.0, 1.0)
        found = _numbers(function(around.ravel())).reshape(around.shape)
        column = np.argmax(found, axis=1)
        higher = found[rows, column] > best
        best = np.where(higher, found[rows, column], best)
        places = np.where(higher, around[rows, column], places)
        half /= 4.0
    first = int(np.argmax(best))
    return float(best[first]), float(places[first])


def _peaks(values: Values) -> NDArray[np.int64]:
    """Return the places of the highest local maxima, the highest first."""
    padded = np.concatenate([[-np.inf], values, [-np.inf]])
    local = np.flatnonzero((values >= padded[:-2]) & (values >= padded[2:]))
    highest: NDArray[np.int64] = local[np.argsort(-values[local], kind="stable")[:PEAKS]]
    return highest


def _numbers(values: Values) -> Values:
    return np.where(np.isnan(values), -np.inf, values)
