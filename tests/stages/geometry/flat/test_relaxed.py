"""The flat map of least strain: closed form, a second method, what must stay the same, and what it says of itself."""

from fractions import Fraction
from math import asinh, degrees

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.errors import NoSolutionError
from stages.geometry.arrays import Array, norm
from stages.geometry.flat import minimise, refinement
from stages.geometry.flat import relaxed as leaststrain
from stages.geometry.flat.development import develop
from stages.geometry.flat.relaxed import Relaxed, relaxed
from stages.geometry.flat.relaxedmap import principal
from stages.geometry.ruled.ruled import at as surface_at
from stages.geometry.ruled.ruled import warp
from tests.near import assert_near, assert_relative
from tests.parts import (
    AUMANN_CUBIC,
    CONE_STRIP,
    EXAMPLE_1,
    EXAMPLE_2_PRINTED,
    OBLIQUE_CONE,
    QUINTIC_TANGENT,
    RIGHT_FRUSTUM,
    Table,
    patches,
)
from tests.strategies import motions, moved, scaled
from tests.warped import (
    CONE_AND_WARPED,
    HARD,
    POINTED,
    WAIST,
    Strip,
    U,
    V,
    backwards,
    exchanged,
    flat,
    helicoid,
    saddle,
    shaken,
    size,
)

ACCURACY = 1e-6


def distances(points: Array) -> Array:
    return norm(points[:, None] - points[None, :])


def largest(made: Relaxed) -> float:
    """The largest principal strain on a grid with the edges."""
    u, v = (axis.ravel() for axis in np.meshgrid(np.linspace(0.0, 1.0, 21), np.linspace(0.0, 1.0, 65)))
    return max(float(np.abs(principal(piece, u, v)).max()) for piece in made.development.pieces)


# Closed form


def test_far_from_its_ends_a_twisted_strip_keeps_its_mean_length() -> None:
    """A helicoid of twist k: a fibre at x from the axis is g = sqrt(1 + (k x)^2) times as long as the axis.

    Flat and straight, all fibres get the length L times the axis' and the strip may narrow freely: nothing strains it
    across.  The energy, the integral of (L / g - 1)^2 g, is least for L = k w / asinh(k w).
    """
    w, twist, length = 0.5, 0.2, 8.0
    made = relaxed(helicoid(w, twist * length, length), accuracy=ACCURACY)
    assert_near(degrees(warp(made.development.pieces[0].patch, np.array([0.5]))[0]), 11.421186274999288, bound=1e-12,
                why="2 atan(1/10)")  # fmt: skip
    mean = twist * w / asinh(twist * w)
    x = np.linspace(-w, w, 9)
    found = principal(made.development.pieces[0], (x + w) / (2.0 * w), np.full(9, 0.5))
    along = mean / np.sqrt(1.0 + (twist * x) ** 2) - 1.0
    expected = np.stack([np.maximum(along, 0.0), np.minimum(along, 0.0)], axis=1)
    # layers at the ends decay like exp(-2.1 z / w), exp(-16.8) = 5e-8 of 2e-3 at the middle
    assert_near(found, expected, bound=1e-9 + ACCURACY * 1e-1, why="strain_change in the middle, ends far away")
    piece = made.development.pieces[0]
    middle = piece.positions(np.full(2, 0.5), np.array([0.4, 0.6]))
    assert_relative(norm(middle[1:] - middle[:1]), [0.2 * length * mean], bound=1e-8, why="two positions to 1e-8")


def test_the_strains_of_known_surfaces() -> None:
    """The paper's Example 2 as printed, and the hyperbolic paraboloid with 10 deg of warp."""
    assert_relative(largest(relaxed(patches(EXAMPLE_2_PRINTED), accuracy=ACCURACY)), 6.21e-5, bound=0.01, why="known")
    assert_relative(largest(relaxed(saddle(10.0), accuracy=ACCURACY)), 1.565e-3, bound=0.002, why="four methods' limit")


def test_strain_grows_with_the_square_of_the_warp() -> None:
    strains = [largest(relaxed(saddle(warp_deg), accuracy=ACCURACY)) / warp_deg**2 for warp_deg in (0.5, 2.0, 8.0)]
    assert_relative(
        strains, np.full(3, 1.56e-5), bound=0.01, why="terms of the fourth order: (8 deg)^2 = 0.02, a third"
    )


# A second method


def triangles(n: int) -> Array:
    """The triangles of an n by n grid of squares, diagonals in turn, shape (2 n n, 3)."""
    made = []
    for i in range(n):
        for j in range(n):
            a, b, c, d = (i * (n + 1) + j, i * (n + 1) + j + 1, (i + 1) * (n + 1) + j, (i + 1) * (n + 1) + j + 1)
            made += [(a, b, d), (a, d, c)] if (i + j) % 2 else [(a, b, c), (b, d, c)]
    return np.array(made)


