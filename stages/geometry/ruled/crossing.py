"""Where a formed surface passes through itself: two different places of a strip of ruled patches meet transversally.

The strip is divided into cells (`cells`); pairs of cells whose hulls are apart are dropped, in the others a meeting

    F(u, v, s, w) = S(u, v) - S(s, w) = 0

is looked for by Newton's method, each step the shortest one that solves the linearised equations and otherwise
towards the middle of the two cells, for a crossing is a curve in (u, v, s, w) [1]_.  Where that finds none the cells
are halved, until they are apart.  A meeting counts if each of the two sheets goes on beyond the other by `RESOLUTION`
of the size at least: sheets that touch (a seam, an apex, an edge on a face, turns that lie on each other) do not cross.

Cells that turn together by less than two steps are neighbours, and a developable sheet that bends by less than half a
turn does not come back to itself.  Sampled, not proved: hulls rest on second derivatives at three places of a cell.
Two folds that cross exactly along both their edges are taken for touching.  Where sheets lie on each other over a whole
area no halving takes them apart: after `MOST_PAIRS` or `HALVINGS` the search ends, and says what it left (`Unsettled`).

.. [1] N. M. Patrikalakis, T. Maekawa, "Shape Interrogation for Computer Aided Design and Manufacturing", 2002, ch. 5.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stages.geometry.arrays import Array, Indices, Mask, Values, Vector3, norm, unit
from stages.geometry.ruled.cells import Cells, first_cells, halved, jets, may_meet, near_pairs
from stages.geometry.ruled.joins import join
from stages.geometry.ruled.planarity import is_planar
from stages.geometry.ruled.ruled import RuledPatch, at

RESOLUTION = 1e-5
"""Sheets that pass through each other by less than this share of the size only touch: 0.01 mm on a part of a metre."""

STEPS = 8
"""Of Newton's method: it doubles the digits with each, from cells that turn by 0.15 rad."""

MET = 1e-10
"""A residual below this share of the size is a meeting."""

SINGULAR = 1e-6
"""Directions that enclose less than this angle are one for a step of Newton's method."""

CLOSED = 1e-6
"""Share of the size within which the first and the last ruling are one: a seam."""

KINK_RAD = 1e-6
"""Patches whose normals differ by more at their joint form an edge."""

NEAR_APEX = 0.5
"""Two cells that share an apex are cones about it: the halves at the apex are like the whole, the others show it."""

HALVINGS = 24
"""Of the cells, half of them in each direction: down to 1/4096 of the first ones."""

TRIED = 200
"""So many pairs are tried by Newton's method at each size of the cells, spread over all that are left."""

MOST_PAIRS = 2500
"""Pairs of cells that are halved: where more are left, sheets lie on each other over a whole area."""


@dataclass(frozen=True, slots=True, eq=False)
class Crossing:
    """A place where the surface passes through itself: patches, v and u on both sheets, the point, and how deep, mm."""

    patches: tuple[int, int]
    v: tuple[float, float]
    u: tuple[float, float]
    point: Vector3
    depth_mm: float


@dataclass(frozen=True, slots=True, eq=False)
class Unsettled:
    """Pairs of cells that were neither taken apart nor found to cross when the search ended: they touch, or cross.

    cell_mm: the longest diagonal of a cell of them.  patches, v, u and point (in the middle of a cell): one pair.
    """

    pairs: int
    cell_mm: float
    patches: tuple[int, int]
    v: tuple[float, float]
    u: tuple[float, float]
    point: Vector3


@dataclass(frozen=True, slots=True)
class Search:
    """What was found: the deepest crossing of every two patches that cross, and what stayed open, if anything did."""

    found: tuple[Crossing, ...] = ()
    unsettled: Unsettled | None = None


@dataclass(frozen=True, slots=True)
class _Strip:
    """The surface: its first cells, whether its ends are one ruling, and which ends of patches (n, 2) are edges."""

    patches: tuple[RuledPatch, ...]
    cells: Cells
    closed: bool
    edges: NDArray[np.bool_]
    size_mm: float


@dataclass(frozen=True, slots=True, eq=False)
class _Sheet:
    """One sheet at n places: points, S_u, S_v, shape (n, 3)."""

    point: Array
    s_u: Array
    s_v: Array


