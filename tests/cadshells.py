"""Shells of several faces for tests, made with OpenCASCADE: trays, a square-to-round transition, a conical bend; mm."""

from collections.abc import Sequence
from math import cos, pi, sin

import numpy as np
from OCP.BRep import BRep_Builder
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakePolygon, BRepBuilderAPI_Sewing
from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder
from OCP.collections import Array1_double, Array1_int, Array2_double, Array2_gp_Pnt
from OCP.Geom import Geom_BSplineSurface, Geom_ConicalSurface, Geom_CylindricalSurface
from OCP.gp import gp_Ax3, gp_Dir
from OCP.TopoDS import TopoDS, TopoDS_Compound, TopoDS_Shape

from tests.cad import Row, axes, point


def sewn(faces: Sequence[TopoDS_Shape]) -> TopoDS_Shape:
    """Faces as one shell, their common edges shared."""
    sewing = BRepBuilderAPI_Sewing(1e-6)
    for face in faces:
        sewing.Add(face)
    sewing.Perform()
    return sewing.SewedShape()


def loose(faces: Sequence[TopoDS_Shape]) -> TopoDS_Shape:
    """Faces side by side in one file, nothing shared."""
    made, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(made)
    for face in faces:
        builder.Add(made, face)
    return made


def polygon(*corners: Row) -> TopoDS_Shape:
    """The plane face inside a polygon, seen from where it runs counter-clockwise."""
    ring = BRepBuilderAPI_MakePolygon()
    for corner in corners:
        ring.Add(point(corner))
    ring.Close()
    return BRepBuilderAPI_MakeFace(ring.Wire(), True).Face()


def drilled(face: TopoDS_Shape, centre: Row, radius: float) -> TopoDS_Shape:
    """A face with a round hole along z."""
    below = np.asarray(centre, dtype=float) - [0, 0, 50]
    return BRepAlgoAPI_Cut(face, BRepPrimAPI_MakeCylinder(axes(below), radius, 100.0).Shape()).Shape()


def quarter(centre: Row, axis: Row, start: Row, length: float, turn: float = pi / 2) -> TopoDS_Shape:
    """The part of a cylinder about an axis from one point of it on through an angle, seen from outside."""
    arm = np.subtract(start, centre).astype(float)
    frame = gp_Ax3(point(centre), gp_Dir(*map(float, axis)), gp_Dir(*map(float, arm)))
    cylinder = Geom_CylindricalSurface(frame, float(np.linalg.norm(arm)))
    return BRepBuilderAPI_MakeFace(cylinder, 0.0, turn, 0.0, length, 1e-7).Face()


def side(
    along: Row, out: Row, start: Row, length: float, *, radius: float, height: float, wing: float = 0.0
) -> list[TopoDS_Shape]:
    """A bend of a right angle upwards and the flange above it, on the edge from `start` along a direction.

    out: away from the bottom, at right angles to `along`.  wing: how far the flange reaches beyond the bend.
    """
    a, o, up = (np.asarray(row, dtype=float) for row in (along, out, (0, 0, 1)))
    begin = np.asarray(start, dtype=float)
    last = begin + length * a
    bend = quarter(last + radius * up, -a, last, length).Reversed()
    foot, end, high = begin + radius * (o + up), last + radius * (o + up), height * up
    wings = [] if wing == 0.0 else [foot - wing * a, foot - wing * a + high, end + wing * a + high, end + wing * a]
    return [bend, polygon(end, foot, *(wings or [foot + high, end + high]))]


def tray(
    *,
    width: float = 120.0,
    depth: float = 80.0,
    radius: float = 4.0,
    height: float = 25.0,
    hole: float = 10.0,
    wing: float = 0.0,
    sides: int = 4,
) -> list[TopoDS_Shape]:
    """The faces of a tray, seen from inside: a bottom with a hole, four bends and four flanges.

    wing: how far the flanges reach beyond their bends.
    """
    w, d = width, depth
    corners = [(0, 0, 0), (w, 0, 0), (w, d, 0), (0, d, 0)]
    bottom = drilled(polygon(*corners), (w / 3, d / 2, 0), hole)
    ways: list[Row] = [(1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0)]
    made = [bottom]
    for i, (corner, way, length) in enumerate(zip(corners, ways, (w, d, w, d), strict=True)):
        if i >= sides:
            break
        made += side(way, ways[i - 1], corner, length, radius=radius, height=height, wing=wing)
    return made


def lip(along: Row, out: Row, start: Row, length: float, *, radius: float, reach: float) -> list[TopoDS_Shape]:
    """A bend of a right angle outwards on the upper edge of a flange, from `start` along a direction, and the lip."""
    a, o, up = (np.asarray(row, dtype=float) for row in (along, out, (0, 0, 1)))
    begin = np.asarray(start, dtype=float)
    foot = begin + radius * (o + up)
    return [
        quarter(begin + radius * o, a, begin, length),
        polygon(foot + length * a, foot, foot + reach * o, foot + reach * o + length * a),
    ]


