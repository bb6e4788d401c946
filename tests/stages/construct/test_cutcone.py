"""Cones cut by planes: ellipses in closed form, 40-digit lengths and areas, proofs, the plane itself, refusals."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import ellipe, mp, mpf

from stages.geometry.arrays import EPS, norm
from stages.geometry.curves.curves import RationalBezier
from stages.geometry.curves.stepped import Stepped
from stages.geometry.ruled.ruled import warp
from tests import oracles
from tests.near import assert_near, assert_relative
from tests.parts import Table, edges, passage, patches, whole

HALF_ANGLE = 20
SLOPED: Table = {"point": [0, 0, 300], "normal": ["-0.4", 0, 1]}
"""z = 300 + 0.4 x."""
OBLIQUE_CUT: Table = {
    "kind": "cone", "radius0": 0, "radius1": repr(float(mp.tan(mp.radians(HALF_ANGLE)) * 400)), "height": 400,
    "end_plane": SLOPED,
}  # fmt: skip
FRUSTUM: Table = {
    "kind": "cone", "radius0": 80, "radius1": 40, "height": 120,
    "start_plane": {"point": [0, 0, 10], "normal": ["0.2", "-0.1", 1]},
    "end_plane": {"point": [0, 0, 150], "normal": ["-0.3", "0.1", 1]},
}  # fmt: skip
PIPE: Table = {"kind": "cone", "radius0": 50, "radius1": 50, "height": 300, "end_plane": SLOPED}
HOPPER: Table = {
    "kind": "cone", "apex": [30, 20, -250], "directrix": {"ellipse": {"center": [0, 0, 0], "major": [90, 0, 10],
    "minor": [0, 60, 0]}}, "end_plane": {"point": [0, 0, -120], "normal": ["0.2", "0.3", 1]},
}  # fmt: skip
SMALL: Table = {
    "kind": "cone", "radius0": 0.6, "radius1": 0.2, "height": 1, "sweep": 250,
    "start_plane": {"point": [0, 0, "0.1"], "normal": ["0.1", 0, 1]},
}  # fmt: skip
LARGE: Table = {
    "kind": "cone", "radius0": 4000, "radius1": 1500, "height": 9000,
    "end_plane": {"point": [0, 0, 8000], "normal": [1, 1, 3]},
}  # fmt: skip
BEZIER: Table = {
    "kind": "cone", "apex": [30, 20, 200],
    "directrix": {"bezier": [[80, 0, 0], [80, 60, 0], [20, 110, 10], [-60, 80, 0]]},
    "start_plane": {"point": [0, 0, 20], "normal": ["0.1", "0.2", 1]},
    "end_plane": {"point": [0, 0, 120], "normal": ["0.3", 0, 1]},
}  # fmt: skip
QUARTER: Table = {
    "kind": "cone", "apex": [0, 0, 100],
    "directrix": {"bspline": {"degree": 2, "knots": [0, 0, 0, 1, 1, 1], "points": [[50, 0, 0], [50, 50, 0], [0, 50, 0]],
                              "weights": [1, "0.70710678118654752440", 1]}},
    "end_plane": {"point": [0, 0, 60], "normal": ["-0.5", "0.25", 1]},
}  # fmt: skip
ROUND = [OBLIQUE_CUT, FRUSTUM, PIPE, HOPPER, SMALL, LARGE]
EXACT = [BEZIER, QUARTER]
EVERY = pytest.mark.parametrize("table", ROUND + EXACT)


# Oracles: the rulings of both forms, cut one by one


def exact(values: object) -> oracles.Vec:
    return tuple(oracles.exact(x) for x in values)  # type: ignore[attr-defined]


def rulings(table: Table) -> tuple[oracles.Space, oracles.Space]:
    """Return where rulings start, uncut, and their way to the other end, as curves."""
    if "apex" in table:
        spec = table["directrix"]
        assert isinstance(spec, dict)
        if "bezier" in spec:
            r = oracles.bezier(spec["bezier"])
        elif "bspline" in spec:
            r = oracles.rational(spec["bspline"]["points"], spec["bspline"]["weights"])
        else:
            r = oracles.turning(*(spec["ellipse"][k] for k in ("center", "major", "minor")), [0, 0, 0], 2 * mp.pi)
        return r, oracles.combined(oracles.fixed(table["apex"]), r, -1)  # type: ignore[arg-type]
    sweep = mp.radians(oracles.exact(table.get("sweep", 360)))
    low, high = (
        oracles.turning([0, 0, z], [radius, 0, 0], [0, radius, 0], [0, 0, 0], sweep)
        for radius, z in ((table["radius0"], 0), (table["radius1"], table["height"]))
    )
    return low, oracles.combined(high, low, -1)


def cut(table: Table, key: str, uncut: int) -> oracles.Space:
    """Return where the rulings meet a plane, by the quotient rule."""
    start, way = rulings(table)
    plane = table.get(key)
    if plane is None:
        return oracles.combined(start, way, uncut)
    assert isinstance(plane, dict)
    n, point = exact(plane["normal"]), exact(plane["point"])

    def jet(v: mpf) -> oracles.Jet:
        r, d = start(v), way(v)
        above = [oracles.dot(n, point) - oracles.dot(n, r[0]), *(-oracles.dot(n, r[k]) for k in (1, 2))]
        below = [oracles.dot(n, d[k]) for k in (0, 1, 2)]
        s = above[0] / below[0]
        s1 = (above[1] - s * below[1]) / below[0]
        s2 = (above[2] - 2 * s1 * below[1] - s * below[2]) / below[0]
        return (
            oracles.add(r[0], d[0], s),
            oracles.add(oracles.add(r[1], d[0], s1), d[1], s),
            oracles.add(oracles.add(oracles.add(r[2], d[0], s2), d[1], 2 * s1), d[2], s),
        )

    return jet


def both(table: Table) -> tuple[oracles.Space, oracles.Space]:
    return cut(table, "start_plane", 0), cut(table, "end_plane", 1)


@EVERY
def test_lengths_and_area_are_those_of_quadrature_to_40_digits(table: Table) -> None:
    c0, c1 = both(table)
    ends = [oracles.norm(oracles.add(c1(mpf(v))[0], c0(mpf(v))[0], -1)) for v in (0, 1)]
    pointed = table is OBLIQUE_CUT
    wanted = [0.0 if pointed else float(oracles.length(c0)), float(oracles.length(c1)), *map(float, ends)]
    area = oracles.area(c0, c1)
    for side in ("flat", "surface"):
        found = [edges(table, side)[key] for key in ("c0", "c1", "start", "end")]
        assert_relative(found[pointed:], wanted[pointed:], bound=1e-12, why="panels to rounding")
        assert_relative(whole(table).side(side)["area"], float(area), bound=1e-12, why="panels to rounding")


def test_the_rulings_of_the_oblique_cut_have_their_length_in_closed_form() -> None:
    # s = 300 / (cos 20 - 0.4 sin 20 cos t)
    (patch,) = patches(OBLIQUE_CUT)
    v = np.linspace(0.0, 1.0, 17)
    angle = np.radians(HALF_ANGLE)
    wanted = 300.0 / (np.cos(angle) - 0.4 * np.sin(angle) * np.cos(2.0 * np.pi * v))
    assert_relative(norm(patch.p.jet(v, 0)[0]), wanted, bound=1e-14, why="closed form")
    sector = 2.0 * np.pi * np.sin(angle)
    corners = whole(OBLIQUE_CUT).side("flat")["corners"]
    assert isinstance(corners, list)
    first, last = np.array(corners[1]), np.array(corners[2])
    turned = np.arctan2(first[0] * last[1] - first[1] * last[0], first @ last)
    assert_near(turned, sector, bound=1e-12, why="2 pi sin of the half angle, below half a turn")


def ellipse_length(table: Table, plane: Table) -> mpf:
    """Return the length of the ellipse in which a plane cuts a right cone about z: by its semi-axes."""
    n = exact(plane["normal"])
    across = mp.sqrt(n[0] ** 2 + n[1] ** 2)
    slope, height = across / n[2], oracles.dot(n, exact(plane["point"])) / n[2]
    r0, r1, h = (oracles.exact(table[key]) for key in ("radius0", "radius1", "height"))
    grows = (r1 - r0) / h
    # along the slope: x = +-(r0 + g z), z = height - slope x
    ends = [sign * (r0 + grows * height) / (1 + sign * grows * slope) for sign in (1, -1)]
    major = (ends[0] - ends[1]) / 2 * mp.sqrt(1 + slope**2)
    middle = sum(ends) / 2
    minor = mp.sqrt((r0 + grows * (height - slope * middle)) ** 2 - middle**2)
    a, b = max(major, minor), min(major, minor)
    return 4 * a * ellipe(1 - (b / a) ** 2)


@pytest.mark.parametrize(("table", "key", "edge"), [
    (OBLIQUE_CUT, "end_plane", "c1"), (FRUSTUM, "start_plane", "c0"), (FRUSTUM, "end_plane", "c1"),
    (PIPE, "end_plane", "c1"), (LARGE, "end_plane", "c1"),
])  # fmt: skip
def test_a_right_cone_is_cut_in_ellipses(table: Table, key: str, edge: str) -> None:
    plane = table[key]
    assert isinstance(plane, dict)
    for side in ("flat", "surface"):
        wanted = float(ellipse_length(table, plane))
        assert_relative(edges(table, side)[edge], wanted, bound=1e-12, why="complete elliptic integral to 40 digits")


@EVERY
def test_edges_lie_in_their_planes_and_rulings_run_to_the_apex(table: Table) -> None:
    v = np.linspace(0.0, 1.0, 17)
    for patch in patches(table):
        for key, curve in (("start_plane", patch.c0), ("end_plane", patch.c1)):
            plane = table.get(key)
            if isinstance(plane, dict):
                n, point = (np.array([float(x) for x in exact(plane[k])]) for k in ("normal", "point"))
                places = curve.jet(v, 0)[0]
                size = float(np.abs(places).max() + np.abs(point).max())
                off = (places - point) @ n / norm(n)
                assert_near(off, np.zeros(17), bound=64 * EPS * size, why="a few roundings of the size")
        jets = patch.c1.jet(v, 3) - patch.c0.jet(v, 3)
        size = float(np.abs(patch.c0.jet(v, 0)[0]).max() + np.abs(patch.c1.jet(v, 0)[0]).max())
        bound = 1024 * EPS * size * (2.0 * np.pi) ** 3
        assert_near(patch.p.jet(v, 3), jets, bound=bound, why="p is c1 - c0, third derivatives of a turn")


@pytest.mark.parametrize("table", EXACT)
def test_over_bezier_curves_edges_stay_rational_and_developability_is_proved(table: Table) -> None:
    for patch in patches(table):
        assert patch.exact
        assert isinstance(patch.c1, RationalBezier)
    warped = whole(table).metric("verify", "max_warp_deg")
    assert (warped.value, warped.evidence) == (0.0, "proved")
    assert whole(table).metric("verify", "max_gaussian_curvature").evidence == "proved"


@pytest.mark.parametrize("table", ROUND)
def test_over_circles_warp_is_rounding_and_the_class_exact(table: Table) -> None:
    v = np.linspace(0.0, 1.0, 65)
    assert max(float(np.nanmax(warp(patch, v))) for patch in patches(table)) <= 256 * EPS
    assert whole(table).reports["verify"].detail["class"] == "exact"
    assert whole(table).refused_by is None


@pytest.mark.parametrize(
    ("lean", "kind", "evidence"), [("-1.2", RationalBezier, "proved"), ("-1.6", Stepped, "sampled")]
)
def test_an_edge_that_takes_too_high_a_degree_is_made_by_power_series(lean: str, kind: type, evidence: str) -> None:
    # one control point lies beyond the plane through the apex, the curve does not: by a quarter, by a thirtieth
    table: Table = {
        "kind": "cone",
        "apex": [30, 20, 200],
        "directrix": {"bezier": [[80, 0, 0], [80, 60, 0], [-300, 110, 0], [80, 80, 0]]},
        "start_plane": {"point": [30, 20, 150], "normal": [lean, 0, 1]},
    }
    (patch,) = patches(table)
    assert isinstance(patch.c0, kind)
    made = passage(table)
    assert made.metric("verify", "max_warp_deg").evidence == evidence
    assert made.reports["verify"].detail["class"] == "exact"
    v = np.linspace(0.0, 1.0, 9)
    wanted = [[float(x) for x in cut(table, "start_plane", 0)(mpf(float(t)))[0]] for t in v]
    assert_near(patch.c0.jet(v, 0)[0], wanted, bound=64 * EPS * 30.0 * 500.0, why="rounding of a quotient of 1 : 30")
    for key in ("length_error", "area_error"):
        assert_near(made.value("unroll", key), 0.0, bound=1e-12, why="two quadratures")


@settings(max_examples=4, deadline=None)
@given(
    st.tuples(*[st.integers(min_value=-25, max_value=25)] * 2),
    st.tuples(*[st.integers(min_value=-25, max_value=25)] * 2),
    st.sampled_from(["round", "bezier"]),
)
def test_all_planes_that_lean_little_cut_an_exact_cone(low: tuple[int, int], high: tuple[int, int], sort: str) -> None:
    base = FRUSTUM if sort == "round" else BEZIER
    planes = [{"point": [0, 0, z], "normal": [*lean, 100]} for z, lean in ((0, low), (110, high))]
    made = passage(base | {"start_plane": planes[0], "end_plane": planes[1]})
    assert made.refused_by is None
    assert made.reports["verify"].detail["class"] == "exact"
    for key in ("length_error", "area_error"):
        assert_near(made.value("unroll", key), 0.0, bound=1e-12, why="two quadratures")


def test_the_same_planes_the_other_way_round_give_the_same_lengths() -> None:
    turned = FRUSTUM | {"start_plane": FRUSTUM["end_plane"], "end_plane": FRUSTUM["start_plane"]}
    here, there = edges(FRUSTUM), edges(turned)
    assert_relative([there["c0"], there["c1"]], [here["c1"], here["c0"]], bound=1e-13, why="the same piece of the cone")


def test_horizontal_planes_give_the_frustum_between_them() -> None:
    cuts: Table = {
        "start_plane": {"point": [7, 5, 30], "normal": [0, 0, -2]},
        "end_plane": {"point": [0, 0, 90], "normal": [0, 0, 1]},
    }
    plain: Table = {"kind": "cone", "radius0": 70, "radius1": 50, "height": 60}
    made = FRUSTUM | cuts
    assert_relative([*edges(made).values()], [*edges(plain).values()], bound=1e-13, why="radii 80 - z / 3")


def test_a_plane_beyond_the_apex_cuts_the_other_nappe() -> None:
    above: Table = {
        f"{end}_plane": {"point": [0, 0, z], "normal": [0, 0, 1]} for end, z in (("start", 300), ("end", 420))
    }
    plain: Table = {"kind": "cone", "radius0": 20, "radius1": 60, "height": 120}
    found, wanted = edges(FRUSTUM | above), edges(plain)
    assert_relative([*found.values()], [*wanted.values()], bound=1e-13, why="apex at 240, slope 1/3")
