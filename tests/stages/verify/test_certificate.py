"""The certificate of single patches: the paper's, folds and cusps by their closed forms, hard scales."""

from fractions import Fraction
from math import atan, cos, degrees, inf, pi, sqrt

import pytest

from stages.geometry.arrays import EPS
from stages.geometry.curves.curves import Bezier, bezier, rational
from stages.geometry.ruled.ruled import RuledPatch, between
from stages.verify import sampled
from stages.verify.certificate import certify
from stages.verify.plucker import ingredients
from tests.near import assert_near
from tests.parts import AUMANN_CUBIC, EXAMPLE_1, EXAMPLE_2_CYLINDER, EXAMPLE_2_PRINTED, QUINTIC_TANGENT, aumann, patches
from tests.stages.verify.exactly import curvature_at, warp_at
from tests.stages.verify.families import theorem_2_2


@pytest.mark.parametrize("seed", range(50))
def test_random_cylinders_of_theorem_2_2_have_no_curvature_and_that_is_proved(seed: int) -> None:
    (patch,) = patches(theorem_2_2(seed))
    assert ingredients(patch).delta.is_zero
    proof = certify(patch)
    assert proof.developable
    assert (proof.warp_rad, proof.curvature) == ((0.0, 0.0) if proof.positive else (pi, None))


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("index", range(6))
def test_one_control_point_moved_by_a_billionth_of_a_micrometre_is_no_longer_proved(index: int, axis: int) -> None:
    (patch,) = patches(EXAMPLE_2_CYLINDER)
    assert isinstance(patch.c1, Bezier)
    rows = [list(point) for point in patch.c1.exact]
    rows[index][axis] += Fraction(1, 10**12)
    other = between(patch.c0, bezier(rows))
    proof = certify(other)
    along_the_ruling = axis == 2
    assert proof.developable is along_the_ruling
    assert (proof.warp_rad == 0.0) is along_the_ruling


# Single patches


def test_example_2_as_printed_has_its_warp_to_ten_digits_and_the_bound_is_above_it() -> None:
    """40 digits: 3.2849872165410022977 deg at v = 0.206364358832."""
    (patch,) = patches(EXAMPLE_2_PRINTED)
    proof = certify(patch)
    assert proof.where is not None
    assert_near(proof.where, 0.206364358832, bound=1e-7, why="the square root of rounding")
    assert proof.warp_rad is not None
    assert 3.2849872165410022977 <= degrees(proof.warp_rad) <= 3.2849872165410022977 + 1e-9


def test_example_2_has_the_curvature_bound_of_its_samples() -> None:
    (patch,) = patches(EXAMPLE_2_PRINTED)
    proof, value = certify(patch), sampled.survey(patch, 0).gaussian.value
    assert proof.curvature is not None
    assert value <= proof.curvature <= value * 1.01, "cos(W / 2)^4 is 0.998"
    assert proof.curvature_where is not None
    there = curvature_at(patch, Fraction(proof.curvature_where))
    assert proof.curvature * 0.99 <= there <= proof.curvature


@pytest.mark.parametrize("table", [EXAMPLE_1, EXAMPLE_2_CYLINDER, QUINTIC_TANGENT, AUMANN_CUBIC])
def test_exact_developables_are_proved(table: dict[str, object]) -> None:
    proof = certify(patches(table)[0])
    assert (proof.developable, proof.warp_rad, proof.curvature, proof.positive) == (True, 0.0, 0.0, True)


def test_a_normal_that_vanishes_at_an_end_makes_a_patch_irregular() -> None:
    assert not certify(patches(EXAMPLE_1)[0]).regular
    assert certify(patches(QUINTIC_TANGENT)[0]).regular


def saddle(side: Fraction, slope: Fraction) -> RuledPatch:
    """Return z = a x y over a square about the origin, slope = a side / 2: the slope of a ruling at the rim."""
    half = side / 2
    rise = slope * half
    return between(
        bezier([(-half, -half, rise), (half, -half, -rise)]), bezier([(-half, half, -rise), (half, half, rise)])
    )


@pytest.mark.parametrize("side", ["1e-6", "1", "1e6"])
@pytest.mark.parametrize("slope", ["1e-9", "1e-3", "0.5"])
def test_a_saddle_has_the_curvature_and_warp_of_its_closed_form_at_every_size(side: str, slope: str) -> None:
    """Normals (-a y, -a x, 1): the ruling x = 0 turns by 2 arctan(a side / 2); |K| = a^2 in the middle."""
    proof = certify(saddle(Fraction(side), Fraction(slope)))
    exact = 2.0 * atan(float(slope))
    assert proof.warp_rad is not None
    assert exact <= proof.warp_rad * (1 + 4 * EPS)
    assert proof.warp_rad <= exact * (1 + 1.1e-10), "the proof starts 1e-10 above"
    assert proof.where is not None
    assert_near(proof.where, 0.5, bound=4 * sqrt(EPS) / float(slope), why="the warp falls by (slope (v - 1/2))^2 of it")
    middle = (2.0 * float(slope) / float(side)) ** 2
    assert proof.curvature is not None
    assert 1.0 <= proof.curvature / middle <= 1.0001e-10 * 4 + 1.0 / cos(exact / 2.0) ** 4, "less at the edges"


