"""The report of a job as one document, schema planish-report/1: the same bytes for the same job, `run` apart.

Keys stand in a fixed order and numbers are written in full (shortest decimals that give the same double).  What is not
a finite number becomes null.  Two additions to the metrics that the stages report: per part and per sheet mass, length
of cut and number of pierces, from the contours that are cut.

The status of `write` is that of the nested sheets: without a nest it is `skipped`, and the files listed are the flat
patterns.
"""

import json
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from pipeline import __version__
from pipeline.files import FileNames, file_names
from pipeline.layouts import engine_of
from pipeline.provenance import environment, provenance
from pipeline.report.costs import costs_entry, job_costs
from pipeline.report.cuts import cuts_of_sheets
from pipeline.report.figures import Figures, figures, total
from pipeline.report.jobentry import job_entry
from pipeline.report.nestentries import options_entry, stock_entry, wish_entry
from pipeline.report.stockfigures import stock_figures
from pipeline.run import JobResult, PartRun, Step
from pipeline.store import digest
from stages.model.report import Finding, Metric

if TYPE_CHECKING:
    from stages.model.pattern import FlatPattern
    from stages.model.sheet import Placement, SheetLayout

SCHEMA = "planish-report/1"
Document = dict[str, object]
CONTENTS = ("class", "surface", "flat", "sides")
"""The entries of a stage's detail that have a place of their own, in the report or beside the drawings."""


def document(result: JobResult, files: Mapping[str, bytes]) -> Document:
    """Return the report of a job whose drawings are `files`, by their paths."""
    measures = measured(result)
    return {
        "schema": SCHEMA,
        "status": result.status,
        "job": job_entry(result.job),
        "provenance": provenance(result.job.digest, result.job.limits),
        "parts": [_part(run, measures.get(run.part.name)) for run in result.parts],
        "nest": nest_entry(result, measures),
        "write": write_entry(result, files),
        "run": {
            "version": __version__,
            "seconds": dict(result.seconds),
            "inputs": [{"name": name, "sha256": found} for name, found in result.job.inputs],
            "environment": environment(name for name, _ in result.job.inputs),
        },
    }


def nest_entry(result: JobResult, measures: Mapping[str, Figures]) -> Document:
    """Return the nest of a report.  measures: of the parts, by their names."""
    names = file_names(result.parts, result.job)
    patterns = {run.part.name: run.pattern for run in result.parts if run.pattern is not None}
    return {
        **_step(result.nest),
        **_basis(result),
        "sheets": [
            {**_sheet(layout, patterns, measures, names), **cuts}
            for layout, cuts in zip(_layouts(result), _cuts_read(result, names), strict=True)
        ],
        **_costs(result),
    }


def write_entry(result: JobResult, files: Mapping[str, bytes]) -> Document:
    """Return what a report says of the drawings, `files` by their paths."""
    return {
        **_step(result.write),
        "status": _write_status(result),
        "files": [{"path": path, "sha256": digest(content)} for path, content in files.items()],
    }


def encoded(report: Mapping[str, object]) -> bytes:
    """Return a document as JSON, without NaN and infinities."""
    text = json.dumps(plain(report), ensure_ascii=False, allow_nan=False, indent=1)
    return f"{text}\n".encode()


