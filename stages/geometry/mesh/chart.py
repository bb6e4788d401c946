"""Cylinders and cones in the plane: exact flat positions of a mesh's vertices, and the ruled patch that goes with them.

    unrolled(mesh, found) -> Unrolled        chart(unrolled, low, high) -> Rectangle | Sector

A cylinder rolls off into x along its rulings and y = radius * angle, a cone into polar coordinates about its apex:
slant height s and the angle phi = angle * sin(half angle).  The angle round the axis is followed from vertex to vertex,
so a tube that is cut open has all of its turn.  Both ways are closed forms: a curve of the plane (a line, an arc, a
spline through boundary points) has its exact place in u and v, by which `model.surface.Trim` carries it.

The flat frame is seen from the side of p x c0', which is the mesh's outside.  Not for a tube without a cut, and not
for a cone with its apex inside the mesh.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.polynomial import chebyshev
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order

from stages.geometry.arrays import (
    Array,
    ArrayValue,
    Mask,
    Points2,
    Triples,
    Values,
    Vector2,
    dot,
    norm,
)
from stages.geometry.curves.curves import Circular
from stages.geometry.curves.plane import PlaneCurve, Segment
from stages.geometry.curves.planespline import Spline
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.primitives import Rotational, facets, frame_about, normals
from stages.geometry.ruled.ruled import RuledPatch, between


@runtime_checkable
class Placing(Protocol):
    """Where flat points are in u and v."""

    def places(self, points: Points2) -> Points2:
        """Return u and v of flat points; NaN where v is not defined (an apex)."""
        ...

    def rates(self, points: Points2, slopes: Points2) -> Points2:
        """Return the rates of u and v at flat points that move."""
        ...


@runtime_checkable
class Chart(Placing, Protocol):
    """A developable in the plane, with the places of its flat points in u and v."""

    @property
    def patch(self) -> RuledPatch:
        """The surface."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class Pulled(ArrayValue):
    """A curve of the plane as a curve of u and v."""

    chart: Placing
    edge: PlaneCurve

    @property
    def breaks(self) -> Values:
        """Return where the curve is not smooth."""
        return self.edge.breaks if isinstance(self.edge, Spline) else np.array([0.0, 1.0])

    def at(self, t: Values) -> Points2:
        """Return u and v at t."""
        places = self.chart.places(self.edge.at(t))
        lost = np.isnan(places[:, 1])
        if lost.any():
            beside = self.edge.at(np.clip(t[lost], BESIDE, 1.0 - BESIDE))
            places[lost, 1] = self.chart.places(beside)[:, 1]
        return places

    def derivative(self, t: Values) -> Points2:
        """Return d/dt of u and v; beside an apex, where v has none."""
        t = np.clip(t, BESIDE, 1.0 - BESIDE)
        return self.chart.rates(self.edge.at(t), self.edge.derivative(t))


BESIDE = 1e-9
"""How far inside an edge its direction at an apex is looked for."""


@dataclass(frozen=True, slots=True, eq=False)
class Rectangle(ArrayValue):
    """A cylinder in the plane: u and v run from `low` to `high`, x and y in mm."""

    patch: RuledPatch
    low: Vector2
    high: Vector2

    def places(self, points: Points2) -> Points2:
        """Return u and v of flat points."""
        placed: Points2 = (points - self.low) / (self.high - self.low)
        return placed

    def rates(self, points: Points2, slopes: Points2) -> Points2:
        """Return the rates of u and v at flat points that move."""
        moving: Points2 = slopes / (self.high - self.low)
        return moving


