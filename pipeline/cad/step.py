"""STEP and IGES files -> faces as plain values, by OpenCASCADE (the only place that imports OCP).

    faces(file) -> CadBody

OpenCASCADE converts the file's units to mm and places the parts of an assembly.  Planes, cylinders, cones and
extrusions keep their own data; any other surface becomes a B-spline net, in which rulings are looked for later.
Runs in a child process (`pipeline.cad.files`): the library prints to stdout, and a broken file may crash it.
"""

from math import tan

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
from OCP.BRepGProp import BRepGProp
from OCP.BRepLib import BRepLib
from OCP.BRepTools import BRepTools, BRepTools_WireExplorer
from OCP.collections import IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as ShapeMap
from OCP.Geom import Geom_RectangularTrimmedSurface, Geom_TrimmedCurve
from OCP.GeomAbs import GeomAbs_CurveType, GeomAbs_SurfaceType
from OCP.GeomConvert import GeomConvert
from OCP.gp import gp_Pnt, gp_Vec
from OCP.GProp import GProp_GProps
from OCP.IFSelect import IFSelect_RetDone
from OCP.IGESControl import IGESControl_Reader
from OCP.Standard import Standard_Failure
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_FORWARD, TopAbs_REVERSED, TopAbs_WIRE
from OCP.TopExp import TopExp, TopExp_Explorer
from OCP.TopoDS import TopoDS, TopoDS_Edge, TopoDS_Face, TopoDS_Shape, TopoDS_Wire

from stages.construct.faces.spline import pieces, straight
from stages.geometry.arrays import Array, Vector3, unit
from stages.geometry.curves.curves import Circular, Curve
from stages.geometry.ruled.backwards import backwards
from stages.model.cadface import CadBody, CadCone, CadEdge, CadFace, CadNet, CadPlane, CadSurface, CadSweep

Curves = GeomAbs_CurveType
Surfaces = GeomAbs_SurfaceType
SORTS = {
    Surfaces.GeomAbs_Plane: "plane",
    Surfaces.GeomAbs_Cylinder: "cylinder",
    Surfaces.GeomAbs_Cone: "cone",
    Surfaces.GeomAbs_Sphere: "sphere",
    Surfaces.GeomAbs_Torus: "torus",
    Surfaces.GeomAbs_BezierSurface: "Bezier surface",
    Surfaces.GeomAbs_BSplineSurface: "B-spline surface",
    Surfaces.GeomAbs_SurfaceOfRevolution: "surface of revolution",
    Surfaces.GeomAbs_SurfaceOfExtrusion: "extrusion",
    Surfaces.GeomAbs_OffsetSurface: "offset surface",
}
NEVER_RULED = (Surfaces.GeomAbs_Sphere, Surfaces.GeomAbs_Torus)


class UnreadableCadError(Exception):
    """The library cannot read the file."""


def faces(file: str, sort: str) -> CadBody:
    """Return the faces of a file, `sort` "step" or "iges"; lengths in mm."""
    reader = STEPControl_Reader() if sort == "step" else IGESControl_Reader()
    if reader.ReadFile(file) != IFSelect_RetDone:
        raise UnreadableCadError("it cannot be read")
    reader.TransferRoots()
    shape = reader.OneShape()
    if shape is None or shape.IsNull():
        return CadBody(())
    BRepLib.BuildCurves3d_s(shape)
    edges = ShapeMap()
    TopExp.MapShapes_s(shape, TopAbs_EDGE, edges)
    found = [TopoDS.Face(one) for one in _explored(shape, TopAbs_FACE)]
    return CadBody(tuple(_face(i, face, _name(reader, face), edges) for i, face in enumerate(found)))


def _explored(shape: TopoDS_Shape, sort: object) -> list[TopoDS_Shape]:
    explorer, found = TopExp_Explorer(shape, sort), []
    while explorer.More():
        found.append(explorer.Current())
        explorer.Next()
    return found


def _name(reader: STEPControl_Reader | IGESControl_Reader, face: TopoDS_Face) -> str:
    """Return what a STEP file calls the face."""
    if not isinstance(reader, STEPControl_Reader):
        return ""
    entity = reader.WS().TransferReader().EntityFromShapeResult(face, 1)
    text = entity.Name() if hasattr(entity, "Name") else None
    return "" if text is None else str(text.ToCString())


