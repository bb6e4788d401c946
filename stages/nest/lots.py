"""From patterns, stock and wishes to a task: lots of copies that are alike, room on the stock, what is fixed already.

A part of which every second copy is mirrored becomes two lots.  Where any copy may be mirrored the lot has both hands,
unless the part is its own mirror image.  Copies placed from outside are taken out of their lot and lie on the first
sheets; where all copies are to lie in one direction, the first of them says which.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace

from stages.model.pattern import FlatPattern
from stages.model.sheet import Nesting, NestOptions, Placement, Sheet
from stages.nest.beds import beds
from stages.nest.blank import Bed, Blank, Placed, Turned, as_blank, fits, turned
from stages.nest.fit import QUARTER_DEG, Kind, hull, kind, steps, tight_angle
from stages.nest.sheets import Filled, Task
from stages.nest.turns import contains

ALIKE_SHARE = 1e-6
"""Two outlines are the same if what one has and the other has not is less than this share of them."""

EMPTY = Nesting(())


def task_of(
    patterns: Sequence[FlatPattern], stock: Sequence[Sheet], options: NestOptions, fixed: Nesting = EMPTY
) -> Task:
    """Return what is to be placed on what, with what is fixed taken out of it."""
    room = beds(patterns, stock, options)
    hands = [lot for pattern in patterns for lot in _hands(pattern, options)]
    numbered = [
        tuple(as_blank(number, pattern, options, mirrored=mirrored) for mirrored in either)
        for number, (pattern, either, _) in enumerate(hands)
    ]
    kinds = [kind(_unlike(blanks), room, options) for blanks in numbered]
    counts = {number: count for number, (_, _, count) in enumerate(hands)}
    start = tuple(_begun(layout.placements, _bed(layout.sheet, room), kinds) for layout in fixed.layouts)
    placed = [one for sheet in start for one in sheet.placed]
    there = Counter(one.turned.blank.part for one in placed)
    if options.one_direction:
        kinds = [_as_given(one, placed, room) for one in kinds]
    return Task(kinds, room, _less(counts, there), start, options.one_direction)


def _hands(pattern: FlatPattern, options: NestOptions) -> list[tuple[FlatPattern, tuple[bool, ...], int]]:
    """Return the lots of a part: which hands (mirrored or not) their copies may have, and how many there are."""
    if pattern.pair:
        return [(pattern, (False,), (pattern.quantity + 1) // 2), (pattern, (True,), pattern.quantity // 2)]
    return [(pattern, (False, True) if options.mirror else (False,), pattern.quantity)]


def _unlike(hands: Sequence[Blank]) -> Sequence[Blank]:
    """Return the hands without a mirror image that is the part itself, turned."""
    if len(hands) == 1:
        return hands
    plain, mirrored = hands
    base = turned(plain, tight_angle(hull(plain)))
    others = (turned(mirrored, angle) for angle in steps(tight_angle(hull(mirrored)), QUARTER_DEG))
    alike = any(base.shape.symmetric_difference(one.shape).area < ALIKE_SHARE * base.shape.area for one in others)
    return hands[:1] if alike else hands


def _bed(sheet: Sheet, room: Sequence[Bed]) -> Bed:
    """Return the bed of a sheet; a sheet that is not in the stock is a mistake of the caller."""
    found = next((bed for bed in room if bed.sheet.id == sheet.id), None)
    if found is None:
        raise ValueError(f"fixed placements lie on '{sheet.id}', which is not in the stock")
    return found


def _begun(placements: Sequence[Placement], bed: Bed, kinds: Sequence[Kind]) -> Filled:
    return Filled(bed, tuple(_given(one, bed, kinds) for one in placements))


def _given(placement: Placement, bed: Bed, kinds: Sequence[Kind]) -> Placed:
    """Return a fixed placement as what lies on the bed."""
    lot = _lot(placement, kinds)
    motion = placement.motion
    hand = next((one for one in lot.hands if one.mirrored == motion.mirrored), lot.blank)
    way = turned(hand, motion.angle_deg)
    return Placed(way, motion.x - way.dx - bed.x_mm, motion.y - way.dy - bed.y_mm, placement)


def _lot(placement: Placement, kinds: Sequence[Kind]) -> Kind:
    """Return the lot of a copy: of a pair, the mirrored one if its number is even."""
    lots = [one for one in kinds if one.blank.pattern.part == placement.part]
    if not lots:
        raise ValueError(f"a fixed placement names part '{placement.part}', which there is not")
    return lots[(placement.copy - 1) % len(lots)]


def _as_given(lot: Kind, placed: Sequence[Placed], room: Sequence[Bed]) -> Kind:
    """Return a lot with only the angle of its fixed copies left for each hand that has any."""
    given: dict[Blank, Turned] = {}
    for one in placed:
        if one.turned.blank in lot.hands:
            given.setdefault(one.turned.blank, one.turned)
    if not given:
        return lot
    ways = tuple((*_others(lot.on(bed), given), *_fitting(lot, bed, given)) for bed in room)
    return replace(lot, ways=ways, turns=(*_others(lot.turns, given), *given.values()))


def _others(ways: Sequence[Turned], given: Mapping[Blank, Turned]) -> tuple[Turned, ...]:
    """Return the ways of the hands that have no fixed copy."""
    return tuple(one for one in ways if one.blank not in given)


def _fitting(lot: Kind, bed: Bed, given: Mapping[Blank, Turned]) -> tuple[Turned, ...]:
    """Return those of the given ways that fit a bed and are allowed there."""
    return tuple(
        one for one in given.values() if fits(one, bed) and contains(lot.allowed(bed, one.blank), one.angle_deg)
    )


def _less(counts: Mapping[int, int], there: Mapping[int, int]) -> dict[int, int]:
    return {number: max(count - there.get(number, 0), 0) for number, count in counts.items()}
