"""The largest value of a function on [0, 1], by sampling and zooming in.

The function is sampled at Chebyshev points of several equal cells; the cells around the best samples are sampled again
until their width is below rounding.  Finds every maximum that is wider than a cell; `sampled`, not proved.
"""

from collections.abc import Callable

import numpy as np

from stages.geometry.arrays import Values

CELLS = 48
"""Cells of the first pass, 8 points each: a quintic patch has at most some 20 extrema of warp or curvature."""
PER_CELL = 8
ZOOMS = 9
"""Each pass narrows the interval by 4: after 9 it is 1e-7 wide, where a smooth maximum is flat to 1e-14."""


def maximum(function: Callable[[Values], Values]) -> tuple[float, float]:
    """Return (largest value, where) of a function that takes an array of v in [0, 1]; NaN values are passed over."""
    angle = (2.0 * np.arange(PER_CELL) + 1.0) * np.pi / (2.0 * PER_CELL)
    offsets = (1.0 - np.cos(angle)) / 2.0
    v = np.concatenate([[0.0], ((np.arange(CELLS)[:, None] + offsets) / CELLS).ravel(), [1.0]])
    best, place = _best(function, v)
    half = 1.0 / (CELLS * PER_CELL / 4)
    for _ in range(ZOOMS):
        v = np.clip(place + half * np.linspace(-1.0, 1.0, 4 * PER_CELL + 1), 0.0, 1.0)
        value, where = _best(function, v)
        if value > best:
            best, place = value, where
        half /= 4.0
    return best, place


def _best(function: Callable[[Values], Values], v: Values) -> tuple[float, float]:
    values = function(v)
    values = np.where(np.isnan(values), -np.inf, values)
    index = int(np.argmax(values))
    return float(values[index]), float(v[index])
