"""The paper's directrix (2.2) and its theorems, in exact fractions against the paper's explicit formulas."""

from fractions import Fraction
from itertools import pairwise, product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.construct.quintic import End, cone_over, directrix, length_exact, patch_between, unit_exact
from stages.construct.theorems import coefficients_a, coefficients_c
from stages.geometry.ruled.ruled import RuledPatch
from tests.parts import EXAMPLE_2_CYLINDER, QUINTIC_TANGENT, patches
from tests.strategies import decimals, points

Vec = tuple[Fraction, ...]
Data = tuple[Vec, Vec, Vec, Fraction, Fraction, Fraction]
"""P, T, N, k, alpha, beta of one end."""


def end_values() -> st.SearchStrategy[Data]:
    number = decimals(-3, 3, 2)
    return st.tuples(points(), points(), points(), number, number, number)


def combined(*terms: tuple[object, Vec]) -> Vec:
    return tuple(sum((Fraction(f) * v[i] for f, v in terms), Fraction(0)) for i in range(3))


def cross(a: Vec, b: Vec) -> Vec:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def dot(a: Vec, b: Vec) -> Fraction:
    return sum((x * y for x, y in zip(a, b, strict=True)), Fraction(0))


def derivative_vectors(start: Data, end: Data) -> list[Vec]:
    """Return B_0 to B_4 as the paper's appendix prints them: r' = 5 sum of binomial(4, i) terms with B_i."""
    P0, T0, N0, k0, a0, b0 = start
    P1, T1, N1, k1, a1, b1 = end
    f, t = Fraction(1, 5), Fraction(1, 20)
    return [
        combined((a0 * f, T0)),
        combined((a0 * f + b0 * t, T0), (k0 * a0**2 * t, N0)),
        combined((1, P1), (-1, P0), (-2 * a1 * f + b1 * t, T1), (k1 * a1**2 * t, N1), (-2 * a0 * f - b0 * t, T0),
                 (-k0 * a0**2 * t, N0)),
        combined((a1 * f - b1 * t, T1), (-k1 * a1**2 * t, N1)),
        combined((a1 * f, T1)),
    ]  # fmt: skip


def rulings(start: Data, end: Data, start_hat: Data, end_hat: Data) -> list[Vec]:
    """Return X_0 to X_5 of the appendix: p = r1 - r."""
    f, t = Fraction(1, 5), Fraction(1, 20)

    def side(data: Data, sign: int) -> list[Vec]:
        P, T, N, k, a, b = data
        bend = combined((sign * 2 * a * f + b * t, T), (k * a**2 * t, N))
        return [P, combined((1, P), (sign * a * f, T)), combined((1, P), (1, bend))]

    plain = [*side(start, 1), *side(end, -1)[::-1]]
    hat = [*side(start_hat, 1), *side(end_hat, -1)[::-1]]
    return [combined((1, q), (-1, p)) for p, q in zip(plain, hat, strict=True)]


Z_TERMS: dict[int, dict[tuple[int, int], int]] = {
    0: {(0, 0): 1}, 1: {(0, 1): 4, (1, 0): 5}, 2: {(0, 2): 6, (1, 1): 20, (2, 0): 10},
    3: {(0, 3): 4, (1, 2): 30, (2, 1): 40, (3, 0): 10}, 4: {(0, 4): 1, (1, 3): 20, (2, 2): 60, (3, 1): 40, (4, 0): 5},
    5: {(1, 4): 5, (2, 3): 40, (3, 2): 60, (4, 1): 20, (5, 0): 1}, 6: {(2, 4): 10, (3, 3): 40, (4, 2): 30, (5, 1): 4},
    7: {(3, 4): 10, (4, 3): 20, (5, 2): 6}, 8: {(5, 3): 4, (4, 4): 5}, 9: {(5, 4): 1},
}  # fmt: skip
"""Z_i = sum of factor times X_a x B~_b, as printed in the appendix."""

