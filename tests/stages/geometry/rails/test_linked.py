"""A rail along an arc of rulings with one tangent plane: closed form for two ellipses, series for derivatives."""

from fractions import Fraction

import numpy as np
import pytest

from stages.geometry.curves.curves import Circular, affine, bezier, restrict
from stages.geometry.numeric.implicit import implicit
from stages.geometry.numeric.roots import bracketed
from stages.geometry.rails.crossing import crossings
from stages.geometry.rails.linked import Link, Linked, arc, both_rails, link
from stages.geometry.rails.mismatch import mismatch
from stages.geometry.ruled.ruled import between, warp
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
    return both_rails(link(LOWER, UPPER, w, t))


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


@pytest.mark.parametrize("knots", [2, 9])
def test_the_rates_are_those_of_the_closed_form(knots: int) -> None:
    """w = t + s(t) with tan b = 4 tan a: dt/dw = 1 / (1 + s'), d2t/dw2 = -s'' / (1 + s')^3."""
    rail, _ = linked(knots)
    t = np.linspace(0.0, 1.0, 41)
    a, quarter = np.pi / 2.0 * t, np.pi / 2.0
    round_ = np.cos(a) ** 2 + 16.0 * np.sin(a) ** 2
    slope, bend = 4.0 / round_, -4.0 * 15.0 * np.sin(2.0 * a) * quarter / round_**2
    found = arc(rail.link, t + other_parameter(t), 2)
    assert_near(found[0], t, bound=4e-15, why="a dozen roundings")
    assert_near(found[1], 1.0 / (1.0 + slope), bound=1e-13, why="quotients of triple products")
    assert_near(2.0 * found[2], -bend / (1.0 + slope) ** 3, bound=1e-11, why="once more divided")


@pytest.mark.parametrize("on_b", [False, True])
@pytest.mark.parametrize(("low", "high"), [("1/4", "2/3"), ("2/3", "1/4"), ("1", "0")])
def test_a_part_is_the_curve_there(low: str, high: str, on_b: bool) -> None:
    curve = linked()[on_b]
    part = restrict(curve, Fraction(low), Fraction(high))
    v, width = np.linspace(0.0, 1.0, 11), float(Fraction(high) - Fraction(low))
    whole = curve.jet(float(Fraction(low)) + width * v, 2) * (width ** np.arange(3.0))[:, None, None]
    assert_near(part.jet(v, 2), whole, bound=1e-12, why="the place differs by a rounding, derivatives are up to 50")


def test_parts_meet_exactly() -> None:
    curve = linked()[1]
    first, second = (restrict(curve, Fraction(a), Fraction(b)) for a, b in (("0", "1/3"), ("1/3", "1")))
    assert (first.jet(np.ones(1), 2)[0] == second.jet(np.zeros(1), 2)[0]).all()


@pytest.mark.parametrize("on_b", [False, True])
def test_an_image_is_the_image_of_every_point(on_b: bool) -> None:
    curve = linked()[on_b]
    matrix, shift = [[0, -2, 0], [1, 0, 3], [0, 1, 1]], [5, -1, 100]
    image = affine(curve, [[Fraction(x) for x in row] for row in matrix], [Fraction(x) for x in shift])
    v = np.linspace(0.0, 1.0, 7)
    expected = curve.jet(v, 3) @ np.array(matrix, dtype=float).T
    expected[0] += np.array(shift, dtype=float)
    assert_near(image.jet(v, 3), expected, bound=1e-12 * np.abs(expected).max(), why="two products")


