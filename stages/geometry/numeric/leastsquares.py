"""Weighted linear least squares with stated uncertainties, gross errors told apart one by one.

Minimise sum ((y - A x) / s)^2, s the standard uncertainty of each y.  The covariance is (A' S^-2 A)^-1: it rests on the
stated uncertainties alone, and `chance` says whether the residuals bear them out: the probability of residuals at least
as large, by the chi-square distribution.  Columns are scaled before the rank is judged, so units do not count.

`snooped` names gross errors by data snooping [1]_: a residual over its own standard deviation, normal if all is well,
is tested at a chance of `FALSE_ALARM` over all values together; the worst one is set aside and the rest fitted again,
as long as one is found.  It cannot tell an error that no other value checks, nor errors of half of the values.

.. [1] W. Baarda, "A testing procedure for use in geodetic networks", Netherlands Geodetic Commission, 1968.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import chdtrc, ndtri

from stages.geometry.arrays import EPS, Array, ArrayValue, Numbers, Values

FALSE_ALARM = 1e-3
"""How often a set of good values is accused of a gross error, and good residuals of being too large."""
DEFINED = 1e-6
"""Columns, each of length 1, whose least singular value is below this share of the largest tell nothing apart."""
UNCHECKED = 1e-9
"""A value of which the others check less than this share cannot be seen to be wrong."""


@dataclass(frozen=True, slots=True, eq=False)
class Fit(ArrayValue):
    """What was fitted.

    values: shape (p,).  covariance: shape (p, p), from the stated uncertainties.
    normalised: each residual over its own standard deviation, 0 where no other value checks it.
    chance: of residuals at least as large, if the model and the stated uncertainties are right; 1 without redundancy.
    """

    values: Array
    covariance: Array
    normalised: Values
    chance: float


@dataclass(frozen=True, slots=True, eq=False)
class Snooped(ArrayValue):
    """A fit without the values set aside, by their places in what was given, in the order they were found."""

    fit: Fit
    kept: Numbers
    aside: Numbers


class UndefinedError(ValueError):
    """The values do not tell all unknowns: `rank` of them can be told."""

    def __init__(self, rank: int, unknowns: int) -> None:
        super().__init__(f"{rank} of {unknowns} unknowns can be told")
        self.rank = rank
        self.unknowns = unknowns


def fitted(matrix: Array, y: Values, uncertainty: Values) -> Fit:
    """Return the fit of y = matrix x.  uncertainty: standard ones, positive.  Raises UndefinedError."""
    weighted, right = matrix / uncertainty[:, None], y / uncertainty
    length = np.sqrt((weighted**2).sum(axis=0))
    scaled = np.divide(weighted, length, out=np.zeros_like(weighted), where=length > 0.0)
    left, sizes, turned = np.linalg.svd(scaled, full_matrices=False)
    rank = int((sizes > max(DEFINED * sizes.max(initial=0.0), EPS)).sum())
    if rank < matrix.shape[1]:
        raise UndefinedError(rank, matrix.shape[1])
    inverse = (turned.T / sizes) / length[:, None]
    values = inverse @ (left.T @ right)
    residual = right - weighted @ values
    free = 1.0 - (left**2).sum(axis=1)
    normalised = np.divide(residual, np.sqrt(free.clip(0.0)), out=np.zeros_like(y), where=free > UNCHECKED)
    redundancy = y.size - rank
    chance = float(chdtrc(redundancy, residual @ residual)) if redundancy else 1.0
    return Fit(values, inverse @ inverse.T, normalised, chance)


def snooped(matrix: Array, y: Values, uncertainty: Values) -> Snooped:
    """Return the fit without gross errors.  Raises UndefinedError where what is left does not tell all unknowns."""
    kept, aside = np.arange(y.size), np.zeros(0, np.int64)
    critical = -float(ndtri(FALSE_ALARM / 2.0 / y.size))
    while True:
        fit = fitted(matrix[kept], y[kept], uncertainty[kept])
        worst = int(np.argmax(np.abs(fit.normalised)))
        if kept.size <= matrix.shape[1] + 1 or abs(fit.normalised[worst]) <= critical:
            return Snooped(fit, kept, aside)
        aside = np.append(aside, kept[worst])
        kept = np.delete(kept, worst)
