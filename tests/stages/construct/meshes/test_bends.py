"""Meshes of bent sheet: flat lengths by K, outlines across bends, folds, and what is no bend."""

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
import pytest
import shapely

from stages.construct.meshes.bends import BentSheet, bent_sheet, laid_out, strip
from stages.construct.meshes.recovery import recovered
from stages.geometry.curves import contours
from stages.geometry.curves.plane import CircularArc
from stages.geometry.curves.refit import refitted
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.profilechain import Leg
from stages.geometry.ruled.strip import Strip, points
from stages.model.kfactor import KFactor
from stages.model.material import Material
from stages.model.pattern import FlatPattern
from stages.model.surface import RuledSurface
from stages.unroll import unroll
from stages.verify import verify
from tests.bentmeshes import Bend, Flat, Legs, bent, lifted, rectangle, run_length
from tests.meshregions import flipped, in_float32, loops_of, moved
from tests.near import assert_near, assert_relative
from tests.parts import DEFAULT, RIGHT_FRUSTUM, part

PART = part(RIGHT_FRUSTUM)
CHANNEL: Legs = (Flat(40.0), Bend(3.0, 90.0), Flat(60.0), Bend(3.0, 90.0), Flat(40.0))
HAT: Legs = (Flat(20.0), Bend(2.0, -80.0), Flat(30.0), Bend(4.0, 80.0), Flat(15.0), Bend(5.0, 90.0))
JOGGLE: Legs = (Flat(30.0), Bend(6.0, 90.0), Bend(9.0, -90.0), Flat(25.0))
HEM: Legs = (Flat(50.0), Bend(4.0, 180.0), Flat(30.0))
WIDTH = 100.0
EXACT = 1e-12
"""Of lengths and areas, relatively, from meshes that keep all digits."""


def found(mesh: Mesh) -> BentSheet:
    """Return the bent sheet that a mesh was made from."""
    made = bent_sheet(PART, mesh, loops_of(mesh), DEFAULT)
    assert made is not None
    return made


def flattened(surface: RuledSurface) -> FlatPattern:
    """Return the pattern of a strip that is proved to be developable."""
    certificate = verify(surface, DEFAULT)
    assert certificate.product is not None
    assert certificate.product.proved
    pattern = unroll(certificate.product, DEFAULT).product
    assert pattern is not None
    return pattern


def area_of(pattern: FlatPattern) -> float:
    """Return the area of a pattern by its exact edges."""
    return sum(contours.area(contour.edges) for contour in (pattern.outer, *pattern.inner))


def extent(pattern: FlatPattern) -> tuple[float, float]:
    """Return length and width of a pattern, the longer one first."""
    x, y = np.ptp(pattern.outer.path.vertices, axis=0)
    return max(x, y), min(x, y)


def numbers_of(legs: Sequence[Leg]) -> list[tuple[float, float]]:
    """Return lengths and angles from the longer end on, the first bend to the left: a mesh may be run either way."""
    rows = [(leg.length_mm, leg.turn_rad) for leg in (legs if legs[0].length_mm >= legs[-1].length_mm else legs[::-1])]
    side = next(float(np.sign(turn)) for _, turn in rows if turn != 0.0)
    return [(length, side * turn) for length, turn in rows]


@pytest.mark.parametrize("step", [5.0, 15.0, 30.0])
@pytest.mark.parametrize("legs", [CHANNEL, HAT, JOGGLE, HEM], ids=["channel", "hat", "joggle", "hem"])
def test_every_leg_is_found_with_its_numbers(legs: Legs, step: float) -> None:
    laid = laid_out(moved(bent(legs, rectangle(WIDTH, legs), step)), DEFAULT)
    assert laid is not None
    wanted = [Leg(leg.length, np.radians(leg.angle_deg) if isinstance(leg, Bend) else 0.0) for leg in legs]
    measured, exact = (numbers_of(rows) for rows in (laid.chain.legs, wanted))
    assert_near(measured, exact, bound=1e-8, why="1000 mm from the origin: 1e-13 of 0.1 mm steps")


