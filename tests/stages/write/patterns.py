"""Patterns to write: a plate with a hole, a sector of a ring, a strip with a wavy edge."""

from math import pi

import numpy as np

from stages.geometry.curves.plane import CircularArc, PlaneCurve, Segment
from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath
from stages.geometry.paths.biarc import trace
from stages.model.pattern import Contour, FlatPattern, Mark
from stages.model.sheet import Nesting, Placement, Sheet, SheetLayout
from tests.stages.geometry.plane_curves import SINE, TAU, Formula

CHORD_MM = 0.02


def polygon_edges(*corners: tuple[float, float]) -> list[PlaneCurve]:
    points = np.array(corners, dtype=np.float64)
    return [Segment(points[i], points[(i + 1) % len(points)]) for i in range(len(points))]


def contour(edges: list[PlaneCurve]) -> Contour:
    return Contour(tuple(edges), trace(edges, accuracy=CHORD_MM), CHORD_MM)


def hole(x: float, y: float, radius: float) -> Contour:
    return contour([CircularArc(np.array([x, y]), radius, 0.0, -TAU)])


def line_mark(*points: tuple[float, float]) -> Mark:
    return Mark("ruling", ArcPath(np.array(points, dtype=np.float64), np.zeros(len(points)), closed=False))


def pattern(
    part: str, outer: Contour, label: tuple[float, float], *inner: Contour, marks: tuple[Mark, ...] = ()
) -> FlatPattern:
    return FlatPattern(part, 1, outer, inner, marks, np.array(label), np.zeros((4, 2)))


def plate(part: str = "plate") -> FlatPattern:
    """Return 100 x 60 with two holes and two marks."""
    outer = contour(polygon_edges((0.0, 0.0), (100.0, 0.0), (100.0, 60.0), (0.0, 60.0)))
    marks = (line_mark((20.0, 10.0), (20.0, 50.0)), line_mark((90.0, 10.0), (95.0, 10.0), (95.0, 20.0)))
    return pattern(part, outer, (45.0, 20.0), hole(50.0, 40.0, 10.0), hole(80.0, 20.0, 4.0), marks=marks)


def sector(part: str = "sector") -> FlatPattern:
    """Return a third of a ring, radii 50 and 100."""
    outside = CircularArc(np.zeros(2), 100.0, 0.0, 2.0 * pi / 3.0)
    inside = CircularArc(np.zeros(2), 50.0, 2.0 * pi / 3.0, -2.0 * pi / 3.0)
    ends = outside.at(np.array([0.0, 1.0])), inside.at(np.array([0.0, 1.0]))
    edges = [outside, Segment(ends[0][1], ends[1][0]), inside, Segment(ends[1][1], ends[0][0])]
    return pattern(part, contour(edges), (37.5, 65.0))


def fan(part: str = "fan") -> FlatPattern:
    """Return a sixth of a disc with an edge of no length at its middle, as a cone cut at its apex has one."""
    rim = CircularArc(np.zeros(2), 90.0, 0.0, pi / 3.0)
    first, last = rim.at(np.array([0.0, 1.0]))
    edges = [rim, Segment(last, np.zeros(2)), Segment(np.zeros(2), np.array([0.0, 1e-13])), Segment(np.zeros(2), first)]
    return pattern(part, contour(edges), (50.0, 30.0))


def strip(part: str = "strip") -> FlatPattern:
    """Return a truncated cylinder, unrolled, with a hole."""
    ends = SINE.at(np.array([0.0, 1.0]))
    width = float(ends[1, 0])
    edges: list[PlaneCurve] = [SINE, *polygon_edges((width, 0.0), (width, 300.0), (0.0, 300.0), (0.0, 0.0))[:3]]
    return pattern(part, contour(edges), (150.0, 200.0), hole(300.0, 250.0, 20.0))


def drop() -> FlatPattern:
    """Return a smooth closed curve by one formula."""
    curve = Formula(
        lambda t: 40.0 * np.exp(1j * TAU * t) + 8.0 * np.exp(-2j * TAU * t),
        lambda t: TAU * 1j * (40.0 * np.exp(1j * TAU * t) - 16.0 * np.exp(-2j * TAU * t)),
    )
    return pattern("drop", contour([curve]), (0.0, 0.0))


def nesting() -> Nesting:
    """Return two sheets with plates and sectors, turned and mirrored."""
    sheet = Sheet("stock", 500.0, 300.0)
    first = (
        Placement("plate", 1, Rigid2(10.0, 10.0)),
        Placement("plate", 2, Rigid2(250.0, 10.0, 90.0)),
        Placement("sector", 1, Rigid2(120.0, 120.0, 33.0)),
        Placement("sector", 2, Rigid2(400.0, 120.0, 33.0, mirrored=True)),
    )
    second = (Placement("plate", 3, Rigid2(110.0, 10.0, 0.0, mirrored=True)),)
    return Nesting((SheetLayout(sheet, 1, first, 0.2), SheetLayout(sheet, 2, second, 0.05)))
