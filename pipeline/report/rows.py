"""Every number of a report as one row: whose, of which stage, its name, value, unit, limit, verdict and evidence.

Metrics of the stages come as they are.  A finding for which a part or a job cannot be made has a row of its own, named
by its code, without a value and not passed: some are no number past a limit.  The figures of flat patterns, surfaces,
sheets and costs are named by their path in the report (`edges.c0`, `marks.<name>.x`); nothing decided on them, so
that they have no verdict.  The unit follows from the last key of the path.  Rows of nest and write, of sheets and of
the cost of the job belong to no part.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from pipeline.report.entries import FindingEntry, PartEntry, ReportEntry, SheetEntry, StageEntry, Value

AXES = ("x", "y")
UNITS = {
    **dict.fromkeys(("c0", "c1", "start", "end", "x", "y", "width", "height"), "mm"),
    **dict.fromkeys(("outline_length", "length", "distance"), "mm"),
    "area": "mm2",
}
SUFFIXES = {"_mm": "mm", "_kg": "kg", "_s": "s", "_deg": "deg"}
SURFACE = ("area", "edges")
"""What of a surface has an equal in the flat: the pieces of a strip between rails are its construction."""


@dataclass(frozen=True, slots=True)
class Row:
    """One number.  passed: None where nothing was decided; evidence: empty where nothing was checked."""

    part: str
    stage: str
    metric: str
    value: Value
    unit: str = ""
    limit: Value = None
    passed: bool | None = None
    evidence: str = ""


def rows(report: ReportEntry) -> Iterator[Row]:
    """Yield the rows of a report in its order, no two of the same part, stage and metric."""
    seen: Counter[tuple[str, str, str]] = Counter()
    for row in _all(report):
        key = (row.part, row.stage, row.metric)
        seen[key] += 1
        yield row if seen[key] == 1 else _numbered(row, seen[key])


def _numbered(row: Row, count: int) -> Row:
    """Return a further row of a name that is taken: marks of the same name."""
    return replace(row, metric=f"{row.metric} ({count})")


def _all(report: ReportEntry) -> Iterator[Row]:
    for part in report.parts:
        yield from _part(part)
    yield from _stage("", "nest", report.nest)
    for sheet in report.nest.sheets:
        yield from _sheet(sheet)
    cost = report.nest.cost
    if cost is not None:
        for entry in cost.parts:
            yield from _figures(str(entry["part"]), "cost", {key: entry[key] for key in entry if key != "part"})
        yield from _figures("", "cost", cost.total)
    yield from _stage("", "write", report.write)


def _part(part: PartEntry) -> Iterator[Row]:
    for stage in part.stages:
        yield from _stage(part.name, stage.stage, stage)
    yield from _figures(part.name, "flat", part.flat or {})
    surface = part.surface or {}
    yield from _figures(part.name, "surface", {key: surface[key] for key in SURFACE if key in surface})
    figures = {
        "quantity": part.quantity,
        "mass_kg": part.mass_kg,
        "cut_length_mm": part.cut_length_mm,
        "pierces": part.pierces,
    }
    yield from _figures(part.name, "part", figures)


def _stage(part: str, name: str, stage: StageEntry) -> Iterator[Row]:
    """Yield the metrics of a stage, and the findings for which it failed."""
    for one in stage.metrics:
        yield Row(part, name, one.name, one.value, one.unit, one.limit, one.passed, one.evidence)
    for code in dict.fromkeys(finding.code for finding in fatal(stage.findings)):
        yield Row(part, name, code, None, passed=False)
    if stage.status == "fail" and all(one.passed for one in stage.metrics) and not fatal(stage.findings):
        yield Row(part, name, "status", None, passed=False)


def fatal(findings: Iterable[FindingEntry]) -> list[FindingEntry]:
    """Return the findings for which a part or a job cannot be made."""
    return [finding for finding in findings if finding.fatal]


def _sheet(sheet: SheetEntry) -> Iterator[Row]:
    figures = {
        "utilisation": sheet.utilisation,
        "mass_kg": sheet.mass_kg,
        "cut_length_mm": sheet.cut_length_mm,
        "pierces": sheet.pierces,
        "used_length_mm": sheet.used_length_mm,
        "offcut": sheet.offcut,
        "cost": sheet.cost,
    }
    yield from _figures("", "sheet", {f"{sheet.stock}-{sheet.index}": figures})


def _figures(part: str, stage: str, figures: Mapping[str, object]) -> Iterator[Row]:
    """Yield every number of some figures, and what is not known of them."""
    for path, value in leaves("", figures):
        if not isinstance(value, str):
            yield Row(part, stage, path, value, unit_of(path))


def leaves(path: str, value: object) -> Iterator[tuple[str, Value | str]]:
    """Yield numbers, truths, nulls and texts below a path; a name is part of the path and none of them."""
    if value is None or isinstance(value, bool | int | float | str):
        yield path, value
    elif isinstance(value, Mapping):
        for key, item in value.items():
            yield from leaves(f"{path}.{key}" if path else str(key), item)
    elif isinstance(value, list | tuple):
        for number, item in enumerate(value):
            yield from leaves(f"{path}.{_name(item, number, len(value))}", item)


def _name(item: object, number: int, count: int) -> str:
    """Return what an item of a list is called: by its name, as a coordinate, or by its number from 0."""
    if isinstance(item, Mapping) and "name" in item:
        return str(item["name"])
    return AXES[number] if count == len(AXES) and isinstance(item, int | float) else str(number)


def unit_of(path: str) -> str:
    """Return the unit of a figure by its path: figures are in mm, mm2, kg, s and degrees."""
    key = path.rpartition(".")[2]
    found = (unit for suffix, unit in SUFFIXES.items() if key.endswith(suffix))
    return UNITS.get(key) or next(found, "")
