"""The largest value of a function on [0, 1], by sampling and zooming in.

The function is sampled at Chebyshev points of several equal cells; the neighbourhoods of the highest peaks are sampled
again until their width is below rounding.  Finds a maximum that is wider than a cell; `sampled`, not proved.
Several functions of the same v are searched together, so that what they share is computed once.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from stages.geometry.arrays import Array, Values

CELLS = 48
"""Cells of the first pass, 8 points each: a quintic patch has at most some 20 extrema of warp or curvature."""
PER_CELL = 8
ZOOMS = 5
"""Each pass narrows the interval by 16: after 5 it is 3e-7 wide, where a smooth maximum is flat to 1e-14."""
NARROWING = 16
ZOOM_POINTS = 2 * NARROWING + 1
"""A pass keeps one step on both sides of the best place of the pass before."""

PEAKS = 6
"""At most so many peaks of the first pass are zoomed into: of two nearly equal ones, the lower may show higher."""
OVERSHOOT = 2.0
"""A peak may be higher than the samples show by its height over the neighbouring samples; twice that leaves room."""


def maximum(function: Callable[[Values], Values]) -> tuple[float, float]:
    """Return (largest value, where) of a function that takes an array of v in [0, 1]; NaN values are passed over."""
    return maxima(lambda v: function(v)[:, None])[0]


def minimum(function: Callable[[Values], Values]) -> tuple[float, float]:
    """Return (least value, where): as `maximum`."""
    value, v = maximum(lambda places: -function(places))
    return -value, v


def maxima(functions: Callable[[Values], Array]) -> list[tuple[float, float]]:
    """Return (largest value, where) of several functions of v, given as the columns of one array."""
    v = _first_places()
    values = _numbers(functions(v))
    peaks = [_peaks(column) for column in values.T]
    owner = np.repeat(np.arange(len(peaks)), [found.size for found in peaks])
    rows = np.concatenate(peaks)
    best, places = values[rows, owner], v[rows]
    half = 1.0 / (CELLS * PER_CELL / 4)
    each = np.arange(places.size)
    for _ in range(ZOOMS):
        around = np.clip(places[:, None] + half * np.linspace(-1.0, 1.0, ZOOM_POINTS), 0.0, 1.0)
        every = _numbers(functions(around.ravel())).reshape(*around.shape, -1)
        found = every[each, :, owner]
        column = np.argmax(found, axis=1)
        higher = found[each, column] > best
        best = np.where(higher, found[each, column], best)
        places = np.where(higher, around[each, column], places)
        half /= NARROWING
    firsts = [int(np.flatnonzero(owner == k)[np.argmax(best[owner == k])]) for k in range(len(peaks))]
    return [(float(best[i]), float(places[i])) for i in firsts]


def _first_places() -> Values:
    angle = (2.0 * np.arange(PER_CELL) + 1.0) * np.pi / (2.0 * PER_CELL)
    offsets = (1.0 - np.cos(angle)) / 2.0
    return np.concatenate([[0.0], ((np.arange(CELLS)[:, None] + offsets) / CELLS).ravel(), [1.0]])


def _peaks(values: Values) -> NDArray[np.int64]:
    """Return the places of the local maxima that may be the highest, the highest first."""
    padded = np.concatenate([values[1:2], values, values[-2:-1]])
    before, after = padded[:-2], padded[2:]
    local = np.flatnonzero((values >= before) & (values >= after))
    with np.errstate(invalid="ignore"):
        height = values[local] - np.minimum(before, after)[local]
    possible = values[local] + OVERSHOOT * np.where(np.isnan(height), 0.0, height)
    local = local[possible >= values.max()]
    highest: NDArray[np.int64] = local[np.argsort(-values[local], kind="stable")[:PEAKS]]
    return highest


def _numbers(values: Array) -> Array:
    return np.where(np.isnan(values), -np.inf, values)
