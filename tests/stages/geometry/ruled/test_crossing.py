"""Surfaces that pass through themselves and surfaces that only touch: closed forms, thin crossings, a second method."""

from fractions import Fraction
from math import cos, hypot, pi, radians, sin, sqrt, tan

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.curves.curves import Circular, Curve, bezier
from stages.geometry.ruled import ruled
from stages.geometry.ruled.cells import first_cells, may_meet, near_pairs
from stages.geometry.ruled.crossing import MOST_PAIRS, RESOLUTION, Crossing, Search, crossings
from stages.geometry.ruled.ruled import RuledPatch, size_of
from tests.near import assert_near
from tests.parts import (
    AUMANN_CUBIC,
    CONE_STRIP,
    ELLIPTIC_CYLINDER,
    EXAMPLE_1,
    EXAMPLE_2_CYLINDER,
    EXAMPLE_2_PRINTED,
    EXAMPLE_3,
    MITRED_CYLINDER,
    OBLIQUE_CONE,
    QUINTIC_TANGENT,
    RIGHT_FRUSTUM,
    STRIP,
    Table,
    patches,
)

Patches = tuple[RuledPatch, ...]
LOOP = [[0, 0], [10, 6], [-6, 6], [4, 0]]
"""A cubic that is symmetric in x = 2 and passes through itself there."""


def search_of(surface: Patches) -> Search:
    return crossings(surface, size_of(surface))


def crossings_of(surface: Patches) -> list[Crossing]:
    return list(search_of(surface).found)


def cylinder(points: list[list[object]], direction: tuple[object, ...]) -> Patches:
    c0 = [[Fraction(str(x)), Fraction(str(y)), Fraction(0)] for x, y in points]
    shift = [Fraction(str(x)) for x in direction]
    return (ruled.between(bezier(c0), bezier([[a + b for a, b in zip(p, shift, strict=True)] for p in c0])),)


def cone(points: list[list[object]], apex: tuple[object, ...], fraction: Fraction) -> Patches:
    c0 = [[Fraction(str(x)), Fraction(str(y)), Fraction(0)] for x, y in points]
    top = [Fraction(str(x)) for x in apex]
    c1 = [[a + fraction * (b - a) for a, b in zip(p, top, strict=True)] for p in c0]
    return (ruled.between(bezier(c0), bezier(c1)),)


def turning(radius: float, sweep: float, z: float = 0.0, rise: float = 0.0) -> Circular:
    axes = np.diag([radius, radius, rise])
    return Circular(np.array([0.0, 0.0, z]), axes[0], axes[1], axes[2], 0.0, sweep)


def helix_tangent(radius: float, pitch: float, near: float, far: float, turns: float) -> Patches:
    """Tangents of a helix between two distances along them."""
    h = pitch / (2 * pi)
    slant = hypot(radius, h)

    def edge(d: float) -> Curve:
        U, V = np.array([radius, d * radius / slant, 0.0]), np.array([-d * radius / slant, radius, 0.0])
        return Circular(np.array([0.0, 0.0, d * h / slant]), U, V, np.array([0.0, 0.0, h]), 0.0, 2 * pi * turns)

    return (ruled.between(edge(near), edge(far)),)


def tube(*corners: tuple[float, float]) -> Patches:
    return patches({"kind": "cylinder", "directrix": {"polyline": [[x, y, 0] for x, y in corners]},
                    "direction": [0, 0, 1], "length": 5})  # fmt: skip


ORDINARY: dict[str, Table] = {
    "quintic tangent": QUINTIC_TANGENT, "Aumann's cubic": AUMANN_CUBIC, "Example 1": EXAMPLE_1,
    "Example 2": EXAMPLE_2_CYLINDER, "Example 2 as printed": EXAMPLE_2_PRINTED, "Example 3": EXAMPLE_3, "strip": STRIP,
    "cone strip": CONE_STRIP, "frustum": RIGHT_FRUSTUM, "frustum of 350 deg": RIGHT_FRUSTUM | {"sweep": 350},
    "cone to its apex": RIGHT_FRUSTUM | {"radius1": 0}, "cone from its apex": RIGHT_FRUSTUM | {"radius0": 0},
    "disc": RIGHT_FRUSTUM | {"radius1": 0, "height": 0}, "mitred pipe": MITRED_CYLINDER, "oblique cone": OBLIQUE_CONE,
    "oblique cone to its apex": OBLIQUE_CONE | {"fraction": [0, 1]}, "elliptic pipe": ELLIPTIC_CYLINDER,
}  # fmt: skip


