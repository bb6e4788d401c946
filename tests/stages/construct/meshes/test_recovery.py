"""Meshes recovered as plates, cylinders and cones, with any outline, and unrolled exactly."""

from collections.abc import Callable

import numpy as np
import pytest

from stages.construct.meshes.recovery import Recovery, recovered
from stages.geometry.curves import contours
from stages.geometry.mesh.mesh import Mesh
from stages.model.pattern import FlatPattern
from stages.model.surface import Plate, RuledSurface
from stages.unroll import unroll
from stages.verify import verify
from tests.meshes import cylinder, right_cone
from tests.meshregions import (
    Lift,
    OnCone,
    OnCylinder,
    flipped,
    in_float32,
    loops_of,
    moved,
    on_plane,
    polygon,
    region,
    ring,
)
from tests.near import assert_near, assert_relative
from tests.parts import DEFAULT, RIGHT_FRUSTUM, part

PART = part(RIGHT_FRUSTUM)
CORNERS = ((30.0, -30.0), (110.0, -30.0), (110.0, 10.0), (60.0, 30.0), (30.0, 30.0))
AREA = 80.0 * 60.0 - 0.5 * 50.0 * 20.0
HOLE = ring(60.0, 0.0, 12.0, 60)
PLATE_WITH_HOLE = AREA - np.pi * 12.0**2
ROUNDING = 1e-11
"""Of areas, relatively: flat points of a part 1000 mm from the origin are good to 1e-13 mm and more."""
KEPT = {"as it is": lambda mesh: mesh, "flipped": flipped, "moved": moved}


def made(mesh: Mesh) -> Recovery:
    """Return the recovered surface."""
    found = recovered(PART, mesh, loops_of(mesh), DEFAULT)
    assert found is not None
    return found


def pattern_of(mesh: Mesh) -> FlatPattern:
    """Return the flat pattern of a mesh that is recovered."""
    certificate = verify(made(mesh).surface, DEFAULT).product
    assert certificate is not None
    pattern = unroll(certificate, DEFAULT).product
    assert pattern is not None
    return pattern


def area_of(pattern: FlatPattern) -> float:
    """Return the area of a pattern by its exact edges."""
    return sum(contours.area(contour.edges) for contour in (pattern.outer, *pattern.inner))


def trimmed_mesh(lift: Lift) -> Mesh:
    """Return a plate of five corners with a round hole, rolled up."""
    return region(polygon(CORNERS, 4.0), [HOLE], 5.0, lift)


@pytest.mark.parametrize("change", KEPT.values(), ids=KEPT)
@pytest.mark.parametrize("lift", [on_plane, OnCylinder(60.0), OnCone(0.6)], ids=["plane", "cylinder", "cone"])
def test_any_outline_with_a_hole_has_its_exact_area(lift: Lift, change: Callable[[Mesh], Mesh]) -> None:
    pattern = pattern_of(change(trimmed_mesh(lift)))
    assert_relative(area_of(pattern), PLATE_WITH_HOLE, bound=ROUNDING, why="lines and a circle are found as such")
    assert pattern.outer.path.bulges.size == len(CORNERS)
    assert np.all(pattern.outer.path.bulges == 0.0) or isinstance(made(trimmed_mesh(lift)).surface, RuledSurface)


@pytest.mark.parametrize("change", KEPT.values(), ids=KEPT)
def test_the_mesh_s_outside_is_the_side_seen(change: Callable[[Mesh], Mesh]) -> None:
    mesh = change(trimmed_mesh(OnCylinder(60.0)))
    pattern = pattern_of(mesh)
    # the outline turns left at its corners, and the cut-off corner shows whether it is mirrored
    lengths = np.hypot(*np.diff(pattern.outer.path.vertices, axis=0, append=pattern.outer.path.vertices[:1]).T)
    wanted = np.hypot(*np.diff(np.array(CORNERS), axis=0, append=np.array(CORNERS[:1])).T)
    wanted = wanted[::-1] if change is flipped else wanted
    turned = min(float(np.abs(np.roll(lengths, k) - wanted).max()) for k in range(len(wanted)))
    assert_near(turned, 0.0, bound=1e-9, why="the same sides in the same order")


