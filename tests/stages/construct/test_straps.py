"""Straps: straight strips in the flat, on curves whose torsion and curvature are known; and what no strap can do."""

from collections.abc import Callable
from fractions import Fraction
from functools import cache
from math import hypot, pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mp, mpf

from stages.construct.curves import Chain
from stages.construct.straprulings import senses
from stages.construct.straps import strap
from stages.geometry.arrays import norm
from stages.geometry.curves.curves import Bezier, Circular
from stages.geometry.flat.development import develop
from stages.geometry.ruled.envelope import Rectifying
from stages.geometry.ruled.ruled import frames
from stages.model.envelopes import Strap
from stages.model.tolerances import Tolerances
from tests import oracles
from tests.near import assert_near, assert_relative
from tests.parts import Table, passage, patches, read, troubles
from tests.strategies import scales, texts

Rows = list[list[object]]
CUBIC: Rows = [[0, 0, 0], [1, 0, 0], [2, 1, 0], [3, 3, 2]]
"""(3t, 3t^2, 2t^3): length 5, tau = kappa, so that the strap is a cylinder along (1, 0, 1)."""
QUINTIC: Rows = [[0, 0, 0], [1, 0.25, 0], [2, 1, 0.5], [2.5, 2.5, 1], [2, 3.5, 2.5], [1, 4, 4]]
S_CURVE: Rows = [[0, 0, 0], [3, 0, 0], [1, 0, 2], [4, 0, 2]]


def over(rows: Rows, half: object, size: object = 1) -> Table:
    scaled = [[str(Fraction(str(size)) * Fraction(str(x))) for x in row] for row in rows]
    return {"kind": "strap", "centre": {"bezier": scaled}, "half_width": str(Fraction(str(size)) * Fraction(str(half)))}


@cache
def lean_of(rows: tuple[tuple[object, ...], ...]) -> Callable[[mpf], mpf]:
    """Return tau / kappa of a Bezier curve to 40 digits."""
    curve = oracles.bezier(rows)
    third = [[oracles.exact(x) for x in row] for row in rows]
    for _ in range(3):
        n = len(third) - 1
        third = [[n * (third[i + 1][k] - third[i][k]) for k in range(3)] for i in range(n)]
    last = oracles.bezier_of([tuple(row) for row in third])

    def lean(v: mpf) -> mpf:
        _, r1, r2 = curve(v)
        b = oracles.cross(r1, r2)
        kappa = oracles.norm(b) / oracles.norm(r1) ** 3
        return oracles.dot(b, last(v)[0]) / oracles.dot(b, b) / kappa

    return lean


def frozen(rows: Rows) -> tuple[tuple[object, ...], ...]:
    return tuple(tuple(row) for row in rows)


# Closed forms


@given(scales())
@settings(max_examples=3, deadline=None)
def test_a_curve_of_constant_slope_gives_a_cylinder_of_known_size(size: Fraction) -> None:
    made = passage(over(CUBIC, "0.2", size))
    factor = float(size)
    assert made.refused_by is None
    assert_relative(made.side("flat")["area"], 2.0 * factor**2, bound=1e-13, why="2 w L, L = 5, w = 0.2")
    edges = made.side("flat")["edges"]
    wanted = {"c0": 5.0, "c1": 5.0, "start": 0.4 * sqrt(2.0), "end": 0.4 * sqrt(2.0)}
    for name, length in wanted.items():
        assert_relative(edges[name], factor * length, bound=1e-13, why="tau / kappa = 1 everywhere")
    assert made.value("construct", "half_width_max_mm") is None
    assert made.value("verify", "max_warp_deg") < 1e-9


def test_a_helix_is_the_centre_line_of_a_strip_wound_on_its_cylinder() -> None:
    table = {"kind": "strap", "centre": {"helix": {"radius": 30, "pitch": 50, "turns": "1.5"}}, "half_width": 15}
    made = passage(table)
    assert_relative(made.side("flat")["area"], 30.0 * 1.5 * hypot(60.0 * pi, 50.0), bound=1e-13, why="2 w L")
    for patch in patches(table):
        for curve in (patch.c0, patch.c1):
            away = norm(curve.jet(np.linspace(0.0, 1.0, 33), 0)[0][:, :2])
            assert_near(away, np.full(33, 30.0), bound=1e-12, why="on the cylinder")


