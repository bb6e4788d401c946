"""Chains of legs and bends: places by closed forms, fits, and radii as people give them."""

from itertools import pairwise
from math import pi

import numpy as np
import pytest

from stages.geometry.arrays import Array, Numbers
from stages.geometry.mesh.profilechain import Chain, Fitted, Leg, fitted, rounded
from tests.bentmeshes import Bend, Flat, Legs, lifted, run_length
from tests.near import assert_near

PROFILES: dict[str, Legs] = {
    "channel": (Flat(40.0), Bend(3.0, 90.0), Flat(60.0), Bend(5.0, -70.0), Flat(20.0)),
    "hem": (Flat(30.0), Bend(2.0, 180.0), Flat(25.0)),
    "curl": (Flat(30.0), Bend(6.0, -270.0)),
    "folds": (Flat(30.0), Flat(20.0, 50.0), Bend(4.0, 30.0), Flat(10.0)),
}


def chain_of(legs: Legs) -> Chain:
    """Return the chain of a profile that begins at the origin along x."""
    made = [
        Leg(leg.length, float(np.radians(leg.angle_deg)))
        if isinstance(leg, Bend)
        else Leg(leg.length, 0.0, float(np.radians(leg.fold_deg)), leg.fold_deg != 0.0)
        for leg in legs
    ]
    return Chain(np.zeros(2), 0.0, tuple(made))


def seen(legs: Legs, count: int = 40) -> tuple[Array, Array, Numbers]:
    """Return flat places on every leg, away from its ends, their points in space, and their legs."""
    ends = np.cumsum([0.0, *(leg.length for leg in legs)])
    share = np.linspace(0.01, 0.99, count)
    s = np.concatenate([a + share * (b - a) for a, b in pairwise(ends.tolist())])
    flat = np.column_stack([100.0 * np.random.default_rng(0).random(s.size), s])
    return flat, lifted(legs, flat), np.repeat(np.arange(len(legs)), count)


@pytest.mark.parametrize("legs", PROFILES.values(), ids=PROFILES)
def test_places_along_and_beside_a_chain_are_those_that_points_were_made_from(legs: Legs) -> None:
    flat, _, leg_of = seen(legs)
    beside = lifted(legs, flat, 0.7)[:, :2]
    along, left = chain_of(legs).places(beside, leg_of)
    assert_near(along, flat[:, 1], bound=1e-12, why="closed forms of both, some 10 roundings of 100 mm")
    assert_near(left, np.full(left.size, 0.7), bound=1e-12, why="as above")


def test_distances_are_those_of_the_nearest_leg() -> None:
    legs = PROFILES["channel"]
    flat, _, _ = seen(legs)
    found = chain_of(legs).distances(lifted(legs, flat, -1.5)[:, :2])
    assert_near(found, np.full(found.size, -1.5), bound=1e-12, why="parallel curves")


def shapes(chain: Chain) -> list[tuple[float, float]]:
    """Return radii, 0 of straight legs, and folds."""
    return [(leg.radius_mm if leg.turn_rad else 0.0, leg.fold_rad) for leg in chain.legs]


def test_a_chain_ends_where_its_legs_lead() -> None:
    chain = Chain(np.zeros(2), 0.0, (Leg(10.0), Leg(3.0 * pi / 2.0, pi / 2.0), Leg(20.0)))
    assert_near(chain.begins()[-1], [13.0, 23.0, pi / 2.0, 30.0 + 1.5 * pi], bound=1e-14, why="closed form")


@pytest.mark.parametrize("legs", PROFILES.values(), ids=PROFILES)
def test_a_fit_finds_all_numbers_and_the_tilt(legs: Legs) -> None:
    flat, points, leg_of = seen(legs)
    # the outermost points are the ends of the chain that is found
    exact = chain_of(legs)
    source = np.random.default_rng(1)
    off = [
        Leg(leg.length_mm * (1.0 + 0.002 * source.normal()), leg.turn_rad, leg.fold_rad, leg.folded)
        for leg in exact.legs
    ]
    tilt = 1e-3
    frame = np.array([[np.cos(tilt), 0.0, np.sin(tilt)], [0.0, 1.0, 0.0], [-np.sin(tilt), 0.0, np.cos(tilt)]])
    found = fitted(points, leg_of, Fitted(Chain(np.array([0.01, 0.02]), 0.003, tuple(off)), frame))
    along, left = found.chain.places(points @ found.frame[:2].T, leg_of)
    assert_near(left, np.zeros(left.size), bound=1e-10, why="slopes by differences: the last step leaves 1e-11 of 100")
    assert_near(along - along.min(), flat[:, 1] - flat[:, 1].min(), bound=1e-8, why="as above, by bends of 30 deg")
    assert_near(shapes(found.chain), shapes(exact), bound=1e-8, why="as above")
    assert abs(float(found.frame[2] @ [0.0, 0.0, 1.0])) > 1.0 - 1e-12
    assert run_length(legs) - along.max() + along.min() > 0.0


@pytest.mark.parametrize(
    ("radius", "near", "wanted"),
    [
        (2.99996, 2e-4, 3.0),
        (1.58751, 2e-6, None),
        (1.5875001, 2e-6, 1.5875),
        (3.14159, 2e-4, None),
        (2.5, 1e-12, 2.5),
        (0.3, 1.0, None),
    ],
)
def test_only_radii_of_few_decimals_are_held(radius: float, near: float, wanted: float | None) -> None:
    chain = rounded(Chain(np.zeros(2), 0.0, (Leg(9.0), Leg(radius, 1.0))), near)
    assert not chain.legs[0].held
    assert chain.legs[1].held == (wanted is not None)
    assert_near(chain.legs[1].radius_mm, radius if wanted is None else wanted, bound=1e-15, why="one division")
