"""Shells that are one blank in any direction: which faces are joined, and why others are not."""

from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
import rhino3dm
from msgspec.structs import replace as with_fields
from OCP.TopoDS import TopoDS_Shape

from stages.construct.faces import tree
from stages.construct.faces.based import Based
from stages.construct.faces.surface import face_blanks, face_surface
from stages.errors import NoSolutionError
from stages.model.cadface import CadBody
from stages.model.material import Part
from stages.model.report import Finding, Outcome
from stages.model.surface import BranchedSurface, Surface
from stages.model.tolerances import Tolerances
from tests import cad, cadrhino, cadshells
from tests.near import assert_near

TOL = Tolerances()
Row = Sequence[float]


def blanks(tmp_path: Path, faces: Sequence[TopoDS_Shape], write: Callable[..., Path] = cad.step) -> tuple[Part, ...]:
    """Return the blanks of a shell of faces."""
    file = tmp_path / ("a.step" if write is cad.step else "a.iges")
    return face_blanks(cad.part(*cad.read(write(file, cadshells.sewn(faces))).faces))


@cache
def shell(make: Callable[[], list[TopoDS_Shape]], write: Callable[..., Path] = cad.step) -> tuple[Part, ...]:
    """Return the blanks of a shell, read once."""
    with TemporaryDirectory() as folder:
        return blanks(Path(folder), make(), write)


@cache
def constructed(
    make: Callable[[], list[TopoDS_Shape]], write: Callable[..., Path] = cad.step
) -> Outcome[Surface | None]:
    """Return the surface of a shell that is one blank, made once."""
    (one,) = shell(make, write)
    return face_surface(one, TOL)


def tray() -> Part:
    """Return a tray as one blank."""
    (one,) = shell(cadshells.tray)
    return one


def indices(part: Part) -> list[int]:
    assert isinstance(part.body, CadBody)
    return sorted(face.index for face in part.body.faces)


def codes(findings: Sequence[Finding]) -> list[str]:
    return [one.code for one in findings]


SHELLS: dict[str, tuple[Callable[[], list[TopoDS_Shape]], int]] = {
    "a tray": (cadshells.tray, 9),
    "a conical bend": (cadshells.conical_bend, 3),
    "a square to a circle": (cadshells.square_to_round, 8),
    "a frame of planes": (cadshells.frame, 4),
    "a flange in a window": (cadshells.window, 3),
}


@pytest.mark.parametrize(("name", "write"), [*((n, cad.step) for n in SHELLS), ("a square to a circle", cad.iges)])
def test_a_shell_of_faces_that_go_over_into_each_other_is_one_blank(name: str, write: Callable[..., Path]) -> None:
    make, count = SHELLS[name]
    (one,) = shell(make, write)
    assert indices(one) == list(range(count))
    made = constructed(make, write)
    assert made.product is not None, made.report.findings
    assert float(made.report.metric("join_normal_deg").value or 0.0) <= 0.01
    assert float(made.report.metric("join_gap_mm").value or 0.0) <= 1e-6


def test_each_face_follows_one_that_it_is_joined_to() -> None:
    one = tray()
    assert isinstance(one.body, CadBody)
    assert [joint.other for joint in one.body.joints] == list(range(1, 9))
    assert all(joint.one < joint.other for joint in one.body.joints)
    surface = constructed(cadshells.tray).product
    assert isinstance(surface, BranchedSurface)
    assert surface.numbers == tuple(face.index for face in one.body.faces)
    ends = [float(face.spans[0][0]) for face in surface.faces]
    assert_near(ends, np.arange(9.0), bound=0.0, why="one patch each, v runs on")


def test_a_ring_is_cut_open_at_its_shortest_edge_and_says_how_far_its_sides_lie_apart() -> None:
    (one,) = shell(cadshells.square_to_round)
    (remark,) = one.remarks
    assert remark.code == "not-joined"
    assert "the ring is cut open there" in remark.message
    assert "mm apart in the flat" in remark.message


def test_a_ring_that_lies_flat_is_closed() -> None:
    (one,) = shell(cadshells.frame)
    assert isinstance(one.body, CadBody)
    assert one.remarks == ()
    assert len(one.body.joints) == 4
    rows = constructed(cadshells.frame).report.detail["joins"]
    assert isinstance(rows, list)
    assert [row["closes_a_ring"] for row in rows] == [False, False, False, True]


def test_faces_that_would_cover_each_other_are_blanks_of_their_own(tmp_path: Path) -> None:
    made = blanks(tmp_path, cadshells.tray(wing=20.0, sides=2))
    assert [len(indices(one)) for one in made] == [4, 1]
    (remark,) = made[1].remarks
    assert "would be covered twice" in remark.message
    assert remark in made[0].remarks


def test_wings_that_stay_clear_of_each_other_are_joined(tmp_path: Path) -> None:
    # the flange lies 4 pi / 2 = 6.28 mm beyond the bottom, its neighbour's wing reaches 6 mm beyond the corner
    assert len(blanks(tmp_path, cadshells.tray(wing=6.0, sides=2))) == 1


