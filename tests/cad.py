"""CAD files for tests, written by OpenCASCADE; shapes in mm unless said otherwise."""

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from math import pi
from pathlib import Path

import numpy as np
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakeWire,
    BRepBuilderAPI_Transform,
)
from OCP.BRepFill import BRepFill
from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
from OCP.BRepPrimAPI import (
    BRepPrimAPI_MakeBox,
    BRepPrimAPI_MakeCone,
    BRepPrimAPI_MakeCylinder,
    BRepPrimAPI_MakeHalfSpace,
    BRepPrimAPI_MakePrism,
    BRepPrimAPI_MakeSphere,
    BRepPrimAPI_MakeTorus,
)
from OCP.collections import Array1_double, Array1_gp_Pnt, Array1_int
from OCP.Geom import Geom_BSplineCurve
from OCP.gp import gp_Ax1, gp_Ax2, gp_Circ, gp_Dir, gp_Elips, gp_Pln, gp_Pnt, gp_Trsf, gp_Vec
from OCP.IGESControl import IGESControl_Writer
from OCP.Interface import Interface_Static
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS, TopoDS_Edge, TopoDS_Face, TopoDS_Shape

from pipeline.cad import rhino as cad_3dm
from pipeline.cad import step as cad_step
from stages.model.cadface import CadBody, CadFace
from stages.model.faces import FaceFile
from stages.model.material import Part
from stages.model.part import PartSpec

Row = Sequence[float]


@contextmanager
def silent() -> Iterator[None]:
    """Keep what the library prints to stdout out of the tests' output."""
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


def step(file: Path, shape: TopoDS_Shape, unit: str = "MM") -> Path:
    """Write a STEP file."""
    with silent():
        Interface_Static.SetCVal_s("write.step.unit", unit)
        writer = STEPControl_Writer()
        writer.Transfer(shape, STEPControl_AsIs)
        writer.Write(str(file))
        Interface_Static.SetCVal_s("write.step.unit", "MM")
    return file


def iges(file: Path, shape: TopoDS_Shape, unit: str = "MM") -> Path:
    """Write an IGES file."""
    with silent():
        writer = IGESControl_Writer(unit, 1)
        writer.AddShape(shape)
        writer.ComputeModel()
        writer.Write(str(file))
    return file


def faces(shape: TopoDS_Shape) -> list[TopoDS_Face]:
    """Return the faces in the library's order."""
    return [TopoDS.Face(one) for one in _explored(shape, TopAbs_FACE)]


def edges(shape: TopoDS_Shape) -> list[TopoDS_Edge]:
    """Return the edges in the library's order."""
    return [TopoDS.Edge(one) for one in _explored(shape, TopAbs_EDGE)]


def _explored(shape: TopoDS_Shape, sort: object) -> Iterator[TopoDS_Shape]:
    explorer = TopExp_Explorer(shape, sort)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def point(row: Row) -> gp_Pnt:
    return gp_Pnt(*(float(x) for x in row))


def axes(centre: Row = (0, 0, 0), normal: Row = (0, 0, 1)) -> gp_Ax2:
    return gp_Ax2(point(centre), gp_Dir(*(float(x) for x in normal)))


def filleted_box(size: Row = (100, 60, 40), radius: float = 10.0) -> TopoDS_Shape:
    """A box with one rounded edge, parallel to z."""
    box = BRepPrimAPI_MakeBox(*(float(x) for x in size)).Shape()
    made = BRepFilletAPI_MakeFillet(box)
    made.Add(radius, edges(box)[0])
    return made.Shape()


def cut_by(shape: TopoDS_Shape, place: Row, normal: Row) -> TopoDS_Shape:
    """A body without what lies on the side of a plane that its normal points to."""
    face = BRepBuilderAPI_MakeFace(gp_Pln(point(place), gp_Dir(*(float(x) for x in normal)))).Face()
    side = point(np.add(place, normal))
    return BRepAlgoAPI_Cut(shape, BRepPrimAPI_MakeHalfSpace(face, side).Solid()).Shape()


