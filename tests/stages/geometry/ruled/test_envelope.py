"""Rulings of envelopes: the Frenet apparatus in 40 digits, closed forms on known developables, a strap two ways."""

from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import atan, cos, pi, sin, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from mpmath import mp, mpf

from stages.geometry.arrays import Array, ArrayValue, Values, cross3, dot, norm, unit
from stages.geometry.curves.curves import Circular, Curve, affine, bezier, exactly, restrict
from stages.geometry.numeric.series import derivatives, inner, outer, scaled, slope, taylor
from stages.geometry.ruled.envelope import (
    Beside,
    Conjugate,
    Rectifying,
    bend,
    closing,
    crossing_sine,
    multiple,
    normal_share,
    room,
    swept,
    turn,
)
from stages.geometry.ruled.ruled import RuledPatch, frames, regression, warp
from tests import oracles
from tests.near import assert_near, assert_relative
from tests.strategies import Motion, motions

V = np.linspace(0.0, 1.0, 7)
X, Y, Z = np.eye(3)
ROWS = [[0, 0, 0], [1, 0.25, 0], [2, 1, 0.5], [2.5, 2.5, 1], [2, 3.5, 2.5], [1, 4, 4]]


def quintic(size: float = 1.0) -> Curve:
    return bezier([exactly([size * x for x in row]) for row in ROWS])


def helix(radius: float, rise: float, sweep: float) -> Circular:
    """Return a helix about z that rises by `rise` per radian."""
    return Circular(np.zeros(3), radius * X, radius * Y, rise * Z, 0.0, sweep)


@dataclass(frozen=True, slots=True, eq=False)
class Principal(ArrayValue):
    """r' x (r' x r''), against the principal normal."""

    curve: Curve

    def jet(self, v: Values, order: int) -> Array:
        r1 = slope(taylor(self.curve.jet(v, order + 2)))
        return derivatives(outer(r1, outer(r1, slope(r1)))[: order + 1])


# Rectifying


def frenet_ruling(rows: list[list[object]], v: mpf) -> list[mpf]:
    """Return B + (tau / kappa) T of a Bezier curve, from kappa and tau as the books have them."""
    position = oracles.bezier(rows)
    third = oracles.bezier_of([tuple(oracles.exact(x) for x in row) for row in _differences(rows, 3)])
    _, r1, r2 = position(v)
    r3 = third(v)[0]
    b, speed = oracles.cross(r1, r2), oracles.norm(r1)
    kappa, tau = oracles.norm(b) / speed**3, oracles.dot(b, r3) / oracles.dot(b, b)
    return [x / oracles.norm(b) + tau / kappa * t / speed for x, t in zip(b, r1, strict=True)]


def _differences(rows: list[list[object]], order: int) -> list[list[Fraction]]:
    found = [[Fraction(str(x)) for x in row] for row in rows]
    for _ in range(order):
        n = len(found) - 1
        found = [[n * (b - a) for a, b in zip(p, q, strict=True)] for p, q in pairwise(found)]
    return found


@pytest.mark.parametrize("size", [1.0, 4096.0])
def test_rulings_of_a_strap_and_four_derivatives_are_those_of_the_frenet_apparatus(size: float) -> None:
    jets = Rectifying(quintic(size)).jet(V, 4)
    for i, v in enumerate(V):
        for axis in range(3):
            series = mp.taylor(lambda x, axis=axis: frenet_ruling(ROWS, x)[axis], mpf(float(v)), 4)
            wanted = [float(c * mp.factorial(k)) for k, c in enumerate(series)]
            bounds = 1e-13 * np.array([1.0, 1e1, 1e2, 1e3, 1e4])
            assert_near(
                jets[:, i, axis] / bounds,
                wanted / bounds,
                bound=1.0,
                why="rounding; each order is ten times larger",
            )


def test_a_helix_gives_the_cylinder_that_it_winds_about() -> None:
    g = Rectifying(helix(3.0, 4.0 / (2.0 * pi), 7.0)).jet(V, 1)
    assert_near(norm(cross3(g[0], np.tile(Z, (V.size, 1)))), np.zeros(V.size), bound=1e-14, why="parallel to the axis")
    assert_near(g[1], np.zeros((V.size, 3)), bound=1e-13, why="tau / kappa is constant")


def test_both_ways_to_a_strap_agree() -> None:
    """The envelope of the planes across the principal normal is the rectifying developable."""
    curve = quintic()
    straight, conjugate = Rectifying(curve).jet(V, 3), Conjugate(curve, Principal(curve)).jet(V, 3)
    for k in range(4):
        scale = max(1.0, float(np.abs(straight[k]).max()))
        assert_near(conjugate[k] / scale, straight[k] / scale, bound=1e-11, why="derivatives one order higher, squared")


# Conjugate


