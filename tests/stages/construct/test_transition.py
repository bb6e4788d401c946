"""Transitions: tips against roots of the condition, areas to 40 digits, the hull as a second method, refusals."""

import json
from fractions import Fraction
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import findroot, mp, mpf

from stages.construct import construct
from stages.geometry.arrays import EPS, norm
from stages.geometry.curves.curves import Bezier
from stages.geometry.ruled.ruled import at
from tests import oracles
from tests.near import assert_near, assert_relative
from tests.parts import DEFAULT, Passage, Table, part, passage, patches, troubles

SQUARE: Table = {"kind": "transition", "rectangle": [3, 3], "round": 2, "height": 2}
TILTED: Table = {
    "kind": "transition", "rectangle": [400, 300], "round": 250, "height": 350, "offset": [50, -20], "tilt": 25,
}  # fmt: skip
ASIDE: Table = {
    "kind": "transition", "rectangle": [40, 300], "round": 250, "height": 350, "offset": [250, -90], "tilt": -35,
}  # fmt: skip
SMALL: Table = {"kind": "transition", "rectangle": [0.4, 0.3], "round": 1, "height": 1, "offset": [5, 0]}
LARGE: Table = {"kind": "transition", "rectangle": [9000, 6000], "round": 10000, "height": 2500, "tilt": 12}
EVERY = pytest.mark.parametrize("table", [SQUARE, TILTED, ASIDE, SMALL, LARGE])


def whole(table: Table) -> Passage:
    """Return what became of a transition; each is made once."""
    return _whole(json.dumps(table))


@cache
def _whole(table: str) -> Passage:
    return passage(json.loads(table))


def ring(table: Table) -> tuple[oracles.Vec, oracles.Vec, oracles.Vec]:
    """Return the round's centre and axes."""
    x, y = table.get("offset", [0, 0])  # type: ignore[misc]
    radius, tilt = oracles.exact(table["round"]) / 2, mp.radians(oracles.exact(table.get("tilt", 0)))
    centre = (oracles.exact(x), oracles.exact(y), oracles.exact(table["height"]))
    return centre, (radius * mp.cos(tilt), mpf(0), -radius * mp.sin(tilt)), (mpf(0), radius, mpf(0))


def on_ring(table: Table, t: mpf) -> tuple[oracles.Vec, oracles.Vec]:
    """Return the point of the round at an angle, and its derivative."""
    centre, x, y = ring(table)
    c, s = mp.cos(t), mp.sin(t)
    return tuple(m + c * a + s * b for m, a, b in zip(centre, x, y, strict=True)), tuple(
        -s * a + c * b for a, b in zip(x, y, strict=True)
    )


def tip(table: Table, corner: oracles.Vec, side: oracles.Vec, near: float) -> mpf:
    """Return the angle where the plane through a side touches the round."""

    def triple(t: mpf) -> mpf:
        point, slope = on_ring(table, t)
        return oracles.dot(side, oracles.cross(oracles.add(point, corner, -1), slope))

    return findroot(triple, mpf(near))


def corners(table: Table) -> list[oracles.Vec]:
    a, b = (oracles.exact(x) / 2 for x in table["rectangle"])  # type: ignore[attr-defined]
    return [(a, b, mpf(0)), (-a, b, mpf(0)), (-a, -b, mpf(0)), (a, -b, mpf(0))]


def tips(table: Table) -> list[mpf]:
    places, x = corners(table), (mpf(1), mpf(0), mpf(0))
    return [mpf(0), tip(table, places[0], x, 1.6), mp.pi, tip(table, places[2], x, 4.7), 2 * mp.pi]


def area(table: Table) -> mpf:
    """Return the area: four triangles, and four cones by quadrature."""
    total, places, angles = mpf(0), corners(table), tips(table)
    for i, corner in enumerate(places):
        low, high = angles[i], angles[i + 1]

        def arc(v: mpf, low: mpf = low, high: mpf = high) -> oracles.Jet:
            point, slope = on_ring(table, low + v * (high - low))
            return point, tuple((high - low) * x for x in slope), (mpf(0),) * 3

        total += oracles.area(lambda _, apex=corner: (apex, (mpf(0),) * 3, (mpf(0),) * 3), arc)
        point, _ = on_ring(table, high)
        following = places[(i + 1) % 4]
        edge = oracles.add(following, corner, -1)
        total += oracles.norm(oracles.cross(edge, oracles.add(point, corner, -1))) / 2
    return total


def test_a_circle_over_a_square_has_the_area_of_four_triangles_and_four_cones() -> None:
    assert_relative(whole(SQUARE).side("flat")["area"], 19.293187945896734798, bound=1e-14, why="30-digit quadrature")


@EVERY
def test_surface_and_pattern_have_the_area_that_quadrature_to_40_digits_gives(table: Table) -> None:
    made = whole(table)
    for side in ("surface", "flat"):
        assert_relative(made.side(side)["area"], float(area(table)), bound=1e-13, why="9 panels of 16 nodes, rounding")


@EVERY
def test_edges_are_the_rectangle_and_the_round(table: Table) -> None:
    edges = whole(table).side("flat")["edges"]
    assert isinstance(edges, dict)
    a, b = (float(x) for x in table["rectangle"])  # type: ignore[attr-defined]
    radius = float(table["round"]) / 2.0  # type: ignore[arg-type]
    assert_relative([edges["c0"], edges["c1"]], [2.0 * (a + b), 2.0 * np.pi * radius], bound=1e-13, why="closed forms")
    assert_relative(edges["start"], edges["end"], bound=1e-14, why="both are the seam")


