"""Arcs of F = 0 between two rails as chords from zero to zero: what a path over the lattice may follow.

Inside a cell of the lattice zeros on its sides and corners are joined by chords; a chord is kept if both parameters
rise along it and both zeros are open, which is where the arc is a ruled developable.  Where two arcs cross in a cell
each goes on, or turns into the other.  Crossing arcs that leave a cell through one side are not seen there, as F has
one sign at both its ends: then the cells on both its sides are taken together.  Rails that share an end point have arcs
that begin there.
"""

from collections.abc import Iterable, Mapping, Sequence
from collections.abc import Set as AbstractSet

import numpy as np

from stages.geometry.arrays import Values, diagonal, norm
from stages.geometry.curves.curves import Curve
from stages.geometry.rails.crossing import crossing
from stages.geometry.rails.zeros import Field, Place, Zero, Zeros, mismatch_at

Chord = tuple[Place, Place]
"""Two zeros in one cell, in the order in which both parameters rise."""


def chords(found: Field, every: Zeros) -> list[Chord]:
    """Return the chords of the arcs along which both parameters rise and both zeros are open."""
    at_corner, cells = _at_corners(found, every), _cells(found, every)
    unseen = _unseen(found, every, cells)
    taken = {cell for row in unseen for cell in row}
    pairs = [pair for cell in cells if cell not in taken for pair in _joined(found, every, at_corner, cell)]
    pairs += [pair for row, middle in unseen.items() for pair in _through(every, _on_sides(every, row), middle)]
    rising = (_rising(every, pair) for pair in pairs)
    return [pair for pair in rising if pair is not None]


def shares_an_end(rail_a: Sequence[Curve], rail_b: Sequence[Curve]) -> bool:
    """Return whether rails begin, or end, in one point."""
    ends = [[rail[k].jet(np.array([v]), 0)[0, 0] for rail in (rail_a, rail_b)] for k, v in ((0, 0.0), (-1, 1.0))]
    size = max(float(norm(last - first)) for first, last in zip(*ends, strict=True))
    return any(float(norm(a - b)) <= SHARED * size for a, b in ends)


def from_shared_ends(found: Field, every: Zeros) -> list[Chord]:
    """Return the chords to the open zeros around the first and the last corner where the rails meet there.

    F and its slopes vanish there, and no normal tells whether the zero is open.
    """
    n, m = found.F.shape
    made: list[Chord] = []
    for (i, j), (k, h) in (((0, 0), (0, 0)), ((n - 1, m - 1), (n - 2, m - 2))):
        gap = float(norm(found.a.point[i] - found.b.point[j]))
        if gap <= SHARED * diagonal(found.a.point):
            end: Place = ("corner", i, j)
            sides: list[Place] = [("column", k, h), ("row", k, h)] if i else [("column", k + 1, h), ("row", k, h + 1)]
            made += [(place, end) if i else (end, place) for place in sides if place in every and every[place].open]
    return made


SHARED = 1e-12
"""Ends of rails this close, as a share of their extent, are one point."""


Cell = tuple[int, int]


def _cells(found: Field, every: Zeros) -> list[Cell]:
    """Return the cells with a zero on a side, by their lowest lines."""
    n, m = found.F.shape
    beside = {
        (i - back, j) if kind == "column" else (i, j - back) for kind, i, j in every for back in (0, 1)
    }  # fmt: skip
    inside_a, inside_b = found.a.inside, found.b.inside
    return sorted((i, j) for i, j in beside if 0 <= i < n - 1 and 0 <= j < m - 1 and inside_a[i] and inside_b[j])


def _at_corners(found: Field, every: Zeros) -> dict[Cell, Place]:
    """Return a zero at each corner of the lattice that has one: it is on two of the four lines that meet there."""
    i, j = np.nonzero(found.F == 0.0)
    at: dict[Cell, Place] = {}
    for n, m in zip(i.tolist(), j.tolist(), strict=True):
        around: list[Place] = [("column", n, m), ("column", n, m - 1), ("row", n, m), ("row", n - 1, m)]
        here = [place for place in around if place in every and _is_at(found, every[place], n, m)]
        if here:
            at[n, m] = here[0]
    return at


def _is_at(found: Field, zero: Zero, n: int, m: int) -> bool:
    return bool(max(abs(zero.t - found.a.value[n]), abs(zero.s - found.b.value[m])) <= SAME)


def _joined(found: Field, every: Zeros, at_corner: Mapping[Cell, Place], cell: Cell) -> list[Chord]:
    """Return which zeros on the sides and corners of a cell belong to one arc.

    Where two arcs cross in the cell those below the crossing and those above it; else, of four, the sign in the middle
    decides.
    """
    i, j = cell
    left, low, right, high = _sides(cell)
    there = _on_sides(every, [cell])
    for corner in ((i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)):
        place = at_corner.get(corner)
        if place and not any(_is_at(found, every[other], *corner) for other in there):
            there.append(place)
    if len(there) == len("ab"):
        return [(there[0], there[1])]
    if len(there) < len("abc"):
        return []
    middle = _crossing(found, [cell])
    if middle is not None:
        return _through(every, there, middle)
    if len(there) > len([side for side in there if side in (left, low, right, high)]):
        return [(p, q) for p in there for q in there if p < q]
    if (_middle(found, cell) >= 0.0) == (found.F[i, j] >= 0.0):
        return [(left, high), (low, right)]
    return [(left, low), (right, high)]