def test_the_normals_of_a_cylinder_along_a_helix_give_the_cylinder() -> None:
    radius, rise = 3.0, 0.8
    curve, normal = helix(radius, rise, 4.0), Circular(np.zeros(3), X, Y, 0.0 * Z, 0.0, 4.0)
    g = Conjugate(curve, normal).jet(V, 2)
    steep = cos(atan(rise / radius))
    assert_near(g[0], np.tile(Z / steep, (V.size, 1)), bound=1e-14, why="1 across the helix, parallel to the axis")
    assert_near(g[1:], np.zeros((2, V.size, 3)), bound=1e-13, why="constant")
    assert_near(room([curve], [Conjugate(curve, normal)])[0].width_mm ** -1, 0.0, bound=1e-13, why="no edge")


SLOPE = 0.6
"""Radius of the cone x^2 + y^2 = (SLOPE z)^2 per height."""


def on_a_cone() -> tuple[Curve, Curve]:
    """Return an ellipse cut from a cone about z by a plane that leans by 0.3, and the cone's normals along it.

    With z = h + 0.3 x on the cone: x = m + a cos, y = b sin.  The normal is the gradient (x, y, -SLOPE^2 z).
    """
    lean, height = 0.3, 5.0
    k = SLOPE**2
    below = 1.0 - k * lean**2
    middle = k * height * lean / below
    a = sqrt((k * height**2 + k**2 * height**2 * lean**2 / below) / below)
    b = a * sqrt(below)
    curve = Circular(
        np.array([middle, 0.0, height + lean * middle]), np.array([a, 0.0, lean * a]), b * Y, 0.0 * Z, 0.2, 5.0
    )
    rows = np.diag([1.0, 1.0, -k])
    return curve, affine(curve, [exactly(row) for row in rows], exactly([0.0, 0.0, 0.0]))


def test_the_normals_of_a_cone_along_an_oblique_section_give_the_cone() -> None:
    curve, normal = on_a_cone()
    r, g = curve.jet(V, 1), Conjugate(curve, normal).jet(V, 0)[0]
    assert_near(dot(r[0, :, :2], r[0, :, :2]), (SLOPE * r[0, :, 2]) ** 2, bound=1e-13, why="the test's own section")
    assert_near(norm(cross3(unit(g), unit(r[0]))), np.zeros(V.size), bound=1e-14, why="through the apex")
    side = dot(g, cross3(unit(normal.jet(V, 0)[0]), unit(r[1])))
    assert_near(side, np.ones(V.size), bound=1e-13, why="1 across the curve, left of travel")
    towards = -1.0 / closing(curve, Conjugate(curve, normal), V)
    assert_relative(r[0] + towards[:, None] * g + 9.0, np.full_like(r[0], 9.0), bound=1e-13, why="the edge is the apex")


@pytest.mark.parametrize("scale", [1.0, -1.0, 1e-6, 1e6])
def test_the_length_of_the_normals_does_not_count(scale: float) -> None:
    """Turned over, they exchange left and right."""
    curve, normal = on_a_cone()
    a, b = Conjugate(curve, normal).jet(V, 2), Conjugate(curve, multiple(normal, scale)).jet(V, 2)
    assert_near(b, np.sign(scale) * a, bound=1e-12, why="derivatives below 100, rounding")


def test_normals_that_lean_along_the_curve_are_made_perpendicular() -> None:
    curve, normal = on_a_cone()
    tilted = Beside(normal, Tangent(curve), 0.05)
    assert_near(
        Conjugate(curve, tilted).jet(V, 1), Conjugate(curve, normal).jet(V, 1), bound=1e-11, why="T is taken off again"
    )


@dataclass(frozen=True, slots=True, eq=False)
class Tangent(ArrayValue):
    """r' of a curve."""

    curve: Curve

    def jet(self, v: Values, order: int) -> Array:
        return self.curve.jet(v, order + 1)[1:]


# Patches


@given(motions())
@settings(max_examples=20)
def test_a_moved_curve_has_the_moved_rulings(motion: Motion) -> None:
    matrix, shift = motion
    turned = np.array([[float(x) for x in row] for row in matrix])
    curve = quintic()
    there = affine(curve, matrix, shift)
    away = max(1.0, *(abs(float(x)) for x in shift))
    ruling = Rectifying(curve)
    assert_near(
        Rectifying(there).jet(V, 2), ruling.jet(V, 2) @ turned.T, bound=2e-12 * away,
        why="control points are rounded far from the origin; second derivatives are below 1000",
    )  # fmt: skip
    image = affine(Beside(curve, ruling, 0.2), matrix, shift).jet(V, 1)
    assert_near(image, Beside(there, Rectifying(there), 0.2).jet(V, 1), bound=2e-12 * away, why="the same")
    zero = (Fraction(0),) * 3
    again = affine(affine(ruling, matrix, zero), tuple(zip(*matrix, strict=True)), zero).jet(V, 1)
    assert_near(again, ruling.jet(V, 1), bound=1e-13, why="there and back")


