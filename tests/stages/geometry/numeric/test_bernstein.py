"""Exact polynomials: every operation against plain evaluation in fractions, at more places than the degree."""

from fractions import Fraction
from itertools import pairwise
from math import comb

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.arrays import EPS
from stages.geometry.numeric.bernstein import (
    Polynomial,
    add,
    cross,
    derivative,
    elevate,
    from_bernstein,
    halves,
    inner,
    lowered,
    multiply,
    ratio,
    rounded,
    subtract,
    vector_from_points,
    whole,
)
from tests.near import assert_near

FRACTIONS = st.fractions(min_value=-100, max_value=100, max_denominator=1000)
COEFFICIENTS = st.lists(FRACTIONS, min_size=1, max_size=7)
PLACES = [Fraction(k, 17) for k in range(18)]
"""Polynomials of degree up to 17 that agree at 18 places are equal."""


def by_de_casteljau(coefficients: list[Fraction], v: Fraction) -> Fraction:
    row = list(coefficients)
    while len(row) > 1:
        row = [(1 - v) * a + v * b for a, b in pairwise(row)]
    return row[0]


@settings(max_examples=30)
@given(COEFFICIENTS)
def test_a_polynomial_has_the_values_of_its_bernstein_coefficients(coefficients: list[Fraction]) -> None:
    f = from_bernstein(coefficients)
    assert all(f(v) == by_de_casteljau(coefficients, v) for v in PLACES)


@settings(max_examples=30)
@given(COEFFICIENTS, COEFFICIENTS)
def test_products_sums_and_differences_are_exact(a: list[Fraction], b: list[Fraction]) -> None:
    f, g = from_bernstein(a), from_bernstein(b)
    for v in PLACES:
        assert multiply(f, g)(v) == f(v) * g(v)
        assert add(f, g)(v) == f(v) + g(v)
        assert add(f, g, sign=-1)(v) == f(v) - g(v)


@settings(max_examples=30)
@given(COEFFICIENTS, st.integers(0, 4))
def test_elevation_changes_the_degree_and_no_value(coefficients: list[Fraction], more: int) -> None:
    f = from_bernstein(coefficients)
    raised = elevate(f, f.degree + more)
    assert raised.degree == f.degree + more
    assert all(raised(v) == f(v) for v in PLACES)


@settings(max_examples=30)
@given(COEFFICIENTS)
def test_the_derivative_is_that_of_the_monomials(coefficients: list[Fraction]) -> None:
    f = from_bernstein(coefficients)
    slope = derivative(f)
    monomials = _monomials(f)
    for v in PLACES:
        assert slope(v) == sum(i * c * v ** (i - 1) for i, c in enumerate(monomials) if i)


def _monomials(f: Polynomial) -> list[Fraction]:
    n = f.degree
    made = [Fraction(0)] * (n + 1)
    for i, c in enumerate(f.scaled):
        for j in range(n - i + 1):
            made[i + j] += Fraction(c, f.denominator) * comb(n - i, j) * (-1) ** j
    return made


POINTS = st.lists(st.tuples(FRACTIONS, FRACTIONS, FRACTIONS), min_size=1, max_size=5)


@settings(max_examples=30)
@given(POINTS, POINTS)
def test_vector_products_are_those_of_the_values(a: list[tuple[Fraction, ...]], b: list[tuple[Fraction, ...]]) -> None:
    f, g = vector_from_points(a), vector_from_points(b)
    for v in PLACES:
        x, y = [c(v) for c in f], [c(v) for c in g]
        assert [c(v) for c in subtract(f, g)] == [p - q for p, q in zip(x, y, strict=True)]
        assert inner(f, g)(v) == sum(p * q for p, q in zip(x, y, strict=True))
        assert [c(v) for c in cross(f, g)] == [
            x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0],
        ]  # fmt: skip


@settings(max_examples=30)
@given(COEFFICIENTS)
def test_a_degree_that_is_too_high_is_lowered_and_one_that_is_not_is_kept(coefficients: list[Fraction]) -> None:
    f = from_bernstein(coefficients)
    assert lowered(elevate(f, f.degree + 1)) == f
    if _monomials(f)[-1]:
        with pytest.raises(ValueError, match="full degree"):
            lowered(f)


@settings(max_examples=30)
@given(COEFFICIENTS.filter(any), COEFFICIENTS.filter(any), st.integers(-900, 900))
def test_quotients_in_floats_are_the_exact_ones_whatever_the_size(
    a: list[Fraction], b: list[Fraction], power: int
) -> None:
    scale = Fraction(10) ** power
    f, g = (_normal(from_bernstein([scale * x for x in row])) for row in (a, b))
    places = [Fraction(k, 16) for k in range(17)]
    found = ratio(rounded(f), rounded(g), np.array([float(v) for v in places]))
    for v, value in zip(places, found, strict=True):
        if abs(g(v)) > Fraction(1, 1000):
            exact = float(f(v) / g(v))
            bound = 64 * EPS * 1000 * (1 + abs(exact))
            assert_near(float(value), exact, bound=bound, why="seven terms of at most 1, a divisor above 1/1000")


def _normal(f: Polynomial) -> Polynomial:
    """Return f over the power of 2 by which `rounded` divides it."""
    return Polynomial(f.scaled, 1 << max(c.bit_length() for c in f.scaled))


@settings(max_examples=30)
@given(COEFFICIENTS, st.lists(st.booleans(), max_size=8))
def test_a_part_of_a_polynomial_is_bounded_by_its_coefficients(coefficients: list[Fraction], turns: list[bool]) -> None:
    f = from_bernstein(coefficients)
    piece, low, width = whole(f), Fraction(0), Fraction(1)
    for right in turns:
        piece, width = halves(piece)[right], width / 2
        low += width if right else 0
    scale = piece.denominator << piece.shift
    least, most = Fraction(min(piece.b), scale), Fraction(max(piece.b), scale)
    values = [f(low + width * v) for v in PLACES]
    assert all(least <= value <= most for value in values)
    assert (Fraction(piece.b[0], scale), Fraction(piece.b[-1], scale)) == (values[0], values[-1])


def test_a_polynomial_of_zeros_is_zero_and_a_tiny_one_is_not() -> None:
    assert from_bernstein([Fraction(0)] * 4).is_zero
    assert not from_bernstein([Fraction(0), Fraction(1, 10**40), Fraction(0)]).is_zero
