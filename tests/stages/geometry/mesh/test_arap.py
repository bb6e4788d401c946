"""The energy of a flattening: closed forms, its derivatives by differences, what no motion changes."""

import numpy as np
import pytest
from scipy.sparse import csc_array

from stages.geometry.arrays import EPS, Array, Points2, norm
from stages.geometry.mesh.arap import (
    Sheet,
    energy,
    free_unknowns,
    second,
    settled,
    sheet,
    slope_of,
    slots_of,
    strain_tensors,
    strains,
)
from stages.geometry.mesh.intrinsic import laid
from tests.meshes import jittered, misplaced
from tests.near import assert_near, assert_relative

STEP = 1e-6


def resting(seed: int = 0) -> tuple[Sheet, Points2]:
    """An irregular plane mesh at rest, and where it lies."""
    v, u, faces = jittered(seed, 5, 4)
    flat = np.column_stack([5.0 * v, 4.0 * u])
    sides = norm(flat[faces[:, [1, 2, 0]]] - flat[faces])
    return sheet(faces, laid(sides), len(flat)), flat


def strained(seed: int = 0) -> tuple[Sheet, Points2]:
    """The same, moved far from rest."""
    rest, flat = resting(seed)
    return rest, flat @ [[1.2, 0.1], [-0.3, 0.9]] + np.random.default_rng(seed).normal(0.0, 0.05, flat.shape)


def turned(flat: Points2, angle: float) -> Points2:
    c, s = np.cos(angle), np.sin(angle)
    return np.asarray(flat @ [[c, s], [-s, c]])


def assembled(rest: Sheet, parts: Array) -> Array:
    """The second derivatives of the whole from those of the triangles."""
    pattern, slots = slots_of(rest)
    data = np.bincount(slots, parts.ravel(), minlength=len(pattern.data))
    return np.asarray(csc_array((data, pattern.indices, pattern.indptr), shape=pattern.shape).toarray())


@pytest.mark.parametrize("seed", range(4))
def test_the_slope_is_that_of_the_energy(seed: int) -> None:
    rest, flat = strained(seed)
    found = np.zeros(flat.size)
    for i in range(flat.size):
        step = np.zeros(flat.size)
        step[i] = STEP
        ahead, behind = (energy(rest, flat + sign * step.reshape(-1, 2)) for sign in (1.0, -1.0))
        found[i] = (ahead - behind) / (2.0 * STEP)
    assert_near(slope_of(rest, flat), found, bound=8.0 * EPS * 5.0 / STEP + 100.0 * STEP**2,
                why="energies of 5 are rounded 8 times; third derivatives of 100 at most")  # fmt: skip


@pytest.mark.parametrize("seed", range(4))
def test_the_second_derivatives_are_those_of_the_slope(seed: int) -> None:
    rest, flat = strained(seed)
    whole = assembled(rest, second(rest, flat, convex=False))
    found = np.zeros_like(whole)
    for i in range(flat.size):
        step = np.zeros(flat.size)
        step[i] = STEP
        ahead, behind = (slope_of(rest, flat + sign * step.reshape(-1, 2)) for sign in (1.0, -1.0))
        found[i] = (ahead - behind) / (2.0 * STEP)
    assert_near(
        whole, found, bound=64.0 * EPS * 5.0 / STEP + 1e4 * STEP**2, why="slopes of 5, fourth derivatives of 1e4"
    )
    assert_near(whole, whole.T, bound=64.0 * EPS * np.abs(whole).max(), why="the order of sums")


@pytest.mark.parametrize("angle", [0.3, 1.5, 3.0])
def test_no_motion_changes_energy_and_strains(angle: float) -> None:
    rest, flat = strained(1)
    moved = turned(flat, angle) + np.array([3.0, -40.0])
    assert_relative(energy(rest, moved), energy(rest, flat), bound=1e-12, why="coordinates of 40, strains of 0.3")
    assert_near(strains(rest, moved), strains(rest, flat), bound=1e-12, why="the same")
    at_rest = energy(rest, turned(resting(1)[1], angle))
    assert at_rest <= (64.0 * EPS) ** 2 * rest.area.sum()


def test_slope_and_bending_vanish_along_motions_at_rest() -> None:
    rest, flat = resting()
    spun = np.column_stack([-flat[:, 1], flat[:, 0]]).ravel()
    assert np.abs(slope_of(rest, flat)).max() < 64.0 * EPS * 5.0
    whole = assembled(rest, second(rest, flat, convex=False))
    for motion in (spun, np.tile([1.0, 0.0], len(flat)), np.tile([0.0, 1.0], len(flat))):
        assert np.abs(whole @ motion).max() < 1e-12 * np.abs(whole).max() * np.abs(motion).max()


def test_strains_of_a_stretched_sheet_in_closed_form() -> None:
    rest, flat = resting()
    stretched = turned(flat * [1.1, 0.95], 0.5)
    assert_near(strains(rest, stretched), np.tile([0.1, -0.05], (len(rest.faces), 1)), bound=1e-13, why="rounding")
    c, s = np.cos(0.5), np.sin(0.5)
    along = [0.1 * c * c - 0.05 * s * s, 0.15 * s * c, 0.1 * s * s - 0.05 * c * c]
    assert_near(strain_tensors(rest, stretched), np.tile(along, (len(rest.faces), 1)), bound=1e-13, why="rounding")
    assert_relative(
        energy(rest, stretched), 5.0 * 4.0 * (0.1**2 + 0.05**2), bound=1e-12, why="rounding of strains of 0.05"
    )


def test_a_sheet_turned_over_is_known_by_its_strains() -> None:
    rest, flat = resting()
    assert_near(strains(rest, flat * [1.0, -1.0]), np.tile([0.0, -2.0], (len(rest.faces), 1)), bound=1e-13,
                why="singular values 1 and -1")  # fmt: skip


def test_cut_to_convexity_the_second_derivatives_are_never_negative() -> None:
    rest, flat = resting()
    pressed = flat * [0.5, 0.3]
    raw, cut = (np.linalg.eigvalsh(second(rest, pressed, convex=convex)) for convex in (False, True))
    assert raw.min() < -0.1, "the case is one where it matters"
    assert cut.min() > -64.0 * EPS * cut.max()


def test_what_is_held_is_one_motion_of_the_whole() -> None:
    rest, flat = resting()
    free = free_unknowns(rest, flat)
    assert len(free) == flat.size - 3
    whole = assembled(rest, second(rest, flat, convex=False))[np.ix_(free, free)]
    assert np.linalg.eigvalsh(whole).min() > 1e-6


def test_it_comes_to_rest_from_far_away() -> None:
    rest, flat = resting()
    found = settled(rest, strained()[1], still=1e-12)
    assert misplaced(found.positions, flat) < 1e-11
    assert found.step_mm <= 1e-12
    assert found.energy_mm2 < 1e-20
