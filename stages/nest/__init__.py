"""Nest: every copy of every part on sheets, remnants, rolls and hides, certified.

A first placement without clock or random numbers; where it fits one sheet it is final, so the same job gives the same
bytes.  Otherwise an engine searches for a better one within the time limit.  Whatever is returned has passed the
certifier, which looks at the exact contours; what has not is discarded.
"""

from collections.abc import Iterator, Sequence
from math import isfinite
from typing import NamedTuple

from stages.model.pattern import FlatPattern
from stages.model.report import Finding, Metric, Outcome, StageReport
from stages.model.sheet import Nesting, NestOptions, Sheet
from stages.model.tolerances import Tolerances
from stages.nest.blank import Bed
from stages.nest.finish import finished
from stages.nest.fit import Kind
from stages.nest.gate import oriented, troubles
from stages.nest.layout import as_nesting
from stages.nest.legal.certify import certify, passed
from stages.nest.lots import EMPTY, task_of
from stages.nest.raster import fill_raster
from stages.nest.search import MANY, Engine, copies_of, search_plans
from stages.nest.sheets import Plan, Task, first_plans

__all__ = ["as_nesting", "needs_search", "nest", "nest_with"]


def nest(
    patterns: Sequence[FlatPattern],
    stock: Sequence[Sheet],
    options: NestOptions,
    tol: Tolerances,
    fixed: Nesting | None = None,
) -> Outcome[Nesting | None]:
    """Return every copy placed on sheets of the stock, or None with the finding that says why not.

    fixed: placements that stay as they are, on the first sheets; what they leave is placed around them.
    """
    return nest_with(patterns, stock, options, tol, Engine(options.seed), fixed)


def nest_with(
    patterns: Sequence[FlatPattern],
    stock: Sequence[Sheet],
    options: NestOptions,
    _: Tolerances,
    engine: Engine,
    fixed: Nesting | None = None,
) -> Outcome[Nesting | None]:
    """Return the same with an engine of one's own."""
    found = troubles(patterns, stock, options)
    if any(finding.fatal for finding in found):
        return _outcome(None, (), found)
    task = task_of([oriented(pattern) for pattern in patterns], stock, options, fixed or EMPTY)
    wanted = [one for one in task.kinds if task.counts[one.blank.part]]
    refused = [_too_large(one, task.beds, "fits no sheet") for one in wanted if not any(map(one.on, task.beds))]
    if refused:
        return _outcome(None, (), [*found, *refused])
    # where every copy is given there is nothing to choose, and nothing to search
    plans = first_plans(task) if wanted else first_plans(task)[:1]
    if wanted and needs_search(plans[0]) and options.time_limit_s > 0.0:
        better, told = _searched(task, plans[0], options.time_limit_s, engine)
        plans, found = sorted([*better, *plans], key=lambda plan: plan.cost), [*found, *told]
    if plans[0].left:
        return _outcome(None, (), [*found, *_left_over(plans[0], task)])
    return _first_certified(plans, Rules(patterns, stock, options, fixed), found)


def needs_search(plan: Plan) -> bool:
    """Return whether a plan is not final: more than one sheet, a roll, or copies left."""
    return len(plan.sheets) > 1 or bool(plan.left) or any(sheet.bed.sheet.is_roll for sheet in plan.sheets)


def _searched(task: Task, first: Plan, time_limit_s: float, engine: Engine) -> tuple[list[Plan], list[Finding]]:
    """Return what the search found, and what the engine failed with, that it was interrupted, or not made at all."""
    plans = search_plans(task, first, time_limit_s, engine)
    failed = (Finding("engine-failed", f"the nesting engine failed: {why}") for why in engine.failures)
    findings = [*_not_searched(copies_of(task)), *failed]
    if engine.interrupted:
        findings.append(Finding("interrupted", "the search was interrupted: the best layout so far is used"))
    return plans, findings


def _not_searched(copies: int) -> Iterator[Finding]:
    """Yield that there are too many copies for a search."""
    if copies > MANY:
        message = f"{copies} copies are more than the search takes on, {MANY}: the first placement is used"
        yield Finding("not-searched", message)


