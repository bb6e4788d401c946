"""Curves of the job file as chains: splines against scipy, circles against their closed form, parts against wholes."""

from fractions import Fraction
from math import cos, pi, radians, sin

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import BSpline

from stages.construct.curves import Chain, chain, largest_gap, plane_axes, ruled_patches
from stages.geometry.arrays import EPS, Array, norm
from stages.geometry.curves.curves import Bezier
from stages.geometry.ruled.ruled import at
from stages.model.curves import CurveSpec
from tests.near import assert_near, assert_relative
from tests.parts import number
from tests.strategies import curves

V = np.linspace(0.0, 1.0, 7)


def read(table: dict[str, object]) -> Chain:
    spec = msgspec.convert(table, CurveSpec, dec_hook=number)
    assert not [*spec.troubles()]
    return chain(spec)


def jets(link: Chain, order: int) -> list[tuple[float, Array]]:
    """Return (v over the whole, jet by the whole parameter) at 7 places of each piece."""
    found = []
    for curve, low, high in zip(link.curves, link.breaks, link.breaks[1:], strict=False):
        width = float(high - low)
        made = curve.jet(V, order) / np.array([width**k for k in range(order + 1)])[:, None, None]
        found += [(float(low) + width * v, made[:, i]) for i, v in enumerate(V)]
    return found


POINTS = [[0, 0, 0], [1, 2, 0.5], [3, 2, -1], [4, 0, 0], [6, 1, 2], [7, 3, 1], [9, 0, 0]]
KNOTS = {
    "clamped, even": (3, [0, 0, 0, 0, 1, 2, 3, 4, 4, 4, 4]),
    "an inner knot twice": (3, [0, 0, 0, 0, 1, 1, 2.5, 4, 4, 4, 4]),
    "an inner knot as often as the degree": (3, [0, 0, 0, 0, 1.5, 1.5, 1.5, 4, 4, 4, 4]),
    "not clamped": (2, [0, 0.5, 1, 2, 3, 4, 4.5, 6, 7, 9]),
    "linear": (1, [0, 0, 1, 2, 3, 4, 5, 6, 6]),
    "one piece": (6, [2, 2, 2, 2, 2, 2, 2, 5, 5, 5, 5, 5, 5, 5]),
}


@pytest.mark.parametrize("weights", [None, [1, 2, 0.5, 1, 3, 1, 0.25]])
@pytest.mark.parametrize("name", KNOTS)
def test_a_spline_has_the_values_and_slopes_that_scipy_gives(name: str, weights: list[float] | None) -> None:
    degree, knots = KNOTS[name]
    table: dict[str, object] = {"degree": degree, "knots": knots, "points": POINTS}
    link = read({"bspline": table | ({"weights": weights} if weights else {})})
    w = np.array(weights or [1.0] * 7)
    over = BSpline(knots, np.array(POINTS) * w[:, None], degree)
    under = BSpline(knots, w, degree)
    first, last = knots[degree], knots[-degree - 1]
    for v, jet in jets(link, 1):
        x = min(max(first + v * (last - first), first), last)
        low, high = over(x) / under(x), 0.0
        assert_near(jet[0], low, bound=256 * EPS * 40, why="weighted points up to 40, some dozens of products")
        if np.min(np.abs(np.array(knots) - x)) > 1e-9:
            high = (over(x, 1) - under(x, 1) * low) / under(x) * (last - first)
            assert_near(jet[1], high, bound=1024 * EPS * 300, why="slopes up to 300, some dozens of products")


def test_a_spline_without_weights_stays_exact() -> None:
    degree, knots = KNOTS["an inner knot twice"]
    link = read({"bspline": {"degree": degree, "knots": knots, "points": POINTS}})
    assert link.breaks == (0, Fraction(1, 4), Fraction(5, 8), 1)
    for a, b in zip(link.curves, link.curves[1:], strict=False):
        assert isinstance(a, Bezier)
        assert isinstance(b, Bezier)
        assert a.exact[-1] == b.exact[0]
    first = link.curves[0]
    assert isinstance(first, Bezier)
    assert first.exact[0] == (0, 0, 0)


@pytest.mark.parametrize("closed", [False, True])
def test_an_interpolation_goes_through_its_points_with_two_continuous_derivatives(closed: bool) -> None:
    points = [*POINTS, POINTS[0]] if closed else POINTS
    link = read({"points": points})
    first = [curve.jet(np.array([0.0]), 0)[0, 0] for curve in link.curves]
    assert np.array_equal(first, np.array(points[:-1], dtype=float))
    chords = norm(np.diff(np.array(points, dtype=float), axis=0))
    assert_relative(
        [float(b) for b in link.breaks[1:]], np.cumsum(chords) / chords.sum(), bound=16 * EPS, why="a sum of chords"
    )
    found = [jet for _, jet in jets(link, 2)]
    ends, starts = found[6::7], found[7::7]
    joins = [*zip(ends, starts, strict=False), *([(found[-1], found[0])] if closed else [])]
    for a, b in joins:
        assert_near(a, b, bound=1e-10, why="second derivatives of up to 1e3, solved to 1e-13 of it")


def test_an_interpolation_is_the_one_cubic_where_four_points_lie_on_one() -> None:
    """Not-a-knot through four points at chord-length parameters: a single polynomial, third derivatives equal."""
    link = read({"points": [[0, 0, 0], [1, 0, 0], [1, 2, 0], [1, 2, 3]]})
    third = [curve.jet(np.array([0.5]), 3)[3, 0] / float(h) ** 3 for curve, h in
             zip(link.curves, np.diff([float(b) for b in link.breaks]), strict=True)]  # fmt: skip
    for other in third[1:]:
        assert_near(other, third[0], bound=1e-10, why="third derivatives of up to 1e3")


