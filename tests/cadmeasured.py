"""CAD files and shapes as OpenCASCADE itself reads and measures them."""

from itertools import pairwise
from pathlib import Path

import numpy as np
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.BRepGProp import BRepGProp
from OCP.GeomAbs import GeomAbs_SurfaceType
from OCP.GeomConvert import GeomConvert
from OCP.GProp import GProp_GProps
from OCP.IGESControl import IGESControl_Reader
from OCP.STEPControl import STEPControl_Reader
from OCP.TopoDS import TopoDS_Face, TopoDS_Shape

from tests.cad import silent


def area(shape: TopoDS_Shape, eps: float = 1e-12) -> float:
    """Return the area that OpenCASCADE measures to a relative error."""
    found = GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, found, eps)
    return float(found.Mass())


def fine_area(face: TopoDS_Face) -> float:
    """Return the area that OpenCASCADE measures; of a spline face, which fills its surface, over 16 pieces per knot.

    Over whole pieces its quadrature stops at 3e-9 whatever is asked of it.
    """
    surface = BRepAdaptor_Surface(face)
    if surface.GetType() in (GeomAbs_SurfaceType.GeomAbs_Plane, *QUADRICS):
        return area(face)
    fine = GeomConvert.SurfaceToBSplineSurface_s(surface.GeomSurface())
    for knots, insert in ((fine.UKnots(), fine.InsertUKnot), (fine.VKnots(), fine.InsertVKnot)):
        rows = [knots.Value(i) for i in range(knots.Lower(), knots.Upper() + 1)]
        for a, b in pairwise(rows):
            for share in np.arange(1, 16) / 16:
                insert(float(a + share * (b - a)), 1, 1e-12, False)
    return area(BRepBuilderAPI_MakeFace(fine, 1e-7).Face())


QUADRICS = GeomAbs_SurfaceType.GeomAbs_Cylinder, GeomAbs_SurfaceType.GeomAbs_Cone


def reread(file: Path) -> TopoDS_Shape:
    """Return what OpenCASCADE itself makes of a file."""
    reader = STEPControl_Reader() if file.suffix == ".step" else IGESControl_Reader()
    with silent():
        reader.ReadFile(str(file))
        reader.TransferRoots()
    return reader.OneShape()
