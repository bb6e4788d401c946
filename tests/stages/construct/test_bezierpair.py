"""Aumann's pairs: the recursion, the edge of regression, exactness, and the refusals."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.curves.curves import Bezier
from stages.geometry.ruled.ruled import frames, regression
from stages.model.surface import RuledSurface
from tests import oracles
from tests.near import assert_near, assert_relative
from tests.parts import AUMANN_FIRST, AUMANN_POINTS, Table, aumann, passage, patches, troubles
from tests.strategies import different_points, points, texts

PAIR: Table = {"kind": "bezier-pair", "points": AUMANN_POINTS, "first": AUMANN_FIRST, "lambda": 1.8, "mu": 2.3}
SHARES = ["-2", "-0.25", "0", "0.25", "0.5", "1", "1.8", "2.3"]


def test_the_cubic_has_the_control_points_lengths_and_area_of_the_recursion_by_hand() -> None:
    """d_1 = ((1 - 1.8) c_0 + 1.8 c_1 + 1.3 d_0) / 2.3, and so on; lengths and area by quadrature of 40 digits."""
    made = passage(PAIR)
    assert isinstance(made.surface, RuledSurface)
    (patch,) = made.surface.patches
    assert isinstance(patch.c1, Bezier)
    assert patch.c1.exact[1] == (Fraction(193, 230), Fraction(13, 115), Fraction(83, 115))
    sides = [oracles.bezier_of([tuple(oracles.exact(x) for x in row) for row in c.exact]) for c in (patch.c0, patch.c1)]
    found = made.side("flat")["edges"]
    assert isinstance(found, dict)
    assert_relative(
        [made.side("surface")["area"], made.side("flat")["area"], found["c0"], found["c1"]],
        [oracles.area(*sides), oracles.area(*sides), oracles.length(sides[0]), oracles.length(sides[1])],
        bound=1e-14, why="quadrature to rounding",
    )  # fmt: skip
    assert_relative(made.side("flat")["area"], 1.5545913608008169701, bound=1e-14, why="the area to 20 digits")


def test_the_pair_is_proved_developable_and_regular() -> None:
    made = passage(PAIR)
    warp, regular = made.metric("verify", "max_warp_deg"), made.metric("verify", "regular")
    assert (warp.value, warp.evidence, regular.value, regular.evidence) == (0.0, "proved", True, "proved")


@settings(max_examples=15)
@given(st.integers(2, 6).flatmap(different_points), points(), st.integers(0, 3), st.sampled_from(SHARES))
def test_every_degree_and_elevation_is_developable_in_exact_numbers(
    rows: list[tuple[Fraction, ...]], first: tuple[Fraction, ...], elevate: int, share: str
) -> None:
    """n (d - c) = (L - v) c' - (M - v) d', so p . (c' x d') = 0: checked at exact places."""
    table = PAIR | {"points": [texts(row) for row in rows], "first": texts(first), "lambda": share, "elevate": elevate}
    (patch,) = patches(table | {"mu": "3"} if Fraction(share) >= 1 else table | {"mu": "-1"} if share[0] in "-0" and
                       Fraction(share) <= 0 else table | {"lambda": "2"})  # fmt: skip
    assert isinstance(patch.c0, Bezier)
    assert isinstance(patch.c1, Bezier)
    n = len(rows) - 1 + elevate
    assert len(patch.c0.exact) == len(patch.c1.exact) == n + 1
    c, d = (np.array([list(row) for row in curve.exact]) for curve in (patch.c0, patch.c1))
    p, dc, dd = d - c, n * np.diff(c, axis=0), n * np.diff(d, axis=0)
    for v in (Fraction(0), Fraction(1, 3), Fraction(6, 7)):
        ruling, a, b = (_value(rows, v) for rows in (p, dc, dd))
        assert np.dot(ruling, np.cross(a, b)) == 0


def _value(rows: np.ndarray, v: Fraction) -> np.ndarray:
    """Return the value of exact Bernstein coefficients at v."""
    while len(rows) > 1:
        rows = (1 - v) * rows[:-1] + v * rows[1:]
    return rows[0]


@pytest.mark.parametrize(("lam", "mu"), [("1.8", "2.3"), ("2.3", "1.8"), ("-0.25", "-2"), ("-2", "-0.5"), ("5", "1.1")])
def test_the_edge_of_regression_lies_at_its_share_of_every_ruling(lam: str, mu: str) -> None:
    (patch,) = patches(PAIR | {"lambda": lam, "mu": mu})
    v = np.linspace(0.0, 1.0, 7)
    share = (float(mu) - v) / (float(mu) - float(lam))
    assert_relative(regression(frames(patch, v)), share, bound=1e-11, why="a quotient of cross products of size 10")


@pytest.mark.parametrize("mu", [share for share in SHARES if share != "0"])
@pytest.mark.parametrize("lam", SHARES)
def test_construct_refuses_just_the_pairs_that_the_exact_certificate_finds_folded(lam: str, mu: str) -> None:
    """Second method: the same two curves as a plain ruled surface, judged by verify alone."""
    made = passage(PAIR | {"lambda": lam, "mu": mu})
    plain = passage(aumann(AUMANN_POINTS, AUMANN_FIRST, lam, mu))
    if lam == mu and 0 <= Fraction(lam) <= 1:
        assert made.codes("construct", fatal=True) == []  # a cylinder, and its rulings shrink to nothing at v = lambda
        assert made.refused_by == plain.refused_by
        return
    folded = "edge-of-regression" in plain.codes("verify")
    assert (made.codes("construct", fatal=True) == ["edge-of-regression"]) == folded


def test_the_refusal_names_both_numbers_and_where_the_edge_of_regression_comes_in() -> None:
    made = passage(PAIR | {"lambda": 0.5})
    (finding,) = made.reports["construct"].findings
    assert "lambda = 0.5 and mu = 2.3" in finding.message
    assert "from 0.5 to 1" in finding.message
    assert finding.where == {"v": 0.5}
    assert made.surface is None


def test_an_edge_of_regression_that_only_touches_is_allowed_and_not_regular() -> None:
    made = passage(PAIR | {"lambda": 1})
    assert made.refused_by is None
    assert made.value("verify", "regular") is False


def test_equal_numbers_make_a_cylinder() -> None:
    (patch,) = patches(PAIR | {"lambda": 2.3})
    rulings = patch.p.jet(np.linspace(0.0, 1.0, 5), 0)[0]
    assert_near(np.cross(rulings, rulings[0]), np.zeros((5, 3)), bound=1e-15, why="parallel to rounding")


def test_elevation_keeps_the_given_curve_and_gives_another_surface() -> None:
    (plain,), (raised,) = patches(PAIR), patches(PAIR | {"elevate": 2})
    v = np.linspace(0.0, 1.0, 7)
    assert_near(raised.c0.jet(v, 1), plain.c0.jet(v, 1), bound=64 * 2.3e-16 * 6.0, why="the same curve to rounding")
    assert np.abs(raised.c1.jet(v, 0)[0, -1] - plain.c1.jet(v, 0)[0, -1]).max() > 1e-2
    assert passage(PAIR | {"elevate": 2}).value("verify", "max_warp_deg") == 0.0


@pytest.mark.parametrize("factor", [Fraction(1, 2), Fraction(4000)])
def test_the_pattern_scales_with_the_part(factor: Fraction) -> None:
    grown = [[str(Fraction(str(x)) * factor) for x in row] for row in [*AUMANN_POINTS, AUMANN_FIRST]]
    made = passage(PAIR | {"points": grown[:-1], "first": grown[-1]})
    area = float(factor) ** 2 * 1.5545913608008169701
    assert_relative(made.side("flat")["area"], area, bound=1e-14, why="quadrature to rounding")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"mu": 0}, "0: the recursion divides by it"),
        ({"points": [[1, 2, 3], [1, 2, 3]]}, "all control points coincide"),
        ({"first": [0, 0, 0], "lambda": 2, "mu": 2}, "the point is points[0]: no ruling has a length"),
    ],
)
def test_what_the_job_file_alone_shows_is_a_trouble(change: Table, message: str) -> None:
    assert troubles(PAIR) == []
    assert troubles(PAIR | change) == [message]
