"""Singular rulings inside a patch: each sort is planted at a known place and named, and nothing else is."""

from fractions import Fraction
from itertools import pairwise

import pytest

from stages.geometry.curves.curves import Curve, bezier, rational
from stages.geometry.ruled.ruled import RuledPatch, between
from stages.verify.certificate import Certified, certify
from tests.stages.verify.exactly import dot

Row = list[Fraction]
PLACES = ["1/2", "0.3", "1/3", "0.999"]


def power(a: Fraction, order: int) -> Row:
    """Return (v - a)^order in the plain powers of v."""
    row = [Fraction(1)]
    for _ in range(order):
        row = [x - a * y for x, y in zip([Fraction(0), *row], [*row, Fraction(0)], strict=True)]
    return row


def times(f: Row, g: Row) -> Row:
    made = [Fraction(0)] * (len(f) + len(g) - 1)
    for i, x in enumerate(f):
        for j, y in enumerate(g):
            made[i + j] += x * y
    return made


def antiderivative(f: Row) -> Row:
    return [Fraction(0), *(x / (i + 1) for i, x in enumerate(f))]


def curve(x: Row, y: Row, z: Row) -> Curve:
    """Return the Bezier curve of three polynomials in the powers of v."""
    n = max(len(x), len(y), len(z)) - 1
    columns = [_bernstein([*f, *[Fraction(0)] * (n + 1 - len(f))]) for f in (x, y, z)]
    return bezier(list(zip(*columns, strict=True)))


def _bernstein(f: Row) -> Row:
    """b_i = sum_j binomial(i, j) / binomial(n, j) f_j: differences at 0, summed up again."""
    n = len(f) - 1
    row, share = [], Fraction(1)
    for j, x in enumerate(f):
        row.append(share * x)
        share *= Fraction(j + 1, n - j) if j < n else 1
    made = [row[0]]
    for _ in range(n):
        row = [a + b for a, b in pairwise([*row, Fraction(0)])]
        made.append(row[0])
    return made


ONE, ZERO, V = [Fraction(1)], [Fraction(0)], [Fraction(0), Fraction(1)]


def sorts(proof: Certified, place: str) -> list[str]:
    """Return what was found, all of it at the place where it was planted."""
    for ruling in proof.singular:
        assert ruling.root[0] <= Fraction(place) <= ruling.root[1]
    return [ruling.sort for ruling in proof.singular]


def stopping(place: str, order: int, *, shear: str = "1/2") -> RuledPatch:
    """Return a bent strip whose directrices both have the speed (v - a)^order: x(v), with z = x^2 / 4."""
    x = antiderivative(power(Fraction(place), order))
    z = [value / 4 for value in times(x, x)]
    y = [Fraction(shear) * value for value in x]
    return between(curve(x, y, z), curve(x, [value + 1 for value in y[:1]] + y[1:], z))


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("order", [2, 4])
def test_directrices_that_stop_and_go_on_leave_the_surface_regular(place: str, order: int) -> None:
    proof = certify(stopping(place, order))
    assert sorts(proof, place) == ["stop"]
    assert (proof.positive, proof.regular, proof.developable) == (True, True, True)


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("order", [1, 3])
def test_directrices_that_stop_and_turn_back_make_a_cusp(place: str, order: int) -> None:
    proof = certify(stopping(place, order))
    assert sorts(proof, place) == ["cusp"]
    assert not proof.regular


@pytest.mark.parametrize(("end", "order"), [("0", 1), ("0", 2), ("1", 3)])
def test_directrices_that_stop_at_an_end_leave_the_surface_regular(end: str, order: int) -> None:
    proof = certify(stopping(end, order))
    assert (proof.singular, proof.positive, proof.regular) == ((), True, True)


