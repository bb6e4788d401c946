"""Points along an exact plane curve, dense enough to stand for it, and its length and area.

A grid of t is halved until the cubic Hermite curve through its points and derivatives meets the exact curve half-way
in each interval, in place and in direction [1]_.  The check is a measurement at those points, not a proof: a curve
that swings more often than about ten times on [0, 1] may fool the first grid.  Derivatives may vanish or be infinite at
t = 0 and 1, and corners inside are found by the grid closing in on them.  A jump is an error.

Length and area are integrated by Gauss's rule on each interval of that grid, twice, with different numbers of nodes.

.. [1] C. de Boor, "A Practical Guide to Splines", rev. ed., ch. IV, 2001.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from stages.errors import NoSolutionError
from stages.geometry.arrays import Array, ArrayValue, Indices, Mask, Points2, Values, cross2, norm
from stages.geometry.curves.plane import PlaneCurve
from stages.geometry.curves.planespline import Spline
from stages.geometry.flat.mapped import MappedEdge

Intervals = NDArray[np.bool_]
"""One truth per interval of a grid, one fewer than nodes."""

FIRST_INTERVALS = 32
HALVINGS = 6
"""After so many halvings only an end or a corner can be left; there intervals are cut into more parts at a time."""

FINE_PARTS = 16
LEAST_INTERVAL = 1e-14
"""No interval of t is cut below this: the doubles near t = 1 are 1e-16 apart."""

MOST_NODES = 30_000
"""A grid of more stands for no edge that is cut: a circle of 100 m takes 5000 at a chord of 0.01 mm."""

VANISHED = 1e-9
"""A derivative below this share of the curve's size has lost its direction to rounding."""

NEARBY = (1e-7, 1e-5, 1e-3)
"""How far inside to look, in t, for the direction at an end where the derivative vanishes or is infinite."""

RULES = legendre.leggauss(7), legendre.leggauss(10)
"""Gauss's rules of 7 and of 10 nodes to an interval: what three more change tells how exact both are."""


@dataclass(frozen=True, slots=True, eq=False)
class Samples(ArrayValue):
    """Points along a curve, first and last at its ends.

    t: parameters, rising.
    points: places in mm.
    angle: directions of travel in rad, made continuous.
    """

    t: Values
    points: Points2
    angle: Values


@dataclass(frozen=True, slots=True, eq=False)
class Resolved:
    """A curve and the nodes of its Hermite curve; derivatives that are not finite are 0."""

    curve: PlaneCurve
    t: Values
    points: Points2
    slopes: Points2


def samples(known: Resolved, *, count: int) -> Samples:
    """Return `count` points of the curve, exact, spread evenly over length and turning together."""
    t = _spread(known, count)
    points = known.curve.at(t)
    return Samples(t, points, np.unwrap(_angles(known.curve, t, points)))


def dense_points(known: Resolved, *, accuracy: float) -> Points2:
    """Return points of the curve whose polygon is within `accuracy` mm of it.

    The height of an arc over its chord is step * turn / 8; steps and turns are measured on the points themselves.

    Raises NoSolutionError if that takes more than `MOST_POINTS`.
    """
    count = FIRST_INTERVALS * 2
    while True:
        found = samples(known, count=count + 1)
        step = norm(np.diff(found.points, axis=0))
        height = float(np.max(step * np.minimum(np.abs(np.diff(found.angle)), 1.0))) / 8.0
        if height <= accuracy:
            return found.points
        if count > MOST_POINTS:
            raise NoSolutionError("points along an edge", reached=height, wanted=accuracy, unit="mm")
        count = int(count * min(max(1.1 * np.sqrt(height / accuracy), 1.5), 16.0))


MOST_POINTS = 2_000_000
"""Some 100 MB: an edge that asks for more has no length that can be measured."""


