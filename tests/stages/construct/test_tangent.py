"""Tangent surfaces: a helix in closed form, other edges in 40 digits, and what is refused."""

from fractions import Fraction
from math import hypot, pi, sqrt

import numpy as np
import pytest
from mpmath import mpf

from stages.geometry.arrays import EPS, norm
from stages.geometry.ruled import ruled
from stages.geometry.ruled.ruled import frames, regression
from tests import oracles
from tests.near import assert_near, assert_relative
from tests.parts import Table, passage, patches, troubles

RADIUS, RISE, SWEEP = 2.0, 1.0, 2.0
HELIX: Table = {
    "kind": "tangent", "edge": {"helix": {"radius": 2, "pitch": repr(2 * pi), "turns": repr(1 / pi)}},
    "from": 0.5, "to": 2,
}  # fmt: skip
"""The edge (2 cos t, 2 sin t, t), t in [0, 2]."""
ROWS = [[0, 0, 0], [100, 0, 20], [200, 130, 60], [250, 200, 180]]
CUBIC: Table = {"kind": "tangent", "edge": {"bezier": ROWS}, "from": 50, "to": 200}


def edges(made: object, side: str) -> dict[str, float]:
    found = made.side(side)["edges"]
    assert isinstance(found, dict)
    return found


@pytest.mark.parametrize("side", ["surface", "flat"])
def test_the_tangents_of_a_helix_have_their_closed_forms(side: str) -> None:
    """kappa = a / (a^2 + b^2); area: (to^2 - from^2) / 2 of the total curvature; |(r + u T)'| = s sqrt(1 + u^2 k^2)."""
    made = passage(HELIX)
    speed, kappa = hypot(RADIUS, RISE), RADIUS / (RADIUS**2 + RISE**2)
    turn = kappa * speed * SWEEP
    lengths = [SWEEP * speed * sqrt(1.0 + (u * kappa) ** 2) for u in (0.5, 2.0)]
    found = edges(made, side)
    assert_relative(made.side(side)["area"], (4.0 - 0.25) / 2.0 * turn, bound=1e-14, why="quadrature to rounding")
    assert_relative([found["c0"], found["c1"]], lengths, bound=1e-14, why="quadrature to rounding")
    assert_relative([found["start"], found["end"]], [1.5, 1.5], bound=4 * EPS, why="to - from along a unit vector")
    assert_relative(made.value("verify", "turn_deg"), np.degrees(turn), bound=1e-13, why="the total curvature")


def test_the_tangents_of_a_cubic_have_the_lengths_and_area_of_40_digits() -> None:
    curve = oracles.bezier(ROWS)

    def turning(v: mpf) -> mpf:
        _, slope, bend = curve(v)
        return oracles.norm(oracles.cross(slope, bend)) / oracles.dot(slope, slope)

    def speed(reach: int) -> oracles.Callable[[mpf], mpf]:
        return lambda v: oracles.mp.hypot(oracles.norm(curve(v)[1]), reach * turning(v))

    made = passage(CUBIC)
    for side in ("surface", "flat"):
        found = edges(made, side)
        area = (200**2 - 50**2) * oracles.Antiderivative(turning)(1) / 2
        assert_relative(made.side(side)["area"], area, bound=1e-13, why="quadrature of the positions")
        exact = [oracles.Antiderivative(speed(reach))(1) for reach in (50, 200)]
        assert_relative([found["c0"], found["c1"]], exact, bound=1e-13, why="quadrature of the positions")
    assert made.reports["verify"].detail["class"] == "exact"
    assert made.metric("verify", "max_warp_deg").evidence == "sampled"


def test_the_edge_of_regression_is_the_given_curve() -> None:
    (patch,) = patches(CUBIC)
    v = np.linspace(0.0, 1.0, 9)
    assert_near(regression(frames(patch, v)), np.full(9, -50.0 / 150.0), bound=1e-13, why="a quotient of products")
    T = patch.p.jet(v, 0)[0] / 150.0
    assert_near(norm(T), np.ones(9), bound=4 * EPS, why="unit tangents")


def test_rulings_may_start_on_the_edge_and_run_backwards() -> None:
    made = passage(CUBIC | {"from": 0, "to": -200})
    assert made.refused_by is None
    assert made.value("verify", "regular") is False
    whole = passage(CUBIC | {"from": 0, "to": 200}).side("flat")["area"]
    assert_relative(made.side("flat")["area"], whole, bound=1e-13, why="(to^2 - from^2) / 2 times the total curvature")


