"""Best fits: what is known is found again from any frame, and nothing near by is better."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from stages.geometry.arrays import Points3, Values, cross3, norm
from stages.geometry.ruled import bestfit
from stages.geometry.ruled.bestfit import BestFit, best_fit
from stages.geometry.ruled.feet import BESIDE, exact_feet, off_faces
from stages.geometry.ruled.strip import Strip, jet, size
from tests.near import assert_near
from tests.parts import CONE_STRIP, MITRED_CYLINDER, OBLIQUE_CONE, RIGHT_FRUSTUM, Table, patches

COUNT = 20


def strip_of(table: Table) -> Strip:
    return Strip(patches(table), np.arange(len(patches(table)) + 1.0))


OBLIQUE, FRUSTUM, MITRED = (strip_of(one) for one in (OBLIQUE_CONE, RIGHT_FRUSTUM, MITRED_CYLINDER))
TWO = Strip(patches(CONE_STRIP), np.array([0.0, 1.0, 3.0]))


def probed(strip: Strip, off: Values, seed: int) -> Points3:
    """Return points so far above the surface, at random all over it."""
    rng = np.random.default_rng(seed)
    ends = strip.knots[[0, -1]]
    found = jet(strip, rng.uniform(0.02, 0.98, off.size), rng.uniform(*ends, off.size))
    normal = cross3(found.s_u, found.s_v)
    return np.asarray(found.s + off[:, None] * normal / norm(normal)[:, None])


def elsewhere(points: Points3, seed: int) -> Points3:
    """Return points in a frame of which nothing is known."""
    rng = np.random.default_rng(seed)
    shift = rng.normal(size=3) * 10.0 * float(np.ptp(points, axis=0).max())
    return np.asarray((points - shift) @ Rotation.random(rng=rng).as_matrix())


@pytest.mark.parametrize(("strip", "height"), [(OBLIQUE, 0.01), (TWO, 0.0)])
def test_points_on_a_part_find_their_places_from_any_frame(strip: Strip, height: float) -> None:
    heights = np.full(COUNT, height * size(strip))
    there = probed(strip, heights, 1)
    measured = elsewhere(there, 2)
    found, _ = best_fit(strip, measured, heights)
    assert found.rms_mm <= 1e-12 * size(strip)
    assert_near(found.motion.moved(measured), there, bound=1e-10 * size(strip), why="distances tell 1/100 of a motion")
    assert (found.free, found.alone) == (0, True)
    assert found.last_step_mm <= 1e-10 * size(strip)


@pytest.mark.parametrize(("strip", "free"), [(FRUSTUM, 1), (MITRED, 2)])
def test_motions_that_no_point_tells_are_counted(strip: Strip, free: int) -> None:
    """A frustum turns about its axis; a cylinder moves along it as well, between its edges."""
    heights = np.zeros(COUNT)
    found, _ = best_fit(strip, elsewhere(probed(strip, heights, 3), 4), heights)
    assert found.rms_mm <= 1e-12 * size(strip)
    assert (found.free, found.alone) == (free, False)


def noisy(factor: float, seed: int) -> tuple[Points3, BestFit]:
    """Return points beside an oblique cone, so many times as large, and their best fit from another frame."""
    directrix = {"circle": {"center": [0, 0, 0], "radius": 2 * factor}}
    apex = [1.5 * factor, 0.5 * factor, 4 * factor]
    strip = strip_of({"kind": "cone", "apex": apex, "directrix": directrix, "fraction": [0, 0.75]})
    off = np.random.default_rng(5).normal(0.0, 1e-3 * factor, COUNT)
    measured = elsewhere(probed(strip, off, 5), seed)
    return measured, best_fit(strip, measured, np.zeros(COUNT))[0]


def test_what_is_best_depends_neither_on_the_frame_nor_on_the_size() -> None:
    (one, first), (other, second) = noisy(1.0, 6), noisy(1000.0, 7)
    assert_near(first.motion.moved(one), second.motion.moved(other) / 1000.0, bound=1e-8, why="a told share of 1e-8")
    assert_near(first.rms_mm, second.rms_mm / 1000.0, bound=1e-12, why="the same least, to second order")
    assert first.rms_mm < 1e-3


def test_at_the_least_distances_balance() -> None:
    """Neither a shift nor a turn about the middle lowers their sum of squares."""
    heights = np.full(COUNT, 0.02)
    there = probed(TWO, 0.02 + np.random.default_rng(8).normal(0.0, 2e-3, COUNT), 8)
    measured = elsewhere(there, 9)
    fit, feet = best_fit(TWO, measured, heights)
    here = fit.motion.moved(measured)
    assert_near(feet.place, exact_feet(TWO, here).place, bound=0.0, why="the same search")
    off, along = off_faces(TWO, feet, here, heights)
    assert_near(off @ along, np.zeros(3), bound=1e-9, why="20 distances of 2e-3, by a motion known to 1e-8")
    assert_near(off @ cross3(here - here.mean(axis=0), along), np.zeros(3), bound=1e-8, why="the same, times the arms")


def plane() -> Strip:
    return strip_of(
        {"kind": "ruled", "c0": {"line": [[0, 0, 0], [100, 0, 0]]}, "c1": {"line": [[0, 60, 0], [90, 60, 0]]}}
    )


def test_on_a_plane_the_least_is_the_least_singular_value() -> None:
    rng = np.random.default_rng(10)
    points = np.stack([rng.uniform(20, 70, 40), rng.uniform(10, 50, 40), rng.normal(0.0, 0.05, 40)], axis=1)
    found, _ = best_fit(plane(), points, np.zeros(40))
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    assert_near(found.rms_mm, float(spread[-1]) / np.sqrt(40.0), bound=1e-12, why="the closed form, some 0.05 mm")
    assert found.free == 3


def test_edges_hold_points_back() -> None:
    """Points all over a plane that lie beyond one edge by 5 mm are moved in by it."""
    grid = np.stack(np.meshgrid(np.linspace(5.0, 85.0, 9), np.linspace(0.0, 60.0, 7)), axis=-1).reshape(-1, 2)
    points = np.column_stack([grid[:, 0], grid[:, 1] + 5.0, np.zeros(len(grid))])
    found, _ = best_fit(plane(), points, np.zeros(len(points)))
    assert found.rms_mm <= 1e-9
    assert_near(found.motion.moved(points)[:, 1].max(), 60.0, bound=BESIDE * size(plane()), why="nearer is not beyond")


def test_a_mirrored_part_does_not_fit() -> None:
    heights = np.zeros(COUNT)
    there = probed(TWO, heights, 11) * np.array([1.0, 1.0, -1.0])
    assert best_fit(TWO, there, heights)[0].rms_mm > 1e-3 * size(TWO)


def test_all_points_are_settled_from_the_best_start_of_some(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every other point is tried, and the others count as much in what is least."""
    heights = np.zeros(2 * COUNT)
    there = probed(OBLIQUE, np.random.default_rng(14).normal(0.0, 1e-3, 2 * COUNT), 14)
    measured = elsewhere(there, 15)
    every, _ = best_fit(OBLIQUE, measured, heights)
    monkeypatch.setattr(bestfit, "MOST_TRIED", COUNT)
    found, _ = best_fit(OBLIQUE, measured, heights)
    assert_near(found.motion.moved(measured), every.motion.moved(measured), bound=1e-8, why="a told share of 1e-8")


def test_feet_that_do_not_come_to_rest_are_no_fit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bestfit, "EXACT_ROUNDS", 0)
    heights = np.zeros(COUNT)
    assert best_fit(MITRED, probed(MITRED, heights, 16), heights)[0].last_step_mm == np.inf
