"""Zeros of many functions of one variable at once, each in its own bracket, to rounding.

Chandrupatla's method: inverse quadratic steps that keep a bracket, halvings where these do not pay; scipy's vectorised
implementation.  Where a bracket has no change of sign there is no zero to be had: its better end is returned.
"""

from collections.abc import Callable

import numpy as np

from stages.geometry.arrays import EPS, Indices, Values


def bracketed(f: Callable[[Values, Indices], Values], low: Values, high: Values) -> Values:
    """Return a zero in each bracket [low, high]; where both ends have one sign, the end that is nearer to zero.

    f takes places and the numbers of the brackets they belong to.
    """
    from scipy.optimize import elementwise

    number = np.arange(low.size)
    f_low, f_high = f(low, number), f(high, number)
    found: Values = np.where(np.abs(f_low) <= np.abs(f_high), low, high)
    inside = np.flatnonzero(np.sign(f_low) * np.sign(f_high) < 0.0)
    if inside.size:

        def chosen(x: Values, k: Indices) -> Values:
            return f(np.asarray(x, dtype=np.float64), np.asarray(k).astype(np.int64))

        solved = elementwise.find_root(
            chosen, (low[inside], high[inside]), args=(inside,), tolerances={"xatol": 0.0, "xrtol": 2.0 * EPS}
        )
        found[inside] = solved.x
    return found
