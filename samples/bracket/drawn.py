"""Writes bracket.step: the outer faces of a bent bracket, as a CAD program exports them.

Lengths in mm.  The profile runs in the xz plane, up, round and down the outside of the sheet; 60 wide along y.
Takes the extra `cad` (OpenCASCADE):  python samples/bracket/drawn.py
"""

from math import pi
from pathlib import Path

from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeWire
from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakePrism
from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Pnt, gp_Vec
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer
from OCP.TopoDS import TopoDS_Edge, TopoDS_Shape

WIDTH, LENGTH, LEFT, RIGHT = 60.0, 120.0, 40.0, 55.0
"""Across; base and both flanges over all."""
OUTSIDE = 6.0
"""Radius of the bends on the outside: 4 inside and 2 of sheet."""
FIXINGS = ((20.0, 12.0), (20.0, 48.0), (100.0, 12.0), (100.0, 48.0))
HOLES = (
    *((gp_Pnt(x, y, -1.0), gp_Dir(0, 0, 1), 6.6) for x, y in FIXINGS),
    (gp_Pnt(60.0, 30.0, -1.0), gp_Dir(0, 0, 1), 32.0),
    (gp_Pnt(-1.0, 30.0, 25.0), gp_Dir(1, 0, 0), 11.0),
    (gp_Pnt(LENGTH - 1.0, 30.0, 35.0), gp_Dir(1, 0, 0), 22.0),
)
"""Where each begins, which way it is drilled, 2 mm deep, and its diameter."""


def profile() -> list[TopoDS_Edge]:
    """Return the outside of the sheet from the top of the left flange to that of the right one."""
    r = OUTSIDE
    left, right = gp_Pnt(r, 0, r), gp_Pnt(LENGTH - r, 0, r)
    return [
        _line(gp_Pnt(0, 0, LEFT), gp_Pnt(0, 0, r)),
        _arc(left, gp_Dir(-1, 0, 0)),
        _line(gp_Pnt(r, 0, 0), gp_Pnt(LENGTH - r, 0, 0)),
        _arc(right, gp_Dir(0, 0, -1)),
        _line(gp_Pnt(LENGTH, 0, r), gp_Pnt(LENGTH, 0, RIGHT)),
    ]


def _line(a: gp_Pnt, b: gp_Pnt) -> TopoDS_Edge:
    return BRepBuilderAPI_MakeEdge(a, b).Edge()


def _arc(centre: gp_Pnt, start: gp_Dir) -> TopoDS_Edge:
    """Return a quarter turn about -y, from a direction on."""
    circle = gp_Circ(gp_Ax2(centre, gp_Dir(0, -1, 0), start), OUTSIDE)
    return BRepBuilderAPI_MakeEdge(circle, 0.0, pi / 2.0).Edge()


def bracket() -> TopoDS_Shape:
    """Return the faces, with their holes."""
    wire = BRepBuilderAPI_MakeWire()
    for edge in profile():
        wire.Add(edge)
    shape = BRepPrimAPI_MakePrism(wire.Wire(), gp_Vec(0, WIDTH, 0)).Shape()
    for start, way, diameter in HOLES:
        drill = BRepPrimAPI_MakeCylinder(gp_Ax2(start, way), diameter / 2.0, 2.0).Shape()
        shape = BRepAlgoAPI_Cut(shape, drill).Shape()
    return shape


def main() -> None:
    """Write the file beside this one."""
    writer = STEPControl_Writer()
    writer.Transfer(bracket(), STEPControl_AsIs)
    writer.Write(str(Path(__file__).parent / "bracket.step"))


if __name__ == "__main__":
    main()
