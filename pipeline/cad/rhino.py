"""3DM files -> faces as plain values, by Rhino's own library (the only place that imports rhino3dm).

    faces(file) -> CadBody

Breps, extrusions and surfaces in the order of the file, blocks where they are inserted; other objects hold no faces.
Every surface that is no plane is taken in its NURBS form, which is exact.  The unit is that of the file's header.
Runs in a child process (`pipeline.cad.files`): a broken file may crash the library.
"""

from collections.abc import Iterator

import numpy as np
import rhino3dm

from stages.construct.faces.spline import pieces, straight
from stages.geometry.arrays import Array, Vector3, norm, unit
from stages.geometry.curves.curves import Circular, Curve
from stages.geometry.ruled.backwards import backwards
from stages.model.cadface import CadBody, CadEdge, CadFace, CadNet

Units = rhino3dm.UnitSystem
MM = {
    Units.Microns: 1e-3, Units.Millimeters: 1.0, Units.Centimeters: 10.0, Units.Decimeters: 100.0,
    Units.Meters: 1000.0, Units.Mils: 0.0254, Units.Inches: 25.4, Units.Feet: 304.8, Units.Yards: 914.4,
    Units.Microinches: 25.4e-6, Units.Kilometers: 1e6,
}  # fmt: skip
FLAT = 1e-9
"""What a surface may differ by, in the file's unit, from the sphere or torus that it is called."""
ROUND = 1e-12
"""Share of its radius by which an edge may leave a circle that is one: rounding of its control points."""
DEEPEST = 64
"""Blocks within blocks; more is a block that holds itself."""
MOST_INSERTED = 20_000
"""Objects of blocks, each counted as often as it is inserted: blocks within blocks multiply, 20 doublings make a
million.  A part that is cut from sheets has some hundreds."""


class UnreadableCadError(Exception):
    """The library cannot read the file."""


def faces(file: str) -> CadBody:
    """Return the faces of a file; lengths in mm."""
    model = rhino3dm.File3dm.Read(file)
    if model is None:
        raise UnreadableCadError("it cannot be read")
    system = model.Settings.ModelUnitSystem
    if system not in MM:
        known = ", ".join(unit_.name for unit_ in MM)
        raise UnreadableCadError(f"its unit is {system.name}, and units read here are {known}")
    found: list[CadFace] = []
    for name, brep in _breps(model):
        for i in range(len(brep.Faces)):
            found.append(_face(len(found), name, brep, brep.Faces[i], MM[system]))
    return CadBody(tuple(found))


def _breps(model: rhino3dm.File3dm) -> Iterator[tuple[str, rhino3dm.Brep]]:
    """Yield every body with the name of its object."""
    entries = [entry for entry in model.Objects if not entry.Attributes.IsInstanceDefinitionObject]
    known: dict[str, int] = {}
    inserted = sum(_inserted(model, entry, known, 0) for entry in entries)
    if inserted > MOST_INSERTED:
        raise UnreadableCadError(f"its blocks insert {inserted:.4g} objects; read here are at most {MOST_INSERTED}")
    for entry in entries:
        yield from _bodies(model, entry)


def _inserted(model: rhino3dm.File3dm, entry: rhino3dm.File3dmObject, known: dict[str, int], depth: int) -> int:
    """Return how many objects an object inserts; each block is counted once, and is `known` after that."""
    if depth > DEEPEST:
        raise UnreadableCadError(f"its blocks are nested more than {DEEPEST} deep")
    thing = entry.Geometry
    if not isinstance(thing, rhino3dm.InstanceReference):
        return 0
    name = str(thing.ParentIdefId)
    if name not in known:
        known[name] = sum(1 + _inserted(model, inner, known, depth + 1) for inner in _block(model, thing))
    return known[name]


def _block(model: rhino3dm.File3dm, reference: rhino3dm.InstanceReference) -> list[rhino3dm.File3dmObject]:
    """Return the objects of the block that is inserted."""
    block = model.InstanceDefinitions.FindId(reference.ParentIdefId)
    found = [] if block is None else [model.Objects.FindId(str(inner)) for inner in block.GetObjectIds()]
    if block is None or None in found:
        raise UnreadableCadError("it inserts a block that it does not hold")
    return found


def _bodies(model: rhino3dm.File3dm, entry: rhino3dm.File3dmObject) -> Iterator[tuple[str, rhino3dm.Brep]]:
    thing, name = entry.Geometry, entry.Attributes.Name
    if isinstance(thing, rhino3dm.InstanceReference):
        for inner in _block(model, thing):
            for inner_name, brep in _bodies(model, inner):
                moved = brep.Duplicate()
                moved.Transform(thing.Xform)
                yield inner_name, moved
    elif isinstance(thing, rhino3dm.Brep):
        yield name, thing
    elif isinstance(thing, rhino3dm.Extrusion):
        yield name, thing.ToBrep(True)
    elif isinstance(thing, rhino3dm.Surface):
        yield name, rhino3dm.Brep.CreateFromSurface(thing)


