"""Straps over centre lines that stop bending: at places, over straight pieces, and where no strap goes on."""

from fractions import Fraction
from math import asin, degrees, hypot, log, pi, sqrt

import numpy as np
import pytest

from stages.construct import construct
from stages.construct.strapstretch import _parts
from stages.geometry.arrays import norm
from stages.geometry.curves.curves import bezier, blossom
from stages.geometry.flat.development import develop
from stages.model.tolerances import Tolerances
from tests import oracles
from tests.inflections import CIRCLE, FREE, Along, control_points, frame, length, rising
from tests.near import assert_near, assert_relative
from tests.parts import Passage, Table, part, passage, patches

Rows = list[list[str]]


def over(rows: object, half: object) -> Table:
    return {"kind": "strap", "centre": {"bezier": rows}, "half_width": str(half)}


def joined(*pieces: object, half: object) -> Table:
    """Return a strap over Bezier curves end to end; two points are a line."""
    chain = [{"bezier" if len(rows) > 2 else "line": rows} for rows in pieces]  # type: ignore[arg-type]
    return {"kind": "strap", "centre": {"chain": chain}, "half_width": str(half)}


def edges(made: Passage) -> dict[str, float]:
    found = made.side("flat")["edges"]
    assert isinstance(found, dict)
    return found


# Through inflections


@pytest.mark.parametrize("size", [Fraction(1), Fraction(4000)])
@pytest.mark.parametrize("places", [["2/5"], ["2/5", "2/5"], ["0"], ["1", "1"], ["1/4", "3/4"]])
@pytest.mark.parametrize("a", [CIRCLE, FREE])
def test_a_strap_goes_on_where_the_torsion_vanishes_as_well(a: Along, places: list[str], size: Fraction) -> None:
    """Area 2 w L; sides L -+ w (lambda(1) - lambda(0)), lambda continuous; ends 2 w sqrt(1 + lambda^2)."""
    s, half = rising(places), 0.02 * float(size)
    made = passage(over(control_points(a, s, size), half))
    assert made.refused_by is None and made.reports["verify"].detail["class"] == "exact"
    whole, (first, last) = float(size) * float(length(a, s)), (float(frame(a, s, v)[2]) for v in (0, 1))
    found = edges(made)
    for side in ("surface", "flat"):
        assert_relative(made.side(side)["area"], 2.0 * half * whole, bound=1e-12, why="40 digits")
    sides = sorted([whole - half * (last - first), whole + half * (last - first)])
    assert_relative(sorted([found["c0"], found["c1"]]), sides, bound=1e-11, why="40 digits")
    ends = [2.0 * half * hypot(1.0, lean) for lean in (first, last)]
    assert_relative([found["start"], found["end"]], ends, bound=1e-11, why="40 digits")
    assert made.value("unroll", "metric_error") < 1e-11


def test_through_an_inflection_the_centre_line_unrolls_to_a_straight_line() -> None:
    (flat,) = develop(patches(over(control_points(FREE, rising(["2/5", "2/5"])), "0.03"))).pieces
    v = np.linspace(0.0, 1.0, 41)
    lines = [flat.positions(np.full_like(v, u), v) for u in (0.0, 0.5, 1.0)]
    along = (lines[1][-1] - lines[1][0]) / norm(lines[1][-1] - lines[1][0])
    for line, side in zip(lines, (0.03, 0.0, 0.03), strict=True):
        away = np.abs((line - lines[1][0]) @ np.array([-along[1], along[0]]))
        assert_near(away, np.full(41, side), bound=1e-12, why="a geodesic, and its parallels")


def test_with_weights_it_is_the_same_strap() -> None:
    """Weights q^i give the same curve another parameter, and its inflection another place."""
    rows = control_points(FREE, rising(["2/5"]))
    n = len(rows) - 1
    spline = {"degree": n, "knots": [0] * (n + 1) + [1] * (n + 1), "points": rows,
              "weights": [str(Fraction(2) ** i) for i in range(n + 1)]}  # fmt: skip
    made, plain = (
        passage({"kind": "strap", "centre": centre, "half_width": "0.02"})
        for centre in ({"bspline": spline}, {"bezier": rows})
    )
    assert_relative(made.side("flat")["area"], plain.side("flat")["area"], bound=1e-12, why="one surface")
    assert_relative([*edges(made).values()], [*edges(plain).values()], bound=1e-11, why="one surface")


