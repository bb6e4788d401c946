"""The patterns of a job made ready to be sewn, once all of them are laid flat.

A part alone cannot know its stitches: two seams that are sewn together have as many.  So seams are grouped and divided
first (`seamgroups`); then each pattern is widened, notched and pricked (`stages.unroll.sewing`).  What is found out
stands in the part's report of `unroll`: metrics, findings, `flat.cut`, and the tables `seams` and `stitches`.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeVar

from pipeline.run import PartRun, Runner, Step, fell_short
from pipeline.seamgroups import (
    Group,
    Half,
    Lengths,
    difference,
    divided,
    groups,
    pitch_mm,
    seam_notches,
    too_different,
    unmated,
)
from stages.errors import NoSolutionError
from stages.model.report import Finding, Metric, StageReport
from stages.model.tolerances import Tolerances

if TYPE_CHECKING:
    from stages.geometry.arrays import Vector2
    from stages.unroll.seams import Seams
    from stages.unroll.sewing import SeamNotch, Sewn
    from stages.unroll.stitches import Stitches

T = TypeVar("T")
Row = dict[str, object]
AGAIN = frozenset({"narrow-web", "small-hole", "narrower-than-kerf", "tip-up"})
"""Findings on holes, webs and the outline, which are judged again for the contour that is cut."""


def sewn_runs(runner: Runner, runs: Sequence[PartRun], tol: Tolerances) -> tuple[PartRun, ...]:
    """Return the runs of a job, the patterns of parts with seams made ready to be sewn; the others as they are."""
    if not any(run.part.spec.seam for run in runs):
        return tuple(runs)
    prepared = [_prepared(runner, run) for run in runs]
    known = {run.part.name: found for run, found in prepared if found is not None}
    plan = planned(runs, known, tol)
    return tuple(run if found is None else _made(runner, run, found, plan, tol) for run, found in prepared)


def _prepared(runner: Runner, run: PartRun) -> "tuple[PartRun, Seams | None]":
    """Return a run with the seams on its pattern, or the run with what stands against them."""
    from stages.unroll.seams import seams

    pattern = run.pattern
    if pattern is None or not run.part.spec.seam:
        return run, None
    try:
        found = runner.timed("unroll", run.part.name, seams, pattern, run.part.spec.seam)
    except NoSolutionError as error:
        return _ended(runner, run, fell_short("unroll", run.part.name, error), short=True), None
    if isinstance(found, Finding):
        return _ended(runner, run, StageReport("unroll", run.part.name, findings=(found,))), None
    return run, found


@dataclass(frozen=True, slots=True)
class Plan:
    """What the parts of a job get along their seams, and what is said of it, each with the name of its part.

    lengths: of all sew lines.
    """

    halves: tuple[Half, ...]
    lengths: Lengths
    notches: "tuple[tuple[str, SeamNotch], ...]"
    stitches: "tuple[tuple[str, Stitches], ...]"
    metrics: tuple[tuple[str, Metric], ...]
    findings: tuple[tuple[str, Finding], ...]


def planned(runs: Sequence[PartRun], known: "Mapping[str, Seams]", tol: Tolerances) -> Plan:
    """Return what is to be cut along the seams of all parts that have a pattern."""
    lengths = {f"{part}.{name}": line.length_mm for part, one in known.items() for name, line in one.lines.items()}
    every = groups([run.part.spec for run in runs])
    halves = tuple(half for group in every for half in group.halves if half.name in lengths)
    whole = [group for group in every if all(half.name in lengths for half in group.halves)]
    compared = [(half.part.name, difference(half, lengths, tol)) for half in halves if half.seam.mate in lengths]
    rows = [divided(group, lengths) for group in whole]
    notches = [found for group in whole for found in seam_notches(group, lengths)]
    return Plan(
        halves,
        lengths,
        tuple((part, notch) for part, notch in notches if not isinstance(notch, Finding)),
        tuple(row for division in rows for row in division.rows),
        tuple((part, _worst(_of(compared, part))) for part in dict(compared)),
        (
            *_incomplete(every, lengths),
            *((part, found) for part, metric in compared for found in too_different(metric, lengths)),
            *(found for division in rows for found in division.findings),
            *((part, notch) for part, notch in notches if isinstance(notch, Finding)),
        ),
    )


def _incomplete(every: Sequence[Group], lengths: Lengths) -> Iterator[tuple[str, Finding]]:
    """Yield what is said to the seams that have a pattern where one that they are sewn together with has none."""
    for group in every:
        there = [half for half in group.halves if half.name in lengths]
        lost = [half.name for half in group.halves if half.name not in lengths]
        yield from unmated(there, [half.name for half in group.halves])
        for half in there if lost else ():
            message = f"{half.name} is sewn together with {', '.join(lost)}, which has no pattern"
            yield half.part.name, Finding("mate-missing", message, fatal=True)


def _of(items: Iterable[tuple[str, T]], part: str) -> list[T]:
    """Return what belongs to a part."""
    return [item for name, item in items if name == part]


def _worst(metrics: Sequence[Metric]) -> Metric:
    """Return the metric that comes nearest to its limit, or is farthest beyond."""
    return max(metrics, key=lambda metric: float(metric.value or 0.0) / (float(metric.limit or 0.0) or 1.0))


def _made(runner: Runner, run: PartRun, known: "Seams", plan: Plan, tol: Tolerances) -> PartRun:
    """Return a run with the pattern that is cut."""
    from stages.unroll.sewing import Sewn, Work, sewn

    name, pattern = run.part.name, run.pattern
    if pattern is None:
        raise ValueError(f"the part {name!r} has seams and no pattern")
    told = StageReport("unroll", name, tuple(_of(plan.metrics, name)), tuple(_of(plan.findings, name)))
    if not told.passed:
        return _ended(runner, run, told)
    work = Work(tuple(_of(plan.notches, name)), tuple(_of(plan.stitches, name)))
    try:
        made: Sewn = runner.timed("unroll", name, sewn, pattern, run.part, known, work, tol)
    except NoSolutionError as error:
        return _ended(runner, run, fell_short("unroll", name, error), short=True)
    tables: Row = {"seams": _seam_rows(run, plan)}
    told = replace(
        told, metrics=(*told.metrics, *made.metrics), findings=(*told.findings, *made.findings), detail=tables
    )
    if made.pattern is None or not told.passed:
        return _ended(runner, run, told)
    tables |= {"stitches": _stitch_rows(run, plan, made), "flat": _flat(run, made)}
    return _ended(runner, run, told, made)


def _ended(
    runner: Runner, run: PartRun, told: StageReport, made: "Sewn | None" = None, *, short: bool = False
) -> PartRun:
    """Return a run whose last step says this as well; without `made` it has failed."""
    *before, last = run.steps
    names = {metric.name for metric in told.metrics}
    report = replace(
        last.report,
        metrics=(*(metric for metric in last.report.metrics if metric.name not in names), *told.metrics),
        findings=(*(one for one in last.report.findings if made is None or one.code not in AGAIN), *told.findings),
        detail=last.report.detail | told.detail,
    )
    pattern = None if made is None else made.pattern
    step: Step[object] = Step("fail" if pattern is None else "pass", report, pattern, short=short)
    runner.listener(step)
    return replace(run, steps=(*before, step), pattern=pattern)


def _flat(run: PartRun, made: "Sewn") -> Row:
    """Return the figures of a pattern with those of what is cut, its notches and stitch holes in their places."""
    flat = run.steps[-1].report.detail["flat"]
    if not isinstance(flat, dict) or made.pattern is None or run.pattern is None:
        raise ValueError(f"the pattern of {run.part.name!r} has no figures")
    before = {place.name for place in run.pattern.notches}
    notches = [_place_row(place.name, place.at) for place in made.pattern.notches]
    holes = [_place_row(name, at) | {"area": area} for name, at, area in made.holes]
    return flat | {
        "marks": [*(row for row in flat["marks"] if row["name"] not in before), *notches],
        "holes": [*flat["holes"], *holes],
        "cut": made.cut,
    }


def _place_row(name: str, at: "Vector2") -> Row:
    return {"name": name, "x": float(at[0]), "y": float(at[1]), "distance": 0.0}


def _seam_rows(run: PartRun, plan: Plan) -> list[Row]:
    """Return what the report says of each seam of a part."""
    return [_seam_row(half, plan.lengths) for half in plan.halves if half.part.name == run.part.name]


def _seam_row(half: Half, lengths: Lengths) -> Row:
    length, mate = lengths[half.name], half.seam.mate
    other = None if mate is None else lengths[mate]
    return {
        "name": half.seam.called,
        "edge": half.seam.edge,
        "kind": half.seam.kind,
        "allowance": half.seam.allowance_mm,
        "length": length,
        "mate": mate,
        "mate_length": other,
        "difference": None if other is None else length - other,
    }


def _stitch_rows(run: PartRun, plan: Plan, made: "Sewn") -> list[Row]:
    """Return what the report says of each row of stitches: as many as were made, and how far apart on both sides."""
    rows: list[Row] = []
    for row in _of(plan.stitches, run.part.name):
        length = plan.lengths[f"{run.part.name}.{row.seam}"]
        pitch = pitch_mm(row.fractions, length)
        rows.append({"name": row.name, "seam": row.seam, "count": made.counts[row.seam], "pitch": pitch})
    return rows
