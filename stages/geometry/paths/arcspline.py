"""A smooth (G1) chain of few arcs through a smooth stretch of a sampled curve, within a stated distance.

Let the curvature grow as k' s.  An arc over the length h through two points of the curve, turning as much as it, stays
within 0.0080 k' h^3; each half of a biarc along exact tangents within 0.0247 k' h^3.  So where the directions at the
joints are free, 1.45 times fewer arcs do.  The method:

1. Breaks: from each point take the longest arc (ends on the curve, the curve's own turn) within the tolerance; then
   lower the tolerance until the last arc is as full as the others.
2. Joints: let the inner points move by y along the normals and the directions turn by phi, by the least weighted
   amount that makes all arcs meet smoothly: Newton's method with a least-norm step on n equations.
3. Measure the result at all points.  Where it is too far, lower the tolerance of step 1 there and repeat.

Distances are measured at the samples; in between, the second difference bounds what is missed (a measurement, not a
proof).  Each sample projects onto its own arc and the arcs meet, so the bound holds in both directions.  Points and
directions are complex numbers here.  Chains of arcs through data: [1]_.

.. [1] D. S. Meek, D. J. Walton, "Approximation of discrete data by G1 arc splines", Computer-Aided Design 24(6), 1992.
"""

from dataclasses import dataclass

import numpy as np

from stages.errors import NoSolutionError
from stages.geometry.arrays import Array, ArrayValue, Mask, Points2, Values
from stages.geometry.paths.arcbreaks import Joints, Plane, Stretch, as_plane, breaks_within, from_circle

NEWTON_STEPS, ROUNDS, PATIENCE = 12, 40, 10
"""PATIENCE: rounds without a change, each at half the tolerance, after which the arcs are as short as they may be.  An
arc whose end direction is kept departs further than the free one that the breaks were chosen for."""

MET = 1e-13
"""Joints that turn by less (rad) are smooth to rounding."""

UNEVEN = 1e-6
"""A chain whose joints turn by more (rad) is not a solution: Newton's method has not arrived, its arcs are too long."""

MOVE, TURN = 0.25, 2.0
"""Weights of step 2: y counts in MOVE tolerance, phi in TURN tolerance / arc length (the natural phi is about 10)."""

SETTLED_DENSITY = 0.05
"""Share of the tolerance that may lie between samples before the caller has to take more of them."""


ENOUGH = 64
"""Samples per arc beyond which more of them would not place the joints better."""


class TooSparseError(NoSolutionError):
    """The samples are too few to say, or to place the joints between them."""


@dataclass(frozen=True, slots=True, eq=False)
class Chain(ArrayValue):
    """Vertices in mm, one bulge fewer for the pieces between them, and the reached distance in mm.

    between_mm: the part of `reached_mm` that allows for what lies between samples.
    """

    vertices: Points2
    bulges: Array
    reached_mm: float
    between_mm: float


def chain(stretch: Stretch, *, accuracy: float, least_piece: float) -> Chain:
    """Return a smooth chain of arcs within `accuracy` mm, no piece shorter than `least_piece` mm.

    Raises TooSparseError if more samples could help, else NoSolutionError.
    """
    share = np.ones(stretch.angle.size)
    place = as_plane(stretch.points)
    best, between, breaks = float("inf"), 0.0, np.zeros(0, dtype=np.int64)
    stalled = 0
    for _ in range(ROUNDS):
        before, breaks = breaks, breaks_within(stretch, place, accuracy * share, least_piece)
        if np.array_equal(before, breaks):
            stalled += 1
            share *= 0.5
        else:
            stalled = 0
        if stalled == PATIENCE:
            break
        found = _joined(stretch, place, breaks, accuracy)
        if found.miss > UNEVEN:
            share *= 0.5
            continue
        far, between = _deviation(place, breaks, found)
        if far.max() + between <= accuracy:
            return Chain(found.vertices, found.bulges, float(far.max()) + between, between)
        best = min(best, float(far.max()) + between)
        if between > accuracy * SETTLED_DENSITY:
            break
        if _at_least(place, breaks, far + between > accuracy, least_piece) and stalled:
            break
        _tighten(share, breaks, far + between, accuracy)
    sparse = between > accuracy * SETTLED_DENSITY or place.size < ENOUGH * breaks.size
    raise (TooSparseError if sparse else NoSolutionError)(
        "arcs along an edge", reached=best, wanted=accuracy, unit="mm"
    )


def _at_least(place: Plane, breaks: Joints, too_far: Mask, least_piece: float) -> bool:
    """Return whether an arc that is too far is as short as may be: it ends at the first sample past `least_piece`."""
    before_end = np.abs(place[np.maximum(breaks[1:] - 1, breaks[:-1])] - place[breaks[:-1]])
    return bool((too_far & (before_end < least_piece)).any())


def _tighten(share: Array, breaks: Joints, far: Array, accuracy: float) -> None:
    """Lower the share of the tolerance on the arcs that are too far, and half as much on their neighbours."""
    factor = np.where(far > accuracy, np.clip(TIGHTER * accuracy / far, 0.5, 1.0), 1.0)
    beside = np.sqrt(np.minimum(np.append(factor[1:], 1.0), np.insert(factor[:-1], 0, 1.0)))
    share[:-1] *= np.repeat(np.minimum(factor, beside), np.diff(breaks))
    share[-1] = share[-2]


