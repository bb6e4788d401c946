"""The way of a ruling along two rails, its corners put exactly onto F = 0: from lattice places to legs.

Stops with one move between them are one leg.  All corners are then solved for together: a smooth one must lie on F = 0,
both ends of a cone share the parameter of its apex.  That leaves some corners free to move; each Newton step is the
least change that meets all equations, so that corners neither drift nor overtake each other.  A leg that would run
backwards is dropped and the rest solved again.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from stages.errors import NoSolutionError
from stages.geometry.arrays import Array, ArrayValue, Values, norm
from stages.geometry.curves import Curve
from stages.geometry.linked import Linked, arc, mismatch
from stages.geometry.railgraph import ONE_PLACE, Move, Stop

Rail = Sequence[Curve]


@dataclass(frozen=True, slots=True, eq=False)
class Leg(ArrayValue):
    """One move: `along` an arc of F = 0, `on_a` (s at rest) or `on_b` (t at rest).

    knots: of (t, s), rising, shape (n, 2), n >= 2.
    folds: whether it meets the next leg in a fold.
    """

    move: Move
    knots: Array
    folds: bool = False

    @property
    def length(self) -> float:
        """Return how far the parameters rise."""
        return float((self.knots[-1] - self.knots[0]).sum())


def legs(stops: Sequence[Stop]) -> tuple[Leg, ...]:
    """Return the legs of a way, without those of no length."""
    runs: list[list[Stop]] = []
    for stop in stops:
        if runs and runs[-1][-1].move == stop.move and not _over_break(runs[-1][-1], stop):
            runs[-1].append(stop)
        else:
            runs.append([stop])
    made = [Leg(run[0].move, np.array([(stop.t, stop.s) for stop in run]), run[-1].fold) for run in runs]
    return _merged([leg for leg in made if leg.length > TINY])


def _over_break(before: Stop, after: Stop) -> bool:
    """Return whether an arc goes from one piece of a rail to the next between two stops."""
    here = np.array([before.t, before.s])
    apart = abs(after.t - before.t) + abs(after.s - before.s)
    return before.move == "along" and apart <= ONE_PLACE and _at_break(here)


TINY = 1e-12
"""A leg along which the parameters rise by less is a corner."""


def _merged(parts: Sequence[Leg]) -> tuple[Leg, ...]:
    """Return the legs with those joined that a corner of no length had kept apart, unless a break lies between."""
    merged: list[Leg] = []
    for leg in parts:
        last = merged[-1] if merged else None
        if last is not None and last.move == leg.move and (leg.move != "along" or not _at_break(leg.knots[0])):
            merged[-1] = leg.replace(knots=np.vstack([last.knots, leg.knots[1:]]))
        else:
            merged.append(leg)
    return tuple(merged)


def _at_break(corner: Values) -> bool:
    """Return whether a corner lies between two pieces of a rail."""
    return bool((np.abs(corner - np.round(corner)) <= TINY).any())


def solved(parts: Sequence[Leg], rail_a: Rail, rail_b: Rail) -> tuple[Leg, ...]:
    """Return the legs with their corners exact.  Raises NoSolutionError where they do not converge."""
    parts = tuple(parts)
    for _ in range(len(parts) + 1):
        corners = _corners(parts, rail_a, rail_b)
        rises = np.diff(corners, axis=0).min(axis=1)
        if (rises >= -TINY).all():
            made = _merged(_legs_between(parts, corners))
            _refuse_gaps(made, rail_a, rail_b)
            return made
        backwards = [k for k in range(len(parts)) if rises[k] < -TINY]
        shortest = min(backwards, key=lambda k: parts[k].length)
        parts = _without(parts, shortest)
    raise NoSolutionError("corners of the strip", reached=float(-rises.min()), wanted=TINY, unit="of a piece backwards")


def _refuse_gaps(parts: Sequence[Leg], rail_a: Rail, rail_b: Rail) -> None:
    """Raise NoSolutionError where two knots do not lie on one arc: a corner has come to another branch of F = 0."""
    for leg in parts:
        if leg.move == "along" and not _level(leg.knots[0], leg.knots[-1]):
            link = linked(leg.knots, rail_a, rail_b, on_b=False)
            w = (link.w[:-1] + link.w[1:]) / 2.0
            t = arc(link, w, 0)[0]
            r, c = link.a.jet(t, 1), link.b.jet(w - t, 1)
            size = norm(r[1]) * norm(c[0] - r[0]) * norm(c[1])
            off = float((np.abs(mismatch(link.a, link.b, t, w - t)) / size).max())
            if off > ON_ARC:
                raise NoSolutionError("an arc between two corners", reached=off, wanted=ON_ARC, unit="of |r'||p||c'|")


ON_ARC = 1e-9
"""A thousand roundings of F; off every arc F is the sine of a warp that is seen."""


def linked(knots: Array, rail_a: Rail, rail_b: Rail, *, on_b: bool) -> Linked:
    """Return one of the rails along an arc by its knots, which lie in one piece of each rail."""
    i, j = (int(np.floor(knots[:, axis].mean())) for axis in (0, 1))
    if (np.abs(knots - np.array([i, j]) - MIDDLE) > MIDDLE + TINY).any():
        raise ValueError("an arc must lie in one piece of each rail")
    t, s = np.clip(knots[:, 0] - i, 0.0, 1.0), np.clip(knots[:, 1] - j, 0.0, 1.0)
    w = t + s
    kept = np.append(True, np.diff(w) > TINY)
    return Linked(rail_a[i], rail_b[j], w[kept], t[kept], on_b)


MIDDLE = 0.5


def _without(parts: tuple[Leg, ...], k: int) -> tuple[Leg, ...]:
    """Return the legs without one, its neighbours brought together at its middle."""
    middle = (parts[k].knots[0] + parts[k].knots[-1]) / 2.0
    left, right = list(parts[:k]), list(parts[k + 1 :])
    if left:
        left[-1] = left[-1].replace(knots=np.vstack([left[-1].knots[:-1], middle]))
    if right:
        right[0] = right[0].replace(knots=np.vstack([middle, right[0].knots[1:]]))
    return _merged([*left, *right])


def _legs_between(parts: Sequence[Leg], corners: Array) -> tuple[Leg, ...]:
    """Return the legs with their ends at the corners and the knots between that still rise."""
    made = []
    for leg, (low, high) in zip(parts, pairwise(corners), strict=True):
        start, end = np.maximum(low, 0.0), np.maximum(high, np.maximum(low, 0.0))
        if leg.move == "along":
            inner = leg.knots[1:-1]
            clear = ((inner > start + TINY) & (inner < end - TINY)).all(axis=1)
            level = (inner >= start - TINY).all(axis=1) & (inner <= end + TINY).all(axis=1) & _level(start, end)
            knots = np.vstack([start, inner[clear | level], end])
        else:
            knots = np.stack([start, end])
        if (end - start).sum() > TINY:
            made.append(leg.replace(knots=knots))
    return tuple(made)


def _level(start: Values, end: Values) -> bool:
    """Return whether an arc keeps one of the parameters."""
    return bool((end - start).min() <= TINY)


def _corners(parts: Sequence[Leg], rail_a: Rail, rail_b: Rail) -> Array:
    """Return all corners of a path, the first and the last ruling among them, shape (legs + 1, 2)."""
    fixed = parts[0].knots[0], parts[-1].knots[-1]
    corners = np.stack([*(leg.knots[0] for leg in parts), fixed[1]])
    cells = [_cell(before, after) for before, after in pairwise(parts)]
    most = 1.0 / LONGEST_STEP
    error = np.inf
    for _ in range(STEPS):
        rows, rest = _equations(parts, corners, cells, rail_a, rail_b)
        if not rows.size:
            return corners
        error = float(np.abs(rest).max())
        step = np.linalg.lstsq(rows, -rest, rcond=DEPENDENT)[0].reshape(-1, 2)
        size = float(np.abs(step).max())
        corners[1:-1] += step * min(1.0, most / size if size > 0.0 else 1.0)
        if size <= CONVERGED:
            break
    if error > REACHED:
        raise NoSolutionError("corners of the strip", reached=error, wanted=REACHED, unit="of a piece")
    return corners


STEPS = 40
LONGEST_STEP = 50
"""A corner moves by at most a fiftieth of a piece at a time: the lattice found it nearer than that."""
DEPENDENT = 1e-10
"""Equations that depend on each other to this degree are one: level arcs, cones at a break."""
CONVERGED = 1e-15
REACHED = 1e-11
"""Corners are exact when all equations hold to this share of a piece: a thousand roundings of F."""

Cell = tuple[int, int]


def _cell(before: Leg, after: Leg) -> Cell:
    """Return the pieces of both rails whose tangents count where two legs meet: each leg's own, as it touches them."""
    t, s = after.knots[0]
    a = _piece_of(before, 0, arriving=True) if before.move != "on_b" else _piece_of(after, 0, arriving=False)
    b = _piece_of(before, 1, arriving=True) if before.move != "on_a" else _piece_of(after, 1, arriving=False)
    return (
        a if a is not None else int(np.floor(t)),
        b if b is not None else int(np.floor(s)),
    )


