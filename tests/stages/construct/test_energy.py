"""Shape parameters of least strain energy: closed forms, 40 digits, invariances, and that nothing near is better."""

from dataclasses import replace
from fractions import Fraction
from math import comb, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mp, mpf

from stages.construct.energy import LEAST_ALPHA, Shape, least_energy
from stages.construct.quintic import ZERO, End, Vector, combine, directrix
from tests.near import assert_near, assert_relative
from tests.strategies import motions

NONE = Fraction(0)
FLAT = 1e-6
"""Shape parameters at a minimum found to rounding of the energy, 1e-15 of it, are off by some roots of that."""


def vec(*values: object) -> Vector:
    x, y, z = (Fraction(str(value)) for value in values)
    return x, y, z


def end(point: Vector, tangent: Vector, normal: Vector = ZERO, k: Fraction = NONE) -> End:
    return End(point, tangent, normal, k, NONE, NONE)


def with_shape(start: End, stop: End, x: list[Fraction]) -> tuple[End, End]:
    return replace(start, alpha=x[0], beta=x[2]), replace(stop, alpha=x[1], beta=x[3])


def energy(start: End, stop: End, x: list[Fraction]) -> Fraction:
    """Return the integral of |r''|^2, exact, from the control points of the curve as built."""
    rows = directrix(*with_shape(start, stop, x)).exact
    d = [[20 * (c - 2 * b + a) for a, b, c in zip(*rows[i : i + 3], strict=True)] for i in range(4)]
    return sum(
        (Fraction(comb(3, i) * comb(3, j), comb(6, i + j) * 7) * sum(p * q for p, q in zip(d[i], d[j], strict=True))
         for i in range(4) for j in range(4)), NONE)  # fmt: skip


def numbers(shape: Shape) -> list[Fraction]:
    return [Fraction(x) for x in (shape.alpha0, shape.alpha1, shape.beta0, shape.beta1)]


BENT = (end(vec(0, 0, 0), vec("0.6", "0.8", 0), vec("0.8", "-0.6", 0), Fraction(1, 200)),
        end(vec(120, 10, 30), vec("0.6", "-0.64", "0.48"), vec("-0.8", "-0.48", "0.36"), Fraction(1, 300)))  # fmt: skip


def test_a_straight_line_is_run_through_evenly() -> None:
    """T along the chord, k = 0: r = P0 + v (P1 - P0) has no energy: alpha is the chord, beta 0."""
    shape = least_energy(end(vec(1, 2, 3), vec("0.6", "0.8", 0)), end(vec(7, 10, 3), vec("0.6", "0.8", 0)))
    assert_near(numbers(shape), [10.0, 10.0, 0.0, 0.0], bound=10 * FLAT, why="a root of rounding")
    assert_near(shape.energy_mm2, 0.0, bound=1e-11, why="1e-13 of the square of the chord")
    assert shape.at_bound == ()


def test_a_symmetric_arch_without_curvature_has_its_closed_form() -> None:
    """T = (c, s) and (c, -s), k = 0, unit chord: alpha0 = alpha1 = a and beta0 = -beta1 = b by symmetry, and the energy
    is quadratic in a and b: two equations, in fractions.
    """
    c, s = Fraction(3, 5), Fraction(4, 5)
    gram = [[Fraction(comb(3, i) * comb(3, j), comb(6, i + j) * 7) for j in range(4)] for i in range(4)]

    def second(a: int, b: int, span: int) -> list[list[Fraction]]:
        A, B = Fraction(a), Fraction(b)
        first = [A * c / 5, A * s / 5]
        bend = [B * c / 20, B * s / 20]
        x = [0, first[0], 2 * first[0] + bend[0], span - 2 * first[0] - bend[0], span - first[0], Fraction(span)]
        y = [0, first[1], 2 * first[1] + bend[1], 2 * first[1] + bend[1], first[1], 0]
        return [[20 * (row[i + 2] - 2 * row[i + 1] + row[i]) for i in range(4)] for row in (x, y)]

    def product(p: list[list[Fraction]], q: list[list[Fraction]]) -> Fraction:
        return sum((gram[i][j] * p[axis][i] * q[axis][j] for axis in (0, 1) for i in range(4) for j in range(4)), NONE)

    fixed, of_a, of_b = second(0, 0, 1), second(1, 0, 0), second(0, 1, 0)
    aa, ab, bb = product(of_a, of_a), product(of_a, of_b), product(of_b, of_b)
    ra, rb = -product(of_a, fixed), -product(of_b, fixed)
    det = aa * bb - ab * ab
    a, b = (ra * bb - rb * ab) / det, (aa * rb - ab * ra) / det
    shape = least_energy(end(vec(0, 0, 0), vec(c, s, 0)), end(vec(1, 0, 0), vec(c, -s, 0)))
    assert_near(numbers(shape), [a, a, b, -b], bound=FLAT, why="a root of rounding")


def test_newtons_method_in_40_digits_ends_at_the_same_shape() -> None:
    """Second method: all four unknowns at once, slopes and bends by central differences of the exact energy."""
    shape = least_energy(*BENT)
    assert shape.at_bound == ()
    with mp.workdps(60):
        x = [mpf(float(value)) for value in numbers(shape)]
        for _ in range(2):
            x = _newton(x)
        assert_near(numbers(shape), [float(t) for t in x], bound=120 * FLAT, why="a root of rounding, of the chord")
        assert_relative([shape.energy_mm2], [float(_value(x))], bound=1e-12, why="the energy is flat at its least")