def frame(outer: float = 100.0, inner: float = 40.0) -> list[TopoDS_Shape]:
    """Four plane trapezoids round a square hole: a ring that lies flat."""
    far, near = ([(h, -h, 0), (h, h, 0), (-h, h, 0), (-h, -h, 0)] for h in (outer / 2, inner / 2))
    return [polygon(far[i], far[(i + 1) % 4], near[(i + 1) % 4], near[i]) for i in range(4)]


def window(width: float = 120.0, radius: float = 3.0, flange: float = 20.0, splay: float = 10.0) -> list[TopoDS_Shape]:
    """A plate with a window of half its width, and a flange bent up from one edge of the window.

    splay: by how much that edge is shorter than the opposite one, on either side.
    """
    w, a, b = width, width / 4, 3 * width / 4
    ring = BRepBuilderAPI_MakePolygon()
    for corner in ((a + splay, a, 0), (b - splay, a, 0), (b, b, 0), (a, b, 0)):
        ring.Add(point(corner))
    ring.Close()
    plate = BRepBuilderAPI_MakeFace(TopoDS.Face(polygon((0, 0, 0), (w, 0, 0), (w, w, 0), (0, w, 0))))
    plate.Add(TopoDS.Wire(ring.Wire().Reversed()))
    length = b - a - 2 * splay
    return [plate.Face(), *side((-1, 0, 0), (0, 1, 0), (b - splay, a, 0), length, radius=radius, height=flange)]


def cone_to_arc(apex: Row, centre: Row, radius: float, start: float, turn: float = pi / 2) -> TopoDS_Shape:
    """The oblique cone from an apex to an arc of a level circle, as the ruled spline that CAD programs make of it."""
    middle, half = start + turn / 2, turn / 2
    weights = [1.0, cos(half), 1.0]
    rows = [[apex] * 3, [np.add(centre, [radius * r * cos(a), radius * r * sin(a), 0]) for a, r in
                         ((start, 1.0), (middle, 1 / cos(half)), (start + turn, 1.0))]]  # fmt: skip
    poles, row = Array2_gp_Pnt(1, 3, 1, 2), Array2_double(1, 3, 1, 2)
    for j, line in enumerate(rows, 1):
        for i, at in enumerate(line, 1):
            poles.SetValue(i, j, point(at))
            row.SetValue(i, j, weights[i - 1])
    surface = Geom_BSplineSurface(
        poles, row, *(_clamped(k)[0] for k in (2, 1)), *(_clamped(k)[1] for k in (2, 1)), 2, 1
    )
    return BRepBuilderAPI_MakeFace(surface, 1e-7).Face()


def _clamped(degree: int) -> tuple[Array1_double, Array1_int]:
    knots, times = Array1_double(1, 2), Array1_int(1, 2)
    for i in (1, 2):
        knots.SetValue(i, float(i - 1))
        times.SetValue(i, degree + 1)
    return knots, times


def square_to_round(side_mm: float = 100.0, radius: float = 30.0, height: float = 80.0) -> list[TopoDS_Shape]:
    """Four triangles and four oblique cones between a square below and a circle above, seen from outside."""
    h = side_mm / 2
    corners = [(h, h, 0), (-h, h, 0), (-h, -h, 0), (h, -h, 0)]
    tops = [(radius * cos(a), radius * sin(a), height) for a in np.arange(4) * pi / 2]
    made: list[TopoDS_Shape] = []
    for i in range(4):
        made.append(cone_to_arc(corners[i], (0, 0, height), radius, i * pi / 2))
        made.append(polygon(corners[i], corners[(i + 1) % 4], tops[(i + 1) % 4]))
    return made


def conical_bend(
    slant: float = 100.0,
    apex_distance: float = 60.0,
    half_angle: float = pi / 6,
    turn: float = 1.2,
    flange: float = 40.0,
) -> list[TopoDS_Shape]:
    """A part of a right cone about z, its apex at the origin, and a tangent plane at each end; seen from outside."""
    near, far = apex_distance, apex_distance + slant
    frame = gp_Ax3(point((0, 0, 0)), gp_Dir(0, 0, 1), gp_Dir(1, 0, 0))
    surface = Geom_ConicalSurface(frame, half_angle, 0.0)
    cone = BRepBuilderAPI_MakeFace(surface, 0.0, turn, near, far, 1e-7).Face()
    made = [cone]
    for angle, sense in ((0.0, -1.0), (turn, 1.0)):
        ruling = np.array([sin(half_angle) * cos(angle), sin(half_angle) * sin(angle), cos(half_angle)])
        aside = sense * flange * np.array([-sin(angle), cos(angle), 0.0])
        ring = [near * ruling, far * ruling, far * ruling + aside, near * ruling + 0.5 * aside]
        made.append(polygon(*(ring if sense < 0 else ring[::-1])))
    return made
