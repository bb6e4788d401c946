"""Meshes of thick sheet, given by any face: half pipes and cones whose flat patterns have closed forms."""

from dataclasses import replace

import numpy as np
import pytest

from stages.geometry.mesh.flat import flattened
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.topology import boundary_loops, edges_of
from stages.model.face import Face
from stages.model.kfactor import KFactor, Rule, k_at
from stages.model.material import Material, Part
from stages.model.meshes import MeshFile
from stages.model.part import PartSpec
from stages.model.surface import Certificate, MeshSurface, no_pairs
from stages.model.tolerances import Tolerances
from stages.unroll.meshes import flatten_mesh
from stages.unroll.meshneutral import NeutralMesh, mesh_neutral
from tests.meshes import jittered
from tests.near import assert_near, assert_relative

COLUMNS, ROWS = 90, 24
RADIUS, ANGLE, LENGTH, THICKNESS = 100.0, np.pi, 80.0, 4.0


def half_pipe(*, outwards: bool = True, wave: bool = False) -> Mesh:
    """Return half a pipe with its normals outwards, or inwards; or a full wave of it: two quarters, bent either way."""
    v, u, faces = jittered(3, COLUMNS, ROWS)
    turn = ANGLE * v
    x, z = RADIUS * np.cos(turn), RADIUS * np.sin(turn)
    if wave:
        back = turn > np.pi / 2.0
        x, z = np.where(back, -RADIUS * np.cos(turn), x), np.where(back, 2.0 * RADIUS - z, z)
        x = np.where(back, -x, x)
    faces = faces[:, ::-1] if outwards else faces
    return Mesh(np.column_stack([x, LENGTH * (u - 1.0), z]), faces)


def surface(mesh: Mesh, face: Face, rule: Rule = 0.5, thickness: float | None = THICKNESS) -> MeshSurface:
    """Return the part of one face of a sheet."""
    spec = PartSpec(name="part", surface=MeshFile(file="part.stl"), face=face)
    material = Material(thickness_mm=thickness, k_factor=KFactor(rule, given=True))
    size = float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
    return MeshSurface(Part(spec, material), mesh, boundary_loops(mesh, edges_of(mesh)), size)


def neutral(mesh: Mesh, face: Face, rule: Rule = 0.5, thickness: float | None = THICKNESS) -> NeutralMesh:
    made = surface(mesh, face, rule, thickness)
    return mesh_neutral(made, flattened(mesh, accuracy=1e-10 * made.size_mm))


def lengths(found: NeutralMesh) -> list[float]:
    """Return the sides of the flat rectangle between its corners: along the bend, and across."""
    flat = found.flat.positions
    count = found.surface.mesh.vertices.shape[0]
    return [float(np.linalg.norm(flat[0] - flat[other])) for other in (count - ROWS - 1, ROWS)]


def value(found: NeutralMesh, name: str) -> float:
    return float(next(metric.value for metric in found.metrics if metric.name == name) or 0.0)


@pytest.mark.parametrize("outwards", [True, False])
@pytest.mark.parametrize(
    ("face", "inside"), [("outer", RADIUS - THICKNESS), ("inner", RADIUS), ("middle", RADIUS - THICKNESS / 2.0)]
)
@pytest.mark.parametrize("rule", [0.5, 0.38, "din6935"])
def test_half_a_pipe_of_every_face_unrolls_to_its_neutral_arc(
    outwards: bool, face: Face, inside: float, rule: Rule
) -> None:
    """The angle times the inside radius plus K t; K by DIN 6935 at the inside radius."""
    found = neutral(half_pipe(outwards=outwards), face, rule)
    k = float(k_at(rule, np.array([inside / THICKNESS]))[0])
    arc, width = lengths(found)
    assert not found.findings
    assert_relative(arc, ANGLE * (inside + k * THICKNESS), bound=1e-7, why="normals to 1e-6 rad, 4 mm away")
    assert_near(width, LENGTH, bound=1e-5, why="across the bend nothing changes")


@pytest.mark.parametrize(("face", "away"), [("plus", -1.0), ("minus", 1.0)])
@pytest.mark.parametrize("outwards", [True, False])
def test_plus_is_the_side_of_the_normals(face: Face, away: float, outwards: bool) -> None:
    """The plus face of a mesh with its normals outwards is the outer one: the middle lies half a sheet inside."""
    found = neutral(half_pipe(outwards=outwards), face)
    radius = RADIUS + (away if outwards else -away) * THICKNESS / 2.0
    assert_relative(lengths(found)[0], ANGLE * radius, bound=1e-7, why="closed form")
    assert_near(value(found, "neutral_offset_mm"), away * THICKNESS / 2.0, bound=0.0, why="half the sheet, as given")


