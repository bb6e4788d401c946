"""Fill several sheets better than the first placement does, with a strip packing engine and within a time limit.

Sheet by sheet: take an even share of what is left, large and small parts alike, have it packed as a strip as high as
the sheet, keep what lies within its width, top up with true shapes what room is left; then ask for more or fewer
parts, until the time of this sheet is over.  The best filling is kept.  The last sheet is packed as short as possible.
While there is time the whole is done again, for one sheet less than the best so far.

The engine computes in single precision and refuses parts exactly as high as the strip.  So its polygons grow by a
margin above that rounding, parts that high are laid first and the engine gets the rest of the sheet, and every place
it gives is tested again before it is used.  The clock is read here and in `child` and nowhere else in the stages.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from time import monotonic
from typing import NamedTuple

import numpy as np
from shapely import affinity

from stages.geometry.arrays import Vector2
from stages.geometry.rigid import Rigid2, apply
from stages.nest.blank import Bed, Blank, Placed, Turned, turned
from stages.nest.child import ENGINE, EngineError, Item, Request, Spot, solve
from stages.nest.fit import Kind
from stages.nest.raster import fill_raster, free_at
from stages.nest.sheets import (
    Counts,
    Filled,
    Plan,
    Task,
    area_of,
    less,
    next_sheet,
    ordered,
    size,
    used_share,
    waiting,
    without_one,
)

MARGIN_SHARE = 2e-6
"""The engine's polygons grow by this share of the sheet: its single precision errs by 1e-7 of a coordinate or so."""

TOO_HIGH_SHARE = 2e-4
"""Parts nearer than this share to the height of the strip make the engine panic; it wants 1e-4."""

LEAST_RUN_S = 1.0
"""The engine counts whole seconds."""

RUNS_PER_SHEET = 2
"""The time of a sheet is meant for so many runs: the wanted filling is approached in steps."""

GRACE_S = 0.5
"""What a run may take beyond its seconds before it is killed; it has told its layouts by then."""

MORE, FULL = 0.03, 1.0
"""Step of the wanted filling, in shares of the sheet, after a run that placed all; and what is never wanted."""

WORSE_SHARE = 0.05
"""An even mix of parts may fill a sheet this much less than large parts first: what follows is easier for it."""

PASS_SHARE, LEAST_SHEET_S = 0.5, 5.0
"""A pass over all sheets takes this share of the time that is left, and not less than these seconds a sheet."""

LEAST_WIDTH_SHARE = 0.2
"""Of a sheet with less width than this left beside the highest parts, the engine makes nothing better."""


@dataclass(slots=True)
class Clock:
    """When the search must end."""

    end: float

    @property
    def left_s(self) -> float:
        """Seconds that are left."""
        return self.end - monotonic()


@dataclass(slots=True)
class Engine:
    """How the engine is called, how often it was, what it failed with, and whether the user broke it off."""

    seed: int
    command: Sequence[str] = ENGINE
    runs: int = 0
    failures: list[str] = field(default_factory=list)
    interrupted: bool = False


class Wish(NamedTuple):
    """What a sheet is to be filled with, as a share of its area, and by when."""

    share: float
    clock: Clock


class Run(NamedTuple):
    """One run of the engine: on which bed, for how long, and the width that is enough."""

    bed: Bed
    seconds: float
    enough_mm: float


def search_plan(task: Task, first: Plan, time_limit_s: float, engine: Engine) -> Plan:
    """Return the best plan found within the time, aiming at one sheet less each time; it is not certified.

    Ctrl-C ends the search early, with the best plan so far.
    """
    clock, best = Clock(monotonic() + time_limit_s), first
    fewest = least_sheets(task)
    while clock.left_s >= LEAST_RUN_S and not engine.failures:
        aim = max(len(best.sheets) - 1, fewest)
        one_pass = Clock(monotonic() + max(clock.left_s * PASS_SHARE, min(clock.left_s, LEAST_SHEET_S * aim)))
        try:
            best = min(best, _pass(task, aim, one_pass, engine), key=lambda plan: plan.cost)
        except KeyboardInterrupt:
            engine.interrupted = True
            break
        if len(best.sheets) == fewest and not best.left:
            break
    return best


