"""Spectral elements: polynomials on pieces of the unit square, their derivatives and Gauss points.

An element covers all of u and a part [low, high] of v.  Its nodes are those of Gauss and Lobatto, the ends included, so
that neighbours share a column of nodes.  The interpolant converges faster than any power of the degree where the
function is smooth, and the nodes crowd at the edges, where layers are [1]_; at a singular corner it converges like a
power.  Arrays over nodes are (v, u), v first.

.. [1] C. Canuto, M. Y. Hussaini, A. Quarteroni, T. A. Zang, "Spectral Methods: Fundamentals in Single Domains", 2006,
   sections 2.3 and 5.1.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.polynomial import legendre

from stages.geometry.arrays import Array, ArrayValue, Matrix, Values


@dataclass(frozen=True, slots=True)
class Degrees:
    """Polynomial degrees of an element, along the rulings and across them."""

    u: int
    v: int


@cache
def lobatto(degree: int) -> Values:
    """Return the degree + 1 nodes on [-1, 1]: both ends and the zeros of the derivative of P_degree."""
    polynomial = np.zeros(degree + 1)
    polynomial[degree] = 1.0
    inner = np.sort(legendre.legroots(legendre.legder(polynomial)).real)
    symmetric = (inner - inner[::-1]) / 2.0
    return np.concatenate([[-1.0], symmetric, [1.0]])


@cache
def analysis(degree: int) -> Matrix:
    """Return the matrix from values at the nodes to Legendre coefficients."""
    matrix: Matrix = np.linalg.inv(legendre.legvander(lobatto(degree), degree))
    return matrix


def sampling(degree: int, x: Values) -> tuple[Matrix, Matrix]:
    """Return the matrices from values at the nodes to values and to derivatives at x, shape (n, degree + 1)."""
    series = analysis(degree)
    values: Matrix = legendre.legvander(x, degree) @ series
    slopes: Matrix = legendre.legvander(x, degree - 1) @ legendre.legder(series, axis=0)
    return values, slopes


@dataclass(frozen=True, slots=True, eq=False)
class Rule(ArrayValue):
    """Gauss points of an element, and the derivatives there of what is given at its nodes.

    u, v: the points, shape (q,), both from 0 to 1 over the element.  weights: of an integral over that square, (q,).
    by_u, by_v: matrices from values at the nodes to derivatives by those u and v, shape (q, nodes).
    """

    u: Values
    v: Values
    weights: Values
    by_u: Matrix
    by_v: Matrix


MORE_POINTS = 3
"""Gauss points beyond the degree: one for squares of the polynomials, two for the metric that multiplies them."""


@cache
def rule(degrees: Degrees) -> Rule:
    """Return the Gauss points of an element of these degrees."""
    (x, a), (y, b) = (legendre.leggauss(degree + MORE_POINTS) for degree in (degrees.u, degrees.v))
    (value_u, slope_u), (value_v, slope_v) = sampling(degrees.u, x), sampling(degrees.v, y)
    v, u = np.meshgrid((y + 1.0) / 2.0, (x + 1.0) / 2.0, indexing="ij")
    weights = np.outer(b, a).ravel() / 4.0
    return Rule(u.ravel(), v.ravel(), weights, 2.0 * np.kron(value_v, slope_u), 2.0 * np.kron(slope_v, value_u))


def node_places(breaks: Array, degrees: Degrees) -> tuple[Array, Array]:
    """Return v of the columns of nodes of every element, shape (m, nv + 1), and u of the nodes of a column."""
    share = (lobatto(degrees.v) + 1.0) / 2.0
    columns: Array = breaks[:-1, None] + np.diff(breaks)[:, None] * share
    columns[:, -1] = breaks[1:]
    return columns, (lobatto(degrees.u) + 1.0) / 2.0


def coefficients(values: Array, degrees: Degrees) -> Array:
    """Return the Legendre coefficients of values at the nodes of m elements, both of shape (m, nv + 1, nu + 1, c)."""
    made: Array = np.einsum("ai,bj,mijc->mabc", analysis(degrees.v), analysis(degrees.u), values, optimize=True)
    return made


def evaluate(series: Array, x: Values, y: Values) -> Array:
    """Return one element's sums, shape (n, c), of coefficients (nv + 1, nu + 1, c) at x along u and y along v."""
    nv, nu, _ = series.shape
    rows = np.einsum("ni,ijc->njc", legendre.legvander(y, nv - 1), series)
    total: Array = np.einsum("nj,njc->nc", legendre.legvander(x, nu - 1), rows)
    return total
