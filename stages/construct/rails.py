"""The kind `rails`: strips between two rails as ruled pieces along F = 0, cones with an apex on a rail, triangles.

The rails are kept exactly: a cone's directrix is the rail's own piece, its apex the rail's own point, in fractions
where the rail is polynomial; a ruled piece runs along both rails by one parameter (`geometry.rails.linked`).
"""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from stages.geometry.arrays import Array, Values
from stages.geometry.curves.curves import Bezier, Curve, Difference, affine, blossom, exactly, restrict
from stages.geometry.rails.chords import SHARED
from stages.geometry.rails.corners import TINY, Leg
from stages.geometry.rails.linked import both_rails
from stages.geometry.rails.strip import Rail, Strip, as_given, snapped
from stages.geometry.rails.way import linked
from stages.geometry.ruled.planarity import is_planar
from stages.geometry.ruled.ruled import RuledPatch

Identity = tuple[tuple[Fraction, ...], ...]
ONE: Identity = tuple(tuple(Fraction(int(i == j)) for j in range(3)) for i in range(3))
NONE: Identity = tuple((Fraction(0),) * 3 for _ in range(3))
AWAY: Identity = tuple(tuple(-x for x in row) for row in ONE)


Range = tuple[float, float]
"""A part of a rail by its parameter, the number of its piece and the place in it."""


@dataclass(frozen=True, slots=True)
class Piece:
    """One patch of a strip, and the parts of the rails that it runs between."""

    kind: str
    patch: RuledPatch
    a: Range
    b: Range


def pieces(strip: Strip) -> tuple[Piece, ...]:
    """Return the patches of a strip in the order of its rulings, divided where the rails are."""
    return tuple(piece for leg in strip.legs for piece in _of_leg(leg, strip.rail_a, strip.rail_b))


def _of_leg(leg: Leg, rail_a: Rail, rail_b: Rail) -> Iterator[Piece]:
    (t0, s0), (t1, s1) = leg.knots[0], leg.knots[-1]
    if leg.move == "along" and min(t1 - t0, s1 - s0) > TINY:
        yield _ruled(leg.knots, rail_a, rail_b)
        return
    if t1 - t0 > s1 - s0:
        apex = _point(rail_b, float(s0))
        for number, low, high in _parts(float(t0), float(t1), len(rail_a)):
            c0 = restrict(rail_a[number], low, high)
            patch = RuledPatch(c0, affine(c0, NONE, apex), affine(c0, AWAY, apex))
            yield Piece(_sort(patch), patch, (float(number + low), float(number + high)), (float(s0), float(s0)))
    else:
        apex = _point(rail_a, float(t0))
        for number, low, high in _parts(float(s0), float(s1), len(rail_b)):
            c1 = restrict(rail_b[number], low, high)
            patch = RuledPatch(affine(c1, NONE, apex), c1, affine(c1, ONE, [-x for x in apex]))
            yield Piece(_sort(patch), patch, (float(t0), float(t0)), (float(number + low), float(number + high)))


def _sort(patch: RuledPatch) -> str:
    """Return what a patch with an apex is: a plane triangle (over a straight rail, say) or a cone."""
    return "triangle" if is_planar((patch,))[0] else "cone"


def _ruled(knots: Array, rail_a: Rail, rail_b: Rail) -> Piece:
    """Return the ruled piece over knots that lie in one piece of each rail.

    Where the rails meet at an end of it, it is built about that point and with parameters that begin there, so that a
    ruling that shrinks to nothing keeps its digits.
    """
    (t0, s0), (t1, s1) = knots[0], knots[-1]
    i, j = np.floor(knots.mean(axis=0)).astype(int).tolist()
    local, pair = knots - [i, j], (rail_a[i], rail_b[j])
    first, last = (_meeting(rail_a, rail_b, corner) for corner in knots[[0, -1]])
    meet = first or last or (Fraction(0),) * 3
    near = [affine(curve, ONE, [-x for x in meet]) for curve in pair]
    turned = first is None and last is not None
    if turned:
        local, near = 1.0 - local[::-1], [restrict(curve, *BACK) for curve in near]
    c0, c1 = both_rails(linked(local, near[:1], near[1:]))
    if turned:
        c0, c1 = c0.part(*BACK), c1.part(*BACK)
    patch = RuledPatch(c0.image(ONE, meet), c1.image(ONE, meet), Difference(c1, c0))
    return Piece("ruled", patch, (float(t0), float(t1)), (float(s0), float(s1)))


BACK = Fraction(1), Fraction(0)


def _meeting(rail_a: Rail, rail_b: Rail, corner: Values) -> tuple[Fraction, ...] | None:
    """Return the point of both rails at a corner, None where they have two."""
    a, b = _point(rail_a, float(corner[0])), _point(rail_b, float(corner[1]))
    gap = max(abs(float(x - y)) for x, y in zip(a, b, strict=True))
    return a if gap <= SHARED * max(abs(float(x)) for x in (*a, 1)) else None


def _parts(start: float, end: float, count: int) -> Iterator[tuple[int, Fraction, Fraction]]:
    """Yield the pieces between two parameters, and the range covered in each."""
    for number in range(int(np.floor(start + TINY)), min(int(np.ceil(end - TINY)), count)):
        low, high = Fraction(max(start - number, 0.0)), Fraction(min(end - number, 1.0))
        if high - low > TINY:
            yield number, low, high


def _point(rail: Rail, parameter: float) -> tuple[Fraction, ...]:
    """Return the point of a rail at a parameter, exactly where the rail is polynomial."""
    number = min(int(parameter), len(rail) - 1)
    return point_at(rail[number], Fraction(parameter) - number)


def point_at(curve: Curve, v: Fraction) -> tuple[Fraction, ...]:
    """Return a point of a curve, exact on Bezier curves."""
    if isinstance(curve, Bezier):
        return tuple(blossom(curve.exact, v, v)[0])
    return exactly(curve.jet(np.array([float(v)]), 0)[0, 0])


def rows(strip: Strip, made: tuple[Piece, ...]) -> list[dict[str, object]]:
    """Return the pieces for the report, by the parameters of the rails as given.

    Of closed rails they count on past the seam; of a rail that is run backwards they fall.
    """
    on_a, on_b = as_given(strip.rail_a, strip.starts[0]), as_given(strip.rail_b, strip.starts[1])
    found: list[dict[str, object]] = []
    for piece in made:
        a, b = [snapped(on_a(x)) for x in piece.a], [snapped(on_b(x)) for x in piece.b]
        if strip.backwards_b:
            count = len(strip.rail_b) - (strip.starts[1] % 1.0 != 0.0)
            b = [count - x for x in b]
        found.append({"kind": piece.kind, "a": a, "b": b})
    return found
