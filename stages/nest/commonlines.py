"""Neighbours moved together until straight edges of theirs are a kerf apart, so that one cut serves both.

Edges that face each other, parallel, over at least `LEAST_COMMON_MM` are tried, the nearest first: the part on one
side moves along their common normal until the kerf is left, and with it whatever is joined to it already or lies in its
holes.  That part is tried first that comes nearer to the lower left corner, so that what is left over grows.  A move
that the certifier's rules refuse, against any other part, the edge, a defect or a zone, is not made.

Limits: parts are moved, never turned; those that must stay do; a part in a hole is not joined to others there.  Where
the outcome of all moves in one direction is refused on a sheet of more than `FEW_PARTS`, none of them is made.
"""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from math import fsum

import numpy as np

from stages.geometry.arrays import Vector2, norm
from stages.geometry.paths.facing import Facing, Strip, facing
from stages.model.pattern import FlatPattern
from stages.model.report import Metric
from stages.model.sheet import Nesting, NestOptions, Placement, SheetLayout
from stages.nest.commonrules import (
    Join,
    Patterns,
    Rules,
    Table,
    apart_by_the_rules,
    is_legal,
    near_pairs,
    roughly_apart,
)
from stages.nest.legal.common import LEAST_COMMON_MM, common_stretches
from stages.nest.legal.gaps import between_copies
from stages.nest.legal.laid import Spread, ground, lay
from stages.nest.legal.region import GAP_TOLERANCE_MM
from stages.nest.order import holders

FAR_GAPS, FAR_MM = 3.0, 10.0
"""Edges farther apart than so many gaps and this much more are left where they are."""

ROUNDS = 6
"""How often all edges of a direction are looked for anew: parts that moved face others than before."""

FEW_PARTS = 150
"""Up to so many on a sheet each move is judged by the full rules where the quick way fails: some 10 s."""

DIRECTION_DECIMALS = 6
"""Of directions that are the same, in rad."""

Copy = tuple[str, int]
"""A part and the number of its copy."""


@dataclass(frozen=True, slots=True)
class Wish:
    """Two parts that might share a cut: the unit normal from the first to the second, and what is to be closed, mm."""

    first: int
    second: int
    normal: tuple[float, float]
    close_mm: float


def aligned(
    nesting: Nesting, patterns: Sequence[FlatPattern], options: NestOptions, held: Collection[Copy] = ()
) -> Nesting:
    """Return the nest with neighbours moved together, their straight edges a kerf apart; `held` copies stay."""
    by_name = {pattern.part: pattern for pattern in patterns}
    layouts = (_aligned(layout, by_name, options, held) for layout in nesting.layouts)
    return replace(nesting, layouts=tuple(layouts))


def common_line(nesting: Nesting, patterns: Sequence[FlatPattern], options: NestOptions) -> Metric:
    """Return the length of all edges that are cut with those of a neighbour, mm: what need not be cut twice."""
    by_name = {pattern.part: pattern for pattern in patterns}
    laid = [[lay(by_name[one.part], one) for one in layout.placements] for layout in nesting.layouts]
    total = fsum(
        float(norm(stretch.on_first[1] - stretch.on_first[0]))
        for sheet in laid
        for i in range(len(sheet))
        for _, j in near_pairs(sheet, [i], range(i + 1, len(sheet)), options.kerf_mm + GAP_TOLERANCE_MM)
        for stretch in common_stretches(sheet[i].region, sheet[j].region, options.kerf_mm)
    )
    return Metric("common_line_mm", total, "mm", "proved")


def _aligned(layout: SheetLayout, patterns: Patterns, options: NestOptions, held: Collection[Copy]) -> SheetLayout:
    """Return a layout with neighbours moved together, in one direction after the other."""
    table = _table(layout, patterns, held)
    pairs = _pairs(table, options)
    for direction in dict.fromkeys(_direction(normal) for normal in pairs.outward):
        table = _closed_up(table, direction, patterns, options)
    return replace(layout, placements=table.placements)


def _closed_up(table: Table, direction: float, patterns: Patterns, options: NestOptions) -> Table:
    """Return the parts after all moves in one direction, as they were if the certifier's rules refuse the outcome.

    First each move is judged by the gaps alone; where the outcome is refused, by the full rules (`legal.common`).
    """
    judges = (roughly_apart,) if len(table.laid) > FEW_PARTS else (roughly_apart, apart_by_the_rules)
    for judge in judges:
        made = table
        for _ in range(ROUNDS):
            after = _round(made, direction, Rules(patterns, options, judge))
            settled = len(after.joins) == len(made.joins)
            made = after
            if settled:
                break
        if not between_copies(Spread(made.ground, made.laid), options).findings:
            return made
    return table


