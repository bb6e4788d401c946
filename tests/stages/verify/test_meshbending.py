"""The sharpest bend of a mesh against closed forms: pipes and ellipses, of every face of the sheet."""

import numpy as np
import pytest

from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.topology import boundary_loops, edges_of
from stages.model.face import Face
from stages.model.material import Material, Part
from stages.model.meshes import MeshFile
from stages.model.part import PartSpec
from stages.model.surface import MeshSurface
from stages.verify.meshbending import mesh_bending
from stages.verify.meshstudy import study
from tests.meshes import jittered
from tests.near import assert_near, assert_relative

SHEET = Material(thickness_mm=4.0, bend_radius_min_mm=10.0, max_strain=0.2)


def half(a: float, b: float) -> Mesh:
    """Return half an elliptic pipe with half axes a and b, its normals outwards."""
    v, u, faces = jittered(2, 80, 20)
    turn = np.pi * v
    return Mesh(np.column_stack([a * np.cos(turn), 80.0 * u, b * np.sin(turn)]), faces[:, ::-1])


def bent(mesh: Mesh, face: Face = "middle", material: Material = SHEET) -> tuple[list[float | None], list[str]]:
    """Return inside radius and strain, and the codes of what the material says; fatal ones with an exclamation mark."""
    spec = PartSpec(name="part", surface=MeshFile(file="part.stl"), face=face)
    size = float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
    made = MeshSurface(Part(spec, material), mesh, boundary_loops(mesh, edges_of(mesh)), size)
    metrics, findings = mesh_bending(made, study(made))
    values = [None if metric.value is None else float(metric.value) for metric in metrics]
    return values, [finding.code + "!" * finding.fatal for finding in findings]


@pytest.mark.parametrize(("face", "inside", "middle"), [("outer", 96, 98), ("inner", 100, 102), ("middle", 98, 100)])
def test_half_a_pipe_has_the_radius_of_its_inside_face(face: Face, inside: float, middle: float) -> None:
    values, findings = bent(half(100.0, 100.0), face)
    assert_relative(
        [values[0] or 0, values[1] or 0], [inside, 2.0 / middle], bound=1e-3, why="quartics, one-sided at edges"
    )
    assert findings == []


def test_an_ellipse_is_sharpest_at_the_end_of_its_longer_axis() -> None:
    """R = b^2 / a at the ends of the half axis a, which here is at the middle of the mesh."""
    values, _ = bent(half(40.0, 60.0))
    assert_near(values[0] or 0.0, 40.0**2 / 60.0 - 2.0, bound=0.05, why="the nearest vertex, up to half an edge off")


@pytest.mark.parametrize(
    ("material", "said"),
    [
        (Material(thickness_mm=4.0, bend_radius_min_mm=99.0, max_strain=0.2), ["bend-radius!"]),
        (Material(thickness_mm=4.0, bend_radius_min_mm=10.0, max_strain=0.019), ["bend-strain!"]),
        (Material(), ["bending-not-checked"]),
    ],
)
def test_each_limit_of_the_material_is_held(material: Material, said: list[str]) -> None:
    assert bent(half(100.0, 100.0), material=material)[1] == said


def test_a_flat_mesh_bends_nowhere() -> None:
    v, u, faces = jittered(2, 40, 20)
    assert bent(Mesh(np.column_stack([100.0 * v, 40.0 * u, 0.0 * u]), faces)) == ([None, None], [])


def test_a_face_that_the_mesh_does_not_have_is_refused() -> None:
    v, u, faces = jittered(2, 80, 20)
    wave = Mesh(np.column_stack([100.0 * v, 40.0 * u, 5.0 * np.sin(2.0 * np.pi * v)]), faces)
    assert bent(wave, "outer") == ([None, None], ["face-changes-side!"])
