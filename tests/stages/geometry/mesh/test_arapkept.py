"""Flattening with lengths that are kept: caps in closed form, another minimiser, invariance, contradictions."""

import numpy as np
import pytest
from scipy.optimize import minimize

from stages.errors import NoSolutionError
from stages.geometry.arrays import norm
from stages.geometry.mesh.arap import Sheet, energy
from stages.geometry.mesh.arapkept import settled_with
from stages.geometry.mesh.fit import fitted, stars
from stages.geometry.mesh.flat import at_rest, edge_lengths, resting
from stages.geometry.mesh.lengths import chords
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.ties import (
    Ties,
    derivatives,
    equal,
    kept,
    left_sides,
    no_ties,
    off_by,
    second_derivatives,
    together,
)
from stages.geometry.mesh.topology import edges_of
from tests.caps import RADIUS, cap, constant, flat_radius
from tests.meshes import misplaced
from tests.near import assert_near
from tests.tubes import rotation

HALF = 0.5


def laid(mesh: Mesh, *, keep: bool) -> tuple[np.ndarray, np.ndarray, Ties]:
    edges = edges_of(mesh)
    lengths, kind = edge_lengths(mesh, edges, fitted(mesh, stars(mesh, edges)))
    border = np.flatnonzero(edges.count == 1)
    ties = kept(edges.ends[border], lengths[border]) if keep else no_ties()
    found = at_rest(mesh, edges, lengths, ties, kind=kind, noise_mm=0.0, accuracy=1e-8)
    return found.positions, found.strains, ties


@pytest.mark.parametrize("keep", [False, True])
@pytest.mark.parametrize("half", [0.2, 0.5, 0.8])
def test_a_cap_lies_flat_as_the_closed_form_says(half: float, keep: bool) -> None:
    mesh = cap(half)
    positions, _, ties = laid(mesh, keep=keep)
    x, y, z = mesh.vertices.T
    polar, turn = np.arctan2(np.hypot(x, y), z), np.arctan2(y, x)
    exact = flat_radius(polar, half, kept=keep)[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])
    # linear triangles of h = 2 / 30: strains that vary by half^2 over the cap are off by that times h^2
    bound = RADIUS * half * half**2 * (2.0 / 30.0) ** 2
    assert_near(misplaced(positions, exact), 0.0, bound=bound, why="linear triangles")
    assert off_by(ties, positions) <= 1e-12


def test_the_closed_form_is_the_least_energy() -> None:
    """Radii moved by any smooth amount that is 0 at the pole raise the integral: the derivative vanishes."""
    s, weight = np.polynomial.legendre.leggauss(60)
    polar, weight = HALF * (s + 1.0) / 2.0, HALF / 2.0 * weight
    rho, step = RADIUS * np.sin(polar), 1e-6

    def slope(r: object) -> np.ndarray:
        return (r(polar + step) - r(polar - step)) / (2.0 * step * RADIUS)  # type: ignore[operator]

    def exact(polar: np.ndarray) -> np.ndarray:
        return flat_radius(polar, HALF)

    for power in (1, 2, 3):
        other = polar**power * RADIUS
        change = power * polar ** (power - 1)
        first = weight @ (rho * ((slope(exact) - 1.0) * change + (exact(polar) / rho - 1.0) * other / rho))
        assert_near(first, 0.0, bound=1e-6, why="differences over 1e-6 of radii of 50 mm")
    assert_near(constant(1e-3, kept=False), 1.0, bound=1e-6, why="a cap that is nearly flat")


def small() -> tuple[Mesh, Sheet, np.ndarray, np.ndarray]:
    mesh = cap(0.7, cells=4, seed=3)
    edges = edges_of(mesh)
    lengths = chords(mesh.vertices, edges.ends)
    return mesh, resting(mesh, edges, lengths), edges.ends, lengths


def test_another_minimiser_finds_no_less() -> None:
    mesh, rest, ends, lengths = small()
    edges = edges_of(mesh)
    border = np.flatnonzero(edges.count == 1)
    ties = together(
        kept(ends[border[:6]], lengths[border[:6]]),
        equal(ends[border[7:9]], ends[border[9:11]], lengths[border[7:9]]),
    )
    found = settled_with(rest, mesh.vertices[:, :2].copy(), ties, still=1e-9)
    assert off_by(ties, found.positions) <= 1e-12
    free = settled_with(rest, mesh.vertices[:, :2].copy(), no_ties(), still=1e-9)
    other = minimize(
        lambda x: energy(rest, x.reshape(-1, 2)), free.positions.ravel(), method="SLSQP",
        constraints={"type": "eq", "fun": lambda x: left_sides(ties, x.reshape(-1, 2)) - ties.wanted},
        options={"maxiter": 300, "ftol": 1e-12},
    )  # fmt: skip
    assert free.energy_mm2 < found.energy_mm2
    assert_near(other.fun, found.energy_mm2, bound=1e-4 * found.energy_mm2, why="differences for derivatives")


def test_derivatives_of_ties_are_those_of_their_left_sides() -> None:
    mesh, _, ends, lengths = small()
    ties = together(kept(ends[:5], lengths[:5]), equal(ends[5:8], ends[8:11], lengths[5:8]))
    source = np.random.default_rng(4)
    x, way = source.normal(size=(len(mesh.vertices), 2)) * 30.0, source.normal(size=(len(mesh.vertices), 2))
    multipliers = source.normal(size=len(ties))
    forth, back = (left_sides(ties, x + sign * way) for sign in (1.0, -1.0))
    across = derivatives(ties, x) @ way.ravel()
    assert_near((forth - back) / 2.0, across, bound=1e-12, why="exact for quadratic functions")
    second = multipliers @ (forth + back - 2.0 * left_sides(ties, x))
    curved = way.ravel() @ (second_derivatives(ties, multipliers, len(x)) @ way.ravel())
    assert_near(second, curved, bound=1e-10, why="exact for quadratic functions")


@pytest.mark.parametrize("scale", [0.01, 1.0, 100.0])
def test_motion_and_scale_change_nothing_but_the_size(scale: float) -> None:
    mesh = cap(HALF, cells=12)
    one, strains, _ = laid(mesh, keep=True)
    other, moved, _ = laid(Mesh(scale * mesh.vertices @ rotation(3).T + [5.0, -7.0, 2.0], mesh.faces), keep=True)
    assert_near(moved, strains, bound=1e-6, why="at rest to 1e-8 mm of a cap of 1 mm and more")
    apart = norm(one - one[0]), norm(other - other[0])
    assert_near(apart[1], scale * apart[0], bound=1e-6 * scale * 100.0, why="the same")


def test_lengths_that_contradict_each_other_are_refused() -> None:
    mesh, rest, ends, lengths = small()
    edges = edges_of(mesh)
    triangle = edges.of_half[:3]
    wrong = lengths[triangle] * np.array([3.0, 1.0, 1.0])
    with pytest.raises(NoSolutionError, match="lengths that are to be kept"):
        settled_with(rest, mesh.vertices[:, :2].copy(), kept(ends[triangle], wrong), still=1e-9)


def test_a_length_that_is_off_by_a_millionth_is_told() -> None:
    mesh, _, ends, _ = small()
    flat = mesh.vertices[:, :2].copy()
    exact = kept(ends, norm(flat[ends[:, 1]] - flat[ends[:, 0]]))
    assert off_by(exact, flat) <= 1e-15
    assert_near(off_by(exact, flat * (1.0 + 1e-6)), 1e-6, bound=1e-11, why="(1 + e)^2 / 2 - 1/2")