def _sides(cell: Cell) -> tuple[Place, Place, Place, Place]:
    """Return the sides of a cell: left, low, right, high."""
    i, j = cell
    return ("column", i, j), ("row", i, j), ("column", i + 1, j), ("row", i, j + 1)


def _on_sides(every: Zeros, row: Sequence[Cell]) -> list[Place]:
    """Return the zeros on the sides of cells."""
    return [side for cell in row for side in _sides(cell) if side in every]


def _unseen(found: Field, every: Zeros, cells: Sequence[Cell]) -> dict[tuple[Cell, ...], Values]:
    """Return the crossings of arcs that go unseen through the sides between cells in a row, by these cells.

    The first and the last cell have two zeros, none on a side between; those in the middle have none at all.
    """
    known = set(cells)
    two = {cell for cell in cells if len(_on_sides(every, [cell])) == len("ab")}
    rows = (_row(known, cell, step) for cell in cells if cell in two for step in ((1, 0), (0, 1)))
    apart = (row for row in rows if row[-1] in two and _is_parted(found, every, row))
    crossed = ((row, _crossing(found, row)) for row in apart)
    return {row: middle for row, middle in crossed if middle is not None}


def _row(known: AbstractSet[Cell], cell: Cell, step: Cell) -> tuple[Cell, ...]:
    """Return the cells from one to the next in a direction that has a zero, at most `UNSEEN` of them."""
    steps = ((k, (cell[0] + k * step[0], cell[1] + k * step[1])) for k in range(1, UNSEEN))
    last = next((k for k, beyond in steps if beyond in known), 0)
    return tuple((cell[0] + k * step[0], cell[1] + k * step[1]) for k in range(last + 1))


UNSEEN = 10
"""Cells: arcs that cross at slopes of a tenth in t and s are a whole cell apart five cells from the crossing."""


def _is_parted(found: Field, every: Zeros, row: Sequence[Cell]) -> bool:
    """Return whether cells, the first and the last of them apart, lie in one piece and share no side with a zero."""
    (i, j), (k, m) = row[0], row[-1]
    one_piece = found.a.inside[i : k + 1].all() and found.b.inside[j : m + 1].all()
    shared = {*_on_sides(every, row[:1])} & {*_on_sides(every, row[-1:])}
    return len(row) > 1 and bool(one_piece) and not shared


def _through(every: Zeros, there: Sequence[Place], middle: Values) -> list[Chord]:
    """Return the chords from zeros below a crossing to those above it."""
    return [(p, q) for p in there for q in there if p != q and _passes(every[p], middle, every[q])]


def _passes(first: Zero, middle: Values, second: Zero) -> bool:
    """Return whether both parameters rise from a zero to a crossing, and on to another zero."""
    t, s = middle.tolist()
    below = first.t <= t + SAME and first.s <= s + SAME
    return bool(below and second.t >= t - SAME and second.s >= s - SAME)


def _crossing(found: Field, row: Sequence[Cell]) -> Values | None:
    """Return where two arcs cross in cells in a row, by the parameters of the rails."""
    (i, j), (k, m) = row[0], row[-1]
    a, b = found.a, found.b
    number = np.array([a.piece[i], b.piece[j]])
    places = np.stack([a.local(np.array([i, k + 1])), b.local(np.array([j, m + 1]))], axis=1)
    place = crossing(a.pieces[number[0]], b.pieces[number[1]], places)
    return None if place is None else place + number


def _middle(found: Field, cell: Cell) -> float:
    """Return F in the middle of a cell."""
    i, j = cell
    a, b = found.a, found.b
    t, s = (float(line.value[k : k + 2].mean() - line.piece[k]) for line, k in ((a, i), (b, j)))
    r = a.pieces[a.piece[i]].jet(np.array([t]), 1)
    return float(mismatch_at(b.pieces[b.piece[j]], r[0], r[1], np.array([s]))[0])


def _rising(every: Zeros, chord: Chord) -> Chord | None:
    """Return the chord in rising order, or None."""
    first, second = (every[place] for place in chord)
    if not (first.open and second.open):
        return None
    t, s = second.t - first.t, second.s - first.s
    if min(t, s) >= -SAME and max(t, s) > 0.0:
        return chord
    return (chord[1], chord[0]) if max(t, s) <= SAME else None


SAME = 1e-13
"""Parameters closer than this are one: zeros are found to rounding, and a level arc must not seem to fall."""


def met(every: Zeros) -> Iterable[tuple[Place, Place]]:
    """Return the pairs of zeros at one place, both ways round, at which an arc goes on.

    An arc through a corner of the lattice ends on one line there and goes on from another; one that goes on over a
    break (without a kink, or where both tangents do) has a zero on either line of it.
    """
    found: dict[tuple[int, int], list[Place]] = {}
    for place, zero in every.items():
        if zero.open:
            cell = round(zero.t / ONE_PLACE), round(zero.s / ONE_PLACE)
            found.setdefault(cell, []).append(place)
    return (pair for cell in found for pair in _neighbours(found, cell))


def _neighbours(found: Mapping[tuple[int, int], list[Place]], cell: tuple[int, int]) -> Iterable[tuple[Place, Place]]:
    """Return the pairs of a place in a cell with another there, or in a cell beside it."""
    i, j = cell
    beside = [place for x in (i - 1, i, i + 1) for y in (j - 1, j, j + 1) for place in found.get((x, y), ())]
    return [(place, other) for place in found[cell] for other in beside if place != other]


ONE_PLACE = 1e-9
"""Zeros on both sides of a break are one if they are this close: tangents equal to rounding, over a flat crossing.
Twice as far at most are those that are taken for one."""
