"""Gauss-Legendre panels: integrals and antiderivatives of smooth functions to rounding.

On a panel the function is sampled at 16 Gauss nodes and expanded in Legendre polynomials; the last two coefficients
say how well it is resolved.  The antiderivative follows from  int P_k = (P_{k+1} - P_{k-1}) / (2k + 1).  Panels are
halved until they resolve; all pending panels are evaluated in one call.

Not for functions with a jump inside: split there first.  An integrable singularity at an end costs panels, no accuracy.
"""

from collections.abc import Callable

import numpy as np
from numpy.polynomial import legendre

from stages.errors import NoSolutionError
from stages.geometry.arrays import Array, Matrix, Values

ORDER = 16
"""Nodes of a panel: degree 31 is integrated exactly, and a quintic patch needs 2 to 20 panels."""
ROUNDING = 8 * 4e-15
"""A Legendre coefficient below this share of the scale is noise: 16 products of doubles, summed with both signs."""
DEPTH = 40
"""A panel is halved at most so often: 2**-40 of the whole, where any integrable singularity has lost its weight."""
MOST_PANELS = 2048
"""So many panels at once are noise, not a function: an end singularity takes 2 per halving, a hard patch some 100,
rails that turn where they touch up to 2000."""

NODES, WEIGHTS = legendre.leggauss(ORDER)


def _analysis() -> Matrix:
    """Return the matrix from values at the nodes to Legendre coefficients, shape (16, 16)."""
    k = np.arange(ORDER)
    matrix: Matrix = (legendre.legvander(NODES, ORDER - 1) * WEIGHTS[:, None]).T * (2 * k[:, None] + 1) / 2.0
    return matrix


def _antiderivative() -> Matrix:
    """Return the matrix from Legendre coefficients to those of the antiderivative from -1, shape (17, 16)."""
    matrix = np.zeros((ORDER + 1, ORDER))
    for k in range(ORDER):
        matrix[k + 1, k] += 1.0 / (2 * k + 1)
        if k > 0:
            matrix[k - 1, k] -= 1.0 / (2 * k + 1)
    matrix[0] -= ((-1.0) ** np.arange(ORDER + 1)[:, None] * matrix).sum(axis=0)
    return matrix


ANALYSIS = _analysis()
ANTIDERIVATIVE = _antiderivative()
AT_NODES = legendre.legvander(NODES, ORDER)
"""Values at the nodes from 17 Legendre coefficients, shape (16, 17)."""


def nodes(starts: Values, ends: Values) -> Matrix:
    """Return the Gauss nodes of the panels [starts, ends], shape (panels, 16)."""
    every: Matrix = (starts + ends)[:, None] / 2.0 + np.outer(ends - starts, NODES) / 2.0
    return every


def coefficients(values: Array) -> Array:
    """Return Legendre coefficients along axis 1 of values at the nodes, shape (panels, 16, ...)."""
    series: Array = np.einsum("kj,pj...->pk...", ANALYSIS, values)
    return series


def panels(sample: Callable[[Values], Array], subject: str) -> tuple[Values, Array]:
    """Return breaks of [0, 1], shape (m + 1,), and values at the nodes, (m, 16, channels), that resolve all channels.

    `sample` takes values of v, shape (n,), and gives (n, channels): one scale serves all channels, the largest value.
    A panel is resolved when its last two coefficients, times its share of the interval once it is small, are below
    `ROUNDING` of the scale.  Raises NoSolutionError if halving does not get there.
    """
    ends = np.array([[0.0, 1.0]])
    done: list[tuple[Array, Array]] = []
    scale = 0.0
    for _ in range(0, DEPTH, 2):
        # a panel and its halves in one call: what a call costs beside its nodes is paid every second time
        family = np.concatenate([ends[:, None], _halves(ends)], axis=1)
        values = sample(nodes(*family.reshape(-1, 2).T).ravel()).reshape(*family.shape[:2], ORDER, -1)
        scale = max(scale, float(np.abs(values).max()))
        tails = _tails(values) * np.minimum(1.0, np.diff(family)[..., 0] * SMALL_PANEL)
        resolved = tails <= ROUNDING * scale
        whole, halves = resolved[:, 0], resolved[:, 1:] & ~resolved[:, :1]
        left = ~resolved[:, 1:] & ~resolved[:, :1]
        done += [(family[whole, 0], values[whole, 0]), (family[:, 1:][halves], values[:, 1:][halves])]
        ends = _halves(family[:, 1:][left]).reshape(-1, 2)
        if not ends.size:
            return _in_order(done)
        if len(ends) > MOST_PANELS:
            break
    reached = float(tails[:, 1:][left].max() / scale) if scale > 0.0 else np.inf
    raise NoSolutionError(subject, reached=reached, wanted=ROUNDING, unit="of the scale")


def _tails(values: Array) -> Array:
    """Return the larger of the last two coefficients of each panel, from values (..., 16, channels)."""
    tails: Array = np.abs(np.einsum("kj,...jc->...kc", ANALYSIS[-2:], values)).max(axis=(-2, -1))
    return tails


def _halves(ends: Array) -> Array:
    """Return the ends of both halves of each panel, (m, 2, 2), from the panels' own (m, 2)."""
    low, high = ends.T
    middle = (low + high) / 2.0
    return np.stack([np.stack([low, middle], axis=1), np.stack([middle, high], axis=1)], axis=1)


def _in_order(done: list[tuple[Array, Array]]) -> tuple[Array, Array]:
    """Return the breaks, (m + 1,), and the values of panels that cover [0, 1], from the first to the last."""
    ends, values = (np.concatenate(part) for part in zip(*done, strict=True))
    order = np.argsort(ends[:, 0])
    return np.append(ends[order, 0], 1.0), values[order]


SMALL_PANEL = 2.0**12
"""Below 1/4096 of the interval a panel counts only by its share: that is how a square-root end is resolved."""


def beginnings(series: Array, start: Array) -> Array:
    """Return where each panel begins, (m, c): where the one before ends; from series (m, 17, c) and the start (c,)."""
    ends = series.sum(axis=1)
    begun: Array = np.concatenate([np.zeros((1, ends.shape[1])), np.cumsum(ends, axis=0)[:-1]]) + start
    return begun


def integral(sample: Callable[[Values], Array], subject: str) -> Array:
    """Return the integrals over [0, 1] of all channels, shape (channels,); relative error some 1e-15 of the scale."""
    breaks, values = panels(sample, subject)
    total: Array = np.einsum("p,j,pjc->c", np.diff(breaks) / 2.0, WEIGHTS, values)
    return total
