"""Sheets that a file holds with their thickness: one skin is kept, at the right distance, or why not."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import shapely

from stages.construct.meshes.solid import Skin, thin_solid
from stages.construct.meshes.surface import mesh_surface
from stages.geometry.mesh.cut import area
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.topology import edges_of
from stages.model.kfactor import KFactor
from stages.model.material import Material, Part
from stages.model.meshes import MeshFile
from stages.model.report import Outcome
from stages.model.surface import RuledSurface, Surface
from stages.unroll import unroll
from stages.verify import verify
from tests.bentmeshes import Bend, Flat, Legs, bent, rectangle, run_length, solid
from tests.meshregions import flipped, in_float32, moved
from tests.near import assert_near, assert_relative
from tests.parts import DEFAULT, Table, part

CHANNEL: Legs = (Flat(40.0), Bend(3.0, -90.0), Flat(60.0), Bend(3.0, -90.0), Flat(40.0))
"""Its outside, on the left, is the outer side of both bends: the radius of the skin is 3, of the other one 3 - t."""
JOGGLE: Legs = (Flat(30.0), Bend(6.0, 90.0), Flat(10.0), Bend(9.0, -90.0), Flat(25.0))
WIDTH, T, K = 100.0, 1.5, 0.4
TABLE: Table = {"kind": "mesh", "file": "part.stl"}


def steel(thickness: float | None = T) -> Material:
    """Return steel, or what nothing is known of but K."""
    return Material("steel", thickness, k_factor=KFactor(K, given=True))


def with_body(mesh: Mesh, material: Material, face: str = "middle") -> Part:
    """Return the part that a mesh describes."""
    return replace(part(TABLE, material, face=face), body=mesh)


def channel(step: float = 15.0) -> Mesh:
    """Return the channel with its thickness."""
    return solid(CHANNEL, rectangle(WIDTH, CHANNEL), step, T)


def skin_of(mesh: Mesh, material: Material | None = None, face: str = "middle") -> Skin:
    """Return the skin of a solid."""
    found = thin_solid(with_body(mesh, material or steel(), face), mesh, DEFAULT)
    assert found is not None
    return found


def surface_of(mesh: Mesh, material: Material) -> Outcome[Surface | None]:
    """Return what construct makes of a mesh."""
    made = with_body(mesh, material)
    assert isinstance(made.spec.surface, MeshFile)
    return mesh_surface(made, made.spec.surface, DEFAULT)


@pytest.mark.parametrize("legs", [(Flat(140.0),), CHANNEL, JOGGLE], ids=["plate", "channel", "joggle"])
@pytest.mark.parametrize("change", [moved, flipped, lambda m: in_float32(moved(m))])
def test_the_thickness_is_the_distance_of_the_skins(legs: Legs, change: Callable[[Mesh], Mesh]) -> None:
    found = skin_of(change(solid(legs, rectangle(WIDTH, legs), 15.0, T)))
    assert_near(found.thickness_mm, T, bound=1e-4, why="float32 at 1000 mm keeps 3e-5")
    assert edges_of(found.mesh).border.size
    assert [finding.code for finding in found.findings] == ["mesh-solid"]
    assert found.part.spec.face == "plus"


def test_inner_keeps_the_smaller_skin() -> None:
    outer, inner = (area(skin_of(channel(1.0), face=face).mesh) for face in ("outer", "inner"))
    assert_relative(outer, WIDTH * run_length(CHANNEL), bound=1e-5, why="chords of 1 deg: 1/24 of its square")
    assert_relative(inner, WIDTH * (140.0 + np.pi * (3.0 - T)), bound=1e-5, why="as above")


def test_a_solid_takes_the_flat_length_of_its_neutral_surface() -> None:
    outcome = surface_of(moved(channel()), steel())
    assert isinstance(outcome.product, RuledSurface)
    certificate = verify(outcome.product, DEFAULT).product
    assert certificate is not None
    pattern = unroll(certificate, DEFAULT).product
    assert pattern is not None
    lengths = sorted(np.ptp(pattern.outer.path.vertices, axis=0))
    assert_near(
        lengths, [WIDTH, 140.0 + np.pi * (3.0 - T + K * T)], bound=1e-8, why="r + K t, r that of the inner skin"
    )
    thickness = outcome.report.metric("solid_thickness_mm")
    assert_near(thickness.value, T, bound=1e-9, why="the skins are parallel")
    assert thickness.evidence == "sampled", "a mean over vertices"


def test_holes_make_handles_of_a_solid_and_none_of_its_skin() -> None:
    legs = (Flat(30.0), Bend(3.0, 90.0), Flat(30.0))
    region = rectangle(WIDTH, legs).difference(
        shapely.union_all([shapely.box(40, 20, 55, 45), shapely.box(5, 5, 15, 15)])
    )
    outcome = surface_of(in_float32(moved(solid(legs, region, 15.0, T))), steel())
    assert isinstance(outcome.product, RuledSurface)
    assert outcome.product.trim is not None
    assert len(outcome.product.trim.inner) == 2


def test_a_solid_that_is_not_as_thick_as_its_material_is_refused() -> None:
    outcome = surface_of(channel(), steel(2.0))
    assert outcome.product is None
    fatal = [finding for finding in outcome.report.findings if finding.fatal]
    assert [finding.code for finding in fatal] == ["solid-thickness"]
    assert "1.5 mm" in fatal[0].message
    assert "2 mm" in fatal[0].message


def test_a_solid_gives_its_thickness_to_a_material_without() -> None:
    found = skin_of(channel(), steel(None))
    assert_near(found.part.material.thickness_mm or 0.0, T, bound=1e-9, why="measured")


# What is no sheet


def test_an_open_mesh_and_a_block_are_no_sheets() -> None:
    plate = (Flat(140.0),)
    open_mesh = bent(CHANNEL, rectangle(WIDTH, CHANNEL), 15.0)
    block = solid(plate, rectangle(WIDTH, plate), 15.0, 60.0)
    for mesh in (open_mesh, block):
        assert thin_solid(with_body(mesh, steel()), mesh, DEFAULT) is None


def test_a_skin_that_is_not_parallel_is_no_sheet() -> None:
    mesh = channel()
    half = len(mesh.vertices) // 2
    tapered = mesh.vertices.copy()
    tapered[half:, 1] += 1e-3 * mesh.vertices[half:, 2] / WIDTH
    assert thin_solid(with_body(mesh, steel()), mesh, DEFAULT) is not None
    wedge = Mesh(tapered, mesh.faces)
    assert thin_solid(with_body(wedge, steel()), wedge, DEFAULT) is None