@pytest.mark.parametrize("size", [1, 2500])
def test_a_strap_is_a_straight_strip_cut_along_its_end_rulings(size: int) -> None:
    """Area 2 w L; the sides are L -+ w (lambda(1) - lambda(0)); an end 2 w sqrt(1 + lambda^2) long."""
    made, half, lean = passage(over(QUINTIC, "0.2", size)), mpf(1) / 5, lean_of(frozen(QUINTIC))
    length, first, last = oracles.length(oracles.bezier(QUINTIC)), lean(mpf(0)), lean(mpf(1))
    assert_relative(made.side("flat")["area"], float(2 * half * length) * size**2, bound=1e-12, why="40 digits")
    edges = made.side("flat")["edges"]
    sides = {
        "c0": length - half * (last - first), "c1": length + half * (last - first),
        "start": 2 * half * mp.sqrt(1 + first**2), "end": 2 * half * mp.sqrt(1 + last**2),
    }  # fmt: skip
    for name, wanted in sides.items():
        assert_relative(edges[name], float(wanted) * size, bound=1e-12, why="40 digits")


def test_the_centre_line_and_both_sides_unroll_to_straight_lines() -> None:
    (flat,) = develop(patches(over(QUINTIC, "0.2"))).pieces
    v = np.linspace(0.0, 1.0, 41)
    lines = [flat.positions(np.full_like(v, u), v) for u in (0.0, 0.5, 1.0)]
    along = (lines[1][-1] - lines[1][0]) / norm(lines[1][-1] - lines[1][0])
    across = np.array([-along[1], along[0]])
    for line, side in zip(lines, (0.2, 0.0, -0.2), strict=True):
        away = np.abs((line - lines[1][0]) @ across)
        assert_near(away, np.full(41, abs(side)), bound=1e-13, why="a geodesic, and its parallels")


def test_a_plane_curve_has_the_cylinder_over_it_inflections_and_all() -> None:
    made = passage(over(S_CURVE, "0.5"))
    assert made.metric("verify", "max_warp_deg").evidence == "proved"
    assert made.value("verify", "max_warp_deg") == 0.0
    length = float(oracles.length(oracles.bezier(S_CURVE)))
    assert_relative(made.side("flat")["area"], length, bound=1e-13, why="2 w L, w = 0.5")
    assert all(isinstance(patch.c0, Bezier) for patch in patches(over(S_CURVE, "0.5")))


@pytest.mark.parametrize("plane", [0, 1, 2])
def test_plane_curves_of_other_sorts_and_in_any_plane_have_theirs(plane: int) -> None:
    normal = [0, 0, 0]
    normal[plane] = 1
    arc = {"arc": {"center": [1, 2, 3], "radius": 40, "normal": normal, "start": 0, "end": 90}}
    made = passage({"kind": "strap", "centre": arc, "half_width": 5})
    assert_relative(made.side("flat")["area"], 10.0 * 20.0 * pi, bound=1e-13, why="a quarter of a pipe")
    kinked = {"polyline": [[0, 0, 0], [10, 0, 10], [20, 0, 0]]}
    folded = passage({"kind": "strap", "centre": kinked, "half_width": 5})
    assert_relative(folded.side("flat")["area"], 10.0 * 20.0 * sqrt(2.0), bound=1e-13, why="a folded strip")


def test_a_strap_run_backwards_is_the_same_strap() -> None:
    there, back = passage(over(QUINTIC, "0.2")), passage(over(QUINTIC[::-1], "0.2"))
    assert_relative(back.side("flat")["area"], there.side("flat")["area"], bound=1e-13, why="the same surface")
    a, b = there.side("flat")["edges"], back.side("flat")["edges"]
    assert_relative([b["start"], b["end"]], [a["end"], a["start"]], bound=1e-12, why="ends exchanged")
    assert_relative([b["c0"], b["c1"]], [a["c1"], a["c0"]], bound=1e-12, why="B turns over with the curve")


