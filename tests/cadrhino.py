"""CAD files for tests, written by Rhino's own library; shapes in mm unless said otherwise."""

from collections.abc import Sequence
from math import pi
from pathlib import Path

import rhino3dm

from tests.cad import Row


def rhino(file: Path, *things: object, unit: str = "Millimeters", name: str = "") -> Path:
    """Write a 3DM file of breps, extrusions and surfaces."""
    model = rhino3dm.File3dm()
    model.Settings.ModelUnitSystem = getattr(rhino3dm.UnitSystem, unit)
    attributes = rhino3dm.ObjectAttributes()
    attributes.Name = name
    for thing in things:
        model.Objects.Add(thing, attributes)
    assert model.Write(str(file), 8)
    return file


def rhino_pipe(radius: float = 20.0, height: float = 50.0) -> rhino3dm.Brep:
    """A closed cylinder about z."""
    circle = rhino3dm.Circle(rhino3dm.Point3d(0, 0, 0), radius)
    return rhino3dm.Brep.CreateFromCylinder(rhino3dm.Cylinder(circle, height), True, True)


def rhino_cone(radius: float = 30.0, height: float = 40.0) -> rhino3dm.Brep:
    """A cone from its apex at the origin to an open circle at `height`."""
    origin = rhino3dm.Point3d(0, 0, 0)
    side = rhino3dm.LineCurve(origin, rhino3dm.Point3d(radius, 0, height))
    axis = rhino3dm.Line(origin, rhino3dm.Point3d(0, 0, 1))
    return rhino3dm.Brep.CreateFromRevSurface(rhino3dm.RevSurface.Create(side, axis, 0.0, 2 * pi), False, False)


def rhino_spline(points: Sequence[Row], degree: int = 3) -> rhino3dm.Curve:
    """A clamped B-spline with even knots."""
    return rhino3dm.Curve.CreateControlPointCurve([rhino3dm.Point3d(*map(float, row)) for row in points], degree)


def rhino_ruled(one: Sequence[Row], other: Sequence[Row], degree: int = 3) -> rhino3dm.NurbsSurface:
    """The ruled surface between two splines."""
    return rhino3dm.NurbsSurface.CreateRuledSurface(rhino_spline(one, degree), rhino_spline(other, degree))


def rhino_extrusion(points: Sequence[Row], height: float) -> rhino3dm.Extrusion:
    """The planar polyline through points in z = 0, extruded along z."""
    line = rhino3dm.Polyline(len(points))
    for row in points:
        line.Add(*(float(x) for x in row))
    return rhino3dm.Extrusion.Create(line.ToPolylineCurve(), height, False)