def test_inner_and_outer_of_one_sheet_give_one_pattern() -> None:
    """Two faces of one sheet, meshed alike: both lead to the neutral surface between them."""
    outer, inner = half_pipe(), half_pipe()
    inner = Mesh(inner.vertices * np.array([0.96, 1.0, 0.96]), inner.faces)
    sides = [lengths(neutral(mesh, face, 0.42)) for mesh, face in ((outer, "outer"), (inner, "inner"))]
    assert_relative(sides[0], sides[1], bound=4e-7, why="both within 2e-7 of the closed form")


def test_a_cone_given_by_its_outside_has_the_sector_of_its_middle() -> None:
    """Offset by d inwards a cone keeps its angle: slant heights grow by d tan, its sector by none."""
    v, u, faces = jittered(5, COLUMNS, ROWS)
    sine, half = 0.5, np.arcsin(0.5)
    turn, slant = 2.0 * v, 100.0 + 60.0 * u
    cone = Mesh(
        np.column_stack([sine * slant * np.cos(turn), sine * slant * np.sin(turn), -np.cos(half) * slant]),
        faces[:, ::-1],
    )
    found = neutral(cone, "outer")
    assert not found.findings
    # the flat sector spans 1 rad; the middle's slant runs from 100 to 160 less d tan(half) from its own apex
    low, high = 100.0 - 2.0 / np.tan(half), 160.0 - 2.0 / np.tan(half)
    flat, last = found.flat.positions, len(cone.vertices) - 1
    chords = [np.linalg.norm(flat[0] - flat[last - ROWS]), np.linalg.norm(flat[ROWS] - flat[last])]
    wanted = [2.0 * low * np.sin(0.5), 2.0 * high * np.sin(0.5)]
    assert_relative(chords, wanted, bound=1e-7, why="between corners of a sector of 1 rad")


def test_the_middle_of_rolled_work_and_sheet_of_no_known_thickness_are_unrolled_as_given() -> None:
    for found in (neutral(half_pipe(), "middle"), neutral(half_pipe(), "middle", 0.4, None)):
        assert found.metrics == () and found.findings == ()
        assert_relative(lengths(found)[0], ANGLE * RADIUS, bound=1e-8, why="the mesh itself")


def test_a_mesh_that_bends_both_ways_has_no_inner_face_and_says_where() -> None:
    found = neutral(half_pipe(wave=True), "inner")
    (finding,) = found.findings
    assert finding.code == "face-changes-side" and finding.fatal and {"x", "y", "z"} <= set(finding.where or {})


def test_a_mesh_that_bends_both_ways_takes_plus_and_says_what_k_neglects() -> None:
    found = neutral(half_pipe(wave=True), "plus", 0.4)
    (finding,) = found.findings
    assert finding.code == "k-neglected" and not finding.fatal
    assert_near(abs(value(found, "neutral_offset_mm")), 2.0, bound=0.0, why="the middle of the sheet")
    assert neutral(half_pipe(wave=True), "plus", 0.5).findings == ()


def test_a_sheet_too_thick_for_its_bend_is_refused() -> None:
    (finding,) = neutral(half_pipe(), "outer", 0.5, 220.0).findings
    assert finding.code == "offset-past-edge" and finding.fatal and "110 mm towards its centre" in finding.message


def test_edges_that_keep_their_lengths_forbid_another_surface() -> None:
    made = replace(surface(half_pipe(), "outer"), kept=np.array([[0, 1]]))
    found = mesh_neutral(made, flattened(made.mesh, accuracy=1e-8))
    assert [finding.code for finding in found.findings] == ["mesh-face"]
    assert no_pairs().shape == (0, 2)


def test_a_flat_mesh_is_the_same_on_any_face() -> None:
    v, u, faces = jittered(1, 40, 20)
    flat = Mesh(np.column_stack([100.0 * v, 50.0 * u, 0.0 * u]), faces)
    found = neutral(flat, "outer")
    assert value(found, "neutral_offset_mm") == 0.0 and found.flat.positions.shape == (len(flat.vertices), 2)


def test_the_pattern_is_that_of_the_neutral_surface() -> None:
    made = surface(half_pipe(), "outer", 0.4)
    flat = flattened(made.mesh, accuracy=1e-8)
    outcome = flatten_mesh(Certificate(made, "fabrication", proved=False, flat=flat), Tolerances())
    assert outcome.product is not None, outcome.report.findings
    wanted = ANGLE * (RADIUS - THICKNESS + 0.4 * THICKNESS) * LENGTH
    area = outcome.report.detail["flat"]["area"]  # type: ignore[index]
    assert_relative(area, wanted, bound=1e-5, why="arcs within the chord")
    assert outcome.report.metric("k_factor").evidence == "proved"
    assert float(outcome.report.metric("length_error").value or 0.0) < 1e-6, "against the neutral surface's own edges"