def _face(index: int, face: TopoDS_Face, name: str, edges: ShapeMap) -> CadFace:
    adaptor = BRepAdaptor_Surface(face, False)
    place, normal = _witness(face, adaptor)
    sort = adaptor.GetType()
    return CadFace(
        index,
        name,
        SORTS.get(sort, "freeform surface"),
        None if sort in NEVER_RULED else _surface(face, adaptor),
        place,
        normal,
        _loops(face, edges),
        _area(face),
    )


def _area(face: TopoDS_Face) -> float:
    measured = GProp_GProps()
    BRepGProp.SurfaceProperties_s(face, measured, LISTED)
    return float(abs(measured.Mass()))


LISTED = 1e-6
"""Relative error of the areas by which faces are told apart in messages."""


def _vector(thing: object) -> Vector3:
    """Return a point, vector or direction of the library as an array."""
    return np.array([thing.X(), thing.Y(), thing.Z()])  # type: ignore[attr-defined]


def _bounds(face: TopoDS_Face) -> tuple[float, float, float, float]:
    """Return the ranges of both parameters that the face covers."""
    u0, u1, v0, v1 = BRepTools.UVBounds_s(face)
    return u0, u1, v0, v1


def _witness(face: TopoDS_Face, adaptor: BRepAdaptor_Surface) -> tuple[Vector3, Vector3]:
    """Return the point of the surface in the middle of the face's parameters, and the outward normal there."""
    u0, u1, v0, v1 = _bounds(face)
    point, by_u, by_v = gp_Pnt(), gp_Vec(), gp_Vec()
    adaptor.D1((u0 + u1) / 2.0, (v0 + v1) / 2.0, point, by_u, by_v)
    sign = -1.0 if face.Orientation() == TopAbs_REVERSED else 1.0
    return _vector(point), sign * unit(np.cross(_vector(by_u), _vector(by_v)))


def _surface(face: TopoDS_Face, adaptor: BRepAdaptor_Surface) -> CadSurface:
    match adaptor.GetType():
        case Surfaces.GeomAbs_Plane:
            return CadPlane()
        case Surfaces.GeomAbs_Cylinder:
            cylinder = adaptor.Cylinder()
            ring = _ring(cylinder.Position(), cylinder.Radius(), cylinder.Radius(), 0.0)
            return CadSweep((ring,), _vector(cylinder.Axis().Direction()))
        case Surfaces.GeomAbs_Cone:
            return _cone(adaptor)
        case Surfaces.GeomAbs_SurfaceOfExtrusion if adaptor.BasisCurve().GetType() in SWEPT:
            basis = adaptor.BasisCurve()
            profile = _curves(basis, basis.FirstParameter(), basis.LastParameter())
            return CadSweep(profile, _vector(adaptor.Direction()))
    return _net(face, adaptor)


SWEPT = (Curves.GeomAbs_Circle, Curves.GeomAbs_Ellipse, Curves.GeomAbs_BezierCurve, Curves.GeomAbs_BSplineCurve)
"""Profiles with ends of their own: any other is cut off where the face ends."""


def _cone(adaptor: BRepAdaptor_Surface) -> CadCone:
    """Return a cone by its apex and a circle: the reference circle, or one unit along the axis if that is a point."""
    cone = adaptor.Cone()
    frame, apex, radius = cone.Position(), _vector(cone.Apex()), cone.RefRadius()
    if radius > 0.0:
        return CadCone(apex, _ring(frame, radius, radius, 0.0))
    slope = abs(tan(cone.SemiAngle()))
    ring = _ring(frame, slope, slope, 0.0)
    return CadCone(apex, Circular(ring.centre + _vector(frame.Direction()), ring.U, ring.V, ring.W, 0.0, 2.0 * np.pi))


def _ring(frame: object, major: float, minor: float, start: float, sweep: float = 2.0 * np.pi) -> Circular:
    """Return a circle or ellipse in the frame of an axis placement."""
    x, y = _vector(frame.XDirection()), _vector(frame.YDirection())  # type: ignore[attr-defined]
    centre = _vector(frame.Location())  # type: ignore[attr-defined]
    return Circular(centre, major * x, minor * y, np.zeros(3), start, sweep)


