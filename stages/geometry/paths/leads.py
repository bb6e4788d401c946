"""Ways of a cutter onto a path and off it, on the right of the path, where its waste is; and whether they are free.

A straight one stands at an angle to the path.  An arc touches the path, its centre on the right.  A way is free where
it keeps its distance, in closed form, from all other contours, touches its own at its end alone, and comes from its
waste: in the corner of a hole a round one would come through the part.
"""

from collections.abc import Sequence

import numpy as np
from shapely import STRtree, box

from stages.geometry.arrays import Array, Mask, Numbers, Points2, Values, Vector2
from stages.geometry.paths import arcs
from stages.geometry.paths.arcpath import ArcPath, backwards
from stages.geometry.paths.clearance import Pieces, between, boxes, distances, point_distances
from stages.geometry.paths.enclosed import inside_own
from stages.geometry.paths.manypaths import areas, pieces, row

FREE_SHARE = 0.02
"""Of a way from its end on the contour: an arc through 90 degrees is 5e-4 of its radius from the contour by then."""

APART_MM = 1e-6
"""Nearer is touching; for the end of a way, which is on the contour, see `FREE_SHARE`."""


def straight(at: Vector2, direction: float, length: float, angle: float) -> ArcPath:
    """Return the line that arrives at a point of a path at `angle` (rad) to its direction, from the right."""
    arriving = direction + angle
    begin = at - length * np.array([np.cos(arriving), np.sin(arriving)])
    return ArcPath(np.stack([begin, at]), np.zeros(2), closed=False)


def round_in(at: Vector2, direction: float, radius: float, angle: float) -> ArcPath:
    """Return the arc through `angle` (rad) that arrives at a point of a path along its direction, from the right."""
    centre = at + radius * np.array([np.sin(direction), -np.cos(direction)])
    towards = direction + np.pi / 2.0 + angle
    begin = centre + radius * np.array([np.cos(towards), np.sin(towards)])
    return ArcPath(np.stack([begin, at]), np.array([-np.tan(angle / 4.0), 0.0]), closed=False)


def off(lead: ArcPath, at: Vector2, direction: float) -> ArcPath:
    """Return the mirror image of a way onto a path, across its normal: the way off it."""
    along = np.array([np.cos(direction), np.sin(direction)])
    offset = lead.vertices - at
    mirrored = lead.vertices - 2.0 * np.outer(offset @ along, along)
    return backwards(ArcPath(mirrored, -lead.bulges, closed=False))


ON_MM = 2e-6
"""A contour that was put together from a file goes through the end of a way as well as this."""


class Obstacles:
    """Contours of one sheet, their pieces found by their boxes.  Many ways are judged at once."""

    def __init__(self, paths: Sequence[ArcPath]) -> None:
        self.closed = np.array([path.closed for path in paths], dtype=bool)
        self.hollow = np.zeros(len(paths), dtype=bool)
        self.hollow[self.closed] = areas([path for path in paths if path.closed]) < 0.0
        self.every, self.owner = pieces(paths)
        self.tree = STRtree(box(*boxes(self.every).T))

    def rooms(self, ways: Sequence[ArcPath], own: Numbers, within: Values) -> Values:
        """Return how near each way comes to any but its own contour, mm; infinite beyond its `within`."""
        some, number = _pieces(ways)
        one, other = self._near(some, within[number])
        foreign = self.owner[other] != own[number[one]]
        found = _least(self._distances(some, one[foreign], other[foreign]), number[one[foreign]], len(ways))
        return np.where(found <= within, found, np.inf)

    def leave(self, ways: Sequence[ArcPath], own: Numbers) -> Mask:
        """Return which ways, each ending on its own contour, are off it everywhere else, on the side of its waste."""
        some, number = _without_ends(ways)
        one, other = self._near(some, np.full(number.size, APART_MM))
        same = self.owner[other] == own[number[one]]
        left: Mask = _least(self._distances(some, one[same], other[same]), number[one[same]], len(ways)) > APART_MM
        left &= self._wasted(np.array([way.vertices[0] for way in ways]).reshape(-1, 2), own)
        return left

    def _wasted(self, points: Points2, own: Numbers) -> Mask:
        """Return which points are in the waste of their contour: in a hole, which runs clockwise, or off an outline."""
        wasted: Mask = (inside_own(points, own, self.every, self.owner) == self.hollow[own]) | ~self.closed[own]
        return wasted

    def are_free(self, ways: Sequence[ArcPath], least: float) -> Mask:
        """Return which ways are off the contours that their ends lie on, and over `least` mm from all others."""
        some, number = _pieces(ways)
        one, other = self._near(some, np.full(number.size, least))
        way = number[one]
        ends = np.array([path.vertices[-1] for path in ways]).reshape(-1, 2)
        contours = self.owner.size + 1
        contour = way * contours + self.owner[other]
        own = np.unique(contour[point_distances(ends[way], self.every.take(other)) <= ON_MM])
        away = ~np.isin(contour, own)
        free: Mask = _least(self._distances(some, one[away], other[away]), way[away], len(ways)) > least
        leaving, owner = np.divmod(own, contours)
        free[leaving[~self.leave([ways[place] for place in leaving], owner)]] = False
        return free

    def _near(self, some: Pieces, within: Values) -> tuple[Numbers, Numbers]:
        """Return pairs of a piece of a way and one of a contour whose boxes are not farther apart than `within`."""
        low_high = boxes(some)
        low, high = low_high[:, :2] - within[:, None], low_high[:, 2:] + within[:, None]
        one, other = self.tree.query(box(*low.T, *high.T))
        return one.astype(np.int64), other.astype(np.int64)

    def _distances(self, some: Pieces, one: Numbers, other: Numbers) -> Values:
        return distances(some.take(one), self.every.take(other))


def _pieces(ways: Sequence[ArcPath]) -> tuple[Pieces, Numbers]:
    """Return the pieces of open paths, and the number of the path that each belongs to."""
    every = row(ways)
    return between(every.start, every.end, every.bulge), every.owner


def _least(values: Array, number: Numbers, count: int) -> Array:
    """Return the smallest of the values of each number; infinite where there is none."""
    found: Array = np.full(count, np.inf)
    np.minimum.at(found, number, values)
    return found


def _without_ends(ways: Sequence[ArcPath]) -> tuple[Pieces, Numbers]:
    """Return the pieces of open paths, and the number of each piece's path, without what is next to their ends."""
    some, number = _pieces(ways)
    last, share = np.flatnonzero(np.diff(number, append=-1)), 1.0 - FREE_SHARE
    ends, bulges, sweep = some.end.copy(), some.bulge.copy(), arcs.sweeps(some.bulge[last])
    ends[last] = arcs.between(some.start[last], some.end[last], sweep, np.full(last.size, share))
    bulges[last] = np.tan(np.arctan(bulges[last]) * share)
    return between(some.start, ends, bulges), number