def _pairs(table: Table, options: NestOptions) -> Facing:
    """Return the edges of different parts that face each other."""
    strip = Strip(FAR_GAPS * options.gap_mm + FAR_MM, GAP_TOLERANCE_MM / 2.0, LEAST_COMMON_MM)
    return facing([one.region.contours[0] for one in table.laid], strip)


def _direction(normal: Vector2) -> float:
    """Return the direction of a normal, either way, in rad, rounded."""
    return round(float(np.arctan2(normal[1], normal[0])) % np.pi, DIRECTION_DECIMALS) % np.pi


def _table(layout: SheetLayout, patterns: Patterns, held: Collection[Copy]) -> Table:
    """Return a layout as it is before anything moves: what lies in a hole moves with the part around it."""
    own = [patterns[one.part] for one in layout.placements]
    within = holders(own, layout.placements)
    joins = tuple(Join(number, holder, None) for number, holder in enumerate(within) if holder is not None)
    kept = (number for number, one in enumerate(layout.placements) if one.fixed or (one.part, one.copy) in held)
    laid = tuple(lay(pattern, one) for pattern, one in zip(own, layout.placements, strict=True))
    return Table(ground(layout), layout.placements, laid, frozenset(kept), joins)


def _round(table: Table, direction: float, rules: Rules) -> Table:
    """Return the parts after every pair of edges that face each other that way has been tried, the nearest first."""
    pairs = _pairs(table, rules.options)
    before = table.placements
    for pair in np.argsort(pairs.apart, kind="stable").tolist():
        if _direction(pairs.outward[pair]) != direction:
            continue
        first, second = pairs.path[pair].tolist()
        normal = pairs.outward[pair]
        shift = _shift(before[second], table.placements[second]) - _shift(before[first], table.placements[first])
        close = float(pairs.apart[pair] + normal @ shift) - rules.options.kerf_mm
        x, y = normal.tolist()
        table = _tried(table, Wish(first, second, (x, y), close), rules)
    return table


def _shift(before: Placement, after: Placement) -> Vector2:
    return np.array([after.motion.x - before.motion.x, after.motion.y - before.motion.y])


def _tried(table: Table, wish: Wish, rules: Rules) -> Table:
    """Return the parts with one of two moved towards the other until the kerf is left; as they were if neither may.

    Two that are the kerf apart already are joined without a move.
    """
    join = Join(wish.first, wish.second, wish.normal)
    way = wish.close_mm * np.array(wish.normal)
    joined_up = replace(table, joins=(*table.joins, join))
    if wish.close_mm <= GAP_TOLERANCE_MM:
        return joined_up if join not in table.joins and _hold(joined_up, [join], rules.options) else table
    for group, move in _groups(table, wish, way):
        moved = _moved(joined_up, group, move, rules.patterns)
        loose = [one for one in moved.joins if (one.first in group) != (one.second in group)]
        if _hold(moved, loose, rules.options) and is_legal(moved, group, rules):
            return moved
    return table


def _groups(table: Table, wish: Wish, way: Vector2) -> Iterator[tuple[set[int], Vector2]]:
    """Yield which parts may be moved, and how: all that are joined; or those that do not slide, and others stay."""
    ways = sorted(((wish.first, way), (wish.second, -way)), key=lambda one: float(one[1].sum()))
    for slides in (False, True):
        for mover, move in ways:
            group = _together(table, mover, move if slides else None)
            if not {wish.first, wish.second} <= group and table.held.isdisjoint(group):
                yield group, move


def _together(table: Table, mover: int, way: Vector2 | None) -> set[int]:
    """Return the parts that move with one if it moves that way; None: all that are joined to it."""
    beside: dict[int, list[int]] = {}
    for join in table.joins:
        if way is None or join.binds(way):
            beside.setdefault(join.first, []).append(join.second)
            beside.setdefault(join.second, []).append(join.first)
    group, fresh = {mover}, [mover]
    while fresh:
        fresh = [other for one in fresh for other in beside.get(one, ()) if other not in group]
        group.update(fresh)
    return group


def _hold(table: Table, joins: Sequence[Join], options: NestOptions) -> bool:
    """Return whether parts that are joined along a line still are."""
    regions = [one.region for one in table.laid]
    lines = [(one.first, one.second) for one in joins if one.normal is not None]
    return all(common_stretches(regions[first], regions[second], options.kerf_mm) for first, second in lines)


def _moved(table: Table, group: Collection[int], way: Vector2, patterns: Patterns) -> Table:
    """Return the parts with those of a group moved."""
    placements, laid = list(table.placements), list(table.laid)
    for number in group:
        motion = placements[number].motion
        there = motion.replace(x=motion.x + float(way[0]), y=motion.y + float(way[1]))
        placements[number] = replace(placements[number], motion=there)
        laid[number] = lay(patterns[placements[number].part], placements[number])
    return replace(table, placements=tuple(placements), laid=tuple(laid))