def test_a_plane_piece_with_an_inflection_joins_a_space_curve() -> None:
    """(3t, 3t^2, 2t^4) leaves the plane z = 0 with tau = 0; before it an S-curve in that plane, curved alike."""
    quartic = control_points(([3], [0, 6], [0, 0, 0, 8]), [0, 1])
    s_curve = [["-6", "-4", 0], ["-4", "-1", 0], ["-3", "0.25", 0], ["-1", "0", 0], [0, 0, 0]]
    made = passage(joined(s_curve, quartic, half="0.05"))
    assert made.refused_by is None
    whole = sum(float(oracles.length(oracles.bezier(rows))) for rows in (s_curve, quartic))
    assert_relative(made.side("flat")["area"], 0.1 * whole, bound=1e-12, why="2 w L")


# Where it does not go on


POLE = control_points(([1], [0, 0, 3], [0, 0, 0, 4]), [Fraction(-1, 4), Fraction(1)])
"""(t, t^3, t^4), t from -1/4 to 3/4."""


def part_of(rows: Rows, low: float, high: float) -> Rows:
    exact = [[Fraction(x) for x in row] for row in rows]
    return [[str(x) for x in row] for row in blossom(exact, Fraction(low), Fraction(high))]


@pytest.mark.parametrize("half", ["0.01", "0.05", "0.0001"])
def test_an_inflection_with_torsion_is_refused_with_the_longest_part_that_does(half: str) -> None:
    made = passage(over(POLE, half))
    assert made.codes("construct", fatal=True) == ["strap-inflection"]
    (finding,) = made.reports["construct"].findings
    assert finding.where is not None
    assert_near(finding.where["v"], 0.25, bound=1e-15, why="an exact root")
    low, high = float(finding.where["from"]), float(finding.where["to"])
    assert high == 1.0 and f"from v = {low:.6f}" in finding.message
    away = low - 0.25
    assert passage(over(part_of(POLE, 0.25 + 1.001 * away, 1.0), half)).refused_by is None
    longer = passage(over(part_of(POLE, 0.25 + 0.999 * away, 1.0), half))
    assert longer.codes("construct", fatal=True) == ["strap-too-wide"]


@pytest.mark.parametrize("at", [0.37, 0.527, 0.63])
def test_a_narrow_place_between_the_samples_ends_a_part(at: float) -> None:
    """0.5 + 2 exp(-x^2), x = (v - at) / 0.0015: above 1 where |x| < sqrt(log 4), narrower than any two samples."""
    width = 0.0015
    parts = _parts(lambda v: 0.5 + 2.0 * np.exp(-(((v - at) / width) ** 2)), 0.0, 1.0)
    away = width * sqrt(log(4.0))
    assert_near(np.array(parts).ravel(), [0.0, at - away, at + away, 1.0], bound=1e-12, why="closed form, bisected")


def test_a_part_on_which_the_width_is_just_reached_stays_whole() -> None:
    """4 v (1 - v) (1 - 1e-12) touches 1 from below in the middle."""
    assert _parts(lambda v: 4.0 * v * (1.0 - v) * (1.0 - 1e-12), 0.0, 1.0) == [(0.0, 1.0)]


def run_off(made: Passage) -> tuple[float, ...]:
    """Return where rulings run off, and from where to where the longest part with a strap reaches."""
    (finding,) = made.reports["construct"].findings
    assert finding.code == "strap-inflection" and finding.where is not None
    where = finding.where
    return float(where["piece"]), *(float(where[key]) for key in ("v", "from", "to"))


def test_the_longest_part_takes_straight_pieces_at_its_end_with_it_either_way_round() -> None:
    """The tangent at the end of the curve, 3 mm long: on it no ruling runs off, whichever comes first."""
    alone = run_off(passage(over(POLE, "0.05")))
    end, before = (np.array([Fraction(x) for x in row]) for row in (POLE[-1], POLE[-2]))
    line = [[str(x) for x in row] for row in (end, end + 4 * (end - before))]
    there = run_off(passage(joined(POLE, line, half="0.05")))
    back = run_off(passage(joined(line[::-1], POLE[::-1], half="0.05")))
    assert_near(there, [0.0, 0.25, alone[2], 2.0], bound=1e-12, why="to the end of the line")
    assert_near(back, [1.0, 1.75, 0.0, 2.0 - alone[2]], bound=2e-6, why="told in millionths")


