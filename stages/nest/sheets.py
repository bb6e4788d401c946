"""Spread parts over sheets: fill one sheet after the other, and tell which of two results is better.

The order of the parts: first what fits few of the stocks, then large ones.  The next sheet is the smallest that takes
all that is left, else the largest that takes anything.  Several fills and orders are tried and the best result wins:
the fewest sheets, then the least area of sheets, then the shortest used length of the emptiest sheet.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import NamedTuple

from stages.nest.blank import Bed, Placed, Turned
from stages.nest.boxes import fill_boxes
from stages.nest.fit import Kind
from stages.nest.raster import fill_raster

Queue = Sequence[tuple[int, tuple[Turned, ...]]]
Fill = Callable[[Bed, Queue], list[Placed]]
Order = Callable[[Kind], float]
Counts = Mapping[int, int]
"""Copies still to be placed, by the place of the part in the list."""

FEW_COPIES = 60
"""Up to so many copies a second order is tried on true shapes: about 1 s more."""


class Task(NamedTuple):
    """What is to be placed, on what, how many of each."""

    kinds: Sequence[Kind]
    beds: Sequence[Bed]
    counts: Counts


class Filled(NamedTuple):
    """One sheet and what lies on it."""

    bed: Bed
    placed: tuple[Placed, ...]


class Plan(NamedTuple):
    """Sheets in the order they were filled, and copies that found no sheet, by part."""

    sheets: tuple[Filled, ...]
    left: dict[int, int]

    @property
    def cost(self) -> tuple[int, int, float, float]:
        """What is to be as small as possible: copies left, sheets, their area in mm2, use of the emptiest one."""
        area = sum((sheet.bed.sheet.width_mm * sheet.bed.sheet.height_mm for sheet in self.sheets), start=0.0)
        return sum(self.left.values()), len(self.sheets), area, min(map(used_share, self.sheets), default=0.0)


def used_share(sheet: Filled) -> float:
    """Return which share of the length of a sheet is used: what is right of it is one straight offcut."""
    return max((placed.right_mm for placed in sheet.placed), default=0.0) / sheet.bed.width_mm


def first_plans(task: Task) -> list[Plan]:
    """Return the plans that need neither clock nor random numbers, the best first."""
    trials: list[tuple[Fill, Order]] = [
        (fill_boxes, side),
        (fill_boxes, size),
        (fill_boxes, height),
        (fill_raster, size),
    ]
    if sum(task.counts.values()) <= FEW_COPIES:
        trials.append((fill_raster, side))
    return sorted((spread(task, fill, order) for fill, order in trials), key=lambda plan: plan.cost)


def size(kind: Kind) -> float:
    """Return the area of a grown part in mm2."""
    return float(kind.blank.shape.area)


def side(kind: Kind) -> float:
    """Return the longest side of the first box of a part in mm."""
    return max(kind.turns[0].width_mm, kind.turns[0].height_mm)


def height(kind: Kind) -> float:
    """Return the least height of a part in its angles in mm."""
    return min(one.height_mm for one in kind.turns)


def spread(task: Task, fill: Fill, order: Order) -> Plan:
    """Return all copies spread over sheets by one fill in one order."""
    queue = ordered(task, order)
    left = less(task.counts, ())
    stock = {bed.stock: bed.sheet.quantity for bed in task.beds}
    sheets: list[Filled] = []
    while left:
        filled = next_sheet(queue, [bed for bed in task.beds if stock[bed.stock] != 0], left, fill)
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
    """Return the parts, first those that fit few stocks, then by falling size, then as listed."""
    stocks = {one.blank.part: sum(bool(one.on(bed)) for bed in task.beds) for one in task.kinds}
    return sorted(task.kinds, key=lambda one: (stocks[one.blank.part], -order(one), one.blank.part))


def next_sheet(queue: Sequence[Kind], beds: Iterable[Bed], left: Counts, fill: Fill) -> Filled | None:
    """Return the smallest sheet that takes all that is left, else the largest that takes anything, filled."""
    rising = sorted(beds, key=lambda bed: (bed.width_mm * bed.height_mm, bed.stock))
    wanted, best = area_of(queue, left), None
    for bed in rising:
        if bed.width_mm * bed.height_mm < wanted and bed is not rising[-1]:
            continue
        filled = Filled(bed, tuple(fill(bed, waiting(queue, bed, left))))
        if not less(left, filled.placed):
            return filled
        best = filled if filled.placed else best
    return best or _anything(queue, rising[-2::-1], left, fill)


def _anything(queue: Sequence[Kind], falling: Sequence[Bed], left: Counts, fill: Fill) -> Filled | None:
    """Return the first of the sheets that takes anything, filled."""
    tried = (Filled(bed, tuple(fill(bed, waiting(queue, bed, left)))) for bed in falling)
    return next((filled for filled in tried if filled.placed), None)


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
