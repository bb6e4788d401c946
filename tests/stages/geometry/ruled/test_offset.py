"""Parallel surfaces: closed forms, 40-digit values, limits where the normal vanishes, and refusals."""

import itertools
from collections.abc import Callable
from fractions import Fraction
from math import comb

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mpf

from stages.errors import NoSolutionError
from stages.geometry.arrays import Array, dot, norm, unit
from stages.geometry.curves.curves import Circular
from stages.geometry.flat.development import develop
from stages.geometry.ruled.offset import normals, offset, restricted
from stages.geometry.ruled.ruled import RuledPatch, across, frames, warp
from tests import oracles
from tests.near import assert_near
from tests.oracles import Space, Vec
from tests.parts import (
    AUMANN_CUBIC,
    AUMANN_FIRST,
    AUMANN_POINTS,
    ELLIPTIC_CYLINDER,
    EXAMPLE_1,
    MITRED_CYLINDER,
    OBLIQUE_CONE,
    QUINTIC_TANGENT,
    RIGHT_FRUSTUM,
    Table,
    aumann,
    patches,
)
from tests.strategies import Motion, motions, moved, scaled, scales

V = np.linspace(0.0, 1.0, 41)
FULL_ROUND = 2.0 * np.pi


def ring(radius: float, order: int) -> Array:
    """The jet of a circle about z, by v over a full turn."""
    a = FULL_ROUND * V
    jets = [
        radius * FULL_ROUND**k * np.stack([np.cos(a + k * np.pi / 2), np.sin(a + k * np.pi / 2), 0 * a], axis=1)
        for k in range(order + 1)
    ]
    return np.stack(jets)


@pytest.mark.parametrize("distance", [-0.7, 0.3, 1.5])
def test_parallel_to_a_pipe_is_a_pipe_with_the_other_radius(distance: float) -> None:
    """p = z and c' runs counter-clockwise: N = p x c' points inward."""
    (pipe,) = patches({"kind": "cylinder", "directrix": {"circle": {"center": [0, 0, 0], "radius": 2}},
                       "direction": [0, 0, 1], "length": 5})  # fmt: skip
    made = offset(pipe, distance).c0.jet(V, 3)
    wanted = ring(2.0 - distance, 3)
    for k in range(4):
        bound = 64 * np.finfo(float).eps * 3.5 * FULL_ROUND**k
        assert_near(made[k], wanted[k], bound=bound, why="rounding of the series, in the size of the derivative")


def test_parallel_to_a_right_cone_is_the_cone_moved_along_its_axis() -> None:
    (cone,) = patches(RIGHT_FRUSTUM)
    made = offset(cone, 0.25)
    slant = np.hypot(4.0, 1.5)
    inward, down = 4.0 / slant, 1.5 / slant
    for curve, radius, level in ((made.c0, 3.0, 0.0), (made.c1, 1.5, 4.0)):
        wanted = ring(radius - 0.25 * inward, 0)[0] + [0.0, 0.0, level - 0.25 * down]
        assert_near(curve.jet(V, 0)[0], wanted, bound=1e-14, why="rounding of a size of 5")


# Forty digits


def cubic_rows(curve: str) -> list[list[object]]:
    table = AUMANN_CUBIC[curve]
    assert isinstance(table, dict)
    rows = table["bezier"]
    assert isinstance(rows, list)
    return rows


def slopes(rows: list[list[object]]) -> Space:
    """The derivative of a Bezier curve, as a curve: its jet holds c', c'' and c'''."""
    exact = [[oracles.exact(x) for x in row] for row in rows]
    n = len(exact) - 1
    control = [tuple(n * (b - a) for a, b in zip(p, q, strict=True)) for p, q in itertools.pairwise(exact)]

    def jet(v: mpf) -> tuple[Vec, Vec, Vec]:
        made = []
        points = control
        for _ in range(3):
            row = points
            while len(row) > 1:
                row = [oracles.add(a, oracles.add(b, a, -1), v) for a, b in itertools.pairwise(row)]
            made.append(row[0])
            m = len(points) - 1
            points = [tuple(m * (b - a) for a, b in zip(p, q, strict=True))
                      for p, q in itertools.pairwise(points)] or [(mpf(0),) * 3]  # fmt: skip
        return made[0], made[1], made[2]

    return jet