@dataclass(frozen=True, slots=True, eq=False)
class Sector(ArrayValue):
    """A cone in the plane about its apex, its middle along x: u and v run from `low` to `high`, in s (mm) and phi.

    way: +1 where s grows with u; -1 where it falls, and phi is counted clockwise.
    """

    patch: RuledPatch
    low: Vector2
    high: Vector2
    way: float

    def places(self, points: Points2) -> Points2:
        """Return u and v of flat points; v is NaN at the apex."""
        slant = norm(points)
        angle = np.arctan2(self.way * points[:, 1], points[:, 0])
        lost = slant <= APEX * max(abs(self.low[0]), abs(self.high[0]))
        polar = np.column_stack([slant, np.where(lost, np.nan, angle)])
        placed: Points2 = (polar - self.low) / (self.high - self.low)
        return placed

    def rates(self, points: Points2, slopes: Points2) -> Points2:
        """Return the rates of u and v at flat points that move."""
        slant = norm(points)
        outward = dot(points, slopes) / slant
        turning = self.way * (points[:, 0] * slopes[:, 1] - points[:, 1] * slopes[:, 0]) / slant**2
        moving: Points2 = np.column_stack([outward, turning]) / (self.high - self.low)
        return moving


APEX = 1e-13
"""A point nearer to the apex, as a share of the largest slant height, is the apex."""


@dataclass(frozen=True, slots=True, eq=False)
class Unrolled(ArrayValue):
    """The vertices of a mesh in the plane of its cylinder or cone.

    frame: x, y and the axis as rows; angles are counted from x about the axis.
    polar: coordinate along the ruling (mm) and angle round the axis (rad), shape (n, 2); NaN angle at an apex.
    flat: positions, mm.  middle: the angle that lies along x in the plane of a cone.  way: see `Sector`.
    """

    found: Rotational
    frame: Array
    polar: Points2
    flat: Points2
    middle: float
    way: float


def unrolled(mesh: Mesh, found: Rotational) -> Unrolled:
    """Return the vertices of a mesh in the plane of the surface that they lie on."""
    frame = np.stack([*frame_about(found.axis), found.axis])
    centres, areas = facets(mesh)
    outside = float(np.sign(dot(areas, normals(found, centres)).sum()))
    offset = (mesh.vertices - found.point) @ frame.T
    away = norm(offset[:, :2])
    angle = np.arctan2(offset[:, 1], offset[:, 0])
    cosine, sine = np.cos(found.half_angle_rad), np.sin(found.half_angle_rad)
    along = offset[:, 2] * cosine + away * sine if sine else offset[:, 2]
    apex = None
    if sine:
        along = along + found.radius / np.tan(found.half_angle_rad) * cosine
        apex = away <= AT_APEX * float(away.max())
    angle = _followed(mesh.faces, angle, apex)
    middle = float(np.nanmin(angle) + np.nanmax(angle)) / 2.0
    # p x c0' points to the axis where s grows with u: the rulings run the other way on a mesh that faces outward
    way = -outside
    if sine:
        phi = way * np.where(np.isnan(angle), 0.0, (angle - middle) * sine)
        flat = along[:, None] * np.column_stack([np.cos(phi), np.sin(phi)])
    else:
        flat = np.column_stack([way * along, found.radius * (angle - middle)])
    return Unrolled(found, frame, np.column_stack([along, angle]), flat, middle, way)


AT_APEX = 1e-9
"""A vertex nearer to the axis, as a share of the farthest, is at the apex: its angle is rounding."""


def _followed(faces: Triples, angle: Values, left_out: Mask | None) -> Values:
    """Return angles made continuous along the edges of a mesh, in steps below pi; NaN at vertices that are left out."""
    start, end = faces.ravel(), faces[:, [1, 2, 0]].ravel()
    if left_out is not None:
        kept = ~(left_out[start] | left_out[end])
        start, end = start[kept], end[kept]
    graph = coo_array((np.ones(start.size), (start, end)), shape=(angle.size, angle.size)).tocsr()
    order, before = breadth_first_order(graph, int(start[0]), directed=False)
    parent = np.arange(angle.size)
    parent[order[1:]] = before[order[1:]]
    step = angle - angle[parent]
    total = step - 2.0 * np.pi * np.round(step / (2.0 * np.pi))
    # each pass doubles the length of the way to the root that has been added up
    while not np.array_equal(parent, parent[parent]):
        total, parent = total + total[parent], parent[parent]
    followed = np.full(angle.size, np.nan)
    followed[order] = angle[order[0]] + total[order]
    return followed