@pytest.mark.parametrize("change", KEPT.values(), ids=KEPT)
def test_a_patch_that_fills_its_range_needs_no_trim(change: Callable[[Mesh], Mesh]) -> None:
    found = made(change(right_cone(0, 60, 16).mesh)).surface
    assert isinstance(found, RuledSurface)
    assert found.trim is None
    pattern = pattern_of(change(right_cone(0, 60, 16).mesh))
    assert_relative(area_of(pattern), 0.5 * 3.0 * 3.0 * 1e4, bound=ROUNDING, why="a ring sector")


def test_a_sector_with_its_apex_on_the_outline() -> None:
    arc = np.linspace(-0.7, 0.7, 90)
    start, end = 100.0 * np.array([np.cos(-0.7), np.sin(-0.7)]), 100.0 * np.array([np.cos(0.7), np.sin(0.7)])
    share = np.linspace(0.0, 1.0, 40, endpoint=False)[:, None]
    sides = [share * start, 100.0 * np.column_stack([np.cos(arc), np.sin(arc)])[:-1], (1.0 - share) * end]
    outer = np.vstack(sides)
    whole = region(outer, [], 5.0, OnCone(0.6))
    holed = region(outer, [ring(60.0, 3.0, 8.0, 40)], 5.0, OnCone(0.6))
    for mesh, area in ((whole, 7000.0), (holed, 7000.0 - 64.0 * np.pi)):
        # the arc may be refitted by a spline through its points 1.6 mm apart: (1.6 / 100)^4 / 384 of 100 mm
        assert_relative(area_of(pattern_of(moved(mesh))), area, bound=1e-8, why="splines through points of the arc")


def test_a_tube_that_is_cut_open_has_all_of_its_turn() -> None:
    count = 72
    turn = 2.0 * np.pi * np.arange(count + 1) / count
    rows = [np.column_stack([20.0 * np.cos(turn), 20.0 * np.sin(turn), np.full(count + 1, z)]) for z in (0.0, 50.0)]
    faces = [[i, i + 1, count + 2 + i] for i in range(count)] + [
        [i, count + 2 + i, count + 1 + i] for i in range(count)
    ]
    pattern = pattern_of(moved(Mesh(np.vstack(rows), np.array(faces))))
    assert_relative(area_of(pattern), 2.0 * np.pi * 20.0 * 50.0, bound=ROUNDING, why="a rectangle")


def test_float32_leaves_what_it_rounds() -> None:
    mesh = in_float32(moved(trimmed_mesh(OnCylinder(60.0))))
    found = made(mesh)
    (deviation, _) = found.metrics
    assert float(deviation.value or 0.0) <= 2.0**-14 * np.sqrt(3.0)
    # 3e-5 mm along an outline of 280 mm
    assert_near(area_of(pattern_of(mesh)), PLATE_WITH_HOLE, bound=280.0 * 6e-5, why="rounding along the outline")


def test_parameters_and_deviation_are_reported() -> None:
    found = made(moved(cylinder(0, 60, 16).mesh))
    said = found.detail["recognised"]
    assert isinstance(said, dict)
    assert said["kind"] == "cylinder"
    assert_near(said["radius_mm"], 100.0, bound=1e-9, why="rounding of 1000 mm")
    assert [metric.name for metric in found.metrics] == ["fit_deviation_mm", "fit_rms_mm"]
    cone = made(right_cone(0, 60, 16).mesh).detail["recognised"]
    assert isinstance(cone, dict)
    assert_near(cone["half_angle_deg"], np.degrees(np.arcsin(0.7)), bound=1e-9, why="rounding")
    assert_near(cone["apex"], np.zeros(3), bound=1e-9, why="rounding of 200 mm")


def test_a_plate_keeps_the_coordinates_of_its_file() -> None:
    found = made(trimmed_mesh(on_plane))
    assert isinstance(found.surface, Plate)
    assert found.frame is not None
    assert_near(found.frame, [[0, 0, 0], [1, 0, 0], [0, 1, 0]], bound=1e-14, why="the plane z = 0 seen from above")
    points = np.concatenate([edge.at(np.zeros(1)) for edge in found.surface.outline])
    assert_near(np.sort(points[:, 0]), np.sort(np.array(CORNERS)[:, 0]), bound=1e-12, why="corners as typed")


def test_what_is_no_such_surface_is_left_to_others() -> None:
    mesh = cylinder(0, 60, 16).mesh
    dented = Mesh(mesh.vertices * (1.0 + 1e-3 * np.sin(np.pi * mesh.vertices[:, 2:] / 50.0)), mesh.faces)
    assert recovered(PART, dented, loops_of(dented), DEFAULT) is None