@pytest.mark.parametrize("name", ORDINARY)
def test_an_ordinary_part_does_not_cross_itself(name: str) -> None:
    assert search_of(patches(ORDINARY[name])) == Search(), "and no place stays open"


TOUCHING: dict[str, Patches] = {
    "square tube, seam at a corner": tube((0, 0), (4, 0), (4, 4), (0, 4), (0, 0)),
    "an edge on a face": tube((0, 0), (4, 0), (4, 4), (2, 4), (2, 0)),
    "a hem": tube((0, 0), (4, 0), (2, 0)),
    "turns a twentieth of a millimetre apart": helix_tangent(100.0, 0.05, 5.0, 60.0, 3.0),
    "helicoid from its edge of regression": helix_tangent(100.0, 30.0, 0.0, 60.0, 2.5),
    "a pipe wound twice": (ruled.between(turning(10, 4 * pi), turning(10, 4 * pi, z=20.0)),),
    "a pipe with a helical seam": (ruled.between(turning(10, 6 * pi, rise=5 / (2 * pi)),
                                                 turning(10, 6 * pi, z=5.0, rise=5 / (2 * pi))),),
}  # fmt: skip


@pytest.mark.parametrize("name", TOUCHING)
def test_sheets_that_touch_do_not_cross(name: str) -> None:
    search = search_of(TOUCHING[name])
    assert search.found == ()
    assert (search.unsettled is not None) == (name == "a pipe wound twice"), "sheets that lie on each other stay open"


def test_what_the_search_leaves_open_is_told_with_a_place_on_both_sheets() -> None:
    """A pipe of radius 10 wound twice: v and v + 1/2 are one ruling, and no halving takes them apart."""
    left = search_of(TOUCHING["a pipe wound twice"]).unsettled
    assert left is not None
    assert left.pairs > MOST_PAIRS
    assert_near(hypot(*left.point[:2]), 10.0, bound=1e-12, why="on the pipe")
    assert abs(left.v[1] - left.v[0] - 0.5) * 4 * pi * 10 <= 2.0 * left.cell_mm, "the middles of cells that meet"
    assert 0.0 < left.cell_mm < 20.0 / 4, "the first cells reach over 20 mm, and were halved"


def test_a_search_that_ends_too_early_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("stages.geometry.ruled.crossing.HALVINGS", 0)
    search = search_of(cylinder(LOOP, (0, 0.2, 50)))
    assert search.found == ()
    assert search.unsettled is not None, "the crossing of the loop was not looked for"


def loop_place() -> tuple[float, float, float]:
    """Return v of both passages of the loop through x = 2, and their y.

    With q = v (1 - v):  x - 2 = (1 - 2v) (26 q - 2)  and  y = 18 q.
    """
    v = (1.0 - sqrt(1.0 - 4.0 / 13.0)) / 2.0
    return v, 1.0 - v, 18.0 / 13.0


def test_a_cylinder_over_a_loop_crosses_in_a_ruling_at_the_loop_s_double_point() -> None:
    v, w, y = loop_place()
    found = crossings_of(cylinder(LOOP, (0, 0.2, 50)))
    assert [c.patches for c in found] == [(0, 0)]
    assert_near(found[0].v, [v, w], bound=1e-9, why="Newton's method to 1e-10 of the size")
    assert_near(found[0].u[0], found[0].u[1], bound=1e-9, why="the same height")
    expected = [2.0, y + 0.2 * found[0].u[0], 50.0 * found[0].u[0]]
    assert_near(found[0].point, expected, bound=1e-7, why="1e-9 of v at a speed of 30 mm")


@pytest.mark.parametrize("fraction", [Fraction(1, 10), Fraction(9, 10), Fraction(1)])
def test_a_cone_over_a_loop_crosses_below_its_apex(fraction: Fraction) -> None:
    v, w, y = loop_place()
    found = crossings_of(cone(LOOP, (2, 2, 40), fraction))
    assert [c.patches for c in found] == [(0, 0)]
    assert_near(found[0].v, [v, w], bound=1e-9, why="Newton's method to 1e-10 of the size")
    climbed = found[0].u[0] * float(fraction)
    assert_near(found[0].point, [2.0, y + climbed * (2.0 - y), 40.0 * climbed], bound=1e-7, why="on the common ruling")


