"""Ribbons: the band that touches, along a curve, a surface with given normals there.

The normals are taken from a mesh (`meshes.normals`), or interpolated by the C2 cubic spline over the parameters of the
curve's points, then made perpendicular to the curve; the band is the envelope of the planes across them
(`geometry.ruled.envelope`), a developable whatever the normals were.  How far they lean over before that is measured.

Not where the normal does not turn (the band is flat there, or the surface is), nor where it turns about the curve
itself: the ruling then runs along the curve.
"""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial

import numpy as np

from stages.construct.bands import LEANING_DEG, least, limit_metric, size_along, stops, too_wide
from stages.construct.built import Built
from stages.construct.curves import Chain, common_pieces, spline
from stages.construct.meshes.normals import NO_MESHES, Meshes, mesh_normals
from stages.construct.plain import closed_chain
from stages.geometry.arrays import dot, floats, unit
from stages.geometry.curves.curves import Curve
from stages.geometry.ruled.envelope import Conjugate, crossing_sine, normal_share, room, swept, turn
from stages.model.envelopes import Ribbon
from stages.model.meshes import MeshNormals
from stages.model.report import Finding, Metric, Where
from stages.model.tolerances import Tolerances

Pieces = list[tuple[Curve, Curve]]
"""The curve and its normals, piece by piece."""


def ribbon(spec: Ribbon, link: Chain, tol: Tolerances, meshes: Meshes = NO_MESHES) -> Built:
    """Return the patches of a ribbon, how wide its sides may be, or why there is none."""
    if not isinstance(spec.normals, MeshNormals):
        return band(link, normal_chain(spec, link, tol), spec.sides)
    found = mesh_normals(link, meshes[spec.normals], tol)
    if found.normals is None:
        return Built((), found.metrics, found.findings)
    built = band(link, found.normals, spec.sides)
    return replace(built, measured=(*found.metrics, *built.measured), findings=(*found.findings, *built.findings))


def band(link: Chain, normals: Chain, sides: tuple[float, float]) -> Built:
    """Return the band along a chain under a chain of normals, its sides left and right, mm; or why there is none."""
    pieces = common_pieces(link, normals)
    curves, fields = [piece[0] for piece in pieces], [piece[1] for piece in pieces]
    stuck = stops("curve", curves)
    if stuck:
        return Built((), (), stuck)
    lean = _lean(link, normals)
    stuck = _leaning(lean) or _without_ruling(curves, fields)
    if stuck:
        return Built((), (lean,), stuck)
    return _made(sides, curves, [Conjugate(*piece) for piece in pieces], lean)


def _made(sides: tuple[float, float], curves: list[Curve], rulings: list[Conjugate], lean: Metric) -> Built:
    """Return the band between both sides, if they end before the edge of regression."""
    size, limits = size_along(curves), room(curves, rulings)
    measured, findings = [lean], list[Finding]()
    for name, width, widest in zip(("left", "right"), sides, limits, strict=True):
        measured.append(limit_metric(f"width_{name}_max_mm", widest, size))
        findings += too_wide("ribbon-too-wide", f"the width on the {name}", width, widest)
    left, right = sides
    patches = tuple(swept(curve, ruling, left, -right) for curve, ruling in zip(curves, rulings, strict=True))
    return Built(() if findings else patches, tuple(measured), tuple(findings))


def normal_chain(spec: Ribbon, link: Chain, tol: Tolerances) -> Chain:
    """Return the spline through the unit normals as given, over the parameter of the curve."""
    if isinstance(spec.normals, MeshNormals):
        raise ValueError("normals of a mesh are not given one by one")
    given = unit(np.array([floats(normal) for normal in spec.normals]))
    steps = len(given) - 1
    at = link.breaks if spec.curve.points is not None else tuple(Fraction(i, steps) for i in range(steps + 1))
    closed = bool(np.array_equal(given[0], given[-1])) and closed_chain(link) <= tol.join_mm
    return normals_through(given, at, closed=closed)


def normals_through(given: np.ndarray, at: tuple[Fraction, ...], *, closed: bool) -> Chain:
    """Return the spline through unit normals, shape (n, 3), at these parameters of the curve, from 0 to 1."""
    return Chain(spline(given, floats(at), closed=closed).curves, at)


def _lean(link: Chain, normals: Chain) -> Metric:
    """Return the largest angle by which a given normal departs from a right angle with the curve."""
    found: list[tuple[float, Where]] = []
    places = sorted({*link.breaks, *normals.breaks})
    for i, (v, normal) in enumerate(zip(normals.breaks, _given(normals), strict=True)):
        piece = min(bisect_right(link.breaks, v) - 1, len(link.curves) - 1)
        low, high = link.breaks[piece], link.breaks[piece + 1]
        share = np.array([float((v - low) / (high - low))])
        tangent = unit(link.curves[piece].jet(share, 1)[1, 0])
        angle = abs(float(np.degrees(np.arcsin(np.clip(dot(normal, tangent), -1.0, 1.0)))))
        found.append((angle, {"normal": i, "v": places.index(v)}))
    worst = max(found, key=lambda one: one[0])
    return Metric("normal_lean_deg", worst[0], "deg", "proved", LEANING_DEG, worst[1])


def _given(normals: Chain) -> list[np.ndarray]:
    """Return the normals that the spline goes through."""
    ends = [curve.jet(np.array([0.0, 1.0]), 0)[0] for curve in normals.curves]
    return [end[0] for end in ends] + [ends[-1][1]]


def _leaning(lean: Metric) -> tuple[Finding, ...]:
    """Refuse normals that are not perpendicular to the curve."""
    if lean.passed or lean.where is None:
        return ()
    message = (
        f"normals[{lean.where['normal']}] is {lean.value:.4g} deg off the right angle with the curve (at v = "
        f"{lean.where['v']:g}), the largest of all; at most {LEANING_DEG:g} deg: take the normals of the surface "
        "that the curve lies on"
    )
    return (Finding("normals-not-perpendicular", message, True, lean.where),)


def _without_ruling(curves: Sequence[Curve], fields: Sequence[Curve]) -> tuple[Finding, ...]:
    """Refuse normals that do not say where the rulings run: that turn too far at a time, not at all, or crosswise."""
    size = size_along(curves)
    pieces = list(zip(curves, fields, strict=True))
    share = least([partial(normal_share, *piece) for piece in pieces])
    if share.value <= HALF:
        text = "neighbouring normals are too far apart at v = {v:.6g} to say how they turn; give more of them"
        return (_refusal("normals-too-far-apart", text, share.where),)
    slowest = least([partial(turn, *piece) for piece in pieces])
    if slowest.value * size <= STILL:
        text = "the normal does not turn at v = {v:.6g}: the band is flat and has no ruling of its own there; split it"
        return (_refusal("ribbon-flat", text, slowest.where),)
    sine = least([partial(crossing_sine, *piece) for piece in pieces])
    if sine.value <= ALONG:
        text = (
            "the ruling at v = {v:.6g} runs along the curve: the normal turns about it there and nowhere else; split "
            "there, or move the curve"
        )
        return (_refusal("ribbon-ruling-along-curve", text, sine.where),)
    return ()


def _refusal(code: str, text: str, where: Where) -> Finding:
    return Finding(code, text.format(v=where["v"]), True, where)


HALF = 0.5
"""What is left across the curve half-way between unit normals that are 120 deg apart."""
STILL = 1e-6
"""Turning of the normal over the size of the band, rad, below which it does not turn: sampled, so not at rounding."""
ALONG = 1e-6
"""Sine of the angle between ruling and curve below which they are parallel: sampled as well."""
