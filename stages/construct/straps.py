"""Straps: the rectifying developable of a centre curve, which unrolls to a straight strip.

The rulings run along B + (tau / kappa) T (`straprulings`).  Where tau = 0 throughout, the curve lies in a plane and the
strap is the cylinder over it, kappa = 0 or not; over Bezier curves that cylinder is exact.  A curve that leaves its
plane has a strap through an inflection just if its torsion vanishes there as well; else the inflection splits it, and
what is left on either side is told (`strapstretch`).

Pieces meet along a common ruling only where B and tau / kappa agree: the curve must be C3, or as good as that.  The
cubic spline through points is not, unless they lie in a plane.  Straight pieces take up any ruling.
"""

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise

import numpy as np

from stages.construct.bands import limit_metric, place, size_along, stops, too_wide
from stages.construct.built import Built
from stages.construct.curves import Chain
from stages.construct.quintic import ZERO, scaling
from stages.construct.straprulings import (
    RunsOff,
    is_straight,
    over_straight,
    piece_ruling,
    plane_normal,
    senses,
    value,
)
from stages.construct.strapstretch import inflection_findings
from stages.geometry.arrays import Vector3, dot, norm, unit
from stages.geometry.curves.curves import Along, Curve, affine, exactly
from stages.geometry.ruled.envelope import room, swept
from stages.geometry.ruled.ruled import RuledPatch
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
    rulings, stuck = _rulings(curves, half, tol)
    if stuck:
        return Built((), (), stuck)
    widest = min(room(curves, rulings), key=lambda side: side.width_mm)
    size = size_along(curves)
    findings = (*too_wide("strap-too-wide", "half_width", half, widest), *_joints(curves, rulings, half, tol))
    patches = tuple(
        swept(curve, ruling, -sense * half, sense * half)
        for curve, ruling, sense in zip(curves, rulings, senses(rulings), strict=True)
    )
    return Built(() if findings else patches, (limit_metric(WIDEST, widest, size),), findings)


def _rulings(curves: Sequence[Curve], half: float, tol: Tolerances) -> tuple[list[Curve], tuple[Finding, ...]]:
    """Return the rulings over all pieces, or why there are none."""
    stuck = stops("centre", curves)
    if stuck:
        return [], stuck
    found = [None if is_straight(curve) else piece_ruling(curve) for curve in curves]
    if all(one is None for one in found):
        return [], (Finding("strap-inflection", NO_FACING, True, place(0, 0.0)),)
    stuck = inflection_findings(curves, found, half, tol)
    made = [one for one in found if not isinstance(one, RunsOff)]
    return ([], stuck) if stuck else over_straight(curves, made, half, tol)


NO_FACING = (
    "the centre curve has straight pieces only and lies in no one plane: nothing says which way the strap faces; "
    "round the corners, or make it a flat part"
)


def upright(curve: Curve, half: Vector3) -> RuledPatch:
    """Return the cylinder over a planar curve, from one side of its plane to the other."""
    step = exactly(half)
    double = affine(curve, (ZERO,) * 3, exactly([2.0, 0.0, 0.0]))
    same = scaling(Fraction(1))
    return RuledPatch(affine(curve, same, [-x for x in step]), affine(curve, same, step), Along(double, half))


def _joints(curves: Sequence[Curve], rulings: Sequence[Curve], half: float, tol: Tolerances) -> tuple[Finding, ...]:
    """Refuse pieces that do not share a ruling, or that lie differently along it in the flat."""
    found = []
    made = [multiplied * np.stack([value(ruling, 0.0), value(ruling, 1.0)])
            for ruling, multiplied in zip(rulings, senses(rulings), strict=True)]  # fmt: skip
    tangents = [unit(np.stack([value(curve, 0.0, 1), value(curve, 1.0, 1)])) for curve in curves]
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
