"""Where a strip bends most, one way or the other: its smallest radius of curvature with its place.

Along a ruling the radius is linear, so it is smallest at an end, u = 0 or u = 1.  The largest value at the Gauss nodes
and ends of the panels, which resolve rate and widths (`turning`), is zoomed into: sampled, not proved.
"""

from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Values, norm
from stages.geometry.numeric import quadrature
from stages.geometry.ruled.turning import FLAT, PatchTurning, Turning, is_fold, rates


@dataclass(frozen=True, slots=True)
class Tight:
    """Where a strip bends most one way: curvature in 1/mm (infinite at an apex), piece, v in it, u (0 or 1)."""

    curvature: float
    piece: int
    v: float
    u: float


Edge = tuple[int, float]
"""One edge of a strip: piece, and u = 0 or 1."""


def apexes(bends: Turning) -> frozenset[Edge]:
    """Return the edges that are points: all rulings of a piece meet there."""
    edges = ((i, u) for i in range(len(bends.pieces)) for u in (0.0, 1.0))
    return frozenset(edge for edge in edges if _is_point(bends.pieces[edge[0]], edge[1]))


def _is_point(piece: PatchTurning, u: float) -> bool:
    v = quadrature.nodes(piece.breaks[:-1], piece.breaks[1:]).ravel()
    c0, c1 = (float(norm(curve.jet(v, 1)[1]).max()) for curve in (piece.patch.c0, piece.patch.c1))
    return c0 <= APEX * c1 if u == 0.0 else c1 <= APEX * c0


def tightest(bends: Turning, sign: float, beside: frozenset[Edge] = frozenset()) -> Tight | None:
    """Return where a strip bends most towards sign * N, edges `beside` left out; None where it does not bend that way.

    Folds do not count.
    """
    bent = {s.piece for s in bends.stretches if sign * s.angle_rad > FLAT and not is_fold(s)}
    edges = [(i, u) for i in sorted(bent) for u in (0.0, 1.0) if (i, u) not in beside]
    found = [_tightest(bends.pieces[i], i, u, sign) for i, u in edges]
    return max(found, key=lambda tight: tight.curvature, default=None)


def _tightest(piece: PatchTurning, index: int, u: float, sign: float) -> Tight:
    nodes = quadrature.nodes(piece.breaks[:-1], piece.breaks[1:]).ravel()
    v = np.unique(np.concatenate([piece.breaks, nodes]))
    values = _bend(piece, u, sign, v)
    top = int(np.argmax(values))
    best, place = float(values[top]), float(v[top])
    low, high = v[max(top - 1, 0)], v[min(top + 1, v.size - 1)]
    while best < np.inf and high - low > NARROW:
        around = np.linspace(low, high, PER_ZOOM)
        values = _bend(piece, u, sign, around)
        top = int(np.argmax(values))
        if values[top] > best:
            best, place = float(values[top]), float(around[top])
        low, high = around[max(top - 1, 0)], around[min(top + 1, PER_ZOOM - 1)]
    return Tight(best, index, place, u)


PER_ZOOM = 17
NARROW = 1e-7
"""Over so small a share of the patch a smooth maximum is flat to 1e-14."""


def _bend(piece: PatchTurning, u: float, sign: float, v: Values) -> Values:
    """Return the curvature towards sign * N at u = 0 or 1; infinite at an apex that bends."""
    beta, *widths = rates(piece.patch, piece.normal, v).T
    width = np.maximum(widths[int(u)], 0.0)
    at_apex = np.where(sign * beta > TURNS, np.inf, 0.0)
    bend: Values = np.divide(sign * beta, width, out=at_apex, where=width > APEX * np.abs(widths).max(axis=0))
    return bend


APEX = 1e-13
"""A width below this share of the other edge's is rounding: an apex."""
TURNS = 1e-12
"""A rate of turning below this, rad per unit of v, is rounding."""
