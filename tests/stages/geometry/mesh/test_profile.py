"""Meshes seen along their rulings: the direction, the order of the vertices, and what has neither."""

import numpy as np
import pytest

from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.profile import profiled
from tests.bentmeshes import Bend, Flat, Legs, divided, lifted, rectangle
from tests.meshes import KNOWN
from tests.meshregions import in_float32, moved
from tests.near import assert_near

LEGS: Legs = (Flat(40.0), Bend(3.0, 90.0), Flat(60.0), Bend(6.0, -120.0), Flat(30.0))


@pytest.mark.parametrize("single", [False, True])
def test_direction_and_order_are_those_of_the_profile(single: bool) -> None:
    flat, faces = divided(LEGS, rectangle(80.0, LEGS), 10.0)
    plain = Mesh(lifted(LEGS, flat), faces)
    mesh = in_float32(moved(plain)) if single else moved(plain)
    found = profiled(mesh)
    assert found is not None
    rulings = [mesh.vertices[np.argmin(np.hypot(flat[:, 0] - x, flat[:, 1] - 60.0))] for x in (0.0, 80.0)]
    way = (rulings[1] - rulings[0]) / np.linalg.norm(rulings[1] - rulings[0])
    assert_near(abs(float(way @ found.frame[2])), 1.0, bound=1e-11, why="1 - cos of 64 roundings of 1e-4 over 80 mm")
    run = flat[found.order, 1]
    run = run if run[0] < run[-1] else run[::-1]
    assert np.all(np.diff(run) >= -1e-9)


@pytest.mark.parametrize("name", ["right cone", "tangent surface", "oblique cone"])
def test_surfaces_without_flanges_have_no_profile(name: str) -> None:
    assert profiled(KNOWN[name](0, 40, 10).mesh) is None