def exact_normal(rows0: list[list[object]], rows1: list[list[object]]) -> Callable[[mpf], tuple[Vec, Vec, Vec]]:
    """N, N' and N'' by the quotient rule written out, at 40 digits."""
    c0, c1, d0, d1 = oracles.bezier(rows0), oracles.bezier(rows1), slopes(rows0), slopes(rows1)

    def jet(v: mpf) -> tuple[Vec, Vec, Vec]:
        p = [oracles.add(b, a, -1) for a, b in zip(c0(v), c1(v), strict=True)]
        s = [tuple((x + y) / 2 for x, y in zip(a, b, strict=True)) for a, b in zip(d0(v), d1(v), strict=True)]
        x = oracles.cross
        m = x(p[0], s[0])
        m1 = oracles.add(x(p[1], s[0]), x(p[0], s[1]))
        m2 = oracles.add(oracles.add(x(p[2], s[0]), x(p[1], s[1]), 2), x(p[0], s[2]))
        L = oracles.norm(m)
        L1 = oracles.dot(m, m1) / L
        L2 = (oracles.dot(m1, m1) + oracles.dot(m, m2) - L1**2) / L
        N = tuple(a / L for a in m)
        N1 = tuple(b / L - a * L1 / L**2 for a, b in zip(m, m1, strict=True))
        N2 = tuple(c / L - 2 * b * L1 / L**2 - a * L2 / L**2 + 2 * a * L1**2 / L**3
                   for a, b, c in zip(m, m1, m2, strict=True))  # fmt: skip
        return N, N1, N2

    return jet


def test_the_normals_of_a_general_developable_and_their_derivatives_hold_forty_digits() -> None:
    (patch,) = patches(AUMANN_CUBIC)
    exact = exact_normal(cubic_rows("c0"), cubic_rows("c1"))
    v = np.array([0.0, 0.125, 0.5, 0.75, 1.0])
    made = normals(patch).jet(v, 2)
    for k in range(3):
        wanted = np.array([[float(x) for x in exact(mpf(value))[k]] for value in v])
        assert_near(made[k], wanted, bound=1e-14 * max(np.abs(wanted).max(), 1.0), why="45 products of doubles")


def test_the_flat_pattern_of_a_parallel_surface_holds_forty_digits() -> None:
    """By the geodesic curvature of the moved directrix, which the program never computes."""
    (patch,) = patches(AUMANN_CUBIC)
    exact = exact_normal(cubic_rows("c0"), cubic_rows("c1"))
    distance = mpf("-0.125")

    def shifted(rows: list[list[object]]) -> Space:
        base = oracles.bezier(rows)
        return lambda v: tuple(oracles.add(a, N, distance) for a, N in zip(base(v), exact(v), strict=True))

    flat = oracles.flat_map(shifted(cubic_rows("c0")), shifted(cubic_rows("c1")))
    (piece,) = develop((offset(patch, -0.125),)).pieces
    u, v = np.array([0.0, 1.0, 0.0, 1.0, 0.5]), np.array([0.25, 0.25, 1.0, 1.0, 0.7])
    wanted = [[float(x) for x in flat(a, b)] for a, b in zip(u, v, strict=True)]
    assert_near(piece.positions(u, v), np.array(wanted), bound=1e-12 * 3.0, why="1e-12 of the size")


# Where the normal vanishes


def stopped(rows: list[list[object]]) -> Table:
    return {"kind": "cone", "apex": ["1", "2", "5"], "directrix": {"bezier": rows}, "fraction": ["0", "0.5"]}