def crossings(patches: Sequence[RuledPatch], size_mm: float) -> Search:
    """Return the deepest crossing found of every two patches that cross (a patch with itself too), in their order."""
    if is_planar(patches)[0]:
        return Search()
    strip = _strip(patches, size_mm)
    cells, deep = strip.cells, RESOLUTION * size_mm
    first, second = near_pairs(cells, deep)
    distinct = ~_neighbours(strip, cells.strip[first], cells.strip[second])
    a, b = cells.take(first[distinct]), cells.take(second[distinct])
    found: dict[tuple[int, int], Crossing] = {}
    for _ in range(HALVINGS):
        a, b = _left(a, b, found, deep)
        if a.patch.size == 0:
            break
        for crossing in _met(strip, a, b):
            known = found.get(crossing.patches)
            if known is None or known.depth_mm < crossing.depth_mm:
                found[crossing.patches] = crossing
        if a.patch.size > MOST_PAIRS:
            break
        a, b = _smaller(strip, a, b)
    left = _left(a, b, found, deep)
    return Search(tuple(found[key] for key in sorted(found)), _unsettled(strip, *left))


def _unsettled(strip: _Strip, a: Cells, b: Cells) -> Unsettled | None:
    """Return what is said of the pairs that are left, with the first of them for an example."""
    if a.patch.size == 0:
        return None
    diagonals = [norm(np.ptp(cells.corners, axis=1)).max() for cells in (a, b)]
    patches, (v, u) = (int(a.patch[0]), int(b.patch[0])), _middles(a, b)
    middle = at(strip.patches[patches[0]], np.array(u[:1]), np.array(v[:1]))[0]
    return Unsettled(a.patch.size, float(max(diagonals)), patches, v, u, middle)


def _middles(a: Cells, b: Cells) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return v and u in the middle of both cells of the first pair."""
    v, u = ((float(one[0].mean()), float(other[0].mean())) for one, other in ((a.v, b.v), (a.u, b.u)))
    return v, u


def _strip(patches: Sequence[RuledPatch], size_mm: float) -> _Strip:
    u = np.array([0.0, 1.0])
    start, end = at(patches[0], u, np.zeros(2)), at(patches[-1], u, np.ones(2))
    closed = min(float(norm(start - end).max()), float(norm(start - end[::-1]).max())) <= CLOSED * size_mm
    edges = np.ones((len(patches), 2), dtype=bool)
    for i in range(1, len(patches)):
        edges[i - 1, 1] = edges[i, 0] = not join(patches[i - 1], patches[i]).normal_rad <= KINK_RAD
    return _Strip(tuple(patches), first_cells(patches), closed, edges, size_mm)


def _neighbours(strip: _Strip, a: Indices, b: Indices) -> Mask:
    """Return which places, by their strips, are too near each other on the surface to meet."""
    count = strip.cells.strip.size
    apart = np.abs(a - b)
    if strip.closed:
        apart = np.minimum(apart, count - apart)
    near: Mask = apart < NEIGHBOUR
    return near


NEIGHBOUR = 2
"""Strips that follow each other are neighbours: together they turn by 0.3 rad."""


def _left(a: Cells, b: Cells, found: dict[tuple[int, int], Crossing], deep: float) -> tuple[Cells, Cells]:
    """Return the pairs that may meet, those of patches that are known to cross left out."""
    known = {(low, high) for low, high in found}
    fresh = np.array([pair not in known for pair in zip(a.patch.tolist(), b.patch.tolist(), strict=True)], dtype=bool)
    chosen = np.flatnonzero(fresh)
    a, b = a.take(chosen), b.take(chosen)
    chosen = np.flatnonzero(may_meet(a, b, deep) & ~_share_apex(a, b, deep))
    return a.take(chosen), b.take(chosen)


def _share_apex(a: Cells, b: Cells, deep: float) -> Mask:
    """Return which pairs are the ends of rulings that run into the same apex."""
    shared = np.zeros(a.patch.size, dtype=bool)
    for end in ([0, 3], [1, 2]):
        for other in ([0, 3], [1, 2]):
            points = np.concatenate([a.corners[:, end], b.corners[:, other]], axis=1)
            shared |= norm(np.ptp(points, axis=1)) <= deep
    narrow = np.maximum(np.ptp(a.u, axis=1), np.ptp(b.u, axis=1)) <= NEAR_APEX
    both: Mask = shared & narrow
    return both


def _smaller(strip: _Strip, a: Cells, b: Cells) -> tuple[Cells, Cells]:
    """Return each half of one cell with each half of the other."""
    one, other = halved(strip.patches, a), halved(strip.patches, b)
    even = np.arange(0, 2 * a.patch.size, 2)
    return (
        one.take(np.concatenate([even, even, even + 1, even + 1])),
        other.take(np.concatenate([even, even + 1, even, even + 1])),
    )


def _met(strip: _Strip, a: Cells, b: Cells) -> list[Crossing]:
    """Return the crossings that Newton's method finds from the middles of the pairs."""
    if a.patch.size > TRIED:
        some = np.linspace(0, a.patch.size - 1, TRIED).astype(np.int64)
        a, b = a.take(some), b.take(some)
    place = _meeting(strip, a, b)
    one, other = (_sheet(strip, cells.patch, place[:, k], place[:, k + 1]) for cells, k in ((a, 0), (b, 2)))
    met = norm(one.point - other.point) <= MET * strip.size_mm
    met &= ~_neighbours(strip, _strip_at(strip, a.patch, place[:, 1]), _strip_at(strip, b.patch, place[:, 3]))
    normal, other_normal = (unit(np.cross(sheet.s_u, sheet.s_v)) for sheet in (one, other))
    room = np.minimum(_room(strip, a.patch, one, place[:, :2]), _room(strip, b.patch, other, place[:, 2:]))
    depth = np.where(met, room * norm(np.cross(normal, other_normal)), 0.0)
    return [
        Crossing(
            (int(a.patch[i]), int(b.patch[i])),
            (float(place[i, 1]), float(place[i, 3])),
            (float(place[i, 0]), float(place[i, 2])),
            one.point[i],
            float(depth[i]),
        )
        for i in np.flatnonzero(depth > RESOLUTION * strip.size_mm)
    ]


