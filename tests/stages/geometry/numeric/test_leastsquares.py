"""Least squares with stated uncertainties: closed forms, coverage, ranks, gross errors by name."""

import numpy as np
import pytest

from stages.geometry.numeric.leastsquares import UndefinedError, fitted, snooped
from tests.near import assert_near


def line(count: int = 20) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the matrix, the values 3 - 2 x and their uncertainties, which differ."""
    x = np.linspace(0.0, 1.0, count)
    return np.stack([np.ones(count), x], axis=1), 3.0 - 2.0 * x, np.linspace(0.1, 0.3, count)


def test_a_weighted_mean_is_that_of_the_textbook() -> None:
    y, u = np.array([1.0, 2.0, 4.0]), np.array([1.0, 2.0, 0.5])
    fit = fitted(np.ones((3, 1)), y, u)
    weights = u**-2
    assert_near(fit.values, [(weights * y).sum() / weights.sum()], bound=1e-15, why="closed form")
    assert_near(fit.covariance, [[1.0 / weights.sum()]], bound=1e-15, why="closed form")


def test_exact_values_are_fitted_exactly_and_bear_out_any_uncertainty() -> None:
    fit = fitted(*line())
    assert_near(fit.values, [3.0, -2.0], bound=1e-14, why="rounding")
    assert fit.chance > 1.0 - 1e-9


def test_units_of_the_columns_do_not_change_the_rank() -> None:
    matrix, y, u = line()
    fit = fitted(matrix * np.array([1e-9, 1e9]), y, u)
    assert_near(fit.values * np.array([1e-9, 1e9]), [3.0, -2.0], bound=1e-13, why="rounding")


def test_what_the_values_do_not_tell_is_refused_with_the_rank() -> None:
    matrix, y, u = line()
    with pytest.raises(UndefinedError) as caught:
        fitted(np.stack([matrix[:, 1], 2.0 * matrix[:, 1]], axis=1), y, u)
    assert (caught.value.rank, caught.value.unknowns) == (1, 2)
    with pytest.raises(UndefinedError):
        fitted(np.zeros((3, 1)), np.ones(3), np.ones(3))


def test_intervals_cover_the_truth_as_often_as_stated() -> None:
    matrix, y, u = line()
    rng = np.random.default_rng(7)
    fits = [fitted(matrix, y + rng.normal(0.0, u), u) for _ in range(400)]
    covered = [abs(fit.values[1] + 2.0) <= 1.96 * fit.covariance[1, 1] ** 0.5 for fit in fits]
    assert 0.92 <= np.mean(covered) <= 0.98  # 0.95 +- 2.8 standard deviations of 400 draws
    assert 0.3 <= np.mean([fit.chance < 0.5 for fit in fits]) <= 0.7  # chances are evenly spread


def test_a_gross_error_is_named_and_alone_set_aside() -> None:
    matrix, y, u = line()
    noisy = y + np.random.default_rng(3).normal(0.0, u)
    assert snooped(matrix, noisy, u).aside.size == 0
    noisy[6] += 12.0 * u[6]
    found = snooped(matrix, noisy, u)
    assert found.aside.tolist() == [6]
    assert 6 not in found.kept.tolist()
    assert found.fit.chance > 1e-3


def test_two_gross_errors_are_named_one_after_the_other() -> None:
    matrix, y, u = line()
    y[[2, 15]] += [3.0, -5.0]
    assert sorted(snooped(matrix, y, u).aside.tolist()) == [2, 15]


def test_of_two_values_neither_is_accused() -> None:
    assert snooped(np.ones((2, 1)), np.array([0.0, 100.0]), np.ones(2)).aside.size == 0