def oblique_pipe(radius: float = 20.0, height: float = 50.0) -> TopoDS_Shape:
    """A cylinder about z with its top cut at 30 degrees through the axis at half the height."""
    pipe = BRepPrimAPI_MakeCylinder(radius, height).Shape()
    return cut_by(pipe, (0, 0, height / 2), (np.sin(pi / 6), 0, np.cos(pi / 6)))


def drilled_cone() -> TopoDS_Shape:
    """A frustum with a round hole in one side."""
    cone = BRepPrimAPI_MakeCone(40.0, 15.0, 60.0).Shape()
    drill = BRepPrimAPI_MakeCylinder(axes((0, -3, 25), (0, 1, 0)), 8.0, 200.0).Shape()
    return BRepAlgoAPI_Cut(cone, drill).Shape()


def pointed_cone() -> TopoDS_Shape:
    """A cone up to its apex."""
    return BRepPrimAPI_MakeCone(30.0, 0.0, 40.0).Shape()


def spline(points: Sequence[Row], degree: int = 3, weights: Row | None = None) -> Geom_BSplineCurve:
    """A clamped B-spline with evenly spaced knots."""
    n = len(points) - degree + 1
    poles, knots, times = Array1_gp_Pnt(1, len(points)), Array1_double(1, n), Array1_int(1, n)
    for i, row in enumerate(points, 1):
        poles.SetValue(i, point(row))
    for i in range(1, n + 1):
        knots.SetValue(i, float(i - 1))
        times.SetValue(i, degree + 1 if i in (1, n) else 1)
    if weights is None:
        return Geom_BSplineCurve(poles, knots, times, degree)
    row = Array1_double(1, len(points))
    for i, weight in enumerate(weights, 1):
        row.SetValue(i, float(weight))
    return Geom_BSplineCurve(poles, row, knots, times, degree)


def between(one: Geom_BSplineCurve, other: Geom_BSplineCurve) -> TopoDS_Shape:
    """The ruled face between two splines."""
    a, b = (BRepBuilderAPI_MakeEdge(curve).Edge() for curve in (one, other))
    return BRepFill.Face_s(a, b)


def slotted_plate(size: Row = (120, 80), tilt: float = 0.0) -> TopoDS_Shape:
    """A plate with a round hole, an elliptic hole and a slot; turned about x by `tilt` rad."""
    w, h = (float(x) for x in size)
    made = BRepBuilderAPI_MakeFace(gp_Pln(axes().Location(), gp_Dir(0, 0, 1)), 0.0, w, 0.0, h)
    for wire in (_round(w / 4, h / 2, 9.0), _ellipse(w / 2, h / 2, 12.0, 7.0), _slot(3 * w / 4, h / 2, 20.0, 5.0)):
        made.Add(TopoDS.Wire(wire.Reversed()))
    turn = gp_Trsf()
    turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0)), tilt)
    return BRepBuilderAPI_Transform(made.Face(), turn, True).Shape()


def _wire(*parts: object) -> object:
    made = BRepBuilderAPI_MakeWire()
    for part in parts:
        made.Add(part)
    return TopoDS.Wire(made.Wire())


def _round(x: float, y: float, radius: float) -> object:
    return _wire(BRepBuilderAPI_MakeEdge(gp_Circ(axes((x, y, 0)), radius)).Edge())


def _ellipse(x: float, y: float, major: float, minor: float) -> object:
    return _wire(BRepBuilderAPI_MakeEdge(gp_Elips(axes((x, y, 0)), major, minor)).Edge())


def _slot(x: float, y: float, length: float, radius: float) -> object:
    half = length / 2
    right, left = gp_Circ(axes((x, y + half, 0)), radius), gp_Circ(axes((x, y - half, 0)), radius)
    corners = [(x + radius, y - half), (x + radius, y + half), (x - radius, y + half), (x - radius, y - half)]
    a, b, c, d = (gp_Pnt(*corner, 0.0) for corner in corners)
    return _wire(
        BRepBuilderAPI_MakeEdge(a, b).Edge(),
        BRepBuilderAPI_MakeEdge(right, b, c).Edge(),
        BRepBuilderAPI_MakeEdge(c, d).Edge(),
        BRepBuilderAPI_MakeEdge(left, d, a).Edge(),
    )


