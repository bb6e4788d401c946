"""Figures of one blank from those of its faces: the worst of each, the sum, or all together.

A gathered figure is proved where that of every face is; it has the place of the face that it is from.  A face on which
a figure is not defined is passed over, but for what that would hide: a figure with a place and no value is beyond all
numbers there, and so is the largest of all faces; a sum that lacks one of its terms is none.
"""

from collections.abc import Mapping, Sequence
from typing import Literal

from stages.model.report import Evidence, Finding, Metric

Rule = Literal["largest", "most", "least", "sum", "all", "alike"]
"""Which value stands for all: largest (by size), most and least (with sign), sum, whether all are true, or the one that
all have."""


def gathered(
    reports: Sequence[Sequence[Metric]], numbers: Sequence[int], rules: Mapping[str, Rule]
) -> tuple[Metric, ...]:
    """Return the metrics of faces as those of the whole, the largest of each where no rule is given."""
    rows: dict[str, list[Metric]] = {}
    for metrics, number in zip(reports, numbers, strict=True):
        for metric in metrics:
            where = None if metric.where is None else {**metric.where, "face": number}
            one = Metric(metric.name, metric.value, metric.unit, metric.evidence, metric.limit, where)
            rows.setdefault(metric.name, []).append(one)
    return tuple(_gathered(found, rules.get(name, "largest")) for name, found in rows.items())


def _gathered(found: Sequence[Metric], rule: Rule) -> Metric:
    """Return one figure of several faces."""
    evidence: Evidence = "proved" if all(one.evidence == "proved" for one in found) else "sampled"
    known = [one for one in found if one.value is not None]
    if not known:
        return _with(found[0], None, evidence)
    values = [float(one.value or 0.0) for one in known]
    unbounded = next((one for one in found if one.value is None and one.where is not None), None)
    match rule:
        case "largest" | "most" if unbounded is not None:
            return _with(unbounded, None, evidence)
        case "sum" if len(known) < len(found):
            return _with(found[0], None, evidence, placed=False)
        case "all":
            return _with(min(known, key=lambda one: bool(one.value)), all(one.value for one in known), evidence)
        case "sum":
            return _with(known[0], sum(values), evidence, placed=False)
        case "alike":
            return _with(known[0], values[0] if len(set(values)) == 1 else None, evidence)
        case "least":
            best = values.index(min(values))
        case "most":
            best = values.index(max(values))
        case "largest":
            best = max(range(len(values)), key=lambda i: abs(values[i]))
    return _with(known[best], known[best].value, evidence)


def _with(one: Metric, value: float | bool | None, evidence: Evidence, *, placed: bool = True) -> Metric:
    return Metric(one.name, value, one.unit, evidence, one.limit, one.where if placed else None)


def told(found: Sequence[Sequence[Finding]], numbers: Sequence[int]) -> tuple[Finding, ...]:
    """Return what is found of faces, each with the numbers of the faces; what is said of several is said once."""
    said: dict[tuple[str, str, bool], list[tuple[int, Finding]]] = {}
    for findings, number in zip(found, numbers, strict=True):
        for one in findings:
            said.setdefault((one.code, one.message, one.fatal), []).append((number, one))
    return tuple(_named(rows) for rows in said.values())


def _named(rows: Sequence[tuple[int, Finding]]) -> Finding:
    """Return one finding of one or several faces."""
    faces, (number, one) = [number for number, _ in rows], rows[0]
    called = f"face {number}" if len(rows) == 1 else f"faces {', '.join(map(str, sorted(faces)))}"
    return Finding(one.code, f"{called}: {one.message}", one.fatal, {**(one.where or {}), "face": number})
