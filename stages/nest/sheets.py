"""Spread parts over sheets: fill one sheet after the other, and tell which of two results is better.

The order of the parts: first those that find little room (few stocks, small shares of them without bad zones), then
large ones.  Remnants are used before new sheets.  The next sheet is the smallest, or the cheapest, that takes all that
is left, else the largest, or the one with the least price of its area, that takes anything.  Several fills, orders and
rules are tried and the best result wins, in this order:

the fewest copies left; the least cost, where remnants are free and every new sheet counts its price if all have one and
1 otherwise; the fewest sheets; the least area of sheets, of a roll only what is used; the largest straight rest of the
emptiest sheet.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import product
from typing import NamedTuple

from stages.nest.blank import Bed, Placed, Turned
from stages.nest.boxes import fill_boxes
from stages.nest.choice import Choice, by_area, by_price
from stages.nest.fit import Kind
from stages.nest.raster import fill_raster

Queue = Sequence[tuple[int, tuple[Turned, ...]]]
Fill = Callable[[Bed, Queue], list[Placed]]
Order = Callable[[Kind], float]
Counts = Mapping[int, int]
"""Copies still to be placed, by lot."""

FEW_COPIES = 60
"""Up to so many copies a second order is tried on true shapes: about 1 s more."""

FEW_WAYS = 300
"""And up to so many angles of all parts together: on a dozen hides 300 angles are tried in 3 s."""

DENSEST = 0.9
"""No outline is ever filled by more than this share: whether it takes all that is left is asked up to there only."""

COST_DIGITS = 6
"""Sums of prices are the same if they agree in so many decimals: the order of summing does not matter."""


class Filled(NamedTuple):
    """One sheet and what lies on it."""

    bed: Bed
    placed: tuple[Placed, ...]


class Task(NamedTuple):
    """What is to be placed, on what, how many of each.

    start: sheets on which something lies already that stays; it does not count in `counts`.
    one_direction: all copies of a lot in one hand are to lie in the same angle.
    """

    kinds: Sequence[Kind]
    beds: Sequence[Bed]
    counts: Counts
    start: tuple[Filled, ...] = ()
    one_direction: bool = False


class Plan(NamedTuple):
    """Sheets in the order they were filled, and copies that found no sheet, by lot."""

    sheets: tuple[Filled, ...]
    left: dict[int, int]

    @property
    def cost(self) -> tuple[int, float, int, float, float]:
        """What is to be as small as possible: copies left, cost, sheets, their area in mm2, use of the emptiest one."""
        spent = round(sum(map(cost, self.sheets), start=0.0), COST_DIGITS)
        area = sum(map(area_mm2, self.sheets), start=0.0)
        return sum(self.left.values()), spent, len(self.sheets), area, min(map(used_share, self.sheets), default=0.0)


def cost(sheet: Filled) -> float:
    """Return what a sheet counts, a roll by the length used."""
    return sheet.bed.cost + sheet.bed.cost_mm * used_mm(sheet)


def area_mm2(sheet: Filled) -> float:
    """Return the area of a sheet, of a roll as far as it is used; the usable one within an outline."""
    stock = sheet.bed.sheet
    if stock.is_roll:
        return used_mm(sheet) * stock.height_mm
    return sheet.bed.area_mm2 if stock.outline else stock.width_mm * stock.height_mm


def used_mm(sheet: Filled) -> float:
    """Return how far from its left end a sheet is used."""
    return max((placed.right_mm for placed in sheet.placed), default=0.0)


def used_share(sheet: Filled) -> float:
    """Return which share of a sheet is used: what is right of all parts, or above them, is one straight offcut."""
    top = max((placed.top_mm for placed in sheet.placed), default=0.0)
    wide = used_mm(sheet) / sheet.bed.width_mm if sheet.bed.width_mm else 1.0
    return min(wide, top / sheet.bed.height_mm) if sheet.bed.sheet.is_rectangle else wide


def first_plans(task: Task) -> list[Plan]:
    """Return the plans that need neither clock nor random numbers, the best first."""
    trials: list[tuple[Fill, Order]] = [(fill_raster, size)]
    if sum(task.counts.values()) <= FEW_COPIES and sum(len(one.turns) for one in task.kinds) <= FEW_WAYS:
        trials.append((fill_raster, side))
    if any(bed.plain for bed in task.beds):
        trials.append((fill_plain, side))
    if all(bed.plain for bed in task.beds):
        trials += [(fill_boxes, size), (fill_boxes, height)]
    choices: list[Choice] = [by_area]
    if len({(bed.cost, bed.cost_mm) for bed in task.beds}) > 1:
        choices.append(by_price)
    every = product(directed(task), trials, choices)
    plans = [spread(one, fill, order, choice) for one, (fill, order), choice in every]
    return sorted(plans, key=lambda plan: plan.cost)


WAYS = 4
"""So many angles are tried where few copies are to lie in one each: the quarter turns of a free part."""


def fill_plain(bed: Bed, queue: Queue) -> list[Placed]:
    """Return a plain sheet filled with boxes, any other with true shapes."""
    return fill_boxes(bed, queue) if bed.plain else fill_raster(bed, queue)


def directed(task: Task) -> list[Task]:
    """Return the task itself, or if each part is to lie in one direction, with some choices of these."""
    if not task.one_direction:
        return [task]
    few = sum(task.counts.values()) <= FEW_COPIES
    ways = min(max((len(one.turns) for one in task.kinds), default=1), WAYS if few else 1)
    return [task._replace(kinds=[one.in_one_way(number) for one in task.kinds]) for number in range(ways)]


def size(kind: Kind) -> float:
    """Return the area of a grown part in mm2."""
    return float(kind.blank.shape.area)


def side(kind: Kind) -> float:
    """Return the longest side of the first box of a part in mm."""
    return max(kind.turns[0].width_mm, kind.turns[0].height_mm)


def height(kind: Kind) -> float:
    """Return the least height of a part in its angles in mm."""
    return min(one.height_mm for one in kind.turns)


def spread(task: Task, fill: Fill, order: Order, choice: Choice = by_area) -> Plan:
    """Return all copies spread over sheets by one fill in one order."""
    queue = ordered(task, order)
    left = less(task.counts, ())
    stock = {bed.stock: bed.sheet.quantity for bed in task.beds}
    sheets: list[Filled] = []
    for begun in task.start:
        stock = without_one(stock, begun.bed.stock)
        sheets.append(Filled(begun.bed, tuple(fill_raster(begun.bed, waiting(queue, begun.bed, left), begun.placed))))
        left = less(left, sheets[-1].placed[len(begun.placed) :])
    while left:
        filled = next_sheet(queue, [bed for bed in task.beds if stock[bed.stock] != 0], left, fill, choice)
        if filled is None:
            break
        sheets.append(filled)
        left = less(left, filled.placed)
        stock = without_one(stock, filled.bed.stock)
    return Plan(tuple(sheets), left)


def without_one(stock: Mapping[int, int | None], taken: int) -> dict[int, int | None]:
    """Return how many sheets there are of each stock after one was taken; None: as many as needed."""
    return {one: count if count is None or one != taken else count - 1 for one, count in stock.items()}


def ordered(task: Task, order: Order) -> list[Kind]:
    """Return the parts, first those that find the least room, then by falling size, then as listed."""
    return sorted(task.kinds, key=lambda one: (*_ease(one, task.beds), -order(one), one.blank.part))


def _ease(one: Kind, beds: Sequence[Bed]) -> tuple[int, float]:
    """Return how many stocks a part fits, and what share of their room is good enough for it."""
    fitting = [bed for bed in beds if one.on(bed)]
    good = sum((bed.room_mm2(one.blank.pattern.quality) for bed in fitting), start=0.0)
    return len(fitting), round(good / max(sum((bed.area_mm2 for bed in fitting), start=0.0), 1.0), 3)


def next_sheet(
    queue: Sequence[Kind], beds: Iterable[Bed], left: Counts, fill: Fill, choice: Choice = by_area
) -> Filled | None:
    """Return the next sheet, filled: a remnant if one takes anything; None if nothing does."""
    every = list(beds)
    remnants = [bed for bed in every if bed.sheet.kind == "remnant"]
    new = [bed for bed in every if bed.sheet.kind != "remnant"]
    return _next_of(queue, remnants, left, fill, choice) or _next_of(queue, new, left, fill, choice)


def _next_of(queue: Sequence[Kind], beds: Sequence[Bed], left: Counts, fill: Fill, choice: Choice) -> Filled | None:
    """Return the first sheet that takes all that is left, else the first that takes anything, as is chosen."""
    wanted = area_of(queue, left)
    tried: dict[int, Filled] = {}

    def filled(bed: Bed) -> Filled:
        if bed.stock not in tried:
            tried[bed.stock] = Filled(bed, tuple(fill(bed, waiting(queue, bed, left))))
        return tried[bed.stock]

    for_all, for_some = choice(beds, wanted)
    for bed in for_all:
        if wanted <= bed.area_mm2 * (1.0 if bed.plain else DENSEST) and not less(left, filled(bed).placed):
            return filled(bed)
    return next((filled(bed) for bed in for_some if filled(bed).placed), None)


def area_of(kinds: Sequence[Kind], counts: Counts) -> float:
    """Return the area of some copies in mm2."""
    return sum((counts.get(one.blank.part, 0) * one.blank.area_mm2 for one in kinds), start=0.0)


def waiting(queue: Sequence[Kind], bed: Bed, left: Counts) -> list[tuple[int, tuple[Turned, ...]]]:
    """Return how many copies wait, in which angles they fit the bed, in the order of the queue."""
    return [(left[one.blank.part], one.on(bed)) for one in queue if left.get(one.blank.part, 0) and one.on(bed)]


def less(left: Counts, placed: Iterable[Placed]) -> dict[int, int]:
    """Return the copies still to be placed after some were."""
    rest = dict(left)
    for one in placed:
        rest[one.turned.blank.part] -= 1
    return {part: count for part, count in rest.items() if count > 0}
