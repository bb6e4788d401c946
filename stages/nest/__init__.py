"""Nest: every copy of every part on sheets, certified.

A first placement without clock or random numbers; where it fits one sheet it is final, so the same job gives the same
bytes.  Otherwise an engine searches for a better one within the time limit.  Whatever is returned has passed the
certifier, which looks at the exact contours; what has not is discarded.

Limits: rectangular sheets, no defects, no mirroring; parts may lie in holes of other parts.
"""

from collections import Counter
from collections.abc import Sequence

from stages.geometry.arcpath import area
from stages.model.pattern import FlatPattern
from stages.model.report import Finding, Metric, Outcome, StageReport
from stages.model.sheet import Nesting, NestOptions, Placement, Sheet, SheetLayout
from stages.model.tolerances import Tolerances
from stages.nest.blank import Bed, Placed, as_blank, bed
from stages.nest.fit import Kind, kind
from stages.nest.legal import certify, passed, utilisation
from stages.nest.search import Engine, search_plan
from stages.nest.sheets import Filled, Plan, Task, first_plans


def nest(
    patterns: Sequence[FlatPattern], stock: Sequence[Sheet], options: NestOptions, tol: Tolerances
) -> Outcome[Nesting | None]:
    """Return every copy placed on sheets of the stock, or None with the finding that says why not."""
    return nest_with(patterns, stock, options, tol, Engine(options.seed))


def nest_with(
    patterns: Sequence[FlatPattern], stock: Sequence[Sheet], options: NestOptions, _: Tolerances, engine: Engine
) -> Outcome[Nesting | None]:
    """Return the same with an engine of one's own."""
    beds = [bed(number, sheet, options) for number, sheet in enumerate(stock)]
    kinds = [kind(as_blank(number, pattern, options), beds) for number, pattern in enumerate(patterns)]
    task = Task(kinds, beds, {number: pattern.quantity for number, pattern in enumerate(patterns)})
    refused = [_too_large(one, beds) for one in kinds if one.blank.pattern.quantity and not any(map(one.on, beds))]
    if refused:
        return _outcome(None, (), refused)
    plans = first_plans(task)
    findings: list[Finding] = []
    if needs_search(plans[0]) and options.time_limit_s > 0.0:
        found, findings = _searched(task, plans[0], options.time_limit_s, engine)
        plans = sorted([found, *plans], key=lambda plan: plan.cost)
    if plans[0].left:
        return _outcome(None, (), [*findings, _exhausted(plans[0], kinds, beds)])
    return _first_certified(plans, patterns, stock, options, findings)


def needs_search(plan: Plan) -> bool:
    """Return whether a plan is not final: more than one sheet, or copies left."""
    return len(plan.sheets) > 1 or bool(plan.left)


def _searched(task: Task, first: Plan, time_limit_s: float, engine: Engine) -> tuple[Plan, list[Finding]]:
    """Return what the search found, and what the engine failed with or that it was interrupted."""
    plan = search_plan(task, first, time_limit_s, engine)
    findings = [Finding("engine-failed", f"the nesting engine failed: {why}") for why in engine.failures]
    if engine.interrupted:
        findings.append(Finding("interrupted", "the search was interrupted: the best layout so far is used"))
    return plan, findings


def _first_certified(
    plans: Sequence[Plan],
    patterns: Sequence[FlatPattern],
    stock: Sequence[Sheet],
    options: NestOptions,
    findings: Sequence[Finding],
) -> Outcome[Nesting | None]:
    """Return the best plan that passes the certifier."""
    kept = list(findings)
    for plan in plans:
        if plan.left:
            continue
        nesting = as_nesting(plan, patterns)
        metrics, faults = certify(nesting, patterns, stock, options)
        if passed(metrics, faults):
            return _outcome(nesting, metrics, kept)
        kept += [Finding("layout-discarded", fault.message, where=fault.where) for fault in faults]
    kept.append(Finding("no-layout", "no layout passed the certifier", fatal=True))
    return _outcome(None, (), kept)


def as_nesting(plan: Plan, patterns: Sequence[FlatPattern]) -> Nesting:
    """Return a plan as it is cut: sheets counted within their stock, copies within their part."""
    sheets: Counter[str] = Counter()
    copies: Counter[str] = Counter()
    layouts = []
    for filled in plan.sheets:
        sheets[filled.bed.sheet.id] += 1
        placements = []
        for placed in sorted(filled.placed, key=_inner_first):
            copies[placed.turned.blank.pattern.part] += 1
            part = placed.turned.blank.pattern.part
            placements.append(Placement(part, copies[part], placed.motion(filled.bed)))
        layouts.append(_layout(filled, sheets[filled.bed.sheet.id], tuple(placements), patterns))
    return Nesting(tuple(layouts))


def _inner_first(placed: Placed) -> tuple[float, int, float, float]:
    """Sort small outlines before large ones: what lies in a hole is cut before the hole is."""
    pattern = placed.turned.blank.pattern
    return abs(area(pattern.outer.path)), placed.turned.blank.part, placed.x, placed.y


def _layout(
    filled: Filled, index: int, placements: tuple[Placement, ...], patterns: Sequence[FlatPattern]
) -> SheetLayout:
    bare = SheetLayout(filled.bed.sheet, index, placements, 0.0)
    share = utilisation(Nesting((bare,)), {pattern.part: pattern for pattern in patterns})
    return SheetLayout(filled.bed.sheet, index, placements, share or 0.0)


def _outcome(
    nesting: Nesting | None, metrics: Sequence[Metric], findings: Sequence[Finding]
) -> Outcome[Nesting | None]:
    return Outcome(nesting, StageReport("nest", "nest", tuple(metrics), tuple(findings)))


def _too_large(one: Kind, beds: Sequence[Bed]) -> Finding:
    """Return that a part fits no sheet in any angle it may take."""
    part = one.blank.pattern.part
    turns = "turned as you like" if one.blank.angles is None else f"turned by {_listed(one.blank.angles)} deg"
    message = f"part '{part}', {_size(one)} mm, fits no sheet, {turns}; the largest has room for {_room(beds)} mm"
    return Finding("part-too-large", message, fatal=True, where={"part": part})


def _exhausted(plan: Plan, kinds: Sequence[Kind], beds: Sequence[Bed]) -> Finding:
    """Return which copies found no place on all sheets there are."""
    left = [(one, plan.left[one.blank.part]) for one in kinds if plan.left.get(one.blank.part)]
    names = ", ".join(f"{count} of '{one.blank.pattern.part}' ({_size(one)} mm)" for one, count in left)
    message = f"the stock is used up, not placed: {names}; the largest sheet has room for {_room(beds)} mm"
    return Finding("stock-exhausted", message, fatal=True, where={"part": left[0][0].blank.pattern.part})


def _listed(angles: Sequence[float]) -> str:
    return ", ".join(f"{angle:g}" for angle in angles)


def _size(one: Kind) -> str:
    grow = 2.0 * one.blank.grow_mm
    return f"{one.turns[0].width_mm - grow:.6g} x {one.turns[0].height_mm - grow:.6g}"


def _room(beds: Sequence[Bed]) -> str:
    """Return the size of the largest sheet between its edge gaps."""
    sheets = [one.sheet for one in beds]
    sizes = [(one.width_mm - 2.0 * one.edge_gap_mm, one.height_mm - 2.0 * one.edge_gap_mm) for one in sheets]
    width, height = max(sizes, key=lambda size: size[0] * size[1], default=(0.0, 0.0))
    return f"{width:.6g} x {height:.6g}"
