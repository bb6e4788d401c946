"""Zeros of many functions of one variable at once, each in its own bracket, to rounding.

Chandrupatla's method: inverse quadratic steps that keep a bracket, halvings where these do not pay; scipy's vectorised
implementation.  Where a bracket has no change of sign there is no zero to be had: its better end is returned.
"""

from collections.abc import Callable

import numpy as np

from stages.geometry.arrays import EPS, Indices, Values

Function = Callable[[Values, Indices], Values]
"""Values at places, given with the numbers of the brackets they belong to."""


def bracketed(f: Function, low: Values, high: Values) -> Values:
    """Return a zero in each bracket [low, high]; where both ends have one sign, the end that is nearer to zero."""
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


def chord_zeros(f: Function, low: Values, high: Values) -> Values:
    """Return where the chord of f over each bracket is zero: within the square of the bracket of a simple zero."""
    number = np.arange(low.size)
    f_low, f_high = f(low, number), f(high, number)
    rise = f_high - f_low
    share = np.divide(-f_low, rise, out=np.full_like(rise, 0.5), where=rise != 0.0)
    return np.asarray(low + np.clip(share, 0.0, 1.0) * (high - low))
