"""The polynomials without denominators against points, tangents and normals evaluated one by one."""

import random
from fractions import Fraction

import pytest

from stages.geometry.curves.curves import bezier
from stages.geometry.numeric.bernstein import Vector
from stages.geometry.ruled.ruled import RuledPatch, between
from stages.verify.plucker import Factored, ingredients
from tests.parts import EXAMPLE_1, patches
from tests.stages.verify.exactly import cross, delta, inner, jet, normals
from tests.stages.verify.families import cone, general, moved_off, weighted, weights

PLACES = [Fraction(k, 7) for k in range(8)]


def mixed(seed: int) -> RuledPatch:
    """Return a patch with weights on one side, on both, or on none; degrees 1 to 9."""
    rng = random.Random(seed)
    a, b = moved_off(general(rng, rng.randint(1, 9)), rng, 0.01)
    first = bezier(a) if seed % 2 else weighted(a, weights(rng))
    return between(first, bezier(b) if seed % 3 else weighted(b, weights(rng)))


def values(f: Vector, v: Fraction) -> list[Fraction]:
    return [component(v) for component in f]


def whole(f: Factored, v: Fraction) -> list[Fraction]:
    return [f.factor(v) * x for x in values(f.rest, v)]


def positive_multiple(a: list[Fraction], b: list[Fraction]) -> bool:
    """Return whether a is b times a positive number, or both are zero."""
    return not any(cross(a, b)) and (inner(a, b) > 0 or not (any(a) or any(b)))


@pytest.mark.parametrize("seed", range(12))
def test_rulings_tangents_and_normals_point_the_way_of_the_points(seed: int) -> None:
    patch = mixed(seed)
    made = ingredients(patch)
    for v in PLACES:
        (c0, d0), (c1, d1) = jet(patch.c0, v), jet(patch.c1, v)
        assert positive_multiple(whole(made.ruling, v), [b - a for a, b in zip(c0, c1, strict=True)])
        for tangent, slope in zip(made.tangents, (d0, d1), strict=True):
            assert positive_multiple(values(tangent.d, v), slope)
        for normal, expected in zip(made.normals, normals(patch, v), strict=True):
            assert positive_multiple(whole(normal, v), expected)


@pytest.mark.parametrize("seed", range(12))
def test_warp_and_curvature_need_no_scale(seed: int) -> None:
    """tan(warp) = |P| |Delta| / (M0 . M1) and sqrt|K| = |Delta| w^2 / |M|^2, squared to stay rational."""
    patch = mixed(seed)
    made = ingredients(patch)
    for v in PLACES:
        n0, n1 = normals(patch, v)
        m0, m1 = (whole(normal, v) for normal in made.normals)
        p, d = whole(made.ruling, v), made.delta(v)
        turn = cross(n0, n1)
        assert inner(p, p) * d**2 * inner(n0, n1) ** 2 == inner(turn, turn) * inner(m0, m1) ** 2
        for m, n, tangent in ((m0, n0, made.tangents[0]), (m1, n1, made.tangents[1])):
            w = tangent.w(v)
            assert d**2 * w**4 * inner(n, n) ** 2 == delta(patch, v) ** 2 * inner(m, m) ** 2


def test_a_vector_without_its_common_factor_vanishes_nowhere() -> None:
    (patch,) = patches(EXAMPLE_1)
    made = ingredients(patch)
    for normal in made.normals:
        assert not any(whole(normal, Fraction(0)))
        assert any(values(normal.rest, Fraction(0)))
        assert {component.degree for component in normal.rest if not component.is_zero} == {0}, "a plane has one normal"


def test_a_cone_to_its_apex_has_no_second_normal_and_whole_numbers_only() -> None:
    rows, _ = cone(random.Random(3), 4)
    apex = [Fraction(5, 7), Fraction(1, 3), Fraction(12)]
    made = ingredients(between(weighted(rows, weights(random.Random(4))), bezier([apex] * 5)))
    assert [normal.is_zero for normal in made.normals] == [False, True]
    assert made.delta.is_zero
    assert all(f.denominator == 1 for tangent in made.tangents for f in (*tangent.A, *tangent.d, *tangent.m, tangent.w))


def test_directrices_that_are_not_exact_have_no_polynomials() -> None:
    from tests.parts import RIGHT_FRUSTUM

    with pytest.raises(TypeError, match="polynomial or rational"):
        ingredients(patches(RIGHT_FRUSTUM)[0])