def control() -> st.SearchStrategy[Rows]:
    """Return four points that climb in x, so that the curve neither stops nor is far from a helix."""
    step = st.integers(1, 9).map(lambda n: Fraction(n, 10))
    return st.tuples(step, step, step).map(
        lambda f: [texts(row) for row in ((0, 0, 0), (1, 0, 0), (1 + f[0], 1, 0), (2, 1 + f[1], f[2]))]
    )


@given(control())
@settings(max_examples=4, deadline=None)
def test_every_strap_that_is_made_has_the_area_of_its_strip(rows: Rows) -> None:
    made = passage(over(rows, "0.02"))
    if made.refused_by is not None:
        assert made.codes("construct", fatal=True) == ["strap-too-wide"]
        return
    length = float(oracles.length(oracles.bezier(rows)))
    assert_relative(made.side("flat")["area"], 0.04 * length, bound=1e-11, why="2 w L")
    assert made.value("verify", "max_warp_deg") < 1e-9


# Pieces


SMOOTH = {"bspline": {"degree": 4, "knots": [0] * 5 + [1] + [2] * 5,
          "points": [[0, 0, 0], [1, 0, 0], [2, 0.5, 0.2], [3, 2, 0.8], [3, 4, 2], [2, 5, 4]]}}  # fmt: skip
ROUGH = {"points": [[0, 0, 0], [2, 0, 0], [3, 1, 1], [3, 3, 3], [1, 5, 4]]}


def test_pieces_of_a_spline_with_three_derivatives_share_their_rulings() -> None:
    made = passage({"kind": "strap", "centre": SMOOTH, "half_width": "0.1"})
    assert made.refused_by is None
    assert made.surface is not None and len(made.surface.patches) == 2
    assert made.value("construct", "join_gap_mm") < 1e-13
    assert_relative(
        made.side("flat")["area"], 0.2 * sum(_lengths(made.surface.patches)), bound=1e-12, why="2 w L, L by chords"
    )


def _lengths(found: tuple[object, ...]) -> list[float]:
    """Return the lengths of the middle lines, by Gauss-Legendre of high order: the centre curve's."""
    nodes, weights = np.polynomial.legendre.leggauss(60)
    v = (nodes + 1.0) / 2.0
    lengths = []
    for patch in found:
        f = frames(patch, v)
        lengths.append(float(weights @ norm(f.c0_d1 + 0.5 * f.p_d1)) / 2.0)
    return lengths


def test_pieces_whose_torsion_jumps_are_refused_at_their_joint() -> None:
    """A cubic spline has two continuous derivatives, tau three."""
    made = passage({"kind": "strap", "centre": ROUGH, "half_width": "0.01"}, Tolerances(join_mm=1e-4))
    joints = [f for f in made.reports["construct"].findings if f.code == "strap-joint"]
    assert made.refused_by == "construct"
    assert joints and joints[0].fatal
    assert joints[0].where is not None and joints[0].where["v"] in (1.0, 2.0, 3.0)


def test_where_the_curve_bends_the_other_way_the_strap_does_not_turn_over() -> None:
    """Two curves of one slope on cylinders that touch along a ruling; B and tau change their signs between them."""
    x, y, z = np.eye(3)
    first = Circular(np.zeros(3), 2.0 * x, 2.0 * y, 0.5 * z, 0.0, 1.0)
    cos, sin = float(np.cos(1.0)), float(np.sin(1.0))
    radial, along = cos * x + sin * y, cos * y - sin * x
    second = Circular(4.0 * radial + 0.5 * z, -2.0 * radial, 2.0 * along, 0.5 * z, 0.0, 1.0)
    assert_near(second.jet(np.zeros(1), 1)[:, 0], first.jet(np.ones(1), 1)[:, 0], bound=1e-15, why="the test's own")
    assert senses([Rectifying(first), Rectifying(second)]) == [1.0, -1.0]
    spec = read({"kind": "strap", "centre": {"bezier": CUBIC}, "half_width": "0.3"}).surface
    assert isinstance(spec, Strap)
    built = strap(spec, Chain((first, second), (Fraction(0), Fraction(1, 2), Fraction(1))), Tolerances())
    assert not built.findings
    a, b = built.patches
    for one, other in ((a.c0, b.c0), (a.c1, b.c1)):
        assert_near(one.jet(np.ones(1), 0), other.jet(np.zeros(1), 0), bound=1e-14, why="one ruling")


