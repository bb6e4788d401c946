"""What a flat map gives beside positions: vectors within a panel, and edges as plane curves."""

from fractions import Fraction

import numpy as np
import pytest

from stages.geometry.arrays import EPS, norm
from stages.geometry.curves.curves import Bezier, restrict
from stages.geometry.flat.development import develop
from stages.geometry.flat.flatmap import DevelopedEdge
from tests.near import assert_near
from tests.parts import ELLIPTIC_CYLINDER, EXAMPLE_1, OBLIQUE_CONE, QUINTIC_TANGENT, RIGHT_FRUSTUM, Table, patches


@pytest.mark.parametrize("table", [EXAMPLE_1, QUINTIC_TANGENT, OBLIQUE_CONE, ELLIPTIC_CYLINDER])
def test_a_chord_is_the_difference_of_positions(table: Table) -> None:
    piece = develop(patches(table)).pieces[0]
    low, high = (np.repeat(ends, 4) for ends in (piece.breaks[:-1], piece.breaks[1:]))
    u0, u = np.tile([0.0, 0.0, 1.0, 0.4], low.size // 4), np.tile([0.0, 1.0, 1.0, 0.7], low.size // 4)
    inside = np.nextafter(high, 0.0)
    apart = piece.positions(u, inside) - piece.positions(u0, low)
    size = float(norm(apart).max() + norm(piece.positions(u, high)).max())
    assert_near(piece.chords(u0, low, u, high), apart, bound=16 * EPS * size, why="rounding of positions")


@pytest.mark.parametrize("u", [0.0, 1.0])
def test_a_chord_is_good_to_the_panel_s_length_and_not_to_the_part_s(u: float) -> None:
    """A plane patch keeps every distance: in the last panel those of its control points, in fractions."""
    patch = patches(EXAMPLE_1)[0]
    piece = develop((patch,)).pieces[0]
    low, high = piece.breaks[-2:]
    v = low + (high - low) * np.array([1e-2, 0.1, 0.5, 1.0])
    edge = patch.c0 if u == 0.0 else patch.c1
    assert isinstance(edge, Bezier)
    ends = [restrict(edge, Fraction(float(low)), Fraction(float(x))).exact for x in v]
    exact = norm(np.array([[float(b - a) for a, b in zip(found[0], found[-1], strict=True)] for found in ends]))
    us = np.full(4, u)
    found = norm(piece.chords(us, np.full(4, low), us, v))
    panel = float(exact[-1])
    assert_near(found, exact, bound=32 * EPS * panel, why="16 terms of either series, of the panel's length")
    assert 32 * EPS * panel < EPS * float(norm(piece.positions(us, v)).max()), "less than the rounding of a position"


@pytest.mark.parametrize("u", [0.0, 0.5, 1.0])
@pytest.mark.parametrize(
    "table",
    [QUINTIC_TANGENT, OBLIQUE_CONE, RIGHT_FRUSTUM | {"radius1": 0}, RIGHT_FRUSTUM | {"radius0": 0},
     {"kind": "ruled", "c0": {"line": [[0, 0, 0], [3, 0, 0]]}, "c1": {"line": [[0, 0, 0], [3, 4, 0]]}}],
)  # fmt: skip
def test_directions_of_edges_are_the_differences_of_positions_also_at_both_ends(table: Table, u: float) -> None:
    piece = develop(patches(table)).pieces[0]
    step = 1e-5
    for reverse in (False, True):
        edge = DevelopedEdge(piece, u, reverse)
        t = np.array([0.0, 0.4, 1.0 - step])
        quotient = (edge.at(t + step) - edge.at(t)) / step
        middle = edge.derivative(t + step / 2.0)
        size = float(norm(middle).max()) + 1.0
        assert_near(middle, quotient, bound=size * (40 * step**2 + 1e-14 / step), why="a central difference")
        ends = np.array([0.0, 1.0])
        beside = edge.derivative(np.array([step, 1.0 - step]))
        assert_near(edge.derivative(ends), beside, bound=size * 20 * step, why="the direction beside it, 20/mm at most")
