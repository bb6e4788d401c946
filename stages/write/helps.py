"""Helps for the process on a drawing of contours: where each begins, tabs, leads; and what is to be said of them.

A contour that is whole begins where the rule says.  With tabs it is open pieces in a row, each from the end of one gap
to the next gap.  Each path that is cut has leads of its own, on the layer LEAD: the way in comes right before it, the
way off right after, so that contours stay closed where there are no tabs.  Where a lead would come too near to a
contour, the edge of the sheet or a defect, the contour begins at another place; where there is none, it has no lead,
which is said.

What is left of outlines that share cuts has no helps: it begins where a common line takes over.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stages.geometry.arcpath import ArcPath, backwards, bounds, length, piece_count, sweeps
from stages.geometry.arrays import Points2, Vector2
from stages.geometry.biarc import LEAST_PIECE_MM
from stages.geometry.leads import APART_MM, Obstacles, off, round_in, straight
from stages.geometry.pathparts import begun, direction_at
from stages.geometry.tabs import Gaps, Wish, gaps, opened
from stages.model.cutfile import Machine
from stages.model.helps import Helps, Lead, Tabs
from stages.write.drawing import Drawing, Item
from stages.write.flavours import as_written
from stages.write.helptold import Done, told
from stages.write.starts import starts

LEAD = "LEAD"
SHUT_LAYERS = ("SHEET", "SHEET_KEEPOUT", "CUT_INNER", "CUT_OUTER")
"""What a lead keeps clear of: contours, the edge of the sheet and of what is left over, defects."""

BEND_LAYERS = ("BEND_UP", "BEND_DOWN")

CLEAR_MM = 2.0
"""How far a tab stays from corners and from ends of bend lines: it is broken off with pliers, and leaves a burr."""

Ways = tuple[ArcPath | None, ArcPath | None]
"""The way to the beginning of a path, and that off its end."""


@dataclass(frozen=True, slots=True)
class Plan:
    """How one closed contour is to be cut: open paths between gaps, or whole from one of some places, the best first.

    own: its number among what leads keep clear of.
    """

    own: int
    item: Item
    pieces: tuple[Item, ...] = ()
    gaps: Gaps | None = None
    places: tuple[float, ...] = ()


def helped(drawing: Drawing, machine: Machine) -> Drawing:
    """Return a drawing with the helps of the machine, and the findings that tell them."""
    helps = machine.helps
    if not helps.any:
        return drawing
    shut = [number for number, item in enumerate(drawing.items) if item.layer in SHUT_LAYERS]
    bends = _bend_ends(drawing.items)
    plans = {
        number: _plan(item, own, helps, bends)
        for own, number in enumerate(shut)
        if (item := drawing.items[number]).contour is not None and item.path.closed
    }
    obstacles = Obstacles([drawing.items[number].path for number in shut])
    cut = dict(zip(plans, _cut(list(plans.values()), helps, obstacles), strict=True))
    done = [
        replace(cut[number], items=_written(cut[number].items, machine))
        if number in cut
        else Done((replace(item, nominal=None),), item.part, shared=item.contour is not None)
        for number, item in enumerate(drawing.items)
    ]
    items = tuple(item for one in done for item in one.items)
    return replace(drawing, items=items, helps=helps, told=told(drawing.path, helps, done))


def _written(items: Iterable[Item], machine: Machine) -> tuple[Item, ...]:
    """Return the items with paths that the flavour holds."""
    return tuple(replace(item, path=as_written(item.path, machine, outline=item.contour is not None)) for item in items)


def _bend_ends(items: Sequence[Item]) -> Points2:
    """Return the ends of all bend lines."""
    ends = [item.path.vertices[[0, -1]] for item in items if item.layer in BEND_LAYERS]
    return np.concatenate(ends) if ends else np.zeros((0, 2))


def _plan(item: Item, own: int, helps: Helps, bends: Points2) -> Plan:
    """Return how a closed contour is to be cut, as far as that does not depend on what is around it."""
    found = None
    if helps.tabs is not None and _is_held(item, helps.tabs):
        found = _gaps(item.path, helps.tabs, helps.gap_mm, bends)
    if found is not None and found.middles:
        rests = enumerate(opened(item.path, found, helps.gap_mm))
        pieces = (
            replace(item, path=rest, begun=True, nominal=None if number else item.nominal) for number, rest in rests
        )
        return Plan(own, item, tuple(pieces), found)
    if not helps.begins:
        return Plan(own, item, (), found)
    return Plan(own, item, (), found, tuple(starts(item.path, helps.start)))


def _cut(plans: Sequence[Plan], helps: Helps, obstacles: Obstacles) -> list[Done]:
    """Return the paths that each contour is cut by, with their leads."""
    rows = [plan.pieces or (_from(plan, 0),) for plan in plans]
    every = [(piece, plan.own) for plan, row in zip(plans, rows, strict=True) for piece in row]
    led = iter(_led(every, helps, obstacles))
    done = [_together(plan, [next(led) for _ in row]) for plan, row in zip(plans, rows, strict=True)]
    place = 0
    while left := [k for k, plan in enumerate(plans) if done[k].blocked and len(plan.places) > place + 1]:
        place += 1
        tried = _led([(_from(plans[k], place), plans[k].own) for k in left], helps, obstacles)
        for k, one in zip(left, tried, strict=True):
            if one.leads:
                done[k] = replace(one, missing_tabs=done[k].missing_tabs, moved=True)
    return done


def _from(plan: Plan, number: int) -> Item:
    """Return a whole contour from one of the places where it may begin."""
    if not plan.places:
        return plan.item
    return replace(plan.item, path=begun(plan.item.path, plan.places[number]), begun=True)


def _together(plan: Plan, led: Sequence[Done]) -> Done:
    """Return the paths of one contour, each with its leads, as one."""
    found = plan.gaps or Gaps((), 0, 0.0)
    return Done(
        tuple(one for some in led for one in some.items),
        plan.item.part,
        tabs=len(found.middles),
        missing_tabs=found.missing,
        uneven_mm=found.uneven_mm if found.middles else 0.0,
        leads=sum(some.leads for some in led),
        blocked=sum(some.blocked for some in led),
        room_mm=min(some.room_mm for some in led),
    )


def _is_held(item: Item, tabs: Tabs) -> bool:
    """Return whether a contour is to have tabs."""
    low_x, low_y, high_x, high_y = bounds(item.path)
    small = tabs.below_mm is None or min(high_x - low_x, high_y - low_y) < tabs.below_mm
    return small and (tabs.holes or item.contour == 0)


def _gaps(path: ArcPath, tabs: Tabs, gap: float, bends: Points2) -> Gaps:
    """Return where the gaps of a contour are to be."""
    wanted = tabs.count if tabs.spacing_mm is None else int(np.ceil(length(path) / tabs.spacing_mm))
    return gaps(path, Wish(wanted or 1, gap, max(CLEAR_MM, gap), 2.0 * LEAST_PIECE_MM), bends)


def _led(every: Sequence[tuple[Item, int]], helps: Helps, obstacles: Obstacles) -> list[Done]:
    """Return paths that are cut, each with the number of its contour among the obstacles, with leads that are free."""
    ways = [_leads(item.path, helps) if helps.leads else (None, None) for item, _ in every]
    rooms = _rooms(ways, [own for _, own in every], helps, obstacles)
    return [_with_leads(item, way, room) for (item, _), way, room in zip(every, ways, rooms, strict=True)]


def _with_leads(item: Item, ways: Ways, room: float | None) -> Done:
    """Return a path with its leads, if they are free."""
    if room is None:
        return Done((item,), item.part, blocked=1)
    onto, away = (() if way is None else (Item(LEAD, item.part, way, name=item.name, copy=item.copy),) for way in ways)
    return Done((*onto, item, *away), item.part, leads=len(onto) + len(away), room_mm=room)


def _leads(path: ArcPath, helps: Helps) -> Ways:
    """Return the leads of a path that is cut, closed or not."""
    last = piece_count(path) - 1
    end = path.vertices[0] if path.closed else path.vertices[-1]
    arriving = direction_at(path, float(last)) + float(sweeps(path)[last])
    onto = _lead(helps.lead_in, path.vertices[0], direction_at(path, 0.0))
    away = _lead(helps.lead_out, end, arriving)
    return onto, None if away is None else off(away, end, arriving)


def _lead(lead: Lead | None, at: Vector2, direction: float) -> ArcPath | None:
    """Return the way to a point."""
    if lead is None:
        return None
    way = straight if lead.kind == "line" else round_in
    return way(at, direction, lead.length_mm, float(np.radians(lead.angle_deg)))


def _rooms(ways: Sequence[Ways], owns: Sequence[int], helps: Helps, obstacles: Obstacles) -> list[float | None]:
    """Return how near the leads of each path come to what is not their contour, mm; None if that is too near."""
    least = max(helps.beam_mm / 2.0 - helps.offset_mm, APART_MM)
    named = [
        (number, way)
        for number, (onto, away) in enumerate(ways)
        for way in (onto, None if away is None else backwards(away))
        if way is not None
    ]
    number, ending = np.array([one for one, _ in named], dtype=np.int64), [way for _, way in named]
    look, room = np.zeros(len(ways)), np.full(len(ways), np.inf)
    np.maximum.at(look, number, np.array([length(way) for way in ending]))
    own = np.array(owns, dtype=np.int64)[number]
    np.minimum.at(room, number, obstacles.rooms(ending, own, least + look[number]))
    free = room > least
    np.logical_and.at(free, number, obstacles.leave(ending, own))
    return [float(one) if is_free else None for one, is_free in zip(room, free, strict=True)]
