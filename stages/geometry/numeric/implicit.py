"""A function given by a power series G(x, h) = 0 in two small variables: x(h), its own series, and what is made of it.

Where G rises with x its coefficients follow one by one.  Where G has no terms of first order two curves G = 0 cross;
then x = h y(h) with G(h y, h) / h^2 = 0, and y starts as the root of a quadratic that is nearest to the rate expected.
Coefficients of G run along the first two axes, by x and by h; those of series along the first; places along the last.

Not where G and its second derivatives vanish together: x stays 0 there.
"""

from functools import cache
from math import comb

import numpy as np

from stages.geometry.arrays import Array, Mask, Values, cross3, locked
from stages.geometry.numeric.series import product, taylor


@cache
def sheared(order: int) -> Array:
    """Return the matrix from coefficients of F(x, y) to those of F(x, h - x), both up to a total degree of `order`."""
    matrix = np.zeros((order + 1,) * 4)
    for i in range(order + 1):
        for j in range(order + 1 - i):
            for k in range(j + 1):
                matrix[i + k, j - k, i, j] = (-1.0) ** k * comb(j, k)
    return locked(matrix)


def offset(G: Array) -> Values:
    """Return x with G(x, 0) = 0, by two of Newton's steps from 0; infinite where G does not change with x."""
    with np.errstate(divide="ignore", invalid="ignore"):
        x = -G[0, 0] / G[1, 0]
        x -= (G[0, 0] + x * (G[1, 0] + x * G[2, 0])) / (G[1, 0] + 2.0 * x * G[2, 0])
    found: Values = np.where(np.isfinite(x), x, np.inf)
    return found


def implicit(G: Array, expected: Values) -> Array:
    """Return the series x(h) with x(0) = 0 and G(x(h), h) = 0; one shorter than G, as crossings need one order more.

    expected: the rate dx/dh at a crossing, roughly.
    """
    crossing = crosses(G)
    x = np.zeros_like(G[0, :-1])
    # not where curves cross: divided by a G_x that is rounding the powers would overflow
    x[:, ~crossing] = _regular(G[:-1, :-1, ~crossing])
    if crossing.any() and x.shape[0] > 1:
        x[1:, crossing] = _crossing(G[..., crossing], expected[crossing])
    return x


def crosses(G: Array) -> Mask:
    """Return where two curves G = 0 cross."""
    second: Values = np.abs(G[2, 0]) + np.abs(G[1, 1]) + np.abs(G[0, 2])
    crossing: Mask = np.abs(G[1, 0]) <= CROSSING * second
    return crossing


CROSSING = 1e-8
"""Two curves G = 0 cross within this distance: what is left out there is as small as what rounding leaves of G_x."""


def _regular(G: Array) -> Array:
    """Return x(h) where G rises with x; 0 where it does not."""
    # powers[i] is the series of x^i, as far as it is known
    powers = np.zeros_like(G)
    powers[0, 0] = 1.0
    x = powers[1] if len(G) > 1 else np.zeros_like(G[0])
    for k in range(1, len(G)):
        for i in range(2, k + 1):
            powers[i, k] = np.einsum("mn,mn->n", x[1:k], powers[i - 1, k - 1 : 0 : -1])
        rest = np.sum([G[i, k - m] * powers[i, m] for i in range(k + 1) for m in range(i, k + 1)], axis=0)
        x[k] = np.divide(-rest, G[1, 0], out=np.zeros_like(rest), where=G[1, 0] != 0.0)
    found: Array = x.copy()
    return found


def _crossing(G: Array, expected: Values) -> Array:
    """Return x(h) / h, from G(h y, h) / h^2 with y = root + z."""
    a, b, c = G[2, 0], G[1, 1], G[0, 2]
    root = np.sqrt(np.maximum(b * b - 4.0 * a * c, 0.0))
    top = -(b + np.copysign(root, b))
    with np.errstate(divide="ignore", invalid="ignore"):
        both = np.stack([top / (2.0 * a), 2.0 * c / top])
    both = np.where(np.isfinite(both), both, np.inf)
    y = np.where(np.abs(both[0] - expected) < np.abs(both[1] - expected), both[0], both[1])
    y = np.where(np.isfinite(y), y, expected)
    shifted = np.zeros_like(G[:-2, :-2])
    for k in range(len(G)):
        for m in range(max(k - 2, 0), len(G) - 2):
            # the term of x^k h^(m + 2 - k) is y^k h^m, and y^k is spread over the powers of z
            for i in range(min(k, len(G) - 3) + 1):
                shifted[i, m] += comb(k, i) * y ** (k - i) * G[k, m + 2 - k]
    z: Array = _regular(shifted)
    z[0] = y
    return z


def outer(a: Array, b: Array) -> Array:
    """Return the cross product of two series of vectors, by one product for each coefficient of the first."""
    total = np.zeros_like(a)
    for i, term in enumerate(a):
        rest = b[: len(b) - i]
        total[i:] += cross3(np.tile(term, (len(rest), 1)), rest.reshape(-1, 3)).reshape(rest.shape)
    return total


def composed(jet: Array, x: Array) -> Array:
    """Return the Taylor coefficients of f(x(w)), shape (m, n, 3), from f's derivatives at x[0] and x's own, (m, n)."""
    count = x.shape[0]
    step = x.copy()
    step[0] = 0.0
    terms = taylor(jet[:count])
    total: Array = np.zeros_like(terms)
    total[0] = terms[0]
    power = step
    for i in range(1, count):
        total[i:] += power[i:, :, None] * terms[i]
        if i + 1 < count:
            power = product(power, step)
    return total
