"""Polynomials in Bernstein form in float64: values, derivatives, and the basis itself.

Every term is positive times a coefficient for v in [0, 1], so nothing cancels that does not cancel in the coefficients.
The exact counterpart is `bernstein`.
"""

from functools import cache
from math import comb

import numpy as np

from stages.geometry.arrays import Array, Values, locked


def bernstein_jet(coefficients: Array, v: Values, order: int) -> Array:
    """Return sum_i B_i^n(v) coefficients[i] and its derivatives up to `order`, shape (order + 1, n points, k)."""
    degree = coefficients.shape[0] - 1
    powers, others = _powers(degree, v), _powers(degree, 1.0 - v)
    jets = np.zeros((order + 1, v.size, coefficients.shape[1]))
    for k in range(min(order, degree) + 1):
        left = degree - k
        jets[k] = (powers[: left + 1] * others[left::-1]).T @ (binomials(left)[:, None] * coefficients)
        coefficients = differences(coefficients, 1)
    return jets


def bernstein_sum(coefficients: Array, v: Values) -> Array:
    """Return sum_i B_i^n(v) coefficients[i], shape (n points, k)."""
    total: Array = bernstein_jet(coefficients, v, 0)[0]
    return total


def bernstein_basis(degree: int, v: Values) -> Array:
    """Return the Bernstein polynomials of a degree at v, shape (n points, degree + 1)."""
    basis: Array = binomials(degree)[:, None] * _powers(degree, v) * _powers(degree, 1.0 - v)[::-1]
    return basis.T


def _powers(degree: int, v: Values) -> Array:
    """Return v to the powers 0 to `degree`, shape (degree + 1, n points)."""
    powers = np.ones((degree + 1, v.size))
    for i in range(1, degree + 1):
        np.multiply(powers[i - 1], v, out=powers[i])
    return powers


@cache
def binomials(degree: int) -> Values:
    """Return one row of Pascal's triangle."""
    return locked(np.array([float(comb(degree, i)) for i in range(degree + 1)]))


def differences(coefficients: Array, order: int) -> Array:
    """Return the Bernstein coefficients of the derivative of that order (one zero row beyond the degree)."""
    for _ in range(order):
        n = coefficients.shape[0] - 1
        coefficients = n * np.diff(coefficients, axis=0) if n > 0 else np.zeros_like(coefficients)
    return coefficients
