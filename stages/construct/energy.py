"""Shape parameters of the directrix (2.2) by least strain energy, the integral of |r''|^2 over [0, 1] [1]_.

r'' is linear in beta, and so the best beta for given alpha are two linear equations; what is left is a polynomial of
degree 4 in each of alpha0 and alpha1, whose least value is certified (`geometry.numeric.leastvalue`).  All integrals
are those of polynomials, without quadrature.  The unit of length is the chord.

No curve of energy e has |r'(0)| or |r'(1)| above 1 + sqrt(e), since |r'(v) - r'(0)| <= sqrt(e) and the mean of r'
is the chord: with the energy of any curve as e, that closes the range of alpha from above.  From below it must be
closed by hand: where tangents point far off the chord the energy falls as alpha goes to 0, and the curve would lose
its tangent.

.. [1] L. Lu, "Planar quintic G2 Hermite interpolation with minimum strain energy", 2015.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import comb

import numpy as np

from stages.construct.quintic import End
from stages.geometry.arrays import Array, Matrix, floats, norm
from stages.geometry.numeric.leastvalue import least

LEAST_ALPHA = 0.05
"""alpha is kept above this share of the chord over |T|: below, the curve leaves its tangent within a few hundredths."""
GAP = 1e-9
"""How far the energy may be from the least one, as a share of 1 + energy, in units of the chord.
Before Newton's steps alpha is good to some 1e-4, after them to the root of rounding or better."""
CUBIC = 3
"""The degree of r''."""
POWERS = ((0, 0), (1, 0), (0, 1), (2, 0), (0, 2))
"""The powers of alpha0 and alpha1 that r'' contains."""


@dataclass(frozen=True, slots=True)
class Shape:
    """alpha0, alpha1, beta0, beta1 in mm, the strain energy in mm2, and the alpha that are at their least value."""

    alpha0: float
    alpha1: float
    beta0: float
    beta1: float
    energy_mm2: float
    at_bound: tuple[str, ...]


def least_energy(start: End, end: End) -> Shape:
    """Return the shape parameters of least strain energy for these ends, whose own alpha and beta do not count.

    Raises NoSolutionError if the least energy is not certified to within `GAP`.
    """
    chord = float(norm(floats(end.P) - floats(start.P)))
    terms, bends = _second_derivative(start, end, chord)
    metric = np.kron(_gram(), np.eye(3))
    solve = np.linalg.solve(bends @ metric @ bends.T, bends @ metric)
    rest = terms - terms @ solve.T @ bends
    quartic = _squared(rest @ metric @ rest.T)
    speeds = [float(norm(floats(at.T))) for at in (start, end)]
    low = [LEAST_ALPHA / speed for speed in speeds]
    first = float(np.polynomial.polynomial.polyval2d(1.0 / speeds[0], 1.0 / speeds[1], quartic))
    most = [(1.0 + np.sqrt(max(first, 0.0))) / speed for speed in speeds]
    found = least(quartic, ((low[0], most[0]), (low[1], most[1])), gap=GAP * (1.0 + first))
    alpha = [float(x) for x in found.place]
    beta = -solve @ (np.array([alpha[0] ** i * alpha[1] ** j for i, j in POWERS]) @ terms)
    at_bound = tuple(f"alpha{i}" for i in (0, 1) if alpha[i] <= low[i])
    energy = max(found.value, 0.0) * chord**2
    a0, a1, b0, b1 = (float(x) * chord for x in (*alpha, *beta))
    return Shape(a0, a1, b0, b1, energy, at_bound)


def _second_derivative(start: End, end: End, chord: float) -> tuple[Array, Array]:
    """Return the control vectors of r'', side by side: of each of `POWERS` (5, 12), and of beta0 and beta1 (2, 12)."""
    span = (floats(end.P) - floats(start.P)) / chord
    bend0, bend1 = (float(at.k) * chord * floats(at.N) for at in (start, end))
    T0, T1, nothing = floats(start.T), floats(end.T), np.zeros(3)
    terms = [
        [nothing, nothing, nothing, span, span, span],
        [nothing, T0 / 5, 2 * T0 / 5, nothing, nothing, nothing],
        [nothing, nothing, nothing, -2 * T1 / 5, -T1 / 5, nothing],
        [nothing, nothing, bend0 / 20, nothing, nothing, nothing],
        [nothing, nothing, nothing, bend1 / 20, nothing, nothing],
    ]
    bends = [[nothing, nothing, T0 / 20, nothing, nothing, nothing],
             [nothing, nothing, nothing, T1 / 20, nothing, nothing]]  # fmt: skip
    return _twice_derived(terms), _twice_derived(bends)


def _twice_derived(rows: Sequence[Sequence[Array]]) -> Matrix:
    """Return the second derivatives of quintics by their control points, shape (n, 6, 3), as rows of 12."""
    points = np.array(rows)
    return np.asarray(20.0 * np.diff(points, 2, axis=1)).reshape(len(points), -1)


def _gram() -> Matrix:
    """Return the integrals of the products of the cubic Bernstein polynomials, shape (4, 4)."""
    n = CUBIC
    return np.array([[comb(n, i) * comb(n, j) / (comb(2 * n, i + j) * (2 * n + 1)) for j in range(n + 1)]
                     for i in range(n + 1)])  # fmt: skip


def _squared(products: Matrix) -> Matrix:
    """Return the coefficients of alpha0^i alpha1^j in the energy, from the products of the terms of r''."""
    quartic = np.zeros((5, 5))
    for (i, j), row in zip(POWERS, products, strict=True):
        for (k, m), product in zip(POWERS, row, strict=True):
            quartic[i + k, j + m] += product
    return quartic
