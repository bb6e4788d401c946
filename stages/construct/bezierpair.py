"""Aumann's developable pair of Bezier curves, exact: c of any degree, the first point of d, and two numbers L, M.

    d_{i+1} = ((1 - L) c_i + L c_{i+1} - (1 - M) d_i) / M,    so that    n (d - c) = (L - v) c' - (M - v) d'

and p . (c' x d') vanishes identically.  Each ruling touches the edge of regression at the share (M - v) / (M - L) of
the way from c to d [1]_: between them just where v lies between L and M.  With L = M the rulings are parallel.
Raising the degree n of c first leaves c and changes d [2]_.  Degrees 2 and 3 hold the patches of Chu and Sequin.

.. [1] G. Aumann, "A simple algorithm for designing developable Bezier surfaces", CAGD 20 (2003), 601-619.
.. [2] G. Aumann, "Degree elevation and developable Bezier surfaces", CAGD 21 (2004), 661-670.
"""

from fractions import Fraction
from itertools import pairwise

from stages.construct.quintic import combine, vector
from stages.geometry.curves.curves import ExactPoints, bezier, elevated
from stages.geometry.ruled.ruled import RuledPatch, between
from stages.model.developables import BezierPair
from stages.model.report import Finding


def bezier_pair(spec: BezierPair) -> tuple[RuledPatch, tuple[Finding, ...]]:
    """Return the patch, and why its edge of regression refuses it, if it does."""
    given = tuple(vector(point) for point in spec.points)
    c = elevated(given, len(given) - 1 + spec.elevate)
    L, M = Fraction(spec.lambda_), Fraction(spec.mu)
    return between(bezier(c), bezier(other_points(c, spec))), _regression(L, M)


def other_points(c: ExactPoints, spec: BezierPair) -> ExactPoints:
    """Return the control points of d by the recursion."""
    L, M = Fraction(spec.lambda_), Fraction(spec.mu)
    d = [vector(spec.first)]
    for a, b in pairwise(c):
        d.append(combine(((1 - L) / M, a), (L / M, b), ((M - 1) / M, d[-1])))
    return tuple(d)


def _regression(L: Fraction, M: Fraction) -> tuple[Finding, ...]:
    """Refuse an edge of regression between the curves: somewhere v is between lambda and mu."""
    low, high = max(min(L, M), Fraction(0)), min(max(L, M), Fraction(1))
    if low >= high:
        return ()
    message = (
        f"lambda = {float(L):g} and mu = {float(M):g} put the edge of regression between the curves for v from "
        f"{float(low):g} to {float(high):g}: the patch folds back; both must be at least 1, or both at most 0"
    )
    return (Finding("edge-of-regression", message, True, {"v": float(low)}),)