def chart(made: Unrolled, low: Vector2, high: Vector2) -> Rectangle | Sector:
    """Return the chart over a range: along the ruling in mm and round the axis in rad, as in `Unrolled.polar`."""
    first, last = (low[0], high[0]) if made.way > 0.0 else (high[0], low[0])
    c0, c1 = (_circle(made, float(along), float(low[1]), float(high[1])) for along in (first, last))
    patch = between(c0, c1)
    sine = float(np.sin(made.found.half_angle_rad))
    turns = (np.array([low[1], high[1]]) - made.middle) * (sine or made.found.radius)
    if sine:
        return Sector(patch, np.array([first, turns[0]]), np.array([last, turns[1]]), made.way)
    return Rectangle(patch, np.array([made.way * first, turns[0]]), np.array([made.way * last, turns[1]]))


def _circle(made: Unrolled, along: float, start: float, end: float) -> Circular:
    """Return the circle of the surface at a place along its rulings."""
    found, (x, y, axis) = made.found, made.frame
    if not found.half_angle_rad:
        centre, radius = found.point + along * axis, found.radius
    else:
        slope = np.cos(found.half_angle_rad)
        centre = found.point + (along * slope - found.radius / np.tan(found.half_angle_rad)) * axis
        radius = along * float(np.sin(found.half_angle_rad))
    return Circular(centre, radius * x, radius * y, np.zeros(3), start, end - start)


def pulled(held: Chart, edges: Sequence[PlaneCurve]) -> tuple[PlaneCurve, ...]:
    """Return a closed loop of the plane in u and v: rulings as straight edges, an apex as the stretch of v at it."""
    made = [_straightened(held, edge) for edge in edges]
    ends = [edge.at(np.array([0.0, 1.0])) for edge in made]
    loop: list[PlaneCurve] = []
    for edge, (here, there) in zip(made, pairwise([*ends, ends[0]]), strict=True):
        loop.append(edge)
        if np.abs(there[0] - here[1]).max() > MEETS:
            loop.append(Segment(here[1], there[0]))
    return tuple(loop)


MEETS = 1e-7
"""Ends of edges that are farther apart in u or v are at an apex, where v jumps."""


def _straightened(held: Chart, edge: PlaneCurve) -> PlaneCurve:
    """Return an edge in u and v, as a segment where it is straight there."""
    curve = Pulled(held, edge)
    if not isinstance(edge, Segment):
        return curve
    t = np.linspace(0.0, 1.0, LINE_SAMPLES)
    places: Points2 = curve.at(t)
    line = Segment(places[0], places[-1])
    return line if np.abs(places - line.at(t)).max() <= ON_LINE else curve


LINE_SAMPLES, ON_LINE = 9, 1e-12
"""Places on an edge, and what it may be off in u or v."""


@dataclass(frozen=True, slots=True, eq=False)
class Series(ArrayValue):
    """A curve of u and v by Chebyshev coefficients over t from 0 to 1, shape (k, 2)."""

    coefficients: Array

    def at(self, t: Values) -> Points2:
        """Return u and v at t."""
        points: Points2 = chebyshev.chebval(2.0 * t - 1.0, self.coefficients).T
        return points

    def derivative(self, t: Values) -> Points2:
        """Return d/dt of u and v."""
        slopes: Points2 = 2.0 * chebyshev.chebval(2.0 * t - 1.0, chebyshev.chebder(self.coefficients)).T
        return slopes


def interpolated(held: Chart, edge: PlaneCurve, count: int) -> PlaneCurve:
    """Return a smooth edge of the plane in u and v by its values at `count` Chebyshev points; straight if it is so."""
    nodes = chebyshev.chebpts2(count)
    places = held.places(edge.at((nodes + 1.0) / 2.0))
    line = Segment(places[0], places[-1])
    if np.abs(places - line.at((nodes + 1.0) / 2.0)).max() <= ON_LINE:
        return line
    return Series(np.linalg.solve(chebyshev.chebvander(nodes, count - 1), places))
