"""What the paper's theorems claim, computed for the patch at hand: coefficients, conditions, end data.

    det(r', p, r1') = sum_i (1 - v)^(13 - i) v^i A_i,      p' x p = -5 sum_i (1 - v)^(9 - i) v^i C~_i.

The A_i are the paper's explicit ones (its B.Z sums are smaller by 25); the C~_i are its sums with 5 (Y0 x X1) in C~_1,
where 4 is printed.  All in exact arithmetic, rounded once at the end.
"""

from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from stages.construct.quintic import End
from stages.geometry.arrays import Array, dot, float_rows, floats, norm
from stages.geometry.curves.curves import Bezier
from stages.geometry.numeric import bernstein
from stages.geometry.numeric.bernstein import Polynomial, cross, derivative, inner, subtract, vector_from_points
from stages.geometry.ruled.ruled import RuledPatch
from stages.model.report import Finding, Metric
from stages.model.tolerances import Tolerances

DEGREE_A, DEGREE_C = 13, 9
"""Of p . (r' x r1') for two quintics: 5 + 4 + 4; and of p' x p: 4 + 5."""


def exact_curves(patch: RuledPatch) -> tuple[bernstein.Vector, bernstein.Vector]:
    """Return both directrices of a polynomial patch as exact polynomials."""
    if not (isinstance(patch.c0, Bezier) and isinstance(patch.c1, Bezier)):
        raise TypeError("only polynomial directrices are exact")
    return vector_from_points(patch.c0.exact), vector_from_points(patch.c1.exact)


def coefficients_a(patch: RuledPatch) -> tuple[Fraction, ...]:
    """Return A_0 to A_13, mm3."""
    r, r1 = exact_curves(patch)
    p = subtract(r1, r)
    triple = inner(tuple(derivative(f) for f in r), cross(p, tuple(derivative(f) for f in r1)))
    return _scaled(triple, DEGREE_A)


def coefficients_c(patch: RuledPatch) -> tuple[tuple[Fraction, ...], ...]:
    """Return C~_0 to C~_9, vectors in mm2, with the paper's factor."""
    r, r1 = exact_curves(patch)
    p = subtract(r1, r)
    components = [_scaled(f, DEGREE_C) for f in cross(tuple(derivative(f) for f in p), p)]
    return tuple(tuple(-c / 5 for c in row) for row in zip(*components, strict=True))


def coefficients(patches: tuple[RuledPatch, ...]) -> dict[str, object]:
    """Return every A_i and C~_i of every patch, rounded once."""
    return {
        "A": [floats(coefficients_a(patch)).tolist() for patch in patches],
        "C_tilde": [float_rows(coefficients_c(patch)).tolist() for patch in patches],
    }


def _scaled(f: Polynomial, degree: int) -> tuple[Fraction, ...]:
    f = bernstein.elevate(f, degree)
    return tuple(Fraction(c, f.denominator) for c in f.scaled)


def relative_a(patch: RuledPatch, size_mm: float) -> float:
    """Return the largest |A_i| over the cube of the size: 0 exactly where the patch is developable."""
    return float(max(abs(a) for a in coefficients_a(patch))) / size_mm**3


def relative_c(patch: RuledPatch, size_mm: float) -> float:
    """Return the largest |C~_i| over the square of the size: 0 exactly where the patch is a cylinder."""
    return float(max(abs(c) for row in coefficients_c(patch) for c in row)) / size_mm**2


def parallel_residual(vectors: Sequence[Array]) -> float:
    """Return the largest sine between the first vector and the others."""
    first = vectors[0]
    sines = [norm(np.cross(first, v)) / (norm(first) * norm(v)) for v in vectors[1:] if norm(v) > 0]
    return float(max(sines, default=0.0))


def end_metrics(ends: Sequence[tuple[str, End]], tol: Tolerances) -> tuple[list[Metric], list[Finding]]:
    """Return how the end data depart from what (2.2) assumes: |T| = |N| = 1, T.N = 0, and so curvature k.

    The curvature reached is k |T x N| / |T|^3; the departure is compared with |k|.
    """
    norms = [(abs(float(norm(floats(v))) - 1.0), where) for where, e in ends for v in (e.T, e.N) if any(v)]
    dots = [(abs(float(dot(floats(e.T), floats(e.N)))), where) for where, e in ends]
    curvatures = [(_curvature_error(e), where) for where, e in ends]
    rows = (
        ("tangent_norm_error", norms, tol.tangent_norm),
        ("normal_tangent_dot", dots, None),
        ("end_curvature_error", curvatures, None),
    )
    metrics = []
    for name, values, limit in rows:
        value, where = max(values, default=(0.0, ""))
        metrics.append(Metric(name, value, "", "proved", limit, {"end": where}))
    return metrics, _curvature_findings(ends)


def _curvature_error(end: End) -> float:
    """Return |curvature reached - k| / |k|, 0 where k is 0."""
    return abs(_reached(end) / float(end.k) - 1.0) if end.k else 0.0


def _reached(end: End) -> float:
    t, n = floats(end.T), floats(end.N)
    return float(end.k) * float(norm(np.cross(t, n)) / norm(t) ** 3)


def _curvature_findings(ends: Sequence[tuple[str, End]]) -> list[Finding]:
    """Say once where the end curvature is not the one asked for: the worst end, and how many."""
    errors = [(_curvature_error(end), where, end) for where, end in ends]
    off = [item for item in errors if item[0] > CURVATURE_WORTH_SAYING]
    if not off:
        return []
    _, where, end = max(off, key=lambda item: item[0])
    ends_text = "at 1 end" if len(off) == 1 else f"at {len(off)} ends"
    turned = float(dot(floats(end.T), floats(end.N)))
    message = (
        f"{ends_text} the normal is not across the tangent, so that the curvature is not the one asked for; "
        f"worst: {_reached(end):.5g} instead of {float(end.k):.5g} per mm, T.N = {turned:.4g}"
    )
    return [Finding("end-curvature", message, where={"end": where})]


CURVATURE_WORTH_SAYING = 1e-3
"""A departure of the end curvature below 0.1 % is the rounding of four printed digits."""
