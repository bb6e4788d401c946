"""The certificate: no false proof on hundreds of random patches, bounds checked by exact evaluation."""

import random
from fractions import Fraction
from itertools import pairwise
from math import atan2, degrees, inf, pi, sqrt

import pytest

from stages.geometry.bernstein import from_bernstein
from stages.geometry.curves import Bezier, bezier
from stages.geometry.ruled import RuledPatch, between
from stages.verify import sampled
from stages.verify.certificate import certify, ingredients, proved_positive
from tests.near import assert_near
from tests.parts import AUMANN_CUBIC, EXAMPLE_1, EXAMPLE_2_CYLINDER, EXAMPLE_2_PRINTED, QUINTIC_TANGENT, aumann, patches

Rows = list[list[Fraction]]


def warp_squared(patch: RuledPatch, v: Fraction) -> tuple[Fraction, Fraction]:
    """Return (|n0 x n1|^2, n0.n1) at one ruling in exact arithmetic, by evaluating points, not polynomials."""
    (c0, d0), (c1, d1) = (_jet(curve, v) for curve in (patch.c0, patch.c1))
    p = [b - a for a, b in zip(c0, c1, strict=True)]
    n0, n1 = _cross(p, d0), _cross(p, d1)
    turn = _cross(n0, n1)
    return sum(x * x for x in turn), sum(x * y for x, y in zip(n0, n1, strict=True))


def warp_at(patch: RuledPatch, v: Fraction) -> float:
    """Return the warp of one ruling in rad, rounded from exact numbers."""
    turn2, dot = warp_squared(patch, v)
    scale = max(turn2, dot * dot)
    return atan2(sqrt(turn2 / scale), float(dot / _root(scale))) if scale else 0.0


def _root(value: Fraction) -> Fraction:
    return Fraction(sqrt(value)) if value < 10**300 else Fraction(1)


def _jet(curve: object, v: Fraction) -> tuple[list[Fraction], list[Fraction]]:
    assert isinstance(curve, Bezier)
    rows = [list(point) for point in curve.exact]
    n = len(rows) - 1
    while len(rows) > 2:
        rows = [[(1 - v) * a + v * b for a, b in zip(x, y, strict=True)] for x, y in pairwise(rows)]
    slope = [n * (b - a) for a, b in zip(*rows, strict=True)]
    return [(1 - v) * a + v * b for a, b in zip(*rows, strict=True)], slope


def _cross(a: list[Fraction], b: list[Fraction]) -> list[Fraction]:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


# 300 perturbed patches


def _curve(rng: random.Random, degree: int) -> Rows:
    """Return a curve along x that bends to all sides, decimals of three places."""
    return [[Fraction(round(x * 1000), 1000) for x in (10 * i / degree, rng.uniform(-2, 2), rng.uniform(-2, 2))]
            for i in range(degree + 1)]  # fmt: skip


def _cone(rng: random.Random, degree: int) -> tuple[Rows, Rows]:
    rows, apex = _curve(rng, degree), [Fraction(5), Fraction(rng.randint(-3, 3)), Fraction(12)]
    return rows, [[x + (a - x) * Fraction(2, 5) for x, a in zip(row, apex, strict=True)] for row in rows]


def _cylinder(rng: random.Random, degree: int) -> tuple[Rows, Rows]:
    rows, d = _curve(rng, degree), [Fraction(rng.randint(-1, 1)), Fraction(1, 4), Fraction(6)]
    return rows, [[x + a for x, a in zip(row, d, strict=True)] for row in rows]


def _aumann(rng: random.Random, degree: int) -> tuple[Rows, Rows]:
    L, M = rng.choice([(Fraction(9, 5), Fraction(23, 10)), (Fraction(-1), Fraction(-2)), (Fraction(3), Fraction(5, 2))])
    c = _curve(rng, degree)
    d = [[c[0][0], c[0][1] + 1, c[0][2] + 5]]
    for a, b in pairwise(c):
        d.append([((1 - L) * x + L * y - (1 - M) * z) / M for x, y, z in zip(a, b, d[-1], strict=True)])
    return c, d


def perturbed(seed: int) -> RuledPatch:
    """Return a developable patch with every control point moved at random by 1e-2 to 1e-9 of its size."""
    rng = random.Random(seed)
    make = (_cone, _cylinder, _aumann)[seed % 3]
    amount = 12.0 * 10.0 ** -rng.uniform(2, 9)
    sides = [
        bezier([[x + Fraction(rng.uniform(-1, 1) * amount) for x in row] for row in rows])
        for rows in make(rng, 2 + seed % 4)
    ]
    return between(*sides)


