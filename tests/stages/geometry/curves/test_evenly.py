"""Places at lengths along edges: closed forms of a parabola, one by one against `arclength`, chains of many."""

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stages.errors import NoSolutionError
from stages.geometry.arrays import EPS, Points2, Values
from stages.geometry.curves.arclength import length_between, reached, speed_of
from stages.geometry.curves.evenly import Measured, along, measured
from stages.geometry.curves.plane import CircularArc, PlaneCurve, Segment
from tests.near import assert_near, assert_relative


@dataclass(frozen=True)
class Parabola:
    """y = x^2 from 0 to 3."""

    def at(self, t: Values) -> Points2:
        return np.stack([3.0 * t, 9.0 * t**2], axis=1)

    def derivative(self, t: Values) -> Points2:
        return np.stack([np.full_like(t, 3.0), 18.0 * t], axis=1)


EDGES: tuple[PlaneCurve, ...] = (
    Segment(np.array([-4.0, 0.0]), np.zeros(2)),
    Parabola(),
    CircularArc(np.array([3.0, 10.0]), 1.0, -np.pi / 2.0, np.pi),
)


def test_a_parabola_has_the_length_of_its_closed_form() -> None:
    x = 3.0
    exact = x / 2.0 * np.sqrt(1.0 + 4.0 * x**2) + np.arcsinh(2.0 * x) / 4.0
    assert_relative([measured(Parabola()).length_mm], [exact], bound=1e-14, why="quadrature to rounding")


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=20))
def test_the_length_up_to_a_place_is_the_length_that_was_asked_for(shares: list[float]) -> None:
    known = measured(Parabola())
    wanted = np.array(shares) * known.length_mm
    t = known.parameters(wanted)
    found = [length_between(speed_of(Parabola()), 0.0, float(one)) for one in t]
    assert_near(found, wanted, bound=1e-13 * known.length_mm, why="both quadratures are good to some 1e-14")


@pytest.mark.parametrize("share", [0.0, 0.1, 0.3, 0.77, 1.0])
def test_along_a_chain_it_is_where_the_search_one_by_one_finds_it(share: float) -> None:
    known = [measured(edge) for edge in EDGES]
    length = share * sum(one.length_mm for one in known)
    number, t = along(known, np.array([length]))
    spot = reached([speed_of(edge) for edge in EDGES], length)
    assert spot is not None
    here, there = EDGES[number[0]].at(t)[0], EDGES[spot[0]].at(np.array([spot[1]]))[0]
    assert_near(here, there, bound=1e-12, why="two ways to one place, of some 20 mm")


def test_what_is_beyond_an_end_lies_at_that_end() -> None:
    known = [measured(edge) for edge in EDGES]
    number, t = along(known, np.array([-5.0, 1e3]))
    assert number.tolist() == [0, 2]
    assert_near(t, [0.0, 1.0], bound=4 * EPS, why="clipped to the chain")


def test_a_length_that_is_not_met_is_no_solution() -> None:
    """A table of lengths that falls where it should rise leaves Newton's method where it began."""
    wrong = Measured(np.array([0.0, 1.0]), np.array([[1.0, -1.0]]), np.array([0.0, 2.0]))
    with pytest.raises(NoSolutionError, match="place at a length: reached 1 mm"):
        wrong.parameters(np.array([0.5]))
