"""Curves at a share of the way along rulings: derivatives of 40 digits, images, parts, and rulings between two."""

from fractions import Fraction

import numpy as np
from mpmath import cos, mp, mpf, sin, taylor

from stages.geometry.arrays import EPS
from stages.geometry.curves.curves import Circular, affine, restrict
from stages.geometry.curves.stepped import Share, Stepped, constant
from tests.near import assert_near

ROUND = Circular(np.zeros(3), np.array([3.0, 0, 0]), np.array([0, 3.0, 0]), np.zeros(3), 0.0, 2.0 * np.pi)
TO_APEX = Circular(np.array([0, 0, 4.0]), np.array([-3.0, 0, 0]), np.array([0, -3.0, 0]), np.zeros(3), 0.0, 2.0 * np.pi)
CUT = Share(
    Circular(np.array([1.5, 0, 0]), np.array([0.75, 0, 0]), np.zeros(3), np.zeros(3), 0.0, 2.0 * np.pi),
    Circular(np.array([4.0, 0, 0]), np.array([0.75, 0, 0]), np.zeros(3), np.zeros(3), 0.0, 2.0 * np.pi),
)
EDGE = Stepped(ROUND, TO_APEX, CUT)
NEAR = Stepped(ROUND, TO_APEX, constant(Fraction(1, 8)))
PLACES = np.array([0.0, 0.1, 0.37, 0.5, 0.9, 1.0])
STEP_BOUND = 64 * EPS * 5.0
"""A few roundings of the slant; of derivative k, times its rate (2 pi)^k."""


def wanted(v: mpf, axis: int) -> mpf:
    a = 2 * mp.pi * v
    share = (mpf("1.5") + mpf("0.75") * cos(a)) / (4 + mpf("0.75") * cos(a))
    return [3 * cos(a) * (1 - share), 3 * sin(a) * (1 - share), 4 * share][axis]


def test_derivatives_are_those_of_the_quotient() -> None:
    jets = EDGE.jet(PLACES, 4)
    for i, v in enumerate(PLACES):
        for axis in range(3):
            with mp.workdps(40):
                series = taylor(lambda x, axis=axis: wanted(x, axis), mpf(float(v)), 4)
            for k in range(5):
                exact = float(series[k] * mp.factorial(k))
                assert_near(jets[k, i, axis], exact, bound=STEP_BOUND * (2.0 * np.pi) ** k, why="products of series")


def test_an_image_is_the_image_of_every_point() -> None:
    matrix = [[Fraction(0), Fraction(-1), Fraction(0)], [Fraction(1), Fraction(0), Fraction(0)],
              [Fraction(0), Fraction(0), Fraction(2)]]  # fmt: skip
    shift = [Fraction(5), Fraction(0), Fraction(-1)]
    turned = affine(EDGE, matrix, shift).jet(PLACES, 2)
    rows = np.array([[float(x) for x in row] for row in matrix])
    plain = EDGE.jet(PLACES, 2) @ rows.T
    plain[0] += [5.0, 0.0, -1.0]
    assert_near(turned, plain, bound=64 * EPS * 5.0 * (2.0 * np.pi) ** 2, why="another order of products")


def test_a_part_is_the_same_curve_over_its_interval() -> None:
    low, high = Fraction(1, 4), Fraction(7, 8)
    half = restrict(EDGE, low, high).jet(PLACES, 3)
    whole = EDGE.jet(0.25 + 0.625 * PLACES, 3) * np.array([0.625**k for k in range(4)])[:, None, None]
    assert_near(half, whole, bound=64 * EPS * 5.0 * (2.0 * np.pi) ** 3, why="the angle is rounded once more")


def test_rulings_between_two_edges_are_their_difference() -> None:
    none = affine(ROUND, [(Fraction(0),) * 3] * 3, (Fraction(0),) * 3)
    p = Stepped(none, TO_APEX, CUT, NEAR.share)
    difference = EDGE.jet(PLACES, 3) - NEAR.jet(PLACES, 3)
    assert_near(p.jet(PLACES, 3), difference, bound=64 * EPS * 5.0 * (2.0 * np.pi) ** 3, why="summed otherwise")


def test_where_the_shares_are_equal_the_ruling_is_nothing() -> None:
    none = affine(ROUND, [(Fraction(0),) * 3] * 3, (Fraction(0),) * 3)
    assert not Stepped(none, TO_APEX, CUT, CUT).jet(PLACES, 2).any()
