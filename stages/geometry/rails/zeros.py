"""Where a ruling between two rails has one tangent plane at both ends: the zero set of F over pairs of parameters.

F(t, s) = det(r', c - r, c') for rails r(t) and c(s), each a chain of smooth pieces.  F is sampled where lattice lines
cross; between two crossings of unlike sign a zero is found to rounding.  A zero counts if both end normals look the
same way, (p x r') . (p x c') > 0: else the edge of regression lies between the rails.  At a kink a rail has two lattice
lines, one for the tangent on either side.

Two arcs, or both ends of a loop, that enter and leave one side of a cell are not seen: the lattice is the resolution.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from stages.geometry.arrays import Array, ArrayValue, Indices, Numbers, Points3, Values, dot, locked, norm
from stages.geometry.curves.curves import Curve
from stages.geometry.numeric.roots import Function, bracketed

Flags = NDArray[np.bool_]

NOISE = 1e-13
"""F below this share of |r'||c - r||c'| is rounding of a zero: three products of doubles, summed over six terms."""


@dataclass(frozen=True, slots=True, eq=False)
class Lines(ArrayValue):
    """Lattice lines across one rail, both ends of each smooth piece among them: a break has two.

    piece: the one that each line lies on.  value: parameter, the number of the piece plus the place in it.
    point, slope: there, shape (n, 3).  even: the numbers of the lines that divide their piece evenly.
    """

    pieces: tuple[Curve, ...]
    piece: Indices
    value: Values
    point: Points3
    slope: Points3
    even: Numbers

    @property
    def inside(self) -> Flags:
        """Whether the interval from each line to the next lies inside one piece, shape (n - 1,)."""
        same: Flags = self.piece[1:] == self.piece[:-1]
        return same

    def local(self, lines: Indices) -> Values:
        """Return the place of lines in their pieces."""
        place: Values = self.value[lines] - self.piece[lines]
        return place


NO_EXTRA = locked(np.zeros(0))


def lines(pieces: Sequence[Curve], count: int, extra: Array = NO_EXTRA) -> Lines:
    """Return about `count` lines, at least `LEAST` intervals to a piece, and one at each of the extra parameters."""
    each = max(LEAST, -(-count // len(pieces)))
    even = np.linspace(0.0, 1.0, each + 1)
    places = [_with_extra(even, extra - number) for number in range(len(pieces))]
    jets = [curve.jet(place, 1) for curve, place in zip(pieces, places, strict=True)]
    sizes = [place.size for place in places]
    piece = np.repeat(np.arange(len(pieces)), sizes)
    starts = np.cumsum([0, *sizes[:-1]])
    return Lines(
        tuple(pieces),
        piece,
        piece + np.concatenate(places),
        np.concatenate([jet[0] for jet in jets]),
        np.concatenate([jet[1] for jet in jets]),
        np.concatenate([start + np.searchsorted(place, even) for start, place in zip(starts, places, strict=True)]),
    )


def _with_extra(even: Array, extra: Array) -> Values:
    """Return even places in [0, 1] and those of the extra ones that are no copies of them or of each other."""
    extra = extra[(extra > 0.0) & (extra < 1.0)]
    if not extra.size:
        return even
    extra = np.unique(np.round(extra / CLEAR)) * CLEAR
    after = np.searchsorted(even, extra)
    clear = np.minimum(extra - even[after - 1], even[after] - extra) > CLEAR
    return np.union1d(even, extra[clear])


CLEAR = 1e-10
"""Lines closer than this are one: a hundred times what parameters are rounded to where they are told apart."""
LEAST = 8
"""Intervals that even a short piece of many has: a cubic's tangents turn by three inflections at most."""


@dataclass(frozen=True, slots=True, eq=False)
class Field(ArrayValue):
    """Two rails on their lattice: F in mm3 (noise set to 0) and the warp of the ruling in rad, shape (n, m).

    turn_a: by how much the normal turns from line to line of rail a about a fixed end on b, rad, (n - 1, m); turn_b:
    the other way round, (n, m - 1).  Between the two lines of a break that is the angle of a fold.
    """

    a: Lines
    b: Lines
    F: Array
    warp: Array
    turn_a: Array
    turn_b: Array