def test_the_part_is_that_at_which_the_lean_turns_at_one_over_the_width() -> None:
    """d lambda / ds = 1 / w by 40 digits at the end that is told."""
    made = passage(over(POLE, "0.01"))
    (finding,) = made.reports["construct"].findings
    assert finding.where is not None
    a, s = ([1], [0, 0, 3], [0, 0, 0, 4]), [Fraction(-1, 4), Fraction(1)]
    at = float(finding.where["from"])
    rate = oracles.mp.diff(lambda v: frame(a, s, v)[2], at) / oracles.norm(oracles.bezier(POLE)(oracles.mpf(at))[1])
    assert_relative(abs(float(rate)), 100.0, bound=1e-4, why="rounded to a millionth, 6e-2 from the pole, third power")


def test_one_digit_off_an_inflection_the_rulings_turn_too_fast_for_any_width_but_the_one_told() -> None:
    """Planted: the design of a strap that goes on, one control point off by a hundredth of a percent."""
    rows = control_points(FREE, rising(["2/5", "2/5"]))
    assert passage(over(rows, "0.02")).refused_by is None
    rows[3][2] = str(Fraction(rows[3][2]) + Fraction(1, 10**4))
    made = passage(over(rows, "0.02"))
    assert made.codes("construct", fatal=True) == ["strap-too-wide"]
    most = made.value("construct", "half_width_max_mm")
    assert isinstance(most, float)
    assert most < 0.02
    assert made.reports["construct"].findings[0].where["v"] == pytest.approx(0.4, abs=0.15)  # type: ignore[index]


# Straight pieces

AHEAD: Rows = control_points(CIRCLE, [0, 1], 3)
"""(3t, 3t^2, 2t^3): leaves along x, its osculating plane is z = 0, lambda = 1."""


def moved(
    rows: Rows, shift: float = 0.0, signs: tuple[int, int, int] = (1, 1, 1), turn: tuple[str, str] = ("1", "0")
) -> Rows:
    """Return the points turned about x by the angle with this cosine and sine, mirrored, and moved along x."""
    c, s = map(Fraction, turn)
    found = [[k * Fraction(x) for k, x in zip(signs, row, strict=True)] for row in rows]
    return [[str(x + Fraction(shift)), str(c * y - s * z), str(s * y + c * z)] for x, y, z in found]


BEHIND: Rows = moved(AHEAD, signs=(-1, 1, -1))[::-1]
"""(3t, 3t^2, 2t^3) for t from -1 to 0: arrives along x."""
LINE: Rows = [["0", "0", "0"], ["4", "0", "0"]]
MIRRORED = moved(AHEAD, 4, (1, 1, -1))
"""After the line, lambda = -1."""
CURVED_BACK = moved(AHEAD, 4, (1, -1, 1))
"""After the line, bent to the other side: B turns over, and lambda = -1 along it."""


@pytest.mark.parametrize("curves", [
    (BEHIND, LINE), (LINE, moved(AHEAD, 4)), (BEHIND, LINE, moved(AHEAD, 4)), (BEHIND, LINE, CURVED_BACK),
    (BEHIND, LINE, [["4", "0", "0"], ["5", "0", "0"]], moved(AHEAD, 5)),
])  # fmt: skip
def test_a_straight_piece_goes_on_from_the_curves_beside_it(curves: tuple[Rows, ...]) -> None:
    """One inclination all along: both sides are as long as the centre line."""
    made = passage(joined(*curves, half="0.3"))
    assert made.refused_by is None and made.reports["verify"].detail["class"] == "exact"
    whole = sum(float(oracles.length(oracles.bezier(rows))) for rows in curves)
    assert_relative(made.side("flat")["area"], 0.6 * whole, bound=1e-13, why="2 w L")
    found = edges(made)
    assert_relative([found["c0"], found["c1"]], [whole, whole], bound=1e-12, why="lambda is the same at both ends")
    assert_relative([found["start"], found["end"]], [0.6 * sqrt(2.0)] * 2, bound=1e-12, why="lambda = 1")
    assert made.value("construct", "half_width_max_mm") is None
    assert made.value("construct", "join_gap_mm") < 1e-14


