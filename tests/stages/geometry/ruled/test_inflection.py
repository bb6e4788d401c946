"""Rulings of straps through inflections: exact factors, closed forms in 40 digits, weights, parts, and poles."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from mpmath import mp, mpf

from stages.geometry.curves.curves import Bezier, RationalBezier, affine, bezier, rational, restrict
from stages.geometry.ruled.envelope import Rectifying
from stages.geometry.ruled.inflection import bending, through
from tests.inflections import CIRCLE, FREE, Along, control_points, frame, rising
from tests.near import assert_near
from tests.strategies import Motion, motions

V = np.linspace(0.0, 1.0, 9)
PLAIN = [[0, 0, 0], [1, 0.25, 0], [2, 1, 0.5], [2.5, 2.5, 1], [2, 3.5, 2.5], [1, 4, 4]]


def curve(a: Along, places: list[str]) -> Bezier:
    """Return the curve with r' = a(s) whose curvature vanishes at these places."""
    return bezier([[Fraction(x) for x in row] for row in control_points(a, rising(places))])


def weighted(plain: Bezier, q: Fraction) -> RationalBezier:
    """Return the same curve, its parameter q t / (1 - t + q t)."""
    return rational([[*(q**i * x for x in point), q**i] for i, point in enumerate(plain.exact)])


def wanted(a: Along, places: list[str], v: mpf, axis: int) -> mpf:
    T, B, lean = frame(a, rising(places), v)
    return B[axis] + lean * T[axis]


@pytest.mark.parametrize("places", [["0.3"], ["1/3", "1/3"], ["0"], ["1", "1", "1"], ["0.25", "0.75"]])
def test_places_of_no_curvature_are_found_exactly_and_have_no_poles(places: list[str]) -> None:
    made = bending(curve(FREE, places))
    exact = [float(Fraction(place)) for place in sorted(set(places))]
    assert_near(made.inflections, exact, bound=1e-15, why="roots are isolated to 2^-50")
    assert made.poles == []


@pytest.mark.parametrize("places", [["0.3"], ["1/3", "1/3"], ["0"], ["0.25", "0.75"]])
def test_rulings_and_three_derivatives_are_those_of_the_curve_below(places: list[str]) -> None:
    jets = through(bending(curve(FREE, places))).jet(V, 3)
    sense = np.sign(jets[0, 4, 2] * float(wanted(FREE, places, mpf(float(V[4])), 2)))
    for i, v in enumerate(V):
        for axis in range(3):
            series = mp.taylor(lambda x, axis=axis: wanted(FREE, places, x, axis), mpf(float(v)), 3)
            exact = [float(c * mp.factorial(k)) for k, c in enumerate(series)]
            assert_near(
                sense * jets[:, i, axis] / np.array([1.0, 10.0, 100.0, 1000.0]),
                exact / np.array([1.0, 10.0, 100.0, 1000.0]),
                bound=1e-12,
                why="rounding of coefficients up to 100; each order is ten times larger",
            )


def test_over_a_circle_of_the_sphere_the_rulings_are_parallel() -> None:
    g = through(bending(curve(CIRCLE, ["0.4", "0.4"]))).jet(V, 2)
    assert_near(g[0], np.tile(np.array([1.0, 0.0, 1.0]) * np.sign(g[0, 0, 0]), (9, 1)), bound=1e-14, why="lambda = 1")
    assert_near(g[1:], np.zeros((2, 9, 3)), bound=1e-11, why="constant; derivatives of degree 20 in Bernstein form")


def test_without_inflection_it_is_the_frenet_apparatus() -> None:
    """Second method, polynomial and with weights."""
    plain = bezier([[Fraction(str(x)) for x in row] for row in PLAIN])
    uneven = rational(
        [[*(w * x for x in point), w] for point, w in zip(plain.exact, map(Fraction, "121513"), strict=True)]
    )
    for one in (plain, uneven):
        made = bending(one)
        assert made.inflections == [] and not made.straight
        straight = Rectifying(one).jet(V, 3)
        for k in range(4):
            scale = float(np.abs(straight[k]).max())
            assert_near(through(made).jet(V, 3)[k] / scale, straight[k] / scale, bound=1e-12, why="rounding")


@pytest.mark.parametrize("q", [Fraction(1, 3), Fraction(2)])
def test_another_parameter_has_the_same_rulings_at_the_same_points(q: Fraction) -> None:
    plain = curve(FREE, ["0.3", "0.3"])
    at = float(q) * V / (1.0 - V + float(q) * V)
    made = bending(weighted(plain, q))
    assert_near(made.inflections, [0.3 / (float(q) * 0.7 + 0.3)], bound=1e-15, why="the place that goes to 0.3")
    assert made.poles == []
    assert_near(
        through(made).jet(V, 0), through(bending(plain)).jet(at, 0), bound=1e-12, why="rounding of another parameter"
    )


@pytest.mark.parametrize("low, high", [("0.1", "0.5"), ("0.9", "0.2")])
def test_a_part_and_a_part_run_backwards(low: str, high: str) -> None:
    whole = through(bending(curve(FREE, ["0.3"])))
    a, b = Fraction(low), Fraction(high)
    at = float(a) + V * float(b - a)
    part, jets = restrict(whole, a, b).jet(V, 2), whole.jet(at, 2)
    for k in range(3):
        assert_near(part[k], float(b - a) ** k * jets[k], bound=1e-13, why="the chain rule")
    twice = restrict(restrict(whole, a, b), Fraction(1, 2), Fraction(1)).jet(V, 0)
    assert_near(twice, whole.jet(float(a) + (0.5 + V / 2) * float(b - a), 0), bound=1e-13, why="a part of a part")


@given(motions())
@settings(max_examples=10, deadline=None)
def test_a_moved_curve_has_the_moved_rulings(motion: Motion) -> None:
    """Exact control points move exactly: the same factor, the same places."""
    plain = curve(FREE, ["0.3", "0.3"])
    there = affine(plain, *motion)
    assert isinstance(there, Bezier)
    made = bending(there)
    assert made.inflections == bending(plain).inflections and made.poles == []
    zero = (Fraction(0),) * 3
    image = affine(through(bending(plain)), motion[0], zero)
    assert_near(through(made).jet(V, 1), image.jet(V, 1), bound=1e-11, why="rounding; derivatives below 100")


@pytest.mark.parametrize("start", ["0", "-1/4", "-1"])
def test_torsion_at_an_inflection_is_a_pole(start: str) -> None:
    """(t, t^3, t^4): no curvature at t = 0."""
    rows = control_points(([1], [0, 0, 3], [0, 0, 0, 4]), [Fraction(start), Fraction(1)])
    made = bending(bezier([[Fraction(x) for x in row] for row in rows]))
    assert_near(made.inflections, [-float(Fraction(start))], bound=1e-15, why="roots are isolated to 2^-50")
    assert made.poles == made.inflections


def test_one_digit_off_the_design_is_no_inflection() -> None:
    """Planted: a control point off by 1e-9 has curvature everywhere."""
    rows = [list(map(Fraction, row)) for row in control_points(FREE, rising(["0.3", "0.3"]))]
    rows[3][1] += Fraction(1, 10**9)
    assert bending(bezier(rows)).inflections == []


def test_a_straight_line_says_so() -> None:
    made = bending(bezier([[Fraction(k * x) for x in (1, 2, 3)] for k in (0, 1, 4, 9)]))
    assert made.straight and made.poles == []
    assert not bending(curve(FREE, ["0.3"])).straight
