"""Ruled surfaces, cones and cylinders over any curve, right frusta, and plates.

Cones and cylinders are affine images of their directrix: c0 and c1 of a cone are r + a (apex - r), those of a cylinder
between planes r + d ((P - r).n) / (d.n).  On Bezier curves all of that is exact.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import radians

import numpy as np

from stages.construct.curves import Chain, chain, plane_axes
from stages.construct.quintic import ZERO, Vector, combine, inner, scaling, vector
from stages.geometry.arrays import Array, ArrayValue, Points2, Values, Vector3, cross2, dot, floats, norm, unit
from stages.geometry.curves import contours
from stages.geometry.curves.curves import Along, Bezier, Circular, Curve, affine, exactly
from stages.geometry.curves.plane import CircularArc, PlaneCurve, Segment
from stages.geometry.ruled.ruled import RuledPatch
from stages.model.part import Cone, Cylinder, Plane


def cone_patches(spec: Cone, directrix: Chain) -> tuple[RuledPatch, ...]:
    """Return the cone over every piece of the directrix."""
    apex, (a, b) = vector(spec.apex or ()), (Fraction(f) for f in spec.fraction)
    return tuple(
        RuledPatch(
            affine(r, scaling(1 - a), combine((a, apex))),
            affine(r, scaling(1 - b), combine((b, apex))),
            affine(r, scaling(a - b), combine((b - a, apex))),
        )
        for r in directrix.curves
    )


def frustum(spec: Cone) -> RuledPatch:
    """Return a right circular frustum about z, radius0 at z = 0, its seam at +x."""
    r0, r1, height = (float(value or 0) for value in (spec.radius0, spec.radius1, spec.height))
    sweep = radians(spec.sweep)
    x, y, z = np.eye(3)

    def ring(radius: float, level: float) -> Circular:
        return Circular(level * z, radius * x, radius * y, 0.0 * z, 0.0, sweep)

    return RuledPatch(ring(r0, 0.0), ring(r1, height), ring(r1 - r0, height))


def cylinder_patches(spec: Cylinder, directrix: Chain) -> tuple[RuledPatch, ...]:
    """Return the cylinder over every piece of the directrix, between its two ends."""
    d = vector(spec.direction)
    start = meeting(spec.start_plane, d) if spec.start_plane else (ZERO, Fraction(0))
    if spec.end_plane:
        end = meeting(spec.end_plane, d)
    else:
        size = float(norm(floats(d)))
        end = (start[0], start[1] + exactly([float(spec.length or 0) / size])[0])
    length = combine((1, end[0]), (-1, start[0])), end[1] - start[1]
    return tuple(
        RuledPatch(_slid(r, start, d), _slid(r, end, d), Along(_distance(r, length), floats(d)))
        for r in directrix.curves
    )


Reach = tuple[Vector, Fraction]
"""A step along the direction as a function of the point r it starts from: row . r + constant."""


def meeting(plane: Plane, d: Vector) -> Reach:
    """Return the step along d that reaches the plane: ((P - r).n) / (d.n)."""
    n, point = vector(plane.normal), vector(plane.point)
    across = inner(d, n)
    return combine((-1 / across, n)), inner(point, n) / across


def _slid(r: Curve, reach: Reach, d: Vector) -> Curve:
    """Return r moved along d by its reach."""
    rows = [combine((1, axis), (component, reach[0])) for axis, component in zip(scaling(Fraction(1)), d, strict=True)]
    return affine(r, rows, combine((reach[1], d)))


def _distance(r: Curve, reach: Reach) -> Curve:
    """Return the reach along r as the first coordinate of a curve."""
    return affine(r, (reach[0], ZERO, ZERO), (reach[1], Fraction(0), Fraction(0)))


@dataclass(frozen=True, slots=True, eq=False)
class PlaneFrame:
    """A plane in space: origin and two axes, and how far the given curves leave it, mm."""

    origin: Vector3
    x: Vector3
    y: Vector3
    off_mm: float


@dataclass(frozen=True, slots=True, eq=False)
class Projected(ArrayValue):
    """A space curve seen in a plane frame."""

    curve: Curve
    origin: Vector3
    axes: Array
    reverse: bool = False

    def at(self, t: Values) -> Points2:
        """Return the points at t, mm."""
        v = 1.0 - t if self.reverse else t
        points: Points2 = (self.curve.jet(v, 0)[0] - self.origin) @ self.axes.T
        return points

    def derivative(self, t: Values) -> Points2:
        """Return d/dt of the points, mm."""
        v = 1.0 - t if self.reverse else t
        slopes: Points2 = (-1.0 if self.reverse else 1.0) * self.curve.jet(v, 1)[1] @ self.axes.T
        return slopes


def plane_of(links: Sequence[Chain]) -> PlaneFrame:
    """Return the plane of the first (outline) curve; axes by DXF's arbitrary-axis rule, so z-planes keep x and y."""
    v = np.linspace(0.0, 1.0, 33)
    samples = [np.concatenate([c.jet(v, 0)[0] for c in link.curves]) for link in links]
    middle = samples[0].mean(axis=0)
    turning = np.cross(samples[0] - middle, np.roll(samples[0], -1, axis=0) - middle).sum(axis=0)
    normal = unit(turning)
    if abs(normal[2]) > ALMOST_UPRIGHT:
        normal = np.array([0.0, 0.0, 1.0])
    x, y = plane_axes(normal)
    off = max(float(np.abs(dot(sample - middle, normal)).max()) for sample in samples)
    origin = dot(middle, normal) * normal
    return PlaneFrame(origin, x, y, off)