@pytest.mark.parametrize("first", range(0, 300, 50))
def test_no_random_patch_gets_a_false_proof_and_bounds_are_tight(first: int) -> None:
    regular = 0
    for seed in range(first, first + 50):
        patch = perturbed(seed)
        place = sampled.largest_warp(patch, 0).v
        proof = certify(patch, place)
        assert not proof.developable, "every one of these is warped"
        worst = max(warp_at(patch, v) for v in (Fraction(place), *(Fraction(k, 8) for k in range(9))))
        assert proof.warp_rad >= worst, f"seed {seed}: the bound is below a value"
        assert proof.warp_rad > radians_of(1e-9) or worst <= radians_of(1e-9), f"seed {seed}: a false exact"
        if proof.positive is False:
            assert proof.where is not None
            assert warp_squared(patch, Fraction(proof.where))[1] < 0, f"seed {seed}: not folded there"
        if proof.regular and worst >= radians_of(1e-9):
            regular += 1
            assert proof.warp_rad <= 4.0 * worst, f"seed {seed}: {proof.warp_rad} against {worst}"
            assert proof.curvature < inf
            assert proof.curvature >= sampled.largest_gaussian(patch, 0).value * (1.0 - 1e-6)
    assert regular >= 30, "most of them must be regular, or the test says little"


def radians_of(deg: float) -> float:
    return deg * pi / 180.0


# Theorem 2.2


def theorem_2_2(seed: int) -> dict[str, object]:
    """Return a cylinder with data as one types them."""
    rng = random.Random(seed)

    def decimals(low: float, high: float) -> str:
        return f"{rng.uniform(low, high):.4f}"

    def unit() -> list[str]:
        direction = [rng.gauss(0, 1) for _ in range(3)]
        length = sqrt(sum(x * x for x in direction))
        return [f"{x / length:.4f}" for x in direction]

    vectors = {key: unit() for key in ("t0", "t1", "n0", "n1")}
    corners = {"p0": [decimals(-5, 5) for _ in range(3)], "p1": [decimals(6, 16) for _ in range(3)],
               "q0": [decimals(-5, 5), decimals(-5, 5), decimals(8, 19)]}  # fmt: skip
    sizes = {key: decimals(0.5, 4) for key in ("alpha0", "alpha1", "s0", "s1", "g")}
    return {"kind": "quintic-cylinder", "k0": decimals(-1, 1), "k1": decimals(-1, 1)} | vectors | corners | sizes


@pytest.mark.parametrize("seed", range(50))
def test_random_cylinders_of_theorem_2_2_have_no_curvature_and_that_is_proved(seed: int) -> None:
    (patch,) = patches(theorem_2_2(seed))
    assert ingredients(patch).delta.is_zero
    proof = certify(patch, 0.5)
    assert proof.developable
    assert proof.positive is None or (proof.warp_rad, proof.curvature) == ((0.0, 0.0) if proof.positive else (pi, inf))


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("index", range(6))
def test_one_control_point_moved_by_a_billionth_of_a_micrometre_is_no_longer_proved(index: int, axis: int) -> None:
    (patch,) = patches(EXAMPLE_2_CYLINDER)
    assert isinstance(patch.c1, Bezier)
    rows = [list(point) for point in patch.c1.exact]
    rows[index][axis] += Fraction(1, 10**12)
    other = between(patch.c0, bezier(rows))
    proof = certify(other, sampled.largest_warp(other, 0).v)
    along_the_ruling = axis == 2
    assert proof.developable is along_the_ruling
    assert (proof.warp_rad == 0.0) is along_the_ruling


# Single patches


def test_example_2_as_printed_has_its_warp_to_ten_digits_and_the_bound_is_above_it() -> None:
    """40 digits: 3.2849872165410022977 deg at v = 0.206364358832."""
    (patch,) = patches(EXAMPLE_2_PRINTED)
    found = sampled.largest_warp(patch, 0)
    assert_near(found.v, 0.206364358832, bound=1e-7, why="the square root of rounding")
    bound = degrees(certify(patch, found.v).warp_rad)
    assert 3.2849872165410022977 <= bound <= 3.2849872165410022977 + 1e-9


