"""Unit tangents and sums against 60 digits and closed forms, their images and parts against plain evaluation."""

from collections.abc import Callable
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given, settings

from stages.geometry.arrays import EPS, dot, norm
from stages.geometry.curves.curves import Bezier, Circular, Curve, affine, bezier, exactly, rational, restrict
from stages.geometry.curves.tangents import Sum, UnitTangent, is_even, total, turn_between, unit_tangent
from tests.near import assert_near
from tests.strategies import different_points, motions

V = np.linspace(0.0, 1.0, 5)
ROWS = np.array([[0.0, 1.0, 2.0], [3.0, -1.0, 0.5], [2.0, 2.0, -4.0], [5.0, 0.25, 1.0]])
WEIGHTS = (1.0, 2.5, 0.5, 1.5)
HELIX = Circular(np.zeros(3), np.array([3.0, 0, 0]), np.array([0, 3.0, 0]), np.array([0, 0, 0.5]), 0.25, 5.0)
ELLIPSE = Circular(np.ones(3), np.array([3.0, 0, 0]), np.array([0, 2.0, 0]), np.zeros(3), 0.25, -5.0)
CURVES: dict[str, Curve] = {
    "bezier": bezier([exactly(row) for row in ROWS]),
    "rational": rational([exactly([*(w * row), w]) for row, w in zip(ROWS, WEIGHTS, strict=True)]),
    "ellipse": ELLIPSE,
}
MATRIX = tuple(tuple(Fraction(n, 8) for n in row) for row in ((1, 2, -3), (0, 5, 8), (9, -2, 4)))
SHIFT = (Fraction(100), Fraction(-7, 2), Fraction(1, 3))

Place = Callable[[mpmath.mpf], list[mpmath.mpf]]


def place(name: str) -> Place:
    """Return a curve by its definition."""
    if name == "ellipse":
        angle = lambda v: mpmath.mpf(0.25) - 5 * v  # noqa: E731
        return lambda v: [1 + 3 * mpmath.cos(angle(v)), 1 + 2 * mpmath.sin(angle(v)), mpmath.mpf(1)]
    weights = WEIGHTS if name == "rational" else (1.0,) * 4

    def at(v: mpmath.mpf) -> list[mpmath.mpf]:
        basis = [mpmath.binomial(3, i) * v**i * (1 - v) ** (3 - i) * weights[i] for i in range(4)]
        return [mpmath.fdot(basis, ROWS[:, k]) / mpmath.fsum(basis) for k in range(3)]

    return at


def tangent(curve: Place, v: mpmath.mpf) -> list[mpmath.mpf]:
    slope = [mpmath.diff(lambda t, k=k: curve(t)[k], v) for k in range(3)]
    return [x / mpmath.norm(slope) for x in slope]


@pytest.mark.parametrize("name", CURVES)
def test_the_unit_tangent_and_four_derivatives_are_those_of_the_definition(name: str) -> None:
    made, curve = unit_tangent(CURVES[name]).jet(V, 4), place(name)
    with mpmath.workdps(60):
        for i, v in enumerate(V):
            for order in range(5):
                exact = [
                    mpmath.diff(lambda t, k=k: tangent(curve, t)[k], mpmath.mpf(v), order, h=mpmath.mpf(10) ** -12)
                    for k in range(3)
                ]
                assert_near(
                    made[order, i], [float(x) for x in exact], bound=1e3 * EPS * max(np.abs(made[order]).max(), 1.0),
                    why="some 30 terms, each up to a hundred times the result",
                )  # fmt: skip


@pytest.mark.parametrize("curve", [HELIX, HELIX.replace(W=np.zeros(3)), HELIX.replace(sweep=-5.0)])
def test_the_tangent_of_a_helix_and_of_a_circle_is_circular_motion(curve: Circular) -> None:
    closed = unit_tangent(curve)
    assert isinstance(closed, Circular)
    general = UnitTangent(curve, np.eye(3), np.zeros(3))
    for order, scale in enumerate(5.0**k for k in range(5)):
        assert_near(
            closed.jet(V, 4)[order], general.jet(V, 4)[order], bound=512 * EPS * scale, why="sums of 30 terms of 5**k"
        )
    assert_near(norm(closed.jet(V, 0)[0]), np.ones(V.size), bound=4 * EPS, why="unit vectors")


def test_an_ellipse_and_a_slanting_helix_have_no_even_speed() -> None:
    assert is_even(HELIX)
    assert not is_even(ELLIPSE)
    assert not is_even(HELIX.replace(W=np.array([1e-6, 0.0, 0.5])))
    assert isinstance(unit_tangent(ELLIPSE), UnitTangent)


