from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.curves.arclength import length_between, reached, speed_of
from stages.geometry.curves.plane import CircularArc, Segment, Stretch, stretch
from tests.near import assert_near
from tests.stages.geometry.plane_curves import SINE

SIDE = Segment(np.array([0.0, 0.0]), np.array([30.0, 40.0]))
TURN = CircularArc(np.array([0.0, 0.0]), 20.0, 0.3, -pi)


@given(st.floats(0.0, 1.0))
def test_on_lines_and_arcs_the_length_is_the_share(share: float) -> None:
    chain = [speed_of(SIDE), speed_of(TURN)]
    total = 50.0 + 20.0 * pi
    found = reached(chain, share * total)
    assert found is not None
    index, t = found
    assert_near([index * 50.0 + t * (20.0 * pi if index else 50.0)], [share * total], bound=1e-11, why="closed form")


@settings(max_examples=20, deadline=None)
@given(st.floats(0.0, 1.0))
def test_the_way_to_a_place_has_the_length_that_was_asked_for(share: float) -> None:
    speed = speed_of(SINE)
    whole = length_between(speed, 0.0, 1.0)
    found = reached([speed], share * whole)
    assert found is not None
    assert_near([length_between(speed, 0.0, found[1])], [share * whole], bound=1e-11 * whole, why="its quadrature")


@pytest.mark.parametrize("length", [-0.1, 50.1])
def test_beyond_the_ends_there_is_no_place(length: float) -> None:
    assert reached([speed_of(SIDE)], length) is None
    assert reached([speed_of(SIDE)], 50.0) == (0, 1.0)


@pytest.mark.parametrize("edge", [SIDE, TURN, SINE])
def test_a_stretch_of_an_edge_is_that_edge(edge: Segment | CircularArc) -> None:
    t = np.linspace(0.0, 1.0, 21)
    for low, high in ((0.25, 0.75), (0.75, 0.25), (0.0, 1.0), (1.0, 0.0)):
        part, inner = stretch(edge, low, high), low + (high - low) * t
        assert_near(part.at(t), edge.at(inner), bound=1e-12 * 700, why="one rounding of t")
        slopes = (high - low) * edge.derivative(inner)
        assert_near(part.derivative(t), slopes, bound=1e-11 * 700, why="one rounding of t, and its slope")
    kinds = (Segment, CircularArc, Stretch)
    assert isinstance(stretch(edge, 0.25, 0.75), kinds)
    if isinstance(edge, Segment | CircularArc):
        assert type(stretch(edge, 0.25, 0.75)) is type(edge), "lines and arcs are recovered one to one"
