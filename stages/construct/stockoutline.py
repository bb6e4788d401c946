"""Outlines of stock: closed curves of a job file as edges in the plane of the sheet.

The plane is z = constant, x and y are those of the sheet.  Ends that are nearer than `join_mm` are joined by a straight
edge.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from stages.construct.curves import Chain, chain
from stages.construct.plain import plane_edges
from stages.geometry.arrays import norm
from stages.geometry.curves.plane import PlaneCurve, Segment
from stages.geometry.paths.biarc import ZERO_LENGTH_MM
from stages.model.curves import CurveSpec


class NoContourError(ValueError):
    """A curve that is no closed contour in the plane of a sheet: what is wrong, and what would be right."""

    def __init__(self, message: str, hint: str) -> None:
        super().__init__(message)
        self.message, self.hint = message, hint


SAMPLES = 17
"""Points on each piece at which its height is looked at; lines and arcs, of which outlines are made, need three."""


def closed_edges(spec: CurveSpec, *, join_mm: float) -> tuple[PlaneCurve, ...]:
    """Return the edges of a closed curve, each beginning where the one before ends, to rounding; `NoContourError`."""
    link = chain(spec)
    height = _heights(link)
    if height > join_mm:
        raise NoContourError(f"the curve leaves the plane of the sheet by {height:.4g} mm", "draw it in x and y")
    edges = plane_edges(link, np.zeros(3), np.eye(3)[:2])
    return tuple(_joined(edges, join_mm))


def _heights(link: Chain) -> float:
    """Return the largest difference of heights on a curve, mm."""
    v = np.linspace(0.0, 1.0, SAMPLES)
    return float(np.ptp(np.concatenate([curve.jet(v, 0)[0][:, 2] for curve in link.curves])))


def _joined(edges: Sequence[PlaneCurve], join_mm: float) -> Iterator[PlaneCurve]:
    """Yield the edges, and a straight one wherever the next does not begin where one ends, rounding apart."""
    ends = np.array([0.0, 1.0])
    for i, edge in enumerate(edges):
        end, start = edge.at(ends)[1], edges[(i + 1) % len(edges)].at(ends)[0]
        gap = float(norm(start - end))
        if gap > join_mm:
            hint = "close the curve: let it end where it begins"
            raise NoContourError(f"the curve does not close: {gap:.4g} mm are missing", hint)
        yield edge
        if gap > ZERO_LENGTH_MM:
            yield Segment(end, start)