def field(
    rail_a: Sequence[Curve],
    rail_b: Sequence[Curve],
    count: int,
    extra_a: Array = NO_EXTRA,
    extra_b: Array = NO_EXTRA,
) -> Field:
    """Return the lattice of about `count` lines on each rail, and those at the extra parameters."""
    a, b = lines(rail_a, count, extra_a), lines(rail_b, count, extra_b)
    p = b.point[None] - a.point[:, None]
    normal_a, normal_b = np.cross(p, a.slope[:, None]), np.cross(p, b.slope[None])
    F = -dot(normal_a, np.broadcast_to(b.slope[None], p.shape))
    length = norm(p)
    F = np.where(np.abs(F) <= NOISE * length * norm(a.slope)[:, None] * norm(b.slope)[None], 0.0, F)
    warp = np.arctan2(length * np.abs(F), dot(normal_a, normal_b))
    return Field(a, b, F, warp, angles(normal_a[:-1], normal_a[1:]), angles(normal_b[:, :-1], normal_b[:, 1:]))


def angles(x: Array, y: Array) -> Array:
    """Return the angles between vectors along the last axis, rad; 0 where one has no length."""
    return np.asarray(np.arctan2(norm(np.cross(x, y)), dot(x, y)))


Place = tuple[str, int, int]
"""A corner of the lattice ("corner", i, j), or a zero on it: ("column", i, j) on line i of rail a between the lines j
and j + 1 of b, ("row", i, j) on line j of rail b between the lines i and i + 1 of a."""


@dataclass(frozen=True, slots=True)
class Zero:
    """A ruling with one tangent plane at both ends; `open` if both normals look the same way."""

    t: float
    s: float
    open: bool


Zeros = Mapping[Place, Zero]


Finder = Callable[[Function, Values, Values], Values]
"""How a zero is found in its bracket: `bracketed` to rounding, `chord_zeros` roughly."""


def zeros(found: Field, finder: Finder = bracketed) -> Zeros:
    """Return every zero of F on a lattice line, to rounding unless another finder is given."""
    a, b = found.a, found.b
    below = found.F >= 0.0
    i, j = np.nonzero((below[:, :-1] != below[:, 1:]) & b.inside[None])
    s, column_open = _crossings(a, b, i, j, finder)
    columns = zip(i.tolist(), j.tolist(), s.tolist(), column_open.tolist(), strict=True)
    k, m = np.nonzero((below[:-1] != below[1:]) & a.inside[:, None])
    t, row_open = _crossings(b, a, m, k, finder)
    rows = zip(k.tolist(), m.tolist(), t.tolist(), row_open.tolist(), strict=True)
    on_columns = {("column", i, j): Zero(float(a.value[i]), s, is_open) for i, j, s, is_open in columns}
    return on_columns | {("row", k, m): Zero(t, float(b.value[m]), is_open) for k, m, t, is_open in rows}


def _crossings(fixed: Lines, other: Lines, at: Indices, below: Indices, finder: Finder) -> tuple[Values, Flags]:
    """Return, for lines `at` of one rail, the zero between the lines `below` and the next of the other, and if open.

    F does not change when the rails are exchanged.
    """
    values, is_open = np.zeros(at.size), np.zeros(at.size, dtype=bool)
    pieces = other.piece[below]
    for number, curve in enumerate(other.pieces):
        chosen = np.nonzero(pieces == number)[0]
        x, d, k = fixed.point[at[chosen]], fixed.slope[at[chosen]], below[chosen]
        local = finder(partial(_chosen, curve, x, d), other.local(k), other.local(k + 1))
        found = curve.jet(local, 1)
        arm = found[0] - x
        values[chosen] = number + local
        is_open[chosen] = dot(np.cross(arm, d), np.cross(arm, found[1])) > 0.0
    return values, is_open


def _chosen(curve: Curve, x: Array, d: Array, v: Values, which: Indices) -> Values:
    """Return F between a curve at v and some of the points x with slopes d."""
    return mismatch_at(curve, x[which], d[which], v)


def mismatch_at(curve: Curve, x: Points3, d: Points3, v: Values) -> Values:
    """Return F between a curve at v and points x with slopes d, mm3."""
    found = curve.jet(v, 1)
    triple: Values = dot(np.cross(d, found[0] - x), found[1])
    return triple
