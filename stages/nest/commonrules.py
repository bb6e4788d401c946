"""Parts on a sheet while they are moved together for common lines, and by which rules a move is judged.

The rules are the certifier's (`legal.ground`, `legal.common`).  The excuses of common lines are worked out for every
move in the strict way; the quick way takes two parts for excused that have a common line, or both one with a third part
(corners about a cross), and leaves it to the certifier to refuse the outcome as a whole.
"""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Vector2, norm
from stages.geometry.paths.clearance import clearances, joined
from stages.model.pattern import FlatPattern
from stages.model.sheet import NestOptions, Placement
from stages.nest.legal.common import Gaps, common_stretches, without_common_lines
from stages.nest.legal.ground import REACH_MM, edge_distances, edge_findings, zone_overlaps
from stages.nest.legal.laid import Ground, Laid, Spread
from stages.nest.legal.region import GAP_TOLERANCE_MM, overlap_mm2

SLIDES = 1e-9
"""Sine of the angle between a move and a common line up to which the parts slide: 1e-8 mm of a move of 10 mm."""

Patterns = Mapping[str, FlatPattern]
Pair = tuple[int, int]
"""Two parts by number, the smaller first."""


@dataclass(frozen=True, slots=True)
class Join:
    """Two parts that move together: a kerf apart along this unit normal, one in a hole of the other if it is None."""

    first: int
    second: int
    normal: tuple[float, float] | None

    def binds(self, way: Vector2) -> bool:
        """Return whether one cannot move that way without the other: parts slide along their common line."""
        return self.normal is None or abs(float(way @ self.normal)) > SLIDES * float(norm(way))


@dataclass(frozen=True, slots=True)
class Table:
    """Parts on a sheet: as they lie, which must not move, and which are joined."""

    ground: Ground
    placements: tuple[Placement, ...]
    laid: tuple[Laid, ...]
    held: frozenset[int]
    joins: tuple[Join, ...]


Judge = Callable[[Table, Gaps, Sequence[Pair], NestOptions], bool]
"""Whether pairs of parts are far enough apart, given the distances of all that are near."""


@dataclass(frozen=True, slots=True)
class Rules:
    """By what a move is judged."""

    patterns: Patterns
    options: NestOptions
    judge: Judge


def is_legal(table: Table, group: Collection[int], rules: Rules) -> bool:
    """Return whether the parts of a group keep their distance to all others, and lie where they may."""
    moved = [table.laid[number] for number in group]
    spread = Spread(table.ground, tuple(moved))
    return (
        not any(edge_findings(spread, edge_distances(spread)))
        and not any(zone_overlaps(spread))
        and _keep_apart(table, group, rules)
    )


def _keep_apart(table: Table, group: Collection[int], rules: Rules) -> bool:
    """Return whether the parts of a group keep the gap to others, but for common lines, and do not overlap them."""
    others = [number for number in range(len(table.laid)) if number not in group]
    pairs = list(near_pairs(table.laid, group, others, rules.options.gap_mm))
    local = sorted({number for pair in pairs for number in pair})
    if not pairs:
        return True
    some = [table.laid[number].region.outline for number in local]
    owner = np.repeat(np.array(local), [one.bulge.size for one in some])
    every = clearances(joined(some), owner, within=rules.options.gap_mm)
    crossing = [pair for pair in every if (pair[0] in group) != (pair[1] in group)]
    regions = [one.region for one in table.laid]
    return rules.judge(table, every, crossing, rules.options) and not any(
        overlap_mm2(regions[i], regions[j], every.get((min(i, j), max(i, j)), rules.options.gap_mm + REACH_MM))
        for i, j in near_pairs(table.laid, group, others, GAP_TOLERANCE_MM)
    )


def roughly_apart(table: Table, gaps: Gaps, pairs: Sequence[Pair], options: NestOptions) -> bool:
    """Return whether pairs under the gap are at least a kerf apart, and have a common line or both one with a third."""
    least = min(options.kerf_mm, options.gap_mm) - GAP_TOLERANCE_MM
    near = [pair for pair in pairs if gaps[pair] < options.gap_mm - GAP_TOLERANCE_MM]
    if any(gaps[pair] < least for pair in near):
        return False
    beside: dict[int, set[int]] = {}
    for i, j in gaps if near else ():
        if common_stretches(table.laid[i].region, table.laid[j].region, options.kerf_mm):
            beside.setdefault(i, {i}).add(j)
            beside.setdefault(j, {j}).add(i)
    return all(not beside.get(i, {i}).isdisjoint(beside.get(j, {j})) for i, j in near)


def apart_by_the_rules(table: Table, gaps: Gaps, pairs: Sequence[Pair], options: NestOptions) -> bool:
    """Return whether pairs keep the gap but for what their common lines excuse."""
    excused = without_common_lines([one.region for one in table.laid], gaps, options)
    return all(excused[pair] >= options.gap_mm - GAP_TOLERANCE_MM for pair in pairs)


def near_pairs(
    laid: Sequence[Laid], some: Collection[int], others: Sequence[int], reach_mm: float
) -> Iterator[tuple[int, int]]:
    """Yield the pairs of one part and another, by number, whose boxes are not farther apart than that."""
    if not others:
        return
    boxes = np.array([laid[number].region.box for number in others])
    for one in some:
        low_high = np.array(laid[one].region.box)
        apart = np.maximum(low_high[:2] - boxes[:, 2:], boxes[:, :2] - low_high[2:]).max(axis=1)
        yield from ((one, others[number]) for number in np.flatnonzero(apart <= reach_mm).tolist())
