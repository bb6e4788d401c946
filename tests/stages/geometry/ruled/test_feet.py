"""Feet of points: signed distances, and what lies beyond an edge."""

import numpy as np
import pytest

from stages.geometry.arrays import Array, cross3, norm
from stages.geometry.ruled.feet import exact_feet
from stages.geometry.ruled.strip import Strip, jet
from tests.near import assert_near
from tests.parts import OBLIQUE_CONE, RIGHT_FRUSTUM, patches

CONE = Strip(patches(OBLIQUE_CONE), np.arange(len(patches(OBLIQUE_CONE)) + 1.0))
FRUSTUM = Strip(patches(RIGHT_FRUSTUM), np.arange(len(patches(RIGHT_FRUSTUM)) + 1.0))


def probed(strip: Strip, off: Array, seed: int = 1) -> Array:
    """Return points at these distances from a strip, spread over it."""
    rng = np.random.default_rng(seed)
    v = rng.uniform(0.05, 0.95, off.size) * strip.knots[-1]
    found = jet(strip, rng.uniform(0.1, 0.9, off.size), v)
    normal = cross3(found.s_u, found.s_v)
    points: Array = found.s + normal / norm(normal)[:, None] * off[:, None]
    return points


@pytest.mark.parametrize("strip", [CONE, FRUSTUM])
def test_distances_are_signed_along_the_normal(strip: Strip) -> None:
    off = np.linspace(-0.5, 0.5, 12)
    found = exact_feet(strip, probed(strip, off))
    assert_near(found.distance_mm, off, bound=1e-11, why="rounding of places on a part of some mm")
    assert not found.beyond.any()


def test_a_point_beyond_an_edge_counts_with_its_whole_distance() -> None:
    end = jet(CONE, np.array([1.0]), np.array([0.5]))
    away = end.s + end.s_u / norm(end.s_u)[:, None] * 2.0
    found = exact_feet(CONE, away)
    assert found.beyond.all()
    assert abs(found.distance_mm[0]) <= 2.0 + 1e-12
    assert_near(norm(away - found.at), np.abs(found.distance_mm), bound=1e-12, why="the same distance")