@pytest.mark.parametrize(("slope", "positive"), [("0.999999", True), ("1", True), ("1.000001", False)])
def test_a_warp_that_reaches_a_right_angle_is_told_from_one_that_exceeds_it(slope: str, positive: bool) -> None:
    patch = saddle(Fraction(1), Fraction(slope))
    proof = certify(patch)
    assert (proof.positive, proof.regular) == (positive, positive)
    assert proof.warp_rad is not None
    assert 0.0 <= proof.warp_rad - (2.0 * atan(float(slope)) if positive else pi) <= 1e-9
    assert (proof.curvature is None) is not positive
    if not positive:
        assert proof.where is not None
        assert warp_at(patch, Fraction(proof.where)) > pi / 2.0


def test_a_right_angle_at_an_end_is_a_bound_and_no_fold() -> None:
    """c0' = (1, 0, 0) and c1' = (v, 0, 1) over rulings that start along y: at v = 0 n0 and n1 are at right angles."""
    zero, one = Fraction(0), Fraction(1)
    patch = between(
        bezier([(zero, zero, zero), (one, zero, zero)]),
        bezier([(zero, one, zero), (zero, one, one / 2), (one / 2, one, one)]),
    )
    proof = certify(patch)
    assert warp_at(patch, zero) == pi / 2.0
    assert all(warp_at(patch, Fraction(k, 8)) < pi / 2.0 for k in range(1, 9))
    assert proof.positive
    assert proof.warp_rad == pytest.approx(pi / 2.0, rel=1e-14)
    assert proof.where == 0.0


def rows(*points: tuple[int, int, int]) -> list[tuple[Fraction, ...]]:
    return [tuple(map(Fraction, point)) for point in points]


def test_a_fold_is_found_where_a_normal_and_the_cosine_change_sign_together() -> None:
    """At v = 1/2 n0 vanishes and the warp tends to 90 deg: the signs to the left and right of it tell nothing."""
    patch = between(bezier(rows((1, 0, 0), (0, 0, 1))), bezier(rows((2, 0, 2), (-1, 0, -1), (-1, 1, -1))))
    proof = certify(patch)
    assert proof.singular[0].root == (Fraction(1, 2), Fraction(1, 2))
    assert proof.positive is False
    assert proof.where is not None
    assert warp_at(patch, Fraction(proof.where)) > pi / 2.0


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
    proof = certify(patches(aumann(POINTS, [0.1, 0.2, 1], lam, mu))[0])
    assert (proof.positive, proof.regular) == (positive, regular)
    assert proof.developable


def dented(place: str, depth: str) -> RuledPatch:
    """Return a plane patch whose upper edge runs backwards over 2 * depth of v around `place`: x' = (v-a)^2 - e^2."""
    a, e = Fraction(place), Fraction(depth)
    m = [-(a**3) / 3, a**2 - e**2, -a, Fraction(1, 3)]
    x = [m[0], m[0] + m[1] / 3, m[0] + 2 * m[1] / 3 + m[2] / 3, sum(m)]
    zero, one = Fraction(0), Fraction(1)
    return between(bezier([(zero, zero, zero), (one, zero, zero)]), bezier([(value, one, zero) for value in x]))


@pytest.mark.parametrize("depth", ["1e-7", "1e-20"])
@pytest.mark.parametrize("place", ["1/2", "1/3", "0.7071"])
def test_a_fold_between_any_two_samples_is_proved_with_its_place(place: str, depth: str) -> None:
    proof = certify(dented(place, depth))
    assert proof.positive is False
    assert proof.where is not None
    assert abs(Fraction(proof.where) - Fraction(place)) < Fraction("1e-7")
    assert [ruling.sort for ruling in proof.singular] == ["edge-of-regression"] * 2


@pytest.mark.parametrize("place", ["1/2", "1/3", "0.7071"])
def test_an_edge_of_regression_that_only_touches_an_edge_is_no_fold(place: str) -> None:
    proof = certify(dented(place, "0"))
    assert (proof.positive, proof.regular, proof.warp_rad) == (True, False, 0.0)
    (ruling,) = proof.singular
    assert ruling.sort == "touch"
    assert ruling.root[0] <= Fraction(place) <= ruling.root[1]


