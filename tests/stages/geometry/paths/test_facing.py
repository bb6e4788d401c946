"""Facing edges: rectangles beside each other by closed forms, turned as a whole, and everything that does not count."""

from math import cos, radians, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, transform
from stages.geometry.paths.facing import Strip, facing, middles
from tests.near import assert_near

KERF_MM = 0.2
STRIP = Strip(KERF_MM, 1e-6, 20.0)
ROUNDING = 1e-9
"""Coordinates of up to 1e3 mm, turned and turned back."""


def rectangle(x: float, y: float, width: float, height: float) -> ArcPath:
    corners = np.array([[x, y], [x + width, y], [x + width, y + height], [x, y + height]])
    return ArcPath(corners, np.zeros(4), closed=True)


def pair(apart: float = KERF_MM, up: float = 0.0, turn_deg: float = 0.0) -> list[ArcPath]:
    """Return 50 x 30 and, to its right, 40 x 60, turned together."""
    paths = [rectangle(0.0, 0.0, 50.0, 30.0), rectangle(50.0 + apart, up, 40.0, 60.0)]
    return [transform(path, Rigid2(3.0, 7.0, turn_deg)) for path in paths]


@given(st.floats(-35.0, 5.0), st.floats(0.0, 360.0))
def test_the_middle_runs_over_the_overlap(up: float, turn_deg: float) -> None:
    (line,) = middles(pair(up=up, turn_deg=turn_deg), STRIP)
    low, high = max(0.0, up), min(30.0, up + 60.0)
    c, s = cos(radians(turn_deg)), sin(radians(turn_deg))
    turned = [(3.0 + c * 50.1 - s * y, 7.0 + s * 50.1 + c * y) for y in (low, high)]
    assert_near(sorted(line.ends.tolist()), sorted(map(list, turned)), bound=ROUNDING, why="closed form")
    assert_near(line.length_mm, high - low, bound=ROUNDING, why="closed form")
    assert {(edge.path, edge.piece) for edge in line.edges} == {(0, 1), (1, 3)}


@pytest.mark.parametrize(
    "paths",
    [
        pair(apart=KERF_MM + 1e-5),
        pair(apart=0.0),
        pair(up=10.5),
        pair(up=31.0),
        [rectangle(0.0, 0.0, 50.0, 30.0)],
        [rectangle(0.0, 0.0, 19.9, 19.9), rectangle(20.1, 0.0, 19.9, 19.9)],
        [rectangle(0.0, 0.0, 50.0, 30.0), transform(rectangle(50.2, 0.0, 40.0, 60.0), Rigid2(angle_deg=0.1))],
        [],
    ],
    ids=["farther", "touching", "overlap 19.5", "beyond", "alone", "short edges", "askew", "nothing"],
)
def test_what_is_no_strip_is_not_found(paths: list[ArcPath]) -> None:
    assert middles(paths, STRIP) == []


def test_arcs_are_not_looked_at() -> None:
    disc = ArcPath(np.array([[-25.1, 0.0], [24.9, 0.0]]), np.ones(2), closed=True)
    assert middles([disc, rectangle(25.1, -30.0, 40.0, 60.0)], STRIP) == []


def test_edges_that_look_the_same_way_do_not_face_each_other() -> None:
    """A rectangle a kerf within another one, both counter-clockwise."""
    inner = rectangle(KERF_MM, KERF_MM, 100.0 - 2.0 * KERF_MM, 100.0 - 2.0 * KERF_MM)
    assert middles([rectangle(0.0, 0.0, 100.0, 100.0), inner], STRIP) == []


def test_middles_that_continue_each_other_are_one_line() -> None:
    """Two rectangles side by side on a third: one line along it, one between the two."""
    paths = [
        rectangle(0.0, 0.0, 100.2, 30.0),
        rectangle(0.0, 30.2, 50.0, 40.0),
        rectangle(50.2, 30.2, 50.0, 40.0),
    ]
    along, between = sorted(middles(paths, STRIP), key=lambda line: -line.length_mm)
    assert_near(along.ends, [[0.0, 30.1], [100.2, 30.1]], bound=ROUNDING, why="closed form")
    assert_near(between.ends, [[50.1, 30.2], [50.1, 70.2]], bound=ROUNDING, why="closed form")
    assert {edge.path for edge in along.edges} == {0, 1, 2}


@pytest.mark.parametrize("over", [3.0, 0.5])
def test_a_short_overlap_counts_where_it_continues_a_long_one(over: float) -> None:
    """The upper rectangle reaches a little beyond the first of two below."""
    below = [rectangle(0.0, 0.0, 50.0, 30.0), rectangle(50.2, 0.0, 50.0, 30.0)]
    above = rectangle(0.0, 30.2, 50.2 + over, 40.0)
    along = max(middles([*below, above], STRIP), key=lambda line: line.length_mm)
    assert_near(along.ends, [[0.0, 30.1], [50.2 + over, 30.1]], bound=ROUNDING, why="closed form")
    assert {edge.path for edge in along.edges} == {0, 1, 2}
    assert middles([below[1], above], STRIP) == []


def test_lines_farther_apart_than_the_strip_is_wide_stay_two() -> None:
    paths = [
        rectangle(0.0, 0.0, 102.0, 30.0),
        rectangle(0.0, 30.2, 50.0, 40.0),
        rectangle(52.0, 30.2, 50.0, 40.0),
    ]
    assert sorted(line.length_mm for line in middles(paths, STRIP)) == pytest.approx([50.0, 50.0])


def test_facing_tells_how_far_and_which_way() -> None:
    found = facing(pair(apart=3.0, turn_deg=90.0), Strip(5.0, 1e-6, 20.0))
    assert_near(found.apart, [3.0], bound=ROUNDING, why="as built")
    assert_near(found.outward, [[0.0, 1.0]], bound=ROUNDING, why="to the right, turned by 90 deg")
    assert facing(pair(apart=3.0), Strip(2.9, 1e-6, 20.0)).apart.size == 0
