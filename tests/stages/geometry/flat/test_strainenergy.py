"""The strain energy: against singular values, and its derivatives against differences."""

from itertools import pairwise

import numpy as np
import pytest

from stages.geometry.arrays import Array
from stages.geometry.flat import strainenergy
from stages.geometry.flat.development import RulingMap, develop
from stages.geometry.flat.strainenergy import Sheet, energy, gradient, hessian, joined, metric, stretched
from stages.geometry.numeric.elements import Degrees, node_places, rule
from stages.geometry.ruled.ruled import at as surface_at
from tests.near import assert_near, assert_relative
from tests.warped import CONE_AND_WARPED, POINTED, Strip, saddle

DEGREES = Degrees(3, 4)
BREAKS = np.array([0.0, 0.4, 1.0])


def made(strip: Strip, piece: int = 0) -> tuple[RulingMap, Sheet]:
    base = develop(strip).pieces[piece]
    assert isinstance(base, RulingMap)
    return base, strainenergy.sheet(base, BREAKS, DEGREES)


def displaced(seed: int, amount: float) -> Array:
    nodes = (DEGREES.u + 1) * (DEGREES.v + 1)
    return np.random.default_rng(seed).uniform(-amount, amount, (2, nodes, 2))


def tangents(base: RulingMap, u: Array, v: Array) -> tuple[Array, Array]:
    """Differences of points of the surface, taken as its tangents: nothing but positions."""
    step = 1e-6
    patch = base.patch
    by_u = (surface_at(patch, u + step, v) - surface_at(patch, u - step, v)) / (2.0 * step)
    by_v = (surface_at(patch, u, v + step) - surface_at(patch, u, v - step)) / (2.0 * step)
    return by_u, by_v


@pytest.mark.parametrize("strip", [saddle(30.0), POINTED])
def test_the_energy_is_that_of_singular_values_of_the_map_between_tangent_planes(strip: Strip) -> None:
    """F_u, F_v = J (S_u, S_v) in any orthonormal frame: J J^T = F g^-1 F^T with the first fundamental form g.

    The smaller stretch counts as negative where the pattern is turned over.
    """
    base, sheet = made(strip)
    moved = displaced(5, 0.02)
    points = rule(DEGREES)
    total = 0.0
    for element, (low, high) in enumerate(pairwise(BREAKS)):
        v = low + (high - low) * points.v
        s_u, s_v = tangents(base, points.u, v)
        g = np.stack([np.stack([(a * b).sum(axis=1) for b in (s_u, s_v)], axis=1) for a in (s_u, s_v)], axis=1)
        step = 1e-6
        f_u = base.positions(np.ones_like(v), v) - base.positions(np.zeros_like(v), v)
        f_v = (base.positions(points.u, v + step) - base.positions(points.u, v - step)) / (2.0 * step)
        f_u, f_v = f_u + points.by_u @ moved[element], f_v + points.by_v @ moved[element] / (high - low)
        F = np.stack([f_u, f_v], axis=2)
        square = F @ np.linalg.inv(g) @ np.swapaxes(F, 1, 2)
        stretches = np.sqrt(np.linalg.eigvalsh(square))
        stretches[:, 0] *= np.sign(np.linalg.det(F))
        area = points.weights * (high - low) * np.sqrt(np.linalg.det(g))
        total += float((area * ((stretches - 1.0) ** 2).sum(axis=1)).sum()) / 2.0
    # tangents by differences: 1e-16 / 1e-6 and 1e-12 of the size, over strains of some 1e-1
    assert_relative(energy(sheet, stretched(sheet, moved)), total, bound=1e-7, why="differences, relative to strains")


@pytest.mark.parametrize(("strip", "piece"), [(saddle(30.0), 0), (POINTED, 0), (CONE_AND_WARPED, 0)])
def test_the_gradient_is_the_slope_of_the_energy(strip: Strip, piece: int) -> None:
    _, sheet = made(strip, piece)
    moved, way = displaced(1, 0.02), displaced(2, 1.0)
    step = 1e-6
    ends = [energy(sheet, stretched(sheet, moved + side * step * way)) for side in (1.0, -1.0)]
    slope = float((gradient(sheet, stretched(sheet, moved)) * way).sum())
    assert_relative(
        (ends[0] - ends[1]) / (2.0 * step), slope, bound=1e-7, why="rounding over step, step^2 third derivs"
    )


