from fractions import Fraction
from math import pi

import numpy as np
import pytest
from mpmath import mp, mpf

from stages.geometry.arrays import norm
from stages.geometry.curves import contours
from stages.geometry.flat.development import develop
from stages.geometry.flat.mapped import FlatStrip, images
from stages.geometry.ruled.drill import drilled
from stages.geometry.ruled.ruled import RuledPatch, part
from stages.geometry.ruled.strip import Strip, points
from tests.near import assert_near, assert_relative
from tests.parts import OBLIQUE_CONE, QUINTIC_TANGENT, RIGHT_FRUSTUM, Table, patches

HALF_TUBE: Table = {
    "kind": "cylinder", "direction": [0, 0, 1], "length": 100,
    "directrix": {"arc": {"center": [0, 0, 0], "radius": 40, "start": 0, "end": 180}},
}  # fmt: skip
PLANE: Table = {"kind": "ruled", "c0": {"bezier": [[0, 0, 0], [30, -10, 0], [100, 0, 0]]},
                "c1": {"bezier": [[0, 60, 0], [40, 90, 0], [130, 70, 0]]}}  # fmt: skip


def strip_of(some: tuple[RuledPatch, ...]) -> tuple[Strip, FlatStrip]:
    knots = np.arange(len(some) + 1.0)
    return Strip(some, knots), FlatStrip(develop(some).pieces, knots)


def drilled_area(some: tuple[RuledPatch, ...], place: tuple[float, float], radius: float) -> float:
    strip, flat = strip_of(some)
    hole = drilled(strip, np.array(place), radius)
    assert hole is not None
    return contours.area(images(flat, [hole]))


def test_a_drill_through_a_plane_makes_a_circle() -> None:
    strip, flat = strip_of(patches(PLANE))
    hole = drilled(strip, np.array([0.5, 0.4]), 12.0)
    assert hole is not None
    edges = images(flat, [hole])
    middle = flat.positions(np.array([0.5]), np.array([0.4]))[0]
    t = np.linspace(0.0, 1.0, 201)
    assert_near(norm(edges[0].at(t) - middle), np.full(t.size, 12.0), bound=1e-11, why="a flat map of 130 mm")
    assert_relative(contours.area(edges), pi * 144.0, bound=1e-12, why="closed form")


@pytest.mark.parametrize("radius", [0.5, 10.0, 39.0, 39.99])
def test_a_drill_through_a_tube_leaves_the_unrolled_crossing_of_two_cylinders(radius: float) -> None:
    """On the tube z^2 + (R sin a)^2 = r^2, so the hole is 2 sqrt(r^2 - R^2 sin^2 a) high at the length R a."""
    r, R = mpf(radius), mpf(40)
    # r sin s = R sin a takes the root out of the ends
    area = mp.quad(
        lambda s: 2 * r**2 * mp.cos(s) ** 2 / mp.sqrt(1 - (r * mp.sin(s) / R) ** 2), [-mp.pi / 2, 0, mp.pi / 2]
    )
    found = drilled_area(patches(HALF_TUBE), (0.5, 0.5), radius)
    assert_relative(abs(found), float(area), bound=2e-12, why="40 digits; steep walls near r = R")


@pytest.mark.parametrize(("table", "place", "radius"), [(QUINTIC_TANGENT, (0.5, 0.4), 30.0),
                                                        (OBLIQUE_CONE, (0.4, 0.3), 0.4),
                                                        (RIGHT_FRUSTUM, (0.5, 0.5), 0.7)])  # fmt: skip
def test_every_point_of_a_drilled_hole_is_on_the_cylinder(
    table: Table, place: tuple[float, float], radius: float
) -> None:
    strip, _ = strip_of(patches(table))
    hole = drilled(strip, np.array(place), radius)
    assert hole is not None
    t = np.linspace(0.0, 1.0, 333)
    at = hole.at(t)
    off = (points(strip, at[:, 0], at[:, 1]) - hole.centre) @ hole.axes.T
    assert_relative(norm(off), np.full(t.size, radius), bound=1e-11, why="the last Newton step squared")
    step = 1e-5
    slopes = (hole.at(t[1:-1] + step) - hole.at(t[1:-1] - step)) / (2.0 * step)
    scale = float(np.abs(slopes).max())
    assert_near(hole.derivative(t[1:-1]), slopes, bound=1e-7 * scale, why="differences: step^2, and 1e-15 / step")


def test_a_joint_under_the_drill_changes_nothing() -> None:
    (whole,) = patches(QUINTIC_TANGENT)
    cut = Fraction(2, 5)
    halves = (part(whole, Fraction(0), cut), part(whole, cut, Fraction(1)))
    strip, flat = strip_of(halves)
    hole = drilled(strip, np.array([0.5, 1.05]), 30.0)
    assert hole is not None
    edges = images(flat, [hole])
    assert len(edges) == 3, "the circle begins on one side and passes the joint twice"
    expected = drilled_area((whole,), (0.5, float(cut) + 0.05 * 0.6), 30.0)
    assert_relative(contours.area(edges), expected, bound=1e-11, why="the same curve in other parameters")


@pytest.mark.parametrize(("place", "radius"), [((0.5, 0.5), 40.5), ((0.95, 0.5), 8.0), ((0.5, 0.02), 8.0)])
def test_a_drill_that_leaves_the_surface_makes_no_hole(place: tuple[float, float], radius: float) -> None:
    strip, _ = strip_of(patches(HALF_TUBE))
    assert drilled(strip, np.array(place), radius) is None
    assert drilled(strip, np.array([0.5, 0.5]), 8.0) is not None
