"""One face of a CAD file on the strip under it, however it was drawn: what is joined to others or trimmed by itself.

    based(face) -> Based | None

A plane lies on the rectangle about its edges, along the longest straight one.  A net of rails is shortened to what its
edges reach, so that what lies beyond them is neither judged nor drawn.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from stages.construct.curves import plane_axes
from stages.construct.faces.chain import counter_clockwise, rectangle, turned
from stages.construct.faces.closed import opened
from stages.construct.faces.joined import is_straight, straight_edges
from stages.construct.faces.ruled import Rails, parallel, ruled_form
from stages.construct.faces.strip import heights, reaches_of, sampled, strip_of
from stages.construct.faces.trim import Loops, closed, loops_of
from stages.construct.quintic import scaling
from stages.geometry.arrays import Array, ArrayValue, Points2, Values, Vector3, cross3, norm, unit
from stages.geometry.curves.curves import Curve, affine, difference
from stages.geometry.curves.plane import PlaneCurve, Segment
from stages.geometry.ruled.ruled import RuledPatch, part
from stages.geometry.ruled.strip import Strip, jet
from stages.model.cadface import CadCone, CadFace, CadPlane, CadSweep


@dataclass(frozen=True, slots=True)
class Based:
    """A face, the patches under it (their v counted from `first`), and its loops with the face on their left.

    plane: whether any line on it may be a ruling.
    """

    face: CadFace
    patches: tuple[RuledPatch, ...]
    loops: Loops
    first: int
    plane: bool

    @property
    def strip(self) -> Strip:
        """Return the patches with their v."""
        return Strip(self.patches, np.arange(len(self.patches) + 1.0) + self.first)


def based(face: CadFace, first: int = 0) -> Based | None:
    """Return a face on its strip; None where it has no rulings or no edges.

    Raises NoSeamError, OpenLoopError, and NoSolutionError where Newton's method fails.
    """
    form = ruled_form(face.surface)
    if form is None or not face.loops:
        return None
    if isinstance(form, CadPlane):
        return _oriented(_plane(face, first))
    face, form = opened(face, form)
    patches = reached(face, form)
    return _oriented(Based(face, patches, loops_of(patches, face, first), first, plane=False))


def _oriented(given: Based) -> Based:
    """Return a face with its outer loop counter-clockwise, its holes clockwise."""
    outer, *inner = (counter_clockwise(curves) for curves in given.loops.curves)
    holes = tuple(tuple(turned(curve) for curve in curves[::-1]) for curves in inner)
    return replace(given, loops=Loops((outer, *holes), given.loops.distance_mm))


# Planes


@dataclass(frozen=True, slots=True, eq=False)
class InPlane(ArrayValue):
    """A curve in space as u and v of a rectangle; axes: their gradients, shape (2, 3), 1/mm."""

    curve: Curve
    origin: Vector3
    axes: Array
    first: float

    def at(self, t: Values) -> Points2:
        """Return the places at t."""
        places_: Points2 = (self.curve.jet(t, 0)[0] - self.origin) @ self.axes.T + np.array([0.0, self.first])
        return places_

    def derivative(self, t: Values) -> Points2:
        """Return d/dt of the places."""
        slopes: Points2 = self.curve.jet(t, 1)[1] @ self.axes.T
        return slopes


def _plane(face: CadFace, first: int) -> Based:
    """Return a plane face on its rectangle: there u and v are coordinates.  Raises OpenLoopError."""
    d = _along(face)
    patch = rectangle(face, d, heights(face, d))
    (origin,), (width,) = patch.c0.jet(np.zeros(1), 1)
    length = patch.p.jet(np.zeros(1), 0)[0][0]
    axes = np.stack([length / (length @ length), width / (width @ width)])
    found = Based(face, (patch,), Loops((), 0.0), first, plane=True)
    loops = [
        closed(found.strip, [_in_plane(InPlane(curve, origin, axes, float(first))) for e in loop for curve in e.curves])
        for loop in face.loops
    ]
    off = max(float(np.abs((points - face.place) @ face.normal).max()) for points in sampled(face))
    return replace(found, loops=Loops(tuple(loops), off))


def _in_plane(curve: InPlane) -> PlaneCurve:
    """Return a curve of u and v, a line as a segment."""
    points = curve.curve.jet(np.linspace(0.0, 1.0, 9), 0)[0]
    if not is_straight(points):
        return curve
    start, end = curve.at(np.array([0.0, 1.0]))
    return Segment(start, end)


def _along(face: CadFace) -> Vector3:
    """Return the direction of the longest straight edge of a plane face, or any in the plane."""
    steps = [ends[1] - ends[0] for ends in straight_edges(face)]
    direction: Vector3 = unit(max(steps, key=norm)) if steps else plane_axes(face.normal)[0]
    return direction


def reached(face: CadFace, form: CadSweep | CadCone | Rails) -> tuple[RuledPatch, ...]:
    """Return the patches under a ruled face, as far as its edges reach.

    Raises NoSeamError, OpenLoopError, and NoSolutionError where Newton's method fails.
    """
    patches = strip_of(form, face)
    if not isinstance(form, Rails):
        return patches
    loops = loops_of(patches, face)
    if loops.trim(patches) is None:
        return patches
    level = parallel(form)
    return shortened(patches, loops) if isinstance(level, Rails) else strip_of(level, face)


# Shortened to the edges


def shortened(patches: Sequence[RuledPatch], loops: Loops) -> tuple[RuledPatch, ...]:
    """Return patches between the least and the largest u and v of the loops on them, v counted from 0."""
    across, along = _reach(loops.curves[0], 0, 1.0), _reach(loops.curves[0], 1, float(len(patches)))
    made = []
    for i, patch in enumerate(patches):
        low, high = (min(max(v - i, Fraction(0)), Fraction(1)) for v in along)
        if high > low:
            made.append(_narrowed(part(patch, low, high), *across))
    return tuple(made)


def _reach(loop: Sequence[PlaneCurve], axis: int, last: float) -> tuple[Fraction, Fraction]:
    """Return from where to where a loop reaches in u (axis 0) or v (axis 1); at an end of the strip exactly there."""
    t = np.linspace(0.0, 1.0, SAMPLES)
    low, high = reaches_of([curve.at(t)[:, axis] for curve in loop])
    near = AT_END * last
    return (
        Fraction(0) if low <= near else Fraction(max(_rounded(low, -1.0), 0.0)),
        Fraction(last) if high >= last - near else Fraction(min(_rounded(high, 1.0), last)),
    )


SAMPLES = 129
AT_END = 1e-6
"""Share of the strip: what its edges leave out of less is not cut off."""


def _rounded(value: float, sense: float) -> float:
    """Return a value a little farther out, of few binary digits: control points stay short fractions."""
    return float(np.floor(sense * value * STEPS + 1.0) * sense / STEPS)


STEPS = 4096.0
"""To a millimetre: a quarter of a micrometre farther out than asked, which no face minds."""


def _narrowed(patch: RuledPatch, low: Fraction, high: Fraction) -> RuledPatch:
    """Return the patch between two u."""
    if low == 0 and high == 1:
        return patch
    return RuledPatch(_at(patch, low), _at(patch, high), affine(patch.p, scaling(high - low), NOWHERE))


NOWHERE = (Fraction(0),) * 3


def _at(patch: RuledPatch, u: Fraction) -> Curve:
    """Return the curve at u: c0 + u p."""
    return patch.c0 if u == 0 else patch.c1 if u == 1 else difference(patch.c0, affine(patch.p, scaling(-u), NOWHERE))


# What is on it


def places(based_: Based, curve: PlaneCurve, t: Values) -> Array:
    """Return the points in space of an edge, shape (n, 3), mm."""
    return jet(based_.strip, *curve.at(t).T).s


def normals(based_: Based, curve: PlaneCurve, t: Values) -> Array:
    """Return the outward normals along an edge, shape (n, 3); 0 at an apex."""
    here = jet(based_.strip, *curve.at(t).T)
    return unit(cross3(here.s_u, here.s_v))