@pytest.mark.parametrize(
    "normal", [(0, 0, 1), (0, 0, -1), (1, 2, 3), (0.01, 0.01, 1), (0.02, 0, 1), (1, 0, 0), (0, 1, 0)]
)
def test_the_arbitrary_axis_rule_is_that_of_the_dxf_reference(normal: tuple[float, float, float]) -> None:
    n = np.array(normal, dtype=float)
    n /= norm(n)
    world = np.array([0.0, 1.0, 0.0]) if abs(n[0]) < 1 / 64 and abs(n[1]) < 1 / 64 else np.array([0.0, 0.0, 1.0])
    x = np.cross(world, n)
    axes = plane_axes(np.array(normal, dtype=float))
    assert_near(axes[0], x / norm(x), bound=8 * EPS, why="two normalisations")
    assert_near(axes[1], np.cross(n, x / norm(x)), bound=8 * EPS, why="two normalisations")


@pytest.mark.parametrize("normal", [[0, 0, 1], [1, 2, 3], [0, -1, 0]])
def test_circles_and_arcs_run_counter_clockwise_about_their_normal(normal: list[float]) -> None:
    plain = {"center": [1, 2, 3], "radius": 2.5, "normal": normal}
    x, y = plane_axes(np.array(normal, dtype=float))
    centre = np.array([1.0, 2.0, 3.0])
    for table, start, end in (
        ({"circle": plain}, 0, 360), ({"arc": plain | {"start": 30, "end": 200}}, 30, 200),
        ({"arc": plain | {"start": 200, "end": 30}}, 200, 30),
    ):  # fmt: skip
        for v, jet in jets(read(table), 0):
            a = radians(start + v * (end - start))
            expected = centre + 2.5 * (cos(a) * x + sin(a) * y)
            assert_near(jet[0], expected, bound=32 * EPS * 6, why="coordinates up to 6")


def test_an_ellipse_starts_at_its_major_axis_and_a_helix_at_plus_x() -> None:
    ellipse = read({"ellipse": {"center": [1, 0, 0], "major": [0, 3, 0], "minor": [0, 0, 2]}})
    for v, jet in jets(ellipse, 0):
        a = 2 * pi * v
        assert_near(jet[0], [1.0, 3 * cos(a), 2 * sin(a)], bound=32 * EPS * 3, why="closed form")
    helix = read({"helix": {"radius": 2, "pitch": 5, "turns": "3/2"}})
    for v, jet in jets(helix, 0):
        a = 3 * pi * v
        assert_near(jet[0], [2 * cos(a), 2 * sin(a), 7.5 * v], bound=64 * EPS * 10, why="an angle of 9.4 rad")


def test_two_coordinates_lie_in_the_plane_z_equal_to_zero() -> None:
    points = [jet[0] for _, jet in jets(read({"line": [[1, 2], [3, 4, 7]]}), 0)]
    assert points[0].tolist() == [1.0, 2.0, 0.0]
    assert points[-1].tolist() == [3.0, 4.0, 7.0]


def test_a_polyline_and_a_chain_share_the_parameter_evenly() -> None:
    assert read({"polyline": [[0, 0, 0], [9, 0, 0], [9, 1, 0]]}).breaks == (0, Fraction(1, 2), 1)
    link = read({"chain": [{"line": [[0, 0, 0], [1, 0, 0]]}, {"polyline": [[1, 0, 0], [2, 0, 0], [2, 1, 0.5]]}]})
    assert link.breaks == (0, Fraction(1, 2), Fraction(3, 4), 1)
    assert largest_gap(link) == 0.0


def test_the_gap_of_a_chain_is_its_widest() -> None:
    link = read(
        {
            "chain": [
                {"line": [[0, 0, 0], [1, 0, 0]]},
                {"line": [[1, 0, 0.5], [2, 0, 0]]},
                {"line": [[2, 0, 0], [3, 0, 0]]},
            ]
        }
    )
    assert largest_gap(link) == 0.5


def whole(link: Chain, v: float) -> Array:
    """Return the point of a chain at the whole parameter v."""
    i = max(k for k, b in enumerate(link.breaks[:-1]) if float(b) <= v)
    low, high = (float(b) for b in link.breaks[i : i + 2])
    return link.curves[i].jet(np.array([(v - low) / (high - low)]), 0)[0, 0]


@settings(max_examples=40)
@given(curves(), curves(), st.floats(0.01, 0.99))
def test_rulings_join_equal_parameters_whatever_the_breaks(a: object, b: object, v: float) -> None:
    c0, c1 = read(a), read(b)
    pieces = ruled_patches(c0, c1)
    breaks = [float(x) for x in sorted({*c0.breaks, *c1.breaks})]
    assert len(pieces) == len(breaks) - 1
    if min(abs(v - x) for x in breaks) < 1e-6:
        return
    i = max(k for k, x in enumerate(breaks[:-1]) if x <= v)
    place = np.array([(v - breaks[i]) / (breaks[i + 1] - breaks[i])])
    for u, link in ((0.0, c0), (1.0, c1)):
        here = at(pieces[i], np.array([u]), place)[0]
        assert_near(here, whole(link, v), bound=1e-11, why="points up to 50 mm, slopes up to 1e4 per unit of v")