TIGHTER = 0.9
"""Aim a little below the tolerance: 0.95 costs twice the rounds for no arc fewer, 0.75 costs an arc in twenty."""


@dataclass(frozen=True, slots=True, eq=False)
class _Joined:
    """Vertices, bulges, directions at the vertices in rad, and by how much the worst joint still turns, in rad."""

    vertices: Points2
    bulges: Array
    angle: Values
    miss: float


def _joined(stretch: Stretch, place: Plane, breaks: Joints, accuracy: float) -> _Joined:
    """Return the arcs that meet smoothly, as near as can be to the curve's points and their natural directions."""
    count = breaks.size - 1
    normal = 1j * np.exp(1j * stretch.angle[breaks])
    move = np.zeros(count + 1)
    turn = _natural(stretch, place, breaks)
    free_move, free_turn = _freedom(stretch, np.abs(np.diff(place[breaks])), accuracy)
    angle = stretch.angle[breaks]
    for _ in range(NEWTON_STEPS):
        vertices = place[breaks] + move * normal
        chord = np.diff(vertices)
        along = angle[:-1] + np.angle(chord * np.exp(-1j * angle[:-1]))
        heading = angle + turn
        miss = 2.0 * along - heading[:-1] - heading[1:]
        if np.max(np.abs(miss)) <= MET:
            break
        step = _least_step(miss, chord, normal, free_move, free_turn)
        if step is None:
            break
        move, turn = move + step[0], turn + step[1]
    bulges = np.tan(np.diff(heading) / 4.0)
    return _Joined(np.stack([vertices.real, vertices.imag], axis=1), bulges, heading, float(np.max(np.abs(miss))))


def _natural(stretch: Stretch, place: Plane, breaks: Joints) -> Values:
    """Return the turns phi that the arcs by themselves would have at the joints, mean of both sides, in rad."""
    angle = stretch.angle[breaks]
    chord = np.diff(place[breaks])
    along = angle[:-1] + np.angle(chord * np.exp(-1j * angle[:-1]))
    own = along - (angle[:-1] + angle[1:]) / 2.0
    turn = np.concatenate([own[:1], (own[:-1] + own[1:]) / 2.0, own[-1:]])
    turn[0] *= not stretch.keep_start
    turn[-1] *= not stretch.keep_end
    return turn


def _freedom(stretch: Stretch, chord: Array, accuracy: float) -> tuple[Values, Values]:
    """Return the squared sizes within which y (mm) and phi (rad) may move; 0 where they must stay."""
    move = np.full(chord.size + 1, (MOVE * accuracy) ** 2)
    move[[0, -1]] = 0.0
    around = np.concatenate([chord[:1], (chord[:-1] + chord[1:]) / 2.0, chord[-1:]])
    turn = (TURN * accuracy / around) ** 2
    turn[0] *= not stretch.keep_start
    turn[-1] *= not stretch.keep_end
    return move, turn


def _least_step(
    miss: Array, chord: Plane, normal: Plane, free_move: Array, free_turn: Array
) -> tuple[Values, Values] | None:
    """Return the least weighted step in y and phi that cancels the linearised misses, if they can be told apart.

    d miss_k = a_k dy_k + b_k dy_(k+1) - dphi_k - dphi_(k+1); the weighted normal matrix is tridiagonal.
    """
    from scipy.linalg import solveh_banded

    across = 1j * chord / np.abs(chord)
    lever = 2.0 / np.abs(chord)
    a = -lever * (normal[:-1] * across.conj()).real
    b = lever * (normal[1:] * across.conj()).real
    diagonal = a**2 * free_move[:-1] + b**2 * free_move[1:] + free_turn[:-1] + free_turn[1:]
    upper = np.zeros_like(diagonal)
    upper[1:] = b[:-1] * a[1:] * free_move[1:-1] + free_turn[1:-1]
    try:
        # one equation is no band: the solver refuses a matrix without neighbours
        weight = -solveh_banded(np.stack([upper, diagonal]), miss) if miss.size > 1 else -miss / diagonal
    except np.linalg.LinAlgError:  # equal equations up to rounding, where chords are far below the freedom to move
        return None
    left, right = np.append(weight, 0.0), np.insert(weight, 0, 0.0)
    move = free_move * (np.append(a, 0.0) * left + np.insert(b, 0, 0.0) * right)
    return move, -free_turn * (left + right)


def _deviation(place: Plane, breaks: Joints, joined: _Joined) -> tuple[Array, float]:
    """Return the largest distance of the samples of each arc to it, and what may lie between samples, in mm."""
    piece = np.repeat(np.arange(breaks.size - 1), np.diff(breaks))
    vertices = as_plane(joined.vertices)
    offset = (place[:-1] - vertices[piece]) * np.exp(-1j * joined.angle[piece])
    chord = np.abs(np.diff(vertices))
    curvature = 2.0 * np.sin(np.diff(joined.angle) / 2.0) / chord
    far = from_circle(offset, curvature[piece])
    step = np.abs(np.diff(place))
    slope = np.diff(far) / np.maximum(step[:-1], np.finfo(float).tiny)
    bend = np.abs(np.diff(slope)) / 2.0 * np.maximum(step[:-2], step[1:-1])
    between = float(bend.max()) / 4.0 if bend.size else 0.0
    return np.maximum.reduceat(np.abs(far), breaks[:-1]), between
