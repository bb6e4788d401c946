"""Curves and their derivatives against mpmath, and their affine images and parts against plain evaluation."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.arrays import EPS, Array
from stages.geometry.curves.curves import (
    Along,
    Bezier,
    Circular,
    Curve,
    Difference,
    RationalBezier,
    affine,
    bezier,
    blossom,
    difference,
    elevated,
    exactly,
    homogeneous,
    rational,
    restrict,
)
from tests.near import assert_near
from tests.strategies import decimals, different_points, motions, rotation

V = np.linspace(0.0, 1.0, 9)
ROWS = np.array([[0.0, 1.0, 2.0], [3.0, -1.0, 0.5], [2.0, 2.0, -4.0], [5.0, 0.25, 1.0]])
WEIGHTS = np.array([1.0, 2.5, 0.5, 1.5])
CURVES: dict[str, Curve] = {
    "bezier": bezier([exactly(row) for row in ROWS]),
    "rational": rational([exactly([*(w * row), w]) for row, w in zip(ROWS, WEIGHTS, strict=True)]),
    "circular": Circular(ROWS[0], ROWS[1], ROWS[2], 0.1 * ROWS[3], 0.3, 4.0),
}
MATRIX = tuple(tuple(Fraction(n, 8) for n in row) for row in ((1, 2, -3), (0, 5, 8), (9, -2, 4)))
SHIFT = (Fraction(100), Fraction(-7, 2), Fraction(1, 3))


def plain(name: str, v: mpmath.mpf) -> list[mpmath.mpf]:
    """Return the position at v by the definition of the curve."""
    basis = [mpmath.binomial(3, i) * v**i * (1 - v) ** (3 - i) for i in range(4)]
    if name == "circular":
        a = mpmath.mpf(0.3) + 4 * v
        terms = (1, mpmath.cos(a), mpmath.sin(a), a / 10)
        exact_w = (1, 1, 1, mpmath.mpf(0.1) * 10)
        return [sum(t * w * ROWS[i, k] for i, (t, w) in enumerate(zip(terms, exact_w, strict=True))) for k in range(3)]
    weights = WEIGHTS if name == "rational" else np.ones(4)
    below = sum(b * w for b, w in zip(basis, weights, strict=True))
    return [sum(b * w * x for b, w, x in zip(basis, weights, ROWS[:, k], strict=True)) / below for k in range(3)]


@pytest.mark.parametrize("name", CURVES)
def test_positions_and_two_derivatives_are_those_of_the_definition(name: str) -> None:
    jets = CURVES[name].jet(V, 2)
    for i, v in enumerate(V):
        for order in range(3):
            slopes = [mpmath.diff(lambda t, k=k: plain(name, t)[k], mpmath.mpf(v), order) for k in range(3)]
            assert_near(
                jets[order, i], slopes, bound=256 * EPS * np.abs(jets[order]).max(), why="30 terms of that size"
            )


@pytest.mark.parametrize("name", CURVES)
def test_an_affine_image_has_the_images_of_the_points(name: str) -> None:
    image = affine(CURVES[name], MATRIX, SHIFT).jet(V, 1)
    m, d = np.array(MATRIX, dtype=float), np.array(SHIFT, dtype=float)
    points, slopes = CURVES[name].jet(V, 1)
    assert_near(image[0], points @ m.T + d, bound=64 * EPS * 200.0, why="coordinates up to 200, a dozen products")
    assert_near(image[1], slopes @ m.T, bound=64 * EPS * 200.0, why="derivatives up to 200, a dozen products")


@pytest.mark.parametrize("name", CURVES)
@pytest.mark.parametrize(("low", "high"), [(Fraction(1, 3), Fraction(3, 4)), (Fraction(0), Fraction(1, 7))])
def test_a_part_of_a_curve_runs_over_the_same_points(name: str, low: Fraction, high: Fraction) -> None:
    part = restrict(CURVES[name], low, high).jet(V, 1)
    points, slopes = CURVES[name].jet(float(low) + float(high - low) * V, 1)
    assert_near(part[0], points, bound=64 * EPS * 20.0, why="coordinates up to 20, a dozen products")
    assert_near(part[1], slopes * float(high - low), bound=64 * EPS * 40.0, why="derivatives up to 40")


def test_the_whole_of_a_curve_is_the_curve_itself() -> None:
    assert restrict(CURVES["bezier"], Fraction(0), Fraction(1)) is CURVES["bezier"]


@settings(max_examples=25)
@given(different_points(4), motions(), st.fractions(0, 1), st.fractions(0, 1))
def test_images_parts_and_elevations_of_bezier_curves_are_exact(
    rows: list[tuple[Fraction, ...]], motion: object, a: Fraction, b: Fraction
) -> None:
    matrix, shift = motion
    curve = bezier(rows)
    image, part, raised = affine(curve, matrix, shift), restrict(curve, a, b), elevated(curve.exact, 6)
    assert isinstance(image, Bezier)
    assert isinstance(part, Bezier)
    assert len(raised) == 7
    for t in (Fraction(0), Fraction(1, 3), Fraction(6, 7), Fraction(1)):
        here = blossom(rows, t, t)[0]
        assert blossom(image.exact, t, t)[0] == [
            sum(m * x for m, x in zip(row, here, strict=True)) + d for row, d in zip(matrix, shift, strict=True)
        ]
        assert blossom(raised, t, t)[0] == here
        assert blossom(part.exact, t, t)[0] == blossom(rows, a + t * (b - a), a + t * (b - a))[0]


@settings(max_examples=25)
@given(different_points(3), different_points(5))
def test_the_difference_of_bezier_curves_is_exact_whatever_their_degrees(
    a: list[tuple[Fraction, ...]], b: list[tuple[Fraction, ...]]
) -> None:
    less = difference(bezier(a), bezier(b))
    assert isinstance(less, Bezier)
    for t in (Fraction(0), Fraction(2, 5), Fraction(1)):
        left, right = blossom(a, t, t)[0], blossom(b, t, t)[0]
        assert blossom(less.exact, t, t)[0] == [x - y for x, y in zip(left, right, strict=True)]


def test_curves_of_one_sort_keep_it_in_their_difference_and_others_are_subtracted_by_value() -> None:
    circle, spline, plain = CURVES["circular"], CURVES["rational"], CURVES["bezier"]
    assert isinstance(circle, Circular)
    other = circle.replace(centre=np.ones(3), U=np.array([1.0, 0.0, 0.0]))
    assert isinstance(difference(circle, other), Circular)
    assert isinstance(difference(circle, other.replace(sweep=1.0)), Difference)
    assert isinstance(difference(spline, plain), RationalBezier)
    assert isinstance(difference(spline, circle), Difference)
    for a, b in ((circle, other), (spline, plain), (plain, spline), (spline, circle)):
        assert_near(
            difference(a, b).jet(V, 2), a.jet(V, 2) - b.jet(V, 2), bound=64 * EPS * 200.0, why="derivatives up to 200"
        )


def test_a_rational_curve_far_from_the_origin_keeps_the_digits_of_its_derivatives() -> None:
    near = CURVES["rational"]
    far = affine(near, rotation((1, 0, 0, 0)), (Fraction(2**20),) * 3)
    bound = 256 * EPS * 2.0**20
    assert_near(far.jet(V, 1)[1], near.jet(V, 1)[1], bound=bound, why="control points rounded at 1e6, no more")
    roughness = np.diff(far.jet(np.linspace(0.5, 0.5 + 1e-9, 64), 1)[1], 2, axis=0)
    assert_near(roughness, np.zeros_like(roughness), bound=512 * EPS * 40.0, why="neighbours round as near the origin")


HOMOGENEOUS = st.lists(
    st.tuples(*[st.fractions(-10, 10, max_denominator=1000)] * 3, st.fractions(Fraction(1, 10), 5, max_denominator=50)),
    min_size=2,
    max_size=6,
)


def exact_point(curve: Curve, v: Fraction) -> list[Fraction]:
    """Return the point at v in exact arithmetic."""
    assert isinstance(curve, Bezier | RationalBezier)
    x, y, z, w = blossom(homogeneous(curve), v, v)[0]
    return [x / w, y / w, z / w]


@settings(max_examples=8, deadline=None)
@given(HOMOGENEOUS, HOMOGENEOUS, motions(), decimals(0, 1), decimals(0, 1))
def test_images_parts_and_differences_of_rational_curves_are_exact(
    rows: list[tuple[Fraction, ...]],
    others: list[tuple[Fraction, ...]],
    motion: tuple[tuple[tuple[Fraction, ...], ...], tuple[Fraction, ...]],
    a: Fraction,
    b: Fraction,
) -> None:
    a, b = min(a, b), max(a, b)
    matrix, shift = motion
    curve, other, plain = rational(rows), rational(others), bezier([row[:3] for row in others])
    image, part = affine(curve, matrix, shift), restrict(curve, a, b)
    for t in (Fraction(0), Fraction(1, 3), Fraction(1)):
        here = exact_point(curve, t)
        assert exact_point(image, t) == [
            sum(m * x for m, x in zip(row, here, strict=True)) + d for row, d in zip(matrix, shift, strict=True)
        ]
        assert exact_point(part, t) == exact_point(curve, a + t * (b - a))
        for second in (other, plain):
            less = [x - y for x, y in zip(here, exact_point(second, t), strict=True)]
            assert exact_point(difference(curve, second), t) == less
            assert exact_point(difference(second, curve), t) == [-x for x in less]
        shifted = rational([[2 * row[3] + row[0], *row[1:]] for row in rows])
        assert exact_point(difference(shifted, curve), t) == [2, 0, 0], "the same weights"


@pytest.mark.parametrize("factor", [1e-200, 1.0, 1e200])
def test_only_the_ratios_of_weights_count(factor: float) -> None:
    rows = homogeneous(CURVES["rational"])
    scaled = rational([[Fraction(factor) * x for x in row] for row in rows])
    assert_near(scaled.jet(V, 2), CURVES["rational"].jet(V, 2), bound=64 * EPS * 200.0, why="derivatives up to 200")


def test_a_ruling_that_shrinks_to_nothing_keeps_its_direction() -> None:
    """(1 - v) (1, 2, 3) over weights: near v = 1 a difference of two points would leave only rounding."""
    steps = [Fraction(1), Fraction(2, 3), Fraction(1, 4), Fraction(0)]
    weights = [Fraction(1), Fraction(3), Fraction(1, 2), Fraction(2)]
    curve = rational([[w * s, 2 * w * s, 3 * w * s, w] for s, w in zip(steps, weights, strict=True)])
    place = curve.jet(np.array([1.0 - 1e-13]), 0)[0, 0]
    assert_near(place[1:] / place[0], [2.0, 3.0], bound=8 * EPS, why="each coordinate rounded by itself")


def test_parallel_rulings_keep_their_direction_however_short_they_get() -> None:
    distance = Circular(np.array([1.0, 0.0, 0.0]), np.array([-1.0, 0.0, 0.0]), *np.zeros((2, 3)), 0.0, 2.0)
    direction = np.array([0.3, 0.2, 1.0])
    jets = Along(distance, direction).jet(np.array([0.0, 1e-7, 1e-3, 0.5]), 2)
    across: Array = np.cross(jets, direction)
    assert (np.abs(across) <= EPS * np.abs(jets).max(axis=-1, keepdims=True)).all()


def test_weights_that_are_not_positive_are_refused() -> None:
    with pytest.raises(ValueError, match="positive"):
        rational([[Fraction(1)] * 4, [Fraction(1)] * 3 + [Fraction(0)]])
    one = CURVES["rational"]
    assert isinstance(one, RationalBezier)
    with pytest.raises(ValueError, match="as many exact as rounded"):
        one.replace(exact=one.exact[:3])


@settings(max_examples=20)
@given(different_points(6), st.floats(0.0, 1.0))
def test_floats_are_the_exact_control_points_rounded_once(rows: list[tuple[Fraction, ...]], v: float) -> None:
    curve = bezier(rows)
    assert curve.points.tolist() == [[float(x) for x in row] for row in rows]
    exact = blossom(rows, Fraction(v), Fraction(v))[0]
    assert_near(
        curve.jet(np.array([v]), 0)[0, 0], [float(x) for x in exact], bound=32 * EPS * 10.0, why="6 terms of size 10"
    )
