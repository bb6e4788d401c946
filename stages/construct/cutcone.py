"""Cones cut by planes, over a directrix or as a right frustum.

Rulings run from r along d: over a directrix d = A - r, with the apex A at the share s_A = 1; in a frustum r is the ring
of radius0 and d the way to that of radius1, s_A = radius0 / (radius0 - radius1), or there is no apex.  A plane
n . (x - P) = 0 meets a ruling at the share

    s = n . (P - r) / (n . d);       from the apex:  A + k R / (n . R),   R = r - A,  k = n . (P - A).

Over a polynomial or rational directrix the second form is rational with exact control points, of the directrix's own
degree: numerator A (n . R) + k R and weight n . R, raised in degree until all weights are positive.  Where that takes
more than `MOST_DEGREE`, and over circles and ellipses, the first form is evaluated by power series.

Refused, with the ruling that is worst: a plane that some ruling does not meet on its way (n . d changes its sign), ends
on both sides of the apex, and ends that cross.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise

import numpy as np

from stages.construct.apex import apex_findings
from stages.construct.quintic import ZERO, Vector, combine, inner, scaling, vector
from stages.geometry.arrays import EPS, Values, dot, floats, norm
from stages.geometry.curves.curves import (
    Bezier,
    Curve,
    HomogeneousPoints,
    RationalBezier,
    affine,
    homogeneous,
    raised,
    rational,
)
from stages.geometry.curves.stepped import Share, Stepped, constant
from stages.geometry.numeric.extremum import minimum
from stages.geometry.ruled.ruled import RuledPatch, between
from stages.model.part import Cone, Plane
from stages.model.report import Finding

Made = tuple[tuple[RuledPatch, ...], tuple[Finding, ...]]
KEYS = ("start_plane", "end_plane")
"""The keys of the planes at u = 0 and at u = 1."""


@dataclass(frozen=True, slots=True)
class Rulings:
    """Rulings r + s d of one piece; `ends`, uncut: the share and the curve at each; apex: its s and place, if any."""

    r: Curve
    d: Curve
    ends: tuple[tuple[Fraction, Curve], tuple[Fraction, Curve]]
    apex: tuple[Fraction, Vector] | None


def cut_cone(spec: Cone, directrix: Sequence[Curve]) -> Made:
    """Return the patches of a cone between planes over the pieces of its directrix, or why there are none."""
    apex, (a, b) = vector(spec.apex or ()), (Fraction(f) for f in spec.fraction)
    beyond = apex_findings(directrix, apex)
    if beyond:
        return (), beyond
    return _cut(spec, [_over(r, apex, a, b) for r in directrix])


def _over(r: Curve, apex: Vector, a: Fraction, b: Fraction) -> Rulings:
    """Return the rulings from a directrix to the apex."""
    at_a, at_b = (affine(r, scaling(1 - share), combine((share, apex))) for share in (a, b))
    return Rulings(r, affine(r, scaling(Fraction(-1)), apex), ((a, at_a), (b, at_b)), (Fraction(1), apex))


def cut_frustum(spec: Cone, whole: RuledPatch) -> Made:
    """Return a frustum between planes, or why there is none; whole: the same, uncut."""
    r0, height = Fraction(spec.radius0 or 0), Fraction(spec.height or 0)
    narrows = r0 - Fraction(spec.radius1 or 0)
    share = r0 / narrows if narrows else None
    apex = None if share is None else (share, (Fraction(0), Fraction(0), share * height))
    return _cut(spec, [Rulings(whole.c0, whole.p, ((Fraction(0), whole.c0), (Fraction(1), whole.c1)), apex)])


def _cut(spec: Cone, every: Sequence[Rulings]) -> Made:
    findings = next((found for i, one in enumerate(every) if (found := _refusals(spec, one, i))), ())
    findings = findings or _reversals(spec, every)
    return ((), findings) if findings else (tuple(_patch(spec, one) for one in every), ())


# The patches


def _patch(spec: Cone, rulings: Rulings) -> RuledPatch:
    """Return the piece between both ends: exact over Bezier curves, else by power series."""
    planes = spec.start_plane, spec.end_plane
    exact = [_exact_end(rulings, plane, uncut) for plane, (_, uncut) in zip(planes, rulings.ends, strict=True)]
    if exact[0] is not None and exact[1] is not None:
        return between(exact[0], exact[1])
    shares = start, end = _shares(spec, rulings)
    c0, c1 = (
        uncut if plane is None else Stepped(rulings.r, rulings.d, share)
        for plane, share, (_, uncut) in zip(planes, shares, rulings.ends, strict=True)
    )
    zero = affine(rulings.d, (ZERO,) * 3, ZERO)
    return RuledPatch(c0, c1, Stepped(zero, rulings.d, end, start))


def _shares(spec: Cone, rulings: Rulings) -> tuple[Share, Share]:
    """Return how far along d both ends are."""
    (a, _), (b, _) = rulings.ends
    return _share(rulings, spec.start_plane, a), _share(rulings, spec.end_plane, b)


def _share(rulings: Rulings, plane: Plane | None, uncut: Fraction) -> Share:
    if plane is None:
        return constant(uncut)
    n, height = vector(plane.normal), inner(vector(plane.normal), vector(plane.point))
    above = affine(rulings.r, (combine((-1, n)), ZERO, ZERO), (height, Fraction(0), Fraction(0)))
    return Share(above, affine(rulings.d, (n, ZERO, ZERO), ZERO))


def _exact_end(rulings: Rulings, plane: Plane | None, uncut: Curve) -> Bezier | RationalBezier | None:
    """Return one end of rulings over a Bezier curve, with exact control points; None over any other."""
    r = rulings.r
    if rulings.apex is None or not isinstance(r, Bezier | RationalBezier):
        return None
    if plane is None:
        return uncut if isinstance(uncut, Bezier | RationalBezier) else None
    apex, n = rulings.apex[1], vector(plane.normal)
    k = inner(n, combine((1, vector(plane.point)), (-1, apex)))
    arms = [combine((1, point[:3]), (-point[3], apex)) for point in homogeneous(r)]
    weights = [inner(n, arm) for arm in arms]
    sign = 1 if sum(weights) > 0 else -1
    rows = [(*combine((sign * w, apex), (sign * k, arm)), sign * w) for arm, w in zip(arms, weights, strict=True)]
    positive = _with_positive_weights(rows)
    return None if positive is None else rational(positive)


MOST_DEGREE = 24
"""Up to here a rational edge is proved in some tens of milliseconds; it reaches as far as some 20 : 1 in ruling length,
which is more than cuts of ducts have."""


def _with_positive_weights(rows: Sequence[tuple[Fraction, ...]]) -> HomogeneousPoints | None:
    """Return the same curve in the least degree in which all its weights are positive; None above `MOST_DEGREE`."""
    while len(rows) <= MOST_DEGREE + 1:
        if all(row[3] > 0 for row in rows):
            return tuple((row[0], row[1], row[2], row[3]) for row in rows)
        rows = raised(rows)
    return None


# What is refused


def _refusals(spec: Cone, rulings: Rulings, piece: int) -> tuple[Finding, ...]:
    """Return why a piece cannot be cut so; nothing where it can."""
    for key, plane in zip(KEYS, (spec.start_plane, spec.end_plane), strict=True):
        missed = None if plane is None else _missed(rulings, plane, key)
        if missed is not None:
            return (_in_piece(missed, piece),)
    start, end = _shares(spec, rulings)
    wrong = _past_apex(rulings, start, end) or _crossing(rulings, start, end)
    return () if wrong is None else (_in_piece(wrong, piece),)


def _in_piece(finding: Finding, piece: int) -> Finding:
    place = dict(finding.where or {})
    return replace(finding, where={"piece": piece} | place | {"v": piece + float(place["v"])})


def _missed(rulings: Rulings, plane: Plane, key: str) -> Finding | None:
    """Refuse a plane that is parallel to a ruling, or meets some rulings on one side of the apex only."""
    normal = floats(plane.normal) / float(norm(floats(plane.normal)))

    def sine(v: Values) -> Values:
        d = rulings.d.jet(v, 0)[0]
        length = norm(d)
        return np.divide(dot(d, normal), length, out=np.zeros_like(length), where=length > 0.0)

    sign = 1.0 if float(sine(EVENLY).sum()) >= 0.0 else -1.0
    worst, v = minimum(lambda places: sign * sine(places))
    if worst > PARALLEL:
        return None
    angle = float(np.degrees(np.arcsin(max(-worst, 0.0))))
    message = (
        f"{key} does not meet all rulings on one side of the apex: the one at v = {v:.6g} is "
        f"{angle:.4g} deg past parallel to it; turn the plane by more than that"
    )
    return Finding("plane-misses", message, True, {"v": v, "past_parallel_deg": angle})


PARALLEL = 1e-9
"""The sine of a ruling's angle to a plane that it is parallel to: below, it would be met beyond 10^9 times the size."""


