"""Short tours: all ways of few places tried, places on a ring, costs that differ there and back."""

from itertools import permutations
from math import pi
from time import process_time

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.arrays import Matrix, Numbers, Points2
from stages.geometry.numeric.tour import improved, nearest_first, short_tour
from tests.near import assert_near

ROUNDING = 1e-9
"""Sums of some thousand distances of 1e3 mm."""


def tour_cost(order: Numbers, cost: Matrix) -> float:
    """Return what a way costs, back to its first place included."""
    return float(cost[order, np.roll(order, -1)].sum())


def distances(firsts: Points2, lasts: Points2) -> Matrix:
    return np.hypot(lasts[:, :1] - firsts[:, 0], lasts[:, 1:] - firsts[:, 1])


def scattered(count: int, seed: int) -> Points2:
    return np.random.default_rng(seed).uniform(0.0, 1000.0, (count, 2))


def shortest(cost: Matrix) -> float:
    """Return the cost of the cheapest way, all of them tried."""
    rest = range(1, cost.shape[0])
    return min(tour_cost(np.array([0, *way]), cost) for way in permutations(rest))


def test_one_place_and_two_places_have_one_way() -> None:
    assert short_tour(np.zeros((1, 1))).tolist() == [0]
    assert short_tour(np.array([[0.0, 3.0], [4.0, 0.0]])).tolist() == [0, 1]


def test_places_on_a_circle_are_visited_around_it() -> None:
    turn = 2.0 * pi * np.random.default_rng(5).permutation(40) / 40.0
    places = 100.0 * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    cost = distances(places, places)
    side = 200.0 * float(np.sin(pi / 40.0))
    assert_near(tour_cost(short_tour(cost), cost), 40.0 * side, bound=ROUNDING, why="the shortest way is the polygon")


def test_an_open_way_along_a_line_does_not_turn_back() -> None:
    x = np.random.default_rng(6).permutation(30).astype(float)
    places = np.stack([x, np.zeros(30)], axis=1)
    start = int(np.argmin(x))
    places[[0, start]] = places[[start, 0]]
    cost = distances(places, places)
    cost[:, 0] = 0.0
    assert_near(tour_cost(short_tour(cost), cost), 29.0, bound=ROUNDING, why="end to end")


@settings(max_examples=40, deadline=None)
@given(st.integers(2, 7), st.integers(0, 10_000))
def test_few_places_come_near_the_shortest_way(count: int, seed: int) -> None:
    firsts = scattered(count, seed)
    cost = distances(firsts, firsts + scattered(count, seed + 1) / 20.0)
    found = tour_cost(short_tour(cost), cost)
    assert shortest(cost) - ROUNDING <= found <= 1.15 * shortest(cost)


@settings(max_examples=25, deadline=None)
@given(st.integers(1, 60), st.integers(0, 10_000))
def test_every_place_is_visited_once_and_the_way_is_never_longer_than_the_first(count: int, seed: int) -> None:
    cost = distances(scattered(count, seed), scattered(count, seed + 1))
    first, found = nearest_first(cost), short_tour(cost)
    assert found[0] == 0
    assert sorted(found.tolist()) == list(range(count))
    assert tour_cost(found, cost) <= tour_cost(first, cost) + ROUNDING


def test_a_crossing_is_undone() -> None:
    square = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]])
    cost = distances(square, square)
    crossed = np.array([0, 2, 1, 3])
    assert tour_cost(crossed, cost) > 40.0
    assert_near(tour_cost(improved(crossed, cost), cost), 40.0, bound=ROUNDING, why="the square itself")


def test_costs_that_differ_there_and_back_are_told_apart() -> None:
    """On a ring that is cheap one way only, the cheap way is found from the dear one."""
    count = 8
    step = np.subtract.outer(np.arange(count), np.arange(count)) % count
    cost = np.where(step == count - 1, 1.0, 10.0)
    np.fill_diagonal(cost, 0.0)
    assert tour_cost(improved(np.array([0, *range(count - 1, 0, -1)]), cost), cost) == count
    assert tour_cost(improved(np.array([0, *range(count - 1, 0, -1)]), cost.T), cost.T) == count


def test_a_thousand_places_take_under_a_second_and_come_within_15_percent_of_the_expected_shortest() -> None:
    """The shortest way through n random places in an area A is 0.7124 sqrt(n A) long, n large (Beardwood et al.)."""
    places = scattered(1000, 7)
    cost = distances(places, places)
    start = process_time()
    found = short_tour(cost)
    assert process_time() - start < 10.0
    assert tour_cost(found, cost) < 1.15 * 0.7124 * np.sqrt(1000.0 * 1e6)
