"""The residuals of Theorem 3.1 are those of the curves as built: faults planted in either end of a join show."""

from dataclasses import replace
from fractions import Fraction

from stages.construct.quintic import ZERO, End, Vector, directrix, moved
from stages.construct.strip import derivative_jumps, joins_detail

X: Vector = (Fraction(1), Fraction(0), Fraction(0))
Y: Vector = (Fraction(0), Fraction(1), Fraction(0))
Z: Vector = (Fraction(0), Fraction(0), Fraction(1))


def end(point: Vector, tangent: Vector) -> End:
    """Return an end with k = 1/2, alpha = 3 and beta = 1/7."""
    return End(point, tangent, Z, Fraction(1, 2), Fraction(3), Fraction(1, 7))


START, MIDDLE, END = end(ZERO, X), end(X, Y), end(Y, X)


def test_an_end_that_is_the_next_start_leaves_no_jump_at_all() -> None:
    assert derivative_jumps(directrix(START, MIDDLE), directrix(MIDDLE, END)) == (0.0, 0.0)


def test_a_start_that_is_faster_by_a_third_jumps_by_that() -> None:
    """alpha 3 -> 4: r' by |T| = 1; r'' by k (16 - 9) = 7/2 along N."""
    other = replace(MIDDLE, alpha=Fraction(4))
    assert derivative_jumps(directrix(START, MIDDLE), directrix(other, END)) == (1.0, 3.5)


def test_another_curvature_jumps_in_the_second_derivative_alone() -> None:
    """k 1/2 -> 1: r'' by alpha^2 / 2 = 9/2."""
    other = replace(MIDDLE, k=Fraction(1))
    assert derivative_jumps(directrix(START, MIDDLE), directrix(other, END)) == (0.0, 4.5)


def test_the_worse_of_both_directrices_is_told() -> None:
    """A hat whose start has beta 1/7 + 2 jumps by 2 in the second derivative, whatever c0 does."""
    hats = [moved(one, (Fraction(0), Fraction(0), Fraction(5))) for one in (START, MIDDLE, END)]
    wrong = replace(hats[1], beta=hats[1].beta + 2)
    rows = joins_detail([((START, MIDDLE), (hats[0], hats[1])), ((MIDDLE, END), (wrong, hats[2]))])["joins"]
    assert isinstance(rows, list)
    assert [rows[0][f"{order}_derivative_residual"] for order in ("first", "second")] == [0.0, 2.0]
    assert (rows[0]["gamma0"], rows[0]["mu0"], rows[0]["t0"]) == (3.0, 1 / 7, [0.0, 1.0, 0.0])


def test_a_join_of_cones_is_judged_by_the_one_directrix_that_is_given() -> None:
    rows = joins_detail([((START, MIDDLE), None), ((MIDDLE, END), None)])["joins"]
    assert isinstance(rows, list)
    assert [rows[0][f"{order}_derivative_residual"] for order in ("first", "second")] == [0.0, 0.0]
