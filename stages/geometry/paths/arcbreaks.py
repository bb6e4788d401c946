"""Where the arcs of a chain meet: from each sample the longest arc that keeps the tolerance.

An arc is tried between two samples of a smooth stretch, with the turn that the curve itself makes there; its length is
guessed by the cubic law (the distance grows with the third power of the length) and corrected by bisection.  Then the
tolerance is lowered until the last arc is as full as the others.  Points are complex numbers here.
"""

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from stages.geometry.arrays import Array, ArrayValue, Points2, Values

Plane = NDArray[np.complex128]
"""Points as complex numbers, shape (samples,) or (joints,)."""

Joints = NDArray[np.int64]
"""Indices of the samples where arcs meet, first and last sample included, shape (joints,)."""

WIDEST_ARC_RAD = pi / 2.0
TRIAL_POINTS = 24
"""Points of an arc at which a trial is measured; the finished chain is measured at all samples."""

NEARLY_THERE, FULL = 1.1, 0.93
"""The end is tried if it is so little beyond a guess; an arc that uses so much of its tolerance will do."""

TRIALS = 12
"""Lengths tried for one arc; 3 to 5 are usual."""


@dataclass(frozen=True, slots=True, eq=False)
class Stretch(ArrayValue):
    """A smooth stretch of a curve: samples, mm and rad, and whether its end directions must be kept."""

    points: Points2
    angle: Values
    keep_start: bool
    keep_end: bool


def as_plane(points: Points2) -> Plane:
    """Return points as complex numbers."""
    plane: Plane = points[:, 0] + 1j * points[:, 1]
    return plane


def breaks_within(stretch: Stretch, place: Plane, tolerance: Values, least_piece: float) -> Joints:
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
        longer = SHORT_OF / np.cbrt(max(excess, np.finfo(float).tiny))
        guess = start + int((end - start) * min(max(longer, SHRINKING), GROWING))
        if bad > last and last - start < NEARLY_THERE * (guess - start):
            guess = last
        end = guess if good < guess < bad else (good + bad) // 2
    return good, used


SHORT_OF = 0.98
"""The deviation grows with the cube of the length: so much of the length that would use the tolerance is tried next."""
SHRINKING, GROWING = 0.25, 2.0
"""What one trial may change the length by: the cube holds for short arcs only."""


def _excess(angle: Values, place: Plane, tolerance: Values, start: int, end: int) -> float:
    """Return the distance of the samples to the arc through two of them, as a multiple of the tolerance."""
    half = (angle[end] - angle[start]) / 2.0
    if abs(half) > WIDEST_ARC_RAD / 2.0 or end == start:
        return float(2.0 * (abs(half) / (WIDEST_ARC_RAD / 2.0)) ** 3)
    chord = complex(place[end] - place[start])
    heading = chord / abs(chord)
    stride = max((end - start) // TRIAL_POINTS, 1)
    offset = (place[start:end:stride] - place[start]) / (heading * complex(np.cos(half), -np.sin(half)))
    far = from_circle(offset, np.array(2.0 * np.sin(half) / abs(chord)))
    return float(np.max(np.abs(far)) / tolerance[start : end + 1].min())


def from_circle(offset: Plane, curvature: Array) -> Array:
    """Return the signed distance, mm, to the circle through 0 along the real axis; stable for all curvatures."""
    twice = 2.0 * offset.imag - curvature * (offset.real**2 + offset.imag**2)
    far: Array = twice / (1.0 + np.sqrt(np.maximum(1.0 - curvature * twice, 0.0)))
    return far
