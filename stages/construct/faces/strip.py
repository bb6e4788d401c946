"""The strip of ruled patches that a face of a CAD file lies on, as far as its edges reach and no farther.

Circles become rational arcs of at most 90 degrees: what is a cylinder or a cone is then exactly one, whatever its
doubles are, and can be proved to be developable.  The rulings end where the edges do: at two planes across parallel
rulings, at two equal shares of the way from an apex.  `p x c0'` points out of the body.
"""

from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import pairwise
from math import ceil, cos, pi

import numpy as np

from stages.construct.faces.ruled import Rails
from stages.construct.quintic import Vector, combine, scaling, vector
from stages.geometry.arrays import Array, Points3, Values, Vector3, cross3, dot, floats
from stages.geometry.curves.curves import Circular, Curve, affine, exactly, rational
from stages.geometry.ruled.backwards import exchanged
from stages.geometry.ruled.nearest import nearest
from stages.geometry.ruled.ruled import RuledPatch, between
from stages.geometry.ruled.strip import Strip, jet
from stages.model.cadface import CadCone, CadFace, CadSweep

QUARTER = pi / 2.0
FULL = 2.0 * pi
SAMPLES = 129
"""Places along a curve at which its reach is looked at; between them second differences bound it."""

Reach = tuple[float, float]


class NoSeamError(Exception):
    """The edges go round the surface without a seam to cut it along."""


def strip_of(form: CadSweep | CadCone | Rails, face: CadFace, reach: Reach | None = None) -> tuple[RuledPatch, ...]:
    """Return the patches under a face.

    reach: from where to where along the direction the rulings of a sweep run, mm; absent: as far as the edges.
    """
    match form:
        case CadSweep():
            patches = swept(form, face, reach or heights(face, form.direction))
        case CadCone():
            patches = _coned(form, face)
        case Rails():
            patches = form.patches
    return patches if faces_out(patches, face) else tuple(exchanged(patch) for patch in patches)


def faces_out(patches: Sequence[RuledPatch], face: CadFace) -> bool:
    """Return whether the normal p x S_v is the face's outward one."""
    strip = Strip(tuple(patches), np.arange(len(patches) + 1.0))
    found = nearest(strip, face.place).place
    here = jet(strip, found[:1], found[1:])
    return bool(dot(cross3(here.s_u, here.s_v)[0], face.normal) > 0.0)


def heights(face: CadFace, direction: Vector3) -> Reach:
    """Return from where to where the edges of a face reach along a direction, mm."""
    return reaches_of([points @ direction for points in sampled(face)])


def sampled(face: CadFace) -> list[Points3]:
    """Return points along every curve of every edge, ends included."""
    v = np.linspace(0.0, 1.0, SAMPLES)
    return [curve.jet(v, 0)[0] for loop in face.loops for edge in loop for curve in edge.curves]


def reaches_of(rows: Sequence[Values]) -> Reach:
    """Return the least and the largest value along curves, no less than what lies between their samples."""
    return -max(_most(-row) for row in rows), max(_most(row) for row in rows)


def _most(row: Values) -> float:
    """Return the largest value along a curve: of its ends, or a little more than of its samples."""
    inner = float(row[1:-1].max() + np.abs(np.diff(row, 2)).max())
    ends = float(max(row[0], row[-1]))
    return ends if row[1:-1].max() <= ends else inner


def swept(form: CadSweep, face: CadFace, reach: Reach) -> tuple[RuledPatch, ...]:
    """Return parallel rulings between two planes across them."""
    d, (low, high) = vector(exactly(form.direction)), exactly(reach)
    length = combine((high - low, d))
    made = []
    for curve in _profile(form, face):
        c0 = affine(curve, *_levelled(curve, d, low))
        made.append(between(c0, affine(c0, scaling(Fraction(1)), length)))
    return tuple(made)


Affine = tuple[Sequence[Sequence[Fraction]], Sequence[Fraction]]


def _levelled(curve: Curve, d: Vector, low: Fraction) -> Affine:
    """Return the map that slides the points of a curve along d to the plane at `low`."""
    height = curve.jet(np.linspace(0.0, 1.0, 9), 0)[0] @ floats(d)
    if np.ptp(height) <= LEVEL * (np.abs(height).max() + 1.0):
        return scaling(Fraction(1)), combine((low - Fraction(float(height[0])), d))
    rows = [combine((1, axis), (-x, d)) for axis, x in zip(scaling(Fraction(1)), d, strict=True)]
    return rows, combine((low, d))


LEVEL = 1e-13
"""A profile that leaves a plane across the rulings by less than rounding is slid as it is: shorter fractions."""


