"""Spectral elements: exact on polynomials, and what goes in comes out."""

import numpy as np
import pytest
from numpy.polynomial import legendre

from stages.geometry.numeric import elements
from stages.geometry.numeric.elements import Degrees, coefficients, evaluate, lobatto, node_places, rule, sampling
from tests.near import assert_near

DEGREES = Degrees(5, 7)


@pytest.mark.parametrize("degree", [2, 3, 6, 14, 24])
def test_the_nodes_are_both_ends_and_the_extrema_of_the_legendre_polynomial(degree: int) -> None:
    nodes = lobatto(degree)
    assert nodes[[0, -1]].tolist() == [-1.0, 1.0]
    assert (np.diff(nodes) > 0.0).all()
    slope = legendre.legval(nodes[1:-1], legendre.legder(np.eye(degree + 1)[degree]))
    # P'' is below n^4 / 8 in [-1, 1], and a node is off by some roundings
    assert_near(slope, 0.0 * slope, bound=degree**4 * 1e-15, why="a node off by 4e-15 times P''")


def test_four_nodes_are_known() -> None:
    assert_near(lobatto(3), [-1.0, -(0.2**0.5), 0.2**0.5, 1.0], bound=1e-15, why="closed form")


@pytest.mark.parametrize("degree", [3, 8, 24])
def test_values_and_derivatives_of_polynomials_are_exact(degree: int) -> None:
    x = np.linspace(-1.0, 1.0, 9)
    values, slopes = sampling(degree, x)
    for power in (0, 1, degree - 1, degree):
        at_nodes = lobatto(degree) ** power
        assert_near(values @ at_nodes, x**power, bound=1e-13, why="some roundings of sums of 25")
        expected = power * x ** max(power - 1, 0)
        assert_near(slopes @ at_nodes, expected, bound=1e-15 * degree**4, why="roundings times degree^2, twice")


def test_gauss_points_integrate_and_differentiate_products_exactly() -> None:
    points = rule(DEGREES)
    _, u = node_places(np.array([0.0, 1.0]), DEGREES)
    v = (lobatto(DEGREES.v) + 1.0) / 2.0
    at_nodes = (v[:, None] ** 7 * u**5).ravel()
    by_u, by_v = points.by_u @ at_nodes, points.by_v @ at_nodes
    assert_near(by_u, points.v**7 * 5.0 * points.u**4, bound=1e-12, why="roundings times 7^2, twice")
    assert_near(by_v, 7.0 * points.v**6 * points.u**5, bound=1e-12, why="roundings times 7^2, twice")
    assert_near(points.weights @ by_u**2, 25.0 / 9.0 / 15.0, bound=1e-13, why="25 int u^8 int v^14")


def test_series_give_back_the_values_they_were_made_from() -> None:
    source = np.random.default_rng(3)
    values = source.uniform(-1.0, 1.0, (2, DEGREES.v + 1, DEGREES.u + 1, 2))
    series = coefficients(values, DEGREES)
    x, y = (axis.ravel() for axis in np.meshgrid(lobatto(DEGREES.u), lobatto(DEGREES.v)))
    for element in range(2):
        found = evaluate(series[element], x, y)
        assert_near(found, values[element].reshape(-1, 2), bound=1e-13, why="some roundings of sums of 48")


def test_neighbours_share_a_column_of_nodes_exactly() -> None:
    columns, u = node_places(np.array([0.0, 0.3, 1.0]), DEGREES)
    assert columns[0, -1] == columns[1, 0] == np.float64(0.3)
    assert (columns[0, 0], columns[1, -1], u[0], u[-1]) == (0.0, 1.0, 0.0, 1.0)


def test_a_wrong_derivative_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    honest = elements.sampling

    def wrong(degree: int, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        values, slopes = honest(degree, x)
        return values, slopes * (1.0 + 1e-9)

    monkeypatch.setattr(elements, "sampling", wrong)
    elements.rule.cache_clear()
    with pytest.raises(AssertionError):
        test_gauss_points_integrate_and_differentiate_products_exactly()
    elements.rule.cache_clear()
