"""Motions between edges: they keep lengths, follow each other, and move flat maps as they move points."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from stages.geometry.arrays import EPS, norm
from stages.geometry.curves.curves import bezier, exactly
from stages.geometry.flat.development import develop
from stages.geometry.flat.placing import STILL, Motion, after, moved, onto
from stages.geometry.ruled.ruled import between
from tests.near import assert_near

NUMBERS = st.floats(-100.0, 100.0)
POINTS = np.array([[0.0, 0.0], [30.0, 10.0], [-5.0, 70.0], [1e-3, -40.0]])


@st.composite
def motions(draw: st.DrawFn) -> Motion:
    angle = draw(st.floats(-4.0, 4.0))
    return Motion(float(np.cos(angle)), float(np.sin(angle)), np.array([draw(NUMBERS), draw(NUMBERS)]))


@given(motions())
def test_distances_are_kept(motion: Motion) -> None:
    before, after_ = (norm(p[:, None] - p[None]) for p in (POINTS, motion.points(POINTS)))
    assert_near(after_, before, bound=64 * EPS * 200.0, why="rounding of turned points")


@given(motions(), motions())
def test_one_motion_after_another_is_their_composition(first: Motion, second: Motion) -> None:
    both = second.points(first.points(POINTS))
    assert_near(after(second, first).points(POINTS), both, bound=64 * EPS * 500.0, why="rounding")
    assert_near(after(STILL, first).points(POINTS), first.points(POINTS), bound=0.0, why="nothing added")


@given(motions())
def test_an_edge_is_laid_on_its_image(motion: Motion) -> None:
    ends = POINTS[1:3]
    found = onto(ends, motion.points(ends))
    assert_near(found.points(POINTS), motion.points(POINTS), bound=1e-12, why="an edge of 69 mm, digits of 1e-14")


def test_an_edge_of_another_length_is_laid_middle_on_middle() -> None:
    found = onto(np.array([[0.0, 0.0], [10.0, 0.0]]), np.array([[5.0, 5.0], [5.0, 17.0]]))
    assert_near(
        found.points(np.array([[0.0, 0.0], [10.0, 0.0]])), [[5.0, 6.0], [5.0, 16.0]], bound=1e-14, why="centred"
    )


@given(motions())
def test_a_moved_map_has_its_points_and_directions_moved(motion: Motion) -> None:
    rows = np.array([[0.0, 0, 0], [10, 20, 5], [40, -10, 0]])
    cone = between(*(bezier([exactly(p) for p in apex + share * (rows - apex)])
                     for apex in [np.array([20.0, 5, 90])] for share in (1.0, 0.4)))  # fmt: skip
    plain = develop((cone,))
    (one,), (other,) = plain.pieces, moved(plain, motion).pieces
    u, v = np.array([0.0, 0.3, 1.0, 0.5]), np.array([0.0, 0.2, 0.7, 1.0])
    assert_near(other.positions(u, v), motion.points(one.positions(u, v)), bound=1e-12, why="rounding")
    assert_near(other.velocities(u, v), motion.vectors(one.velocities(u, v)), bound=1e-11, why="rounding")
    steps = [piece.chords(u, v, u[::-1], v) for piece in (one, other)]
    assert_near(steps[1], motion.vectors(steps[0]), bound=1e-12, why="rounding")
