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
MOST_PANELS = 4096
"""So many panels at once are noise, not a function: an end singularity takes 2 per halving, a hard patch some 100."""

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


def _differentiation() -> Matrix:
    """Return the matrix from values at the nodes to derivatives there (barycentric), shape (16, 16)."""
    gaps = NODES[:, None] - NODES + np.eye(ORDER)
    weight = 1.0 / gaps.prod(axis=1)
    matrix: Matrix = (weight[None, :] / weight[:, None]) / gaps
    np.fill_diagonal(matrix, 0.0)
    np.fill_diagonal(matrix, -matrix.sum(axis=1))
    return matrix


DIFFERENTIATION = _differentiation()


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
    pending = [(0.0, 1.0)]
    done: list[tuple[float, float, Array]] = []
    scale = 0.0
    for _ in range(DEPTH):
        starts, ends = np.array(pending).T
        values = sample(nodes(starts, ends).ravel()).reshape(starts.size, ORDER, -1)
        scale = max(scale, float(np.abs(values).max()))
        tail = np.abs(coefficients(values)[:, -2:]).max(axis=(1, 2)) * np.minimum(1.0, (ends - starts) * SMALL_PANEL)
        good = tail <= ROUNDING * scale
        done += [(a, b, block) for a, b, block in zip(starts[good], ends[good], values[good], strict=True)]
        middle = (starts + ends) / 2.0
        pending = [
            half for a, m, b in zip(starts[~good], middle[~good], ends[~good], strict=True) for half in ((a, m), (m, b))
        ]
        if not pending:
            done.sort(key=lambda panel: panel[0])
            return np.array([panel[0] for panel in done] + [1.0]), np.stack([panel[2] for panel in done])
        if len(pending) > MOST_PANELS:
            break
    reached = float(tail.max() / scale) if scale > 0.0 else np.inf
    raise NoSolutionError(subject, reached=reached, wanted=ROUNDING, unit="of the scale")


SMALL_PANEL = 2.0**12
"""Below 1/4096 of the interval a panel counts only by its share: that is how a square-root end is resolved."""


def integral(sample: Callable[[Values], Array], subject: str) -> Array:
    """Return the integrals over [0, 1] of all channels, shape (channels,); relative error some 1e-15 of the scale."""
    breaks, values = panels(sample, subject)
    total: Array = np.einsum("p,j,pjc->c", np.diff(breaks) / 2.0, WEIGHTS, values)
    return total
