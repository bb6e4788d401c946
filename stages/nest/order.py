"""In which order the parts of a sheet are cut: what lies in a hole before that hole, and short ways between the cuts.

The head begins at the lower left corner of the sheet, goes to the first vertex of each path and leaves it at the last
(of a closed one: where it began).  A part and all that lies in its holes are cut in one go, the innermost first, so the
rule for holes holds however the rest is ordered; among such groups, and within each, the way is a short tour
(`geometry.numeric.tour`).  BEND and ROLL lines are in the file and nobody cuts them: they do not count.

Limits: where a controller begins a full circle is its own affair, here it is the first vertex; lead-ins are not known.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import fsum

import numpy as np
from shapely import Point, Polygon, STRtree

from stages.geometry.arrays import Matrix, Points2, norm
from stages.geometry.curves.rigid import Rigid2, apply
from stages.geometry.numeric.tour import short_tour
from stages.geometry.paths.arcpath import ArcPath, area, bounds, polygon, transform
from stages.model.pattern import FlatPattern
from stages.model.report import Metric
from stages.model.sheet import Nesting, Placement, SheetLayout
from stages.model.strokes import strokes

LONGEST_TOUR = 1000
"""Groups in one tour: 0.4 s.  More are cut band after band, each of this many."""

BESIDE_MM = 0.01
"""How far the polygon of a hole may be off it; a part that touches the hole still lies in it."""

FOLLOWED = frozenset({"MARK", "CUT_SLIT", "CUT_INNER", "CUT_OUTER"})
"""The layers along which the head goes."""


@dataclass(frozen=True, slots=True)
class Cut:
    """A run of placements in the order they are cut: their places in the layout, where it begins and where it ends."""

    places: tuple[int, ...]
    first: tuple[float, float]
    last: tuple[float, float]


def in_cut_order(nesting: Nesting, patterns: Sequence[FlatPattern]) -> tuple[Nesting, tuple[Metric, ...]]:
    """Return the nest with the placements of every sheet in the order of cutting, and how far the head then travels.

    To compare with: `travel_listed_mm`, one part after the other as they are listed, copy by copy.
    """
    by_name = {pattern.part: pattern for pattern in patterns}
    listed = [as_listed(layout, by_name) for layout in nesting.layouts]
    made = [cut_order(layout, by_name) for layout in nesting.layouts]
    ways = {"travel_mm": made, "travel_listed_mm": listed}
    metrics = [
        Metric(name, fsum(travel(layout, by_name) for layout in way), "mm", "proved") for name, way in ways.items()
    ]
    return replace(nesting, layouts=tuple(made)), tuple(metrics)


def as_listed(layout: SheetLayout, patterns: Mapping[str, FlatPattern]) -> SheetLayout:
    """Return the layout with its placements in the order of the parts and their copies."""
    rank = {part: place for place, part in enumerate(patterns)}
    return replace(layout, placements=tuple(sorted(layout.placements, key=lambda one: (rank[one.part], one.copy))))


def cut_order(unordered: SheetLayout, patterns: Mapping[str, FlatPattern]) -> SheetLayout:
    """Return the layout with its placements in the order they are cut; whatever order they had does not matter."""
    layout = as_listed(unordered, patterns)
    cuts = [_cut(number, placed, patterns) for number, placed in enumerate(layout.placements)]
    within = holders([patterns[placed.part] for placed in layout.placements], layout.placements)
    children: dict[int | None, list[int]] = {}
    for number, holder in enumerate(within):
        children.setdefault(holder, []).append(number)
    groups = {number: cuts[number] for number in range(len(cuts))}
    for holder in sorted((one for one in children if one is not None), key=lambda one: -_depth(one, within)):
        inner = toured([groups[child] for child in children[holder]], None, cuts[holder].first)
        groups[holder] = joined([*inner, cuts[holder]])
    tops = [groups[number] for number in children.get(None, ())]
    places = [place for cut in in_bands(tops, _corner(layout)) for place in cut.places]
    return replace(layout, placements=tuple(layout.placements[place] for place in places))


def travel(layout: SheetLayout, patterns: Mapping[str, FlatPattern]) -> float:
    """Return how far the head goes without cutting, in mm, from the lower left corner to the last cut."""
    points = [np.array(_corner(layout))]
    for placed in layout.placements:
        points += _hops(patterns[placed.part], placed.motion)
    route = np.vstack(points)
    return float(norm(route[1::2] - route[:-1:2]).sum())


def holders(patterns: Sequence[FlatPattern], placements: Sequence[Placement]) -> list[int | None]:
    """Return in a hole of which placement each one lies: the smallest such hole; None for most."""
    owners = [number for number, pattern in enumerate(patterns) for _ in pattern.inner]
    holes = [
        Polygon(polygon(transform(contour.path, placed.motion), accuracy=BESIDE_MM))
        for pattern, placed in zip(patterns, placements, strict=True)
        for contour in pattern.inner
    ]
    tree = STRtree(holes)
    found: list[int | None] = []
    for number, (pattern, placed) in enumerate(zip(patterns, placements, strict=True)):
        vertex = Point(apply(placed.motion, pattern.outer.path.vertices[:1])[0])
        near = tree.query(vertex, predicate="dwithin", distance=2.0 * BESIDE_MM).tolist()
        # only a hole larger than the part: then no two parts ever hold each other
        around = [one for one in near if owners[one] != number and holes[one].area > abs(area(pattern.outer.path))]
        found.append(owners[min(around, key=lambda one: holes[one].area)] if around else None)
    return found


def toured(cuts: Sequence[Cut], begin: tuple[float, float] | None, end: tuple[float, float] | None) -> list[Cut]:
    """Return the cuts in an order that makes the way short, from a point and to a point if they are given."""
    firsts = np.array([cut.first for cut in cuts])
    lasts = np.array([cut.last for cut in cuts])
    cost = np.zeros((len(cuts) + 1, len(cuts) + 1))
    cost[1:, 1:] = _between(lasts, firsts)
    if begin is not None:
        cost[0, 1:] = norm(firsts - np.array(begin))
    if end is not None:
        cost[1:, 0] = norm(lasts - np.array(end))
    return [cuts[place - 1] for place in short_tour(cost)[1:].tolist()]


def in_bands(cuts: Sequence[Cut], begin: tuple[float, float]) -> list[Cut]:
    """Return any number of cuts in a short order from a point: upright bands from left to right, each toured."""
    across = sorted(cuts, key=lambda cut: cut.first)
    made: list[Cut] = []
    for start in range(0, len(across), LONGEST_TOUR):
        made += toured(across[start : start + LONGEST_TOUR], made[-1].last if made else begin, None)
    return made


def joined(cuts: Sequence[Cut]) -> Cut:
    """Return several cuts, one after the other, as one."""
    return Cut(tuple(place for cut in cuts for place in cut.places), cuts[0].first, cuts[-1].last)


def _between(starts: Points2, ends: Points2) -> Matrix:
    """Return the distance from each start to each end, as many of both."""
    distance: Matrix = np.hypot(starts[:, :1] - ends[:, 0], starts[:, 1:] - ends[:, 1])
    return distance


def _depth(number: int, within: Sequence[int | None]) -> int:
    """Return in how many parts a placement lies."""
    holder, depth = within[number], 0
    while holder is not None:
        holder, depth = within[holder], depth + 1
    return depth


def _cut(number: int, placed: Placement, patterns: Mapping[str, FlatPattern]) -> Cut:
    hops = _hops(patterns[placed.part], placed.motion)
    (x, y), (last_x, last_y) = hops[0][0].tolist(), hops[-1][1].tolist()
    return Cut((number,), (x, y), (last_x, last_y))


def _hops(pattern: FlatPattern, motion: Rigid2) -> list[Points2]:
    """Return where each path of a placed part is begun and left, in order, each of shape (2, 2)."""
    paths = [stroke.path for stroke in strokes(pattern) if stroke.layer in FOLLOWED]
    return [apply(motion, path.vertices[_ends(path, mirrored=motion.mirrored)]) for path in paths]


def _ends(path: ArcPath, *, mirrored: bool) -> list[int]:
    """Return at which vertices a path is begun and left; a mirrored one runs the other way."""
    first, last = (-1, 0) if mirrored else (0, -1)
    return [first, first if path.closed else last]


def _corner(layout: SheetLayout) -> tuple[float, float]:
    """Return the lower left corner of the sheet's box."""
    return (0.0, 0.0) if layout.sheet.outline is None else bounds(layout.sheet.outline)[:2]
