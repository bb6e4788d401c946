"""A rail along an arc of rulings with one tangent plane: closed form for two ellipses, series for derivatives."""

import numpy as np
import pytest

from stages.geometry.curves import Circular
from stages.geometry.linked import Linked, mismatch
from stages.geometry.roots import bracketed
from stages.geometry.ruled import between, warp
from stages.unroll.sides import surface_figures
from tests.near import assert_near, assert_relative

ZERO, X, Y, Z = np.zeros(3), *np.eye(3)
LOWER = Circular(ZERO, 2.0 * X, Y, ZERO, 0.0, np.pi / 2.0)
UPPER = Circular(2.0 * Z, X, 2.0 * Y, ZERO, 0.0, np.pi / 2.0)


def other_parameter(t: np.ndarray) -> np.ndarray:
    """Return s of parallel tangents: (-2 sin a, cos a) along (-sin b, 2 cos b) where tan b = 4 tan a."""
    return np.arctan2(4.0 * np.sin(np.pi / 2.0 * t), np.cos(np.pi / 2.0 * t)) / (np.pi / 2.0)


def linked(knots: int = 9) -> tuple[Linked, Linked]:
    t = np.linspace(0.0, 1.0, knots)
    w = t + other_parameter(t)
    return Linked(LOWER, UPPER, w, t, on_b=False), Linked(LOWER, UPPER, w, t, on_b=True)


@pytest.mark.parametrize("knots", [2, 3, 9])
def test_both_rails_run_together_where_the_tangents_are_parallel(knots: int) -> None:
    a, b = linked(knots)
    v = np.linspace(0.0, 1.0, 101)
    on_a, on_b = a.jet(v, 1), b.jet(v, 1)
    t = np.arctan2(on_a[0, :, 1], on_a[0, :, 0] / 2.0) / (np.pi / 2.0)
    s = np.arctan2(on_b[0, :, 1] / 2.0, on_b[0, :, 0]) / (np.pi / 2.0)
    assert_near(s, other_parameter(t), bound=1e-14, why="closed form")
    assert_near(np.cross(on_a[1], on_b[1]), np.zeros((101, 3)), bound=1e-12, why="parallel tangents of size 10")


@pytest.mark.parametrize("on_b", [False, True])
def test_derivatives_are_those_of_the_positions(on_b: bool) -> None:
    curve = linked()[on_b]
    v, step = np.array([0.11, 0.42, 0.83]), 1e-3
    jets = curve.jet(v, 4)
    for order in range(4):
        ahead, behind = (curve.jet(v + sign * step, order)[order] for sign in (1.0, -1.0))
        wide = [curve.jet(v + sign * 2.0 * step, order)[order] for sign in (1.0, -1.0)]
        found = (8.0 * (ahead - behind) - (wide[0] - wide[1])) / (12.0 * step)
        size = np.abs(jets[order + 1]).max()
        assert_near(found / size, jets[order + 1] / size, bound=1e-7, why="step^4 times the ratio of derivatives")


def test_the_strip_between_two_ellipses_is_developable_and_has_its_area() -> None:
    """20.7300282819194 for all four quarters, from 20-digit quadrature over the ellipse's angle."""
    patch = between(*linked())
    assert float(warp(patch, np.linspace(0.0, 1.0, 501)).max()) < 1e-13
    assert_relative([4.0 * surface_figures((patch,))[1]], [20.73002828191942], bound=1e-13, why="quadrature")


def test_the_mismatch_does_not_change_when_the_rails_are_exchanged() -> None:
    t, s = np.linspace(0.0, 1.0, 7), np.linspace(1.0, 0.0, 7)
    assert_near(mismatch(LOWER, UPPER, t, s), mismatch(UPPER, LOWER, s, t), bound=1e-13, why="one triple product")


def test_zeros_are_found_to_rounding_also_of_flat_and_of_steep_functions() -> None:
    power = np.array([1.0, 3.0, 1.0 / 3.0, 0.5])

    def f(x: np.ndarray, which: np.ndarray) -> np.ndarray:
        away = x - 0.3
        return np.sign(away) * np.abs(away) ** power[which]

    found = bracketed(f, np.zeros(4), np.ones(4))
    assert_near(found, np.full(4, 0.3), bound=2e-15, why="a few roundings of 0.3")


def test_a_bracket_without_a_change_of_sign_gives_the_end_that_is_nearer_to_zero() -> None:
    assert bracketed(lambda x, _: x + 0.25, np.zeros(1), np.ones(1)) == 0.0
    assert bracketed(lambda x, _: 1.25 - x, np.zeros(1), np.ones(1)) == 1.0