def test_the_strip_passes_through_the_vertices_where_the_chart_says() -> None:
    mesh = moved(bent(HAT, rectangle(WIDTH, HAT), 15.0))
    laid = laid_out(mesh, DEFAULT)
    assert laid is not None
    chart, patches, breaks = strip(laid, (laid.flat.min(axis=0), laid.flat.max(axis=0)))
    place = chart.places(laid.flat)
    on = points(Strip(patches, np.arange(len(patches) + 1.0)), place[:, 0], place[:, 1])
    assert_near(on, mesh.vertices, bound=1e-9, why="coordinates of 1000 mm, bends by 30 deg: some 1000 roundings")
    assert len(breaks) == len(HAT) - 1


@pytest.mark.parametrize("face", ["middle", "inner", "outer"])
def test_a_channel_takes_the_length_of_its_neutral_surface(face: str) -> None:
    t, k = 2.0, 0.4
    steel = Material("steel", t, k_factor=KFactor(k, given=True))
    mesh = bent(CHANNEL, rectangle(WIDTH, CHANNEL), 15.0)
    made = bent_sheet(part(RIGHT_FRUSTUM, steel, face=face), mesh, loops_of(mesh), DEFAULT)
    assert made is not None
    inside = 3.0 - {"middle": t / 2.0, "inner": 0.0, "outer": t}[face]
    wanted = 140.0 + np.pi * (inside + k * t), WIDTH
    assert_near(extent(flattened(made.surface)), wanted, bound=1e-9, why="flanges and two quarter turns at r + K t")


@pytest.mark.parametrize("scale", [0.01, 1.0, 70.0])
def test_what_float32_leaves_is_explained_at_any_size(scale: float) -> None:
    legs = [Flat(leg.length * scale) if isinstance(leg, Flat) else Bend(3.0 * scale, 90.0) for leg in ANGLE]
    exact = bent(legs, rectangle(WIDTH * scale, legs), 15.0)
    mesh = in_float32(Mesh(exact.vertices + 200.0 * scale, exact.faces))
    made = found(mesh)
    spacing = float(np.spacing(np.float32(300.0 * scale)))
    assert made.deviation.most_mm <= spacing
    wanted = WIDTH * scale, run_length(legs)
    assert_near(extent(flattened(made.surface)), wanted, bound=6 * spacing, why="three legs, two ends each")


def test_small_bends_of_a_long_channel_are_found_in_float32() -> None:
    legs = [Flat(2000.0), Bend(3.0, 90.0), Flat(6000.0), Bend(3.0, 90.0), Flat(2000.0)]
    mesh = in_float32(moved(bent(legs, rectangle(8000.0, legs), 15.0)))
    spacing = float(np.spacing(np.float32(8192.0)))
    assert_near(extent(flattened(found(mesh).surface)), [run_length(legs), 8000.0], bound=8 * spacing, why="as above")


ANGLE: Legs = (Flat(30.0), Bend(3.0, 90.0), Flat(30.0))
SLOTTED = rectangle(WIDTH, ANGLE).difference(shapely.box(40.0, 20.0, 55.0, 45.0))
"""A slot across the bend."""


@pytest.mark.parametrize(("change", "bound"), [(flipped, 1e-11), (lambda m: in_float32(moved(m)), 1e-5)])
def test_a_slot_across_a_bend_is_a_trim(change: Callable[[Mesh], Mesh], bound: float) -> None:
    pattern = flattened(found(change(bent(ANGLE, SLOTTED, 30.0))).surface)
    assert len(pattern.inner) == 1
    assert_relative(area_of(pattern), SLOTTED.area, bound=bound, why="straight edges; float32 at 1000 mm: 6e-5 mm")


def test_a_cut_out_of_the_outline_across_a_bend_is_a_trim() -> None:
    region = rectangle(WIDTH, ANGLE).difference(shapely.box(-1.0, 20.0, 15.0, 45.0))
    pattern = flattened(found(moved(bent(ANGLE, region, 15.0))).surface)
    assert not pattern.inner
    assert_relative(area_of(pattern), region.area, bound=1e-11, why="straight edges")