def channel(width: float = 80.0, height: float = 30.0, depth: float = 120.0, radius: float = 5.0) -> TopoDS_Shape:
    """A U-shaped shell along y: flange, bend, base with a round hole, bend, flange; tangent-continuous throughout."""
    w, h, r = width / 2, height, radius
    corners = [(-w, h), (-w, r), (-w + r, 0), (w - r, 0), (w, r), (w, h)]
    a, b, c, d, e, f = (gp_Pnt(x, 0.0, z) for x, z in corners)
    left, right = (gp_Circ(axes((x, 0, r), (0, -1, 0)), r) for x in (-w + r, w - r))
    profile = _wire(
        BRepBuilderAPI_MakeEdge(a, b).Edge(),
        BRepBuilderAPI_MakeEdge(left, b, c).Edge(),
        BRepBuilderAPI_MakeEdge(c, d).Edge(),
        BRepBuilderAPI_MakeEdge(right, d, e).Edge(),
        BRepBuilderAPI_MakeEdge(e, f).Edge(),
    )
    shell = BRepPrimAPI_MakePrism(profile, gp_Vec(0.0, depth, 0.0)).Shape()
    drill = BRepPrimAPI_MakeCylinder(axes((0, depth / 3, -10)), 12.0, 20.0).Shape()
    return BRepAlgoAPI_Cut(shell, drill).Shape()


def rounded_tube(width: float = 60.0, depth: float = 40.0, radius: float = 8.0) -> TopoDS_Shape:
    """A square tube along z with rounded corners: a ring of four planes and four cylinders."""
    box = BRepPrimAPI_MakeBox(width, width, depth).Shape()
    made = BRepFilletAPI_MakeFillet(box)
    for edge in edges(box):
        reach = extents(edge)
        if reach[2] > depth / 2:
            made.Add(radius, edge)
    return made.Shape()


def extents(edge: TopoDS_Edge) -> Row:
    """The extents of an edge along x, y and z."""
    curve = BRepAdaptor_Curve(edge)
    a, b = (curve.Value(t) for t in (curve.FirstParameter(), curve.LastParameter()))
    return abs(a.X() - b.X()), abs(a.Y() - b.Y()), abs(a.Z() - b.Z())


def prism(corners: Sequence[tuple[float, float]], height: float) -> TopoDS_Shape:
    """A polygon of z = 0 extruded along z."""
    points = [gp_Pnt(x, y, 0.0) for x, y in corners]
    sides = [BRepBuilderAPI_MakeEdge(a, b).Edge() for a, b in zip(points, [*points[1:], points[0]], strict=True)]
    return BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(_wire(*sides)).Face(), gp_Vec(0.0, 0.0, height)).Shape()


def turned(shape: TopoDS_Shape, axis: Row, angle: float, shift: Row) -> TopoDS_Shape:
    """A shape turned about an axis through the origin, then moved."""
    turn, move = gp_Trsf(), gp_Trsf()
    turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(*(float(x) for x in axis))), angle)
    move.SetTranslation(gp_Vec(*(float(x) for x in shift)))
    return BRepBuilderAPI_Transform(shape, move.Multiplied(turn), True).Shape()


def sphere(radius: float = 10.0) -> TopoDS_Shape:
    """A sphere."""
    return BRepPrimAPI_MakeSphere(radius).Shape()


def torus(major: float = 10.0, minor: float = 3.0) -> TopoDS_Shape:
    """A torus."""
    return BRepPrimAPI_MakeTorus(major, minor).Shape()


# Reading


def read(file: Path) -> CadBody:
    """Return the faces of a file, read in this process."""
    with silent():
        if file.suffix == ".3dm":
            return cad_3dm.faces(str(file))
        return cad_step.faces(str(file), "step" if file.suffix == ".step" else "iges")


def part(*faces: CadFace, name: str = "part") -> Part:
    """Return the part that is made of faces."""
    return Part(PartSpec(name=name, surface=FaceFile(file="a.step", all=True)), body=CadBody(faces))