class Rules(NamedTuple):
    """What a nest is held against."""

    patterns: Sequence[FlatPattern]
    stock: Sequence[Sheet]
    options: NestOptions
    fixed: Nesting | None


def _first_certified(plans: Sequence[Plan], rules: Rules, findings: Sequence[Finding]) -> Outcome[Nesting | None]:
    """Return the best plan that passes the certifier, its parts in the order of cutting."""
    kept = list(findings)
    for plan in plans:
        if plan.left:
            continue
        nesting = as_nesting(plan, rules.patterns, rules.options)
        for made in finished(nesting, rules.patterns, rules.options, rules.fixed):
            metrics, faults = certify(made.nesting, *rules)
            if passed(metrics, faults):
                return _outcome(made.nesting, (*metrics, *made.metrics), kept)
            kept += [Finding("layout-discarded", fault.message, where=fault.where) for fault in faults]
    remedy = ": in the one that is given move the copies that are named, or leave them out of it" if rules.fixed else ""
    kept.append(Finding("no-layout", f"no layout passed the certifier{remedy}", fatal=True))
    return _outcome(None, (), kept)


def _outcome(
    nesting: Nesting | None, metrics: Sequence[Metric], findings: Sequence[Finding]
) -> Outcome[Nesting | None]:
    return Outcome(nesting, StageReport("nest", "nest", tuple(metrics), tuple(findings)))


def _left_over(plan: Plan, task: Task) -> list[Finding]:
    """Return which parts find no place even on an empty sheet, or else that the stock is used up."""
    left = [one for one in task.kinds if plan.left.get(one.blank.part)]
    hopeless = [one for one in left if not any(fill_raster(bed, [(1, one.on(bed))]) for bed in task.beds)]
    found = "found no place even on an empty sheet"
    return [_too_large(one, task.beds, found) for one in hopeless] or [_exhausted(plan, left, task.beds)]


def _too_large(one: Kind, beds: Sequence[Bed], why: str) -> Finding:
    """Return that a part fits no sheet in any angle it may take, or was not seen to."""
    part = one.blank.pattern.part
    message = f"part '{part}', {_size(one)} mm, {why}, {_turns(one)}; the largest has room for {_room(beds)} mm"
    return Finding("part-too-large", message, fatal=True, where={"part": part})


def _exhausted(plan: Plan, left: Sequence[Kind], beds: Sequence[Bed]) -> Finding:
    """Return which copies found no place on all sheets there are."""
    counted = [(one, plan.left[one.blank.part]) for one in left]
    names = ", ".join(f"{count} of '{one.blank.pattern.part}' ({_size(one)} mm)" for one, count in counted)
    message = f"the stock is used up, not placed: {names}; the largest sheet has room for {_room(beds)} mm"
    return Finding("stock-exhausted", message, fatal=True, where={"part": left[0].blank.pattern.part})


def _turns(one: Kind) -> str:
    """Return how a part may be turned, in words."""
    spans = list(dict.fromkeys(span for turns in one.spans for each in turns for span in each.spans or ()))
    if not one.spans or any(each.spans is None for turns in one.spans for each in turns):
        return "turned as you like"
    if not spans:
        return "as none of its angles lies along the grain"
    listed = (f"{low:g}" if low == high else f"{low:g} to {high:g}" for low, high in spans)
    return f"turned by {', '.join(listed)} deg"


def _size(one: Kind) -> str:
    grow = 2.0 * one.blank.grow_mm
    return f"{one.turns[0].width_mm - grow:.6g} x {one.turns[0].height_mm - grow:.6g}"


def _room(beds: Sequence[Bed]) -> str:
    """Return the size of the largest sheet between its edge gaps; an outline by its box, a roll of any length."""
    sheets = [one.sheet for one in beds]
    sizes = [[max(size - 2.0 * one.edge_gap_mm, 0.0) for size in (one.width_mm, one.height_mm)] for one in sheets]
    width, height = max(sizes, key=lambda size: size[0] * size[1], default=[0.0, 0.0])
    return f"{f'{width:.6g}' if isfinite(width) else 'any length'} x {height:.6g}"
