"""Truncated power series of functions of v at many places at once, and their arithmetic.

Coefficient k is the k-th derivative over k!; it runs along the first axis, the places along the second, so that a
scalar is (k, n) and a vector (k, n, 3).  Of two series of unlike length the result has the shorter one.  Exact but for
rounding: what is made of jets by these keeps as many derivatives as it started from, less one for each `slope` [1]_.

.. [1] D. E. Knuth, "The Art of Computer Programming", vol. 2, 3rd ed., section 4.7, 1997.
"""

from math import factorial

import numpy as np

from stages.geometry.arrays import Array


def taylor(jet: Array) -> Array:
    """Return the power series of a function from its derivatives."""
    series: Array = jet / _factorials(jet)
    return series


def derivatives(series: Array) -> Array:
    """Return value and derivatives of a function from its power series."""
    jet: Array = series * _factorials(series)
    return jet


def _factorials(series: Array) -> Array:
    count = series.shape[0]
    return np.array([float(factorial(k)) for k in range(count)]).reshape(-1, *[1] * (series.ndim - 1))


def slope(series: Array) -> Array:
    """Return the series of the derivative, one shorter."""
    counts = np.arange(1.0, series.shape[0]).reshape(-1, *[1] * (series.ndim - 1))
    derivative: Array = counts * series[1:]
    return derivative


def product(a: Array, b: Array) -> Array:
    """Return the product of two scalars, or of a scalar and a vector whose axis it has."""
    found: Array = np.einsum("i...,ik...->k...", a[: _shorter(a, b)], _shifted(a, b))
    return found


def scaled(factor: Array, vector: Array) -> Array:
    """Return a scalar times a vector."""
    return product(factor[..., None], vector)


def inner(a: Array, b: Array) -> Array:
    """Return the dot product of two vectors."""
    found: Array = np.einsum("i...c,ik...c->k...", a[: _shorter(a, b)], _shifted(a, b))
    return found


def outer(a: Array, b: Array) -> Array:
    """Return the cross product of two vectors."""
    forward, backward = [1, 2, 0], [2, 0, 1]
    first, second = a[: _shorter(a, b)], _shifted(a, b)
    found: Array = np.einsum("i...c,ik...c->k...c", first[..., forward], second[..., backward])
    found -= np.einsum("i...c,ik...c->k...c", first[..., backward], second[..., forward])
    return found


def _shifted(a: Array, b: Array) -> Array:
    """Return b moved by i places along its orders, i in the first axis: what term i of a series a is multiplied by."""
    count = _shorter(a, b)
    before = np.concatenate([np.zeros((count - 1, *b.shape[1:])), b[:count]])
    order = np.arange(count)
    moved: Array = before[count - 1 + order[None, :] - order[:, None]]
    return moved


def _shorter(a: Array, b: Array) -> int:
    return min(len(a), len(b))


def power(base: Array, exponent: float) -> Array:
    """Return a scalar to a power; the base may not vanish, and not be negative unless the exponent is whole.

    From  s r' = a s' r  for r = s^a, term by term.
    """
    powers = [base[0] ** exponent]
    for k in range(1, base.shape[0]):
        terms = [(j * (exponent + 1.0) - k) * base[j] * powers[k - j] for j in range(1, k + 1)]
        powers.append(np.sum(terms, axis=0) / (k * base[0]))
    return np.stack(powers)


def unit(vector: Array) -> Array:
    """Return a vector scaled to length 1; zero, with all its derivatives, where it is zero."""
    squares = inner(vector, vector)
    gone = squares[0] == 0.0
    squares[0, gone] = 1.0
    return scaled(power(squares, -0.5), np.where(gone[:, None], 0.0, vector))