@EVERY
def test_pieces_meet_without_gap_or_fold_and_the_surface_is_exact(table: Table) -> None:
    made = whole(table)
    size = made.surface.size_mm if made.surface is not None else 0.0
    assert_near(made.value("construct", "join_gap_mm"), 0.0, bound=16 * EPS * size, why="a few roundings of the size")
    assert_near(made.value("construct", "join_normal_deg"), 0.0, bound=1e-9, why="tangent continuous")
    assert made.reports["verify"].detail["class"] == "exact"
    assert made.codes("verify", fatal=True) == []


@EVERY
def test_tips_lie_where_the_planes_through_the_sides_touch_the_round(table: Table) -> None:
    made, u = patches(table), np.ones(1)
    found = [at(patch, u, np.zeros(1))[0] for patch in made[::2]]
    wanted = [[float(x) for x in on_ring(table, t)[0]] for t in tips(table)]
    size = max(float(x) for x in table["rectangle"]) + float(table["round"])  # type: ignore[attr-defined,arg-type]
    assert_near(found, wanted, bound=64 * EPS * size, why="arctan, arccos, and the round's own rounding")


def test_triangles_and_cones_take_turns_and_triangles_are_exact() -> None:
    made = patches(TILTED)
    assert [isinstance(patch.c0, Bezier) for patch in made] == [True, False] * 4 + [True]
    assert [patch.exact for patch in made] == [True, False] * 4 + [True]


@EVERY
def test_the_surface_is_the_side_of_the_convex_hull(table: Table) -> None:
    from scipy.spatial import ConvexHull

    count = 4000
    t = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    centre, x, y = (np.array([float(c) for c in vector]) for vector in ring(table))
    points = np.vstack([[[float(c) for c in p] for p in corners(table)],
                        centre + np.cos(t)[:, None] * x + np.sin(t)[:, None] * y])  # fmt: skip
    radius = float(norm(x))
    caps = float(np.prod([float(c) for c in table["rectangle"]])) + np.pi * radius**2  # type: ignore[attr-defined]
    hull = float(ConvexHull(points / radius, qhull_options="QJ Pp").area) * radius**2
    flat = whole(table).side("flat")["area"]
    assert_relative(float(flat) + caps, hull, bound=1e-5, why="a polygon of 4000 sides: pi^2/(6 n^2), and QJ's joggle")


@settings(max_examples=15, deadline=None)
@given(
    st.tuples(*[st.integers(min_value=1, max_value=400)] * 2),
    st.integers(min_value=1, max_value=400),
    st.tuples(*[st.integers(min_value=-300, max_value=300)] * 2),
    st.integers(min_value=-60, max_value=60),
)
def test_above_its_least_height_every_transition_is_smooth(
    rectangle: tuple[int, int], diameter: int, offset: tuple[int, int], tilt: int
) -> None:
    table: Table = {"kind": "transition", "rectangle": [*rectangle], "round": diameter, "height": "1/1000000",
                    "offset": [*offset], "tilt": tilt}  # fmt: skip
    refused = construct(part(table), DEFAULT).report
    where = refused.findings[0].where if not refused.passed else None
    least = 0.0 if where is None else float(where["least_height_mm"])
    height = str(Fraction(1.2 * least + 30.0).limit_denominator(1000))
    made = construct(part(table | {"height": height}), DEFAULT).report
    assert made.passed
    assert_near(made.metric("join_normal_deg").value, 0.0, bound=1e-9, why="tangent continuous")


@pytest.mark.parametrize(
    ("tilt", "offset", "least"),
    [(30, 0, 0.5), (-30, 0, 0.8660254037844386), (30, -2, 2.0207259421636903)],
)
def test_a_round_that_leans_into_the_rectangle_is_refused_with_the_least_height(
    tilt: int, offset: int, least: float
) -> None:
    table = SQUARE | {"rectangle": [3, 3] if tilt < 0 or offset else [1, 1], "tilt": tilt, "offset": [offset, 0]}
    finding = passage(table | {"height": repr(least - 1e-6)}).reports["construct"].findings[0]
    assert (finding.code, finding.fatal) == ("transition-too-low", True)
    assert finding.where is not None
    assert_near(float(finding.where["least_height_mm"]), least, bound=1e-15, why="R sin(tilt), (a/2 - dx) tan(tilt)")
    assert passage(table | {"height": repr(least + 1e-6)}).reports["construct"].passed


@pytest.mark.parametrize(
    ("change", "message"),
    [({"height": 0}, "0"), ({"round": -1}, "-1"), ({"rectangle": [3, 0]}, "0 mm"), ({"tilt": 90}, "90 deg")],
)
def test_sizes_that_make_no_duct_are_errors_of_the_job_file(change: Table, message: str) -> None:
    assert troubles(SQUARE | change) == [message]


def test_the_rectangle_may_stand_inside_and_outside_the_round() -> None:
    for table in (SQUARE | {"round": 0.5}, SQUARE | {"round": 20}):
        assert passage(table).refused_by is None