def length_and_area(edges: Sequence[Resolved], *, accuracy: float) -> tuple[float, float]:
    """Return the length in mm and the signed area in mm2 of the contour that the edges close.

    accuracy: relative, of the length and of the area (against length^2).

    Raises NoSolutionError if two rules of integration differ by more.
    """
    middle = np.mean([edge.points[0] for edge in edges], axis=0)
    coarse, fine = np.sum([_integrals(edge, middle) for edge in edges], axis=0)
    scale = np.array([fine[0], fine[0] ** 2])
    error = float(np.max(np.abs(fine - coarse) / np.where(scale > 0.0, scale, 1.0)))
    if not error <= accuracy:
        raise NoSolutionError("length and area of a contour", reached=error, wanted=accuracy)
    return float(fine[0]), float(fine[1])


def _integrals(edge: Resolved, middle: Array) -> Array:
    """Return length and area swept about `middle`, by two rules, shape (2, 2); splines piece by piece."""
    breaks = np.union1d(edge.t, edge.curve.breaks) if isinstance(edge.curve, Spline | MappedEdge) else edge.t
    return np.array([_gauss(edge.curve, breaks, rule, middle) for rule in RULES])


def _gauss(edge: PlaneCurve, breaks: Values, rule: tuple[Array, Array], middle: Array) -> Array:
    """Return length and area by Gauss's rule, its nodes and weights, between each two breaks, shape (2,)."""
    x, w = rule
    half = np.diff(breaks) / 2.0
    t = (breaks[:-1] + half)[:, None] + half[:, None] * x
    weight = (half[:, None] * w).ravel()
    points, slopes = edge.at(t.ravel()) - middle, edge.derivative(t.ravel())
    return np.array([weight @ norm(slopes), weight @ cross2(points, slopes) / 2.0])


def not_too_large(edges: Sequence[PlaneCurve], accuracy: float) -> Sequence[PlaneCurve]:
    """Return the edges of a contour; `NoSolutionError` where it is absurdly large, before it is sampled finely."""
    size = float(np.max(np.ptp(np.concatenate([edge.at(FEW) for edge in edges]), axis=0)))
    if size > MOST_ACCURACIES * accuracy:
        raise NoSolutionError("the size of a contour", reached=size, wanted=MOST_ACCURACIES * accuracy, unit="mm")
    return edges


FEW = np.linspace(0.0, 1.0, 9)
MOST_ACCURACIES = 1e8
"""A circle of that size takes 20 000 chords; what is larger is not cut, or not as exactly as it is asked for."""


def resolved(curve: PlaneCurve, *, accuracy: float) -> Resolved:
    """Return a grid whose Hermite curve is within `accuracy` mm of the exact one half-way in each interval.

    Raises NoSolutionError if the curve jumps, or takes more than `MOST_NODES`.
    """
    grid = _nodes(curve, np.linspace(0.0, 1.0, FIRST_INTERVALS + 1))
    unsettled = np.ones(FIRST_INTERVALS, dtype=bool)
    level = 0
    while unsettled.any():
        parts = 2 if level < HALVINGS else FINE_PARTS
        grid, unsettled = _refined(curve, grid, unsettled, parts, accuracy)
        level += 1
    return grid


def _refined(
    curve: PlaneCurve, grid: Resolved, unsettled: Intervals, parts: int, accuracy: float
) -> tuple[Resolved, Intervals]:
    """Return the grid with its unsettled intervals cut, and which of the new intervals are still unsettled."""
    which = np.flatnonzero(unsettled)
    fraction = np.arange(1, parts) / parts
    width = np.diff(grid.t)[which]
    fresh = _nodes(curve, (grid.t[which][:, None] + width[:, None] * fraction).ravel())
    error = _hermite_error(grid, which, fresh, parts)
    wrong = error > accuracy
    if (wrong & (width < LEAST_INTERVAL * parts)).any():
        gap = float(np.max(norm(np.diff(grid.points, axis=0))[which][wrong & (width < LEAST_INTERVAL * parts)]))
        raise NoSolutionError("an edge that jumps", reached=gap, wanted=accuracy, unit="mm")
    if wrong.any() and grid.t.size > MOST_NODES:
        raise NoSolutionError("points along an edge", reached=float(error.max()), wanted=accuracy, unit="mm")
    place = np.repeat(which + 1, parts - 1)
    merged = Resolved(
        curve,
        np.insert(grid.t, place, fresh.t),
        np.insert(grid.points, place, fresh.points, axis=0),
        np.insert(grid.slopes, place, fresh.slopes, axis=0),
    )
    count = np.ones(unsettled.size, dtype=np.int64)
    count[which] = parts
    still = np.zeros(unsettled.size, dtype=bool)
    still[which] = wrong
    return merged, np.repeat(still, count)