def least_sheets(task: Task) -> int:
    """Return how many of the largest sheets the area of the parts needs at least."""
    largest = max((bed.width_mm * bed.height_mm for bed in task.beds), default=np.inf)
    return max(int(np.ceil(area_of(task.kinds, task.counts) / largest)), 1)


def _pass(task: Task, aim: int, clock: Clock, engine: Engine) -> Plan:
    """Return all copies spread over sheets, `aim` of them if that can be."""
    queue, left = ordered(task, size), less(task.counts, ())
    stock = {bed.stock: bed.sheet.quantity for bed in task.beds}
    sheets: list[Filled] = []
    while left:
        base = next_sheet(queue, [bed for bed in task.beds if stock[bed.stock] != 0], left, fill_raster)
        if base is None:
            break
        ahead = max(aim - len(sheets), 1)
        sheet_clock = Clock(monotonic() + clock.left_s / ahead)
        if less(left, base.placed):
            even = min(area_of(queue, left) / ahead / area(base.bed), FULL)
            sheets.append(_improved(base, queue, left, Wish(even, sheet_clock), engine))
        else:
            sheets.append(_shortened(base, queue, left, sheet_clock, engine))
        left = less(left, sheets[-1].placed)
        stock = without_one(stock, base.bed.stock)
    return Plan(tuple(sheets), left)


def _improved(base: Filled, queue: Sequence[Kind], left: Counts, wish: Wish, engine: Engine) -> Filled:
    """Return the sheet filled with the wished share of its area, and with more as far as the engine finds room."""
    bed, share, clock = base.bed, wish.share, wish.clock
    low, high, best = 0.0, FULL, None
    run_s = max(clock.left_s / RUNS_PER_SHEET, LEAST_RUN_S)
    tried: list[Counts] = []
    while clock.left_s >= LEAST_RUN_S and not engine.failures:
        chosen = choose(bed, queue, left, share)
        found = (
            None
            if chosen in tried
            else _packed(Run(bed, min(run_s, clock.left_s), bed.width_mm), queue, chosen, engine)
        )
        if found is None:
            break
        tried.append(chosen)
        topped = Filled(bed, tuple(fill_raster(bed, waiting(queue, bed, less(left, found)), found)))
        best = topped if best is None else max(best, topped, key=filling)
        if less(chosen, found):
            high = share
        else:
            low = max(share, filling(topped))
        between = (max(low, filling(best)) + high) / 2.0
        share = min(low + MORE, between) if low else between
    return best if best is not None and filling(best) > filling(base) - WORSE_SHARE else base


def _shortened(base: Filled, queue: Sequence[Kind], left: Counts, clock: Clock, engine: Engine) -> Filled:
    """Return the last sheet, which takes all that is left, packed as short as the engine can."""
    if clock.left_s < LEAST_RUN_S or engine.failures:
        return base
    found = _packed(Run(base.bed, clock.left_s, 0.0), queue, left, engine)
    if found is None or less(left, found):
        return base
    return min(base, Filled(base.bed, tuple(found)), key=used_share)


def area(bed: Bed) -> float:
    """Return the area of a bed in mm2."""
    return bed.width_mm * bed.height_mm


def filling(sheet: Filled) -> float:
    """Return the area of the parts as a share of the bed."""
    return sum(placed.turned.blank.area_mm2 for placed in sheet.placed) / area(sheet.bed)


def choose(bed: Bed, queue: Sequence[Kind], left: Counts, share: float) -> dict[int, int]:
    """Return of each part that fits its portion of what is left, as many as fill a share of the bed.

    Rounded so that the area never strays from the portion by more than half a part: a sheet gets large and small ones
    as they come, and the small ones that fill the gaps are not used up first.
    """
    fitting = [one for one in queue if left.get(one.blank.part, 0) and one.on(bed)]
    portion = min(share * area(bed) / max(area_of(fitting, left), 1.0), 1.0)
    chosen: dict[int, int] = {}
    due = 0.0
    for one in fitting:
        each, part = one.blank.area_mm2, one.blank.part
        due += portion * left[part] * each
        count = int(np.clip(round(due / each), 0, left[part]))
        due -= count * each
        chosen[part] = count
    return {part: count for part, count in chosen.items() if count}


