"""Each kind of ruled surface: its patches, what its theorem asks for, and what is found wrong.

One function per kind, chosen by the type of its specification.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial

import numpy as np

from stages.construct import minimax, theorems
from stages.construct.curves import Chain, chain, ends, largest_gap, ruled_patches
from stages.construct.plain import cone_patches, cylinder_patches, directrix_of, frustum
from stages.construct.quintic import (
    End,
    Vector,
    cone_ends,
    cone_over,
    cylinder_ends,
    directrix,
    patch_between,
    planar_ends,
    ruled_ends,
    vector,
)
from stages.construct.strip import joins_detail, strip_ends
from stages.geometry.arrays import Values, Vector3, dot, norm
from stages.geometry.curves import Curve
from stages.geometry.extremum import maximum
from stages.geometry.ruled import RuledPatch
from stages.model.part import Cone, Cylinder, Ruled, SurfaceSpec
from stages.model.quintics import (
    SHAPE_KEYS,
    QuinticCone,
    QuinticCylinder,
    QuinticPlanar,
    QuinticRuled,
    QuinticStrip,
)
from stages.model.report import Finding, Metric
from stages.model.scalars import floats
from stages.model.tolerances import Tolerances

EndPair = tuple[End, End]


@dataclass(frozen=True, slots=True)
class Built:
    """Patches and what was measured on the way; `residual` (of the size) becomes `theorem_residual`."""

    patches: tuple[RuledPatch, ...]
    measured: tuple[Metric, ...] = ()
    findings: tuple[Finding, ...] = ()
    residual: Callable[[float], float] | None = None
    detail: dict[str, object] = field(default_factory=dict)

    def metrics(self, size_mm: float) -> tuple[Metric, ...]:
        """Return the metrics, the theorem's residual among them once the size is known."""
        if self.residual is None or not size_mm > 0.0:
            return self.measured
        return (*self.measured, Metric("theorem_residual", self.residual(size_mm), "", "proved"))


def patches_of(spec: SurfaceSpec, tol: Tolerances) -> Built:
    """Return the patches of a ruled kind."""
    match spec:
        case QuinticRuled():
            return _quintic(*ruled_ends(spec, normalise=tol.normalise), tol)
        case QuinticPlanar():
            return _planar(spec, tol)
        case QuinticCylinder():
            return _cylinder(spec, tol)
        case QuinticCone():
            return _cone(spec, tol)
        case QuinticStrip():
            return _strip(spec, tol)
        case Ruled():
            c0, c1 = chain(spec.c0), chain(spec.c1)
            return Built(ruled_patches(c0, c1), findings=(*_open("c0", c0, tol), *_open("c1", c1, tol)))
        case Cone() if spec.directrix is None:
            return Built((frustum(spec),))
        case Cone():
            link = directrix_of(spec)
            patches = cone_patches(spec, link)
            return Built(
                patches,
                findings=(*_open("directrix", link, tol), *_apex_findings(link.curves, vector(spec.apex or ()))),
            )
        case Cylinder():
            link = directrix_of(spec)
            return Built(cylinder_patches(spec, link), findings=_open("directrix", link, tol))
    raise ValueError(f"no construction for {type(spec).__name__}")


def _open(key: str, link: Chain, tol: Tolerances) -> tuple[Finding, ...]:
    gap = largest_gap(link)
    if gap <= tol.join_mm:
        return ()
    return (Finding("chain-open", f"{key}: the pieces of the chain are {gap:.4g} mm apart", fatal=True),)


def _apex_findings(curves: Sequence[Curve], apex: Vector) -> tuple[Finding, ...]:
    """Refuse an apex on the directrix, naming the place."""
    for i, curve in enumerate(curves):
        least, v = _nearest(curve, floats(apex))
        if least <= ON_CURVE * float(norm(np.stack(ends(curve)) - floats(apex)).max()):
            return (Finding("apex-on-directrix", "the apex lies on the directrix", True, {"piece": i, "v": v}),)
    return ()


def _nearest(curve: Curve, point: Vector3) -> tuple[float, float]:
    """Return the least distance of a curve from a point, mm, and its place: sampled, then Gauss-Newton."""
    _, v = maximum(partial(_nearness, curve, point))
    for _ in range(NEWTON_STEPS):
        position, slope = curve.jet(np.array([v]), 1)[:, 0]
        speed = float(dot(slope, slope))
        v = min(max(v - float(dot(position - point, slope)) / speed, 0.0), 1.0) if speed > 0.0 else v
    return float(-_nearness(curve, point, np.array([v]))[0]), v


def _nearness(curve: Curve, point: Vector3, v: Values) -> Values:
    return -norm(curve.jet(v, 0)[0] - point)


NEWTON_STEPS = 3
"""The sampled place is good to 1e-8; on the curve each step squares that."""
ON_CURVE = 1e-9
"""An apex nearer to its directrix than this share of the cone's length lies on it: below, no ruling has a direction."""


def coefficients(patches: tuple[RuledPatch, ...]) -> dict[str, object]:
    """Return every A_i and C~_i of every patch, rounded once."""
    return {
        "A": [[float(a) for a in theorems.coefficients_a(patch)] for patch in patches],
        "C_tilde": [[[float(c) for c in row] for row in theorems.coefficients_c(patch)] for patch in patches],
    }