def _net(face: TopoDS_Face, adaptor: BRepAdaptor_Surface) -> CadNet:
    """Return the surface as a B-spline over the face's range of parameters."""
    if adaptor.GetType() == Surfaces.GeomAbs_BSplineSurface:
        net = adaptor.BSpline()
    else:
        whole = Geom_RectangularTrimmedSurface(BRep_Tool.Surface_s(face), *_bounds(face))
        net = GeomConvert.SurfaceToBSplineSurface_s(whole)
    net.SetUNotPeriodic()
    net.SetVNotPeriodic()
    n, m = net.NbUPoles(), net.NbVPoles()
    points = np.array([[_vector(net.Pole(i, j)) for j in range(1, m + 1)] for i in range(1, n + 1)])
    weights = np.array([[net.Weight(i, j) for j in range(1, m + 1)] for i in range(1, n + 1)])
    knots_u, knots_v = _row(net.UKnotSequence()), _row(net.VKnotSequence())
    return CadNet(net.UDegree(), net.VDegree(), knots_u, knots_v, points, weights)


def _row(values: object) -> Array:
    """Return a row of numbers of the library, counted from 1, as an array."""
    return np.array([values.Value(i) for i in range(values.Lower(), values.Upper() + 1)])  # type: ignore[attr-defined]


def _loops(face: TopoDS_Face, edges: ShapeMap) -> tuple[tuple[CadEdge, ...], ...]:
    """Return the loops of a face, the outer one first."""
    seen = TopoDS.Face(face.Oriented(TopAbs_FORWARD))
    outer = BRepTools.OuterWire_s(seen)
    wires = [TopoDS.Wire(one) for one in _explored(seen, TopAbs_WIRE)]
    wires.sort(key=lambda wire: not wire.IsSame(outer))
    return tuple(_loop(wire, seen, edges) for wire in wires)


def _loop(wire: TopoDS_Wire, face: TopoDS_Face, edges: ShapeMap) -> tuple[CadEdge, ...]:
    """Return the edges of a loop in its order; those without length (at an apex) are left out."""
    explorer, found = BRepTools_WireExplorer(wire, face), []
    while explorer.More():
        edge = explorer.Current()
        if not BRep_Tool.Degenerated_s(edge):
            found.append(CadEdge(edges.FindIndex(edge), _along(edge, edge.Orientation() == TopAbs_REVERSED)))
        explorer.Next()
    return tuple(found)


def _along(edge: TopoDS_Edge, turned: bool) -> tuple[Curve, ...]:
    """Return the curves of an edge, run backwards if it is used that way."""
    adaptor = BRepAdaptor_Curve(edge)
    run = _curves(adaptor, adaptor.FirstParameter(), adaptor.LastParameter())
    return tuple(backwards(curve) for curve in run[::-1]) if turned else run


def _curves(adaptor: object, first: float, last: float) -> tuple[Curve, ...]:
    """Return the part of a curve between two parameters: a line, an arc of a circle or ellipse, or Bezier pieces."""
    match adaptor.GetType():  # type: ignore[attr-defined]
        case Curves.GeomAbs_Line:
            return (straight(*(_vector(adaptor.Value(t)) for t in (first, last))),)  # type: ignore[attr-defined]
        case Curves.GeomAbs_Circle:
            circle = adaptor.Circle()  # type: ignore[attr-defined]
            return (_ring(circle.Position(), circle.Radius(), circle.Radius(), first, last - first),)
        case Curves.GeomAbs_Ellipse:
            ellipse = adaptor.Ellipse()  # type: ignore[attr-defined]
            return (_ring(ellipse.Position(), ellipse.MajorRadius(), ellipse.MinorRadius(), first, last - first),)
    return _spline(adaptor, first, last)


def _spline(adaptor: object, first: float, last: float) -> tuple[Curve, ...]:
    """Return the part of any other curve between two parameters as Bezier pieces."""
    if adaptor.GetType() == Curves.GeomAbs_BSplineCurve:  # type: ignore[attr-defined]
        spline = adaptor.BSpline()  # type: ignore[attr-defined]
    else:
        curve = adaptor.GeomCurve().Transformed(adaptor.Trsf())  # type: ignore[attr-defined]
        spline = GeomConvert.CurveToBSplineCurve_s(Geom_TrimmedCurve(curve, first, last))
    if spline.IsPeriodic() or (spline.FirstParameter(), spline.LastParameter()) != (first, last):
        spline = spline.Copy()
        spline.Segment(first, last)
    count = range(1, spline.NbPoles() + 1)
    weights = [spline.Weight(i) for i in count] if spline.IsRational() else None
    points = np.array([_vector(spline.Pole(i)) for i in count])
    return pieces(spline.Degree(), _row(spline.KnotSequence()), points, weights)


CRASHES = Standard_Failure, ValueError, RuntimeError
"""What the library, or the values made of what it hands out, raise over a file that makes no sense."""