@pytest.mark.parametrize("angle_deg", [90, 30, 5])
@pytest.mark.parametrize("past", [1e-3, 1e-4, -1e-4, 0.0])
def test_an_edge_that_goes_through_a_face_is_found_however_little(past: float, angle_deg: float) -> None:
    """A tube whose last wall ends `past` of the size beyond the first one, at an angle to it; short of it: none."""
    size = 6.0
    slope = radians(angle_deg)
    end = (2.0 - past * size / tan(slope), -past * size)
    start = (2.0 + 4.0 * cos(slope), 4.0 * sin(slope))
    found = crossings_of(tube((0, 0), (9, 0), (9, 5), start, end))
    assert len(found) == (1 if past > 0 else 0)
    for crossing in found:
        assert_near(crossing.point[:2], [2.0, 0.0], bound=1e-9, why="closed form")
        assert_near(
            crossing.depth_mm, past * size, bound=0.05 * past * size, why="what stands out, where there is room"
        )


def test_turns_whose_inner_edge_sinks_while_the_outer_rises_cross_at_one_radius() -> None:
    """In a half-plane through the axis the next turn lies 5 mm higher outside and 2 mm lower inside: u = 5/7."""
    outer = turning(10, 6 * pi, rise=5 / (2 * pi))
    assert crossings_of((ruled.between(outer, turning(7, 6 * pi, z=8.0, rise=2 / (2 * pi))),)) == []
    found = crossings_of((ruled.between(outer, turning(7, 6 * pi, z=8.0, rise=-2 / (2 * pi))),))
    assert [c.patches for c in found] == [(0, 0)]
    assert_near(found[0].u, [5 / 7, 5 / 7], bound=1e-9, why="Newton's method to 1e-10 of the size")
    turns = 3 * (found[0].v[1] - found[0].v[0])
    assert_near(turns, round(turns), bound=1e-8, why="whole turns, of three")


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**31), st.booleans())
def test_a_cylinder_or_cone_crosses_itself_where_its_plane_directrix_does(seed: int, conical: bool) -> None:
    """Second method: whether a fine polygon along the directrix is simple."""
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(int(rng.integers(4, 8)), 2)).round(3)
    apex = (*rng.normal(size=2).round(3), 2)
    made = cone(points.tolist(), apex, Fraction(1, 2)) if conical else cylinder(points.tolist(), (*apex[:2], 1))
    along = made[0].c0.jet(np.linspace(0.0, 1.0, 4001), 0)[0][:, :2]
    found = crossings_of(made)
    assert bool(found) != shapely.LineString(along).is_simple
    for crossing in found:
        one, other = (
            ruled.at(made[0], np.array([u]), np.array([v]))[0] for u, v in zip(crossing.u, crossing.v, strict=True)
        )
        assert_near(one, other, bound=1e-9 * size_of(made), why="both places are one point")
        assert crossing.depth_mm > RESOLUTION * size_of(made)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**31), st.floats(1e-2, 1e3))
def test_moving_scaling_and_exchanging_the_edges_finds_the_same_ruling(seed: int, scale: float) -> None:
    (plain,) = cylinder(LOOP, (0, 0.2, 50))
    rng = np.random.default_rng(seed)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0] * scale
    shift = rng.normal(size=3) * 100.0 * scale
    c0, c1 = (
        bezier([[Fraction(float(x)) for x in point @ turn.T + shift] for point in curve.points])
        for curve in (plain.c1, plain.c0)
    )
    found = crossings_of((ruled.between(c0, c1),))
    v, w, _ = loop_place()
    assert [c.patches for c in found] == [(0, 0)]
    assert_near(found[0].v, [v, w], bound=1e-8, why="control points rounded 100 sizes away")


def test_hulls_hold_the_surface_and_apart_is_apart() -> None:
    """On a helicoid: every sampled point lies in the shadows of its cell; pairs that are dropped share no point."""
    surface = helix_tangent(10.0, 8.0, 1.0, 30.0, 1.0)
    cells = first_cells(surface)
    first, second = near_pairs(cells, 0.0)
    kept = may_meet(cells.take(first), cells.take(second), 0.0)
    near = {(int(a), int(b)) for a, b in zip(first[kept], second[kept], strict=True)}
    u, v = (grid.ravel() for grid in np.meshgrid(np.linspace(0, 1, 9), np.linspace(0, 1, 9)))
    clouds = [ruled.at(surface[0], u, low + v * (high - low)) for low, high in cells.v]
    rng = np.random.default_rng(5)
    for axis in rng.normal(size=(20, 3)):
        for cloud, hull, slack in zip(clouds, cells.hull, cells.slack, strict=True):
            shadow, room = hull @ axis, slack.max() * np.linalg.norm(axis) + 1e-12
            assert shadow.min() - room <= (cloud @ axis).min() <= (cloud @ axis).max() <= shadow.max() + room
    for i in range(len(clouds) - 1):
        assert (i, i + 1) in near, "cells that share a ruling are never taken apart"
