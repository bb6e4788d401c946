"""The developable that a mesh was made from, as the envelope of its tangent planes.

    enveloped(mesh, fit, enough_mm=...) -> Family | None

A developable has one tangent plane for each ruling, N(t).x = D(t), and its ruling is where N'(t).x = D'(t) too [1]_.
Any such family envelops a developable, so nothing has to be forced.  Where the surface bends the other way U = (N, D)
stops and turns round: U' = P(t) W(t), with P the product of t - t_k over these places, W has no such zero, and the
ruling is N.x = D, W.(x, -1) = 0 throughout.  Unknown are U at the beginning, W as a Chebyshev series whose degree rises
until the vertices lie on the envelope, and the t_k.

1. At first t is a function on the mesh that changes along the fitted directions of greatest curvature (`fit`), not
   across them: least squares over the facets.
2. U is fitted to the fitted normals, then to the vertices, by Gauss and Newton.  A vertex lies on the ruling for which
   W.(x, -1) = 0, and (N.x - D) / |N| is its distance.  A change of t does not change that to first order, so each step
   is one linear least-squares problem; what only scales the planes or shifts t along is left alone (least norm), and
   as much beside that as it takes for the step to help.

Not for a surface with a plane part (one plane, no t) nor with a crease: None, or a large deviation.

.. [1] H. Pottmann, J. Wallner, "Computational Line Geometry", 2001, section 6.2.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

from stages.geometry.arrays import EPS, Array, ArrayValue, Mask, Points3, Values, dot, norm
from stages.geometry.mesh.across import along, ways, zeros
from stages.geometry.mesh.fit import SurfaceFit
from stages.geometry.mesh.mesh import Mesh

DEGREES = (8, 12, 17, 24, 34, 48)
"""Of W: each half as high again as the one before."""
STEPS = 20
"""Of Gauss and Newton at one degree: they all but square the error where the degree suffices."""
NEWTON = 10
MOST_VERTICES = 2000
"""So many, evenly taken, are fitted to: ten for each unknown of the highest degree."""
DAMPED = tuple(10.0**-k for k in range(8, 0, -1))
"""Shares of the largest singular value below which changes, that hardly move the planes, are damped (Tikhonov)."""
AT_REST = 1e-14
"""Of the extent: deviations that cannot get smaller."""
WORTH = 0.5
"""A degree, or a step, that leaves more than this share of the deviation gains nothing."""
PLANE = 4
"""Coordinates of a plane."""
PER_UNKNOWN = 3
"""Vertices for each unknown, at least."""


@dataclass(frozen=True, slots=True, eq=False)
class Family(ArrayValue):
    """A family of planes over t from -1 to 1 or little more, about `centre` and in units of `extent`, mm.

    planes, turns: Chebyshev coefficients of U and W, shapes (k, 4).
    t: that of every vertex.
    off: signed distances of the vertices, mm.
    """

    centre: Array
    extent: float
    planes: Array
    turns: Array
    t: Values
    off: Values


@dataclass(frozen=True, slots=True, eq=False)
class _Guess(ArrayValue):
    """U at t = -1, W as a series, and where the bending changes sign."""

    first: Array
    turns: Array
    zeros: Array


def enveloped(mesh: Mesh, fit: SurfaceFit, *, enough_mm: float) -> Family | None:
    """Return the family of tangent planes nearest to the vertices; None where they do not follow each other.

    enough_mm: a largest distance at which a higher degree is not tried.
    """
    across, bends = ways(fit)
    t = along(mesh, across, bends)
    low, high = float(t.min()), float(t.max())
    if not high > low:
        return None
    t = (2.0 * t - low - high) / (high - low)
    centre = mesh.vertices.mean(axis=0)
    extent = float(norm(mesh.vertices - centre).max())
    x = (mesh.vertices - centre) / extent
    signs = zeros(t, bends)
    best: tuple[_Guess, Values, Values] | None = None
    guess = _begun(fit.normals, x, t, signs)
    for degree in (degree for degree in DEGREES if degree >= len(guess.turns) - 1):
        if (degree + 2) * PLANE * PER_UNKNOWN > len(x):
            break
        found = _refined(x, _raised(guess, degree), t)
        gained = found is not None and (best is None or norm(found[2]) <= WORTH * norm(best[2]))
        if found is not None and gained:
            best, (guess, t, _) = found, found
        if best is not None and (not gained or extent * np.abs(best[2]).max() <= enough_mm):
            break
    if best is None:
        return None
    return Family(centre, extent, _planes(best[0]), best[0].turns, best[1], extent * best[2])


# Fits


def _products(zeros: Array) -> Array:
    """Return the Chebyshev series of the product of t - t_k."""
    return np.asarray(chebyshev.chebfromroots(zeros)) if zeros.size else np.ones(1)


def _basis(t: Values, zeros: Array, degree: int) -> Array:
    """Return 1 and the integrals from -1 of P T_k at t, shape (n, degree + 2)."""
    factor = _products(zeros)
    columns = [np.ones_like(t)]
    for k in range(degree + 1):
        whole = chebyshev.chebint(chebyshev.chebmul(factor, np.eye(degree + 1)[k]), lbnd=-1.0)
        columns.append(chebyshev.chebval(t, whole))
    return np.stack(columns, axis=1)


def _planes(guess: _Guess) -> Array:
    """Return the Chebyshev series of U, shape (k, 4)."""
    factor = _products(guess.zeros)
    whole = [chebyshev.chebint(chebyshev.chebmul(factor, column), lbnd=-1.0) for column in guess.turns.T]
    planes = np.stack(whole, axis=1)
    planes[0] += guess.first
    return np.asarray(planes, dtype=np.float64)


def _begun(normals: Points3, x: Points3, t: Values, zeros: Array) -> _Guess:
    """Return the family of the fitted normals and of the planes through the vertices across them.

    Of the least degree that fits half as well as the best.
    """
    planes = np.column_stack([normals, dot(normals, x)])
    fits = []
    for degree in DEGREES[:-1]:
        basis = _basis(t, zeros, degree)
        solved = np.linalg.lstsq(basis, planes, rcond=None)[0]
        fits.append((float(norm(basis @ solved - planes).max()), _Guess(solved[0], solved[1:], zeros)))
    least = min(off for off, _ in fits)
    return next(guess for off, guess in fits if off <= least / WORTH)


def _raised(guess: _Guess, degree: int) -> _Guess:
    """Return the same in a higher degree."""
    return _Guess(guess.first, np.vstack([guess.turns, np.zeros((degree + 1 - len(guess.turns), PLANE))]), guess.zeros)


@dataclass(frozen=True, slots=True, eq=False)
class _Tried:
    """A family with the t and the distances of points from it; those that find no ruling are not settled."""

    guess: _Guess
    t: Values
    settled: Mask
    off: Values
    length: Values

    @property
    def size(self) -> float:
        """Return the root mean square of the distances; infinite where too few points find a ruling."""
        if self.settled.mean() < MOST_SETTLE:
            return float("inf")
        rms = float(np.sqrt(np.mean(self.off[self.settled] ** 2)))
        return rms * (1.0 + UNSETTLED * float(np.mean(~self.settled)))


def _refined(x: Points3, guess: _Guess, t: Values) -> tuple[_Guess, Values, Values] | None:
    """Return the family, t and distances after Gauss and Newton; None where a vertex finds no ruling."""
    some = np.arange(0, len(x), len(x) // MOST_VERTICES + 1)
    start = _tried(guess, x[some], t[some])
    best = min(_bold(start, x[some]), _careful(start, x[some]), key=lambda one: one.size)
    here, settled = places(best.guess.turns, x, t)
    return (best.guess, here, _off(best.guess, x, here)[0]) if settled.all() else None


def _bold(start: _Tried, x: Points3) -> _Tried:
    """Return the best of a row of steps that need not help one by one: past a bad start they get there soonest."""
    at = best = start
    for _ in range(STEPS):
        if float(np.abs(best.off).max()) <= AT_REST or not np.isfinite(at.size):
            break
        at = _tried(next(_steps(at, x, (BOLD,), damped=False)), x, at.t)
        settled = CALM * best.size <= at.size <= best.size
        best = min(best, at, key=lambda one: one.size)
        if settled:
            break
    return best


BOLD = 1e-6
"""Share of the largest singular value below which changes are left alone at once."""


def _careful(start: _Tried, x: Points3) -> _Tried:
    """Return what is left after steps of which each helps, damped as much as serves it best."""
    best = start
    for _ in range(STEPS):
        if float(np.abs(best.off).max()) <= AT_REST:
            break
        better = min((_tried(step, x, best.t) for step in _steps(best, x, DAMPED)), key=lambda one: one.size)
        if better.size > CALM * best.size:
            break
        best = better
    return best


def _tried(guess: _Guess, x: Points3, t: Values) -> _Tried:
    """Return how points lie to a family."""
    at, settled = places(guess.turns, x, t)
    return _Tried(guess, at, settled, *_off(guess, x, at))


MOST_SETTLE = 0.9
"""Share of the vertices that must find a ruling for a step; in the end all must."""
UNSETTLED = 100.0
"""How much worse a family counts for each share of the vertices that finds no ruling."""
CALM = 0.9
"""A step that leaves more than this share of the distances is the last one."""


def _off(guess: _Guess, x: Points3, t: Values) -> tuple[Values, Values]:
    """Return the signed distances of points from the planes at t, and |N|."""
    values = chebyshev.chebval(t, _planes(guess))
    length = norm(values[:3].T)
    return np.asarray((dot(values[:3].T, x) - values[3]) / length), np.asarray(length)


def _steps(at: _Tried, x: Points3, shares_of: tuple[float, ...], *, damped: bool = True) -> Iterator[_Guess]:
    """Yield the families that take the vertices onto their planes to first order, each leaving more alone."""
    guess, here = at.guess, at.settled
    degree, zeros = len(guess.turns) - 1, guess.zeros
    x, t, off = x[here], at.t[here], at.off[here]
    plane = np.column_stack([x, -np.ones(len(x))]) / at.length[here][:, None]
    rows = (_basis(t, zeros, degree)[:, :, None] * plane[:, None, :]).reshape(len(x), -1)
    for k in range(zeros.size):
        moved = _planes(_Guess(np.zeros(PLANE), -guess.turns, np.delete(zeros, k)))
        rows = np.column_stack([rows, dot(chebyshev.chebval(t, moved).T, plane)])
    left, values, right = np.linalg.svd(rows, full_matrices=False)
    seen = left.T @ off
    for share in shares_of:
        least = share * values[0]
        shares = values / (values**2 + least**2) if damped else np.where(values > least, 1.0 / values, 0.0)
        change = -right.T @ (seen * shares)
        series = change[: change.size - zeros.size].reshape(degree + 2, PLANE)
        moved_zeros = zeros + change[change.size - zeros.size :]
        yield _Guess(guess.first + series[0], guess.turns + series[1:], moved_zeros)


def places(turns: Array, x: Points3, t: Values) -> tuple[Values, Mask]:
    """Return the t of the rulings on which points lie, from estimates, and where Newton's method settled."""
    slope, begun = chebyshev.chebder(turns), t
    for _ in range(NEWTON):
        here, rate = chebyshev.chebval(t, turns), chebyshev.chebval(t, slope)
        against = dot(rate[:3].T, x) - rate[3]
        step = np.divide(dot(here[:3].T, x) - here[3], against, out=np.full_like(t, np.inf), where=against != 0.0)
        t = np.clip(t - np.clip(step, -LONGEST_STEP, LONGEST_STEP), -BEYOND, BEYOND)
        if float(np.abs(step).max()) <= SETTLED:
            break
    settled = np.abs(step) <= NEARLY
    return np.where(settled, t, begun), np.asarray(settled)


LONGEST_STEP, BEYOND = 0.1, 1.2
"""A ruling far beyond the ends of the family, or far from its estimate, is another one."""
SETTLED, NEARLY = 64.0 * EPS, 1e-9
"""A step of rounding, and what it may be at the end: near an edge of regression rounding is magnified."""
