"""Planes, cylinders and cones recognised by their vertices, and near misses that are not."""

import numpy as np
import pytest

from stages.geometry.arrays import Array
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.primitives import Plane, Rotational, distances
from stages.geometry.mesh.recognise import Recognised, recognised, rounding
from tests.meshes import cylinder, jittered, right_cone
from tests.meshregions import OnCylinder, flipped, in_float32, moved, on_plane, polygon, region, ring
from tests.near import assert_near, assert_relative

CHORD = 0.02
GRID = (60, 16)
RECTANGLE = ((0.0, 0.0), (80.0, 0.0), (80.0, 50.0), (0.0, 50.0))


def found(mesh: Mesh) -> Recognised | None:
    """Return what a mesh is recognised as."""
    return recognised(mesh, chord_mm=CHORD)


def rotational(mesh: Mesh) -> Rotational:
    """Return the cylinder or cone that a mesh is recognised as."""
    one = found(mesh)
    assert one is not None
    assert isinstance(one.primitive, Rotational)
    return one.primitive


@pytest.mark.parametrize("change", [lambda m: m, moved, flipped])
@pytest.mark.parametrize("scale", [0.01, 1.0, 100.0])
def test_a_cylinder_is_recognised_to_rounding(change: object, scale: float) -> None:
    assert callable(change)
    mesh = change(cylinder(0, *GRID, scale=100.0 * scale).mesh)
    one = rotational(mesh)
    assert one.half_angle_rad == 0.0
    far = float(np.abs(mesh.vertices).max())
    assert_near(one.radius, 100.0 * scale, bound=1e-13 * far, why="some hundred roundings of the coordinates")


@pytest.mark.parametrize("change", [lambda m: m, moved, flipped])
def test_a_cone_is_recognised_to_rounding(change: object) -> None:
    assert callable(change)
    one = rotational(change(right_cone(0, *GRID).mesh))
    assert_near(np.sin(one.half_angle_rad), 0.7, bound=1e-12, why="some thousand roundings over the size")


def test_the_apex_is_found() -> None:
    apex = rotational(right_cone(0, *GRID).mesh).apex
    assert apex is not None
    assert_near(apex, np.zeros(3), bound=1e-10, why="some hundred roundings of 200 mm")


def test_float32_is_explained_by_its_rounding() -> None:
    mesh = in_float32(moved(right_cone(1, *GRID).mesh))
    one = found(mesh)
    assert one is not None
    # half a unit in the last place of 1000 to 2048, in three coordinates
    assert one.deviation.most_mm <= 2.0**-14 * np.sqrt(3.0)
    assert one.deviation.most_mm > 2.0**-17
    assert_near(np.sin(one.primitive.half_angle_rad), 0.7, bound=1e-6, why="rounding of 3e-5 mm over 100 mm")


@pytest.mark.parametrize("turn", [0.3, 0.03])
def test_slight_bends_are_cylinders_too(turn: float) -> None:
    v, u, faces = jittered(3, 60, 20)
    radius = 100.0 / turn
    mesh = Mesh(np.column_stack([radius * np.cos(turn * v), radius * np.sin(turn * v), 80.0 * u]), faces)
    # rounding of the sagitta c^2 / 8r, relatively, is that of the radius; averaged over the vertices
    assert_relative(rotational(mesh).radius, radius, bound=1e-14 * 8.0 / turn**2, why="sagitta")


def test_a_plane_needs_few_vertices() -> None:
    square = moved(region(polygon(RECTANGLE, 1000.0), [], 1000.0, on_plane))
    assert len(square.vertices) == 4
    one = found(square)
    assert one is not None
    assert isinstance(one.primitive, Plane)


def bent(change: object) -> Mesh:
    """Return the mesh of a cylinder of radius 100 about z, 50 high, with its vertices changed."""
    assert callable(change)
    mesh = cylinder(0, *GRID).mesh
    return Mesh(change(mesh.vertices.copy()), mesh.faces)


def flattened(x: Array) -> Array:
    """Make circles ellipses, flatter by a hundredth."""
    return x * np.array([0.99, 1.0, 1.0])


def hardly_flattened(x: Array) -> Array:
    """Make circles ellipses, flatter by a millionth: 0.1 um on 100 mm."""
    return x * np.array([1.0 - 1e-6, 1.0, 1.0])


def warped(x: Array) -> Array:
    """Shear the cylinder by half a degree, more with the height: no longer developable."""
    return x + np.radians(0.5) * np.column_stack([0.0 * x[:, 0], x[:, 0] / 100.0 * (x[:, 2] - 25.0), 0.0 * x[:, 0]])