def test_a_smooth_spline_makes_a_strip_without_gaps() -> None:
    made = passage(CUBIC | {"edge": {"points": [*ROWS, [200, 300, 300]]}})
    assert made.refused_by is None
    assert_near(
        made.value("construct", "join_gap_mm"), 0.0, bound=1e-11, why="tangents of 200 mm, rounded control points"
    )


@pytest.mark.parametrize("factor", [1e-2, 40.0])
def test_the_pattern_scales_with_the_part(factor: float) -> None:
    grown = {"edge": {"bezier": [[factor * x for x in row] for row in ROWS]}, "from": 50 * factor, "to": 200 * factor}
    area = passage(CUBIC).side("flat")["area"]
    assert isinstance(area, float)
    made = passage(CUBIC | grown).side("flat")["area"]
    assert_relative(made, factor**2 * area, bound=1e-13, why="quadrature to rounding, decimals rounded")


def test_a_part_of_the_surface_is_the_same_surface() -> None:
    (patch,) = patches(CUBIC)
    low, high = Fraction(1, 5), Fraction(3, 4)
    inside = ruled.part(patch, low, high)
    u, v = np.array([0.0, 0.3, 1.0]), np.array([0.0, 0.6, 1.0])
    there = ruled.at(patch, u, float(low) + float(high - low) * v)
    assert_near(ruled.at(inside, u, v), there, bound=64 * EPS * 500.0, why="coordinates up to 500, a dozen products")


# Refusals


@pytest.mark.parametrize(
    ("edge", "code"),
    [
        ({"bezier": [[0, 0, 0], [100, 100, 0], [0, 100, 0], [100, 0, 0]]}, "curve-stops"),
        ({"bezier": [[0, 0, 0], [0, 0, 0], [0, 100, 50], [100, 0, 0]]}, "curve-stops"),
        ({"bezier": [[0, 0, 0], [1, 2, 3], [3, 6, 9], [4, 8, 12]]}, "edge-straight"),
        ({"chain": [{"bezier": ROWS}, {"bezier": [[250, 200, 180], [300, 200, 180], [300, 300, 0]]}]}, "kink"),
        ({"chain": [{"bezier": ROWS}, {"line": [[250, 200, 180], [300, 270, 300]]}]}, "edge-straight"),
    ],
)
def test_an_edge_that_makes_no_surface_is_refused_with_the_reason(edge: Table, code: str) -> None:
    made = passage(CUBIC | {"edge": edge})
    assert made.refused_by == "construct"
    assert code in made.codes("construct", fatal=True)


def test_a_kink_is_named_with_its_angle_and_piece() -> None:
    edge = {
        "chain": [{"bezier": [[0, 0, 0], [10, 0, 0], [20, 10, 0]]}, {"bezier": [[20, 10, 0], [20, 20, 0], [0, 30, 5]]}]
    }
    (finding,) = (f for f in passage(CUBIC | {"edge": edge}).reports["construct"].findings if f.code == "kink")
    assert "a kink of 45 deg at v = 1 of piece 0" in finding.message
    assert finding.where == {"piece": 0}


@pytest.mark.parametrize("lift", [0, 40])
def test_where_the_curvature_vanishes_verify_says_that_the_surface_turns_back(lift: int) -> None:
    """r = (300 v, ..., 16 lift (v - 1/2)^4): r'' = 0 at v = 1/2, and the binormal turns back there."""
    rows = [[0, 0, lift], [75, 75, -lift], [150, 0, lift], [225, -75, -lift], [300, 0, lift]]
    made = passage(CUBIC | {"edge": {"bezier": rows}})
    assert made.refused_by == "verify"
    (finding,) = (f for f in made.reports["verify"].findings if f.fatal)
    assert finding.code == "singular-ruling"
    assert_near(finding.where["v"], 0.5, bound=1e-6, why="a sampled zero")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"from": -1}, "the edge of regression lies between from and to"),
        ({"from": 200}, "the same distance as from"),
        ({"edge": {"line": [[0, 0, 0], [1, 2, 3]]}}, "a straight line is its own only tangent"),
        ({"edge": {"polyline": [[0, 0, 0], [1, 2, 3], [4, 0, 0]]}}, "straight lines are their own only tangents"),
        ({"edge": {"bezier": [[0, 0], [1, 2], [3, 0]]}}, "a point with two coordinates"),
    ],
)
def test_what_the_job_file_alone_shows_is_a_trouble(change: Table, message: str) -> None:
    assert troubles(CUBIC) == []
    assert troubles(CUBIC | change) == [message]
