"""Verify: is the surface developable, how far is it from it, and is that proved?

    verify(surface, tol) -> Outcome[Certificate | None]

Polynomial directrices get the exact certificate (`certificate`), everything else is sampled (`sampled`) and says so.
The class follows from the warp: exact <= 1e-9 deg (or K == 0 proved), fabrication <= 0.1, metal <= 8, leather <= 45.
A surface worse than `tol.accept` is refused with the place and the amount.  Strain is known only after flattening:
`unroll` may still refuse.
"""

import numpy as np

from stages.errors import NoSolutionError
from stages.geometry.ruled import RuledPatch, frames, regression
from stages.model.report import Finding, Metric, Outcome, StageReport, Where
from stages.model.surface import Certificate, Plate, RuledSurface, Surface
from stages.model.tolerances import WARP_LIMIT_DEG, Tolerances, class_by_warp
from stages.verify import sampled
from stages.verify.bending import smallest_radius
from stages.verify.certificate import Certified, certify
from stages.verify.sampled import Extreme

__all__ = ["verify"]

DEG = 180.0 / np.pi


def verify(surface: Surface, tol: Tolerances) -> Outcome[Certificate | None]:
    """Return the certificate of a surface whose class the job accepts, else None with the reason."""
    if isinstance(surface, Plate):
        return _plate(surface)
    warps = [sampled.largest_warp(patch, i) for i, patch in enumerate(surface.patches)]
    proofs = [_proof(patch, warp) for patch, warp in zip(surface.patches, warps, strict=True)]
    radius, bending = smallest_radius(surface)
    findings = [*_singular(surface, proofs), *bending]
    warp, proved = _warp(warps, proofs, WARP_LIMIT_DEG[tol.accept])
    metrics = (
        warp,
        _gaussian(surface, proofs),
        radius,
        Metric("regular", _regular(surface, proofs), "", "proved" if proved else "sampled"),
        _turning(surface),
    )
    reached = class_by_warp(float(warp.value or 0.0))
    if reached is None or not tol.accepts(reached):
        findings.append(_rejection(surface, warp, tol))
    passes = not any(finding.fatal for finding in findings)
    sampled_warp = max(extreme.value for extreme in warps) * DEG
    detail: dict[str, object] = {"class": reached if passes else "rejected", "sampled_warp_deg": sampled_warp}
    report = StageReport("verify", surface.part.name, metrics, tuple(findings), detail)
    if reached is None or not report.passed:
        return Outcome(None, report)
    return Outcome(Certificate(surface, reached, proved), report)


def _plate(plate: Plate) -> Outcome[Certificate | None]:
    metrics = (
        Metric("max_warp_deg", 0.0, "deg", "proved"),
        Metric("max_gaussian_curvature", 0.0, "", "proved"),
        Metric("min_bend_radius_mm", None, "mm", "proved"),
        Metric("regular", True, "", "proved"),
        Metric("turn_deg", 0.0, "deg", "proved"),
    )
    report = StageReport("verify", plate.part.name, metrics, detail={"class": "exact"})
    return Outcome(Certificate(plate, "exact", proved=True), report)


def _proof(patch: RuledPatch, warp: Extreme) -> Certified | None:
    return certify(patch, warp.v) if patch.polynomial else None


def _warp(warps: list[Extreme], proofs: list[Certified | None], limit: float) -> tuple[Metric, bool]:
    """Return the metric of the warp: the largest proved bound where every piece has one, else the largest sample.

    A piece whose proof stays open (an interior zero of a normal) is represented by its sample, and nothing is proved.
    """
    proved = all(proof is not None and proof.positive is not None for proof in proofs)
    worst = max(warps, key=lambda extreme: extreme.value)
    if not proved:
        return Metric("max_warp_deg", worst.value * DEG, "deg", "sampled", limit, worst.where), False
    bounds = [(proof, extreme) for proof, extreme in zip(proofs, warps, strict=True) if proof is not None]
    proof, extreme = max(bounds, key=lambda pair: pair[0].warp_rad)
    where: Where = extreme.where if proof.where is None else {"v": extreme.piece + proof.where}
    return Metric("max_warp_deg", proof.warp_rad * DEG, "deg", "proved", limit, where), True