def _quintic(c0: EndPair, c1: EndPair, tol: Tolerances) -> Built:
    patch = patch_between(c0, c1)
    named = [("0", c0[0]), ("1", c0[1]), ("0_hat", c1[0]), ("1_hat", c1[1])]
    metrics, findings = theorems.end_metrics(named, tol)
    return Built(
        (patch,),
        tuple(metrics),
        tuple(findings),
        lambda size: theorems.relative_a(patch, size),
        coefficients((patch,)),
    )


def _planar(spec: QuinticPlanar, tol: Tolerances) -> Built:
    """Theorem 2.1: conditions (1) and (2) are measured; (3), all k = 0, holds by construction."""
    built = _quintic(*planar_ends(spec), tol)
    p0, p1, q0, q1 = (floats(point) for point in (spec.p0, spec.p1, spec.q0, spec.q1))
    first, second = theorems.parallel_residual([q0 - p0, q1 - p1]), theorems.parallel_residual([p1 - p0, q1 - q0])
    findings = list(built.findings)
    for number, value, text in ((1, first, "Q0 - P0 and Q1 - P1"), (2, second, "P1 - P0 and Q1 - Q0")):
        if value > PARALLEL:
            message = f"condition ({number}) of Theorem 2.1 does not hold: {text} enclose a sine of {value:.4g}"
            findings.append(Finding("theorem-condition", message))
    (patch,) = built.patches
    return Built(
        built.patches,
        built.measured,
        tuple(findings),
        lambda size: max(first, second, theorems.relative_a(patch, size)),
        built.detail,
    )


PARALLEL = 1e-9
"""Vectors that enclose a smaller angle are parallel: decimals of input are seldom better."""


def _cylinder(spec: QuinticCylinder, tol: Tolerances) -> Built:
    c0, c1 = cylinder_ends(spec, normalise=tol.normalise)
    patch = patch_between(c0, c1)
    metrics, findings = theorems.end_metrics([("0", c0[0]), ("1", c0[1])], tol)
    return Built(
        (patch,),
        tuple(metrics),
        tuple(findings),
        lambda size: theorems.relative_c(patch, size),
        coefficients((patch,)),
    )


def _cone(spec: QuinticCone, tol: Tolerances) -> Built:
    """Theorem 2.3: shape parameters given, or by the minimax of the speed; the cone over the directrix is exact."""
    bare = cone_ends(spec, (Fraction(0),) * 4, normalise=tol.normalise)
    metrics, findings = theorems.end_metrics([("0", bare[0]), ("1", bare[1])], tol)
    given = [getattr(spec, key) for key in SHAPE_KEYS]
    if None in given:
        best = minimax.solve(*bare, None if spec.guess is None else [float(x) for x in spec.guess])
        shape: tuple[Fraction, ...] = tuple(Fraction(x) for x in best.shape)
        if best.at_bound:
            findings.append(Finding("shape-at-bound", f"the minimax is at the least value allowed: {best.shape} mm"))
    else:
        shape = tuple(Fraction(x) for x in given)
    r = directrix(*cone_ends(spec, shape, normalise=tol.normalise))
    patch = cone_over(r, vector(spec.apex), (Fraction(spec.fraction[0]), Fraction(spec.fraction[1])))
    speed, place = minimax.largest_speed(r)
    metrics.append(Metric("speed_max", speed, "mm", "sampled", None, {"v": place}))
    detail = coefficients((patch,)) | {"shape": dict(zip(SHAPE_KEYS, map(float, shape), strict=True))}
    found = (*findings, *_apex_findings((r,), vector(spec.apex)))
    return Built((patch,), tuple(metrics), found, lambda size: theorems.relative_a(patch, size), detail)


def _strip(spec: QuinticStrip, tol: Tolerances) -> Built:
    """Theorem 3.1: further patches start with the derivatives of the end before; each stays of the first one's kind."""
    first = patches_of(spec.first, tol)
    if not first.patches:
        return first
    pairs = strip_ends(spec, first.detail, normalise=tol.normalise)
    if isinstance(spec.first, QuinticCone):
        fraction = (Fraction(spec.first.fraction[0]), Fraction(spec.first.fraction[1]))
        patches = tuple(cone_over(directrix(*c0), vector(spec.first.apex), fraction) for c0, _ in pairs)
    else:
        patches = tuple(patch_between(c0, c1) for c0, c1 in pairs if c1 is not None)
    named = [(f"{i}.{side}{hat}", end) for i, pair in enumerate(pairs) for side, hat, end in _named(pair)]
    metrics, findings = theorems.end_metrics(named, tol)
    relative = theorems.relative_c if isinstance(spec.first, QuinticCylinder) else theorems.relative_a
    detail = coefficients(patches) | joins_detail(pairs)
    kept = [metric for metric in first.measured if metric.name == "speed_max"]
    findings += [finding for finding in first.findings if finding.code not in ("end-curvature", "apex-on-directrix")]
    if isinstance(spec.first, QuinticCone):
        findings += _apex_findings([directrix(*c0) for c0, _ in pairs], vector(spec.first.apex))
    return Built(
        patches,
        (*metrics, *kept),
        tuple(findings),
        lambda size: max(relative(patch, size) for patch in patches),
        detail,
    )


def _named(pair: tuple[EndPair, EndPair | None]) -> list[tuple[str, str, End]]:
    hats = (("", pair[0]), ("_hat", pair[1]))
    return [(side, hat, end) for hat, ends in hats if ends for side, end in zip("01", ends, strict=True)]
