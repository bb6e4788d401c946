"""The stage on surfaces that fold, stop, meet their edge of regression or have an apex: refused or named."""

from fractions import Fraction
from math import asinh, comb, hypot

import pytest

from stages.model.tolerances import Tolerances
from tests.near import assert_near, assert_relative
from tests.parts import (
    AUMANN_FIRST,
    AUMANN_POINTS,
    CIRCLE,
    EXAMPLE_1,
    EXAMPLE_3,
    OBLIQUE_CONE,
    RIGHT_FRUSTUM,
    Table,
    aumann,
    passage,
)


@pytest.mark.parametrize(("lam", "mu"), [("1", "2.3"), ("2.3", "1")])
def test_an_edge_of_regression_at_an_edge_is_accepted_and_reported(lam: str, mu: str) -> None:
    made = passage(aumann(AUMANN_POINTS, AUMANN_FIRST, lam, mu))
    assert made.refused_by is None
    assert made.value("verify", "regular") is False
    assert made.value("verify", "min_bend_radius_mm") < 1e-9


@pytest.mark.parametrize(("lam", "mu"), [("0.5", "2.3"), ("0.99999999999", "2.3"), ("2.3", "0.5"), ("3", "-2")])
def test_an_edge_of_regression_inside_is_rejected_as_folded(lam: str, mu: str) -> None:
    made = passage(aumann(AUMANN_POINTS, AUMANN_FIRST, lam, mu), Tolerances(accept="leather"))
    assert made.refused_by == "verify"
    assert "edge-of-regression" in made.codes("verify", fatal=True)
    assert made.value("verify", "regular") is False
    assert made.value("verify", "max_warp_deg") > 90.0


def test_a_fold_narrower_than_any_sampling_is_rejected_at_its_place() -> None:
    """The upper edge runs back where (v - 1/3)^2 < 1e-14."""
    upper = [[x, 1, 0] for x in _dent("1/3", "1e-7")]
    made = passage({"kind": "ruled", "c0": {"bezier": [[0, 0, 0], [1, 0, 0]]}, "c1": {"bezier": upper}})
    assert made.codes("verify", fatal=True) == ["edge-of-regression"]
    where = made.metric("verify", "max_warp_deg").where
    assert where is not None
    assert_near(where["v"], 1 / 3, bound=1e-7, why="the width of the fold")
    touching = passage(
        {"kind": "ruled", "c0": {"bezier": [[0, 0, 0], [1, 0, 0]]},
         "c1": {"bezier": [[x, 1, 0] for x in _dent("1/3", "0")]}}
    )  # fmt: skip
    assert touching.refused_by is None
    assert touching.value("verify", "regular") is False


def _dent(place: str, depth: str) -> list[str]:
    a, e = Fraction(place), Fraction(depth)
    m = [-(a**3) / 3, a**2 - e**2, -a, Fraction(1, 3)]
    return [str(x) for x in (m[0], m[0] + m[1] / 3, m[0] + 2 * m[1] / 3 + m[2] / 3, sum(m))]


@pytest.mark.parametrize("place", ["1/2", "0.3"])
def test_a_cusp_of_the_profile_is_refused_wherever_it_lies(place: str) -> None:
    """(v - a)^2, (v - a)^3 in Bernstein form, raised along z: the tangent plane turns back at v = a."""
    a = Fraction(place)
    x = [a * a, a * a - 2 * a / 3, a * a - 4 * a / 3 + Fraction(1, 3), (1 - a) ** 2]
    y = [-(a**3), -(a**3) + a**2, -(a**3) + 2 * a**2 - a, (1 - a) ** 3]
    profile = {"bezier": [[str(p), str(q), 0] for p, q in zip(x, y, strict=True)]}
    made = passage({"kind": "cylinder", "directrix": profile, "direction": [0, 0, 1], "length": 1})
    assert made.refused_by == "verify"
    assert made.codes("verify", fatal=True) == ["cusp"]
    assert made.value("verify", "regular") is False