def _gaussian(surface: RuledSurface, proofs: list[Certified | None]) -> Metric:
    """Return |K| D^2, proved where every piece has a bound."""
    square = surface.size_mm**2
    found = [sampled.largest_gaussian(patch, i) for i, patch in enumerate(surface.patches)]
    worst = max(found, key=lambda extreme: extreme.value)
    bounds = [proof.curvature if proof is not None else np.inf for proof in proofs]
    if np.isfinite(max(bounds)):
        return Metric("max_gaussian_curvature", max(bounds) * square, "", "proved", None, worst.where)
    value = worst.value * square
    return Metric("max_gaussian_curvature", value if np.isfinite(value) else None, "", "sampled", None, worst.where)


def _turning(surface: RuledSurface) -> Metric:
    """Return the total turning of the rulings in the flat; not defined where it does not resolve (a fold)."""
    try:
        return Metric("turn_deg", abs(sum(sampled.turning(patch) for patch in surface.patches)) * DEG, "deg")
    except NoSolutionError:
        return Metric("turn_deg", None, "deg")


def _regular(surface: RuledSurface, proofs: list[Certified | None]) -> bool:
    """Return whether the normal vanishes nowhere, edges included."""
    return all(
        sampled.is_regular(patch) if proof is None or proof.positive is None else proof.regular
        for patch, proof in zip(surface.patches, proofs, strict=True)
    )


def _singular(surface: RuledSurface, proofs: list[Certified | None]) -> list[Finding]:
    """Refuse rulings of no length and rulings along the directrix, unless a proof excludes them."""
    findings = []
    for i, (patch, proof) in enumerate(zip(surface.patches, proofs, strict=True)):
        if proof is not None and proof.positive:
            continue
        ruling, normal = sampled.shortest_ruling(patch, i), sampled.weakest_normal(patch, i)
        if ruling.value <= SINGULAR * surface.size_mm:
            findings.append(Finding("zero-ruling", "a ruling inside the patch has no length", True, ruling.where))
        elif normal.value <= SINGULAR:
            message = "a ruling runs along the directrix: the surface has an edge inside"
            findings.append(Finding("singular-ruling", message, True, normal.where))
    return findings


SINGULAR = 1e-6
"""Relative size below which a ruling or a normal inside the patch is taken for zero: sampled, so not at rounding."""


def _rejection(surface: RuledSurface, warp: Metric, tol: Tolerances) -> Finding:
    value = float(warp.value or 0.0)
    if value >= FOLDED_DEG:
        message = (
            f"the edge of regression lies inside{_crossing(surface, warp)}: the patch folds back; shorten the rulings"
        )
        return Finding("edge-of-regression", message, True, warp.where)
    reached = class_by_warp(value) or "no class"
    place = f"at v = {float((warp.where or {}).get('v', 0)):.6g}" if warp.where else ""
    message = (
        f"not developable enough: warp {value:.6g} deg {place}, allowed {WARP_LIMIT_DEG[tol.accept]:g} deg "
        f"(accept = {tol.accept!r}); it reaches {reached!r}"
    )
    return Finding("not-developable", message, True, warp.where)


def _crossing(surface: RuledSurface, warp: Metric) -> str:
    """Return where the edge of regression crosses the worst ruling, if it is known and crosses it inside."""
    v = float((warp.where or {}).get("v", 0.0))
    piece = min(int(v), len(surface.patches) - 1)
    u = float(regression(frames(surface.patches[piece], np.array([v - piece])))[0])
    return f" (at u = {u:.4g}, v = {v:.4g})" if 0.0 <= u <= 1.0 else ""


FOLDED_DEG = 90.0
"""From here on the end normals of a ruling look away from each other."""