STOP: list[list[object]] = [["0", "0", "0"], ["0", "0", "0"], ["2", "1", "0"], ["3", "4", "1"]]
"""A directrix that starts from rest: c'(0) = 0."""


def test_where_the_directrix_stops_the_normal_is_its_limit() -> None:
    """Near v = 0 the directrix leaves along its second derivative: N = (p x c'') / |p x c''|."""
    (patch,) = patches(stopped(STOP))
    made = normals(patch).jet(np.array([0.0, 1e-9]), 1)
    p, leave = np.array([1.0, 2.0, 5.0]), np.array([2.0, 1.0, 0.0])
    assert_near(made[0, 0], unit(np.cross(p, leave)), bound=1e-15, why="exact polynomials, rounded once")
    assert_near(made[0, 1] - made[0, 0], 1e-9 * made[1, 0], bound=1e-15, why="rounding; the square of 1e-9 is below")


def test_a_directrix_that_stops_inside_leaves_the_normals_smooth() -> None:
    """c' = (v - 1/2)^2 (1, v, 0), a cone over it: N = (A - c) x (1, v, 0), scaled."""
    powers = {"x": ["0", "1/4", "-1/2", "1/3", "0"], "y": ["0", "0", "1/8", "-1/3", "1/4"]}
    x, y = ([sum(Fraction(comb(i, k), comb(4, k)) * Fraction(a) for k, a in enumerate(row)) for i in range(5)]
            for row in powers.values())  # fmt: skip
    (patch,) = patches(stopped([[str(a), str(b), "0"] for a, b in zip(x, y, strict=True)]))
    v = np.array([0.0, 0.3, 0.5, 0.5 + 1e-9, 1.0])
    c = np.stack([v / 4 - v**2 / 2 + v**3 / 3, v**2 / 8 - v**3 / 3 + v**4 / 4, 0 * v], axis=1)
    wanted = unit(np.cross([1.0, 2.0, 5.0] - c, np.stack([1 + 0 * v, v, 0 * v], axis=1)))
    made = normals(patch).jet(v, 1)
    assert_near(made[0], wanted, bound=1e-14, why="the factor (v - 1/2)^2 is divided out exactly")
    assert_near((made[0, 3] - made[0, 2]) / 1e-9, made[1, 2], bound=1e-6, why="rounding over a step of 1e-9")


def test_a_plane_has_one_normal_even_where_its_rulings_run_along_the_directrix() -> None:
    (patch,) = patches(EXAMPLE_1)
    N = normals(patch).jet(V, 2)
    assert_near(N[0], np.broadcast_to(N[0, 0], N[0].shape), bound=0.0, why="the factor is divided out exactly")
    assert_near(N[1:], np.zeros_like(N[1:]), bound=0.0, why="a constant")


def test_a_pipe_cut_to_a_point_at_its_seam_keeps_its_normals() -> None:
    tan_30 = "0.57735026918962576451"
    arc = {"arc": {"center": [0, 0, 0], "radius": 2, "start": 180, "end": 540}}
    (patch,) = patches({"kind": "cylinder", "directrix": arc, "direction": [0, 0, 1],
                        "end_plane": {"point": [-2, 0, 0], "normal": [f"-{tan_30}", 0, 1]}})  # fmt: skip
    a = np.pi + FULL_ROUND * V
    inward = -np.stack([np.cos(a), np.sin(a), 0 * a], axis=1)
    assert_near(normals(patch).jet(V, 0)[0], inward, bound=1e-14, why="rounding")


def test_an_apex_takes_the_normal_of_the_other_end() -> None:
    (cone,) = patches({"kind": "cone", "radius0": 3, "radius1": 0, "height": 4})
    a = FULL_ROUND * V
    inward = np.stack([-0.8 * np.cos(a), -0.8 * np.sin(a), -0.6 + 0 * a], axis=1)
    assert_near(normals(cone).jet(V, 0)[0], inward, bound=1e-14, why="rounding; the slant is 3, 4, 5")
    moved_apex = offset(cone, -0.5).c1.jet(V, 0)[0]
    assert_near(norm(moved_apex[:, :2]), np.full(V.size, 0.4), bound=1e-14, why="the apex opens to a ring")


