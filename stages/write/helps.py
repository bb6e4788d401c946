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
class Around:
    """What there is around a contour: what leads keep clear of, its own number among that, the ends of bend lines."""

    obstacles: Obstacles
    own: int
    bends: Points2


def helped(drawing: Drawing, machine: Machine) -> Drawing:
    """Return a drawing with the helps of the machine, and the findings that tell them."""
    if not machine.helps.any:
        return drawing
    shut = [number for number, item in enumerate(drawing.items) if item.layer in SHUT_LAYERS]
    obstacles = Obstacles([drawing.items[number].path for number in shut])
    place = {number: at for at, number in enumerate(shut)}
    bends = _bend_ends(drawing.items)
    done = []
    for number, item in enumerate(drawing.items):
        if item.contour is None or not item.path.closed:
            done.append(Done((replace(item, nominal=None),), item.part, shared=item.contour is not None))
            continue
        one = _cut(item, machine.helps, Around(obstacles, place[number], bends))
        done.append(replace(one, items=_written(one.items, machine)))
    items = tuple(item for one in done for item in one.items)
    return replace(drawing, items=items, helps=machine.helps, told=told(drawing.path, machine.helps, done))


def _written(items: Iterable[Item], machine: Machine) -> tuple[Item, ...]:
    """Return the items with paths that the flavour holds."""
    return tuple(replace(item, path=as_written(item.path, machine, outline=item.contour is not None)) for item in items)


def _bend_ends(items: Sequence[Item]) -> Points2:
    """Return the ends of all bend lines."""
    ends = [item.path.vertices[[0, -1]] for item in items if item.layer in BEND_LAYERS]
    return np.concatenate(ends) if ends else np.zeros((0, 2))


def _cut(item: Item, helps: Helps, around: Around) -> Done:
    """Return the paths that one closed contour is cut by, with their leads."""
    if helps.tabs is None or not _is_held(item, helps.tabs):
        return _begun(item, helps, around)
    found = _gaps(item.path, helps.tabs, helps.gap_mm, around.bends)
    if not found.middles:
        return replace(_begun(item, helps, around), missing_tabs=found.missing)
    rests = opened(item.path, found, helps.gap_mm)
    pieces = [
        replace(item, path=rest, begun=True, nominal=None if number else item.nominal)
        for number, rest in enumerate(rests)
    ]
    led = [_led(piece, helps, around) for piece in pieces]
    return Done(
        tuple(one for some in led for one in some.items),
        item.part,
        tabs=len(found.middles),
        missing_tabs=found.missing,
        uneven_mm=found.uneven_mm,
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


def _begun(item: Item, helps: Helps, around: Around) -> Done:
    """Return a whole contour from where it may begin on, with its leads; without them where none is free."""
    if not helps.begins:
        return Done((item,), item.part)
    places = starts(item.path, helps.start)
    if not helps.leads:
        return Done((replace(item, path=begun(item.path, places[0]), begun=True),), item.part)
    for place in places:
        made = _led(replace(item, path=begun(item.path, place), begun=True), helps, around)
        if made.leads:
            return replace(made, moved=place != places[0])
    return _led(replace(item, path=begun(item.path, places[0]), begun=True), helps, around)


def _led(item: Item, helps: Helps, around: Around) -> Done:
    """Return a path that is cut with its leads, if they are free."""
    ways = _leads(item.path, helps)
    room = _room(ways, helps, around)
    if room is None:
        return Done((item,), item.part, blocked=int(helps.leads))
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


def _room(ways: Ways, helps: Helps, around: Around) -> float | None:
    """Return how near leads come to what is not their contour, mm; None if that is too near."""
    least = max(helps.beam_mm / 2.0 - helps.offset_mm, APART_MM)
    onto, away = ways
    ending = [way for way in (onto, None if away is None else backwards(away)) if way is not None]
    look = least + max(map(length, ending), default=0.0)
    nearest = min((around.obstacles.room(way, around.own, look) for way in ending), default=np.inf)
    free = nearest > least and all(around.obstacles.leaves(way, around.own) for way in ending)
    return nearest if free else None
