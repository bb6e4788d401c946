"""In which order sheets are asked: for all that is left first, then for anything."""

from collections.abc import Callable, Sequence
from math import ceil

from stages.nest.blank import Bed

Choice = Callable[[Sequence[Bed], float], tuple[list[Bed], list[Bed]]]
"""Given the sheets and the area in mm2 that is left: which are asked for all of it, and which for anything."""


def by_area(beds: Sequence[Bed], _: float) -> tuple[list[Bed], list[Bed]]:
    """Return the smallest sheets first to take all, the largest first to take anything."""
    return sorted(beds, key=lambda bed: bed.area_mm2), sorted(beds, key=lambda bed: -bed.area_mm2)


def by_price(beds: Sequence[Bed], wanted_mm2: float) -> tuple[list[Bed], list[Bed]]:
    """Return the cheapest first to take all, those with the least price of their area first to take anything.

    One sheet is not asked to take all where several of the least price of their area cost less.
    """
    rising = sorted(beds, key=lambda bed: (bed.cost + bed.cost_mm * bed.width_mm) / max(bed.area_mm2, 1.0))
    if not rising:
        return [], []
    best = rising[0]
    several = max(ceil(wanted_mm2 / max(best.area_mm2, 1.0)), 1) * price(best, wanted_mm2)
    for_all = (bed for bed in beds if price(bed, wanted_mm2) <= several)
    return sorted(for_all, key=lambda bed: price(bed, wanted_mm2)), rising


def price(bed: Bed, wanted_mm2: float) -> float:
    """Return what a sheet costs if it is to take so much, of a roll the length that takes at least."""
    return bed.cost + bed.cost_mm * min(bed.width_mm, wanted_mm2 / max(bed.height_mm, 1.0))
