"""The flat map of least strain on hard strips: at rest, any displacement strains it more; frame, derivatives, joins."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from numpy.polynomial import legendre

from stages.geometry.arrays import Array, norm
from stages.geometry.flat import strainenergy
from stages.geometry.flat.development import RulingMap, develop
from stages.geometry.flat.flatmap import Development, FlatPiece
from stages.geometry.flat.relaxed import relaxed
from stages.geometry.flat.relaxedmap import RelaxedMap, principal
from tests.near import assert_near, assert_relative
from tests.warped import (
    CONE_AND_WARPED,
    HARD,
    flat,
    saddle,
    size,
)

NODES, WEIGHTS = legendre.leggauss(24)
SLOPES = legendre.legvander(NODES, 22) @ legendre.legder(np.linalg.inv(legendre.legvander(NODES, 23)), axis=0)
"""Derivatives at 24 Gauss nodes from values there."""
Field = Callable[[Array], Array]


def measured(made: Development, field: Field) -> tuple[float, float]:
    """Half the integral of squared strains, from positions alone, after a field of the plane; and the area."""
    found = [_measured(piece, low, high, field) for piece in made.pieces for low, high in pairwise(piece.breaks)]
    energy, area = np.sum(found, axis=0)
    return float(energy), float(area)


def _measured(piece: FlatPiece, low: float, high: float, field: Field) -> tuple[float, float]:
    base = piece.base if isinstance(piece, RelaxedMap) else piece
    assert isinstance(base, RulingMap)
    v, u = (axis.ravel() for axis in np.meshgrid(low + (high - low) * (NODES + 1) / 2, (NODES + 1) / 2, indexing="ij"))
    points = field(piece.positions(u, v)).reshape(24, 24, 2)
    f_u = 2.0 * np.einsum("ij,vjc->vic", SLOPES, points).reshape(-1, 2)
    f_v = 2.0 / (high - low) * np.einsum("ij,juc->iuc", SLOPES, points).reshape(-1, 2)
    at = strainenergy.metric(base, u, v)
    f_e = f_u / at.length[:, None]
    f_w = (f_v - at.along[:, None] * f_e) / at.aside[:, None]
    strains = np.linalg.svd(np.stack([f_e, f_w], axis=2), compute_uv=False) - 1.0
    area = np.outer(WEIGHTS, WEIGHTS).ravel() / 4.0 * (high - low) * at.length * at.aside
    return float((area * (strains**2).sum(axis=1)).sum()) / 2.0, float(area.sum())


def fields(extent: float) -> dict[str, Callable[[Array], Array]]:
    """Displacements of the plane with derivatives of about 1."""

    def wave(points: Array) -> Array:
        return extent / 4.0 * np.stack([np.sin(4.0 * points[:, 1] / extent), np.cos(3.0 * points[:, 0] / extent)], 1)

    matrices = {"larger": [[1.0, 0.0], [0.0, 1.0]], "longer": [[1.0, 0.0], [0.0, -1.0]], "slanted": [[0.0, 1.0]] * 2}
    return {"wavy": wave} | {name: (lambda points, m=m: points @ np.array(m)) for name, m in matrices.items()}


def slope_and_rise(made: Development, extent: float, way: Callable[[Array], Array]) -> tuple[float, float]:
    """Derivatives of the energy along a field: the first over sqrt(2 energy area), the second over the area."""
    step = 1e-4
    (low, _), (here, area), (high, _) = (
        measured(made, lambda points, e=e: points + e * way(points)) for e in (-step, 0.0, step)
    )
    return (high - low) / (2.0 * step) / (2.0 * here * area) ** 0.5, (high - 2.0 * here + low) / step**2 / area


@pytest.mark.parametrize("name", HARD)
def test_hard_strips_are_at_rest_and_any_displacement_strains_them_more(name: str) -> None:
    made = relaxed(HARD[name], accuracy=1e-5)
    extent = size(flat(made.development))
    assert made.reached <= 1e-5
    assert 0.0 < made.energy < made.energy_along_rulings
    energy, _ = measured(made.development, lambda points: points)
    assert_relative(energy, made.energy, bound=1e-6, why="another quadrature, derivatives of positions")
    for field, way in fields(extent).items():
        slope, rise = slope_and_rise(made.development, extent, way)
        # of a map that is not at rest it is about 1: see the next test
        assert abs(slope) < 1e-3, field
        assert rise > 0.1, field


def test_the_map_along_the_rulings_is_seen_not_to_be_at_rest() -> None:
    strip = saddle(10.0)
    along = develop(strip)
    slope, _ = slope_and_rise(along, 2.8, fields(2.8)["larger"])
    assert slope < -0.5


def test_one_coefficient_changed_is_seen() -> None:
    made = relaxed(saddle(10.0), accuracy=1e-5)
    (piece,) = made.development.pieces
    assert isinstance(piece, RelaxedMap)
    series = piece.series.copy()
    bent = np.unravel_index(np.argmax(np.abs(series[0, 1:, 2:])), series[0, 1:, 2:].shape)
    series[0, 1 + bent[0], 2 + bent[1], bent[2]] *= 1.01
    worse, _ = measured(Development((piece.replace(series=series),)), lambda points: points)
    assert worse > made.energy * (1.0 + 1e-6)


# Frame, derivatives, joins


@pytest.mark.parametrize("name", HARD)
def test_the_first_ruling_points_along_x_or_else_the_last_one(name: str) -> None:
    pieces = relaxed(HARD[name], accuracy=1e-4).development.pieces
    start = pieces[0].positions(np.array([0.0, 1.0]), np.zeros(2))
    end = pieces[-1].positions(np.array([0.0, 1.0]), np.ones(2))
    extent = 1e-15 * max(1.0, float(norm(end).max()))
    assert_near(start[0], [0.0, 0.0], bound=4 * extent, why="the origin")
    ruling = next((r for r in (start[1] - start[0], end[1] - end[0]) if norm(r) > 1e-9), np.zeros(2))
    assert_near(ruling[1], 0.0, bound=16 * extent, why="along x")
    assert ruling[0] >= 0.0
    middle = pieces[0].positions(np.array([0.0, 1.0, 0.5, 0.5]), np.array([0.5, 0.5, 0.49, 0.51]))
    across, onwards = middle[1] - middle[0], middle[3] - middle[2]
    assert across[0] * onwards[1] - across[1] * onwards[0] > 0.0


@pytest.mark.parametrize("name", ["pointed end", "cone before a warped patch", "Example 2 as printed"])
def test_velocities_and_chords_are_those_of_the_positions(name: str) -> None:
    for piece in relaxed(HARD[name], accuracy=1e-4).development.pieces:
        u, v, step = np.tile([0.0, 0.4, 1.0], 3), np.repeat([0.11, 0.52, 0.9], 3), 1e-5
        quotient = (piece.positions(u, v + step) - piece.positions(u, v - step)) / (2.0 * step)
        found = piece.velocities(u, v)
        extent = float(norm(found).max())
        assert_near(found, quotient, bound=extent * (100 * step**2 + 1e-15 / step), why="a central difference")
        index = np.searchsorted(piece.breaks, v, side="right") - 1
        low = piece.breaks[index]
        chords = piece.chords(1.0 - u, low, u, v)
        expected = piece.positions(u, v) - piece.positions(1.0 - u, low)
        assert_near(chords, expected, bound=1e-14 * extent, why="a difference of positions")


@pytest.mark.parametrize(
    "name", ["cone before a warped patch", "two patches that share a point", "corners into the pattern"]
)
def test_pieces_meet_where_they_join(name: str) -> None:
    one, two = relaxed(HARD[name], accuracy=1e-4).development.pieces
    u = np.linspace(0.0, 1.0, 7)
    ends = one.positions(u, np.ones(7)), two.positions(u, np.zeros(7))
    assert_near(ends[0], ends[1], bound=1e-14, why="one column of nodes, to rounding")


def test_an_apex_stays_one_point() -> None:
    cone, _ = relaxed(HARD["cone before a warped patch"], accuracy=1e-4).development.pieces
    points = cone.positions(np.zeros(9), np.linspace(0.0, 1.0, 9))
    assert_near(points, np.zeros((9, 2)), bound=1e-15, why="c0 is the apex, at the origin")


def test_warp_in_one_patch_strains_the_other_near_their_join_only_little() -> None:
    cone, warped = relaxed(CONE_AND_WARPED, accuracy=1e-6).development.pieces
    u, v = (axis.ravel() for axis in np.meshgrid(np.linspace(0.5, 1.0, 6), np.linspace(0.0, 1.0, 11)))
    assert isinstance(cone, RelaxedMap)
    assert isinstance(warped, RelaxedMap)
    far, near = (np.abs(principal(cone, u[here], v[here])).max() for here in (v < 0.3, v > 0.9))
    assert 0.0 < far < near < np.abs(principal(warped, u, v)).max()
