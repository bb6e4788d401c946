"""Ways of a cutter onto a path and off it, on the right of the path, where its waste is; and whether they are free.

A straight one stands at an angle to the path.  An arc touches the path, its centre on the right.  A way is free where
it keeps its distance, in closed form, from all other contours, and touches its own at its end alone.
"""

from collections.abc import Sequence

import numpy as np
from shapely import STRtree, box

from stages.geometry.arcpath import ArcPath, backwards, bounds
from stages.geometry.arrays import Vector2
from stages.geometry.clearance import Pieces, clearance, pieces, point_distances
from stages.geometry.pathparts import part

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
    """Contours of one sheet, found by their boxes."""

    def __init__(self, paths: Sequence[ArcPath]) -> None:
        self.some: list[Pieces] = [pieces(path) for path in paths]
        self.tree = STRtree([box(*bounds(path)) for path in paths])

    def room(self, lead: ArcPath, own: int, within: float) -> float:
        """Return how near a way comes to any but its own contour, mm; infinite beyond `within`."""
        low_x, low_y, high_x, high_y = bounds(lead)
        near = self.tree.query(box(low_x - within, low_y - within, high_x + within, high_y + within)).tolist()
        way = pieces(lead)
        return min((clearance(way, self.some[one], within=within) for one in near if one != own), default=np.inf)

    def is_free(self, lead: ArcPath, least: float) -> bool:
        """Return whether a way is off the contour that its end lies on, and farther than `least` mm from all others."""
        low_x, low_y, high_x, high_y = bounds(lead)
        near = self.tree.query(box(low_x - least, low_y - least, high_x + least, high_y + least)).tolist()
        own = [one for one in near if self._holds(one, lead.vertices[-1])]
        away = (clearance(pieces(lead), self.some[one], within=2.0 * least) for one in near if one not in own)
        return all(self.leaves(lead, one) for one in own) and all(one > least for one in away)

    def _holds(self, number: int, point: Vector2) -> bool:
        """Return whether a contour goes through a point."""
        some = self.some[number]
        away = point_distances(np.broadcast_to(point, some.start.shape).copy(), some)
        return float(away.min()) <= ON_MM

    def leaves(self, lead: ArcPath, own: int) -> bool:
        """Return whether a way, which ends on its own contour, is off it everywhere else."""
        return clearance(pieces(_without_end(lead)), self.some[own], within=APART_MM) > APART_MM


def _without_end(lead: ArcPath) -> ArcPath:
    """Return a way of one piece without what is next to the contour."""
    closed = ArcPath(lead.vertices, lead.bulges, closed=True)
    return part(closed, 0.0, 1.0 - FREE_SHARE)
