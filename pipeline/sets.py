"""The seams of a part that is made of several blanks: how much the edges differ that are welded to each other.

Lengths are those of the flat patterns that are cut.  What a seam's edges differ by stands in the report of the blank
that has the seam's second half.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from stages.model.report import Finding, Metric, StageReport
from stages.model.tolerances import Tolerances

if TYPE_CHECKING:
    from pipeline.run import PartRun
    from stages.construct.sets import Edges, Seam


def with_seams(runs: "Sequence[PartRun]", seams: "Sequence[Seam]", tol: Tolerances) -> "tuple[PartRun, ...]":
    """Return the runs of a set's blanks, with `seam_difference_mm` where both sides of a seam have a pattern."""
    made = {run.part.name: run for run in runs}
    for seam in seams:
        one, other = made[seam.one.blank], made[seam.other.blank]
        if one.pattern is not None and other.pattern is not None:
            difference = length(other, seam.other) - length(one, seam.one)
            made[seam.other.blank] = _told(other, seam, difference, tol)
    return tuple(made.values())


def length(run: "PartRun", side: "Edges") -> float:
    """Return the length of a seam's side in the flat, mm."""
    flat = run.steps[-1].report.detail["flat"]
    if not isinstance(flat, dict):
        raise ValueError(f"the pattern of {side.blank!r} has no lengths")
    lengths = {"outline": flat["outline_length"]} | (flat["edges"] or {})
    return sum(float(lengths[name]) for name in side.edges)


def _told(run: "PartRun", seam: "Seam", difference: float, tol: Tolerances) -> "PartRun":
    *before, last = run.steps
    metric = Metric("seam_difference_mm", abs(difference), "mm")
    findings: tuple[Finding, ...] = ()
    if abs(difference) > tol.join_mm:
        message = (
            f"the seam with {seam.one.blank!r} is {abs(difference):.4g} mm {'longer' if difference > 0 else 'shorter'} "
            f"on this side, allowed {tol.join_mm:g} mm: the faces of the sheet that meet there differ"
        )
        findings = (Finding("seams-differ", message, False, {"blank": seam.one.blank}),)
    report: StageReport = replace(
        last.report, metrics=(*last.report.metrics, metric), findings=(*last.report.findings, *findings)
    )
    return replace(run, steps=(*before, replace(last, report=report)))
