"""Verify: is the surface developable, how far is it from it, and is that proved?

    verify(surface, tol) -> Outcome[Certificate | None]

Polynomial and rational directrices get the exact certificate (`certificate`), everything else is sampled (`sampled`)
and says so.  The class follows from the warp: exact <= 1e-9 deg (or K == 0 proved), fabrication <= 0.1, metal <= 8,
leather <= 45.  A surface worse than `tol.accept` is refused with the place and the amount.  Strain is known only after
flattening: `unroll` may still refuse.
"""

import numpy as np

from stages.errors import NoSolutionError
from stages.model.report import Evidence, Metric, Outcome, StageReport, Where
from stages.model.surface import BranchedSurface, Certificate, MeshSurface, Plate, RuledSurface, Surface
from stages.model.tolerances import WARP_LIMIT_DEG, Tolerances, class_by_warp
from stages.verify import sampled
from stages.verify.bending import bending
from stages.verify.branched import branched
from stages.verify.crossing import crossings
from stages.verify.examined import Examined, examine
from stages.verify.findings import rejection, singular_findings
from stages.verify.sampled import Extreme

__all__ = ["verify"]

DEG = 180.0 / np.pi


def verify(surface: Surface, tol: Tolerances) -> Outcome[Certificate | None]:
    """Return the certificate of a surface whose class the job accepts, else None with the reason."""
    if isinstance(surface, Plate):
        return _plate(surface)
    if isinstance(surface, MeshSurface):
        return _mesh(surface, tol)
    if isinstance(surface, BranchedSurface):
        return branched(surface, tol, _strip)
    return _strip(surface, tol)


def _strip(surface: RuledSurface, tol: Tolerances) -> Outcome[Certificate | None]:
    """Return the certificate of a strip of ruled patches."""
    examined = [examine(patch, i) for i, patch in enumerate(surface.patches)]
    proved = all(one.proved for one in examined)
    bends, bent = bending(surface)
    findings = [*singular_findings(surface, examined), *bent]
    warp = _warp(surface, examined, WARP_LIMIT_DEG[tol.accept])
    regular = all(one.regular for one in examined)
    metrics = (
        warp,
        _gaussian(surface, examined),
        *bends,
        Metric("regular", regular, "", "proved" if all(one.proof for one in examined) else "sampled"),
        _turning(surface),
    )
    reached = class_by_warp(float(warp.value or 0.0))
    if reached is None or not tol.accepts(reached):
        findings.append(rejection(surface, warp, tol))
    elif not any(finding.fatal for finding in findings):
        findings += crossings(surface)
    passes = not any(finding.fatal for finding in findings)
    sampled_warp = max(one.sampled_warp for one in examined) * DEG
    detail: dict[str, object] = {"class": reached if passes else "rejected", "sampled_warp_deg": sampled_warp}
    report = StageReport("verify", surface.part.name, metrics, tuple(findings), detail)
    if reached is None or not report.passed:
        return Outcome(None, report)
    return Outcome(Certificate(surface, reached, proved), report)


def _mesh(surface: MeshSurface, tol: Tolerances) -> Outcome[Certificate | None]:
    """Return the certificate of a mesh that was not recognised: judged by the map that it will be cut by."""
    from stages.geometry.mesh.fit import MOST_TRIANGLES
    from stages.verify.meshes import too_fine, verdict

    if len(surface.mesh.faces) > MOST_TRIANGLES:
        return Outcome(None, StageReport("verify", surface.part.name, (), (too_fine(surface),)))
    judged = verdict(surface, tol)
    detail: dict[str, object] = {"class": judged.reached, "regions": list(judged.regions)}
    report = StageReport("verify", surface.part.name, judged.metrics, judged.findings, detail)
    if judged.reached == "rejected" or judged.reached == "inconclusive" or not report.passed:  # noqa: PLR1714
        return Outcome(None, report)
    return Outcome(Certificate(surface, judged.reached, proved=False, flat=judged.flat), report)


def _plate(plate: Plate) -> Outcome[Certificate | None]:
    metrics = (
        Metric("max_warp_deg", 0.0, "deg", "proved"),
        Metric("max_gaussian_curvature", 0.0, "", "proved"),
        Metric("min_bend_radius_mm", None, "mm", "proved"),
        Metric("outer_fibre_strain", None, "", "proved"),
        Metric("regular", True, "", "proved"),
        Metric("turn_deg", 0.0, "deg", "proved"),
    )
    report = StageReport("verify", plate.part.name, metrics, detail={"class": "exact"})
    return Outcome(Certificate(plate, "exact", proved=True), report)


def _warp(surface: RuledSurface, examined: list[Examined], limit: float) -> Metric:
    """Return the metric of the warp: the largest bound or sample of all patches, proved if that of every patch is."""
    worst = max((one.warp for one in examined), key=lambda extreme: extreme.value)
    evidence: Evidence = "proved" if all(one.proved for one in examined) else "sampled"
    return Metric("max_warp_deg", worst.value * DEG, "deg", evidence, limit, _where(surface, worst))


def _gaussian(surface: RuledSurface, examined: list[Examined]) -> Metric:
    """Return |K| D^2; not defined where it grows without bound (towards a normal that vanishes)."""
    worst = max((one.gaussian for one in examined), key=lambda extreme: extreme.value)
    value = worst.value * surface.size_mm**2
    evidence: Evidence = "proved" if all(one.curvature_proved for one in examined) else "sampled"
    finite = value if np.isfinite(value) else None
    return Metric("max_gaussian_curvature", finite, "", evidence, None, _where(surface, worst))


def _where(surface: RuledSurface, extreme: Extreme) -> Where | None:
    """Return the place of an extreme; none where it is 0 everywhere."""
    return {"v": surface.v_of(extreme.piece, extreme.v)} if extreme.value else None


def _turning(surface: RuledSurface) -> Metric:
    """Return the total turning of the rulings in the flat; not defined where it does not resolve (a fold)."""
    try:
        return Metric("turn_deg", abs(sum(sampled.turning(patch) for patch in surface.patches)) * DEG, "deg")
    except NoSolutionError:
        return Metric("turn_deg", None, "deg")