@pytest.mark.parametrize("place", PLACES)
def test_a_stop_of_both_counts_as_one_whatever_the_weights(place: str) -> None:
    """The same stopping curves run with a weight of 1 + v: the points of the patch are the same."""
    a = Fraction(place)
    x = antiderivative(power(a, 2))
    w = [Fraction(1), Fraction(1)]
    homogeneous = [times(f, w) for f in (x, ONE, times(x, x))]
    rows = [_bernstein([*f, *[Fraction(0)] * (8 - len(f))]) for f in (*homogeneous, w)]
    lifted = [_bernstein([*f, *[Fraction(0)] * (8 - len(f))]) for f in (homogeneous[0], ZERO, homogeneous[2], w)]
    patch = between(*(rational(list(zip(*columns, strict=True))) for columns in (rows, lifted)))
    proof = certify(patch)
    assert sorts(proof, place) == ["stop"]
    assert (proof.positive, proof.regular, proof.developable) == (True, True, True)


def along(place: str, order: int) -> RuledPatch:
    """Return a cylinder along y whose profile has the speed (v - a)^order, its edges sloping along the rulings."""
    x = antiderivative(power(Fraction(place), order))
    z = [value / 4 for value in times(x, x)]
    return between(curve(x, V, z), curve(x, [Fraction(3), Fraction(1)], z))


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize(("order", "sort"), [(1, "singular-ruling"), (2, "tangent-ruling"), (3, "singular-ruling")])
def test_a_ruling_along_the_directrices_turns_back_or_goes_on(place: str, order: int, sort: str) -> None:
    proof = certify(along(place, order))
    assert sorts(proof, place) == [sort]
    assert not proof.regular


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize(("order", "sort"), [(1, "edge-of-regression"), (2, "touch"), (3, "edge-of-regression")])
def test_one_directrix_that_stops_touches_or_folds(place: str, order: int, sort: str) -> None:
    x = antiderivative(power(Fraction(place), order))
    patch = between(curve(V, ZERO, ZERO), curve(x, ONE, ZERO))
    proof = certify(patch)
    assert sorts(proof, place) == [sort]
    assert proof.positive is (sort == "touch")
    assert not proof.regular
    if proof.positive is False:
        assert proof.where is not None
        assert dot(patch, Fraction(proof.where)) < 0


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("order", [1, 2])
def test_a_ruling_of_no_length_inside_is_found(place: str, order: int) -> None:
    x = power(Fraction(place), order)
    proof = certify(between(curve(V, ZERO, ZERO), curve(V, x, ZERO)))
    assert sorts(proof, place) == ["zero-ruling"]
    assert not proof.regular


def test_two_stops_of_unlike_order_touch() -> None:
    """c0' ~ (v - a)^2, c1' ~ (v - a)^4: run as fast as c0 wants, c1 still stops."""
    a = Fraction(2, 5)
    patch = between(curve(antiderivative(power(a, 2)), ZERO, ZERO), curve(antiderivative(power(a, 4)), ONE, ZERO))
    proof = certify(patch)
    assert sorts(proof, "2/5") == ["touch"]
    assert (proof.positive, proof.regular) == (True, False)


def test_an_irrational_place_is_found_too() -> None:
    """x' = (v^2 - 1/2)^2."""
    x = antiderivative(times([Fraction(-1, 2), ZERO[0], ONE[0]], [Fraction(-1, 2), ZERO[0], ONE[0]]))
    proof = certify(between(curve(x, ZERO, ZERO), curve(x, ONE, ZERO)))
    (ruling,) = proof.singular
    assert ruling.sort == "stop"
    assert ruling.v == pytest.approx(0.5**0.5, abs=1e-15)


def test_a_stop_of_a_patch_that_is_not_developable_is_told_and_its_warp_proved() -> None:
    """The ruling at v = a still turns by what a reparametrisation would give: arctan2 of (1, 0, 0) and (1, 0, h)."""
    a, h = Fraction(1, 3), Fraction(1, 10)
    x = antiderivative(power(a, 2))
    patch = between(curve(x, ZERO, ZERO), curve(x, ONE, [h * value for value in x]))
    proof = certify(patch)
    assert sorts(proof, "1/3") == ["stop"]
    assert (proof.developable, proof.positive, proof.regular) == (False, True, True)
    assert proof.warp_rad is not None
    assert proof.warp_rad == pytest.approx(0.1, rel=0.01)
    assert proof.curvature == pytest.approx(0.01, rel=0.05)