def test_a_round_hole_in_a_flange_is_a_circle_and_one_across_a_bend_keeps_its_points() -> None:
    circles = [shapely.Point(30, 15).buffer(8, 32), shapely.Point(70, 32.35).buffer(9, 32)]
    region = rectangle(WIDTH, ANGLE).difference(shapely.union_all(circles))
    mesh = moved(bent(ANGLE, region, 15.0))
    laid = laid_out(mesh, DEFAULT)
    assert laid is not None
    holes = [refitted(laid.flat[loop], accuracy=laid.near_mm).edges for loop in loops_of(mesh)[1:]]
    areas = sorted(-contours.area(hole) for hole in holes)
    # the second one has points also where the bands cut its chords: they lie off the circle by up to its sagitta
    chords = 0.5 * 128 * np.sin(2.0 * np.pi / 128) * 81.0
    assert_relative(areas[0], np.pi * 64.0, bound=1e-9, why="one circle")
    assert isinstance(holes[0][0], CircularArc) or isinstance(holes[1][0], CircularArc)
    assert chords * (1 - 1e-4) <= areas[1] <= np.pi * 81.0


def test_bends_with_slanting_facets_are_found_by_their_vertices() -> None:
    # triangles of three different angles on each bend, as meshers leave them beside a hole
    laid = laid_out(moved(_slanting(CHANNEL)), DEFAULT)
    assert laid is not None
    assert_near([leg.length_mm for leg in laid.chain.legs], [leg.length for leg in CHANNEL], bound=1e-8, why="chain")


def _slanting(legs: Legs) -> Mesh:
    """Return the strip of two columns whose places on the bends differ."""
    columns = []
    for shift in (0.0, 0.5, 0.0):
        places, far = [0.0], 0.0
        for leg in legs:
            inner = (np.arange(1, 7) - shift) / 6.0 if isinstance(leg, Bend) else np.array([])
            places += [*(far + leg.length * inner[inner < 1.0 - 1e-9]), far + leg.length]
            far += leg.length
        columns.append(np.array(places))
    xs = [np.full(len(column), 50.0 * i) for i, column in enumerate(columns)]
    flat = np.concatenate([np.column_stack(pair) for pair in zip(xs, columns, strict=True)])
    faces, first = [], 0
    for a, b in pairwise(columns):
        i, j, second = 0, 0, first + len(a)
        while i < len(a) - 1 or j < len(b) - 1:
            # to the side whose next place is nearer, so that no triangle spans a leg
            if j == len(b) - 1 or (i < len(a) - 1 and a[i + 1] <= b[j + 1]):
                faces.append([first + i, second + j, first + i + 1])
                i += 1
            else:
                faces.append([first + i, second + j, second + j + 1])
                j += 1
        first = second
    return Mesh(lifted(legs, flat), np.array(faces, dtype=np.int64))


@pytest.mark.parametrize("beyond", [-0.02, 0.02])
def test_a_hole_that_ends_within_rounding_of_the_edge_of_a_bend_is_no_fold(beyond: float) -> None:
    # 0.02 mm beyond the tangent the bend and the flange are 0.02^2 / 2 R = 2e-5 mm apart, the rounding is 6e-5 mm
    legs = (Flat(60.0), Bend(8.0, 26.0), Flat(90.0))
    corners = [(40.0, 60.0 + beyond), (30.0, 20.0), (60.0, 20.0)]
    mesh = in_float32(moved(bent(legs, rectangle(WIDTH, legs).difference(shapely.Polygon(corners)), 13.0)))
    laid = laid_out(mesh, DEFAULT)
    assert laid is not None
    spacing = float(np.spacing(np.float32(1100.0)))
    assert len(laid.chain.legs) == len(legs)
    assert_near(sum(leg.length_mm for leg in laid.chain.legs), run_length(legs), bound=4 * spacing, why="two ends")


# Folds and bend lines


def test_sharp_folds_are_bend_lines_and_are_told() -> None:
    legs = (Flat(40.0), Flat(60.0, 90.0), Flat(30.0, -25.0))
    mesh = moved(bent(legs, rectangle(WIDTH, legs), 15.0))
    made = recovered(PART, mesh, loops_of(mesh), DEFAULT)
    assert made is not None
    assert isinstance(made.surface, RuledSurface)
    assert [finding.code for finding in made.findings] == ["fold"]
    assert "90" in made.findings[0].message
    assert "25" in made.findings[0].message
    pattern = flattened(made.surface)
    assert_near(extent(pattern), [130.0, WIDTH], bound=1e-9, why="three flanges")
    assert sorted(mark.layer for mark in pattern.marks) == ["BEND_DOWN", "BEND_UP"]


