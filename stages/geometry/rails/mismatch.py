"""F(t, s) = det(r', c - r, c') of two rails r(t) and c(s): zero where both tangents and the ruling lie in one plane."""

import numpy as np

from stages.geometry.arrays import Array, Points3, Values, cross3, dot, norm
from stages.geometry.curves.curves import Curve
from stages.geometry.numeric.implicit import outer
from stages.geometry.numeric.series import slope, taylor


def _triple(a: Points3, b: Points3, c: Points3) -> Values:
    triple: Values = dot(cross3(a, b), c)
    return triple


def mismatch(a: Curve, b: Curve, t: Values, s: Values) -> Values:
    """Return F = det(r', c - r, c') at pairs of parameters, mm3."""
    r, c = a.jet(t, 1), b.jet(s, 1)
    return _triple(r[1], c[0] - r[0], c[1])


def mismatch_and_slope(a: Curve, b: Curve, t: Values, s: Values) -> tuple[Values, Values]:
    """Return F and F_t - F_s."""
    r, c = a.jet(t, 2), b.jet(s, 2)
    arm = c[0] - r[0]
    side = cross3(r[1], arm)
    return dot(side, c[1]), _triple(r[2], arm, c[1]) - dot(side, c[2])


def mismatch_series(a: Curve, b: Curve, t: Values, s: Values, order: int) -> Array:
    """Return the Taylor coefficients of F about pairs of parameters, shape (order + 1, order + 1, n).

    F = r' . M - N . c' with M = (c - r_0) x c', of s alone, and N = r' x (r - r_0), of t alone.
    """
    r, c = taylor(a.jet(t, order + 1)), taylor(b.jet(s, order + 1))
    along_r, along_c = slope(r), slope(c)
    c[0] -= r[0]
    r[0] = 0.0
    M, N = outer(c[:-1], along_c), outer(along_r, r[:-1])
    F: Array = np.einsum("ind,jnd->ijn", along_r, M) - np.einsum("ind,jnd->ijn", N, along_c)
    return F


def scale(r: Array, c: Array) -> Values:
    """Return |r'||p||c'| from jets of both rails: F over it is the sine of an angle."""
    size: Values = norm(r[1]) * norm(c[0] - r[0]) * norm(c[1])
    return size
