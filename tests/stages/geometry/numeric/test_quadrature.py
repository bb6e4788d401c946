"""Integrals and antiderivatives against closed forms; what cannot be resolved is refused, quickly."""

from math import e, pi

import numpy as np
import pytest
from numpy.polynomial import legendre

from stages.errors import NoSolutionError
from stages.geometry.arrays import EPS, Array, Values
from stages.geometry.numeric import quadrature
from stages.geometry.numeric.quadrature import ANTIDERIVATIVE, NODES, ORDER, coefficients, integral, panels
from tests.near import assert_near, assert_relative

INTEGRALS = {
    "exponential": (np.exp, e - 1.0),
    "constant": (lambda v: np.full_like(v, 7.0), 7.0),
    "many waves": (lambda v: 1.0 + np.sin(100.0 * v), 1.0 + (1.0 - np.cos(100.0)) / 100.0),
    "narrow bell": (lambda v: 1.0 / (1e-6 + (v - 0.3) ** 2), 1e3 * (np.arctan(700.0) + np.arctan(300.0))),
    "root at an end": (np.sqrt, 2.0 / 3.0),
    "root at the other end": (lambda v: np.sqrt(1.0 - v), 2.0 / 3.0),
    "kink": (lambda v: np.abs(v - 0.3), 0.29),
    "circle": (lambda v: np.sqrt(1.0 - v * v), pi / 4.0),
}


@pytest.mark.parametrize("name", INTEGRALS)
def test_an_integral_has_the_value_of_its_closed_form(name: str) -> None:
    function, value = INTEGRALS[name]
    found = integral(lambda v: function(v)[:, None], name)
    assert_relative(found, [value], bound=1e-13, why="a sum of some 1e3 positive terms, each good to 1e-16")


def test_each_channel_has_its_own_integral_and_one_scale_serves_all() -> None:
    found = integral(lambda v: np.stack([v, np.zeros_like(v), 1e-30 * np.sqrt(v)], axis=1), "channels")
    assert_near(found, [0.5, 0.0, 0.0], bound=4 * EPS, why="16 terms")
    breaks, values = panels(lambda v: np.stack([np.cos(v), np.zeros_like(v)], axis=1), "a channel of zeros")
    assert values.shape == (breaks.size - 1, ORDER, 2)


@pytest.mark.parametrize("degree", [0, 1, 7, 15])
def test_the_antiderivative_matrix_integrates_polynomials_from_the_left_end(degree: int) -> None:
    values = NODES**degree
    made = ANTIDERIVATIVE @ coefficients(values[None])[0]
    assert_near(legendre.legval(-1.0, made), 0.0, bound=32 * EPS, why="17 terms")
    x = np.linspace(-1.0, 1.0, 9)
    expected = (x ** (degree + 1) - (-1.0) ** (degree + 1)) / (degree + 1)
    assert_near(legendre.legval(x, made), expected, bound=64 * EPS, why="two sums of 16 terms")


def noise(v: Values) -> Array:
    return 1.0 + 1e-3 * np.sin(1e17 * v)[:, None]


UNRESOLVABLE = {
    "noise": noise,
    "a jump": lambda v: np.where(v > 0.3, 1.0, 0.0)[:, None],
    "not a number": lambda v: np.full((v.size, 1), np.nan),
    "a pole": lambda v: 1.0 / np.maximum(np.abs(v - 0.3), 1e-300)[:, None],
}


@pytest.mark.parametrize("name", UNRESOLVABLE)
def test_what_cannot_be_resolved_is_refused_with_both_numbers(name: str) -> None:
    calls = []

    def counted(v: Values) -> Array:
        calls.append(v.size)
        return UNRESOLVABLE[name](v)

    with pytest.raises(NoSolutionError, match=name) as caught:
        integral(counted, name)
    assert caught.value.wanted == quadrature.ROUNDING
    assert sum(calls) <= 300_000, "noise must not fill the memory with panels"