@pytest.mark.parametrize("angle_deg", [0.005, 0.02, 5.0])
def test_a_crease_is_no_hinge_from_a_hundredth_of_a_degree_on(tmp_path: Path, angle_deg: float) -> None:
    c, s = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    flat = [(0, 0, 0), (0, -40, 0), (60, -40, 0), (60, 0, 0)]
    steep = [(0, 0, 0), (60, 0, 0), (60, 50 * c, 50 * s), (0, 50 * c, 50 * s)]
    slanted = [(0, 0, 0), (0, 50 * c, 50 * s), (-30, 50 * c, 50 * s), (-30, 0, 0)]
    made = blanks(tmp_path, [cadshells.polygon(*row) for row in (flat, steep, slanted)])
    assert [indices(one) for one in made] == ([[0, 1, 2]] if angle_deg < 0.01 else [[0], [1, 2]])
    if angle_deg > 0.01:
        assert codes(made[0].remarks) == ["edges-apart"]
        assert (
            f"faces 0 and 1 at (30, 0, 0) mm: they meet at an angle of {angle_deg:g} deg" in made[0].remarks[0].message
        )


def test_loose_faces_are_joined_by_where_their_edges_lie(tmp_path: Path) -> None:
    body = cad.read(cad.step(tmp_path / "a.step", cadshells.loose(cadshells.tray())))
    (one,) = face_blanks(cad.part(*body.faces))
    assert indices(one) == list(range(9))


def test_a_face_that_is_turned_over_stays_apart_and_the_way_out_is_told(tmp_path: Path) -> None:
    faces = cadshells.tray()
    faces[2] = faces[2].Reversed()
    made = face_blanks(cad.part(*cad.read(cad.step(tmp_path / "a.step", cadshells.loose(faces))).faces))
    assert [len(indices(one)) for one in made] == [8, 1]
    assert "their outward normals are opposite: sew the faces" in made[1].remarks[0].message


def test_a_face_that_cannot_be_laid_flat_stays_apart(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = tree.flat_face

    def broken(side: Based) -> tree.FlatFace:
        if side.face.index == 2:
            raise NoSolutionError("unrolling piece 0", reached=1.0, wanted=1e-14)
        return whole(side)

    monkeypatch.setattr(tree, "flat_face", broken)
    made = blanks(tmp_path, cadshells.conical_bend())
    assert [indices(one) for one in made] == [[0, 1], [2]]
    assert [codes(one.remarks) for one in made] == [["not-joined"]] * 2
    assert "its development does not resolve" in made[1].remarks[0].message


# The face of the sheet


def lipped(tmp_path: Path) -> Part:
    faces = [cadshells.polygon((0, 0, 0), (60, 0, 0), (60, 40, 0), (0, 40, 0))]
    faces += cadshells.side((0, 1, 0), (1, 0, 0), (60, 0, 0), 40.0, radius=4.0, height=25.0)[:1]
    faces += cadshells.side((1, 0, 0), (0, -1, 0), (0, 0, 0), 60.0, radius=4.0, height=25.0)
    faces += cadshells.lip((1, 0, 0), (0, -1, 0), (0, -4, 29), 60.0, radius=4.0, reach=12.0)
    (one,) = blanks(tmp_path, faces)
    return one


def test_bends_to_both_sides_leave_no_inner_face(tmp_path: Path) -> None:
    part = lipped(tmp_path)
    for face in ("inner", "outer"):
        made = face_surface(Part(with_fields(part.spec, face=face), part.material, body=part.body), TOL)
        assert made.product is None
        assert codes(made.report.findings) == ["face-changes-side"]
    assert face_surface(part, TOL).product is not None


@pytest.mark.parametrize(("face", "side"), [("inner", "plus"), ("outer", "minus"), ("middle", "middle")])
def test_inner_is_one_side_of_all_faces(face: str, side: str) -> None:
    part = tray()
    made = face_surface(Part(with_fields(part.spec, face=face), part.material, body=part.body), TOL)
    assert isinstance(made.product, BranchedSurface)
    assert {one.part.spec.face for one in made.product.faces} == {side}


# Rhino


def surface_between(one: Sequence[Row], other: Sequence[Row]) -> rhino3dm.NurbsSurface:
    lines = [rhino3dm.LineCurve(*(rhino3dm.Point3d(*map(float, row)) for row in rows)) for rows in (one, other)]
    return rhino3dm.NurbsSurface.CreateRuledSurface(*lines)


def bent(start: Row, middle: Row, end: Row, along: Row) -> rhino3dm.NurbsSurface:
    """The part of a cylinder between an arc through three points and the arc moved."""
    arcs = [
        rhino3dm.NurbsCurve.CreateFromArc(
            rhino3dm.Arc(*(rhino3dm.Point3d(*map(float, np.add(row, move))) for row in (start, middle, end)))
        )
        for move in ((0, 0, 0), along)
    ]
    return rhino3dm.NurbsSurface.CreateRuledSurface(*arcs)


def test_loose_surfaces_by_rhino_that_bend_in_two_directions_are_one_blank(tmp_path: Path) -> None:
    h = 5 - 5 * np.sqrt(0.5)
    plate = surface_between([(0, 0, 0), (60, 0, 0)], [(0, 40, 0), (60, 40, 0)])
    right = bent((60, 0, 0), (65 - h, 0, h), (65, 0, 5), (0, 40, 0))
    back = bent((60, 40, 0), (60, 45 - h, h), (60, 45, 5), (-60, 0, 0))
    body = cad.read(cadrhino.rhino(tmp_path / "a.3dm", plate, right, back))
    made = face_blanks(cad.part(*body.faces))
    told = [remark.message for one in made for remark in one.remarks]
    assert [indices(one) for one in made] == [[0, 1, 2]], told
