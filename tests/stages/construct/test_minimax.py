"""Theorem 2.3's minimax: the paper's example to 9 digits, optimality, and what it says when it cannot."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.construct import minimax
from stages.construct.minimax import GAP, largest_speed, solve, stationary
from stages.construct.quintic import End, cone_ends, directrix, vector
from stages.errors import NoSolutionError
from stages.geometry.curves.curves import bezier
from stages.model.part import QuinticCone
from tests.near import assert_near, assert_relative
from tests.parts import EXAMPLE_3, part
from tests.strategies import different_points

SPEED = 0.698368026963404
SHAPE = (0.698376854503, 0.696927489190, 0.153883463986, 0.079577797997)
PLACES = (0.0, 0.357990710982, 0.847586111683)
"""The minimax at 30 digits: its value, its parameters, and the three places where the speed reaches it."""


def ends() -> tuple[End, End]:
    spec = part(EXAMPLE_3).spec.surface
    assert isinstance(spec, QuinticCone)
    return cone_ends(spec, (Fraction(0),) * 4, normalise=False)


@pytest.mark.parametrize("guess", [None, (0.5, 0.5, 0.1, 0.1), (0.1, 0.1, 1.0, 1.0), (3.0, 0.2, 0.01, 2.0)])
def test_example_3_reaches_the_true_minimax_from_any_guess(guess: tuple[float, ...] | None) -> None:
    found = solve(*ends(), guess)
    assert found.speed_max <= SPEED + 1e-9
    assert found.speed_max >= SPEED - 1e-12, "below the minimum: the inner maximum missed a peak"
    assert_near(found.shape, SHAPE, bound=1e-4, why="the objective is flat: 1e-9 of it is 1e-4 of beta")
    assert not found.at_bound
    assert_near(found.where, PLACES, bound=1e-3, why="peaks of a flat objective")


def test_the_printed_parameters_are_worse() -> None:
    start, end = ends()
    shape = [Fraction(x) for x in ("0.6983", "0.6968", "0.1541", "0.079")]
    r = directrix(
        End(start.P, start.T, start.N, start.k, shape[0], shape[2]), End(end.P, end.T, end.N, end.k, shape[1], shape[3])
    )
    assert_near(largest_speed(r)[0], 0.698416891747, bound=1e-12, why="12 digits are given")


@pytest.fixture(scope="module")
def best() -> minimax.Minimax:
    """Return the solution of Example 3, found once."""
    return solve(*ends())


@settings(max_examples=8)
@given(seed=st.integers(0, 10**6))
def test_no_neighbour_of_the_solution_is_better(best: minimax.Minimax, seed: int) -> None:
    start, end = ends()
    random = np.random.default_rng(seed)
    for step in (1e-2, 1e-4):
        shape = np.array(best.shape) * (1.0 + step * random.normal(size=4))
        a0, a1, b0, b1 = (Fraction(float(x)) for x in shape)
        other = directrix(End(start.P, start.T, start.N, start.k, a0, b0), End(end.P, end.T, end.N, end.k, a1, b1))
        assert largest_speed(other)[0] >= best.speed_max * (1.0 - 10 * GAP)


def line(beta: str) -> tuple[End, End]:
    x = vector((Fraction(1), Fraction(0), Fraction(0)))
    zero = vector((Fraction(0),) * 3)
    far = vector((Fraction(7), Fraction(0), Fraction(0)))
    return End(zero, x, zero, Fraction(0), Fraction(0), Fraction(beta)), End(
        far, x, zero, Fraction(0), Fraction(0), Fraction(0)
    )


def test_a_straight_directrix_gets_even_speed_and_says_that_beta_is_at_its_bound() -> None:
    """r' = P1 - P0 everywhere: alpha = 7, beta = 0, and beta must stay above 0."""
    found = solve(*line("0"))
    assert found.at_bound
    assert_relative(found.shape[:2], [7.0, 7.0], bound=1e-4, why="beta at 1e-4 of the chord moves alpha as much")
    assert 7.0 <= found.speed_max <= 7.0 * (1.0 + 1e-4)


def test_an_exchange_that_does_not_close_is_no_solution(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(minimax, "EXCHANGES", 1)
    with pytest.raises(NoSolutionError, match=r"Theorem 2\.3"):
        solve(*ends())


@pytest.mark.parametrize("steps", [1, 2, 3])
def test_a_minimiser_that_stops_early_is_found_out(steps: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """After so few steps t is the true maximum already, but not the smallest one."""
    monkeypatch.setattr(minimax, "SLSQP", {"ftol": 1e-15, "maxiter": steps})
    monkeypatch.setattr(minimax, "GAP", 1.0)
    with pytest.raises(NoSolutionError, match="minimum of the largest speed"):
        solve(*ends())


@settings(max_examples=30)
@given(different_points(6))
def test_the_largest_speed_of_a_quintic_is_not_below_any_sample(rows: list[tuple[Fraction, ...]]) -> None:
    curve = bezier(rows)
    speed, place = largest_speed(curve)
    samples = np.linalg.norm(curve.jet(np.linspace(0.0, 1.0, 2001), 1)[1], axis=1)
    assert speed >= samples.max() * (1.0 - 1e-12)
    here = np.linalg.norm(curve.jet(np.array([place]), 1)[1])
    assert_relative([here], [speed], bound=1e-12, why="the value at its own place")


def test_all_stationary_points_of_a_polynomial_are_found() -> None:
    roots = np.array([0.1, 0.35, 0.5, 0.77])
    slope = np.polynomial.Polynomial.fromroots(roots)
    found = stationary(slope.integ(), degree=5)
    assert_near(found, [0.0, *roots, 1.0], bound=1e-10, why="roots of a well-conditioned quartic")