def compact(value: object) -> str:
    """Return a value as JSON in one line; what is plain already, as nearly all is, is not looked through."""
    try:
        return json.dumps(value, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    except (TypeError, ValueError):  # arrays; numbers that are not finite
        return json.dumps(plain(value), ensure_ascii=False, allow_nan=False, separators=(",", ":"))


def plain(value: object) -> object:
    """Return a value as JSON has it: numbers that are not finite as null, arrays as lists."""
    if isinstance(value, bool | int | str) or value is None:
        return value
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    number = float(value)  # type: ignore[arg-type]
    return number if math.isfinite(number) else None


def measured(result: JobResult) -> dict[str, Figures]:
    """Return the figures of the parts that passed: of what is left when holes and notches have been cut."""
    from stages.geometry.curves.contours import area

    patterns = {run.part.name: run.pattern for run in result.parts if run.pattern is not None}
    return {
        name: figures(pattern, sum(area(contour.edges) for contour in (pattern.outer, *pattern.inner)))
        for name, pattern in patterns.items()
    }


def _detail(run: PartRun) -> dict[str, object]:
    """Return the details of all stages of a part together."""
    return {key: value for step in run.steps for key, value in step.report.detail.items()}


def _basis(result: JobResult) -> Document:
    """Return who placed the copies, on which stock and with which wishes; nothing without stock."""
    if not result.job.stock:
        return {}
    return {
        "engine": engine_of(result),
        "options": options_entry(result.job.options),
        "stock": [stock_entry(sheet) for sheet in result.job.stock],
    }


def _costs(result: JobResult) -> Document:
    """Return the cost table of what was nested."""
    made = job_costs(result)
    return {} if made is None else {"cost": costs_entry(made)}


def _part(run: PartRun, measured: Figures | None) -> Document:
    detail = _detail(run)
    passed = run.pattern is not None
    return {
        "name": run.part.name,
        "quantity": run.part.spec.quantity,
        "class": class_of(run),
        "flat": detail.get("flat") if passed else None,
        "surface": _surface(detail) if passed else None,
        **figures_entry(measured),
        "tape": _tape(run, detail),
        "formed": _formed(run),
        "nest": None if run.pattern is None else wish_entry(run.pattern),
        "stages": [{"stage": step.report.stage, **_step(step)} for step in run.steps],
    }


def _tape(run: PartRun, detail: Document) -> Document | None:
    """Return what is measured on the blank of a part that passed."""
    flat = detail.get("flat")
    if run.pattern is None or not isinstance(flat, dict):
        return None
    from pipeline.report.tape import tape_entry

    widened = any(seam.allowance_mm > 0.0 for seam in run.part.spec.seam)
    return tape_entry(run.pattern, None if widened else flat["edges"])


def _formed(run: PartRun) -> Document | None:
    """Return how large a formed part is; nothing of a plate, and where nothing was constructed."""
    from pipeline.report.formedsize import formed_entry

    return None if run.surface is None else formed_entry(run.surface)


def _surface(detail: Document) -> object:
    """Return the figures of the surface, with the pieces that a strip between rails is made of."""
    figures = detail.get("surface")
    return {**figures, "pieces": detail["pieces"]} if isinstance(figures, dict) and "pieces" in detail else figures


def class_of(run: PartRun) -> str:
    """Return the class by warp and strain of a part that passed; else rejected, or open where a method fell short."""
    if any(step.short for step in run.steps):
        return "inconclusive"
    return "rejected" if run.pattern is None else str(_detail(run)["class"])


def figures_entry(measured: Figures | None) -> Document:
    """Return mass, length of cut and pierces, null for what is not known."""
    if measured is None:
        return {"mass_kg": None, "cut_length_mm": None, "pierces": None}
    return {"mass_kg": measured.mass_kg, "cut_length_mm": measured.cut_length_mm, "pierces": measured.pierces}


def _step(step: Step[object]) -> Document:
    report = step.report
    detail = {key: value for key, value in report.detail.items() if key not in CONTENTS}
    return {
        "status": step.status,
        "metrics": [_metric(metric) for metric in report.metrics],
        "findings": [_finding(finding) for finding in report.findings],
        **({"detail": detail} if detail else {}),
    }


def _metric(metric: Metric) -> Document:
    return {
        "name": metric.name,
        "value": metric.value,
        "unit": metric.unit,
        "evidence": metric.evidence,
        "limit": metric.limit,
        "pass": metric.passed,
        "margin": metric.margin,
        "where": metric.where,
    }


def _finding(finding: Finding) -> Document:
    return {"code": finding.code, "message": finding.message, "fatal": finding.fatal, "where": finding.where or {}}


def _layouts(result: JobResult) -> Sequence["SheetLayout"]:
    return () if result.nest.product is None else result.nest.product.layouts


def _write_status(result: JobResult) -> str:
    return "skipped" if result.write.status == "pass" and result.nest.product is None else result.write.status


def _sheet(
    layout: "SheetLayout", patterns: "Mapping[str, FlatPattern]", measures: Mapping[str, Figures], names: FileNames
) -> Document:
    parts = total([measures[placed.part] for placed in layout.placements])
    return {
        "stock": layout.sheet.id,
        "index": layout.index,
        "utilisation": layout.utilisation,
        "file": names.drawing(layout),
        **figures_entry(parts),
        **stock_figures(layout, patterns),
        "placements": [_placement(placed) for placed in layout.placements],
    }


def _cuts_read(result: JobResult, names: FileNames) -> list[Document]:
    """Return what cutting each sheet takes, as its file reads, where that is not what its parts take by themselves."""
    if not result.job.options.common_line and not names.machine.helps.any:
        return [{} for _ in _layouts(result)]
    found = cuts_of_sheets(result.write.report, _layouts(result), names)
    whole = [None if cuts.pierces is None else int(cuts.pierces) for cuts in found]
    return [{"cut_length_mm": cuts.length_mm, "pierces": one} for cuts, one in zip(found, whole, strict=True)]


def _placement(placed: "Placement") -> Document:
    motion = placed.motion
    return {
        "part": placed.part,
        "copy": placed.copy,
        "x": motion.x,
        "y": motion.y,
        "angle": motion.angle_deg,
        "mirrored": motion.mirrored,
    }