@pytest.mark.parametrize("half", ["0.3", "1.998"])
def test_over_a_straight_piece_the_rulings_turn_evenly(half: str) -> None:
    """From lambda = 1 to -1: one side is longer by 2 w, the other shorter; at w = 2 the rulings of the line meet."""
    made = passage(joined(BEHIND, LINE, MIRRORED, half=half))
    w = float(half)
    assert made.refused_by is None
    assert_relative(made.value("construct", "half_width_max_mm"), 2.0, bound=1e-12, why="4 / (1 + 1)")
    assert_relative(made.side("flat")["area"], 2.0 * w * 14.0, bound=1e-12, why="2 w L, L = 5 + 4 + 5")
    found = edges(made)
    assert_relative(
        sorted([found["c0"], found["c1"]]), [14.0 - 2.0 * w, 14.0 + 2.0 * w], bound=1e-11, why="L -+ w (1 + 1)"
    )


def test_rulings_that_cross_over_a_straight_piece_are_refused_with_the_largest_width() -> None:
    made = passage(joined(BEHIND, LINE, MIRRORED, half="2.002"))
    assert made.codes("construct", fatal=True) == ["strap-too-wide"]
    (finding,) = made.reports["construct"].findings
    assert "less than 2 mm" in finding.message and 1.0 <= float(finding.where["v"]) <= 2.0  # type: ignore[index]


def test_a_line_goes_on_into_a_helix() -> None:
    """Along the tangent of the helix: the strap leaves its cylinder for the tangent plane."""
    rise = 50.0 / (2.0 * pi)
    line = {"line": [[30, -60, repr(-2.0 * rise)], [30, 0, 0]]}
    centre = {"chain": [line, {"helix": {"radius": 30, "pitch": 50, "turns": "0.75"}}]}
    made = passage({"kind": "strap", "centre": centre, "half_width": 8})
    steep = hypot(30.0, rise)
    assert_relative(made.side("flat")["area"], 16.0 * steep * (2.0 + 1.5 * pi), bound=1e-12, why="2 w L")
    assert_relative(edges(made)["start"], 16.0 * steep / 30.0, bound=1e-12, why="parallel to the axis")


def test_curves_that_leave_a_straight_piece_in_unlike_planes_are_refused_with_the_angle() -> None:
    turned = moved(AHEAD, 4, turn=("0.8", "0.6"))
    made = passage(joined(BEHIND, LINE, turned, half="0.3"))
    assert made.codes("construct", fatal=True) == ["strap-twisted"]
    (finding,) = made.reports["construct"].findings
    assert f"differ by {degrees(asin(0.6)):.4g} deg" in finding.message
    assert finding.where == {"piece": 1, "v": 1.0}


@pytest.mark.parametrize("off, twisted", [("0.000033", False), ("0.000034", True)])
def test_a_twist_counts_from_where_an_edge_is_off_by_the_tolerance(off: str, twisted: bool) -> None:
    """The angle times the half width against 1e-5 mm."""
    turned = moved(AHEAD, 4, turn=("1", off))
    made = construct(part(joined(BEHIND, LINE, turned, half="0.3")), Tolerances(join_mm=1e-5))
    assert ("strap-twisted" in [finding.code for finding in made.report.findings]) == twisted


def test_a_kink_between_straight_pieces_is_refused_unless_all_is_plane() -> None:
    kinked = [["4", "0", "0"], ["6", "2", "0"]]
    made = passage(joined(BEHIND, LINE, kinked, half="0.3"))
    assert made.codes("construct", fatal=True)[0] == "strap-kink"
    assert "a kink of 45 deg between straight pieces at v = 2" in made.reports["construct"].findings[0].message
    plane = passage({"kind": "strap", "centre": {"polyline": [*LINE, ["6", "2", "0"]]}, "half_width": "0.3"})
    assert_relative(plane.side("flat")["area"], 0.6 * (4.0 + sqrt(8.0)), bound=1e-13, why="a folded strip")


def test_straight_pieces_that_lie_in_no_one_plane_have_no_strap() -> None:
    bent = {"polyline": [[0, 0, 0], [10, 0, 0], [10, 10, 0], [10, 10, 10]]}
    made = passage({"kind": "strap", "centre": bent, "half_width": 1})
    assert made.codes("construct", fatal=True) == ["strap-inflection"]
    assert "straight pieces only" in made.reports["construct"].findings[0].message


def test_the_test_curves_are_what_they_say() -> None:
    end = bezier([[Fraction(x) for x in row] for row in BEHIND]).jet(np.ones(1), 1)[:, 0]
    assert_near(end, [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0]], bound=0.0, why="small whole numbers")
