"""Files with parts that are placed: STEP assemblies and blocks of 3DM, and names that are no plain ASCII."""

import re
from pathlib import Path

import numpy as np
import pytest
import rhino3dm
from OCP.BRep import BRep_Builder
from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
from OCP.Interface import Interface_Static
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Compound, TopoDS_Shape

from pipeline.cad.rhino import UnreadableCadError
from stages.geometry.arrays import norm
from stages.model.cadface import CadFace
from tests import cad, cadrhino
from tests.near import assert_near

ANGLE, SHIFT = 0.7, np.array([300.0, -40.0, 25.0])


def move() -> gp_Trsf:
    """A turn about z, then a shift."""
    turn, shift = gp_Trsf(), gp_Trsf()
    turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), ANGLE)
    shift.SetTranslation(gp_Vec(*SHIFT.tolist()))
    return shift.Multiplied(turn)


def moved(points: np.ndarray) -> np.ndarray:
    c, s = np.cos(ANGLE), np.sin(ANGLE)
    return points @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + SHIFT


def corners(faces: tuple[CadFace, ...]) -> np.ndarray:
    """Return the ends of all edges, in an order of their own."""
    found = [edge.curves[0].jet(np.zeros(1), 0)[0][0] for face in faces for loop in face.loops for edge in loop]
    rows = np.array(found)
    return rows[np.lexsort(np.round(rows, 6).T)]


def assembly(shape: TopoDS_Shape) -> TopoDS_Compound:
    """One part where it is drawn and once more where it is placed."""
    made, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(made)
    builder.Add(made, shape)
    builder.Add(made, shape.Moved(TopLoc_Location(move())))
    return made


def test_the_parts_of_a_step_assembly_lie_where_they_are_placed(tmp_path: Path) -> None:
    part = cad.filleted_box()
    try:
        Interface_Static.SetIVal_s("write.step.assembly", 1)
        file = cad.step(tmp_path / "a.step", assembly(part))
    finally:
        Interface_Static.SetIVal_s("write.step.assembly", 0)
    assert file.read_text().count("NEXT_ASSEMBLY_USAGE_OCCURRENCE") >= 2, "the writer may wrap them once more"
    faces = cad.read(file).faces
    count = len(faces) // 2
    assert count == len(cad.faces(part))
    assert_near(corners(faces[count:]), corners_moved(faces[:count]), bound=1e-9, why="digits of the file")
    for one, other in zip(faces[:count], faces[count:], strict=True):
        turned = moved(one.normal[None])[0] - SHIFT
        assert_near(other.normal, turned, bound=1e-12, why="placed with its face")
        assert other.area_mm2 == pytest.approx(one.area_mm2, rel=1e-9)


def corners_moved(faces: tuple[CadFace, ...]) -> np.ndarray:
    rows = moved(corners(faces))
    return rows[np.lexsort(np.round(rows, 6).T)]


@pytest.mark.parametrize(
    ("written", "name"),
    [
        ("Deckel links", "Deckel links"),
        (r"T\X2\00FC\X0\r gro\X2\00DF\X0\ 2", "Tür groß 2"),
        ("it''s 5", "it's 5"),
        (r"\X2\677F\X0\ 1", "板 1"),
    ],
)
def test_names_of_step_faces_keep_spaces_and_umlauts(tmp_path: Path, written: str, name: str) -> None:
    file = cad.step(tmp_path / "Blech groß 1.step", cad.slotted_plate())
    content = file.read_text()
    assert content.count("ADVANCED_FACE('',") == 1
    file.write_text(content.replace("ADVANCED_FACE('',", f"ADVANCED_FACE('{written}',"))
    assert [face.name for face in cad.read(file).faces] == [name]


