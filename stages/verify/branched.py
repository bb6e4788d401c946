"""Verify a branched surface: every face has a certificate of its own, and the worst of them is that of the blank.

A branched surface is developable where its faces are and where their normals agree along the hinges, which construct
measures (`join_normal_deg`).  Each face is looked at for passing through itself; whether two faces pass through each
other is not.
"""

from collections.abc import Callable

from stages.model.gathered import Rule, gathered, told
from stages.model.report import Outcome, StageReport
from stages.model.surface import BranchedSurface, Certificate, RuledSurface
from stages.model.tolerances import CLASSES, Class, Tolerances

RULES: dict[str, Rule] = {"min_bend_radius_mm": "least", "regular": "all", "turn_deg": "sum"}

Check = Callable[[RuledSurface, Tolerances], Outcome[Certificate | None]]


def branched(surface: BranchedSurface, tol: Tolerances, check: Check) -> Outcome[Certificate | None]:
    """Return the certificate of a blank of which every face passes, else None with the reasons."""
    outcomes = [check(face, tol) for face in surface.faces]
    reports = [outcome.report for outcome in outcomes]
    certificates = [outcome.product for outcome in outcomes if outcome.product is not None]
    metrics = gathered([report.metrics for report in reports], surface.numbers, RULES)
    passes = len(certificates) == len(outcomes)
    reached: Class = max((one.reached for one in certificates), key=CLASSES.index, default="leather")
    rows = [
        {"face": number, "class": report.detail.get("class"), "sampled_warp_deg": report.detail.get("sampled_warp_deg")}
        for number, report in zip(surface.numbers, reports, strict=True)
    ]
    detail: dict[str, object] = {"class": reached if passes else "rejected", "verified_faces": rows}
    report = StageReport(
        "verify", surface.part.name, metrics, told([report.findings for report in reports], surface.numbers), detail
    )
    if not passes:
        return Outcome(None, report)
    return Outcome(Certificate(surface, reached, all(one.proved for one in certificates)), report)
