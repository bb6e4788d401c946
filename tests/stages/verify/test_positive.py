"""Proofs of sign, and least multiples, on polynomials whose extremes are known."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stages.geometry.numeric.bernstein import Polynomial, add, from_bernstein, multiply
from stages.verify.positive import least_multiple, proved_positive, root_above

ONE = Polynomial((1,))


def poly(*values: object) -> Polynomial:
    return from_bernstein([Fraction(str(value)) for value in values])


def test_positive_polynomials_are_proved_and_others_named_or_left_open() -> None:
    assert proved_positive(poly(1, -0.9, 1)) == (True, None)
    assert proved_positive(poly(1, -1, 1)) == (None, pytest.approx(0.5, abs=1e-9))
    state, where = proved_positive(poly(1, -1.0001, 1))
    assert state is False
    assert where is not None
    assert abs(where - 0.5) < 0.01
    assert proved_positive(poly(0, 1, 1))[0] is None


@pytest.mark.parametrize("margin", ["1e-6", "1e-12", "1e-20"])
def test_a_narrow_miss_of_zero_is_proved_and_a_narrow_dip_is_found(margin: str) -> None:
    """(v - 1/3)^2 +- margin."""
    a = Fraction(1, 3)
    near = [a * a, -a * (1 - a), (1 - a) ** 2]
    assert proved_positive(from_bernstein([c + Fraction(margin) for c in near])) == (True, None)
    state, where = proved_positive(from_bernstein([c - Fraction(margin) for c in near]))
    assert state is False
    assert where is not None
    assert (Fraction(where) - a) ** 2 < Fraction(margin)


@pytest.mark.parametrize("place", [0, "0.3", "1/3", "0.999", 1])
def test_the_least_multiple_of_a_parabola_is_its_peak(place: object) -> None:
    a = Fraction(str(place))
    top = from_bernstein([1 - a * a, 1 + a * (1 - a), 1 - (1 - a) ** 2])  # 1 - (v - a)^2
    t, v = least_multiple((top,), ONE)
    assert t is not None
    assert 1 <= t <= 1 + Fraction("1.1e-10")
    assert abs(Fraction(v) - a) < Fraction("1e-7")


def test_a_peak_that_no_sampling_meets_is_climbed() -> None:
    """1 / ((v - a)^2 + 1e-12) is 1e12 high and 1e-6 wide; beside it 1 at both ends of a valley."""
    a = Fraction(1, 3) + Fraction("1e-4")
    below = from_bernstein([c + Fraction("1e-16") for c in (a * a, -a * (1 - a), (1 - a) ** 2)])
    t, v = least_multiple((ONE,), below)
    assert t is not None
    assert 10**16 <= t <= 4 * 10**16
    assert abs(Fraction(v) - a) < Fraction("1e-8")


def test_a_peak_hidden_below_a_broad_one_is_met_by_the_proof_and_climbed() -> None:
    """1 - (v - 4/5)^2 + 1e-15 / ((v - a)^2 + 1e-16): ten high, 1e-8 wide, and 1e-9 high where sampling passes by."""
    a = Fraction(1, 3) + Fraction("1e-4")
    below = from_bernstein([c + Fraction("1e-16") for c in (a * a, -a * (1 - a), (1 - a) ** 2)])
    broad = from_bernstein([1 - Fraction("0.64"), 1 + Fraction("0.16"), 1 - Fraction("0.04")])
    t, v = least_multiple((add(multiply(below, broad), Polynomial((1,), 10**15)),), below)
    exact = 1 - (a - Fraction(4, 5)) ** 2 + 10
    assert t is not None
    assert exact <= t <= exact * (1 + Fraction("1e-3")), "so near a double root floats keep few digits"
    assert abs(Fraction(v) - a) < Fraction("1e-8")


def test_both_signs_are_bounded_by_the_larger() -> None:
    top = poly(-3, 0, 2)
    t, v = least_multiple((top, multiply(top, Polynomial((-1,)))), ONE)
    assert t is not None
    assert 3 <= t <= 3 + Fraction("1e-9")
    assert v == 0.0


def test_what_cannot_be_bounded_is_not() -> None:
    assert least_multiple((ONE,), poly(1, 0, 0))[0] is None


@given(st.fractions(min_value=Fraction(1, 10**30), max_value=10**30), st.integers(-1000, 1000))
def test_the_root_is_above_and_near(t: Fraction, power: int) -> None:
    t *= Fraction(2) ** power
    root = root_above(t)
    assert t <= root**2 <= t * (1 + Fraction(1, 2**50))