def block(model: rhino3dm.File3dm, thing: rhino3dm.GeometryBase, name: str) -> str:
    """Define a block of one object; return its id."""
    attributes = rhino3dm.ObjectAttributes()
    attributes.Name = name
    index = model.InstanceDefinitions.Add(name, "", "", "", rhino3dm.Point3d(0, 0, 0), (thing,), (attributes,))
    return model.InstanceDefinitions.FindIndex(index).Id


def placed(model: rhino3dm.File3dm, number: str, x: float, scale: float = 1.0) -> None:
    form = rhino3dm.Transform.Scale(rhino3dm.Point3d(0, 0, 0), scale)
    form.M03 = x
    model.Objects.AddInstanceObject(rhino3dm.InstanceReference(number, form))


def test_blocks_of_a_3dm_file_lie_where_they_are_inserted(tmp_path: Path) -> None:
    model = rhino3dm.File3dm()
    model.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Centimeters
    number = block(model, cadrhino.rhino_extrusion([(0, 0, 0), (50, 0, 0)], 30.0), "Wange")
    for x, scale in ((0.0, 1.0), (200.0, 1.0), (500.0, 2.0)):
        placed(model, number, x, scale)
    assert model.Write(str(tmp_path / "a.3dm"), 8)
    faces = cad.read(tmp_path / "a.3dm").faces
    assert [face.name for face in faces] == ["Wange"] * 3
    first, second, third = (corners((face,)) for face in faces)
    assert_near(second, first + np.array([2000.0, 0, 0]), bound=1e-9, why="moved by 200 cm")
    assert_near(third, 2.0 * first + np.array([5000.0, 0, 0]), bound=1e-9, why="twice as large")
    assert_near(norm(np.ptp(first, axis=0)), np.hypot(500.0, 300.0), bound=1e-9, why="50 x 30 cm")


def doubled(model: rhino3dm.File3dm, thing: rhino3dm.GeometryBase, levels: int) -> str:
    """Return the id of a block that inserts two of a block, which does the same, and so on; the last holds a thing."""
    number = block(model, thing, "level 0")
    for level in range(1, levels + 1):
        twice = tuple(rhino3dm.InstanceReference(number, rhino3dm.Transform.Identity()) for _ in range(2))
        named = tuple(rhino3dm.ObjectAttributes() for _ in twice)
        origin = rhino3dm.Point3d(0, 0, 0)
        index = model.InstanceDefinitions.Add(f"level {level}", "", "", "", origin, twice, named)
        number = model.InstanceDefinitions.FindIndex(index).Id
    return number


@pytest.mark.parametrize("levels", [1, 3])
def test_blocks_within_blocks_are_read_as_often_as_they_are_inserted(tmp_path: Path, levels: int) -> None:
    model = rhino3dm.File3dm()
    placed(model, doubled(model, cadrhino.rhino_extrusion([(0, 0, 0), (50, 0, 0)], 30.0), levels), 0.0)
    assert model.Write(str(tmp_path / "a.3dm"), 8)
    assert len(cad.read(tmp_path / "a.3dm").faces) == 2**levels


@pytest.mark.parametrize("thing", ["a body", "a point"])
def test_blocks_that_multiply_without_end_are_refused_before_they_are_read(tmp_path: Path, thing: str) -> None:
    """Blocks doubled forty times take a file of some kB, and a month to read; also where there is nothing in them."""
    model = rhino3dm.File3dm()
    body = (
        cadrhino.rhino_extrusion([(0, 0, 0), (50, 0, 0)], 30.0)
        if thing == "a body"
        else rhino3dm.Point(rhino3dm.Point3d(0, 0, 0))
    )
    placed(model, doubled(model, body, 40), 0.0)
    assert model.Write(str(tmp_path / "a.3dm"), 8)
    inserted = 3 * 2**40 - 2  # of a block n: two of n - 1 and what they hold; the last one holds one thing
    with pytest.raises(
        UnreadableCadError,
        match=f"^its blocks insert {re.escape(format(inserted, '.4g'))} objects; read here are at most ",
    ):
        cad.read(tmp_path / "a.3dm")
