"""What straps and ribbons share: the pieces of their curve, how wide they may be, and where that cannot be said."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from math import isinf

import numpy as np

from stages.geometry.arrays import Values, diagonal
from stages.geometry.curves.curves import Curve
from stages.geometry.numeric.extremum import maximum
from stages.geometry.ruled.envelope import Widest, speed
from stages.model.report import Finding, Metric, Where

PLACES = 33
"""Samples of each piece that give its size."""


def positions(curves: Sequence[Curve]) -> np.ndarray:
    """Return points along the curves, shape (n, 3), mm."""
    return np.concatenate([curve.jet(np.linspace(0.0, 1.0, PLACES), 0)[0] for curve in curves])


def size_along(curves: Sequence[Curve]) -> float:
    """Return the diagonal of the bounding box of the curves, mm (sampled)."""
    return diagonal(positions(curves))


@dataclass(frozen=True, slots=True)
class Least:
    """The least value of a function along a band and its place."""

    value: float
    piece: int
    v: float

    @property
    def where(self) -> Where:
        """Return the place for a report; v counts on over the pieces."""
        return place(self.piece, self.v)


def place(piece: int, v: float) -> Where:
    """Return a place for a report; v counts on over the pieces."""
    return {"piece": piece, "v": piece + v}


def least(functions: Sequence[Callable[[Values], Values]]) -> Least:
    """Return the least value of a function that is given on each piece (sampled)."""
    found = [maximum(partial(_negative, function)) for function in functions]
    piece = max(range(len(found)), key=lambda i: found[i][0])
    return Least(-found[piece][0], piece, found[piece][1])


def _negative(function: Callable[[Values], Values], v: Values) -> Values:
    return -function(v)


def stops(key: str, curves: Sequence[Curve]) -> tuple[Finding, ...]:
    """Return a finding where a curve stops: no tangent and no ruling there."""
    slowest = least([partial(speed, curve) for curve in curves])
    if slowest.value > STOPPED * size_along(curves):
        return ()
    message = f"{key}: the curve stops at v = {slowest.where['v']:.6g}, where it has no tangent and no ruling"
    return (Finding("curve-stops", message, True, slowest.where),)


STOPPED = 1e-7
"""A speed below this share of the size vanishes: sampling comes within some 1e-8 of a zero."""

LEANING_DEG = 1.0
"""Beyond this the band does not touch the surface that was meant: normals of that surface are off by the tangent's
error only, and tangents of a spline through points 10 deg apart by less than a hundredth of a degree."""

PARALLEL = 1e-9
"""An edge of regression more than a billion sizes away is rounding: the rulings are parallel."""


def limit_metric(name: str, widest: Widest, size_mm: float) -> Metric:
    """Return how wide a side may be, None without a limit."""
    if isinf(widest.width_mm) or size_mm <= PARALLEL * widest.width_mm:
        return Metric(name, None, "mm")
    return Metric(name, widest.width_mm, "mm", where=place(widest.piece, widest.v))


def too_wide(code: str, key: str, width_mm: float, widest: Widest) -> tuple[Finding, ...]:
    """Return a finding if a side reaches the edge of regression."""
    if width_mm < widest.width_mm:
        return ()
    where = place(widest.piece, widest.v)
    message = (
        f"{key} {width_mm:g} mm reaches the edge of regression at v = {where['v']:.6g}: "
        f"it must be less than {widest.width_mm:.6g} mm"
    )
    return (Finding(code, message, True, where),)
