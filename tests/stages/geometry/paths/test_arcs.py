"""Lines and arcs in arrays of any shape: what is known of them in closed form, in a stack as in a row."""

from math import pi, sqrt

import numpy as np
import pytest

from stages.geometry.paths import arcs
from tests.near import assert_near

EXACT = 1e-14
BULGES = np.array([[0.0, sqrt(2.0) - 1.0], [1.0, 1e-16]])
"""A line, a quarter of a circle, a half, and what is a line in all but name: each on a chord of length 2."""

START, END = np.zeros((2, 2, 2)), np.broadcast_to([2.0, 0.0], (2, 2, 2))
RADII = [[np.inf, sqrt(2.0)], [1.0, np.inf]]


def test_sweeps_and_radii_follow_from_bulges() -> None:
    assert_near(arcs.sweeps(BULGES), [[0.0, pi / 2.0], [pi, 0.0]], bound=EXACT, why="four times the arc tangent")
    found = arcs.radii(START, END, arcs.bends(BULGES))
    assert np.isinf(found).tolist() == np.isinf(RADII).tolist()
    assert_near(1.0 / found, 1.0 / np.array(RADII), bound=EXACT, why="half the chord over the sine of half the sweep")
    assert_near(arcs.curvatures(START, END, arcs.bends(BULGES)), 1.0 / found, bound=EXACT, why="one over the radius")


def test_lengths_and_areas_are_those_of_circles() -> None:
    sweep = arcs.sweeps(BULGES)
    assert_near(arcs.lengths(START, END, sweep), [[2.0, pi / sqrt(2.0)], [pi, 2.0]], bound=EXACT, why="radius x sweep")
    found = arcs.areas(START, END, sweep, np.zeros(2))
    assert_near(found, [[0.0, pi / 2.0 - 1.0], [pi / 2.0, 0.0]], bound=EXACT, why="sectors less triangles")


@pytest.mark.parametrize("share", [0.0, 0.25, 1.0])
def test_points_lie_where_the_share_of_the_sweep_says(share: float) -> None:
    found = arcs.between(START, END, arcs.sweeps(BULGES), np.full((2, 2), share))
    angle = -pi + pi * share
    assert_near(found[1, 0], [1.0 + np.cos(angle), np.sin(angle)], bound=EXACT, why="a half circle, from the left on")
    assert_near(found[0, 0], [2.0 * share, 0.0], bound=EXACT, why="a line")


def test_a_half_circle_is_furthest_out_below() -> None:
    piece, points = arcs.furthest(START[1], END[1], arcs.sweeps(BULGES[1]))
    lowest = int(points[:, 1].argmin())
    assert piece[lowest] == 0
    assert_near(points[lowest], [1.0, -1.0], bound=EXACT, why="below its middle, counter-clockwise from the left")
    assert 1 not in piece.tolist(), "a line is nowhere further out than at its ends"


def test_a_stack_is_as_its_rows() -> None:
    random = np.random.default_rng(3)
    start, end, about = random.normal(size=(3, 4, 5, 2))
    sweep, share = arcs.sweeps(random.normal(size=(4, 5))), random.uniform(size=(4, 5))
    for k in range(4):
        rows = (
            (arcs.areas(start, end, sweep, about)[k], arcs.areas(start[k], end[k], sweep[k], about[k])),
            (arcs.between(start, end, sweep, share)[k], arcs.between(start[k], end[k], sweep[k], share[k])),
            (arcs.directions(start, end, sweep)[1][k], arcs.directions(start[k], end[k], sweep[k])[1]),
        )
        for one, other in rows:
            assert one.tolist() == other.tolist()