def test_a_normal_without_a_known_limit_is_refused_with_its_ruling() -> None:
    x, y, z = np.eye(3)
    small = Circular(0 * x, x, y, 0 * z, 0.0, np.pi)
    large = Circular(-x + 0.5 * z, 2 * x, 2 * y + z, 0 * z, 0.0, np.pi)
    touching = RuledPatch(small, large, Circular(-x, x, y + z, 0 * z, 0.0, np.pi))
    with pytest.raises(NoSolutionError, match="v = 0"):
        offset(touching, 0.1)


# Whatever the surface


DEVELOPABLE = {
    "aumann": AUMANN_CUBIC, "tangent": QUINTIC_TANGENT, "oblique cone": OBLIQUE_CONE, "ellipse": ELLIPTIC_CYLINDER,
    "mitred": MITRED_CYLINDER, "aumann, far edge": aumann(AUMANN_POINTS, AUMANN_FIRST, "-1", "-0.25"),
}  # fmt: skip


@pytest.mark.parametrize("name", DEVELOPABLE)
def test_a_parallel_surface_is_developable_along_the_same_rulings_at_its_distance(name: str) -> None:
    (patch,) = patches(DEVELOPABLE[name])
    made = offset(patch, 0.01)
    assert made.p is patch.p
    inside = V[1:-1]
    assert_near(warp(made, inside), np.zeros(inside.size), bound=1e-10, why="rounding of normals of a cubic's size")
    before, after = patch.c0.jet(V, 0)[0], made.c0.jet(V, 0)[0]
    size = np.abs(before).max()
    assert_near(norm(after - before), np.full(V.size, 0.01), bound=4e-16 * size + 1e-17, why="one subtraction")
    _, w = across(frames(patch, inside), 0.5)
    assert_near(dot(after - before, unit(patch.p.jet(V, 0)[0])), 0 * V, bound=1e-15 * size, why="across the ruling")
    assert_near(dot((after - before)[1:-1], unit(w)), 0 * inside, bound=1e-15 * size, why="across the surface")


def test_back_again_is_where_it_was() -> None:
    (patch,) = patches(QUINTIC_TANGENT)
    there = offset(patch, 5.0)
    field = normals(patch)
    back = offset(there, -5.0, field)
    assert_near(back.c0.jet(V, 2), patch.c0.jet(V, 2), bound=1e-11, why="rounding of derivatives of 1e3 mm")
    assert_near(normals(there).jet(V, 0)[0], field.jet(V, 0)[0], bound=1e-12, why="one normal for all parallels")


def test_no_distance_is_the_surface_itself() -> None:
    (patch,) = patches(AUMANN_CUBIC)
    assert offset(patch, 0.0) is patch


def test_a_part_of_a_patch_is_its_chain_rule() -> None:
    (patch,) = patches(AUMANN_CUBIC)
    piece = restricted(offset(patch, 0.1), 0.25, 0.75)
    whole = offset(patch, 0.1).c1.jet(0.25 + 0.5 * V, 3)
    for k in range(4):
        assert_near(piece.c1.jet(V, 3)[k], 0.5**k * whole[k], bound=0.0, why="the same numbers")


@settings(max_examples=15, deadline=None)
@given(motions(), scales(), st.sampled_from([AUMANN_CUBIC, QUINTIC_TANGENT]))
def test_a_motion_and_a_scale_carry_the_normals_along(motion: Motion, factor: Fraction, table: Table) -> None:
    (patch,) = patches(table)
    turned = np.array([[float(x) for x in row] for row in motion[0]])
    made = normals(moved(scaled(patch, factor), motion)).jet(V, 1)
    wanted = normals(patch).jet(V, 1) @ turned.T
    assert_near(made, wanted, bound=2e-14 * max(np.abs(wanted).max(), 1.0), why="exact motion, rounded once")
