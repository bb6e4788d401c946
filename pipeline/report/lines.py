"""What the terminal shows of a job: a line for each stage of each part with the figures that matter, and the outcome.

Where something fails, the lines below say where, how much, what is allowed, and what to do about it.
"""

from collections.abc import Collection, Iterator

from pipeline.report.telling import told_of
from pipeline.report.traveller.numbers import counted
from pipeline.run import JobResult, Step
from stages.model.report import Metric, StageReport, Where

SHOWN: dict[str, tuple[tuple[str, str], ...]] = {
    "construct": (("theorem_residual", "residual"), ("join_gap_mm", "join gap"), ("speed_max", "speed")),
    "verify": (
        ("max_warp_deg", "warp"), ("equivalent_warp_deg", "equivalent warp"), ("max_strain", "strain"),
        ("mesh_noise", "noise"), ("max_gaussian_curvature", "K D2"), ("min_bend_radius_mm", "R min"),
    ),
    "unroll": (("length_error", "length error"), ("area_error", "area error"), ("metric_error", "metric error")),
    "nest": (
        ("utilisation", "utilisation"), ("min_gap_mm", "gap"), ("min_edge_gap_mm", "edge gap"),
        ("common_line_mm", "common lines"), ("travel_mm", "travel"),
    ),
    "write": (("max_deviation_mm", "deviation"), ("closure_gap_mm", "closure"), ("entities", "entities")),
}  # fmt: skip
"""The metrics of each stage that are shown, and what they are called."""

REMEDIES = {
    "regular": "shorten the rulings, or move the edge of regression off the part",
    "tangent_norm_error": "give unit vectors, or set normalise = true under [tolerance]",
    "join_gap_mm": "make the pieces meet, or widen join under [tolerance]",
    "planar_error_mm": "bring the points of the outline into one plane",
    "max_deviation_mm": "widen chord under [tolerance]",
    "not-developable": "straighten the twist along the rulings, or accept a wider class under [tolerance]",
    "self-crossing": "shorten the rulings, or end the part before it comes back to itself",
    "edge-of-regression": "shorten the rulings, or cut the part into pieces",
    "bend-radius": "bend less sharply, take thinner sheet, or another material",
    "bend-strain": "bend less sharply, take thinner sheet, or another material",
    "apex-on-directrix": "move the apex off the curve",
    "open-contour": "close the contour: end it at the point where it begins",
    "chain-open": "make the pieces meet, or widen join under [tolerance]",
    "cusp": "smooth the curve there, or cut the part into pieces",
    "zero-ruling": "keep the two curves apart",
    "singular-ruling": "turn the rulings off the direction of the curve",
    "part-too-large": "give a larger sheet under [[stock]], smaller gaps, or cut the part into pieces",
    "stock-exhausted": "give more or larger sheets under [[stock]]",
}
"""What to do, by the name of a failed metric or the code of a finding."""


def step_line(step: Step[object]) -> str:
    """Return one line: part, stage, result, figures."""
    subject, stage = step.report.subject, step.report.stage
    return stage_line(step) if subject == stage else f"{subject}  {stage_line(step)}"


def stage_line(step: Step[object]) -> str:
    """Return the same without the part."""
    report = step.report
    figures = [shown for shown in (_shown(report, *entry) for entry in SHOWN[report.stage]) if shown]
    return "  ".join([report.stage, _word(step), *_extent(report), *figures])


def _word(step: Step[object]) -> str:
    """Return the result in a word: FAILED, the class of a verified surface, or ok."""
    if step.status == "fail":
        return "FAILED"
    return str(step.report.detail.get("class", "ok")) if step.status == "pass" else step.status


def _extent(report: StageReport) -> list[str]:
    """Return the size of a flat pattern, as far as the report has it."""
    flat = report.detail.get("flat")
    if not isinstance(flat, dict):
        return []
    return [f"{flat['width']:.6g} x {flat['height']:.6g} mm", f"area {flat['area']:.8g} mm2"]


def _shown(report: StageReport, name: str, label: str) -> str:
    metric = next((metric for metric in report.metrics if metric.name == name), None)
    if metric is None or metric.value is None:
        return ""
    proved = " (proved)" if metric.evidence == "proved" else ""
    return f"{label} {_amount(metric.value, metric.unit)}{proved}"


def _amount(value: float | bool | None, unit: str) -> str:
    if value is None or isinstance(value, bool):
        return {None: "not defined", True: "true", False: "false"}[value]
    return f"{value:.6g} {unit}".rstrip()


def trouble_lines(report: StageReport) -> Iterator[str]:
    """Yield what failed and what an engineer must know, with place, limit and remedy."""
    told = told_of(finding.code for finding in report.findings)
    for metric in report.metrics:
        if not metric.passed and metric.name not in told:
            yield _advised(metric.name, _failure(metric))
    for finding in report.findings:
        text = finding.message if " at " in finding.message else f"{finding.message}{_place(finding.where)}"
        yield _advised(finding.code, text) if finding.fatal else f"  note: {text}"


def _failure(metric: Metric) -> str:
    allowed = "must be" if isinstance(metric.limit, bool) else "allowed"
    value, limit = _amount(metric.value, metric.unit), _amount(metric.limit, metric.unit)
    return f"{metric.name} is {value}, {allowed} {limit}{_place(metric.where)}"


def _advised(code: str, text: str) -> str:
    remedy = REMEDIES.get(code)
    return f"  {text}; {remedy}" if remedy else f"  {text}"


def _place(where: Where | None) -> str:
    if not where:
        return ""
    steps = [f"{key} {value:.6g}" if isinstance(value, float) else f"{key} {value}" for key, value in where.items()]
    return f" at {', '.join(steps)}"


OPENED = ("report.html", "traveller.pdf", "report.json")
"""What a person opens next, in this order."""


def outcome_line(result: JobResult, out: str, paths: Collection[str]) -> str:
    """Return the last line: what was made, and what of it to open where.  paths: of all that was written."""
    count = sum(path.endswith(".dxf") for path in paths)
    *others, last = [counted(count, "drawing"), *(name for name in OPENED if name in paths)]
    files = f"{', '.join(others)} and {last}" if others else last
    if result.status == "made":
        sheets = len(result.nest.product.layouts) if result.nest.product else 0
        on = f" on {counted(sheets, 'sheet')}" if sheets else ""
        copies = sum(run.part.spec.quantity for run in result.parts)
        return f"made: {counted(copies, 'piece')}{on}, {files} in {out}"
    failed = [run.part.name for run in result.parts if run.pattern is None]
    if failed:
        return f"{result.status}: {', '.join(failed)}; nothing nested, {files} in {out}"
    return f"{result.status}: not all could be nested and written; {files} in {out}"
