"""How a contour is to be cut, planned once for all copies of its part that lie alike: its beginning, tabs, leads.

A plan is made in the part's own frame; where the rule of start points names a side of the sheet, in one that is turned
as the copies are.  Mirrored copies have plans of their own: their contours run the other way round.  What is around a
copy is not looked at here: whether a lead is free of its own contour is, and is the same for all copies.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stages.geometry.arrays import Points2, Vector2
from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, backwards, bounds, length, piece_count, split, sweeps
from stages.geometry.paths.biarc import LEAST_PIECE_MM
from stages.geometry.paths.leads import Obstacles, off, round_in, straight
from stages.geometry.paths.manypaths import moved
from stages.geometry.paths.parts import begun, direction_at
from stages.geometry.paths.tabs import Gaps, Wish, gaps, opened
from stages.model.cutfile import Machine
from stages.model.helps import Helps, Lead, Tabs
from stages.write.flavours import as_written
from stages.write.starts import starts

CLEAR_MM = 2.0
"""How far a tab stays from corners and from ends of bend lines: it is broken off with pliers, and leaves a burr."""

NO_GAPS = Gaps((), 0, 0.0)

Ways = tuple[ArcPath | None, ArcPath | None]
"""The way to the beginning of a path, and that off its end."""


@dataclass(frozen=True, slots=True, eq=False)
class Led:
    """A path that is cut, as the flavour holds it, and its leads.

    ways: the leads as they are; drawn: as the flavour holds them.
    leaves: whether they are off their own contour but for their ends, on the side of its waste.
    reach_mm: the length of the longer one.
    """

    path: ArcPath
    ways: Ways = (None, None)
    drawn: Ways = (None, None)
    leaves: bool = True
    reach_mm: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """How one closed contour is cut: by paths between gaps, or whole from one of some places, the best first.

    Without either it is cut as it is drawn.
    """

    contour: ArcPath
    gaps: Gaps = NO_GAPS
    pieces: tuple[Led, ...] = ()
    places: tuple[float, ...] = ()


def plan(contour: ArcPath, machine: Machine, bends: Points2, *, outer: bool) -> Plan:
    """Return how a closed contour is to be cut; bends: the ends of the bend lines of its part."""
    helps = machine.helps
    found = NO_GAPS
    if helps.tabs is not None and _is_held(contour, helps.tabs, outer=outer):
        found = _gaps(contour, helps.tabs, helps.gap_mm, bends)
    if found.middles:
        return Plan(contour, found, led(opened(contour, found, helps.gap_mm), contour, machine))
    return Plan(contour, found, (), tuple(starts(contour, helps.start)) if helps.begins else ())


def from_place(of: Plan, number: int, machine: Machine) -> tuple[Led, ...]:
    """Return the paths of a contour that has gaps, or all of it, from one of its places."""
    return of.pieces or led([begun(of.contour, of.places[number])], of.contour, machine)


def led(paths: Sequence[ArcPath], contour: ArcPath, machine: Machine) -> tuple[Led, ...]:
    """Return paths that a contour is cut by, with their leads."""
    helps = machine.helps
    if not helps.leads:
        return tuple(Led(as_written(path, machine, outline=True)) for path in paths)
    ways = [_leads(path, helps) for path in paths]
    ending = [(number, way) for number, row in enumerate(ways) for way in _ending(row)]
    free = Obstacles([contour]).leave([way for _, way in ending], np.zeros(len(ending), dtype=np.int64))
    shut = {number for (number, _), leaves in zip(ending, free.tolist(), strict=True) if not leaves}
    return tuple(
        Led(
            as_written(path, machine, outline=True),
            row,
            _drawn(row, machine),
            number not in shut,
            max(length(way) for way in row if way is not None),
        )
        for number, (path, row) in enumerate(zip(paths, ways, strict=True))
    )


def lying(row: Sequence[Led], motion: Rigid2) -> list[Led]:
    """Return paths with their leads where a copy lies; what is one path stays one."""
    every = dict.fromkeys(way for one in row for way in (one.path, *one.ways, *one.drawn) if way is not None)
    there: dict[ArcPath | None, ArcPath | None] = dict(zip(every, moved(list(every), motion), strict=True))
    there[None] = None
    made = []
    for one in row:
        path, onto, away, drawn_onto, drawn_away = (there[way] for way in (one.path, *one.ways, *one.drawn))
        made.append(Led(path or one.path, (onto, away), (drawn_onto, drawn_away), one.leaves, one.reach_mm))
    return made


def _drawn(ways: Ways, machine: Machine) -> Ways:
    """Return leads as the flavour holds them, their arcs no longer than those of contours."""
    onto, away = (
        None if way is None else as_written(split(way, max_bulge=machine.max_bulge), machine, outline=False)
        for way in ways
    )
    return onto, away


def _ending(ways: Ways) -> Iterator[ArcPath]:
    """Yield leads such that they end on their contour."""
    onto, away = ways
    yield from (way for way in (onto, None if away is None else backwards(away)) if way is not None)


def _is_held(path: ArcPath, tabs: Tabs, *, outer: bool) -> bool:
    """Return whether a contour is to have tabs."""
    low_x, low_y, high_x, high_y = bounds(path)
    small = tabs.below_mm is None or min(high_x - low_x, high_y - low_y) < tabs.below_mm
    return small and (tabs.holes or outer)


def _gaps(path: ArcPath, tabs: Tabs, gap: float, bends: Points2) -> Gaps:
    """Return where the gaps of a contour are to be."""
    long, least = length(path), 2.0 * LEAST_PIECE_MM
    wanted = tabs.count or 1
    if tabs.spacing_mm is not None:
        wanted = int(np.ceil(long / max(tabs.spacing_mm, LEAST_PIECE_MM)))
    # more have no room beside each other
    count = max(min(wanted, int(long / (gap + least))), 1)
    found = gaps(path, Wish(count, gap, max(CLEAR_MM, gap), least), bends)
    return replace(found, missing=found.missing + wanted - count)


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
