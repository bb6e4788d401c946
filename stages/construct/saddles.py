"""Pipes that end on a crossing pipe: cylinders with a saddle, and the branches of tees.

Symbols: r(a) runs along a circle, an arc or an ellipse about C; e is the unit direction of the rulings, x the part of
the curve's own x axis across e, y = e x x.  The crossing pipe, of radius rho, has its axis along
m = sin(angle) x - cos(angle) e through C + length e + offset y.  With n = cos(angle) x + sin(angle) e across m and y, a
ruling meets it first at the distance

    s = length - ((r - C) . n + sqrt(rho^2 - h^2)) / sin(angle),   h = (r - C) . y - offset:

nothing is approximated.

Rulings that miss the pipe, or meet it before they begin, are refused with the radius or length that would do.  Where
rulings touch the pipe (branch and main of one diameter) the saddle has corners, at which it is split.
"""

from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import atan2, ceil, cos, floor, hypot, pi, radians, sin

import numpy as np

from stages.construct.plain import directrix_of, meeting
from stages.construct.quintic import combine, vector
from stages.geometry.arrays import ArrayValue, Vector3, dot, floats, norm, unit
from stages.geometry.curves.curves import Along, Circular, Curve, Difference, affine, exactly, restrict
from stages.geometry.curves.halfchord import TOUCHING, HalfChord, excess
from stages.geometry.numeric.extremum import minimum
from stages.geometry.ruled.ruled import RuledPatch
from stages.model.ducts import Saddle, Tee
from stages.model.part import Cylinder
from stages.model.report import Finding

Made = tuple[tuple[RuledPatch, ...], tuple[Finding, ...]]


@dataclass(frozen=True, slots=True, eq=False)
class Crossing(ArrayValue):
    """A pipe across parallel rulings; mm, rad, unit vectors."""

    centre: Vector3
    e: Vector3
    x: Vector3
    length: float
    radius: float
    angle: float
    offset: float

    @property
    def y(self) -> Vector3:
        """Return the direction across the rulings and the pipe's axis."""
        return np.cross(self.e, self.x)

    def distance(self, r: Circular) -> Curve:
        """Return how far rulings from r run before they meet the pipe, as the first coordinate of a curve, mm."""
        n = cos(self.angle) * self.x + sin(self.angle) * self.e
        row = exactly(-n / sin(self.angle))
        constant = self.length + float(dot(self.centre, n)) / sin(self.angle)
        none = (Fraction(0),) * 3
        straight = affine(r, (row, none, none), (Fraction(constant), Fraction(0), Fraction(0)))
        return Difference(straight, self._half_chord(r))

    def _half_chord(self, r: Circular) -> HalfChord:
        """Return sqrt(rho^2 - h^2) / sin(angle)."""
        reach, ahead, middle = self.heights(r)
        below, above = excess(self.radius, middle, reach), excess(self.radius, -middle, reach)
        return HalfChord(below, above, reach, 1.0 / sin(self.angle), r.start - ahead, r.sweep)

    def heights(self, r: Circular) -> tuple[float, float, float]:
        """Return reach, angle and middle of h = middle + reach cos(a - angle)."""
        u, v = float(dot(r.U, self.y)), float(dot(r.V, self.y))
        return hypot(u, v), atan2(v, u), float(dot(r.centre - self.centre, self.y)) - self.offset

    def edge(self, r: Circular) -> Curve:
        """Return the saddle: where the rulings from r meet the pipe."""
        return Difference(r, Along(self.distance(r), -self.e))


def saddled_cylinder(spec: Cylinder, saddle: Saddle) -> Made:
    """Return the patches of a cylinder that ends on a crossing pipe, or why there are none."""
    (r,) = directrix_of(spec).curves
    if not isinstance(r, Circular):
        raise ValueError("a saddle on a curve without a centre passed the checks of the job file")
    direction = floats(spec.direction)
    e = unit(direction)
    x = unit(r.U - float(dot(r.U, e)) * e)
    place = float(spec.length or 0), float(saddle.radius), radians(saddle.angle), float(saddle.offset)
    crossing = Crossing(r.centre, e, x, *place)
    if spec.start_plane is None:
        return saddle_patches(crossing, r)
    row, constant = meeting(spec.start_plane, vector(spec.direction))
    size, none = exactly([float(norm(direction))])[0], (Fraction(0),) * 3
    start = affine(r, (combine((size, row)), none, none), (size * constant, Fraction(0), Fraction(0)))
    return saddle_patches(crossing, r, start)


