"""The corners of a strip between two rails, put exactly onto F = 0 all at once.

A strip is a chain of legs, each with one move.  A corner without a fold must lie on F = 0, both ends of a cone share
the parameter of its apex, and a corner on a break of a rail stays there.  That leaves some corners free to move; each
Newton step is the least change that meets all equations, so that corners neither drift nor overtake each other.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from stages.errors import NoSolutionError
from stages.geometry.arrays import Array, ArrayValue, Values, norm
from stages.geometry.curves.curves import Curve
from stages.geometry.rails.graph import Move

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


TINY = 1e-12
"""A leg along which the parameters rise by less is a corner."""


def corners_of(parts: Sequence[Leg], rail_a: Rail, rail_b: Rail) -> Array:
    """Return all corners of a path, the first and the last ruling among them, shape (legs + 1, 2)."""
    fixed = parts[0].knots[0], parts[-1].knots[-1]
    corners = np.stack([*(leg.knots[0] for leg in parts), fixed[1]])
    cells = [cell_of(before, after) for before, after in pairwise(parts)]
    most = 1.0 / LONGEST_STEP
    error = np.inf
    for _ in range(STEPS):
        rows, rest = equations(parts, corners, cells, rail_a, rail_b)
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


def cell_of(before: Leg, after: Leg) -> Cell:
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


def equations(
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
            value, by_t, by_s = _rail_mismatch(rail_a, rail_b, corners[k], cell)
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


def _rail_mismatch(rail_a: Rail, rail_b: Rail, corner: Values, cell: Cell) -> tuple[float, float, float]:
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
