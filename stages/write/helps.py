"""Helps for the process on a drawing of contours: where each begins, tabs, leads; and what is to be said of them.

A contour that is whole begins where the rule says.  With tabs it is open pieces in a row, each from the end of one gap
to the next gap.  Each path that is cut has leads of its own, on the layer LEAD: the way in comes right before it, the
way off right after, so that contours stay closed where there are no tabs.  Where a lead would come too near to a
contour, the edge of the sheet or a defect, the contour begins at another place; where there is none, it has no lead,
which is said.

How a contour is cut is planned once for all copies of its part that lie alike (`helpplans`); copy by copy it is looked
at what is around.  What is left of outlines that share cuts has no helps: it begins where a common line takes over.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stages.geometry.arrays import Array, Points2
from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, transform
from stages.geometry.paths.leads import APART_MM, Obstacles
from stages.model.cutfile import Machine
from stages.model.helps import Helps
from stages.write.drawing import Drawing, Item
from stages.write.flavours import as_written
from stages.write.helpplans import Led, Plan, from_place, lying, plan
from stages.write.helptold import Done, told
from stages.write.starts import SIDES

LEAD = "LEAD"
SHUT_LAYERS = ("SHEET", "SHEET_KEEPOUT", "CUT_INNER", "CUT_OUTER")
"""What a lead keeps clear of: contours, the edge of the sheet and of what is left over, defects."""

BEND_LAYERS = ("BEND_UP", "BEND_DOWN")


@dataclass(frozen=True, slots=True)
class Copy:
    """A closed contour of a drawing: its number among what leads keep clear of, its plan, and where that lies."""

    own: int
    item: Item
    plan: Plan
    motion: Rigid2


def helped(drawing: Drawing, machine: Machine) -> Drawing:
    """Return a drawing with the helps of the machine, and the findings that tell them."""
    helps = machine.helps
    if not helps.any:
        return drawing
    shut = [number for number, item in enumerate(drawing.items) if item.layer in SHUT_LAYERS]
    obstacles = Obstacles([drawing.items[number].path for number in shut] if helps.leads else [])
    copies = _copies(drawing.items, shut, machine)
    cut = dict(zip(copies, _cut(list(copies.values()), machine, obstacles), strict=True))
    done = [
        cut.get(number) or Done((replace(item, nominal=None),), item.part, shared=item.contour is not None)
        for number, item in enumerate(drawing.items)
    ]
    items = tuple(item for one in done for item in one.items)
    return replace(drawing, items=items, helps=helps, told=told(drawing.path, helps, done))


def _copies(items: Sequence[Item], shut: Sequence[int], machine: Machine) -> dict[int, Copy]:
    """Return the closed contours by their numbers; those of copies that lie alike have one plan."""
    bends, plans = _bends(items), dict[tuple[str, ArcPath, float, bool], Plan]()
    copies = {}
    for own, number in enumerate(shut):
        item = items[number]
        if item.contour is None or not item.path.closed:
            continue
        frame = _frame(item, machine.helps)
        own_path = item.own or item.path
        key = (item.part, own_path, frame.angle_deg, frame.mirrored)
        if key not in plans:
            contour = as_written(transform(own_path, frame), machine, outline=True)
            ends = [transform(line, frame).vertices[[0, -1]] for line in bends.get((item.part, item.copy), ())]
            plans[key] = plan(contour, machine, _joined(ends), outer=item.contour == 0)
        rest = Rigid2(item.motion.x, item.motion.y, item.motion.angle_deg - frame.angle_deg)
        copies[number] = Copy(own, item, plans[key], rest)
    return copies


def _frame(item: Item, helps: Helps) -> Rigid2:
    """Return the motion into the frame in which a contour is planned."""
    angle = item.motion.angle_deg if helps.start in SIDES else 0.0
    return Rigid2(0.0, 0.0, angle, item.motion.mirrored)


def _bends(items: Sequence[Item]) -> dict[tuple[str, int], list[ArcPath]]:
    """Return the bend lines of all copies, each in the frame of its part."""
    found: dict[tuple[str, int], list[ArcPath]] = {}
    for item in items:
        if item.layer in BEND_LAYERS:
            found.setdefault((item.part, item.copy), []).append(item.own or item.path)
    return found


def _joined(points: Sequence[Array]) -> Points2:
    return np.concatenate([np.zeros((0, 2)), *points])


def _cut(copies: Sequence[Copy], machine: Machine, obstacles: Obstacles) -> list[Done]:
    """Return the paths that each contour is cut by, with their leads."""
    rows: dict[tuple[Plan, int], tuple[Led, ...]] = {}

    def tried(place: int, some: Sequence[int]) -> Iterator[Done]:
        """Yield copies as they are cut from their place of that number."""
        for number in some:
            key = copies[number].plan, place
            rows[key] = rows.get(key) or from_place(*key, machine)
        there = [lying(rows[copies[number].plan, place], copies[number].motion) for number in some]
        rooms = iter(_rooms(there, [copies[number].own for number in some], machine.helps, obstacles))
        for number, row in zip(some, there, strict=True):
            yield _done(copies[number], row, [next(rooms) for _ in row])

    planned = [number for number, copy in enumerate(copies) if copy.plan.pieces or copy.plan.places]
    found = dict(zip(planned, tried(0, planned), strict=True))
    place = 0
    while left := [k for k in planned if found[k].blocked and len(copies[k].plan.places) > place + 1]:
        place += 1
        found |= {k: replace(one, moved=True) for k, one in zip(left, tried(place, left), strict=True) if one.leads}
    return [found.get(number) or _as_drawn(copy) for number, copy in enumerate(copies)]


def _as_drawn(copy: Copy) -> Done:
    """Return a contour that nothing is done on."""
    return Done((copy.item,), copy.item.part, missing_tabs=copy.plan.gaps.missing)


def _done(copy: Copy, row: Sequence[Led], rooms: Sequence[float | None]) -> Done:
    """Return the paths of one contour, each with its leads where they are free."""
    item, gaps = copy.item, copy.plan.gaps
    items: list[Item] = []
    leads = 0
    for number, (one, room) in enumerate(zip(row, rooms, strict=True)):
        onto, away = one.drawn if room is not None else (None, None)
        nominal = None if number else item.nominal
        items += _lead(item, onto)
        items.append(replace(item, path=one.path, begun=True, nominal=nominal, own=None))
        items += _lead(item, away)
        leads += (onto is not None) + (away is not None)
    return Done(
        tuple(items),
        item.part,
        tabs=len(gaps.middles),
        missing_tabs=gaps.missing,
        uneven_mm=gaps.uneven_mm if gaps.middles else 0.0,
        leads=leads,
        blocked=sum(room is None for room in rooms),
        room_mm=min(np.inf if room is None else room for room in rooms),
    )


def _lead(item: Item, way: ArcPath | None) -> list[Item]:
    return [] if way is None else [Item(LEAD, item.part, way, name=item.name, copy=item.copy)]


def _rooms(
    rows: Sequence[Sequence[Led]], owns: Sequence[int], helps: Helps, obstacles: Obstacles
) -> list[float | None]:
    """Return how near the leads of each path come to what is not their contour, mm; None if that is too near."""
    least = max(helps.beam_mm / 2.0 - helps.offset_mm, APART_MM)
    every = [(one, own) for row, own in zip(rows, owns, strict=True) for one in row]
    named = [(number, way) for number, (one, _) in enumerate(every) for way in one.ways if way is not None]
    number = np.array([one for one, _ in named], dtype=np.int64)
    own = np.array([own for _, own in every], dtype=np.int64)[number]
    within = least + np.array([one.reach_mm for one, _ in every])[number]
    room = np.full(len(every), np.inf)
    np.minimum.at(room, number, obstacles.rooms([way for _, way in named], own, within))
    return [
        float(far) if far > least and one.leaves else None for far, (one, _) in zip(room.tolist(), every, strict=True)
    ]
