"""A plan as it is cut: sheets and copies numbered, how much is used, and what is left over in one straight piece."""

from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import count

from stages.geometry.paths.arcpath import bounds, transform
from stages.model.pattern import FlatPattern
from stages.model.sheet import Nesting, NestOptions, Placement, Rectangle, Sheet, SheetLayout
from stages.nest.blank import Bed, Placed
from stages.nest.legal.certify import utilisation
from stages.nest.sheets import Plan

Numbers = dict[tuple[str, bool], Iterator[int]]
"""The numbers that are still free, for each part and, of a pair, for each hand."""


def as_nesting(plan: Plan, patterns: Sequence[FlatPattern], options: NestOptions) -> Nesting:
    """Return a plan as it is cut: sheets counted within their stock, copies within their part, those given as given.

    The placements of a sheet are sorted by part and copy, so that sums over them do not depend on how they came about.
    """
    sheets: Counter[str] = Counter()
    numbers = _free_numbers(plan, patterns)
    layouts = []
    for filled in plan.sheets:
        if not filled.placed:
            continue
        sheets[filled.bed.sheet.id] += 1
        placements = [_placement(placed, filled.bed, numbers) for placed in filled.placed]
        placements.sort(key=lambda one: (one.part, one.copy))
        bare = SheetLayout(filled.bed.sheet, sheets[filled.bed.sheet.id], tuple(placements), 0.0)
        layouts.append(as_used(bare, patterns, options))
    return Nesting(tuple(layouts))


def _free_numbers(plan: Plan, patterns: Sequence[FlatPattern]) -> Numbers:
    """Return the numbers of copies that are not given: of a pair, even ones for the mirrored hand."""
    taken: defaultdict[str, set[int]] = defaultdict(set)
    for given in (placed.given for filled in plan.sheets for placed in filled.placed):
        if given is not None:
            taken[given.part].add(given.copy)
    numbers: Numbers = {}
    for pattern in patterns:
        odd, even = (count(1, 2), count(2, 2)) if pattern.pair else (count(1),) * 2
        numbers[pattern.part, False] = _without(odd, taken[pattern.part])
        numbers[pattern.part, True] = _without(even, taken[pattern.part])
    return numbers


def _without(numbers: Iterator[int], taken: set[int]) -> Iterator[int]:
    return (number for number in numbers if number not in taken)


def _placement(placed: Placed, bed: Bed, numbers: Numbers) -> Placement:
    if placed.given is not None:
        return placed.given
    blank = placed.turned.blank
    return Placement(blank.pattern.part, next(numbers[blank.pattern.part, blank.mirrored]), placed.motion(bed))


def as_used(layout: SheetLayout, patterns: Sequence[FlatPattern], options: NestOptions) -> SheetLayout:
    """Return a layout with how much of the sheet is used and what is left over, as its parts lie."""
    by_name = {pattern.part: pattern for pattern in patterns}
    boxes = [bounds(transform(by_name[one.part].outer.path, one.motion)) for one in layout.placements]
    share = utilisation(Nesting((layout,)), by_name)
    return replace(layout, utilisation=share or 0.0, offcut=offcut(layout.sheet, boxes, options))


def offcut(sheet: Sheet, boxes: Sequence[tuple[float, float, float, float]], options: NestOptions) -> Rectangle | None:
    """Return the largest straight rest right of all parts or above them, the gap away; None if it is scrap.

    Only of rectangles: what a hide leaves has no straight edge, and what a roll leaves stays on it.
    """
    if not sheet.is_rectangle:
        return None
    right = max((box[2] for box in boxes), default=-options.gap_mm) + options.gap_mm
    top = max((box[3] for box in boxes), default=-options.gap_mm) + options.gap_mm
    beside = Rectangle(right, 0.0, sheet.width_mm - right, sheet.height_mm)
    above = Rectangle(0.0, top, sheet.width_mm, sheet.height_mm - top)
    sides = [(min(one.width_mm, one.height_mm), one) for one in (beside, above)]
    worth = [one for side, one in sides if side > 0.0 and side >= options.offcut_min_mm]
    return max(worth, key=lambda one: one.width_mm * one.height_mm, default=None)
