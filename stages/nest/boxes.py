"""Fill a sheet with the boxes of the parts: a skyline, leftmost first.

The skyline is how far the sheet is used at each height.  Every copy goes, in the angle and at the step of the skyline
where its right end comes out least; ties by the smaller height.  Exact for rectangles, a row of boxes that fits to the
last micron is found; the hollows of curved parts are wasted.

Source: E. K. Burke, G. Kendall, G. Whitwell, "A new placement heuristic for the orthogonal stock-cutting problem",
Operations Research 52 (2004) 655-671, with the order of the parts fixed from outside.
"""

from collections.abc import Sequence
from typing import NamedTuple

from stages.nest.blank import Bed, Placed, Turned


class Step(NamedTuple):
    """One step of the skyline: from `low` to `high` the sheet is used up to `reach`; mm."""

    low: float
    high: float
    reach: float


class Spot(NamedTuple):
    """Where a box may lie; sorts by preference."""

    right: float
    y: float
    x: float
    turn: int


def fill_boxes(bed: Bed, queue: Sequence[tuple[int, tuple[Turned, ...]]]) -> list[Placed]:
    """Return the copies that find room, in the order of the queue; each entry is how many, in which angles."""
    skyline = [Step(0.0, bed.height_mm, 0.0)]
    placed = []
    for count, turns in queue:
        for _ in range(count):
            spot = best_spot(skyline, turns, bed)
            if spot is None:
                break
            one = turns[spot.turn]
            placed.append(Placed(one, spot.x, spot.y))
            skyline = covered(skyline, Step(spot.y, spot.y + one.height_mm, spot.right))
    return placed


def best_spot(skyline: Sequence[Step], turns: Sequence[Turned], bed: Bed) -> Spot | None:
    """Return the preferred place of a box, or None."""
    spots = [
        spot
        for number, one in enumerate(turns)
        for step in skyline
        for y in (step.low, step.high - one.height_mm)
        if (spot := _spot(skyline, one, y, number, bed)) is not None
    ]
    return min(spots, default=None)


def _spot(skyline: Sequence[Step], one: Turned, y: float, number: int, bed: Bed) -> Spot | None:
    top = y + one.height_mm
    if y < 0.0 or top > bed.height_mm:
        return None
    x = max(step.reach for step in skyline if step.low < top and step.high > y)
    right = x + one.width_mm
    return Spot(right, y, x, number) if right <= bed.width_mm else None


def covered(skyline: Sequence[Step], new: Step) -> list[Step]:
    """Return the skyline after a box has been laid on it."""
    below = [step._replace(high=min(step.high, new.low)) for step in skyline if step.low < new.low]
    above = [step._replace(low=max(step.low, new.high)) for step in skyline if step.high > new.high]
    merged: list[Step] = []
    for step in (*below, new, *above):
        if merged and merged[-1].reach == step.reach:
            merged[-1] = merged[-1]._replace(high=step.high)
        else:
            merged.append(step)
    return merged