@pytest.mark.parametrize(("change", "layer"), [(moved, "BEND_UP"), (lambda m: flipped(moved(m)), "BEND_DOWN")])
def test_bends_are_marked_where_they_begin_and_end(change: Callable[[Mesh], Mesh], layer: str) -> None:
    pattern = flattened(found(change(bent(CHANNEL, rectangle(WIDTH, CHANNEL), 15.0))).surface)
    marks = [mark for mark in pattern.marks if mark.name.startswith("tangency")]
    assert [mark.layer for mark in marks] == [layer] * 4
    assert not [mark for mark in pattern.marks if mark.name.startswith("fold")]


def test_a_chamfer_is_two_folds_and_no_bend() -> None:
    legs = (Flat(40.0), Flat(5.0, 30.0), Flat(40.0, 30.0))
    made = found(bent(legs, rectangle(WIDTH, legs), 15.0))
    assert [metric.value for metric in made.metrics[:2]] == [0.0, 2.0]


# Near misses


@pytest.mark.parametrize("stretch", [1.2, 1.0005])
@pytest.mark.parametrize("step", [5.0, 15.0])
def test_an_elliptic_bend_is_no_cylinder(stretch: float, step: float) -> None:
    mesh = bent(CHANNEL, rectangle(WIDTH, CHANNEL), step)
    for change in (moved, in_float32):
        assert laid_out(change(Mesh(mesh.vertices * np.array([stretch, 1.0, 1.0]), mesh.faces)), DEFAULT) is None


def test_a_bend_with_slightly_conical_facets_is_no_cylinder() -> None:
    mesh = in_float32(bent(CHANNEL, rectangle(WIDTH, CHANNEL), 15.0))
    x, y, z = mesh.vertices.T
    inside = (x > 40.1) & (y < 2.9)
    assert inside.any()
    offset = np.column_stack([x - 40.0, y - 3.0, 0.0 * z])
    wider = 1e-3 * inside * (z / WIDTH)
    assert laid_out(mesh, DEFAULT) is not None
    assert laid_out(in_float32(Mesh(mesh.vertices + wider[:, None] * offset, mesh.faces)), DEFAULT) is None


def test_a_vertex_off_its_bend_is_seen() -> None:
    mesh = in_float32(bent(CHANNEL, rectangle(WIDTH, CHANNEL), 15.0))
    for vertex in range(len(mesh.vertices)):
        off = mesh.vertices.copy()
        off[vertex] += np.array([1e-3, -1e-3, 0.0])
        assert laid_out(Mesh(off, mesh.faces), DEFAULT) is None


def test_a_facet_that_cuts_a_corner_is_no_flange() -> None:
    legs = (Flat(40.0), Flat(40.0, 60.0))
    exact = bent(legs, rectangle(WIDTH, legs), 15.0)
    # the square over the fold, divided by the diagonal from flange to flange: its own corner is missing
    corners = np.array([[0.0, 0.0], [WIDTH, 0.0], [WIDTH, 40.0], [WIDTH, 80.0], [0.0, 80.0], [0.0, 40.0]])
    cut = Mesh(lifted(legs, corners), np.array([[0, 1, 2], [0, 2, 4], [2, 3, 4], [0, 4, 5]]))
    assert laid_out(exact, DEFAULT) is not None
    assert laid_out(cut, DEFAULT) is None


def test_a_tray_with_bends_both_ways_is_no_strip() -> None:
    mesh = bent((Flat(40.0), Bend(3.0, 90.0), Flat(20.0)), shapely.box(0.0, 0.0, 60.0, 64.71238898038469), 15.0)
    x, y, z = mesh.vertices.T
    flap = Mesh(np.array([[0.0, 0.0, 0.0], [40.0, 0.0, 0.0], [0.0, 30.0, -9.0], [40.0, 30.0, -9.0]]),
                np.array([[0, 2, 1], [1, 2, 3]]))  # fmt: skip
    at = [int(np.argmin(np.hypot(x - a, y) + np.abs(z))) for a in (0.0, 40.0)]
    numbers = np.array([*at, len(x), len(x) + 1])
    tray = Mesh(np.vstack([mesh.vertices, flap.vertices[2:]]), np.vstack([mesh.faces, numbers[flap.faces]]))
    assert laid_out(mesh, DEFAULT) is not None
    assert laid_out(tray, DEFAULT) is None
