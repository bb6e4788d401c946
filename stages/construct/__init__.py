"""Construct: from the description of a part to its surface, with every condition measured.

    construct(part, tol) -> Outcome[Surface | None]

A surface that cannot be made (an apex on its directrix, an outline that does not close) is refused with a finding.
What a theorem of the paper assumes is computed as a metric, never taken for granted.  Whether the surface is
developable is not decided here: `verify` does that for every kind alike.
"""

import numpy as np

from stages.construct.assemble import patches_of
from stages.construct.features import placed
from stages.construct.joins import join_metrics, join_rows, joins_of
from stages.geometry.ruled.planarity import is_planar
from stages.geometry.ruled.ruled import RuledPatch, size_of
from stages.model.caps import MOST_CHORDS
from stages.model.ducts import MainOpening
from stages.model.faces import FaceFile
from stages.model.material import Part
from stages.model.meshes import MeshFile
from stages.model.part import Flat
from stages.model.report import Finding, Metric, Outcome, StageReport
from stages.model.surface import RuledSurface, Surface, whole_spans
from stages.model.tolerances import Tolerances

__all__ = ["construct"]


def construct(part: Part, tol: Tolerances) -> Outcome[Surface | None]:
    """Return the surface of a part in mm, or None with the reason; lengths are exact to rounding."""
    if isinstance(part.spec.surface, Flat):
        from stages.construct.plates import plate

        return plate(part, part.spec.surface, tol)
    if isinstance(part.spec.surface, MainOpening):
        from stages.construct.openings import main_opening

        return main_opening(part, part.spec.surface.tee)
    if isinstance(part.spec.surface, MeshFile):
        from stages.construct.meshes.surface import mesh_surface

        return mesh_surface(part, part.spec.surface, tol)
    if isinstance(part.spec.surface, FaceFile):
        from stages.construct.faces.surface import face_surface

        return face_surface(part, tol)
    built = patches_of(part.spec.surface, tol, part.meshes)
    size = size_of(built.patches) if built.patches else 0.0
    findings = [*part.remarks, *built.findings, *_size_findings(built.patches, size, tol)]
    metrics, detail = [*built.metrics(size)], dict(built.detail)
    if built.patches and size > 0.0:
        joins = joins_of(built.patches)
        metrics += [*_planar(built.patches), *join_metrics(joins, size, tol)]
        detail |= _with_joins(built.detail, join_rows(joins, size, tol))
    features = placed(part.spec, () if any(finding.fatal for finding in findings) else built.patches, tol)
    metrics, findings = [*metrics, *features.metrics], [*findings, *features.findings]
    report = StageReport("construct", part.name, tuple(metrics), tuple(findings), detail)
    if not report.passed:
        return Outcome(None, report)
    return Outcome(RuledSurface(part, built.patches, size, whole_spans(len(built.patches)), features.features), report)


def _size_findings(patches: tuple[RuledPatch, ...], size: float, tol: Tolerances) -> list[Finding]:
    if patches and not np.isfinite(size):
        return [Finding("not-finite", "the surface is not finite", fatal=True)]
    if patches and size == 0.0:
        return [Finding("no-extent", "all points of the surface coincide", fatal=True)]
    if patches and size > MOST_CHORDS * tol.chord_mm:
        message = f"the surface is {size:.3g} mm across and its contours are to be within {tol.chord_mm:g} mm"
        cure = "check the units, or choose a coarser tolerance.chord"
        return [Finding("too-large", f"{message}: {cure}", fatal=True, where={"size_mm": size})]
    return []


def _planar(patches: tuple[RuledPatch, ...]) -> list[Metric]:
    planar, proved = is_planar(patches)
    return [Metric("planar", planar, "", "proved" if proved else "sampled")]


def _with_joins(detail: dict[str, object], rows: list[dict[str, object]]) -> dict[str, object]:
    """Return the joins as measured, beside what a theorem says of them."""
    theorem = detail.get("joins")
    if isinstance(theorem, list):
        rows = [row | said for row, said in zip(rows, theorem, strict=True)]
    return {"joins": rows} if rows else {}