@pytest.mark.parametrize("place", ["1/2", "0.3"])
def test_directrices_that_stop_and_go_on_are_accepted_and_named(place: str) -> None:
    """Profile x = (v - a)^3, z = x^2: the parabola z = x^2, run with a stop at v = a."""
    a = Fraction(place)
    x = [-(a**3), a**2 * (1 - a), -a * (1 - a) ** 2, (1 - a) ** 3]
    squares = [0, 1, 2, 3, 4, 5, 6]
    z = [sum(comb(3, i) * comb(3, k - i) * x[i] * x[k - i] for i in range(4) if 0 <= k - i <= 3) / comb(6, k)
         for k in squares]  # fmt: skip
    raised = [sum(Fraction(comb(3, i) * comb(3, k - i), comb(6, k)) * x[i] for i in range(4) if 0 <= k - i <= 3)
              for k in squares]  # fmt: skip
    profile = {"bezier": [[str(p), 0, str(q)] for p, q in zip(raised, z, strict=True)]}
    made = passage({"kind": "cylinder", "directrix": profile, "direction": [0, 1, 0], "length": 1})
    assert made.refused_by is None
    assert made.certificate is not None
    assert (made.certificate.reached, made.certificate.proved) == ("exact", True)
    assert made.value("verify", "regular") is True
    (finding,) = [f for f in made.reports["verify"].findings if f.code == "directrices-stop"]
    assert not finding.fatal
    assert finding.where is not None
    assert_near(finding.where["v"], float(a), bound=1e-15, why="an interval of 2^-50")
    low, high = float(x[0]), float(x[-1])
    lengths = [(t * hypot(1, 2 * t) + asinh(2 * t) / 2) / 2 for t in (low, high)]
    edges = made.side("flat")["edges"]
    assert isinstance(edges, dict)
    assert_relative([edges["c0"], edges["c1"]], [lengths[1] - lengths[0]] * 2, bound=1e-12, why="arc of a parabola")


def test_a_cusp_in_a_later_piece_is_named_with_its_piece() -> None:
    straight, cusp = {"line": [[-1, 0, 0], [0, 0, 0]]}, {"bezier": [[0, 0, 0], [1, 1, 0], [-1, 1, 0], [0, 0, 0]]}
    turned = {"bezier": [[0, 0, 0], [1, 1, 0], [0, 1, 0], [1, 0, 0]]}
    for curve, codes in ((cusp, []), (turned, ["cusp"])):
        made = passage({"kind": "cylinder", "directrix": {"chain": [straight, curve]}, "direction": [0, 0, 1],
                        "length": 1})  # fmt: skip
        found = [f for f in made.reports["verify"].findings if f.code == "cusp"]
        assert [f.code for f in found] == codes
        for finding in found:
            assert finding.fatal
            assert finding.where == {"piece": 1, "v": 1.5}
            assert "v = 1.5 (piece 1)" in finding.message


def test_a_ruling_of_no_length_inside_is_refused_at_its_place() -> None:
    plane = {"point": [0, 0, 0], "normal": [1, 0, 1]}
    made = passage({"kind": "cylinder", "directrix": CIRCLE, "direction": [0, 0, 1], "end_plane": plane})
    assert "zero-ruling" in made.codes("verify", fatal=True)


def test_rulings_along_the_profile_are_refused() -> None:
    made = passage({"kind": "cylinder", "directrix": CIRCLE, "direction": [1, 0, 0], "length": 5})
    assert "singular-ruling" in made.codes("verify", fatal=True)


@pytest.mark.parametrize(
    "table",
    [EXAMPLE_1, EXAMPLE_3, OBLIQUE_CONE | {"fraction": [0, 1]}, RIGHT_FRUSTUM | {"radius1": 0},
     RIGHT_FRUSTUM | {"radius0": 0}, RIGHT_FRUSTUM | {"radius1": 0, "height": 0}],
)  # fmt: skip
def test_a_normal_that_vanishes_at_an_edge_makes_a_part_irregular_and_passes(table: Table) -> None:
    made = passage(table)
    assert made.value("verify", "regular") is False
    assert made.refused_by is None
