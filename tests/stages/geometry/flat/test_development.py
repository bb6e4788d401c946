"""The map along rulings: closed forms, invariance, and what it refuses; against 40 digits in `unroll/test_figures`."""

from collections.abc import Callable
from fractions import Fraction
from math import hypot, pi, tan

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.errors import NoSolutionError
from stages.geometry.arrays import EPS, Array, norm
from stages.geometry.curves.curves import Circular
from stages.geometry.flat import development
from stages.geometry.flat.development import develop
from stages.geometry.flat.flatmap import Development
from stages.geometry.numeric.quadrature import beginnings
from stages.geometry.ruled.ruled import RuledPatch, between
from tests.near import assert_near, assert_relative
from tests.parts import (
    AUMANN_CUBIC,
    AUMANN_FIRST,
    AUMANN_POINTS,
    ELLIPTIC_CYLINDER,
    EXAMPLE_1,
    MITRED_CYLINDER,
    OBLIQUE_CONE,
    QUINTIC_TANGENT,
    Table,
    aumann,
    patches,
)
from tests.rewritten import (
    AT_REST,
    UNEVEN,
    Polynomial,
    exchanged,
    in_pieces,
    raised,
    reparametrised,
    turned_around,
    value,
)
from tests.strategies import motions, moved, scaled

U = np.array([0.0, 0.3, 1.0])
V = np.linspace(0.0, 1.0, 11)
GRID_U, GRID_V = (axis.ravel() for axis in np.meshgrid(U, V, indexing="ij"))


def flat(made: Development, u: Array = GRID_U, v: Array = GRID_V) -> Array:
    """Return flat positions of a strip whose parameter v runs evenly over its pieces in [0, 1]."""
    count = len(made.pieces)
    index = np.minimum((v * count).astype(int), count - 1)
    points = np.zeros((v.size, 2))
    for i, piece in enumerate(made.pieces):
        here = index == i
        points[here] = piece.positions(u[here], v[here] * count - i)
    return points


def distances(points: Array) -> Array:
    """Return all distances between points: what no motion and no mirror changes."""
    return norm(points[:, None] - points[None, :])


# Closed forms


@pytest.mark.parametrize("sweep", [10, 90, 180, 360])
@pytest.mark.parametrize(("r0", "r1", "height"), [(3, 1.5, 4), (3, 0, 4), (0, 3, 4), (1, 3, 0), (3, 0, 0), (5, 5, 2)])
def test_a_right_frustum_unrolls_to_its_sector(r0: float, r1: float, height: float, sweep: int) -> None:
    table = {"kind": "cone", "radius0": r0, "radius1": r1, "height": height, "sweep": sweep}
    points = flat(develop(patches(table)))
    slant, a = hypot(r1 - r0, height), np.radians(sweep) * GRID_V
    if r0 == r1:
        expected = np.stack([GRID_U * slant, r0 * a], axis=1)
    else:
        outward = 1.0 if r1 > r0 else -1.0
        turned = a * abs(r1 - r0) / slant
        reach = (r0 + (r1 - r0) * GRID_U) * slant / abs(r1 - r0)
        start = r0 * slant / abs(r1 - r0)
        # c0(0) at the origin, the first ruling along +x, c0 leaving towards +y
        expected = np.stack([outward * (reach * np.cos(turned) - start), reach * np.sin(turned)], axis=1)
    assert_near(points, expected, bound=1e-14 * 4 * pi * 5, why="1e-14 of an arc of up to 2 pi 5 mm")


@pytest.mark.parametrize("normal", [f"-{tan(pi / 6)}", "0", "2"])
def test_a_mitred_pipe_unrolls_to_a_sine_curve(normal: str) -> None:
    """x + 5 - tan x 2 cos(y / 2): the plane z = 5 - n x over the circle of radius 2, at 50 places."""
    end = {"point": [0, 0, 5], "normal": [normal, 0, 1]}
    piece = develop(patches(MITRED_CYLINDER | {"end_plane": end})).pieces[0]
    v = np.linspace(0.0, 1.0, 50)
    expected = np.stack([5.0 - float(normal) * 2.0 * np.cos(2.0 * pi * v), 4.0 * pi * v], axis=1)
    assert_near(piece.positions(np.ones(50), v), expected, bound=1e-13, why="1e-14 of 12.6 mm")
    base = np.stack([np.zeros(50), 4.0 * pi * v], axis=1)
    assert_near(piece.positions(np.zeros(50), v), base, bound=1e-13, why="1e-14 of 12.6 mm")


def test_a_plane_patch_unrolls_to_itself() -> None:
    patch = patches(EXAMPLE_1)[0]
    space = (1.0 - GRID_U)[:, None] * patch.c0.jet(GRID_V, 0)[0] + GRID_U[:, None] * patch.c1.jet(GRID_V, 0)[0]
    assert_near(distances(flat(develop((patch,)))), distances(space), bound=1e-14 * 90, why="1e-14 of 90 mm")