def _packed(run: Run, queue: Sequence[Kind], counts: Counts, engine: Engine) -> list[Placed] | None:
    """Return what of the parts lies well within the bed after one run of the engine; None if it cannot be asked."""
    bed = run.bed
    flat = [one for one in queue if counts.get(one.blank.part) and _engine_angles(one, bed)]
    high = [one for one in queue if counts.get(one.blank.part) and not _engine_angles(one, bed)]
    start = fill_raster(bed, [(counts[one.blank.part], one.on(bed)) for one in high if one.on(bed)]) if high else []
    used = max((placed.right_mm for placed in start), default=0.0)
    if not flat or bed.width_mm - used < LEAST_WIDTH_SHARE * bed.width_mm:
        return None
    margin = MARGIN_SHARE * max(bed.width_mm, bed.height_mm)
    items = tuple(_item(one, bed, counts[one.blank.part], margin) for one in flat)
    whole = max(int(run.seconds), 1)
    engine.runs += 1
    request = Request(bed.height_mm, whole, engine.seed + engine.runs, max(run.enough_mm - used, 0.0), items)
    try:
        spots = solve(request, whole + GRACE_S, engine.command)
    except EngineError as error:
        engine.failures.append(str(error))
        return None
    by_id = {str(one.blank.part): one for one in flat}
    return settled(bed, [_placed(by_id[spot.id], spot, used) for spot in spots], start, 2.0 * margin)


def _engine_angles(one: Kind, bed: Bed) -> tuple[Turned, ...]:
    """Return the angles in which a part fits the bed and is not as high as it."""
    return tuple(way for way in one.on(bed) if way.height_mm <= bed.height_mm * (1.0 - TOO_HIGH_SHARE))


def _item(one: Kind, bed: Bed, count: int, margin_mm: float) -> Item:
    """Return a part as the engine takes it: its outline only, grown by the margin, about its middle."""
    angles = None if one.blank.angles is None else tuple(way.angle_deg for way in _engine_angles(one, bed))
    grown = one.blank.shape.buffer(margin_mm, join_style="mitre")
    x, y = middle(one.blank)
    corners = affinity.translate(grown, -x, -y).exterior.coords[:-1]
    return Item(str(one.blank.part), count, angles, tuple((float(px), float(py)) for px, py, *_ in corners))


def middle(blank: Blank) -> Vector2:
    """Return the middle of the box of the grown part in its flat frame: coordinates stay small about it."""
    low_x, low_y, high_x, high_y = blank.shape.bounds
    return np.array([(low_x + high_x) / 2.0, (low_y + high_y) / 2.0])


def _placed(one: Kind, spot: Spot, used_mm: float) -> Placed:
    """Return the part where the engine put it, its angle made the exact one of its list."""
    way = turned(one.blank, spot.angle_deg % 360.0) if one.blank.angles is None else _nearest(one, spot.angle_deg)
    shift = apply(Rigid2(angle_deg=way.angle_deg), middle(one.blank))
    return Placed(way, spot.x - float(shift[0]) - way.dx + used_mm, spot.y - float(shift[1]) - way.dy)


def _nearest(one: Kind, angle_deg: float) -> Turned:
    return min(one.turns, key=lambda way: abs((way.angle_deg - angle_deg + 180.0) % 360.0 - 180.0))


def settled(bed: Bed, wished: Sequence[Placed], start: Sequence[Placed], shift_mm: float) -> list[Placed]:
    """Return what lay there and those of the wished that lie within the bed and on nothing else, from the left.

    What leaves the bed by no more than the shift is moved in.
    """
    kept = list(start)
    for one in sorted(wished, key=lambda placed: (placed.x, placed.y)):
        x = float(np.clip(one.x, 0.0, max(bed.width_mm - one.turned.width_mm, 0.0)))
        y = float(np.clip(one.y, 0.0, max(bed.height_mm - one.turned.height_mm, 0.0)))
        if max(abs(x - one.x), abs(y - one.y)) <= shift_mm and free_at(kept, one.turned, x, y):
            kept.append(Placed(one.turned, x, y))
    return kept
