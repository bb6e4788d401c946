"""Theorem 2.3's shape parameters: the minimum over alpha, beta > 0 of the largest |r'(v)|.

In epigraph form: least t with |r'(v)|^2 <= t for all v in [0, 1].  |r'|^2 is a polynomial of degree 8 in v, so its
largest value is found among the ends and the real roots of a polynomial of degree 7: no sampling error.  The condition
is kept at a growing set of v (an exchange method [1]_): solve by SLSQP, add the true maxima, repeat until the largest
value equals t.  The paper's quasi-Newton scheme is a special case; its initial guess may be given.

A local method: the problem is convex but for the terms k alpha^2 N.  It says how far lower bound and value differ.

.. [1] R. Hettich, K. O. Kortanek, "Semi-infinite programming", SIAM Review 35 (1993), 380-429.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from stages.construct.quintic import End
from stages.errors import NoSolutionError
from stages.geometry.arrays import Array, Matrix, Values, floats, norm
from stages.geometry.curves.curves import Bezier
from stages.geometry.numeric.basis import bernstein_basis, bernstein_sum, differences

DEGREE = 4
"""Degree of r'."""
LEAST_SHARE = 1e-4
"""alpha and beta are kept above this share of the chord: the theorem wants them positive, the minimum may be at 0."""
EXCHANGES = 30
"""Rounds of the exchange; 4 to 8 are usual."""
GAP = 1e-13
"""Relative difference between t and the true maximum at which the exchange stops: rounding of |r'|^2."""
SLSQP = {"ftol": 1e-15, "maxiter": 200}
"""It stops where t changes by rounding alone, which takes some 20 steps."""
STEP = 1e-2
"""Share of the chord within which no step may lower the largest value: so small that straight lines tell."""
LEFT = 1e-6
"""Share of |r'|^2 that such a step may still gain: a minimum found leaves 1e-9, shape parameters off by a thousandth
leave 2e-3."""


@dataclass(frozen=True, slots=True)
class Minimax:
    """Shape parameters alpha0, alpha1, beta0, beta1 in mm, the largest |r'| in mm, and where it is reached."""

    shape: tuple[float, float, float, float]
    speed_max: float
    where: tuple[float, ...]
    at_bound: bool


def solve(start: End, end: End, guess: Sequence[float] | None = None) -> Minimax:
    """Return the minimax of |r'|.  Raises NoSolutionError if the exchange does not close, or not at a minimum."""
    from scipy.optimize import minimize

    problem = _Problem(start, end)
    x = np.array(guess) / problem.chord if guess is not None else np.array([1.0, 1.0, 0.1, 0.1])
    places = np.linspace(0.0, 1.0, 13)
    least = LEAST_SHARE
    for _ in range(EXCHANGES):
        basis = bernstein_basis(DEGREE, places)
        result = minimize(
            lambda y: y[4],
            np.append(x, problem.squared_speed(x, basis).max()),
            jac=lambda _: np.array([0.0, 0.0, 0.0, 0.0, 1.0]),
            bounds=[(least, None)] * 4 + [(0.0, None)],
            constraints={
                "type": "ineq",
                "fun": lambda y, at=basis: y[4] - problem.squared_speed(y[:4], at),
                "jac": lambda y, at=basis: problem.slack_gradient(y[:4], at),
            },
            method="SLSQP",
            options=SLSQP,
        )
        x, level = np.maximum(result.x[:4], least), float(result.x[4])
        peaks = problem.peaks(x)
        reached = float(problem.squared_speed(x, bernstein_basis(DEGREE, peaks)).max())
        if reached <= level * (1.0 + GAP):
            _check_minimum(problem, x, np.union1d(places, peaks))
            return problem.answer(x, peaks, least)
        places = np.union1d(places, peaks)
    raise NoSolutionError("minimax of the speed (Theorem 2.3)", reached=reached / level - 1.0, wanted=GAP)


def _check_minimum(problem: "_Problem", x: Array, places: Values) -> None:
    """Raise NoSolutionError where a small step of the shape parameters would lower the largest of the values."""
    from scipy.optimize import linprog

    basis = bernstein_basis(DEGREE, places)
    values = problem.squared_speed(x, basis)
    fall = problem.slack_gradient(x, basis)  # of t - |r'|^2: a step d keeps fall . (d, dt) >= |r'|^2 - t
    found = linprog(
        np.array([0.0, 0.0, 0.0, 0.0, 1.0]),
        A_ub=-fall,
        b_ub=values.max() - values,
        bounds=[*((max(-STEP, LEAST_SHARE - value), STEP) for value in x), (None, 0.0)],
        method="highs",
    )
    gain = -float(found.fun) / float(values.max()) if found.success else np.inf
    if gain > LEFT:
        raise NoSolutionError("minimum of the largest speed (Theorem 2.3)", reached=gain, wanted=LEFT)


