"""The strip of several CAD faces with parallel rulings that go over into each other.

All rulings run between two planes across them, from the lowest edge of all faces to the highest.  A plane face is the
rectangle over its reach across the rulings.  Each face keeps its own loops; where two faces meet the common edge is
taken out of both loops, which become one.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from stages.construct.faces.joined import joinable_of, run_of
from stages.construct.faces.strip import Reach, faces_out, heights, swept
from stages.construct.faces.trim import Loops, OpenLoopError, loops_of
from stages.construct.quintic import combine, scaling, vector
from stages.geometry.arrays import ArrayValue, Points2, Values, Vector3, cross2, norm
from stages.geometry.curves.curves import affine, bezier, exactly
from stages.geometry.curves.plane import PlaneCurve, Segment
from stages.geometry.ruled.backwards import reversed_patch
from stages.geometry.ruled.ruled import RuledPatch, between
from stages.model.cadface import CadBody, CadFace, CadPlane, CadSweep

LOOP_SAMPLES = 65
ON_JOINT = 1e-6
"""Of a patch in v: an edge this close to the joint all along is the common edge."""


@dataclass(frozen=True, slots=True)
class Joined:
    """The patches under faces, their common loops, and the v at which each face begins and the last one ends."""

    patches: tuple[RuledPatch, ...]
    loops: Loops
    breaks: tuple[int, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Turned(ArrayValue):
    """A curve of the plane run the other way."""

    curve: PlaneCurve

    def at(self, t: Values) -> Points2:
        """Return the points at t."""
        return self.curve.at(1.0 - t)

    def derivative(self, t: Values) -> Points2:
        """Return d/dt of the points."""
        return -self.curve.derivative(1.0 - t)


def joined(body: CadBody) -> Joined:
    """Return the strip of faces that were found to be joined, in that order.

    Raises OpenLoopError, and NoSolutionError where Newton's method fails.
    """
    d = np.array(body.direction)
    reaches = [heights(face, d) for face in body.faces]
    reach = min(low for low, _ in reaches), max(high for _, high in reaches)
    patches: tuple[RuledPatch, ...] = ()
    breaks, loops = [0], []
    for face in body.faces:
        here = _patches(face, d, reach)
        loops.append(loops_of(here, face, len(patches)))
        patches = (*patches, *here)
        breaks.append(len(patches))
    return Joined(patches, merged(loops, breaks), tuple(breaks))


def _patches(face: CadFace, d: Vector3, reach: Reach) -> tuple[RuledPatch, ...]:
    """Return the patches of one face, run along n x d, their rulings along d."""
    side = joinable_of(face)
    if side is None:
        raise ValueError(f"face {face.index} was joined and has no parallel rulings")
    if isinstance(side.form, CadPlane):
        return (rectangle(face, d, reach),)
    made = swept(CadSweep(side.form.profile, d), face, reach)
    return made if faces_out(made, face) else tuple(reversed_patch(patch) for patch in made[::-1])


def rectangle(face: CadFace, d: Vector3, reach: Reach) -> RuledPatch:
    """Return the rectangle of a plane face over its reach across d."""
    across = np.cross(face.normal, d)
    corner = float(face.place @ face.normal) * face.normal + reach[0] * d
    c0 = bezier([exactly(corner + place * across) for place in run_of(face, d)])
    step = combine((Fraction(reach[1] - reach[0]), vector(exactly(d))))
    return between(c0, affine(c0, scaling(Fraction(1)), step))


def merged(loops: Sequence[Loops], breaks: Sequence[int]) -> Loops:
    """Return the loops of faces side by side as those of one: the outer ones spliced where the faces meet."""
    outer = counter_clockwise(loops[0].curves[0])
    for one, joint in zip(loops[1:], breaks[1:-1], strict=True):
        outer = _spliced(outer, counter_clockwise(one.curves[0]), float(joint))
    inner = [curves for one in loops for curves in one.curves[1:]]
    return Loops((outer, *inner), max(one.distance_mm for one in loops))


Run = tuple[PlaneCurve, ...]


def counter_clockwise(curves: Run) -> Run:
    """Return a loop run counter-clockwise in the plane of u and v."""
    t = np.linspace(0.0, 1.0, LOOP_SAMPLES)
    points = np.concatenate([curve.at(t)[:-1] for curve in curves])
    if float(cross2(points, np.roll(points, -1, axis=0)).sum()) > 0.0:
        return curves
    return tuple(turned(curve) for curve in curves[::-1])


def turned(curve: PlaneCurve) -> PlaneCurve:
    """Return a curve run the other way; a straight one stays straight."""
    return Segment(curve.end, curve.start) if isinstance(curve, Segment) else Turned(curve)


def _spliced(before: Run, after: Run, v: float) -> Run:
    """Return two loops as one, without the edge at v that they share.  Raises OpenLoopError where there is none."""
    i, j = _on_joint(before, v), _on_joint(after, v)
    apart = norm(before[i].at(np.array([0.0, 1.0])) - after[j].at(np.array([1.0, 0.0]))).max()
    if apart > ON_JOINT:
        raise OpenLoopError(float(apart))
    return (*before[i + 1 :], *before[:i], *after[j + 1 :], *after[:j])


def _on_joint(curves: Run, v: float) -> int:
    """Return which curve of a loop runs along the ruling at v, the longest if there are several."""
    t = np.linspace(0.0, 1.0, LOOP_SAMPLES)
    found = [(float(np.ptp(curve.at(t)[:, 0])), i) for i, curve in enumerate(curves)
             if np.abs(curve.at(t)[:, 1] - v).max() <= ON_JOINT]  # fmt: skip
    if not found:
        raise OpenLoopError(0.0)
    return max(found)[1]