def saddle_patches(crossing: Crossing, r: Circular, start: Curve | None = None) -> Made:
    """Return the patches from r to the saddle, or why there are none.

    start: how far from r the rulings begin, mm, the first coordinate of a curve over r; None: on r.
    """
    largest, place = _farthest(crossing, r)
    if largest > crossing.radius * (1.0 + TOUCHING):
        return (), (_misses(crossing, largest, place),)
    cuts = [Fraction(0), *map(Fraction, _corners(crossing, r)), Fraction(1)]
    patches = tuple(_patch(crossing, r, start, low, high) for low, high in pairwise(cuts))
    short = [_least(patch.p, crossing.e) for patch in patches]
    least = min(short)
    if least > 0.0:
        return patches, ()
    wanted = crossing.length - least
    message = f"some rulings meet the crossing pipe before they begin: the length must be above {wanted:.6g} mm"
    return (), (Finding("saddle-too-near", message, True, {"piece": short.index(least), "least_length_mm": wanted}),)


def _patch(crossing: Crossing, r: Circular, start: Curve | None, low: Fraction, high: Fraction) -> RuledPatch:
    base = restrict(r, low, high)
    if not isinstance(base, Circular):
        raise ValueError("a part of a turning became something else")
    distance, first, e = crossing.distance(base), base, crossing.e
    if start is None:
        return RuledPatch(first, crossing.edge(base), Along(distance, e))
    begin = restrict(start, low, high)
    return RuledPatch(Difference(first, Along(begin, -e)), crossing.edge(base), Along(Difference(distance, begin), e))


def _farthest(crossing: Crossing, r: Circular) -> tuple[float, float]:
    """Return the largest |h| of the rulings, mm, and its v."""
    reach, ahead, middle = crossing.heights(r)
    places = [0.0, 1.0, *_inside(r, ahead), *_inside(r, ahead + pi)]
    sizes = [abs(middle + reach * cos(r.start + v * r.sweep - ahead)) for v in places]
    largest = max(sizes)
    return largest, places[sizes.index(largest)]


def _corners(crossing: Crossing, r: Circular) -> list[float]:
    """Return the places where rulings touch the pipe: there the saddle has corners."""
    reach, ahead, middle = crossing.heights(r)
    places = _inside(r, ahead) if excess(crossing.radius, middle, reach) == 0.0 else []
    if excess(crossing.radius, -middle, reach) == 0.0:
        places = places + _inside(r, ahead + pi)
    return sorted(places)


def _inside(r: Circular, angle: float) -> list[float]:
    """Return where r passes an angle (and all its full turns), ends apart."""
    low, high = sorted(((r.start - angle) / (2.0 * pi), (r.start + r.sweep - angle) / (2.0 * pi)))
    turns = range(ceil(low), floor(high) + 1)
    places = [(angle + 2.0 * pi * k - r.start) / r.sweep for k in turns]
    return [v for v in places if AT_END < v < 1.0 - AT_END]


AT_END = 1e-12
"""Nearer to an end than this, in v, is the end: rounding of angles over a full turn, a thousand times over."""


def _least(p: Curve, e: Vector3) -> float:
    """Return the least distance that rulings run along e, mm."""
    return minimum(lambda v: dot(p.jet(v, 0)[0], e))[0]


def _misses(crossing: Crossing, largest: float, place: float) -> Finding:
    message = (
        f"rulings miss the crossing pipe by {largest - crossing.radius:.6g} mm: its radius is {crossing.radius:.6g} mm "
        f"and must be at least {largest:.6g} mm"
    )
    return Finding("saddle-misses", message, True, {"v": place, "least_radius_mm": largest})


def tee(spec: Tee) -> Made:
    """Return the branch of a tee, or why there is none."""
    angle, length, offset = radians(spec.angle), float(spec.length), float(spec.offset)
    outwards = np.array([cos(angle), 0.0, sin(angle)])
    x = np.array([sin(angle), 0.0, -cos(angle)])
    centre = length * outwards + np.array([0.0, offset, 0.0])
    crossing = Crossing(centre, -outwards, x, length, float(spec.main) / 2.0, angle, offset)
    radius = float(spec.branch) / 2.0
    r = Circular(centre, radius * x, radius * crossing.y, np.zeros(3), 0.0, 2.0 * pi)
    patches, findings = saddle_patches(crossing, r)
    return patches, tuple(_in_words_of_a_tee(finding, spec) for finding in findings)


def _in_words_of_a_tee(finding: Finding, spec: Tee) -> Finding:
    """Return a finding about the crossing pipe with what a tee may be at most."""
    if finding.code != "saddle-misses":
        return finding
    branch = float(spec.main) - 2.0 * abs(float(spec.offset))
    offset = (float(spec.main) - float(spec.branch)) / 2.0
    where = dict(finding.where or {})
    ways = [f"main at least {2.0 * float(where['least_radius_mm']):.6g} mm"]
    if branch > 0.0:
        ways.append(f"branch at most {branch:.6g} mm")
        where["largest_branch_mm"] = branch
    if offset >= 0.0:
        ways.append(f"offset at most {offset:.6g} mm")
        where["largest_offset_mm"] = offset
    return Finding(finding.code, f"the branch misses the main: {', or '.join(ways)}", True, where)