def barrelled(x: Array) -> Array:
    """Give the straight lines the profile of a spline, 0.1 mm deep."""
    return x * (1.0 + 1e-3 * np.sin(np.pi * x[:, 2:] / 50.0) * np.array([1.0, 1.0, 0.0]))


@pytest.mark.parametrize("change", [flattened, hardly_flattened, warped, barrelled])
def test_near_misses_are_not_recognised(change: object) -> None:
    assert found(bent(change)) is None


def test_a_cone_of_a_hundredth_of_a_degree_is_no_cylinder() -> None:
    slope = np.tan(np.radians(0.01))
    one = rotational(bent(lambda x: x * np.where([1, 1, 0], 1.0 + slope * x[:, 2:] / 100.0, 1.0)))
    assert_relative(one.half_angle_rad, np.radians(0.01), bound=1e-9, why="rounding over 0.009 mm of taper")


def test_noise_is_explained_and_more_of_it_is_too_much() -> None:
    source = np.random.default_rng(0)
    noise = source.normal(0.0, 1.0, cylinder(0, *GRID).mesh.vertices.shape)
    one = found(bent(lambda x: x + 1e-4 * noise))
    assert one is not None
    assert one.deviation.most_mm > one.deviation.rounding_mm
    assert found(bent(lambda x: x + 1e-2 * noise)) is None


def test_a_prism_is_no_cylinder() -> None:
    turn = 2.0 * np.pi * np.arange(9) / 8.0
    rows = [np.column_stack([20.0 * np.cos(turn), 20.0 * np.sin(turn), np.full(9, z)]) for z in (0.0, 30.0, 60.0)]
    faces = [[9 * k + i, 9 * k + i + 1, 9 * k + i + 10] for k in range(2) for i in range(8)]
    faces += [[9 * k + i, 9 * k + i + 10, 9 * k + i + 9] for k in range(2) for i in range(8)]
    assert found(Mesh(np.vstack(rows), np.array(faces))) is None


def test_a_lid_is_no_part_of_the_cylinder() -> None:
    turn = 2.0 * np.pi * np.arange(36) / 36.0
    rows = [np.column_stack([20.0 * np.cos(turn), 20.0 * np.sin(turn), np.full(36, z)]) for z in (0.0, 3000.0)]
    walls = [[i, (i + 1) % 36, 36 + (i + 1) % 36] for i in range(36)]
    walls += [[i, 36 + (i + 1) % 36, 36 + i] for i in range(36)]
    lid = [[36, 36 + i, 37 + i] for i in range(1, 35)]
    open_tube = Mesh(np.vstack(rows), np.array(walls))
    assert found(open_tube) is not None
    assert found(Mesh(np.vstack(rows), np.array(walls + lid))) is None


def test_distances_are_signed_and_vanish_on_the_surface() -> None:
    cone = Rotational(np.array([0.0, 0.0, 10.0]), np.array([0.0, 0.0, 1.0]), 10.0, np.pi / 4.0)
    points = np.array([[10.0, 0.0, 10.0], [0.0, 20.0, 20.0], [12.0, 0.0, 10.0]])
    assert_near(distances(cone, points), [0.0, 0.0, np.sqrt(2.0)], bound=1e-14, why="rounding of 20")


@pytest.mark.parametrize(("kept", "expected"), [(0, 0.5), (3, 5e-4), (6, 5e-7)])
def test_decimals_of_a_text_file_are_found(kept: int, expected: float) -> None:
    points = np.round(np.random.default_rng(0).uniform(-900.0, 900.0, (50, 3)), kept)
    assert_relative(rounding(points), expected, bound=1e-9, why="half a unit of the last decimal")


def test_float32_in_inches_is_found() -> None:
    inches = np.random.default_rng(0).uniform(17.0, 31.0, (50, 3)).astype(np.float32).astype(np.float64)
    assert_relative(rounding(25.4 * inches), 25.4 * 2.0**-20, bound=1e-9, why="half the spacing from 16 to 32")


def test_numbers_in_full_are_rounded_as_doubles() -> None:
    assert rounding(np.random.default_rng(0).uniform(1.0, 2.0, (50, 3))) <= 2.0**-52


def test_holes_do_not_count() -> None:
    mesh = region(ring(0.0, 0.0, 40.0, 90), [ring(10.0, 5.0, 8.0, 30)], 4.0, OnCylinder(60.0))
    assert_relative(rotational(moved(mesh)).radius, 60.0, bound=1e-12, why="rounding of 1000 mm over 60")