def _meeting(strip: _Strip, a: Cells, b: Cells) -> Array:
    """Return (u, v, s, w) after the steps of Newton's method, shape (n, 4): where the sheets meet, if they do."""
    middle = np.stack([a.u.mean(axis=1), a.v.mean(axis=1), b.u.mean(axis=1), b.v.mean(axis=1)], axis=1)
    place = middle
    for _ in range(STEPS):
        one, other = (_sheet(strip, cells.patch, place[:, k], place[:, k + 1]) for cells, k in ((a, 0), (b, 2)))
        slopes = np.stack([one.s_u, one.s_v, -other.s_u, -other.s_v], axis=2)
        lengths = np.maximum(norm(np.swapaxes(slopes, 1, 2)), np.finfo(float).tiny)
        slopes = slopes / lengths[:, None]
        home = (middle - place) * lengths
        miss = (one.point - other.point) + np.einsum("nij,nj->ni", slopes, home)
        step = home - np.einsum("nij,nj->ni", np.linalg.pinv(slopes, rcond=SINGULAR), miss)
        place = np.clip(place + step / lengths, 0.0, 1.0)
    return place


def _sheet(strip: _Strip, patch: Indices, u: Values, v: Values) -> _Sheet:
    found = jets(strip.patches, patch, v)
    return _Sheet(found.c0[0] + u[:, None] * found.p[0], found.p[0], found.c0[1] + u[:, None] * found.p[1])


def _strip_at(strip: _Strip, patch: Indices, v: Values) -> Indices:
    """Return the first strips in which places lie."""
    starts = strip.cells.patch + strip.cells.v[:, 0]
    found: Indices = np.searchsorted(starts, patch + np.minimum(v, BELOW_ONE), side="right") - 1
    return found


BELOW_ONE = 1.0 - 2.0**-40
"""The last v of a patch, so that it is not taken for the first of the next."""


def _room(strip: _Strip, patch: Indices, sheet: _Sheet, place: Array) -> Values:
    """Return how far the sheet goes on about each place until an edge or a fold, mm."""
    area = norm(np.cross(sheet.s_u, sheet.s_v))
    across, along = (
        np.divide(area, side, out=np.zeros_like(area), where=side > 0.0) for side in (norm(sheet.s_v), norm(sheet.s_u))
    )
    u, v = place.T
    low, high = (np.where(strip.edges[patch, end], share * along, np.inf) for end, share in ((0, v), (1, 1.0 - v)))
    room: Values = np.minimum(np.minimum(u, 1.0 - u) * across, np.minimum(low, high))
    return room