A_TERMS: dict[int, dict[tuple[int, int], int]] = {
    0: {(0, 0): 1}, 1: {(0, 1): 1, (1, 0): 4}, 2: {(0, 2): 1, (1, 1): 4, (2, 0): 6},
    3: {(0, 3): 1, (1, 2): 4, (2, 1): 6, (3, 0): 4}, 4: {(0, 4): 1, (1, 3): 4, (2, 2): 6, (3, 1): 4, (4, 0): 1},
    5: {(0, 5): 1, (1, 4): 4, (2, 3): 6, (3, 2): 4, (4, 1): 1},
    6: {(0, 6): 1, (1, 5): 4, (2, 4): 6, (3, 3): 4, (4, 2): 1},
    7: {(0, 7): 1, (1, 6): 4, (2, 5): 6, (3, 4): 4, (4, 3): 1},
    8: {(0, 8): 1, (1, 7): 4, (2, 6): 6, (3, 5): 4, (4, 4): 1},
    9: {(0, 9): 1, (1, 8): 4, (2, 7): 6, (3, 6): 4, (4, 5): 1}, 10: {(1, 9): 4, (2, 8): 6, (3, 7): 4, (4, 6): 1},
    11: {(2, 9): 6, (3, 8): 4, (4, 7): 1}, 12: {(3, 9): 4, (4, 8): 1}, 13: {(4, 9): 1},
}  # fmt: skip
"""A_i = sum of factor times B_a . Z_b, as printed in (2.4); 25 times that are the coefficients."""

C_TERMS: dict[int, dict[tuple[int, int], int]] = {
    0: {(0, 0): 1}, 1: {(1, 0): 4, (0, 1): 5}, 2: {(2, 0): 6, (1, 1): 20, (0, 2): 10},
    3: {(3, 0): 4, (2, 1): 30, (1, 2): 40, (0, 3): 10}, 4: {(4, 0): 1, (3, 1): 20, (2, 2): 60, (1, 3): 40, (0, 4): 5},
    5: {(4, 1): 5, (3, 2): 40, (2, 3): 60, (1, 4): 20, (0, 5): 1}, 6: {(4, 2): 10, (3, 3): 40, (2, 4): 30, (1, 5): 4},
    7: {(4, 3): 10, (3, 4): 20, (2, 5): 6}, 8: {(4, 4): 5, (3, 5): 4}, 9: {(4, 5): 1},
}  # fmt: skip
"""C~_i = sum of factor times Y_a x X_b; the paper prints 4 for the (0, 1) of C~_1, where expansion gives 5."""

FOUR_ENDS = st.tuples(*[end_values()] * 4)


def built(ends: tuple[Data, ...]) -> RuledPatch:
    made = [End(*data) for data in ends]
    return patch_between((made[0], made[1]), (made[2], made[3]))


@settings(max_examples=25)
@given(FOUR_ENDS)
def test_all_coefficients_are_exactly_those_of_the_papers_sums(ends: tuple[Data, ...]) -> None:
    start, end, start_hat, end_hat = ends
    patch = built(ends)
    B, hat = derivative_vectors(start, end), derivative_vectors(start_hat, end_hat)
    X = rulings(start, end, start_hat, end_hat)
    Z = [combined(*((n, cross(X[a], hat[b])) for (a, b), n in Z_TERMS[i].items())) for i in range(10)]
    A = [25 * sum(n * dot(B[a], Z[b]) for (a, b), n in A_TERMS[i].items()) for i in range(14)]
    assert list(coefficients_a(patch)) == A
    Y = [combined((1, b), (-1, h)) for b, h in zip(B, hat, strict=True)]
    C = [combined(*((n, cross(Y[a], X[b])) for (a, b), n in C_TERMS[i].items())) for i in range(10)]
    assert [tuple(row) for row in coefficients_c(patch)] == C


