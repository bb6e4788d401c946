"""Faces of a CAD file as plain values in mm: surface, loops of edges, and which edges faces share.

Curves and surfaces keep the doubles of the file.  What a surface is (plane, parallel or converging rulings, a net of
control points that may turn out to be ruled, or none of these) is told apart by type.
"""

from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Array, ArrayValue, Vector3
from stages.geometry.curves.curves import Circular, Curve


@dataclass(frozen=True, slots=True)
class CadEdge:
    """One use of an edge by a loop: its curves end to end, run along the loop.

    number: of the edge in its file; both uses of a seam, and those by two faces that meet there, have the same.
    """

    number: int
    curves: tuple[Curve, ...]


@dataclass(frozen=True, slots=True)
class CadPlane:
    """A plane; where it lies is seen from the face's own place and normal."""


@dataclass(frozen=True, slots=True, eq=False)
class CadSweep(ArrayValue):
    """Parallel rulings along a direction (of length 1) through every point of a profile."""

    profile: tuple[Curve, ...]
    direction: Vector3


@dataclass(frozen=True, slots=True, eq=False)
class CadCone(ArrayValue):
    """Rulings from an apex through every point of a circle."""

    apex: Vector3
    profile: Circular


@dataclass(frozen=True, slots=True, eq=False)
class CadNet(ArrayValue):
    """A B-spline surface: degrees, knots in full, control points of shape (n, m, 3), weights of shape (n, m)."""

    degree_u: int
    degree_v: int
    knots_u: Array
    knots_v: Array
    points: Array
    weights: Array

    def check(self) -> None:
        """Refuse counts that do not fit, and weights that are not positive."""
        n, m = self.weights.shape
        fits = self.knots_u.size == n + self.degree_u + 1 and self.knots_v.size == m + self.degree_v + 1
        if not fits or self.points.shape != (n, m, 3):
            raise ValueError("knots, control points and weights of a net do not fit each other")
        if not (self.weights > 0.0).all() or not np.isfinite(self.points).all():
            raise ValueError("a net needs finite control points and positive weights")


CadSurface = CadPlane | CadSweep | CadCone | CadNet


@dataclass(frozen=True, slots=True, eq=False)
class CadFace(ArrayValue):
    """One face of a file, in the order of the file.

    sort: what the file calls its surface, in words.  surface: None where nothing on it can be ruled (a sphere, say).
    place, normal: a point of its surface and the outward normal there, of length 1.
    loops: the outer one first; a loop runs round the face in either sense.
    area_mm2: as the file's own library measures it; None where it does not.
    """

    index: int
    name: str
    sort: str
    surface: CadSurface | None
    place: Vector3
    normal: Vector3
    loops: tuple[tuple[CadEdge, ...], ...]
    area_mm2: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class CadJoint(ArrayValue):
    """A straight edge along which two faces of a body, by place, go over into each other.

    ends: of the edge, mm, shape (2, 3), as the outline of `one` runs with the face on its left, seen from outside.
    """

    one: int
    other: int
    ends: Array


@dataclass(frozen=True, slots=True)
class CadBody:
    """Faces of one file.

    direction: of the rulings along which each face goes over into the next; None for faces that are taken one by one.
    joints: of faces that go over into each other in any direction, as a tree: the k-th of the first ones joins face
    k + 1 to one before it; the others close rings that lie flat.
    """

    faces: tuple[CadFace, ...]
    direction: tuple[float, float, float] | None = None
    joints: tuple[CadJoint, ...] = ()