def _profile(form: CadSweep, face: CadFace) -> tuple[Curve, ...]:
    if len(form.profile) == 1 and isinstance(form.profile[0], Circular):
        return arcs(form.profile[0], *_turn(face, lambda points: axial(form, points)))
    return form.profile


def axial(form: CadSweep | CadCone, points: Points3) -> Array:
    """Return points by the axes of a circular profile, shape (n, 3): the first two give the angle about the axis.

    On a sweep the third is along its direction, mm; on a cone all are shares of the way from the apex to the profile.
    """
    ring = form.profile[0] if isinstance(form, CadSweep) else form.profile
    if not isinstance(ring, Circular):
        raise ValueError("a profile that is no circle has no axis")
    if isinstance(form, CadSweep):
        return np.asarray((points - ring.centre) @ np.linalg.inv(np.stack([ring.U, ring.V, form.direction])))
    return np.asarray((points - form.apex) @ np.linalg.inv(np.stack([ring.U, ring.V, ring.centre - form.apex])))


def _coned(form: CadCone, face: CadFace) -> tuple[RuledPatch, ...]:
    """Return rulings from an apex, between the shares of the way to the profile that the edges reach."""
    ring, apex = form.profile, vector(exactly(form.apex))
    low, high = exactly(reaches_of([axial(form, points)[:, 2] for points in sampled(face)]))
    if abs(low) <= LEVEL * 100 * abs(high):
        low = Fraction(0)
    return tuple(
        RuledPatch(
            affine(arc, scaling(low), combine((1 - low, apex))),
            affine(arc, scaling(high), combine((1 - high, apex))),
            affine(arc, scaling(high - low), combine((low - high, apex))),
        )
        for arc in arcs(ring, *_turn(face, lambda points: axial(form, points)))
    )


def arcs(ring: Circular, start: float, end: float) -> tuple[Curve, ...]:
    """Return the part of a circle or ellipse between two angles as equal rational arcs of at most 90 degrees.

    Source: G. Farin, "Curves and Surfaces for CAGD", 5th ed., sec. 13.7: w = cos of half the angle.
    """
    count = ceil((end - start) / QUARTER - ROUND)
    cuts = np.linspace(start, end, count + 1)
    half = (end - start) / count / 2.0

    def at(angle: float, stretch: float) -> list[Fraction]:
        point = ring.centre + stretch * (np.cos(angle) * ring.U + np.sin(angle) * ring.V)
        return [*exactly(point), Fraction(1)]

    made = []
    for a, b in pairwise(cuts):
        w = Fraction(cos(half))
        shoulder = [w * x for x in at((a + b) / 2.0, 1.0 / cos(half))]
        made.append(rational([at(a, 1.0), shoulder, at(b, 1.0)]))
    return tuple(made)


ROUND = 1e-9
"""Share of a quarter turn by which an arc may be longer for rounding."""


def _turn(face: CadFace, places: Callable[[Points3], Array]) -> Reach:
    """Return the range of angles that the edges cover; a whole turn from the seam where there is one.

    Raises NoSeamError where the edges go all the way round and there is no seam.
    """
    seam = seam_points(face)
    if seam is not None:
        x, y, *_ = places(seam)[0]
        start = float(np.arctan2(y, x))
        return start, start + FULL
    angles = [unwound(places(points)) for points in sampled(face)]
    every = np.sort(np.concatenate([row % FULL for row in angles]))
    gaps = np.diff(every, append=every[0] + FULL)
    widest = int(np.argmax(gaps))
    if gaps[widest] <= 2.0 * max(float(np.abs(np.diff(row)).max()) for row in angles):
        raise NoSeamError
    # counted from the middle of the gap no curve passes 0
    origin = float(every[widest] + gaps[widest] / 2.0)
    low, high = reaches_of([(row - origin) % FULL for row in angles])
    return low + origin, high + origin


def unwound(places: Array) -> Values:
    """Return the angles of places, without jumps; at an apex that of the place beside it."""
    x, y = places[:, 0], places[:, 1]
    there = np.hypot(x, y) > LEVEL * np.hypot(x, y).max()
    angle = np.interp(np.arange(x.size), np.flatnonzero(there), np.unwrap(np.arctan2(y[there], x[there])))
    return np.asarray(angle)


def seam_points(face: CadFace) -> Points3 | None:
    """Return the middle of an edge that a loop runs along twice, shape (1, 3); None where there is none."""
    for loop in face.loops:
        numbers = [edge.number for edge in loop]
        for edge in loop:
            if numbers.count(edge.number) > 1:
                return np.asarray(edge.curves[0].jet(np.array([0.5]), 0)[0])
    return None
