"""From a rectangle to a round: five flat triangles (the first and last are halves of one) and four oblique cones.

The rectangle lies at z = 0 about the origin, sides a along x and b along y.  The round's plane is turned about y by
the tilt:  c(t) = M + R (cos(t) X + sin(t) Y),  X = (cos tilt, 0, -sin tilt), Y = (0, 1, 0).  A triangle stands on each
side, with its tip where the plane through the side touches the round: there c' lies in that plane.

    sides along y:            t = 0 and t = pi
    sides along x, at y = Q:  h cos t + (Q - My) sin(tilt) sin t = R sin(tilt),  h = Mz

Between two tips the surface is the cone over the round with its apex in the corner between.  The whole is the lateral
surface of a convex hull, tangent planes continuous throughout, as long as the rectangle and the round lie each on one
side of the other's plane; what is not so is refused with the height that would do.
"""

from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import acos, atan2, cos, hypot, pi, radians, sin, tan

import numpy as np

from stages.geometry.arrays import ArrayValue, Vector3
from stages.geometry.curves.curves import Circular, bezier, exactly
from stages.geometry.ruled.ruled import RuledPatch, between
from stages.model.ducts import Transition
from stages.model.report import Finding


@dataclass(frozen=True, slots=True, eq=False)
class Round(ArrayValue):
    """The round: centre, axes of length R (mm) and tilt (rad)."""

    centre: Vector3
    x: Vector3
    y: Vector3
    tilt_rad: float

    def at(self, t: float) -> Vector3:
        """Return the point at the angle t, mm; at t = 0 and pi exactly centre + x and centre - x."""
        point: Vector3 = self.centre + cos(t) * self.x + (sin(t) if t % pi else 0.0) * self.y
        return point

    def arc(self, low: float, high: float) -> Circular:
        """Return the round from one angle to another."""
        return Circular(self.centre, self.x, self.y, np.zeros(3), low, high - low)


def transition(spec: Transition) -> tuple[tuple[RuledPatch, ...], tuple[Finding, ...]]:
    """Return the pieces from the seam on, counter-clockwise about z, u from rectangle to round, or a refusal."""
    ring = _round(spec)
    found = _too_low(spec, ring)
    if found:
        return (), found
    a, b = (side / 2 for side in spec.rectangle)
    corners = [(a, b), (-a, b), (-a, -b), (a, -b)]
    angles = [0.0, _touching(ring, float(b), 1.0), pi, 2.0 * pi + _touching(ring, -float(b), -1.0), 2.0 * pi]
    feet = [(a, Fraction(0)), *corners, (a, Fraction(0))]
    triangles = [_triangle(p, q, ring.at(t)) for (p, q), t in zip(pairwise(feet), angles, strict=True)]
    cones = [_cone(corner, ring.arc(*span)) for corner, span in zip(corners, pairwise(angles), strict=True)]
    pieces = [piece for pair in zip(triangles, cones, strict=False) for piece in pair]
    return (*pieces, triangles[-1]), ()


def _round(spec: Transition) -> Round:
    radius, tilt = float(spec.round) / 2.0, radians(spec.tilt)
    centre = np.array([float(spec.offset[0]), float(spec.offset[1]), float(spec.height)])
    x = radius * np.array([cos(tilt), 0.0, -sin(tilt)])
    return Round(centre, x, np.array([0.0, radius, 0.0]), tilt)


def _touching(ring: Round, side: float, turn: float) -> float:
    """Return the angle at which the plane through the side y = `side` touches the round, on the outside of that side.

    There c - Q and c' have no cross product in the yz plane.  That equation has two solutions, one for each `turn`.
    """
    height = float(ring.centre[2])
    across = (side - float(ring.centre[1])) * sin(ring.tilt_rad)
    level = float(ring.y[1]) * sin(ring.tilt_rad)
    return atan2(across, height) + turn * acos(level / hypot(height, across))


def _too_low(spec: Transition, ring: Round) -> tuple[Finding, ...]:
    """Refuse a rectangle and a round that cut each other's plane."""
    slope = tan(ring.tilt_rad)
    lean = max((s * float(spec.rectangle[0]) / 2.0 - float(spec.offset[0])) * slope for s in (1.0, -1.0))
    least = max(float(ring.y[1]) * abs(sin(ring.tilt_rad)), lean)
    if float(spec.height) > least:
        return ()
    message = (
        f"at this tilt the planes of the rectangle and the round cut them: the height is {float(spec.height):.6g} mm, "
        f"it must be above {least:.6g} mm"
    )
    return (Finding("transition-too-low", message, True, {"least_height_mm": least}),)


Foot = tuple[Fraction, Fraction]
"""A point of the rectangle's plane, mm."""


def _triangle(p: Foot, q: Foot, tip: Vector3) -> RuledPatch:
    return between(bezier([(*p, Fraction(0)), (*q, Fraction(0))]), bezier([exactly(tip)] * 2))


def _cone(corner: Foot, arc: Circular) -> RuledPatch:
    """Return the cone from a corner of the rectangle to an arc of the round."""
    zero = np.zeros(3)
    apex = Circular(np.array([float(corner[0]), float(corner[1]), 0.0]), zero, zero, zero, arc.start, arc.sweep)
    return between(apex, arc)