def test_a_crossing_of_two_arcs_is_found_and_passed_exactly() -> None:
    """A rail moved along: t = s, and another arc crosses where the tangent is across the curvature's change."""
    points = [[0, 0, 0], [1, 2, 0], [3, -1, 0], [4, 1, 0]]
    a, b = (
        bezier([[Fraction(x) + m for x, m in zip(p, by, strict=True)] for p in points]) for by in ((0, 0, 0), (1, 0, 2))
    )
    w = np.linspace(0.0, 2.0, 51)
    ((t, s),) = crossings(a, b, w, w / 2.0)
    # the inflection: y'' x' = x'' y' with x' = 3 (1 + 2 t - 2 t^2), y' = 3 (2 - 10 t + 10 t^2)
    x1, x2 = 3.0 * (1.0 + 2.0 * t - 2.0 * t * t), 3.0 * (2.0 - 4.0 * t)
    y1, y2 = 3.0 * (2.0 - 10.0 * t + 10.0 * t * t), 3.0 * (20.0 * t - 10.0)
    assert_near([t - s, x1 * y2 - x2 * y1], [0.0, 0.0], bound=1e-12, why="Newton's method on both slopes of F")
    end = t + s
    before = link(a, b, np.append(w[w < end - 1e-6], end), np.append(w[w < end - 1e-6], end) / 2.0)
    near = end - np.array([0.0, 1e-12, 1e-9, 1e-6, 1e-3, 1e-2, 1e-1])
    found = arc(before, near, 2)
    assert_near(found[0], near / 2.0, bound=1e-14, why="the series about the crossing")
    assert_near(found[1], np.full(7, 0.5), bound=1e-12, why="F_t is 0.1 of its size where the series ends")
    assert_near(found[2], np.zeros(7), bound=1e-10, why="and once more divided")


def beside_a_crossing(points: list[list[Fraction]], place: float) -> tuple[Link, np.ndarray]:
    """Return the arc t = s between a rail and the same moved along, from a crossing at `place` to the end, and w."""
    a, b = (bezier([[x + m for x, m in zip(p, by, strict=True)] for p in points]) for by in ((0, 0, 0), (1, 0, 2)))
    w = np.linspace(2.0 * place, 2.0, 7)
    return link(a, b, w, w / 2.0), np.linspace(2.0 * place, 2.0, 501)


BENDS_LATE = [[Fraction(x), Fraction(y), Fraction(0)] for x, y in ((0, 0), (1, 0), (2, "9.7"), (3, "19.1"))]
"""y'' = 0 at 97/100: 97 (1 - t) - 3 t = 0."""


def test_the_series_about_a_crossing_holds_as_far_as_the_end_of_the_rails() -> None:
    along, w = beside_a_crossing(BENDS_LATE, 0.97)
    found = arc(along, w, 2)
    assert_near(found[1], np.full_like(w, 0.5), bound=1e-15, why="t = w / 2; Newton's method leaves 1e-16 / 0.04^2")
    assert_near(found[2], np.zeros_like(w), bound=1e-14, why="t = w / 2; Newton's method leaves 1e-16 / 0.04^3")


def test_the_series_about_an_end_where_nothing_crosses_is_not_used() -> None:
    """Within the reach of the first end most places are nearer to the last one."""
    along, w = beside_a_crossing(BENDS_LATE, 0.97)
    assert along.reach[0] > (w[-1] - w[0]) / 2.0
    assert along.reach[1] == 0.0
    ends = np.stack([along.ends[0], np.full_like(along.ends[1], np.nan)])
    assert np.isfinite(arc(along.replace(ends=ends), w, 2)).all()


def test_an_implicit_function_is_found_where_two_curves_cross() -> None:
    """(x - 0.3 h - h^2)(x - 2 h) = 0: the curve whose rate is nearer to the one expected."""
    G = np.zeros((5, 5, 2))
    G[2, 0], G[1, 1], G[1, 2], G[0, 2], G[0, 3] = 1.0, -2.3, -1.0, 0.6, 2.0
    found = implicit(G, np.array([0.4, 1.7]))
    assert_near(found, [[0, 0], [0.3, 2.0], [1.0, 0.0], [0.0, 0.0]], bound=1e-14, why="closed form")