def test_the_tangent_of_a_line_is_one_exact_point() -> None:
    made = unit_tangent(bezier([exactly((1.0, 2.0, 3.0)), exactly((4.0, 2.0, 7.0))]))
    assert isinstance(made, Bezier)
    assert made.exact == (exactly((0.6, 0.0, 0.8)),)


@pytest.mark.parametrize("name", CURVES)
def test_images_and_parts_run_over_the_same_points_also_backwards(name: str) -> None:
    curve = CURVES[name]
    T = unit_tangent(curve)
    m, d = np.array(MATRIX, dtype=float), np.array(SHIFT, dtype=float)
    both = total(curve, affine(T, MATRIX, SHIFT))
    points = curve.jet(V, 2)[0] + T.jet(V, 2)[0] @ m.T + d
    assert_near(both.jet(V, 0)[0], points, bound=64 * EPS * 200.0, why="coordinates up to 200, a dozen products")
    image = affine(both, MATRIX, SHIFT).jet(V, 1)
    assert_near(image[0], points @ m.T + d, bound=64 * EPS * 1e3, why="coordinates up to 1e3, a dozen products")
    for low, high in ((Fraction(1, 4), Fraction(3, 4)), (Fraction(1), Fraction(0)), (Fraction(2, 3), Fraction(1, 3))):
        whole = both.jet(float(low) + float(high - low) * V, 2)
        part = restrict(both, low, high).jet(V, 2)
        for order in range(3):
            expected = whole[order] * float(high - low) ** order
            bound = 1e3 * EPS * max(np.abs(whole[order]).max(), 200.0)
            assert_near(part[order], expected, bound=bound, why="the same sums of some 50 terms")


def test_sums_stay_of_the_sort_of_their_terms() -> None:
    polynomial, circle = CURVES["bezier"], HELIX
    assert isinstance(total(polynomial, polynomial), Bezier)
    assert isinstance(total(circle, unit_tangent(circle)), Circular)
    assert isinstance(total(circle, bezier([exactly((1.0, 2.0, 3.0))])), Circular)
    assert isinstance(total(polynomial, circle), Sum)
    for a, b in ((polynomial, polynomial), (circle, unit_tangent(circle)), (polynomial, circle)):
        assert_near(total(a, b).jet(V, 2), a.jet(V, 2) + b.jet(V, 2), bound=64 * EPS * 100, why="derivatives of 100")


def test_a_circle_drawn_in_to_its_centre_is_a_point() -> None:
    circle = HELIX.replace(U=np.array([0.0, 0.3, 0.0]), V=np.array([-0.3, 0.0, 0.0]), W=np.zeros(3))
    inwards = circle.replace(U=-3.0 * np.array([0.0, 0.1, 0.0]), V=-0.1 * 3.0 * np.array([-1.0, 0.0, 0.0]))
    point = total(circle, inwards)
    assert not point.jet(V, 2)[1:].any()


@settings(max_examples=20)
@given(different_points(4), motions())
def test_a_motion_turns_the_tangent_with_the_curve(rows: list[tuple[Fraction, ...]], motion: object) -> None:
    matrix, shift = motion
    curve = bezier(rows)
    v = np.array([0.1, 0.45, 0.8])
    speed = norm(curve.jet(v, 1)[1])
    assume(speed.min() > 1e-3)  # nearly a stop: the direction of rounding
    there = unit_tangent(affine(curve, matrix, shift)).jet(v, 0)[0]
    turned = affine(unit_tangent(curve), matrix, (Fraction(0),) * 3).jet(v, 0)[0]
    bound = 64 * EPS * float((60.0 / speed).max() + 2e3 / speed.min())
    assert_near(there, turned, bound=bound, why="control points rounded at 1e3, over the speed")


def test_the_turn_between_curves_is_the_angle_of_their_tangents() -> None:
    a, b = (
        bezier([exactly((*p, 0.0)), exactly((*q, 0.0))])
        for p, q in (((0.0, 0.0), (2.0, 0.0)), ((2.0, 0.0), (3.0, 1.0)))
    )
    assert_near(turn_between(a, b), np.pi / 4.0, bound=2 * EPS, why="45 deg")
    assert turn_between(a, a) == 0.0


def test_the_derivative_of_a_unit_vector_is_perpendicular_to_it() -> None:
    T = unit_tangent(CURVES["rational"]).jet(V, 1)
    assert_near(dot(T[0], T[1]), np.zeros(V.size), bound=64 * EPS * norm(T[1]).max(), why="one cancellation")