def _vector(thing: object, mm: float = 1.0) -> Vector3:
    """Return a point or vector of the library, times `mm`."""
    return mm * np.array([thing.X, thing.Y, thing.Z])  # type: ignore[attr-defined]


def _face(index: int, name: str, brep: rhino3dm.Brep, face: rhino3dm.BrepFace, mm: float) -> CadFace:
    middle = [(face.Domain(i).T0 + face.Domain(i).T1) / 2.0 for i in (0, 1)]
    sign = -1.0 if face.OrientationIsReversed else 1.0
    loops = [face.Loops[i] for i in range(len(face.Loops))]
    loops.sort(key=lambda loop: loop.LoopType != rhino3dm.BrepLoopType.Outer)
    net = _net(face.ToNurbsSurface(), mm)
    return CadFace(
        index,
        name,
        _sort(face),
        None if face.IsSphere(FLAT) or face.IsTorus(FLAT) else net,
        _vector(face.PointAt(*middle), mm),
        sign * unit(_vector(face.NormalAt(*middle))),
        tuple(_loop(brep, loop, mm) for loop in loops),
    )


def _sort(face: rhino3dm.BrepFace) -> str:
    """Return what the library recognises the surface as, in words."""
    known = {
        "plane": face.IsPlanar, "cylinder": face.IsCylinder, "cone": face.IsCone, "sphere": face.IsSphere,
        "torus": face.IsTorus,
    }  # fmt: skip
    return next((name for name, is_one in known.items() if is_one(FLAT)), "NURBS surface")


def _net(surface: rhino3dm.NurbsSurface, mm: float) -> CadNet:
    """Return a NURBS surface; openNURBS leaves out the first and the last knot, which no point depends on."""
    points, n, m = surface.Points, surface.Points.CountU, surface.Points.CountV
    grid = [(i, j) for i in range(n) for j in range(m)]
    return CadNet(
        surface.OrderU - 1,
        surface.OrderV - 1,
        _knots(surface.KnotsU),
        _knots(surface.KnotsV),
        np.array([_vector(points.GetPoint(i, j), mm) for i, j in grid]).reshape(n, m, 3),
        np.array([points.GetControlPoint(i, j).W for i, j in grid]).reshape(n, m),
    )


def _knots(knots: object) -> Array:
    inner = [float(knots[i]) for i in range(len(knots))]  # type: ignore[arg-type, index]
    return np.array([inner[0], *inner, inner[-1]])


def _loop(brep: rhino3dm.Brep, loop: rhino3dm.BrepLoop, mm: float) -> tuple[CadEdge, ...]:
    """Return the edges of a loop in its order; those without length (at an apex) are left out."""
    trims = [loop.Trims[i] for i in range(len(loop.Trims))]
    return tuple(_edge(brep, trim, mm) for trim in trims if trim.EdgeIndex >= 0)


def _edge(brep: rhino3dm.Brep, trim: rhino3dm.BrepTrim, mm: float) -> CadEdge:
    run = _curves(brep.Edges[trim.EdgeIndex], mm)
    turned = tuple(backwards(curve) for curve in run[::-1]) if trim.IsReversed else run
    return CadEdge(trim.EdgeIndex, turned)


def _curves(edge: rhino3dm.BrepEdge, mm: float) -> tuple[Curve, ...]:
    """Return an edge: a line, a circular arc, or Bezier pieces."""
    spline = edge.ToNurbsCurve()
    count = range(len(spline.Points))
    points, weights = [spline.Points[i] for i in count], [spline.Points[i].W for i in count]
    places = np.array([mm * _vector(p) / p.W for p in points])
    if len(places) == len("ab"):
        return (straight(*places),)
    run = pieces(spline.Degree, _knots(spline.Knots), places, weights)
    arc = edge.TryGetArc() if spline.IsRational else None
    return run if arc is None else (_arc(arc, mm, run) or run)


def _arc(arc: rhino3dm.Arc, mm: float, run: tuple[Curve, ...]) -> tuple[Curve, ...] | None:
    """Return the arc as such if the edge is one to rounding."""
    frame, domain = arc.Plane, arc.AngleDomain
    x, y = (mm * arc.Radius * _vector(axis) for axis in (frame.XAxis, frame.YAxis))
    made = Circular(_vector(arc.Center, mm), x, y, np.zeros(3), domain.T0, domain.T1 - domain.T0)
    ends = np.array([0.0, 1.0])
    v = np.linspace(0.0, 1.0, 9)
    first, last = run[0].jet(ends, 0)[0][0], run[-1].jet(ends, 0)[0][1]
    off = [norm(norm(curve.jet(v, 0)[0] - made.centre) - mm * arc.Radius) for curve in run]
    apart = norm(made.jet(ends, 0)[0] - np.stack([first, last])).max()
    return (made,) if max(*off, apart) <= ROUND * (mm * arc.Radius + norm(made.centre)) else None
