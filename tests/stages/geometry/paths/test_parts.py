"""Parts of closed paths: nothing is lost, places and distances are inverse, a path begun elsewhere is the same."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stages.geometry.paths.arcpath import ArcPath, area, length
from stages.geometry.paths.parts import begun, direction_at, part, place_at, points_at, settled
from tests.near import assert_near

LENS = ArcPath(
    np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 8.0], [0.0, 8.0]]), np.array([0.2, 0.0, -0.1, 0.0]), closed=True
)
ROUNDING = 1e-12
"""Lengths of 40 mm, some ten operations."""

places = st.floats(0.0, 3.999)


@given(places, st.floats(0.01, 3.9))
def test_two_parts_make_up_the_path(leave: float, on: float) -> None:
    total = length(part(LENS, leave, leave + on)) + length(part(LENS, leave + on, leave + 4.0))
    assert_near(total, length(LENS), bound=ROUNDING, why="nothing is lost")


@given(st.floats(0.0, 100.0))
def test_a_place_is_as_far_along_as_the_part_before_it_is_long(distance: float) -> None:
    place = place_at(LENS, distance)
    rounds, rest = divmod(place, 4.0)
    long = length(part(LENS, 0.0, rest)) if rest > 0.0 else 0.0
    assert_near(rounds * length(LENS) + long, distance, bound=1e-11, why="up to three rounds")


@given(places)
def test_begun_elsewhere_a_path_encloses_the_same(place: float) -> None:
    found = begun(LENS, float(settled(LENS, np.array([place]), 0.05)[0]))
    assert_near([area(found), length(found)], [area(LENS), length(LENS)], bound=1e-11, why="rounding at 80 mm2")


def test_a_place_beside_a_vertex_is_the_vertex() -> None:
    assert settled(LENS, np.array([1.001, 1.999, 1.5]), 0.05).tolist() == [1.0, 2.0, 1.5]
    assert begun(LENS, 2.0).vertices[0].tolist() == [10.0, 8.0]


@pytest.mark.parametrize("place", [0.0, 0.3, 1.0, 2.75])
def test_the_direction_is_that_of_a_short_step(place: float) -> None:
    step = np.diff(points_at(LENS, np.array([place, place + 1e-6])), axis=0)[0]
    along = np.array([np.cos(direction_at(LENS, place)), np.sin(direction_at(LENS, place))])
    assert_near(step / np.hypot(*step), along, bound=1e-6, why="half a step's turn")
