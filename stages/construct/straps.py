"""Straps: the rectifying developable of a centre curve, which unrolls to a straight strip.

The rulings run along B + (tau / kappa) T (`stages.geometry.envelope`).  Where tau = 0 throughout, the curve lies in a
plane and the strap is the cylinder over it, kappa = 0 or not; over Bezier curves that cylinder is exact.  A curve that
leaves its plane has no strap through an inflection.

Pieces meet along a common ruling only where B and tau / kappa agree: the curve must be C3, or as good as that.  The
cubic spline through points is not, unless they lie in a plane.
"""

from collections.abc import Sequence
from fractions import Fraction
from functools import partial
from itertools import pairwise

import numpy as np

from stages.construct.bands import PLACES, least, limit_metric, place, positions, size_along, stops, too_wide
from stages.construct.built import Built
from stages.construct.curves import Chain
from stages.construct.quintic import ZERO, scaling
from stages.geometry.arrays import EPS, Vector3, cross3, dot, norm, unit
from stages.geometry.curves import Along, Curve, affine, exactly
from stages.geometry.envelope import Rectifying, bend, room, swept
from stages.geometry.ruled import RuledPatch
from stages.model.envelopes import Strap
from stages.model.report import Finding, Metric
from stages.model.tolerances import Tolerances

WIDEST = "half_width_max_mm"


def strap(spec: Strap, link: Chain, tol: Tolerances) -> Built:
    """Return the patches of a strap, the largest half width, or why there is none."""
    half, curves = float(spec.half_width), link.curves
    across = plane_normal(curves)
    if across is not None:
        return Built(tuple(upright(curve, half * across) for curve in curves), (Metric(WIDEST, None, "mm"),))
    stuck = stops("centre", curves) or _inflections(curves)
    if stuck:
        return Built((), (), stuck)
    rulings = [Rectifying(curve) for curve in curves]
    widest = min(room(curves, rulings), key=lambda side: side.width_mm)
    size = size_along(curves)
    findings = (*too_wide("strap-too-wide", "half_width", half, widest), *_joints(curves, rulings, half, tol))
    patches = tuple(
        swept(curve, ruling, -sense * half, sense * half)
        for curve, ruling, sense in zip(curves, rulings, senses(rulings), strict=True)
    )
    return Built(() if findings else patches, (limit_metric(WIDEST, widest, size),), findings)


def plane_normal(curves: Sequence[Curve]) -> Vector3 | None:
    """Return the unit normal of the plane that the curves lie in, towards B where they bend most; None without one.

    Straight curves lie in no one plane.
    """
    points = positions(curves)
    middle = points.mean(axis=0)
    _, spread, axes = np.linalg.svd(points - middle)
    if spread[1] <= FLAT * spread[0] or spread[2] > FLAT * spread[0]:
        return None
    normal = np.where(np.abs(axes[2]) <= EPS, 0.0, axes[2])
    towards = max((_binormal(curve) for curve in curves), key=lambda b: float(norm(b)))
    facing: Vector3 = unit(normal) * (1.0 if dot(normal, towards) >= 0.0 else -1.0)
    return facing


FLAT = 1e-13
"""Points nearer to a plane than this share of their extent lie in it: some hundred roundings."""


def _binormal(curve: Curve) -> Vector3:
    """Return r' x r'' where that is longest, among samples."""
    _, r1, r2 = curve.jet(np.linspace(0.0, 1.0, PLACES), 2)
    b = cross3(r1, r2)
    longest: Vector3 = b[np.argmax(norm(b))]
    return longest


def upright(curve: Curve, half: Vector3) -> RuledPatch:
    """Return the cylinder over a planar curve, from one side of its plane to the other."""
    step = exactly(half)
    double = affine(curve, (ZERO,) * 3, exactly([2.0, 0.0, 0.0]))
    same = scaling(Fraction(1))
    return RuledPatch(affine(curve, same, [-x for x in step]), affine(curve, same, step), Along(double, half))


def _inflections(curves: Sequence[Curve]) -> tuple[Finding, ...]:
    """Refuse a curve that is straight somewhere."""
    flattest = least([partial(bend, curve) for curve in curves])
    if flattest.value * size_along(curves) > STRAIGHT:
        return ()
    where = flattest.where
    message = (
        f"the centre curve has no curvature at v = {where['v']:.6g}: the rulings of a strap run off there unless the "
        "whole curve lies in a plane; split there, and let both parts end short of it"
    )
    return (Finding("strap-inflection", message, True, where),)


STRAIGHT = 1e-6
"""Curvature times size below which a place is straight: sampled, so not at rounding."""


def senses(rulings: Sequence[Rectifying]) -> list[float]:
    """Return 1 or -1 for each piece, such that neighbours have their sides in common: B turns over where curves do."""
    made = [1.0]
    for a, b in pairwise(rulings):
        turned = float(dot(_at(a, 1.0), _at(b, 0.0)))
        made.append(-made[-1] if turned < 0.0 else made[-1])
    return made


def _at(curve: Curve, v: float, order: int = 0) -> Vector3:
    """Return the value or a derivative of a curve at one place."""
    value: Vector3 = curve.jet(np.array([v]), order)[order, 0]
    return value


def _joints(
    curves: Sequence[Curve], rulings: Sequence[Rectifying], half: float, tol: Tolerances
) -> tuple[Finding, ...]:
    """Refuse pieces that do not share a ruling, or that lie differently along it in the flat."""
    found = []
    made = [multiplied * np.stack([_at(ruling, 0.0), _at(ruling, 1.0)])
            for ruling, multiplied in zip(rulings, senses(rulings), strict=True)]  # fmt: skip
    tangents = [unit(np.stack([_at(curve, 0.0, 1), _at(curve, 1.0, 1)])) for curve in curves]
    leans = [dot(g, t) for g, t in zip(made, tangents, strict=True)]
    for i, ((g, h), (lean, other)) in enumerate(zip(pairwise(made), pairwise(leans), strict=True), start=1):
        gap = half * max(float(norm(h[0] - g[1])), abs(float(other[0] - lean[1])))
        if gap > tol.join_mm:
            message = (
                f"the pieces of the centre curve that meet at v = {i} do not share a ruling: their ends are "
                f"{gap:.4g} mm apart; curvature and torsion must go on there "
                "(one Bezier curve, or a B-spline of degree 4 or more)"
            )
            found.append(Finding("strap-joint", message, True, place(i, 0.0)))
    return tuple(found)
