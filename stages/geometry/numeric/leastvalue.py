"""The least value of a polynomial of two variables on a rectangle, certified.

A polynomial is the array a[i, j] of the coefficients of x^i y^j.  Branch and bound: on each rectangle the least
Bernstein coefficient is a lower bound whose error falls with the square of the size [1]_; rectangles that cannot hold
a value below the best one by more than `gap` are dropped, the others halved both ways.  The best place is then
polished by Newton's method on those variables that are not held at an end of their range.

Rounding counts as nothing here: bounds hold to some 1e-14 of the largest coefficient.

.. [1] J. Garloff, "The Bernstein algorithm", Interval Computations 2 (1993), 154-168.
"""

from dataclasses import dataclass
from functools import cache
from math import comb

import numpy as np

from stages.errors import NoSolutionError
from stages.geometry.arrays import EPS, Array, ArrayValue, Matrix, Points2, Vector2, locked

Box = tuple[tuple[float, float], tuple[float, float]]
"""The ranges of x and of y."""
ROUNDS = 40
"""Halvings of the rectangle: 1e-12 of its sides.  A gap of 1e-6 takes about 10."""
MOST_BOXES = 20_000
"""Rectangles of one round; a minimum in a point leaves a few dozen, one along a curve some hundreds."""
STEPS = 8
"""Newton's steps: the place that is handed over has four to six digits."""


@dataclass(frozen=True, slots=True, eq=False)
class Least(ArrayValue):
    """Where a polynomial is least, its value there, and a bound below which it does not fall in the whole rectangle."""

    place: Vector2
    value: float
    bound: float


def least(a: Matrix, box: Box, *, gap: float) -> Least:
    """Return the least value on the rectangle to within `gap`; raises NoSolutionError if that is not reached."""
    corners = np.array([[low for low, _ in box]])
    size = np.array([high - low for low, high in box])
    best, place, bound, dropped = np.inf, corners[0], -np.inf, np.inf
    for _ in range(ROUNDS):
        coefficients = _bernstein(a, corners, size)
        values = coefficients[:, [0, 0, -1, -1], [0, -1, 0, -1]]
        number, corner = np.unravel_index(int(np.argmin(values)), values.shape)
        if values[number, corner] < best:
            best = float(values[number, corner])
            place = corners[number] + size * np.array(CORNERS[corner])
        lower = coefficients.min(axis=(1, 2))
        bound = min(float(lower.min()), dropped)
        if best - bound <= gap:
            place = _polished(a, place, box)
            return Least(place, value_at(a, place), bound)
        kept = corners[lower < best - gap]
        dropped = min(dropped, float(lower[lower >= best - gap].min(initial=np.inf)))
        size = size / 2.0
        corners = np.concatenate([kept + size * np.array(corner) for corner in CORNERS])
        if len(corners) > MOST_BOXES:
            break
    raise NoSolutionError("least value of a polynomial of two variables", reached=best - bound, wanted=gap)


CORNERS = ((0, 0), (0, 1), (1, 0), (1, 1))


def value_at(a: Matrix, place: Vector2) -> float:
    """Return the value of the polynomial."""
    return float(np.polynomial.polynomial.polyval2d(place[0], place[1], a))


def _bernstein(a: Array, corners: Points2, size: Vector2) -> Array:
    """Return the Bernstein coefficients on every rectangle of that size, shape (n, *a.shape)."""
    columns, rows = (_shifted(len(side), corners[:, axis], size[axis]) for axis, side in ((0, a), (1, a.T)))
    coefficients: Array = columns @ a @ rows.transpose(0, 2, 1)
    return coefficients


def _shifted(count: int, start: Array, size: float) -> Array:
    """Return the matrices that take powers of x to Bernstein coefficients in t, x = start + size t: (n, count, count).

    x^m = sum_k C(m, k) start^(m - k) size^k t^k, and t^k has the Bernstein coefficients C(i, k) / C(n, k).
    """
    moved = np.zeros((len(start), count, count))
    for m in range(count):
        for k in range(m + 1):
            moved[:, k, m] = comb(m, k) * start ** (m - k) * size**k
    return np.asarray(_from_powers(count) @ moved)


@cache
def _from_powers(count: int) -> Array:
    return locked(np.array([[comb(i, k) / comb(count - 1, k) for k in range(count)] for i in range(count)]))


def _polished(a: Matrix, place: Vector2, box: Box) -> Vector2:
    """Return the place after Newton's steps that lower the value; a variable pressed on an end of its range stays."""
    low, high = np.array(box).T
    for _ in range(STEPS):
        slope, bend = _slope(a, place), _bend(a, place)
        free = ~((place <= low) & (slope > 0.0)) & ~((place >= high) & (slope < 0.0))
        step = np.zeros(2)
        step[free] = -np.linalg.lstsq(bend[np.ix_(free, free)], slope[free], rcond=EPS)[0] if free.any() else 0.0
        moved = np.clip(place + step, low, high)
        if value_at(a, moved) > value_at(a, place) + ROUNDING * float(np.abs(a).max()):
            break
        place = moved
    return place


ROUNDING = 64 * EPS
"""By how much a value may seem to rise in a step, of the largest coefficient: the sum of 25 terms."""


def _slope(a: Matrix, place: Vector2) -> Vector2:
    derivative = np.polynomial.polynomial.polyder
    return np.array([value_at(derivative(a, axis=axis), place) for axis in (0, 1)])


def _bend(a: Matrix, place: Vector2) -> Array:
    derivative = np.polynomial.polynomial.polyder
    xx, yy = (value_at(derivative(a, 2, axis=axis), place) for axis in (0, 1))
    xy = value_at(derivative(derivative(a, axis=0), axis=1), place)
    return np.array([[xx, xy], [xy, yy]])
