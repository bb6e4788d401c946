"""Where on a chain of curves a given length from its beginning is reached."""

from collections.abc import Callable, Sequence

import numpy as np

from stages.geometry.arrays import Values, norm
from stages.geometry.curves.plane import PlaneCurve
from stages.geometry.numeric.quadrature import integral

Speed = Callable[[Values], Values]
"""The speed of a curve at values of t in [0, 1], mm."""

BISECTIONS = 60
NEAR = 1e-14
"""Of the length of a curve: as near as its quadrature tells."""
ROUNDING = 1e-12
"""A length that exceeds a chain by less than this share ends at its end."""


def speed_of(edge: PlaneCurve) -> Speed:
    """Return the speed of a plane curve."""
    return lambda t: norm(edge.derivative(t))


def length_between(speed: Speed, low: float, high: float) -> float:
    """Return the length from t = low to t = high, mm; some 1e-14 of the whole."""
    if high <= low:
        return 0.0
    return (high - low) * float(integral(lambda x: speed(low + (high - low) * x)[:, None], "length along an edge")[0])


def reached(speeds: Sequence[Speed], length_mm: float) -> tuple[int, float] | None:
    """Return the curve and its t at a length from the beginning of the chain; None beyond its end (or before it)."""
    lengths = [length_between(speed, 0.0, 1.0) for speed in speeds]
    total = sum(lengths)
    if not -ROUNDING * total <= length_mm <= total * (1.0 + ROUNDING):
        return None
    ends = np.cumsum(lengths)
    index = min(int(np.searchsorted(ends, length_mm)), len(speeds) - 1)
    rest = min(max(length_mm - float(ends[index] - lengths[index]), 0.0), lengths[index])
    return index, _parameter(speeds[index], rest, lengths[index])


def _parameter(speed: Speed, rest: float, length: float) -> float:
    """Return t at a length from the beginning of one curve: Newton's method inside a bracket that only shrinks."""
    low, high, t = 0.0, 1.0, rest / length if length > 0.0 else 0.0
    for _ in range(BISECTIONS):
        off = length_between(speed, 0.0, t) - rest
        if abs(off) <= NEAR * length:
            break
        low, high = (low, t) if off > 0.0 else (t, high)
        slope = float(speed(np.array([t]))[0])
        step = t - off / slope if slope > 0.0 else low
        t = step if low < step < high else (low + high) / 2.0
    return t
