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
from math import pi

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solveh_banded

from stages.errors import NoSolutionError
from stages.geometry.arrays import Array, ArrayValue, Mask, Points2, Values

Plane = NDArray[np.complex128]
"""Points as complex numbers, shape (samples,) or (joints,)."""

Joints = NDArray[np.int64]
"""Indices of the samples where arcs meet, first and last sample included, shape (joints,)."""

WIDEST_ARC_RAD = pi / 2.0
TRIAL_POINTS = 24
"""Points of an arc at which a trial is measured; the finished chain is measured at all samples."""

NEARLY_THERE, FULL = 1.1, 0.93
"""The end is tried if it is so little beyond a guess; an arc that uses so much of its tolerance will do."""

TRIALS, NEWTON_STEPS, ROUNDS, PATIENCE = 12, 12, 40, 10
"""PATIENCE: rounds without a change, each at half the tolerance, after which the arcs are as short as they may be.  An
arc whose end direction is kept departs further than the free one that the breaks were chosen for, by up to 8 times."""

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
class Stretch(ArrayValue):
    """A smooth stretch of a curve: samples, mm and rad, and whether its end directions must be kept."""

    points: Points2
    angle: Values
    keep_start: bool
    keep_end: bool


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
    place = _plane(stretch.points)
    best, between, breaks = float("inf"), 0.0, np.zeros(0, dtype=np.int64)
    stalled = 0
    for _ in range(ROUNDS):
        before, breaks = breaks, _breaks(stretch, place, accuracy * share, least_piece)
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
        far, between = _deviation(stretch, place, breaks, found)
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


def _breaks(stretch: Stretch, place: Plane, tolerance: Values, least_piece: float) -> Joints:
    """Return the indices of the samples where arcs meet, as few and as equal as the tolerance lets them be."""
    breaks, full = _greedy(stretch, place, tolerance, least_piece)
    count = breaks.size - 1
    # the last arc is what was left over; by the cubic law this tolerance would fill all of them alike
    scale = ((count - 1 + np.cbrt(min(full, 1.0))) / count) ** 3
    for power in EQUALISE:
        equal, _ = _greedy(stretch, place, tolerance * scale**power, least_piece)
        if equal.size == breaks.size:
            return equal
    return breaks


EQUALISE = (1.0, 0.7, 0.4, 0.2)
"""Powers of the levelling factor to try, the boldest first: a trial may need one arc more and is then dropped."""