@pytest.mark.parametrize("lean", ["0.1", "1e-7", "1e-12"])
def test_rulings_that_grow_much_and_turn_little_still_turn(lean: str) -> None:
    """A plane trapezium: rulings from (0, 1) to (lean, 2); its corners keep their distances."""
    lower, upper = [[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [str(1 + Fraction(lean)), 2, 0]]
    patch = patches({"kind": "ruled", "c0": {"line": lower}, "c1": {"line": upper}})[0]
    points = flat(develop((patch,)), np.array([0.0, 1.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0, 1.0]))
    a = float(lean)
    expected = [[0.0, 0.0], [1.0, 0.0], [2.0, 1.0 + a], [0.0, 1.0]]
    assert_near(points, [[x, y] for x, y in expected], bound=1e-14, why="1e-14 of 2 mm, the first ruling along x")


def test_a_tangent_surface_of_a_helix_unrolls_to_circles() -> None:
    """Edge (2 cos t, 2 sin t, t), rulings from 1/2 to 2 along the tangent: its curvature 2/5 stays in the flat.

    The tangent of a circular helix is circular motion again: T = (-2 sin t, 2 cos t, 1) / sqrt 5.
    """
    x, y, z = np.eye(3)
    root = 5.0**0.5

    def rail(reach: float) -> Circular:
        u, v = 2.0 * x + 2.0 * reach / root * y, 2.0 * y - 2.0 * reach / root * x
        return Circular(reach / root * z, u, v, z, 0.0, 2.0)

    made = develop((between(rail(0.5), rail(2.0)),))
    s = 2.0 * root * GRID_V
    turned, reach = 0.4 * s, 0.5 + 1.5 * GRID_U
    edge = 2.5 * np.stack([np.sin(turned), 1.0 - np.cos(turned)], axis=1)
    tangent = np.stack([np.cos(turned), np.sin(turned)], axis=1)
    expected = edge + reach[:, None] * tangent - np.array([0.5, 0.0])
    assert_near(flat(made), expected, bound=1e-13, why="1e-14 of 6 mm")


# Invariance


SHAPES = [QUINTIC_TANGENT, AUMANN_CUBIC, aumann(AUMANN_POINTS, AUMANN_FIRST, "-1", "-2")]


@settings(max_examples=12)
@given(st.sampled_from(SHAPES), motions())
def test_moving_a_surface_does_not_change_its_pattern(table: Table, motion: object) -> None:
    made = patches(table)
    other = develop(tuple(moved(patch, motion) for patch in made))
    bound = 1e-14 * 1000 + 64 * EPS * 2000
    assert_near(flat(other), flat(develop(made)), bound=bound, why="control points rounded at up to 2 m")


@pytest.mark.parametrize("factor", [Fraction(1, 1000), Fraction(1, 7), Fraction(25), Fraction(4000)])
@pytest.mark.parametrize("table", SHAPES)
def test_a_larger_surface_has_the_same_pattern_larger(table: Table, factor: Fraction) -> None:
    made = patches(table)
    small = flat(develop(made))
    large = flat(develop(tuple(scaled(patch, factor) for patch in made)))
    bound = 2e-14 * float(np.abs(small).max())
    assert_near(large / float(factor), small, bound=bound, why="1e-14 of the size, twice")


SAME_SHAPE: dict[str, tuple[Callable[[RuledPatch], tuple[RuledPatch, ...]], Array, Array]] = {
    "the other way round": (lambda p: (turned_around(p),), GRID_U, 1.0 - GRID_V),
    "edges exchanged": (lambda p: (exchanged(p),), 1.0 - GRID_U, GRID_V),
    "a higher degree": (lambda p: (raised(p),), GRID_U, GRID_V),
    "in two pieces": (lambda p: in_pieces(p, 2), GRID_U, GRID_V),
    "in three pieces": (lambda p: in_pieces(p, 3), GRID_U, GRID_V),
}  # fmt: skip


@pytest.mark.parametrize("way", SAME_SHAPE)
@pytest.mark.parametrize("table", SHAPES)
def test_the_pattern_does_not_depend_on_how_the_surface_is_written(table: Table, way: str) -> None:
    patch = patches(table)[0]
    rewritten, u, v = SAME_SHAPE[way]
    expected = distances(flat(develop((patch,))))
    found = distances(flat(develop(rewritten(patch)), u, v))
    assert_near(found, expected, bound=4e-14 * float(expected.max()), why="1e-14 of the size on both sides")


@pytest.mark.parametrize("inner", [UNEVEN, AT_REST])
@pytest.mark.parametrize("table", SHAPES)
def test_the_pattern_does_not_depend_on_the_parameter(table: Table, inner: Polynomial) -> None:
    patch = patches(table)[0]
    expected = flat(develop((patch,)), GRID_U, np.array([value(inner, v) for v in GRID_V], dtype=float))
    found = flat(develop((reparametrised(patch, inner),)))
    assert_near(found, expected, bound=4e-14 * float(distances(expected).max()), why="1e-14 of the size on both sides")


# Frame, directions, refusals


def test_the_first_ruling_points_along_x_and_the_first_directrix_leaves_upwards() -> None:
    for table in (QUINTIC_TANGENT, OBLIQUE_CONE, ELLIPTIC_CYLINDER):
        piece = develop(patches(table)).pieces[0]
        first = piece.positions(np.array([0.0, 1.0]), np.zeros(2))
        assert_near(first[0], [0.0, 0.0], bound=1e-12, why="the origin")
        assert first[1, 0] > 0.0
        assert_near(first[1, 1], 0.0, bound=1e-12, why="along x")
        assert piece.velocities(np.array([0.0]), np.array([0.0]))[0, 1] > 0.0


def test_the_last_ruling_points_along_x_where_the_first_has_no_length() -> None:
    table = {"kind": "ruled", "c0": {"line": [[0, 0, 0], [3, 0, 0]]}, "c1": {"line": [[0, 0, 0], [3, 4, 0]]}}
    corners = flat(develop(patches(table)), np.array([0.0, 1.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0, 1.0]))
    expected = [[0.0, 0.0], [0.0, 0.0], [4.0, 3.0], [0.0, 3.0]]
    assert_near(corners, expected, bound=1e-14, why="a triangle with its last ruling of 4 mm along x, at y = 3")


def test_parallel_rulings_stay_parallel_where_they_shrink_to_nothing() -> None:
    """A pipe cut to a point at its seam, its axis in no special direction: an area in closed form.

    Plane x + z = 100 over the circle of radius 100 along d = (0.3, 0.2, 1): reach (100 - x) / 1.3, length times |d|.
    The area of the hoof is the integral of the ruling times the width across it, |d x c'|.
    """
    direction = np.array([0.3, 0.2, 1.0])
    circle = {"circle": {"center": [0, 0, 0], "radius": 100}}
    table = {"kind": "cylinder", "directrix": circle, "direction": [0.3, 0.2, 1],
             "end_plane": {"point": [100, 0, 0], "normal": [1, 0, 1]}}  # fmt: skip
    made = develop(patches(table))
    v = np.linspace(0.0, 1.0, 21)
    ends = [made.pieces[0].positions(np.full(21, u), v) for u in (0.0, 1.0)]
    rulings = ends[1] - ends[0]
    length = (100.0 - 100.0 * np.cos(2.0 * pi * v)) / 1.3 * norm(direction)
    assert_near(norm(rulings), length, bound=1e-12, why="1e-14 of 164 mm")
    across = rulings[:, 0] * rulings[10, 1] - rulings[:, 1] * rulings[10, 0]
    assert_near(across, 0.0 * v, bound=1e-14 * 164**2 * 4, why="one direction")


@pytest.mark.parametrize(
    ("direction", "lean"), [((-0.84, -0.47, 0.95), 0.03), ((0.57, 0.66, 0.51), 0.07), ((0.32, 0.4, 0.72), 0.17)]
)
def test_parallel_rulings_do_not_turn_by_rounding_however_short_they_get(
    direction: tuple[float, ...], lean: float
) -> None:
    """p'.w of these is 1e-17 and not 0: over a ruling that shrinks to nothing it would turn without bound."""
    arc = {"arc": {"center": [0, 0, 0], "radius": 100, "start": 0, "end": 60}}
    table = {"kind": "cylinder", "directrix": arc, "direction": list(direction),
             "end_plane": {"point": [100, 0, 0], "normal": [1, lean, 3]}}  # fmt: skip
    made = develop(patches(table))
    assert not made.pieces[0].phi[:, 1:].any()


def test_rulings_that_turn_without_end_are_refused_with_the_number_reached() -> None:
    folded = patches(aumann(AUMANN_POINTS, AUMANN_FIRST, "3", "-1.9"))[0]
    with pytest.raises(NoSolutionError, match="unrolling piece 0"):
        develop((folded,))


@pytest.mark.parametrize("name", ["beginnings", "MOST_TURN"])
def test_the_closed_forms_above_see_a_planted_fault(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    if name == "MOST_TURN":
        monkeypatch.setattr(development, "MOST_TURN", 100.0)
    else:
        monkeypatch.setattr(development, "beginnings", lambda local, start: beginnings(local, start) * (1.0 + 1e-12))
    with pytest.raises(AssertionError):
        test_a_right_frustum_unrolls_to_its_sector(3, 0, 0, 360)


def test_a_full_circle_of_a_plane_ring_closes() -> None:
    piece = develop(patches({"kind": "cone", "radius0": 1, "radius1": 3, "height": 0, "sweep": 360})).pieces[0]
    both = piece.positions(np.array([0.0, 0.0]), np.array([0.0, 1.0]))
    assert_near(both[0], both[1], bound=1e-13, why="1e-14 of 2 pi mm")
    half = piece.positions(np.array([1.0]), np.array([0.5]))[0]
    assert_relative(half[:1], [-4.0], bound=1e-13, why="the far side, 1 mm beyond a centre at -1 and 3 mm from it")
