"""Points of profiles divided into legs: what is a bend, a fold, or neither."""

from collections.abc import Sequence

import numpy as np
import pytest

from stages.geometry.arrays import Array
from stages.geometry.mesh.profilelegs import Stretch, chain_of, stations, stretches
from tests.bentmeshes import Bend, Flat, Legs, lifted, rulings
from tests.near import assert_near

NEAR = 1e-6


def points(legs: Legs, step: float) -> Array:
    """Return the corners of a profile, its bends in facets."""
    places = np.array(rulings(legs, step))
    return lifted(legs, np.column_stack([np.zeros(places.size), places]))[:, :2]


def kinds(found: Sequence[Stretch] | None) -> str | None:
    """Return a letter for each leg."""
    return None if found is None else "".join("b" if leg.radius else "f" for leg in found)


@pytest.mark.parametrize(
    ("legs", "step", "wanted"),
    [
        ((Flat(40.0), Bend(3.0, 90.0), Flat(60.0)), 30.0, "fbf"),
        ((Flat(40.0), Bend(3.0, 20.0), Flat(60.0)), 10.0, "fbf"),
        ((Flat(40.0), Bend(3.0, 20.0), Flat(60.0)), 20.0, "fff"),
        ((Bend(3.0, 90.0), Flat(60.0)), 30.0, "bf"),
        ((Bend(3.0, 60.0), Flat(60.0)), 30.0, "fff"),
        ((Flat(40.0), Bend(3.0, 90.0), Bend(8.0, -90.0), Flat(4.0)), 22.5, "fbbf"),
        ((Flat(40.0), Bend(3.0, 90.0), Bend(8.0, 90.0), Flat(4.0)), 22.5, None),
        ((Flat(40.0), Flat(10.0, 90.0), Flat(5.0, -10.0)), 30.0, "fff"),
        ((Flat(10.0), Flat(9.0, 30.0), Flat(11.0, 30.0), Flat(10.0, 30.0)), 30.0, None),
        ((Flat(10.0), Flat(9.0, 60.0), Flat(11.0, 60.0), Flat(10.0, 60.0)), 30.0, "ffff"),
        ((Flat(10.0), Flat(9.0, 30.0), Flat(11.0, -30.0), Flat(10.0, -30.0), Flat(7.0, 30.0)), 30.0, "fffff"),
    ],
)
def test_profiles_are_divided_into_their_legs(legs: Legs, step: float, wanted: str | None) -> None:
    # a row of three small turns the same way may be a curve; two of them, turns of 60 deg, and to and fro, are folds
    assert kinds(stretches(points(legs, step), NEAR)) == wanted


@pytest.mark.parametrize("count", [6, 18, 60])
def test_part_of_an_ellipse_between_flanges_is_neither(count: int) -> None:
    t = np.linspace(0.0, np.pi / 2.0, count + 1)
    bend = np.column_stack([3.6 * np.sin(t), 3.0 - 3.0 * np.cos(t)])
    assert stretches(np.vstack([[-40.0, 0.0], bend, [3.6, 60.0]]), NEAR) is None


def test_a_bend_that_ends_with_a_kink_is_none() -> None:
    whole = points((Flat(40.0), Bend(3.0, 90.0)), 15.0)
    assert kinds(stretches(np.vstack([whole, whole[-1] + [0.0, 30.0]]), NEAR)) == "fbf"
    assert stretches(np.vstack([whole, whole[-1] + [3.0, 30.0]]), NEAR) is None


def test_the_first_chain_has_the_numbers_of_the_points() -> None:
    legs = (Flat(40.0), Bend(3.0, 90.0), Flat(60.0), Flat(10.0, -40.0))
    corners = points(legs, 15.0)
    found = stretches(corners, NEAR)
    assert found is not None
    chain = chain_of(corners, found)
    assert_near([leg.length_mm for leg in chain.legs], [leg.length for leg in legs], bound=1e-12, why="exact points")
    assert_near(chain.begins()[-1, :2], corners[-1], bound=1e-12, why="the chain ends at the last point")


def test_points_within_rounding_are_put_together() -> None:
    every = np.array([[0.0, 0.0], [1e-7, 0.0], [5.0, 0.0], [5.0, -1e-7], [9.0, 0.0]])
    together, label = stations(every, NEAR)
    assert label.tolist() == [0, 0, 1, 1, 2]
    assert_near(together, [[5e-8, 0.0], [5.0, -5e-8], [9.0, 0.0]], bound=1e-15, why="means")
