"""The least value of a polynomial of two variables: known minima, random ones against a grid, and what it refuses."""

import numpy as np
import pytest

from stages.errors import NoSolutionError
from stages.geometry.numeric import leastvalue
from stages.geometry.numeric.leastvalue import least, value_at
from tests.near import assert_near

SQUARE = ((-2.0, 3.0), (-1.0, 4.0))


def polynomial(terms: dict[tuple[int, int], float]) -> np.ndarray:
    a = np.zeros((5, 5))
    for power, factor in terms.items():
        a[power] += factor
    return a


def test_the_lower_of_two_wells_is_found_wherever_a_descent_would_start() -> None:
    """(x^2 - 1)^2 + x/10 + (y - 1)^2: its wells are where 4 x^3 - 4 x + 1/10 = 0, the lower one near -1.01."""
    wells = polynomial({(4, 0): 1, (2, 0): -2, (0, 0): 2, (1, 0): 0.1, (0, 2): 1, (0, 1): -2})
    found = least(wells, SQUARE, gap=1e-9)
    x = min(root.real for root in np.roots([4.0, 0.0, -4.0, 0.1]))
    assert_near(found.place, [x, 1.0], bound=1e-12, why="Newton's method ends at rounding")
    assert found.value - 1e-9 <= found.bound <= found.value


def test_a_least_value_at_the_edge_stays_there() -> None:
    found = least(polynomial({(1, 0): 1, (0, 2): 1, (0, 1): -1}), SQUARE, gap=1e-9)
    assert found.place[0] == -2.0
    assert_near(found.place[1], 0.5, bound=1e-14, why="a parabola: one step of Newton's")


@pytest.mark.parametrize("seed", range(10))
def test_no_place_of_a_grid_is_lower_than_the_bound(seed: int) -> None:
    a = np.random.default_rng(seed).normal(size=(5, 5))
    found = least(a, SQUARE, gap=1e-6)
    x, y = (np.linspace(*side, 300) for side in SQUARE)
    grid = np.polynomial.polynomial.polygrid2d(x, y, a)
    scale = float(np.abs(a).max()) * 3.0**4 * 4.0**4
    assert grid.min() >= found.bound - 1e-13 * scale
    assert_near(found.value, value_at(a, found.place), bound=0.0, why="the value of that place")
    assert found.value - found.bound <= 1e-6 + 1e-13 * scale


def test_a_gap_that_is_not_reached_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(leastvalue, "ROUNDS", 2)
    with pytest.raises(NoSolutionError, match="two variables"):
        least(polynomial({(2, 0): 1, (0, 2): 1}), SQUARE, gap=1e-9)
