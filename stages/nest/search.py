"""Look for a better plan than the first placement: fewer or cheaper sheets, then the last of them used less.

The task becomes a problem of shapes and bins for `separation`, which runs in a process of its own on all cores it is
given.  What comes back is a plan like any other, and is certified like any other.  Sheets of one kind that are not
limited are offered as often as the best plan so far has them; of several kinds any mixture may turn out better.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from shapely import Polygon, affinity

from stages.geometry.arrays import Vector2
from stages.geometry.curves.rigid import Rigid2, apply
from stages.nest.blank import Bed, Blank, Placed, Region, turned
from stages.nest.child import ENGINE, EngineError, Told, last_words, layouts, solve
from stages.nest.fit import Kind
from stages.nest.separation import problem as given
from stages.nest.separation.problem import NOWHERE, RECTANGLE, Item, Problem, Spot
from stages.nest.separation.wire import Request
from stages.nest.sheets import Counts, Filled, Plan, Task, used_mm
from stages.nest.turns import ANGLE_TOLERANCE_DEG, Turns, contains

MOST_THREADS = 8
"""More threads find little more, as they share one best layout; where there are fewer cores the worker takes those."""

MOST_BINS = 40
"""So many sheets are offered, or as many as the best plan has: those first, then others."""

MANY = 400
"""Above so many copies every pair of them is too much to keep: the first placement is final."""

QUARTER_DEG = 90.0
ANY_SPAN = ((0.0, 360.0),)


@dataclass(slots=True)
class Engine:
    """How the engine is called, how often it was, what it failed with, and whether the user broke it off."""

    seed: int
    command: Sequence[str] = ENGINE
    runs: int = 0
    failures: list[str] = field(default_factory=list)
    interrupted: bool = False


class Hand(NamedTuple):
    """One kind of the problem: a lot in one of its hands; `middle` of its shape in the flat frame, mirrored already."""

    lot: Kind
    blank: Blank
    shape: Polygon
    middle: Vector2


class Posed(NamedTuple):
    """A problem with what its numbers stand for: hands by kind, beds by bin, what was placed from outside by item."""

    request: Request
    hands: Sequence[Hand]
    beds: Sequence[Bed]
    kept: Sequence[Placed | None]


def search_plans(task: Task, first: Plan, time_limit_s: float, engine: Engine) -> list[Plan]:
    """Return the plans found within the time, the best first; none of them is certified.

    Ctrl-C ends the search early, with what was found so far.
    """
    posed = pose(task, first, time_limit_s, engine.seed)
    if posed is None:
        return []
    told = Told()
    engine.runs += 1
    try:
        solve(posed.request, told, engine.command)
    except KeyboardInterrupt:
        engine.interrupted = True
    except EngineError as error:
        engine.failures.append(str(error))
        return []
    try:
        found = [plan_of(spots, posed) for spots in layouts(told, posed.request)[:2]]
    except EngineError as error:
        if not engine.interrupted:
            engine.failures.append(str(error))
        return []
    engine.failures += filter(None, [last_words(told)])
    return found


def pose(task: Task, first: Plan, seconds: float, seed: int) -> Posed | None:
    """Return a task as a problem that starts from a plan; None if there is nothing to be searched."""
    beds = bins_for(task, first)
    if copies_of(task) > MANY or not beds or not sum(task.counts.values()):
        return None
    hands = [hand_of(lot, blank) for lot in task.kinds for blank in lot.hands]
    number = {id(hand.blank): k for k, hand in enumerate(hands)}
    regions: list[Region] = []
    kinds = tuple(_kind(hand, beds, regions, _angle_of(hand, first) if task.one_direction else None) for hand in hands)
    rows = list(_rows(first, beds, number)) + list(_left(first.left, task, number))
    items = tuple(Item(kind, _other(hands[kind], number), kept is not None) for kind, kept, _ in rows)
    bins = tuple((bed.width_mm, bed.height_mm) for bed in beds)
    problem = Problem(kinds, items, bins, tuple(regions))
    start = tuple(_spot(kind, placed, hands, bin_) for kind, _, (bin_, placed) in rows)
    request = Request(
        problem, start, not first.left, seconds, MOST_THREADS, seed,
        tuple(bed.cost for bed in beds), tuple(bed.area_mm2 for bed in beds), tuple(bed.plain for bed in beds),
    )  # fmt: skip
    return Posed(request, hands, beds, [kept for _, kept, _ in rows])


def copies_of(task: Task) -> int:
    """Return how many copies lie on the sheets in the end."""
    return sum(task.counts.values()) + sum(len(sheet.placed) for sheet in task.start)


def bins_for(task: Task, first: Plan) -> list[Bed]:
    """Return the sheets that are offered: those of the plan in its order, then others there are."""
    beds = [sheet.bed for sheet in first.sheets]
    used = {bed.stock: sum(one.stock == bed.stock for one in beds) for bed in task.beds}
    alone = len(task.beds) == 1 and not first.left
    for bed in task.beds:
        if alone or (bed.sheet.is_roll and used[bed.stock]) or min(bed.width_mm, bed.height_mm) <= 0.0:
            continue
        most = len(first.sheets) + 1 if bed.sheet.quantity is None else bed.sheet.quantity
        beds += [bed] * max(min(most, len(first.sheets) + 1) - used[bed.stock], 0)
    return beds[: max(MOST_BINS, len(first.sheets))]


def hand_of(lot: Kind, blank: Blank) -> Hand:
    """Return one hand of a lot with its shape about its middle.

    Where it is only ever turned by quarters its shape is cut to the exact box, so that what fits exactly does.
    """
    spans = [turns.spans for turns in (one[lot.hands.index(blank)] for one in lot.spans)]
    square = all(
        span is not None and all(low == high and low % QUARTER_DEG == 0.0 for low, high in span) for span in spans
    )
    shape = blank.shape
    if square:
        way = turned(blank, 0.0)
        shape = affinity.translate(way.shape, -way.dx, -way.dy)
    low_x, low_y, high_x, high_y = shape.bounds
    middle = np.array([(low_x + high_x) / 2.0, (low_y + high_y) / 2.0])
    return Hand(lot, blank, affinity.translate(shape, -middle[0], -middle[1]), middle)


def _kind(hand: Hand, beds: Sequence[Bed], regions: list[Region], only: float | None) -> given.Kind:
    """Return a hand as a kind of the problem; regions that are new are added to the list."""
    spans, numbers = [], []
    for bed in beds:
        turns = hand.lot.allowed(bed, hand.blank)
        spans.append(spans_of(turns) if only is None else _alone(only, turns))
        numbers.append(_region(bed.region(hand.blank.pattern.quality), regions))
    return given.Kind(hand.shape, tuple(spans), tuple(numbers))


def _alone(angle_deg: float, turns: Turns) -> tuple[tuple[float, float], ...]:
    """Return one angle as the only one; none where it is not allowed."""
    return ((angle_deg, angle_deg),) if contains(turns, angle_deg) else ()


def spans_of(turns: Turns) -> tuple[tuple[float, float], ...]:
    """Return the spans of allowed angles in degrees, any angle as one whole turn."""
    return ANY_SPAN if turns.spans is None else turns.spans


def _region(region: Region | None, regions: list[Region]) -> int:
    if region is None:
        return RECTANGLE
    if region.is_empty:
        return NOWHERE
    known = next((k for k, one in enumerate(regions) if one is region), None)
    if known is None:
        regions.append(region)
    return len(regions) - 1 if known is None else known


def _angle_of(hand: Hand, first: Plan) -> float | None:
    """Return the angle in which the plan has a hand, else the first in which it was tried."""
    placed = (one.turned for sheet in first.sheets for one in sheet.placed)
    return next((one.angle_deg for one in (*placed, *hand.lot.turns) if one.blank is hand.blank), None)


Row = tuple[int, Placed | None, tuple[int, Placed | None]]
"""The kind of an item, what it was placed by from outside, and the bin and place where it lies; bin -1: nowhere yet."""


def _rows(first: Plan, beds: Sequence[Bed], number: dict[int, int]) -> Iterable[Row]:
    for bin_, sheet in enumerate(first.sheets[: len(beds)]):
        for placed in sheet.placed:
            yield number[id(placed.turned.blank)], placed if placed.given is not None else None, (bin_, placed)


def _left(left: Counts, task: Task, number: dict[int, int]) -> Iterable[Row]:
    for lot in task.kinds:
        for _ in range(left.get(lot.blank.part, 0)):
            yield number[id(lot.blank)], None, (-1, None)


def _other(hand: Hand, number: dict[int, int]) -> int:
    """Return the kind that a copy has when turned over; its own if it is not."""
    others = [blank for blank in hand.lot.hands if blank is not hand.blank]
    return number[id(others[0])] if others else number[id(hand.blank)]


def _spot(kind: int, placed: Placed | None, hands: Sequence[Hand], bin_: int) -> Spot:
    """Return where an item lies in the plan."""
    if placed is None:
        return Spot(-1, kind, 0.0, 0.0, 0.0)
    angle = placed.turned.angle_deg
    shift = apply(Rigid2(angle_deg=angle), hands[kind].middle)
    return Spot(
        bin_, kind, angle, placed.x + placed.turned.dx + float(shift[0]), placed.y + placed.turned.dy + float(shift[1])
    )


def plan_of(spots: Sequence[Spot], posed: Posed) -> Plan:
    """Return a layout of the engine as a plan; sheets in the order of use, the emptiest last."""
    laid: list[list[Placed]] = [[] for _ in posed.beds]
    for spot, kept in zip(spots, posed.kept, strict=True):
        laid[spot.bin].append(kept or _placed(spot, posed.hands[spot.kind], posed.beds[spot.bin]))
    sheets = [Filled(bed, tuple(placed)) for bed, placed in zip(posed.beds, laid, strict=True)]
    begun = [sheet for sheet in sheets if any(one.given is not None for one in sheet.placed)]
    others = [sheet for sheet in sheets if sheet.placed and sheet not in begun]
    return Plan((*begun, *sorted(others, key=lambda sheet: -used_mm(sheet) / sheet.bed.width_mm)), {})


def _placed(spot: Spot, hand: Hand, bed: Bed) -> Placed:
    """Return a part where the engine put it, its angle made the exact one of its list."""
    angle = _exact(spot.angle_deg, hand.lot.allowed(bed, hand.blank))
    way = turned(hand.blank, angle)
    shift = apply(Rigid2(angle_deg=angle), hand.middle)
    return Placed(way, spot.x - float(shift[0]) - way.dx, spot.y - float(shift[1]) - way.dy)


def _exact(angle_deg: float, turns: Turns) -> float:
    """Return the angle of a list that is meant; of a span, the angle itself, within its ends."""
    spans = spans_of(turns)
    low, high = min(
        spans,
        key=lambda span: (
            abs((angle_deg - span[0] + 180.0) % 360.0 - 180.0) if span[0] == span[1] else _outside(angle_deg, span)
        ),
    )
    if low == high:
        return low
    past = (angle_deg - low) % 360.0
    return (low + min(past, high - low)) % 360.0 if past < 360.0 - ANGLE_TOLERANCE_DEG else low


def _outside(angle_deg: float, span: tuple[float, float]) -> float:
    """Return how far an angle is outside a span, in degrees."""
    past = (angle_deg - span[0]) % 360.0
    return 0.0 if past <= span[1] - span[0] else min(past - (span[1] - span[0]), 360.0 - past)
