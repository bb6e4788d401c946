"""A seam for closed faces whose edges go all the way round and leave none: a ruling that meets no hole.

Some programs close such a face without an edge along it.  Both rims are divided where a ruling meets them, and the
ruling is put between them twice, there and back, as other programs write it; a cone that is closed up to its apex has
one rim, and the seam ends in the apex.  A ruling through the end of an edge is preferred, which divides nothing.

Not for a rim that any ruling meets more than once.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from stages.construct.faces.spline import straight
from stages.construct.faces.strip import NoSeamError, axial, seam_points, unwound
from stages.geometry.arrays import Array, Values, Vector3
from stages.geometry.curves.curves import Circular, Curve, restrict
from stages.geometry.ruled.backwards import backwards
from stages.model.cadface import CadCone, CadEdge, CadFace, CadSweep

Rim = tuple[CadEdge, ...]
Run = tuple[Curve, ...]
SEAM_NUMBER = -1
"""Of the edge that is put in, and from there down of the pieces of the rims: files count from 0 or 1."""
TRIED = 16
"""Rulings looked at beside those through the ends of edges."""
SAMPLES = 65
AT_END = 1e-9
"""Share of a curve: a ruling that meets it this near its end meets the end."""
APART = 1e-3
"""rad between the seam and a hole, at least: what is nearer looks like meeting it."""


@dataclass(frozen=True, slots=True, eq=False)
class Turned:
    """A rim and the angles along each of its curves, without jumps, at `SAMPLES` places, shape (curves, SAMPLES)."""

    rim: Rim
    angles: Array

    @property
    def once_round(self) -> bool:
        """Return whether it goes round the axis."""
        return bool(abs(self.angles[-1, -1] - self.angles[0, 0]) > np.pi)


@dataclass(frozen=True, slots=True, eq=False)
class Compass:
    """What tells places round a closed surface apart: a whole turn of `along` is once round.

    along: the angles, without jumps, at `SAMPLES` even steps of a curve, rad.
    beside: how far a point is beyond the ruling at an angle, near it, in any measure: its zero and its sign count.
    apex: in which all rulings meet at an end of the surface.
    """

    along: Callable[[Curve], Values]
    beside: Callable[[float, Vector3], float]
    apex: Vector3 | None


def seamed(face: CadFace, form: CadSweep | CadCone) -> CadFace:
    """Return the face of a round surface with a seam; as it is where it has one or needs none.

    Raises NoSeamError where no ruling crosses each rim once and no hole.
    """
    if not isinstance(_ring(form), Circular) or seam_points(face) is not None:
        return face
    compass = _about_axis(form)
    cut = cut_open(face, compass, lambda rims: [float(row[0]) for one in rims for row in one.angles])
    return face if cut is None else cut[0]


def cut_open(
    face: CadFace, compass: Compass, first: Callable[[Sequence[Turned]], Sequence[float]]
) -> tuple[CadFace, float] | None:
    """Return a face with a seam, and the angle of it; None where it has no rim that goes all the way round.

    first: the angles to be tried before evenly spaced ones.
    Raises NoSeamError where no ruling crosses each rim once and no hole.
    """
    loops = [_turned(loop, compass) for loop in face.loops]
    rims, holes = [one for one in loops if one.once_round], [one for one in loops if not one.once_round]
    if not rims:
        return None
    if len(rims) > len("ab") or (len(rims) == 1 and compass.apex is None):
        raise NoSeamError
    for angle in (*first(rims), *_even(rims)):
        if not all(_clear(one, angle) for one in holes):
            continue
        found = [begun for one in rims if (begun := _begun(one, compass, angle)) is not None]
        if len(found) == len(rims):
            changed = face.replace(loops=(_sewn(found, rims, compass.apex), *(one.rim for one in holes)))
            if isinstance(changed, CadFace):
                return changed, angle
    raise NoSeamError


def _ring(form: CadSweep | CadCone) -> Curve:
    return form.profile[0] if isinstance(form, CadSweep) else form.profile


def _about_axis(form: CadSweep | CadCone) -> Compass:
    """Return the angle about the axis of a round surface."""
    t = np.linspace(0.0, 1.0, SAMPLES)

    def beside(angle: float, point: Vector3) -> float:
        """Return how far a point is turned beyond an angle, rad."""
        x, y, _ = axial(form, point[None])[0]
        return float((np.arctan2(y, x) - angle + np.pi) % (2.0 * np.pi) - np.pi)

    apex = form.apex if isinstance(form, CadCone) else None
    return Compass(lambda curve: unwound(axial(form, curve.jet(t, 0)[0])), beside, apex)


def _turned(loop: Rim, compass: Compass) -> Turned:
    """Return a loop with the angles along it."""
    rows = [compass.along(curve) for edge in loop for curve in edge.curves]
    made = rows[:1]
    for row in rows[1:]:
        made.append(row + 2.0 * np.pi * np.round((made[-1][-1] - row[0]) / (2.0 * np.pi)))
    return Turned(loop, np.array(made))


def _even(rims: Sequence[Turned]) -> list[float]:
    """Return the angles of evenly spaced rulings."""
    first = float(rims[0].angles[0, 0])
    return [first + float(x) for x in np.arange(1, TRIED) * (2.0 * np.pi / TRIED)]


def _clear(hole: Turned, angle: float) -> bool:
    """Return whether a ruling misses a hole."""
    low, high = float(hole.angles.min()) - APART, float(hole.angles.max()) + APART
    return bool((angle - low) % (2.0 * np.pi) > high - low)


def _begun(one: Turned, compass: Compass, angle: float) -> Run | None:
    """Return a rim begun where the ruling at an angle meets it; None where it meets it more than once."""
    curves = [curve for edge in one.rim for curve in edge.curves]
    met = [(k, t) for k, row in enumerate(one.angles) for t in _met(row, angle)]
    # the end of one curve is the beginning of the next
    places = {((k + 1) % len(curves), 0.0) if t >= 1.0 - AT_END else (k, 0.0 if t <= AT_END else t) for k, t in met}
    if len(places) != 1:
        return None
    ((k, t),) = places
    rest = [*curves[k + 1 :], *curves[:k]]
    if t == 0.0:
        return (curves[k], *rest)
    exact = _refined(curves[k], compass, angle, t)
    return (restrict(curves[k], exact, Fraction(1)), *rest, restrict(curves[k], Fraction(0), exact))


def _met(row: Values, angle: float) -> list[float]:
    """Return the places on a curve, as shares, where its angle is the given one, straight lines between samples."""
    turns = (row - angle) / (2.0 * np.pi)
    found = []
    for k in range(int(np.floor(turns.min() - AT_END)), int(np.ceil(turns.max() + AT_END)) + 1):
        off = turns - k
        near = np.flatnonzero(np.abs(off) <= AT_END)
        crossing = np.flatnonzero((off[1:] * off[:-1] < 0.0) & (np.minimum(np.abs(off[1:]), np.abs(off[:-1])) > AT_END))
        found += [float(i) / (SAMPLES - 1) for i in near]
        found += [(float(i) + float(off[i] / (off[i] - off[i + 1]))) / (SAMPLES - 1) for i in crossing]
    return found


def _refined(curve: Curve, compass: Compass, angle: float, t: float) -> Fraction:
    """Return the place on a curve, near t, where it meets the ruling at an angle, to rounding."""
    low, high = max(t - 1.0 / SAMPLES, 0.0), min(t + 1.0 / SAMPLES, 1.0)

    def off(at: float) -> float:
        return compass.beside(angle, curve.jet(np.array([at]), 0)[0][0])

    rising = off(high) > off(low)
    for _ in range(HALVINGS):
        middle = (low + high) / 2.0
        low, high = (low, middle) if (off(middle) > 0.0) == rising else (middle, high)
    return Fraction((low + high) / 2.0)


HALVINGS = 52
"""What is left of an interval is the spacing of the doubles."""


def _sewn(begun: Sequence[Run], rims: Sequence[Turned], apex: Vector3 | None) -> Rim:
    """Return both rims and the seam between them, there and back, as one loop; every curve is an edge of its own."""
    one, other = begun[0], begun[-1]
    if apex is not None and len(begun) == 1:
        seam, other = straight(_start(one), apex), ()
    else:
        senses = [float(np.sign(rim.angles[-1, -1] - rim.angles[0, 0])) for rim in rims]
        other = other if senses[0] != senses[1] else tuple(backwards(curve) for curve in other[::-1])
        seam = straight(_start(one), _start(other))
    numbers = iter(range(SEAM_NUMBER - 1, SEAM_NUMBER - 1 - len(one) - len(other), -1))
    there, back = (CadEdge(SEAM_NUMBER, (way,)) for way in (seam, backwards(seam)))
    first, second = ([CadEdge(next(numbers), (curve,)) for curve in run] for run in (one, other))
    return (*first, there, *second, back)


def _start(run: Run) -> Vector3:
    start: Vector3 = run[0].jet(np.zeros(1), 0)[0][0]
    return start
