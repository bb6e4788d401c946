"""Faces of a CAD file that make one blank in any direction: laid side by side in the plane along their hinges.

Every face is developed by itself.  The longest hinge is taken first: the two groups of faces that it joins are laid
against each other, unless they would then cover the plane twice.  A hinge within a group closes a ring: where both its
sides come to lie on each other it is none, elsewhere the ring is cut open there.

Whether faces cover each other is seen on polygons that lie inside them by `INSIDE` of the size: what overlaps by less
is found later, on the contours that are cut.  That the faces do not cross each other in space is not looked at.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from stages.construct.faces.based import Based
from stages.construct.faces.hinges import ENDS, Edge, Meeting, curve_of
from stages.construct.faces.trim import MEETS
from stages.errors import NoSolutionError
from stages.geometry.arrays import Points2, norm
from stages.geometry.flat.development import develop
from stages.geometry.flat.mapped import FlatStrip
from stages.geometry.flat.placing import STILL, Motion, after, onto

if TYPE_CHECKING:
    from shapely import Polygon

INSIDE = 1e-3
"""Share of the size by which the polygons are shrunk: some ten times what their chords leave out of a half circle."""
SAMPLES = 33


@dataclass(frozen=True, slots=True)
class FlatFace:
    """A face laid flat by itself, a polygon inside it, and the larger side of the box about it, mm."""

    side: Based
    strip: FlatStrip
    polygon: "Polygon"
    size_mm: float

    def ends_of(self, edge: Edge) -> Points2:
        """Return the ends of one of its edges in the plane, shape (2, 2), mm."""
        return self.strip.positions(*curve_of(self.side, edge).at(ENDS).T)


@dataclass(frozen=True, slots=True)
class Apart:
    """A hinge, or another straight edge, at which two faces are not joined, and why."""

    meeting: Meeting
    why: str


@dataclass(frozen=True, slots=True)
class Grown:
    """Groups of faces by place, the hinges in each, those that close rings, and where faces stay apart."""

    groups: tuple[tuple[int, ...], ...]
    hinges: tuple[Meeting, ...]
    closing: tuple[Meeting, ...]
    apart: tuple[Apart, ...]


def grown(hinges: Sequence[Meeting], sides: dict[int, Based]) -> Grown:
    """Return the faces of hinges in groups that are one blank each."""
    used = sorted({i for hinge in hinges for i in (hinge.one, hinge.other)})
    flat = {i: one for i in used if (one := _tried(sides[i])) is not None}
    group = {i: i for i in flat}
    motion = dict.fromkeys(flat, STILL)
    taken: list[Meeting] = []
    closing: list[Meeting] = []
    apart = [Apart(one, UNRESOLVED) for one in hinges if not {one.one, one.other} <= flat.keys()]
    usable = [one for one in hinges if {one.one, one.other} <= flat.keys()]
    for hinge in sorted(usable, key=lambda one: (-round(one.length_mm, DECIMALS), one.one, one.other)):
        here, there = (_members(group, i) for i in (hinge.one, hinge.other))
        mine, its = (motion[i].points(flat[i].ends_of(e)) for i, e in _sides(hinge))
        if here == there:
            gap = float(norm(mine - its[::-1]).max())
            if gap <= MEETS * max(flat[i].size_mm for i in here):
                closing.append(hinge)
            else:
                apart.append(Apart(hinge, f"the ring is cut open there, its sides {gap:.6g} mm apart in the flat"))
            continue
        step = onto(its[::-1], mine)
        tried = motion | {i: after(step, motion[i]) for i in there}
        doubled = _doubled([_placed(flat[i], tried[i]) for i in here], [_placed(flat[i], tried[i]) for i in there])
        if doubled > 0.0:
            apart.append(Apart(hinge, f"laid flat, {doubled:.4g} mm2 of the one blank would be covered twice"))
            continue
        motion, group = tried, group | dict.fromkeys(there, group[hinge.one])
        taken.append(hinge)
    groups = tuple(_members(group, root) for root in sorted({min(_members(group, i)) for i in flat}))
    return Grown(groups, tuple(taken), tuple(closing), tuple(apart))


UNRESOLVED = "one of them cannot be laid flat by itself: its development does not resolve"
DECIMALS = 6
"""Of a length in mm: hinges of one length are taken in the order of the file, whatever their rounding."""


def _members(group: dict[int, int], of: int) -> tuple[int, ...]:
    return tuple(i for i in sorted(group) if group[i] == group[of])


def _sides(hinge: Meeting) -> tuple[tuple[int, Edge], tuple[int, Edge]]:
    return (hinge.one, hinge.of_one), (hinge.other, hinge.of_other)


# In the plane


def flat_face(side: Based) -> FlatFace:
    """Return a face laid flat along its rulings.  Raises NoSolutionError where the quadrature does not resolve."""
    from shapely import Polygon, make_valid

    strip = FlatStrip(develop(side.patches).pieces, side.strip.knots)
    t = np.linspace(0.0, 1.0, SAMPLES)[:-1]
    outer, *inner = (np.concatenate([strip.positions(*curve.at(t).T) for curve in loop]) for loop in side.loops.curves)
    extent = float(np.ptp(outer, axis=0).max())
    return FlatFace(side, strip, make_valid(Polygon(outer, inner)).buffer(-INSIDE * extent), extent)


def _tried(side: Based) -> FlatFace | None:
    try:
        return flat_face(side)
    except NoSolutionError:
        return None


def _placed(face: FlatFace, motion: Motion) -> "Polygon":
    """Return the polygon of a face where it lies."""
    from shapely import transform

    return transform(face.polygon, motion.points)


def _doubled(one: "Sequence[Polygon]", other: "Sequence[Polygon]") -> float:
    """Return the area that two groups both cover, mm2."""
    return float(sum(a.intersection(b).area for a in one for b in other if a.intersects(b)))


def in_order(group: Sequence[int], hinges: Sequence[Meeting]) -> tuple[tuple[int, ...], tuple[Meeting, ...]]:
    """Return the faces of a group from its first one on, each after the one that it is hinged to, and those hinges.

    Every hinge has the face that comes first as `one`.
    """
    order, steps = [min(group)], []
    for place in order:
        for hinge in hinges:
            if place in (hinge.one, hinge.other):
                there = hinge.other if place == hinge.one else hinge.one
                if there not in order:
                    order.append(there)
                    steps.append(hinge if place == hinge.one else reversed_meeting(hinge))
    return tuple(order), tuple(steps)


def reversed_meeting(hinge: Meeting) -> Meeting:
    """Return a hinge seen from its other face."""
    return replace(
        hinge, one=hinge.other, other=hinge.one, of_one=hinge.of_other, of_other=hinge.of_one, ends=hinge.ends[::-1]
    )
