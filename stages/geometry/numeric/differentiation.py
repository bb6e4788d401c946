"""Numerical differentiation of smooth functions from their values at a few nodes of [-1, 1].

The derivative of the interpolating polynomial, by barycentric weights [1]_: exact on polynomials of a degree below the
number n of nodes, with a rounding error of some n^2 / 2 of the values' own.  Nodes count as they are: a node off its
place by rounding is as good as any other, as long as the value is taken there.

.. [1] J.-P. Berrut, L. N. Trefethen, "Barycentric Lagrange interpolation", SIAM Review 46 (2004), section 9.3.
"""

import numpy as np

from stages.geometry.arrays import Array, Values


def matrix(nodes: Array) -> Array:
    """Return the matrices from values at nodes (..., n) to the derivatives there, shape (..., n, n)."""
    gaps = nodes[..., :, None] - nodes[..., None, :] + np.eye(nodes.shape[-1])
    weight = 1.0 / gaps.prod(axis=-1)
    slopes: Array = (weight[..., None, :] / weight[..., :, None]) / gaps
    diagonal = np.arange(nodes.shape[-1])
    slopes[..., diagonal, diagonal] = 0.0
    slopes[..., diagonal, diagonal] = -slopes.sum(axis=-1)
    return slopes


def lobatto(count: int) -> tuple[Values, Values]:
    """Return the Chebyshev points of [-1, 1], both ends among them, and the weights of Clenshaw and Curtis."""
    n = count - 1
    angle = np.pi * np.arange(count) / n
    weights = np.zeros(count)
    for k in range(n // 2 + 1):
        share = 0.5 if k in (0, n / 2) else 1.0
        weights += share * 2.0 / (1.0 - 4.0 * k * k) * np.cos(2.0 * k * angle)
    weights *= 2.0 / n
    weights[[0, -1]] /= 2.0
    points: Array = -np.cos(angle)
    points[n // 2] = 0.0 if n % 2 == 0 else points[n // 2]
    return points, weights