def _greedy(stretch: Stretch, place: Plane, tolerance: Values, least_piece: float) -> tuple[Joints, float]:
    """Return breaks, each as far on as its arc may reach, and the share of its tolerance that the last arc uses."""
    last = place.size - 1
    travelled = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(place)))])
    breaks, width, full = [0], max(last // 8, 1), 0.0
    while breaks[-1] < last:
        start = breaks[-1]
        least = int(np.searchsorted(travelled, travelled[start] + least_piece))
        end, full = _longest(stretch.angle, place, tolerance, start, width)
        end = max(end, min(least, last))
        width = end - start
        breaks.append(end)
    if len(breaks) > 2 and travelled[last] - travelled[breaks[-2]] < least_piece:  # noqa: PLR2004  more than one arc
        del breaks[-2]
    if len(breaks) == 2 and stretch.keep_start and stretch.keep_end:  # noqa: PLR2004  one arc has one free end only
        breaks.insert(1, last // 2)
    return np.array(breaks), full


def _longest(angle: Values, place: Plane, tolerance: Values, start: int, width: int) -> tuple[int, float]:
    """Return the end of the longest arc from `start` found within the tolerance, and the share of it that it uses."""
    last = place.size - 1
    good, bad, used = start + 1, last + 1, 0.0
    end = min(start + width, last)
    for _ in range(TRIALS):
        excess = _excess(angle, place, tolerance, start, end)
        if excess <= 1.0:
            good, used = end, excess
        else:
            bad = end
        if bad - good <= 1 or FULL <= excess <= 1.0:
            break
        guess = start + int((end - start) * min(max(0.98 / np.cbrt(max(excess, 1e-9)), 0.25), 2.0))
        if bad > last and last - start < NEARLY_THERE * (guess - start):
            guess = last
        end = guess if good < guess < bad else (good + bad) // 2
    return good, used


def _excess(angle: Values, place: Plane, tolerance: Values, start: int, end: int) -> float:
    """Return the distance of the samples to the arc through two of them, as a multiple of the tolerance."""
    half = (angle[end] - angle[start]) / 2.0
    if abs(half) > WIDEST_ARC_RAD / 2.0 or end == start:
        return float(2.0 * (abs(half) / (WIDEST_ARC_RAD / 2.0)) ** 3)
    chord = complex(place[end] - place[start])
    heading = chord / abs(chord)
    stride = max((end - start) // TRIAL_POINTS, 1)
    offset = (place[start:end:stride] - place[start]) / (heading * complex(np.cos(half), -np.sin(half)))
    far = _from_circle(offset, np.array(2.0 * np.sin(half) / abs(chord)))
    return float(np.max(np.abs(far)) / tolerance[start : end + 1].min())


def _from_circle(offset: Plane, curvature: Array) -> Array:
    """Return the signed distance, mm, to the circle through 0 along the real axis; stable for all curvatures."""
    twice = 2.0 * offset.imag - curvature * (offset.real**2 + offset.imag**2)
    far: Array = twice / (1.0 + np.sqrt(np.maximum(1.0 - curvature * twice, 0.0)))
    return far


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
        step_move, step_turn = _least_step(miss, chord, normal, free_move, free_turn)
        move, turn = move + step_move, turn + step_turn
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


def _least_step(miss: Array, chord: Plane, normal: Plane, free_move: Array, free_turn: Array) -> tuple[Values, Values]:
    """Return the least weighted step in y and phi that cancels the linearised misses.

    d miss_k = a_k dy_k + b_k dy_(k+1) - dphi_k - dphi_(k+1); the weighted normal matrix is tridiagonal.
    """
    across = 1j * chord / np.abs(chord)
    lever = 2.0 / np.abs(chord)
    a = -lever * (normal[:-1] * across.conj()).real
    b = lever * (normal[1:] * across.conj()).real
    diagonal = a**2 * free_move[:-1] + b**2 * free_move[1:] + free_turn[:-1] + free_turn[1:]
    upper = np.zeros_like(diagonal)
    upper[1:] = b[:-1] * a[1:] * free_move[1:-1] + free_turn[1:-1]
    # one equation is no band: the solver refuses a matrix without neighbours
    weight = -solveh_banded(np.stack([upper, diagonal]), miss) if miss.size > 1 else -miss / diagonal
    left, right = np.append(weight, 0.0), np.insert(weight, 0, 0.0)
    move = free_move * (np.append(a, 0.0) * left + np.insert(b, 0, 0.0) * right)
    return move, -free_turn * (left + right)


def _deviation(stretch: Stretch, place: Plane, breaks: Joints, joined: _Joined) -> tuple[Array, float]:
    """Return the largest distance of the samples of each arc to it, and what may lie between samples, in mm."""
    piece = np.repeat(np.arange(breaks.size - 1), np.diff(breaks))
    vertices = _plane(joined.vertices)
    offset = (place[:-1] - vertices[piece]) * np.exp(-1j * joined.angle[piece])
    chord = np.abs(np.diff(vertices))
    curvature = 2.0 * np.sin(np.diff(joined.angle) / 2.0) / chord
    far = _from_circle(offset, curvature[piece])
    step = np.abs(np.diff(place))
    slope = np.diff(far) / np.maximum(step[:-1], np.finfo(float).tiny)
    bend = np.abs(np.diff(slope)) / 2.0 * np.maximum(step[:-2], step[1:-1])
    between = float(bend.max()) / 4.0 if bend.size else 0.0
    return np.maximum.reduceat(np.abs(far), breaks[:-1]), between


def _plane(points: Points2) -> Plane:
    """Return points as complex numbers."""
    plane: Plane = points[:, 0] + 1j * points[:, 1]
    return plane