def mesh_energy(strip: Strip, n: int) -> float:
    """Half the least sum over triangles of area times squared strains, by local and global steps in turn."""
    from scipy import sparse
    from scipy.sparse.linalg import factorized

    v, u = (axis.ravel() for axis in np.meshgrid(*[np.linspace(0.0, 1.0, n + 1)] * 2, indexing="ij"))
    space, every = surface_at(strip[0], u, v), triangles(n)
    arms = space[every[:, 1:]] - space[every[:, :1]]
    first = arms[:, 0] / norm(arms[:, 0])[:, None]
    second = arms[:, 1] - (arms[:, 1] * first).sum(axis=1)[:, None] * first
    second /= norm(second)[:, None]
    local = np.stack([(arms * first[:, None]).sum(axis=2), (arms * second[:, None]).sum(axis=2)], axis=2)
    area = np.linalg.det(local) / 2.0
    # columns of the gradient: from the three corners' values to both derivatives
    slopes = np.linalg.inv(local) @ np.array([[-1.0, 1.0, 0.0], [-1.0, 0.0, 1.0]])
    rows = np.repeat(np.arange(2 * len(every)), 3)
    G = sparse.csr_matrix(
        (slopes.ravel(), (rows, np.repeat(every, 2, axis=0).ravel())), (2 * len(every), space.shape[0])
    )
    W = sparse.diags(np.repeat(area, 2))
    solve = factorized((G.T @ W @ G).tocsc()[1:, 1:])
    points = develop(strip).pieces[0].positions(u, v)
    energy = before = np.inf
    while not energy > before * (1.0 - 1e-7):
        J = np.swapaxes((G @ points).reshape(-1, 2, 2), 1, 2)
        U, s, Vt = np.linalg.svd(J)
        before, energy = energy, float((area * ((s - 1.0) ** 2).sum(axis=1)).sum()) / 2.0
        R = np.swapaxes(U @ Vt, 1, 2).reshape(-1, 2)
        points = np.vstack([np.zeros(2), *[np.column_stack([solve((G.T @ (W @ R[:, k]))[1:]) for k in range(2)])]])
    return energy


def test_a_triangle_mesh_converges_to_the_same_energy() -> None:
    strip = saddle(10.0)
    exact = relaxed(strip, accuracy=ACCURACY).energy
    coarse, fine = (mesh_energy(strip, n) for n in (12, 24))
    assert abs(fine - exact) < abs(coarse - exact) / 2.5
    # the error falls with the square of the width, so a third of the last change is still missing
    assert_relative(fine + (fine - coarse) / 3.0, exact, bound=0.01, why="next order of a mesh of 24 squares")


# What must stay the same

EXACT: dict[str, Table] = {
    "quintic tangent surface": QUINTIC_TANGENT, "Aumann's cubic": AUMANN_CUBIC, "oblique cone": OBLIQUE_CONE,
    "to the apex": RIGHT_FRUSTUM | {"radius1": 0}, "strip of cones": CONE_STRIP, "singular end rulings": EXAMPLE_1,
}  # fmt: skip


@pytest.mark.parametrize("name", EXACT)
def test_a_developable_surface_keeps_its_map(name: str) -> None:
    strip = patches(EXACT[name])
    made, along = relaxed(strip, accuracy=1e-9), develop(strip)
    assert_near(flat(made.development), flat(along), bound=1e-15 * size(flat(along)), why="the same, to rounding")
    assert made.reached < 1e-15
    assert made.energy <= made.energy_along_rulings < 1e-25 * size(flat(along)) ** 2


@settings(max_examples=3, deadline=None)
@given(motions())
def test_moving_a_surface_does_not_change_its_pattern(motion: object) -> None:
    strip = POINTED
    one = flat(relaxed(strip, accuracy=1e-3).development)
    other = flat(relaxed(tuple(moved(patch, motion) for patch in strip), accuracy=1e-3).development)
    assert_near(other, one, bound=1e-10, why="the same problem; control points rounded at up to 1 m, 1e-13, times 1000")


@pytest.mark.parametrize("factor", [Fraction(1, 1000), Fraction(25), Fraction(5000)])
def test_a_larger_surface_has_the_same_pattern_larger(factor: Fraction) -> None:
    strip = saddle(6.0)
    small, large = (relaxed(tuple(scaled(patch, by) for patch in strip), accuracy=1e-5) for by in (Fraction(1), factor))
    assert_near(flat(large.development) / float(factor), flat(small.development), bound=1e-13, why="the same problem")
    assert_relative(large.energy / float(factor) ** 2, small.energy, bound=1e-10, why="an area")


