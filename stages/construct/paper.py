"""The paper's kinds: their patches, what its theorems ask for, and what is found wrong with the data.

One function per theorem; the mathematics is in `quintic`, `theorems`, `minimax` and `strip`.
"""

from dataclasses import replace
from fractions import Fraction

from stages.construct import minimax, theorems
from stages.construct.apex import apex_findings
from stages.construct.built import Built
from stages.construct.geodesic import geodesic
from stages.construct.quintic import (
    End,
    cone_ends,
    cone_over,
    cylinder_ends,
    directrix,
    patch_between,
    planar_ends,
    ruled_ends,
    vector,
)
from stages.construct.shape import Patch, settled
from stages.construct.strip import joins_detail, strip_ends
from stages.construct.through import strip_through
from stages.geometry.arrays import floats
from stages.model.quintics import (
    SHAPE_KEYS,
    QuinticCone,
    QuinticCylinder,
    QuinticPlanar,
    QuinticRuled,
)
from stages.model.quinticstrip import QuinticStrip
from stages.model.report import Finding, Metric
from stages.model.tolerances import Tolerances

EndPair = tuple[End, End]


def paper_kind(spec: Patch | QuinticStrip, tol: Tolerances) -> Built:
    """Return the patches of one of the paper's kinds, shape parameters found where the job leaves them open."""
    if isinstance(spec, QuinticStrip):
        return strip_through(spec, tol) if spec.through is not None else _strip(spec, tol)
    made = settled(spec, normalise=tol.normalise)
    built = _patch(made.spec, tol)
    return replace(built, findings=(*built.findings, *made.findings), detail=built.detail | made.detail)


def _patch(spec: Patch, tol: Tolerances) -> Built:
    match spec:
        case QuinticRuled() if spec.directrix_geodesic:
            return geodesic(spec, tol)
        case QuinticRuled():
            return _quintic(*ruled_ends(spec, normalise=tol.normalise), tol)
        case QuinticPlanar():
            return _planar(spec, tol)
        case QuinticCylinder():
            return _cylinder(spec, tol)
        case QuinticCone():
            return _cone(spec, tol)


def _quintic(c0: EndPair, c1: EndPair, tol: Tolerances) -> Built:
    patch = patch_between(c0, c1)
    named = [("0", c0[0]), ("1", c0[1]), ("0_hat", c1[0]), ("1_hat", c1[1])]
    metrics, findings = theorems.end_metrics(named, tol)
    return Built(
        (patch,),
        tuple(metrics),
        tuple(findings),
        lambda size: theorems.relative_a(patch, size),
        theorems.coefficients((patch,)),
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
        theorems.coefficients((patch,)),
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
    detail = theorems.coefficients((patch,)) | {"shape": dict(zip(SHAPE_KEYS, map(float, shape), strict=True))}
    found = (*findings, *apex_findings((r,), vector(spec.apex)))
    return Built((patch,), tuple(metrics), found, lambda size: theorems.relative_a(patch, size), detail)


def _strip(spec: QuinticStrip, tol: Tolerances) -> Built:
    """Theorem 3.1: further patches start with the derivatives of the end before; each stays of the first one's kind."""
    if spec.first is None:
        raise ValueError("a strip without a first patch passed the checks of the job file")
    made = settled(spec.first, normalise=tol.normalise)
    start, first = made.spec, _patch(made.spec, tol)
    pairs = strip_ends(start, spec.next or (), first.detail, normalise=tol.normalise)
    if isinstance(start, QuinticCone):
        fraction = (Fraction(start.fraction[0]), Fraction(start.fraction[1]))
        patches = tuple(cone_over(directrix(*c0), vector(start.apex), fraction) for c0, _ in pairs)
    else:
        patches = tuple(patch_between(c0, c1) for c0, c1 in pairs if c1 is not None)
    named = [(f"{i}.{side}{hat}", end) for i, pair in enumerate(pairs) for side, hat, end in _named(pair)]
    metrics, findings = theorems.end_metrics(named, tol)
    relative = theorems.relative_c if isinstance(start, QuinticCylinder) else theorems.relative_a
    detail = theorems.coefficients(patches) | joins_detail(pairs) | made.detail
    kept = [metric for metric in first.measured if metric.name == "speed_max"]
    findings += made.findings
    findings += [finding for finding in first.findings if finding.code not in ("end-curvature", "apex-on-directrix")]
    if isinstance(start, QuinticCone):
        findings += apex_findings([directrix(*c0) for c0, _ in pairs], vector(start.apex))
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