def test_a_line_that_is_its_own_second_edge_has_no_normal_and_is_no_surface() -> None:
    line = [[Fraction(i), Fraction(0), Fraction(0)] for i in range(2)]
    longer = [[Fraction(i + 5), Fraction(0), Fraction(0)] for i in range(2)]
    proof = certify(between(bezier(line), bezier(longer)))
    assert (proof.positive, proof.regular) == (False, False)


# Normals that vanish at an end of a patch that is not developable


@pytest.mark.parametrize("twist", ["1e-9", "0.5"])
def test_curvature_without_bound_towards_a_vanishing_normal_is_proved_to_be_so(twist: str) -> None:
    """c0 = (v^3 / 3, 0, 0), c1 = (v, 1, h v): delta = -h v^2 and |n0|^2 ~ v^4, so sqrt|K| ~ h / v^2."""
    zero, one, h = Fraction(0), Fraction(1), Fraction(twist)
    patch = between(
        bezier([(zero, zero, zero)] * 3 + [(Fraction(1, 3), zero, zero)]), bezier([(zero, one, zero), (one, one, h)])
    )
    proof = certify(patch)
    assert (proof.developable, proof.positive, proof.regular) == (False, True, False)
    assert (proof.curvature, proof.curvature_where) == (inf, 0.0)
    assert proof.warp_rad is not None
    assert atan(float(h)) <= proof.warp_rad <= atan(float(h)) * 1.5, "arctan(h) where c0 stops"


@pytest.mark.parametrize("warped", ["1e-8", "0.1"])
def test_curvature_is_bounded_at_the_corner_of_a_triangle(warped: str) -> None:
    """c0 = (v, 0, 0), c1 = (0, v, h v^2): both normals are v (0, 0, 1) + ... there, delta = -h v^2, K(0) = -h^2."""
    zero, one, h = Fraction(0), Fraction(1), Fraction(warped)
    corner = (zero, zero, zero)
    patch = between(bezier([corner, (one, zero, zero)]), bezier([corner, (zero, one / 2, zero), (zero, one, h)]))
    proof = certify(patch)
    assert (proof.developable, proof.positive, proof.regular) == (False, True, False)
    assert proof.curvature is not None
    assert 1.0 <= proof.curvature / float(h) ** 2 <= 1.05, "cos(W / 2)^4, the warp at v = 1 being some 11 deg"


@pytest.mark.parametrize("factor", ["1e-300", "1e300"])
def test_sizes_beyond_all_reason_give_numbers_and_no_false_proof(factor: str) -> None:
    (patch,) = patches(EXAMPLE_2_PRINTED)
    assert isinstance(patch.c0, Bezier)
    assert isinstance(patch.c1, Bezier)
    rows = [[[Fraction(factor) * x for x in point] for point in c.exact] for c in (patch.c0, patch.c1)]
    proof = certify(between(*map(bezier, rows)))
    assert_near(degrees(proof.warp_rad or 0.0), 3.28498721654, bound=1e-9, why="the warp has no scale")


@pytest.mark.parametrize("amount", ["1e-15", "1e-30", "1e-170"])
def test_a_warp_below_all_rounding_is_bounded_and_not_called_zero(amount: str) -> None:
    proof = certify(saddle(Fraction(1), Fraction(amount)))
    assert not proof.developable
    assert proof.warp_rad is not None
    assert 0.0 < proof.warp_rad <= 5.0 * float(amount)


def test_a_peak_that_is_a_millionth_of_the_patch_wide_is_bounded_too() -> None:
    """Weights from 1/1000 to 1000 crowd the warp into v < 1e-5; digits by 40-digit arithmetic from the definitions."""
    bottom, top = [(0, 0, 0), (5, 9, 1), (10, -3, 0), (20, 0, 0)], [(0, 0, 20), (6, 9, 22), (10, -3, 20), (20, 1, 20)]
    weights = (["1", "0.001", "1000", "1"], ["1", "0.002", "700", "1"])
    c0, c1 = (
        rational([[*(Fraction(w) * x for x in point), Fraction(w)] for point, w in zip(points, by, strict=True)])
        for points, by in zip((bottom, top), weights, strict=True)
    )
    found = certify(between(c0, c1))
    assert found.warp_rad is not None and found.curvature is not None and found.where is not None
    warp, curvature = 0.369100954590014588209, 0.0005792537645575379287554
    assert 0.0 <= found.warp_rad / warp - 1.0 <= 1e-10, "from above, nearly reached"
    assert 0.0 <= found.curvature / curvature - 1.0 <= 1e-9, "from above, and here reached along an edge"
    assert_near(found.where, 9.38005703531e-7, bound=1e-10, why="a flat maximum: the square root of rounding")