def test_example_2_has_the_curvature_bound_of_its_samples() -> None:
    (patch,) = patches(EXAMPLE_2_PRINTED)
    proof = certify(patch, sampled.largest_warp(patch, 0).v)
    value = sampled.largest_gaussian(patch, 0).value
    assert value <= proof.curvature <= 4.0 * value


@pytest.mark.parametrize("table", [EXAMPLE_1, EXAMPLE_2_CYLINDER, QUINTIC_TANGENT, AUMANN_CUBIC])
def test_exact_developables_are_proved(table: dict[str, object]) -> None:
    proof = certify(patches(table)[0], 0.3)
    assert (proof.developable, proof.warp_rad, proof.curvature, proof.positive) == (True, 0.0, 0.0, True)


def test_a_normal_that_vanishes_at_an_end_makes_a_patch_irregular() -> None:
    assert not certify(patches(EXAMPLE_1)[0], 0.5).regular
    assert certify(patches(QUINTIC_TANGENT)[0], 0.5).regular


POINTS: list[list[object]] = [[0, 0, 0], [1, 0, 0.2], [2, 1.3, 0.6], [2.5, 2, 1.8]]


@pytest.mark.parametrize(
    ("lam", "mu", "positive", "regular"),
    [
        ("1.8", "2.3", True, True),  # (M - t)/(M - L) > 1 for t < 1.8
        ("-1", "-2", True, True),
        ("1", "2.3", True, False),  # at t = 1 the edge of regression meets d
        ("2.3", "1", True, False),  # at t = 1 it meets c
        ("0", "-1", True, False),  # at t = 0
        ("0.5", "2.3", False, False),  # it enters at t = 1/2
        ("0.99999999999", "2.3", False, False),
    ],
)
def test_the_edge_of_regression_is_told_outside_at_an_edge_and_inside(
    lam: str, mu: str, positive: bool, regular: bool
) -> None:
    proof = certify(patches(aumann(POINTS, [0.1, 0.2, 1], lam, mu))[0], 0.5)
    assert (proof.positive, proof.regular) == (positive, regular)
    assert proof.developable


def dented(place: str, depth: str) -> RuledPatch:
    """Return a plane patch whose upper edge runs backwards over 2 * depth of v around `place`: x' = (v-a)^2 - e^2."""
    a, e = Fraction(place), Fraction(depth)
    m = [-(a**3) / 3, a**2 - e**2, -a, Fraction(1, 3)]
    x = [m[0], m[0] + m[1] / 3, m[0] + 2 * m[1] / 3 + m[2] / 3, sum(m)]
    zero, one = Fraction(0), Fraction(1)
    return between(bezier([(zero, zero, zero), (one, zero, zero)]), bezier([(value, one, zero) for value in x]))


@pytest.mark.parametrize("place", ["1/2", "1/3", "0.7071"])
def test_a_fold_between_any_two_samples_is_proved_with_its_place(place: str) -> None:
    proof = certify(dented(place, "1e-7"), 0.9)
    assert proof.positive is False
    assert proof.where is not None
    assert abs(Fraction(proof.where) - Fraction(place)) < Fraction("1e-7")


@pytest.mark.parametrize("place", ["1/2", "1/3", "0.7071"])
def test_an_edge_of_regression_that_only_touches_an_edge_is_no_fold(place: str) -> None:
    proof = certify(dented(place, "0"), 0.9)
    assert proof.positive is None
    assert not proof.regular


def test_positive_polynomials_are_proved_and_others_named_or_left_open() -> None:
    def poly(*values: float) -> object:
        return from_bernstein([Fraction(value) for value in values])

    assert proved_positive(poly(1, -0.9, 1)) == (True, None)
    assert proved_positive(poly(1, -1, 1)) == (None, pytest.approx(0.5, abs=1e-9))
    state, where = proved_positive(poly(1, -1.0001, 1))
    assert state is False
    assert where is not None
    assert abs(where - 0.5) < 0.01
    assert proved_positive(poly(0, 1, 1))[0] is None


def test_a_line_that_is_its_own_second_edge_has_no_normal_and_is_no_surface() -> None:
    line = [[Fraction(i), Fraction(0), Fraction(0)] for i in range(2)]
    longer = [[Fraction(i + 5), Fraction(0), Fraction(0)] for i in range(2)]
    proof = certify(between(bezier(line), bezier(longer)), 0.5)
    assert (proof.positive, proof.regular) == (False, False)