def _piece_of(leg: Leg, axis: int, *, arriving: bool) -> int | None:
    """Return the piece in which a leg ends or begins; None if it rests on that rail."""
    x = leg.knots[:, axis]
    if x[-1] - x[0] <= TINY:
        return None
    return int(np.ceil(x[-1] - TINY)) - 1 if arriving else int(np.floor(x[0] + TINY))


def _equations(
    parts: Sequence[Leg], corners: Array, cells: Sequence[Cell], rail_a: Rail, rail_b: Rail
) -> tuple[Array, Values]:
    """Return the equations on the inner corners: their gradients, shape (k, 2 * inner), and how far they are off."""
    inner = len(parts) - 1
    rows: list[Values] = []
    rest: list[float] = []

    def add(terms: Sequence[tuple[int, int, float]], value: float) -> None:
        row = np.zeros((inner + 2, 2))
        for corner, axis, slope in terms:
            row[corner, axis] += slope
        if row[1:-1].any():
            rows.append(row[1:-1].ravel())
            rest.append(value)

    for k, (leg, cell) in enumerate(zip(parts[:-1], cells, strict=True), start=1):
        if not leg.folds:
            value, by_t, by_s = _mismatch(rail_a, rail_b, corners[k], cell)
            add([(k, 0, by_t), (k, 1, by_s)], value)
    for k, leg in enumerate(parts):
        if leg.move != "along":
            axis = 1 if leg.move == "on_a" else 0
            add([(k, axis, -1.0), (k + 1, axis, 1.0)], float(corners[k + 1, axis] - corners[k, axis]))
    for corner, axis, value in _breaks(parts):
        add([(corner, axis, 1.0)], float(corners[corner, axis] - value))
    return (np.stack(rows) if rows else np.zeros((0, 2 * inner))), np.array(rest)