def _hermite_error(grid: Resolved, which: Indices, fresh: Resolved, parts: int) -> Values:
    """Return by how much the Hermite curve misses the middle node of each interval, in mm."""
    width = np.diff(grid.t)[which][:, None]
    p0, p1 = grid.points[which], grid.points[which + 1]
    d0, d1 = grid.slopes[which] * width, grid.slopes[which + 1] * width
    middle = slice(parts // 2 - 1, None, parts - 1)
    place = (p0 + p1) / 2.0 + (d0 - d1) / 8.0 - fresh.points[middle]
    slope = 1.5 * (p1 - p0) - (d0 + d1) / 4.0 - fresh.slopes[middle] * width
    return norm(place) + norm(slope) / 8.0


def _nodes(curve: PlaneCurve, t: Values) -> Resolved:
    """Return the curve at t; ValueError if a point is not finite."""
    points, slopes = curve.at(t), curve.derivative(t)
    if not np.isfinite(points).all():
        raise ValueError("an edge must be finite on [0, 1]")
    return Resolved(curve, t, points, np.where(np.isfinite(slopes).all(axis=1)[:, None], slopes, 0.0))


def _spread(grid: Resolved, count: int) -> Values:
    """Return parameters that share length and turning evenly, both ends included."""
    step = np.diff(grid.points, axis=0)
    chord = norm(step)
    heading = np.arctan2(step[:, 1], step[:, 0])[chord > 0.0]
    turn = np.zeros(grid.t.size)
    bend = np.abs(np.pi - np.mod(np.pi - np.diff(heading), 2.0 * np.pi))
    turn[np.flatnonzero(chord > 0.0)[1:]] = bend
    cost = chord / max(float(chord.sum()), np.finfo(float).tiny)
    if bend.sum() > VANISHED:
        # the turn between two chords is shared by both
        cost = cost + (turn[:-1] + turn[1:]) / (2.0 * bend.sum())
    total = np.concatenate([[0.0], np.cumsum(cost)])
    keep = np.concatenate([[True], np.diff(total) > 0.0])
    t: Values = np.interp(np.linspace(0.0, total[-1], count), total[keep], grid.t[keep])
    t[0], t[-1] = 0.0, 1.0
    return t


def _angles(curve: PlaneCurve, t: Values, points: Points2) -> Values:
    """Return the directions of travel in rad, from nearby points where the derivative gives none."""
    slopes = curve.derivative(t)
    size = float(np.max(np.ptp(points, axis=0)))
    lost = ~_has_direction(slopes, size)
    for nearby in NEARBY:
        if not lost.any():
            break
        slopes[lost] = curve.derivative(np.where(t < 0.5, t + nearby, t - nearby)[lost])  # noqa: PLR2004  half-way
        lost = ~_has_direction(slopes, size)
    if lost.any():
        chord = np.gradient(points, axis=0)
        slopes[lost] = chord[lost]
    angle: Values = np.arctan2(slopes[:, 1], slopes[:, 0])
    return angle


def _has_direction(slopes: Points2, size: float) -> Mask:
    """Return where a derivative is finite and not too small to have a direction."""
    finite = np.isfinite(slopes).all(axis=1)
    clear: Mask = finite & (norm(np.where(finite[:, None], slopes, 0.0)) > VANISHED * size)
    return clear