class _Problem:
    """|r'|^2 as a function of x = (alpha0, alpha1, beta0, beta1) and v, with the chord as the unit of length."""

    def __init__(self, start: End, end: End) -> None:
        span = floats(end.P) - floats(start.P)
        self.chord = float(norm(span))
        self.span = span / self.chord
        self.T0, self.T1 = floats(start.T), floats(end.T)
        self.kN0 = float(start.k) * self.chord * floats(start.N)
        self.kN1 = float(end.k) * self.chord * floats(end.N)

    def control_vectors(self, x: Array) -> Matrix:
        """Return the Bernstein coefficients of r', shape (5, 3)."""
        a0, a1, b0, b1 = x
        first = a0 / 5 * self.T0
        last = a1 / 5 * self.T1
        second = b0 / 20 * self.T0 + a0**2 / 20 * self.kN0
        before = -b1 / 20 * self.T1 - a1**2 / 20 * self.kN1
        middle = self.span - 2 * last - before - 2 * first - second
        return 5.0 * np.stack([first, first + second, middle, last + before, last])

    def gradients(self, x: Array) -> Array:
        """Return d(control vectors)/dx, shape (4, 5, 3)."""
        a0, a1 = x[:2]
        zero = np.zeros(3)
        bend0, bend1 = a0 / 10 * self.kN0, a1 / 10 * self.kN1
        T0, T1 = self.T0 / 5, self.T1 / 5
        rows = [
            [T0, T0 + bend0, -2 * T0 - bend0, zero, zero],
            [zero, zero, -2 * T1 + bend1, T1 - bend1, T1],
            [zero, T0 / 4, -T0 / 4, zero, zero],
            [zero, zero, T1 / 4, -T1 / 4, zero],
        ]
        return 5.0 * np.array(rows)

    def squared_speed(self, x: Array, basis: Array) -> Values:
        """Return |r'|^2 in units of the chord, where the Bernstein basis is given, shape (n, 5)."""
        values: Values = ((basis @ self.control_vectors(x)) ** 2).sum(axis=1)
        return values

    def slack_gradient(self, x: Array, basis: Array) -> Array:
        """Return the gradient of t - |r'|^2 by (x, t), shape (n, 5)."""
        speed = basis @ self.control_vectors(x)
        rates = np.einsum("nk,xnk->nx", speed, basis @ self.gradients(x))
        return np.concatenate([-2.0 * rates, np.ones((len(speed), 1))], axis=1)

    def peaks(self, x: Array) -> Values:
        """Return the ends and every stationary v of |r'(v)|^2 in [0, 1]: roots of its derivative, degree 7."""
        return stationary(lambda v: self.squared_speed(x, bernstein_basis(DEGREE, v)), degree=2 * DEGREE)

    def answer(self, x: Array, peaks: Values, least: float) -> Minimax:
        """Return the solution in mm."""
        speeds = np.sqrt(self.squared_speed(x, bernstein_basis(DEGREE, peaks)))
        top = float(speeds.max())
        a0, a1, b0, b1 = (float(value) * self.chord for value in x)
        active = tuple(float(v) for v, s in zip(peaks, speeds, strict=True) if s >= top * (1.0 - ACTIVE))
        return Minimax((a0, a1, b0, b1), top * self.chord, active, bool((x <= least * (1.0 + ACTIVE)).any()))


ALMOST_REAL = 1e-6
"""Double roots split into a pair with an imaginary part of about sqrt(EPS); a peak is flat enough not to mind."""
ACTIVE = 1e-8
"""Speeds within this share of the largest count as reaching it."""


def largest_speed(r: Bezier) -> tuple[float, float]:
    """Return the largest |r'(v)| of a quintic in mm and the v where it is reached."""
    control = differences(r.points, 1)

    def squared(v: Values) -> Values:
        values: Values = (bernstein_sum(control, v) ** 2).sum(axis=1)
        return values

    peaks = stationary(squared, degree=2 * (len(control) - 1))
    values = squared(peaks)
    return float(np.sqrt(values.max())), float(peaks[int(np.argmax(values))])


def stationary(function: Callable[[Values], Values], *, degree: int) -> Values:
    """Return the ends and every stationary point in [0, 1] of a polynomial of that degree."""
    nodes = (1.0 - np.cos(np.pi * np.arange(degree + 1) / degree)) / 2.0
    slope = np.polynomial.Chebyshev.fit(nodes, function(nodes), degree, domain=[0.0, 1.0]).deriv()
    roots = slope.roots()
    real = roots.real[np.abs(roots.imag) < ALMOST_REAL]
    inside = real[(real > 0.0) & (real < 1.0)]
    return np.concatenate([[0.0], np.sort(inside), [1.0]])