def _breaks(parts: Sequence[Leg]) -> list[tuple[int, int, float]]:
    """Return the inner corners that lie on a break of a rail, and must stay there: corner, axis, parameter."""
    found = []
    for k, (before, after) in enumerate(pairwise(parts), start=1):
        for axis in (0, 1):
            value = float(after.knots[0, axis])
            rests = _piece_of(before, axis, arriving=True) is None or _piece_of(after, axis, arriving=False) is None
            crosses = _piece_of(before, axis, arriving=True) != _piece_of(after, axis, arriving=False)
            if abs(value - round(value)) <= TINY and (rests or crosses):
                found.append((k, axis, float(round(value))))
    return found


def _mismatch(rail_a: Rail, rail_b: Rail, corner: Values, cell: Cell) -> tuple[float, float, float]:
    """Return F and its derivatives at a corner, scaled so that the gradient has length 1 (0 where it vanishes)."""
    (t, s), i, j = corner, min(cell[0], len(rail_a) - 1), min(cell[1], len(rail_b) - 1)
    r, c = rail_a[i].jet(np.array([t - i]), 2)[:, 0], rail_b[j].jet(np.array([s - j]), 2)[:, 0]
    arm = c[0] - r[0]
    value = float(np.cross(r[1], arm) @ c[1])
    slopes = np.array([np.cross(r[2], arm) @ c[1], np.cross(r[1], arm) @ c[2]])
    scale = float(norm(r[1]) * norm(arm) * norm(c[1]))
    steep = float(norm(slopes))
    if steep <= FLAT * scale:
        return value / scale, 0.0, 0.0
    return value / steep, float(slopes[0]) / steep, float(slopes[1]) / steep


FLAT = 1e-9
"""Where F hardly changes over a whole piece, there is nothing to solve: two planes, or one cone."""