@settings(max_examples=25)
@given(FOUR_ENDS)
def test_the_explicit_first_and_last_coefficients_are_the_papers(ends: tuple[Data, ...]) -> None:
    (P0, T0, N0, k0, a0, b0), (P1, T1, N1, k1, a1, b1) = ends[:2]
    (Q0, T0h, N0h, k0h, a0h, b0h), (Q1, T1h, N1h, k1h, a1h, b1h) = ends[2:]
    first, last = combined((1, Q0), (-1, P0)), combined((1, Q1), (-1, P1))

    def triple(a: Vec, b: Vec, c: Vec) -> Fraction:
        return dot(a, cross(b, c))

    A = coefficients_a(built(ends))
    assert A[0] == a0 * a0h * triple(T0, first, T0h)
    assert A[1] == (
        (13 * a0 * a0h + a0 * b0h + a0h * b0) * triple(T0, first, T0h)
        + k0h * a0 * a0h**2 * triple(T0, first, N0h)
        + k0 * a0h * a0**2 * triple(N0, first, T0h)
    )
    assert A[12] == (
        (13 * a1 * a1h - a1 * b1h - a1h * b1) * triple(T1, last, T1h)
        - k1h * a1 * a1h**2 * triple(T1, last, N1h)
        - k1 * a1h * a1**2 * triple(N1, last, T1h)
    )
    assert A[13] == a1 * a1h * triple(T1, last, T1h)


def test_the_misprint_in_c_1_is_not_followed() -> None:
    """With the printed 4 (Y0 x X1) the sum is another one."""
    patch = patches(QUINTIC_TANGENT)[0]
    found = coefficients_c(patch)[1]
    b, c = (curve.exact for curve in (patch.c0, patch.c1))
    X = [combined((1, q), (-1, p)) for p, q in zip(b, c, strict=True)]
    Y = [combined((-1, q), (1, p)) for p, q in pairwise(X)]
    assert found == combined((4, cross(Y[1], X[0])), (5, cross(Y[0], X[1])))
    assert found != combined((4, cross(Y[1], X[0])), (4, cross(Y[0], X[1])))


@settings(max_examples=30)
@given(end_values(), end_values())
def test_the_directrix_has_the_end_derivatives_it_was_asked_for(start: Data, end: Data) -> None:
    b = directrix(End(*start), End(*end)).exact
    for (P, T, N, k, alpha, beta), i, sign in ((start, 0, 1), (end, 5, -1)):
        first, second = b[i + sign], b[i + 2 * sign]
        assert b[i] == P
        assert combined((5 * sign, first), (-5 * sign, P)) == combined((alpha, T))
        assert combined((20, second), (-40, first), (20, P)) == combined((beta, T), (k * alpha**2, N))


def test_theorem_2_2_makes_every_ruling_parallel() -> None:
    """c_i - b_i is Q0 - P0 for i <= 2 and g (Q0 - P0) beyond."""
    patch = patches(EXAMPLE_2_CYLINDER)[0]
    steps = [combined((1, q), (-1, p)) for p, q in zip(patch.c0.exact, patch.c1.exact, strict=True)]
    assert steps == [(0, 0, 4)] * 3 + [(0, 0, 8)] * 3
    assert not any(x for row in coefficients_c(patch) for x in row)


@settings(max_examples=20)
@given(end_values(), end_values(), points(), st.tuples(decimals(0, 0.4), decimals(0.5, 1)))
def test_the_cone_over_any_directrix_is_exactly_developable(
    start: Data, end: Data, apex: Vec, fraction: tuple[Fraction, Fraction]
) -> None:
    patch = cone_over(directrix(End(*start), End(*end)), apex, fraction)
    assert not any(coefficients_a(patch))
    for p, b in zip(patch.p.exact, patch.c0.exact, strict=True):
        across = cross(p, combined((1, apex), (-1, b)))
        assert across == (0, 0, 0)


@pytest.mark.parametrize(("a", "length"), [((3, 4, 0), 5), (("2/7", "3/7", "6/7"), 1), ((0, 0, 0), 0)])
def test_a_rational_length_is_exact(a: tuple[object, ...], length: int) -> None:
    vector = tuple(Fraction(x) for x in a)
    assert length_exact(vector) == length
    assert unit_exact(vector) == (combined((Fraction(1, length), vector)) if length else vector)


def test_an_irrational_length_is_the_double_next_to_it() -> None:
    for x, y, z in product((1, 2), (1, 3), (5,)):
        vector = (Fraction(x), Fraction(y), Fraction(z))
        length = length_exact(vector)
        assert abs(length * length / dot(vector, vector) - 1) <= Fraction(1, 2**51)
        assert abs(dot(unit_exact(vector), unit_exact(vector)) - 1) <= Fraction(1, 2**51)
