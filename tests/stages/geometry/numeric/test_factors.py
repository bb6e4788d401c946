"""Common factors and roots: found again after they were put in, and nothing found that is not there."""

from fractions import Fraction
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.numeric.bernstein import Polynomial, elevate, from_bernstein, multiply
from stages.geometry.numeric.factors import (
    ONE,
    common_factor,
    divided_by,
    multiplicity,
    quotient,
    roots_inside,
    sign_changes,
    square_free,
)

WHOLE = st.lists(st.integers(-(10**9), 10**9), min_size=1, max_size=6).filter(any)
ROOTS = st.lists(st.fractions(Fraction(1, 97), Fraction(96, 97), max_denominator=97), max_size=3, unique=True)
NO_REAL_ROOT = Polynomial((1, -1, 1))
"""t^2 - t + 1."""


def from_roots(roots: dict[Fraction, int]) -> Polynomial:
    """Return the polynomial with these roots, each as often as said; v - a is -a (1 - v) + (1 - a) v."""
    f = ONE
    for a, order in roots.items():
        for _ in range(order):
            f = multiply(f, Polynomial((-a.numerator, a.denominator - a.numerator)))
    return f


@settings(max_examples=60, deadline=None)
@given(WHOLE, WHOLE, WHOLE, st.integers(0, 2), st.integers(0, 2))
def test_a_factor_put_into_all_is_found_in_all(a: list[int], b: list[int], g: list[int], front: int, back: int) -> None:
    shared = Polynomial((0,) * front + tuple(g) + (0,) * back)
    f, h = (multiply(shared, Polynomial(tuple(row))) for row in (a, b))
    found = common_factor((f, h))
    for other in (f, h):
        assert multiply(quotient(other, found), found) == other
    primitive = common_factor((shared,))
    assert multiply(quotient(found, primitive), primitive) == found, "what was put in divides what was found"


@settings(max_examples=40, deadline=None)
@given(ROOTS, ROOTS)
def test_the_common_factor_holds_the_common_roots_and_no_other(a: list[Fraction], b: list[Fraction]) -> None:
    f, g = (multiply(from_roots(dict.fromkeys(roots, 1)), NO_REAL_ROOT) for roots in (a, b))
    expected = multiply(from_roots(dict.fromkeys(sorted(set(a) & set(b)), 1)), NO_REAL_ROOT)
    found = common_factor((f, g))
    assert found.scaled in (expected.scaled, tuple(-c for c in expected.scaled))


def test_polynomials_that_vanish_do_not_count_and_a_degree_too_high_is_a_common_factor() -> None:
    zero, f = Polynomial((0, 0)), Polynomial((2, 4, 6))
    assert common_factor((zero, f)).scaled == (1, 2, 3)
    assert common_factor((zero, zero)) == ONE
    assert common_factor((elevate(Polynomial((1, 5)), 3), elevate(Polynomial((2, 3)), 4))).scaled == (1, 2, 1)


def test_a_leading_coefficient_that_the_prime_divides_hides_no_factor() -> None:
    prime = 2**61 - 1
    shared = Polynomial((1, prime))
    f, g = multiply(shared, Polynomial((1, 1))), multiply(shared, Polynomial((3, 1)))
    assert common_factor((f, g)) == shared
    assert common_factor((Polynomial((1, prime)), Polynomial((2, prime)))) == ONE


def test_what_is_no_factor_is_refused_and_not_divided() -> None:
    for f, g in (((1, 3, 3), (1, 1)), ((0, 1), (1, 1)), ((1, 2), (0, 1)), ((1, 2, 3), (1, 2, 0))):
        with pytest.raises(ValueError, match="not a factor"):
            quotient(Polynomial(f), Polynomial(g))
    halves = Polynomial((1, 2, 1), 6)
    assert divided_by((halves, Polynomial((0, 0))), Polynomial((1, 1))) == (Polynomial((1, 1), 6), Polynomial((0,)))


ORDERS = st.dictionaries(
    st.fractions(Fraction(1, 97), Fraction(96, 97), max_denominator=97), st.integers(1, 4), max_size=3
)


@settings(max_examples=40, deadline=None)
@given(ORDERS, st.integers(0, 2), st.integers(0, 2))
def test_roots_inside_are_isolated_with_how_often_they_count(
    orders: dict[Fraction, int], front: int, back: int
) -> None:
    f = multiply(from_roots(orders), NO_REAL_ROOT)
    f = Polynomial((0,) * front + f.scaled + (0,) * back)
    found = roots_inside(f)
    assert len(found) == len(orders)
    split = square_free(f)
    for (low, high), root in zip(found, sorted(orders), strict=True):
        assert low <= root <= high <= low + Fraction(1, 2**50)
        assert multiplicity(split, (low, high)) == orders[root]
    others = square_free(from_roots({Fraction(98, 99): 1}))
    assert all(multiplicity(others, interval) == 0 for interval in found)


@pytest.mark.parametrize("gap", ["1e-3", "1e-12", "1e-30"])
def test_roots_that_nearly_coincide_are_told_apart(gap: str) -> None:
    a = Fraction(1, 3)
    f = from_roots({a: 1, a + Fraction(gap): 1, Fraction(1, 2): 2})
    found = roots_inside(f)
    places = (a, a + Fraction(gap), Fraction(1, 2))
    assert all(low <= place <= high for (low, high), place in zip(found, places, strict=True))
    assert all(right[0] >= left[1] for left, right in pairwise(found)), "no interval overlaps the next"


def test_irrational_roots_are_found_and_a_near_miss_is_not() -> None:
    half = from_bernstein([Fraction(-1, 2), Fraction(-1, 2), Fraction(1, 2)])  # v^2 - 1/2
    (root,) = roots_inside(multiply(half, half))
    assert float(root[0]) == pytest.approx(0.5**0.5, abs=1e-15)
    assert multiplicity(square_free(multiply(half, half)), root) == 2
    missed = from_bernstein([Fraction(1), Fraction(-1) + Fraction(1, 10**30), Fraction(1)])
    assert roots_inside(missed) == []
    assert not roots_inside(Polynomial((0, 0, 5, 0)))


@settings(max_examples=30, deadline=None)
@given(ORDERS, WHOLE)
def test_square_free_factors_multiply_to_the_whole_and_repeat_nothing(
    orders: dict[Fraction, int], row: list[int]
) -> None:
    f = multiply(from_roots(orders), multiply(Polynomial(tuple(row)), NO_REAL_ROOT))
    rest = f
    for order, factor in square_free(f).items():
        assert set(square_free(factor)) == {1}
        for _ in range(order):
            rest = quotient(rest, factor)
    assert sum(map(bool, rest.scaled)) == 1, "nothing but a number and factors v and 1 - v is left"


def test_sign_changes_pass_over_zeros() -> None:
    assert [sign_changes(row) for row in ((1, 0, -1), (0, 0), (1, 2), (-1, 0, 0, 2, -3))] == [1, 0, 0, 2]