@pytest.mark.parametrize("low, high", [(Fraction(1, 4), Fraction(3, 4)), (Fraction(1), Fraction(0))])
def test_parts_and_reversals_are_the_same_surface(low: Fraction, high: Fraction) -> None:
    curve, normal = on_a_cone()
    at = float(low) + V * float(high - low)
    for ruling, line in ((Rectifying(quintic()), quintic()), (Conjugate(curve, normal), curve)):
        for whole in (ruling, Beside(line, ruling, 0.2), multiple(ruling, 3.0)):
            part, width = restrict(whole, low, high).jet(V, 3), float(high - low)
            for k in range(4):
                scale = max(1.0, float(np.abs(whole.jet(at, k)[k]).max()))
                assert_near(
                    part[k] / scale, width**k * whole.jet(at, k)[k] / scale, bound=1e-11, why="rounding of derivatives"
                )


def strap(curve: Curve, half: float) -> RuledPatch:
    return swept(curve, Rectifying(curve), -half, half)


@pytest.mark.parametrize("half", [0.01, 0.2])
def test_swept_patches_are_developable_to_rounding(half: float) -> None:
    curve, normal = on_a_cone()
    for patch in (strap(quintic(), half), swept(curve, Conjugate(curve, normal), half, -half)):
        assert_near(warp(patch, np.linspace(0.0, 1.0, 99)), np.zeros(99), bound=1e-11, why="rounding of p . (c0' x p')")


def test_the_room_of_a_strap_ends_where_the_edge_of_regression_comes_in() -> None:
    curve = quintic()
    along, against = room([curve], [Rectifying(curve)])
    for widest, sign in ((along, 1.0), (against, -1.0)):
        edge = swept(curve, Rectifying(curve), 0.0, sign * widest.width_mm)
        u = regression(frames(edge, np.linspace(0.0, 1.0, 2001)))
        reached = u[u > 0.0].min()
        assert_near(reached, 1.0, bound=1e-5, why="the smallest of 2001 samples, beside the true one by their spacing")
        assert reached >= 1.0 - 1e-12
        assert warp(swept(curve, Rectifying(curve), 0.0, 1.01 * sign * widest.width_mm), np.array([widest.v]))[0] > 3.0
        assert warp(swept(curve, Rectifying(curve), 0.0, 0.99 * sign * widest.width_mm), np.array([widest.v]))[0] < 1e-9


# What is measured before anything is divided


def test_measures_have_their_closed_forms_on_a_helix() -> None:
    radius, rise = 3.0, 0.8
    curve, normal = helix(radius, rise, 4.0), Circular(np.zeros(3), 2.0 * X, 2.0 * Y, 0.0 * Z, 0.0, 4.0)
    speed = sqrt(radius**2 + rise**2)
    assert_near(bend(curve, V), np.full(V.size, radius / speed**2), bound=1e-15, why="a / (a^2 + b^2)")
    assert_near(normal_share(curve, normal, V), np.full(V.size, 2.0), bound=1e-15, why="across already")
    assert_near(turn(curve, normal, V), np.full(V.size, 1.0 / speed), bound=1e-15, why="one rad per rad")
    angle = np.full(V.size, sin(pi / 2.0 - atan(rise / radius)))
    assert_near(crossing_sine(curve, normal, V), angle, bound=1e-14, why="rulings along z")


def test_a_normal_that_turns_about_the_curve_has_its_ruling_along_it() -> None:
    line = bezier([exactly([0.0, 0.0, 0.0]), exactly([0.0, 0.0, 5.0])])
    normal = Circular(np.zeros(3), X, Y, 0.0 * Z, 0.0, 2.0)
    assert_near(crossing_sine(line, normal, V), np.zeros(V.size), bound=0.0, why="r'' = 0")
    assert_near(turn(line, normal, V), np.full(V.size, 0.4), bound=1e-15, why="2 rad over 5 mm")


def test_a_dropped_term_of_the_ruling_is_seen_as_warp() -> None:
    """Planted: tau / kappa off by one part in a million turns a strap into a surface that is not developable."""
    curve = quintic()
    off = Beside(Rectifying(curve), scaled_lean(curve), 1e-6)
    assert warp(swept(curve, off, -0.2, 0.2), V).max() > 1e-9


def scaled_lean(curve: Curve) -> Curve:
    @dataclass(frozen=True, slots=True, eq=False)
    class Lean(ArrayValue):
        def jet(self, v: Values, order: int) -> Array:
            g, r1 = taylor(Rectifying(curve).jet(v, order)), slope(taylor(curve.jet(v, order + 1)))
            return derivatives(scaled(inner(g, r1), r1))

    return Lean()
