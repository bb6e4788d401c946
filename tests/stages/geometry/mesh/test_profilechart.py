"""Flat strips of chains: places and rates in u and v, and edges cut where patches meet."""

from itertools import pairwise

import numpy as np

from stages.geometry.curves.plane import Segment
from stages.geometry.mesh.chart import Pulled
from stages.geometry.mesh.profilechart import ChainChart, pulled
from tests.near import assert_near

CHART = ChainChart(np.array([0.0, 50.0]), np.array([0.0, 40.0, 45.0, 60.0]), np.array([0.0, 0.7, 0.0]))


def test_knots_are_whole_numbers_and_middles_are_halves() -> None:
    y = np.array([0.0, 20.0, 40.0, 42.5, 45.0, 52.5, 60.0])
    found = CHART.places(np.column_stack([np.full(y.size, 10.0), y]))
    assert_near(found[:, 1], [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0], bound=1e-15, why="closed form")
    assert_near(found[:, 0], np.full(y.size, 0.2), bound=1e-15, why="10 of 50 mm")


def test_on_a_bend_v_is_the_tangent_of_half_the_angle() -> None:
    ((_, v),) = CHART.places(np.array([[0.0, 43.5]]))
    assert_near(v, 1.5 + 0.5 * np.tan(0.7 * 0.4 / 2.0) / np.tan(0.35), bound=1e-15, why="40 % of half the bend")


def test_rates_are_the_slopes_of_places() -> None:
    source = np.random.default_rng(0)
    points = np.column_stack([50.0 * source.random(50), 0.1 + 59.8 * source.random(50)])
    slopes, step = source.normal(size=(50, 2)), 1e-5
    measured = (CHART.places(points + step * slopes) - CHART.places(points - step * slopes)) / (2.0 * step)
    assert_near(CHART.rates(points, slopes), measured, bound=1e-8, why="central differences: rounding / step")


def test_straight_edges_are_cut_at_knots_and_meet() -> None:
    edges = (Segment(np.array([0.0, 0.0]), np.array([50.0, 60.0])), Segment(np.array([50.0, 60.0]), np.zeros(2)))
    made = pulled(CHART, edges)
    assert [type(edge) for edge in made] == [Segment, Pulled, Segment, Segment, Pulled, Segment]
    ends = [edge.at(np.array([0.0, 1.0])) for edge in made]
    assert all(np.abs(a[1] - b[0]).max() <= 1e-14 for a, b in pairwise([*ends, ends[0]]))


def test_edges_across_and_along_rulings_stay_straight() -> None:
    across = Segment(np.array([10.0, 60.0]), np.array([10.0, 0.0]))
    along = Segment(np.array([10.0, 43.0]), np.array([30.0, 43.0]))
    assert all(isinstance(edge, Segment) for edge in pulled(CHART, (across, along)))
    assert len(pulled(CHART, (across, along))) == len(CHART.halves) + 1