ALMOST_UPRIGHT = 1.0 - 1e-14
"""A plane this close to z = constant is that plane; its x and y are then those of the job file, unrounded."""


def in_plane(link: Chain, frame: PlaneFrame, *, clockwise: bool) -> tuple[PlaneCurve, ...]:
    """Return the edges of a closed chain in the plane, run in the asked sense."""
    edges = plane_edges(link, frame.origin, np.stack([frame.x, frame.y]))
    if (contours.area(edges) < 0.0) == clockwise:
        return edges
    return tuple(_reversed(edge) for edge in edges[::-1])


def plane_edges(link: Chain, origin: Vector3, axes: Array) -> tuple[PlaneCurve, ...]:
    """Return a chain as seen along the normal of a plane, in its axes, shape (2, 3)."""
    return tuple(_edge(curve, origin, axes) for curve in link.curves)


def _edge(curve: Curve, origin: Vector3, axes: Array) -> PlaneCurve:
    """Return a curve in the plane; straight lines and circular arcs are recognised by their data."""
    if isinstance(curve, Bezier) and len(curve.points) == len("ab"):
        start, end = (curve.points - origin) @ axes.T
        return Segment(start, end)
    if isinstance(curve, Circular):
        u, v = axes @ curve.U, axes @ curve.V
        radius = float(norm(u))
        round_enough = abs(float(norm(v)) - radius) * radius + abs(float(dot(u, v))) <= ROUND * radius**2
        if radius > 0.0 and round_enough and not curve.W.any():
            sense = np.sign(cross2(u, v))
            first = float(np.arctan2(u[1], u[0]) + sense * curve.start)
            return CircularArc(axes @ (curve.centre - origin), radius, first, float(sense * curve.sweep))
    return Projected(curve, origin, axes)


ROUND = 1e-14
"""Semi-axes that differ by less than this share are those of a circle."""


def _reversed(edge: PlaneCurve) -> PlaneCurve:
    if isinstance(edge, Segment):
        return Segment(edge.end, edge.start)
    if isinstance(edge, CircularArc):
        return CircularArc(edge.centre, edge.radius, edge.start_rad + edge.sweep_rad, -edge.sweep_rad)
    if isinstance(edge, Projected):
        return Projected(edge.curve, edge.origin, edge.axes, not edge.reverse)
    raise ValueError(f"no reverse of a {type(edge).__name__}")


def closed_chain(link: Chain) -> float:
    """Return the distance between the last and the first point of a chain, mm."""
    first = link.curves[0].jet(np.array([0.0]), 0)[0]
    last = link.curves[-1].jet(np.array([1.0]), 0)[0]
    return float(norm(first - last)[0])


def directrix_of(spec: Cone | Cylinder) -> Chain:
    """Return the directrix of a general cone or of a cylinder."""
    if spec.directrix is None:
        raise ValueError("a cone without a directrix passed the checks of the job file")
    return chain(spec.directrix)
