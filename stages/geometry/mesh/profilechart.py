"""A chain of legs and bends along rulings, in the plane: x along the rulings, y along the chain, mm.

Patches follow each other along the chain; v counts them.  On a straight patch v is proportional to y; on a bend it is
the parameter of a rational quadratic arc with equal weights at its ends, 2 v - 1 = tan(phi / 2) / tan(alpha / 2) with
phi from the middle of the arc and alpha half its angle [1]_.

.. [1] G. Farin, "Curves and Surfaces for CAGD", 5th ed., sec. 13.7: stereographic projection of the arc.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from stages.geometry.arrays import Array, ArrayValue, Indices, Points2, Values, Vector2
from stages.geometry.curves.plane import PlaneCurve, Segment, stretch
from stages.geometry.mesh.chart import Pulled


@dataclass(frozen=True, slots=True, eq=False)
class ChainChart(ArrayValue):
    """The flat strip of a chain.

    heights: x of both ends of the rulings.  knots: y at the ends of the patches.
    halves: half the angle of each patch, rad; 0 of a straight one.
    """

    heights: Vector2
    knots: Array
    halves: Array

    def places(self, points: Points2) -> Points2:
        """Return u and v of flat points."""
        index, share, _ = self._within(points[:, 1])
        angle, half = (2.0 * share - 1.0) * self.halves[index], self.halves[index]
        bent = half > 0.0
        ratio = np.divide(np.tan(angle / 2.0), np.tan(half / 2.0), out=2.0 * share - 1.0, where=bent)
        u = (points[:, 0] - self.heights[0]) / (self.heights[1] - self.heights[0])
        placed: Points2 = np.column_stack([u, index + (1.0 + ratio) / 2.0])
        return placed

    def rates(self, points: Points2, slopes: Points2) -> Points2:
        """Return the rates of u and v at flat points that move."""
        index, share, width = self._within(points[:, 1])
        angle, half = (2.0 * share - 1.0) * self.halves[index], self.halves[index]
        faster = np.ones(share.size)
        np.divide(half, 2.0 * np.tan(half / 2.0) * np.cos(angle / 2.0) ** 2, out=faster, where=half > 0.0)
        moving: Points2 = np.column_stack(
            [slopes[:, 0] / (self.heights[1] - self.heights[0]), slopes[:, 1] * faster / width]
        )
        return moving

    def _within(self, y: Values) -> tuple[Indices, Values, Values]:
        """Return the patch of each y (a whole number), its share of the way across it, and the patch's width."""
        index = np.clip(np.searchsorted(self.knots, y, side="right") - 1, 0, self.knots.size - 2)
        width = np.diff(self.knots)[index]
        return index, (y - self.knots[index]) / width, width


def pulled(chart: ChainChart, edges: Sequence[PlaneCurve]) -> tuple[PlaneCurve, ...]:
    """Return a closed loop of the plane in u and v; what is straight there too, patch by patch, as segments."""
    made: list[PlaneCurve] = []
    for edge in edges:
        made += _patchwise(chart, edge) if isinstance(edge, Segment) else [Pulled(chart, edge)]
    return tuple(made)


def _patchwise(chart: ChainChart, edge: Segment) -> list[PlaneCurve]:
    """Return a straight edge in u and v, cut where it passes from one patch to the next."""
    rise = edge.end[1] - edge.start[1]
    if abs(rise) <= LEVEL * (chart.knots[-1] - chart.knots[0]):
        return [_placed(chart, edge, float((edge.start[1] + edge.end[1]) / 2.0))]
    inner = (chart.knots[1:-1] - edge.start[1]) / rise
    stops = [0.0, *np.sort(inner[(inner > LEVEL) & (inner < 1.0 - LEVEL)]).tolist(), 1.0]
    cuts = [stretch(edge, low, high) for low, high in pairwise(stops)]
    return [_placed(chart, cut, float(cut.at(np.array([0.5]))[0, 1])) for cut in cuts if isinstance(cut, Segment)]


LEVEL = 1e-9
"""Share of a length: an edge along a ruling to rounding, and one that ends on a knot."""


def _placed(chart: ChainChart, edge: Segment, y: float) -> PlaneCurve:
    """Return a straight edge on one patch, that at y, in u and v."""
    i = int(np.clip(np.searchsorted(chart.knots, y, side="right") - 1, 0, chart.knots.size - 2))
    ends = np.array([edge.start, edge.end])
    on_patch = np.clip(ends[:, 1], chart.knots[i], chart.knots[i + 1])
    v = np.clip(chart.places(np.column_stack([ends[:, 0], on_patch]))[:, 1], i, i + 1.0)
    u = chart.places(ends)[:, 0]
    straight = chart.halves[i] == 0.0 or abs(np.ptp(ends[:, 1])) == 0.0 or abs(np.ptp(u)) <= LEVEL
    return Segment(np.array([u[0], v[0]]), np.array([u[1], v[1]])) if straight else Pulled(chart, edge)