@pytest.mark.parametrize(("strip", "piece"), [(saddle(30.0), 0), (POINTED, 0), (CONE_AND_WARPED, 0)])
def test_the_second_derivatives_are_the_slope_of_the_gradient(strip: Strip, piece: int) -> None:
    _, sheet = made(strip, piece)
    moved, way = displaced(1, 0.02), displaced(2, 1.0)
    step = 1e-6
    ends = [gradient(sheet, stretched(sheet, moved + side * step * way)) for side in (1.0, -1.0)]
    blocks = hessian(sheet, stretched(sheet, moved), convex=False)
    expected = np.einsum("mij,mj->mi", blocks, way.reshape(2, -1))
    found = ((ends[0] - ends[1]) / (2.0 * step)).reshape(2, -1)
    assert_near(found, expected, bound=1e-7 * float(np.abs(expected).max()), why="rounding over step, step^2 thirds")


def test_the_convex_part_bends_upwards_everywhere_and_the_whole_does_not() -> None:
    _, sheet = made(saddle(30.0))
    squeezed = stretched(sheet, displaced(1, 0.0))
    lowest = [np.linalg.eigvalsh(hessian(sheet, squeezed, convex=convex)).min() for convex in (True, False)]
    assert lowest[0] > -1e-13
    assert lowest[1] < -1e-5


def test_a_developable_patch_along_its_rulings_has_no_energy_and_no_slope() -> None:
    _, sheet = made(CONE_AND_WARPED)
    at = stretched(sheet, displaced(1, 0.0))
    assert energy(sheet, at) < 1e-28
    assert np.abs(gradient(sheet, at)).max() < 1e-14


def test_a_turned_pattern_has_the_energy_it_had() -> None:
    """d = (R - 1) flat, without strain however far it turns; Z keeps its digits where |J|^2 - 2 (s1 + s2) would not."""
    base, _ = made(CONE_AND_WARPED)
    degrees = Degrees(6, 14)
    breaks = np.linspace(0.0, 1.0, 6)
    sheet = strainenergy.sheet(base, breaks, degrees)
    columns, u = node_places(breaks, degrees)
    flat = base.positions(np.tile(u, columns.size), np.repeat(columns.ravel(), u.size)).reshape(5, -1, 2)
    for turn in (1e-5, 0.3, 2.0):
        c, s = np.cos(turn), np.sin(turn)
        moved = flat @ (np.array([[c, s], [-s, c]]) - np.eye(2))
        rounding = 2e-16 * min(turn, 1.0) ** 2 * sheet.weights.sum()
        assert energy(sheet, stretched(sheet, moved)) < rounding, "|G|^2 is the square of the turn"


def test_warp_and_its_small_angle_are_in_kappa_without_cancellation() -> None:
    for warp_deg, digits in ((10.0, 1e-12), (1e-4, 1e-9)):
        base, _ = made(saddle(warp_deg))
        found = metric(base, np.array([0.0, 1.0]), np.full(2, 0.5)).kappa
        expected = 2.0 * np.sin(np.radians(warp_deg) / 4.0) ** 2
        assert_relative(found, np.full(2, expected), bound=digits, why="1 - cos of half the warp; z is rounded")


def test_elements_of_several_patches_are_joined_in_their_order() -> None:
    sheets = [made(CONE_AND_WARPED, piece)[1] for piece in (0, 1)]
    both = joined(sheets)
    moved = displaced(4, 0.01)
    parts = [energy(sheet, stretched(sheet, moved)) for sheet in sheets]
    whole = energy(both, stretched(both, np.concatenate([moved, moved])))
    assert_relative(whole, sum(parts), bound=1e-14, why="a sum in another order")


FAULTS = {
    "by_e": saddle(30.0),
    "by_w": saddle(30.0),
    "kappa": saddle(30.0),
    "weights": saddle(30.0),
    "sin": CONE_AND_WARPED[:1],
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_in_the_sheet_is_seen(fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    honest = strainenergy.sheet

    def wrong(*arguments: object) -> Sheet:
        sheet = honest(*arguments)
        return sheet.replace(**{fault: getattr(sheet, fault) * (1.0 + 1e-5)})

    monkeypatch.setattr(strainenergy, "sheet", wrong)
    with pytest.raises(AssertionError):
        test_the_energy_is_that_of_singular_values_of_the_map_between_tangent_planes(FAULTS[fault])