def _past_apex(rulings: Rulings, start: Share, end: Share) -> Finding | None:
    """Refuse ends that lie on different sides of the apex."""
    if rulings.apex is None:
        return None
    apex = float(rulings.apex[0])
    middle = np.array([0.5])
    a, b = (float(share.at(middle)[0]) - apex for share in (start, end))
    if a * b >= 0.0:
        return None
    message = "the rulings would run through the apex: both ends must lie on the same side of it"
    return Finding("through-apex", message, True, {"v": 0.5})


def _crossing(rulings: Rulings, start: Share, end: Share) -> Finding | None:
    """Refuse ends that cross: there the rulings would turn back."""

    def length(v: Values) -> Values:
        return _lengths(rulings, start, end, v)

    sign = 1.0 if float(length(EVENLY).sum()) >= 0.0 else -1.0
    least, v = minimum(lambda places: sign * length(places))
    size = float(np.abs(length(EVENLY)).max())
    if least >= -ROUNDING * size:
        return None
    message = (
        f"the ends of the cone cross: at v = {v:.6g} the ruling would be {least:.6g} mm long; move the planes apart "
        f"by more than {-least:.6g} mm along it"
    )
    return Finding("planes-cross", message, True, {"v": v, "length_mm": least})


ROUNDING = 64 * EPS
"""A ruling below this share of the longest has the length of rounding."""


EVENLY = np.linspace(0.0, 1.0, 33)
"""Where the way that most rulings run is taken from."""


def _lengths(rulings: Rulings, start: Share, end: Share, v: Values) -> Values:
    """Return the lengths of rulings, mm, negative against d."""
    lengths: Values = (end.at(v) - start.at(v)) * norm(rulings.d.jet(v, 0)[0])
    return lengths


def _reversals(spec: Cone, every: Sequence[Rulings]) -> tuple[Finding, ...]:
    """Refuse ends that cross at the very ruling where two pieces meet."""
    ways = [float(_lengths(one, *_shares(spec, one), EVENLY).sum()) for one in every]
    for i, (a, b) in enumerate(pairwise(ways), start=1):
        if a * b < 0.0:
            message = (
                f"the ends of the cone cross at v = {i}, between two pieces of the directrix; move the planes apart"
            )
            return (Finding("planes-cross", message, True, {"piece": i, "v": float(i), "length_mm": 0.0}),)
    return ()