REWRITTEN = {"backwards": (backwards, U, 1.0 - V), "exchanged": (exchanged, 1.0 - U, V)}
SHAPES = {"shaken tangent surface": shaken(patches(QUINTIC_TANGENT), 1e-2), "pointed": POINTED}


@pytest.mark.parametrize("way", REWRITTEN)
@pytest.mark.parametrize("name", SHAPES)
def test_the_pattern_does_not_depend_on_how_the_surface_is_written(name: str, way: str) -> None:
    strip = SHAPES[name]
    rewrite, u, v = REWRITTEN[way]
    one, other = relaxed(strip, accuracy=ACCURACY), relaxed(rewrite(strip), accuracy=ACCURACY)
    expected = distances(flat(one.development))
    bound = 4.0 * (one.reached + other.reached) * float(expected.max()) + 1e-12
    assert_near(distances(flat(other.development, u, v)), expected, bound=bound, why="both errors, at both ends")


def test_the_same_strip_gives_the_same_bytes() -> None:
    first, second = (flat(relaxed(CONE_AND_WARPED, accuracy=1e-5).development) for _ in range(2))
    assert first.tobytes() == second.tobytes()


@settings(max_examples=3, deadline=None)
@given(st.integers(0, 1000), st.sampled_from([1e-4, 1e-2, 3e-2]), st.sampled_from([EXAMPLE_2_PRINTED, AUMANN_CUBIC]))
def test_the_energy_is_never_above_that_of_the_map_along_the_rulings(seed: int, amount: float, table: Table) -> None:
    made = relaxed(shaken(patches(table), amount, seed), accuracy=1e-3)
    assert 0.0 < made.energy < made.energy_along_rulings


# Error and refusal


@pytest.mark.parametrize("name", ["pointed end", "cone before a warped patch", "Example 2 as printed"])
def test_the_error_that_is_told_is_no_less_than_the_true_one(name: str) -> None:
    rough, fine = (relaxed(HARD[name], accuracy=accuracy) for accuracy in (1e-4, 1e-7))
    truth = flat(fine.development)
    away = float(norm(flat(rough.development) - truth).max()) / size(truth)
    assert away <= rough.reached + fine.reached
    assert fine.reached <= 1e-7


def test_strain_that_does_not_converge_says_so() -> None:
    """Corners into the pattern: at an angle over 180 deg the least strain is infinite; elsewhere it is known."""
    waist, convex = relaxed(WAIST, accuracy=ACCURACY), relaxed(saddle(10.0), accuracy=ACCURACY)
    assert waist.strain_change > 0.05 * largest(waist)
    assert convex.strain_change < 0.02 * largest(convex)


def test_what_refinement_does_not_reach_is_refused_with_both_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(leaststrain, "LEVELS", leaststrain.LEVELS[:3])
    with pytest.raises(NoSolutionError, match="least strain") as error:
        relaxed(WAIST, accuracy=1e-14)
    assert error.value.wanted == np.float64(1e-14)
    assert 1e-14 < error.value.reached < 1e-5


def test_newton_steps_that_do_not_end_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(minimise, "MOST_STEPS", 1)
    with pytest.raises(NoSolutionError, match="strain energy"):
        relaxed(saddle(20.0), accuracy=1e-6)


def test_equations_without_a_solution_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(minimise, "solved", lambda system, right: None)
    with pytest.raises(NoSolutionError, match="free to move"):
        relaxed(saddle(20.0), accuracy=1e-6)


def test_the_convex_part_alone_leads_to_the_same_minimum(monkeypatch: pytest.MonkeyPatch) -> None:
    expected = flat(relaxed(saddle(20.0), accuracy=1e-5).development)
    honest = minimise.hessian
    monkeypatch.setattr(minimise, "hessian", lambda sheet, at, convex: honest(sheet, at, convex=True))
    assert_near(flat(relaxed(saddle(20.0), accuracy=1e-5).development), expected, bound=1e-7, why="last steps of 1e-8")


def test_settled_strain_is_told_from_strain_that_grows() -> None:
    change = refinement.Change
    assert change(1.0, 0.01, 1.0).settled(None)
    assert not change(1.0, 0.2, 1.0).settled(None)
    assert not change(1.0, 0.2, 1.0).settled(change(1.0, 0.5, 1.0))
    assert change(1.0, 0.2, 1.0).settled(change(1.0, 0.2, 1.0))
