"""Series of products and powers against those of known functions."""

from math import factorial

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stages.geometry.arrays import EPS
from stages.geometry.numeric.series import derivatives, inner, outer, power, product, scaled, slope, taylor
from tests.near import assert_near, assert_relative

COUNT = 6
V = np.array([0.25, 1.0, 3.0])
EXPONENTS = (-1.0, -0.5, 0.5, 2.0)
coefficients = st.lists(st.integers(-9, 9), min_size=COUNT, max_size=COUNT)


def column(values: list[int]) -> np.ndarray:
    return np.array(values, dtype=float)[:, None]


def test_a_series_holds_derivatives_over_factorials() -> None:
    jet = np.stack([np.exp(V) for _ in range(COUNT)])
    series = taylor(jet)
    for k in range(COUNT):
        assert_relative(series[k], np.exp(V) / factorial(k), bound=2 * EPS, why="one division")
    assert_relative(derivatives(series), jet, bound=2 * EPS, why="there and back")
    assert_relative(slope(series), series[:-1], bound=2 * EPS, why="exp is its own derivative")


@pytest.mark.parametrize("exponent", EXPONENTS)
def test_powers_are_those_of_the_exponential(exponent: float) -> None:
    """exp(v)^a = exp(a v), whose k-th derivative is a^k exp(a v)."""
    raised = derivatives(power(taylor(np.stack([np.exp(V)] * COUNT)), exponent))
    for k in range(COUNT):
        assert_relative(raised[k], exponent**k * np.exp(exponent * V), bound=256 * EPS, why="a sum of k products each")


@pytest.mark.parametrize("exponent", EXPONENTS)
def test_powers_are_those_of_mpmath(exponent: float) -> None:
    """Of 2 + sin(v), whose derivatives have both signs."""
    sines = np.stack([np.sin(V + k * np.pi / 2.0) + (2.0 if k == 0 else 0.0) for k in range(COUNT)])
    raised = power(taylor(sines), exponent)
    for i, v in enumerate(V):
        wanted = mpmath.taylor(lambda x: (2 + mpmath.sin(x)) ** exponent, mpmath.mpf(v), COUNT - 1)
        assert_near(raised[:, i], [float(c) for c in wanted], bound=1e-13, why="thirty products of numbers below 10")


@given(coefficients, coefficients)
def test_products_are_those_of_polynomials(a: list[int], b: list[int]) -> None:
    wanted = np.convolve(a, b)[:COUNT]
    assert_near(product(column(a), column(b))[:, 0], wanted, bound=0.0, why="whole numbers")


def test_the_shorter_series_says_how_long_the_product_is() -> None:
    made = product(column([1, 2, 3]), column([1, 1, 1, 1, 1]))
    assert_near(made[:, 0], [1, 3, 6], bound=0.0, why="whole numbers")


def test_products_of_vectors_follow_from_their_components() -> None:
    rng = np.random.default_rng(7)
    a, b = rng.integers(-9, 9, (2, COUNT, 3, 3)).astype(float)
    parts = [product(a[..., i], b[..., i]) for i in range(3)]
    assert_near(inner(a, b), sum(parts), bound=0.0, why="whole numbers")
    x = product(a[..., 1], b[..., 2]) - product(a[..., 2], b[..., 1])
    assert_near(outer(a, b)[..., 0], x, bound=0.0, why="whole numbers")
    assert_near(scaled(a[..., 0], b)[..., 2], product(a[..., 0], b[..., 2]), bound=0.0, why="whole numbers")
