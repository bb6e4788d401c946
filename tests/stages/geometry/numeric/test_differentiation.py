"""Differentiation at nodes is exact on polynomials, also where the nodes are not quite those that were meant."""

import numpy as np
import pytest
from numpy.polynomial import legendre

from stages.geometry.arrays import EPS
from stages.geometry.numeric.differentiation import lobatto, matrix
from tests.near import assert_near

NODES = {
    "Gauss": legendre.leggauss(20)[0],
    "Chebyshev": lobatto(17)[0],
    "uneven": np.array([-1.0, -0.7, 0.1, 0.4, 0.9]),
}


@pytest.mark.parametrize("name", NODES)
def test_polynomials_are_differentiated_exactly(name: str) -> None:
    nodes = NODES[name]
    for degree in range(nodes.size):
        slopes = degree * nodes ** max(degree - 1, 0)
        bound = 4 * nodes.size**2 * EPS
        assert_near(matrix(nodes) @ nodes**degree, slopes, bound=bound, why="n^2 / 2 roundings of values up to 1")


def test_each_row_of_nodes_has_its_own_matrix() -> None:
    """Nodes off their places by 1e-9, as those of a narrow panel are by rounding: exact at what they are."""
    meant = NODES["Gauss"]
    shifted = np.stack([meant, meant + 1e-9 * np.cos(7.0 * np.arange(20))])
    slopes = np.einsum("pij,pj->pi", matrix(shifted), shifted**9)
    assert_near(slopes, 9.0 * shifted**8, bound=4 * 20**2 * EPS, why="n^2 / 2 roundings of values up to 1")
    off = np.abs(matrix(meant) @ shifted[1] ** 9 - 9.0 * shifted[1] ** 8).max()
    assert off > 1e-9, "the matrix of the nodes that were meant would not do"


@pytest.mark.parametrize("count", [2, 3, 8, 17])
def test_the_weights_integrate_polynomials_below_their_number(count: int) -> None:
    points, weights = lobatto(count)
    assert (points[0], points[-1]) == (-1.0, 1.0)
    assert (np.diff(points) > 0.0).all()
    for degree in range(count):
        expected = (1.0 - (-1.0) ** (degree + 1)) / (degree + 1)
        assert_near(weights @ points**degree, expected, bound=4 * count * EPS, why="as many terms")