# Refusals


def test_a_strap_too_wide_is_refused_with_the_largest_width_that_would_do() -> None:
    """1 / max |d lambda / ds|, by 40 digits on a fine grid."""
    curve, lean = oracles.bezier(QUINTIC), lean_of(frozen(QUINTIC))
    rates = [abs(mp.diff(lean, mpf(k) / 200) / oracles.norm(curve(mpf(k) / 200)[1])) for k in range(201)]
    limit = float(1 / max(rates))
    made = passage(over(QUINTIC, "0.2"))
    metric = made.metric("construct", "half_width_max_mm")
    assert_relative(metric.value, limit, bound=1e-3, why="the grid misses the largest rate by the square of its step")
    assert metric.value is not None and float(metric.value) <= limit * (1.0 + 1e-12)
    below, above = (passage(over(QUINTIC, repr(float(metric.value) * f))) for f in (0.999, 1.001))
    assert below.refused_by is None
    assert above.codes("construct", fatal=True) == ["strap-too-wide"]
    (finding,) = above.reports["construct"].findings
    assert finding.where == metric.where
    assert f"{float(metric.value):.6g} mm" in finding.message


def test_an_inflection_in_space_is_refused_with_its_place() -> None:
    """(t, t^3, t^4) from -1/4 to 3/4: no curvature at t = 0, v = 1/4."""
    t = np.polynomial.Polynomial([-0.25, 1.0])
    powers = [np.pad((t**k).coef, (0, 4 - k)) for k in (1, 3, 4)]
    rows = np.array([[sum(np.prod([(i - j) / (4 - j) for j in range(k)]) * c[k] for k in range(5)) for c in powers]
                     for i in range(5)])  # fmt: skip
    made = passage(over(rows.tolist(), "0.01"))
    assert made.codes("construct", fatal=True) == ["strap-inflection"]
    (finding,) = made.reports["construct"].findings
    assert finding.where is not None and finding.where["v"] == pytest.approx(0.25, abs=1e-7)
    assert "split there" in finding.message


def test_a_straight_line_has_no_strap() -> None:
    made = passage({"kind": "strap", "centre": {"line": [[0, 0, 0], [1, 2, 3]]}, "half_width": 1})
    (finding,) = made.reports["construct"].findings
    assert (finding.code, finding.fatal, finding.where) == ("strap-inflection", True, {"piece": 0, "v": 0.0})


def test_a_curve_that_stops_has_no_strap() -> None:
    made = passage(over([[0, 0, 0], [0, 0, 0], [1, 1, 0], [2, 1, 1], [2, 3, 5]], "0.1"))
    assert made.codes("construct", fatal=True) == ["curve-stops"]


def test_an_open_chain_is_refused() -> None:
    pieces = {"chain": [{"line": [[0, 0, 0], [1, 0, 0]]}, {"line": [[1, 0, 1], [2, 0, 1]]}]}
    assert "chain-open" in passage({"kind": "strap", "centre": pieces, "half_width": 1}).codes("construct", fatal=True)


def test_what_the_job_file_alone_shows() -> None:
    assert troubles(over(CUBIC, "-1")) == ["-1"]
    flat = {"kind": "strap", "centre": {"bezier": [[0, 0], [1, 1], [2, 0]]}, "half_width": 1}
    assert troubles(flat) == ["a point with two coordinates"]