def _value(y: list[mpf]) -> mpf:
    exact = energy(*BENT, [Fraction(mp.nstr(t, 50)) for t in y])
    return mpf(exact.numerator) / exact.denominator


def _newton(x: list[mpf]) -> list[mpf]:
    step = mpf(10) ** -10
    slope, bend = mp.matrix(4, 1), mp.matrix(4, 4)
    along = [[step if k == i else mpf(0) for k in range(4)] for i in range(4)]

    def beside(*moves: tuple[int, int]) -> mpf:
        return _value([t + sum(sign * along[i][k] for i, sign in moves) for k, t in enumerate(x)])

    for i in range(4):
        slope[i] = (beside((i, 1)) - beside((i, -1))) / (2 * step)
        for j in range(4):
            same, across = beside((i, 1), (j, 1)), beside((i, 1), (j, -1))
            bend[i, j] = (same - across - beside((i, -1), (j, 1)) + beside((i, -1), (j, -1))) / (4 * step**2)
    return [a - d for a, d in zip(x, mp.lu_solve(bend, slope), strict=True)]


@pytest.mark.parametrize("pair", [
    BENT,
    (BENT[0], end(vec(40, 90, -20), vec(0, 0, 1), vec(1, 0, 0), Fraction(-1, 50))),
    (end(vec(0, 0, 0), vec(0, 1, 0)), end(vec(10, 0, 0), vec("0.8", "-0.6", 0), vec("0.6", "0.8", 0), Fraction(1))),
])  # fmt: skip
def test_no_shape_of_a_grid_has_less_energy(pair: tuple[End, End]) -> None:
    """Brute force: alpha over a grid, beta by least squares from exact energies."""
    shape = least_energy(*pair)
    chord = sqrt(sum(float(b - a) ** 2 for a, b in zip(pair[0].P, pair[1].P, strict=True)))
    assert_relative([float(energy(*pair, numbers(shape)))], [shape.energy_mm2], bound=1e-11, why="two evaluations")
    for a0 in np.geomspace(LEAST_ALPHA, 4.0, 8):
        for a1 in np.geomspace(LEAST_ALPHA, 4.0, 8):
            best = _best_over_beta(pair, Fraction(a0 * chord), Fraction(a1 * chord))
            assert best >= shape.energy_mm2 * (1.0 - 1e-8)


def _best_over_beta(pair: tuple[End, End], a0: Fraction, a1: Fraction) -> float:
    """Return the least energy for these alpha: a quadratic in beta, known from six exact values."""
    f = {
        (i, j): energy(*pair, [a0, a1, Fraction(i), Fraction(j)])
        for i, j in ((0, 0), (1, 0), (-1, 0), (0, 1), (0, -1), (1, 1))
    }
    gx, gy = (f[1, 0] - f[-1, 0]) / 2, (f[0, 1] - f[0, -1]) / 2
    xx, yy = f[1, 0] + f[-1, 0] - 2 * f[0, 0], f[0, 1] + f[0, -1] - 2 * f[0, 0]
    xy = f[1, 1] - f[1, 0] - f[0, 1] + f[0, 0]
    det = xx * yy - xy * xy
    return float(f[0, 0] - (gx * gx * yy - 2 * gx * gy * xy + gy * gy * xx) / (2 * det))


def test_tangents_that_point_away_from_the_chord_hold_alpha_at_its_bound() -> None:
    shape = least_energy(end(vec(0, 0, 0), vec(-1, 0, 0)), end(vec(50, 0, 0), vec(1, 0, 0)))
    assert shape.at_bound == ("alpha0",)
    assert_near(shape.alpha0, LEAST_ALPHA * 50, bound=1e-14, why="held there")
    free = energy(end(vec(0, 0, 0), vec(-1, 0, 0)), end(vec(50, 0, 0), vec(1, 0, 0)), numbers(shape))
    shorter = [Fraction(1), *numbers(shape)[1:]]
    assert energy(end(vec(0, 0, 0), vec(-1, 0, 0)), end(vec(50, 0, 0), vec(1, 0, 0)), shorter) < free


@settings(max_examples=15, deadline=None)
@given(motions(), st.sampled_from([Fraction(1, 100), Fraction(3), Fraction(80)]))
def test_moving_scaling_and_turning_the_curve_round_change_nothing(
    motion: tuple[tuple[Vector, ...], Vector], factor: Fraction
) -> None:
    matrix, shift = motion

    def image(vector: Vector) -> Vector:
        x, y, z = (sum((m * c for m, c in zip(row, vector, strict=True)), NONE) for row in matrix)
        return x, y, z

    def of(at: End) -> End:
        return End(combine((factor, image(at.P)), (1, shift)), image(at.T), image(at.N), at.k / factor, NONE, NONE)

    def back(at: End) -> End:
        return replace(at, T=combine((-1, at.T)))

    here, there = least_energy(*BENT), least_energy(of(BENT[0]), of(BENT[1]))
    scale = 120.0 * float(factor)
    why = "a root of rounding, of the chord"
    assert_near([x / factor for x in numbers(there)], numbers(here), bound=120 * FLAT, why=why)
    assert_relative([there.energy_mm2], [here.energy_mm2 * float(factor) ** 2], bound=1e-11, why="rounding")
    turned = least_energy(back(of(BENT[1])), back(of(BENT[0])))
    expected = [there.alpha1, there.alpha0, -there.beta1, -there.beta0]
    assert_near(numbers(turned), expected, bound=scale * FLAT, why=why)
