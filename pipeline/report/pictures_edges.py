"""What is asked of a flat pattern before it is drawn: its named edges, rulings, lengths and areas.

Lengths and areas are sums over a fixed number of Gauss nodes: six digits, for type beside a line; never for a report.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from pipeline.report.pictures_canvas import length_text
from stages.geometry import arcpath
from stages.geometry.arcpath import ArcPath
from stages.geometry.arrays import Array, Points2, Values, cross2, norm
from stages.geometry.flatmap import DevelopedEdge
from stages.geometry.plane import PlaneCurve
from stages.model.pattern import FlatPattern

Sides = Mapping[str, tuple[PlaneCurve, ...]]


def sides(pattern: FlatPattern) -> Sides:
    """Return the edges called start, c1, end and c0 of a strip, in the order of its outline; none of a plate."""
    edges = pattern.outer.edges
    there = tuple(edge for edge in edges if isinstance(edge, DevelopedEdge) and not edge.reverse)
    back = tuple(edge for edge in edges if isinstance(edge, DevelopedEdge) and edge.reverse)
    rest = [edge for edge in edges if not isinstance(edge, DevelopedEdge)]
    if not there or len(there) != len(back) or len(rest) != len(("start", "end")):
        return {}
    return {"start": (rest[0],), "c1": there, "end": (rest[1],), "c0": back}


def rulings(pattern: FlatPattern, places: Sequence[float] | Array) -> list[Points2]:
    """Return the rulings at v, counted over the pieces, each by its two ends in mm."""
    pieces = [edge.piece for edge in sides(pattern).get("c1", ()) if isinstance(edge, DevelopedEdge)]
    if not pieces:
        return []
    whole = np.clip(np.floor(places).astype(np.int64), 0, len(pieces) - 1)
    ends = np.array([0.0, 1.0])
    return [
        pieces[i].positions(ends, np.full(2, min(max(float(v) - i, 0.0), 1.0)))
        for i, v in zip(whole.tolist(), places, strict=True)
    ]


def corner_points(pattern: FlatPattern) -> Points2:
    """Return the corners of the exact box about the outline, mm."""
    low_x, low_y, high_x, high_y = arcpath.bounds(pattern.outer.path)
    return np.array([[low_x, low_y], [high_x, high_y]])


def side_length(edges: Sequence[PlaneCurve]) -> float:
    """Return the length of some edges, mm; to six digits, cusps included, and of an apex too."""
    t, weights = gauss_panels()
    return float(sum(weights @ norm(edge.derivative(t)) for edge in edges))


def side_area(edges: Sequence[PlaneCurve]) -> float:
    """Return the signed area inside closed edges, mm2; to six digits."""
    t, weights = gauss_panels()
    return float(sum(weights @ cross2(edge.at(t), edge.derivative(t)) for edge in edges)) / 2.0


def gauss_panels() -> tuple[Values, Values]:
    """Return nodes and weights of 8 panels of 16 Gauss nodes on [0, 1]."""
    x, w = np.polynomial.legendre.leggauss(16)
    panels = 8
    t = (np.arange(panels)[:, None] + (x + 1.0) / 2.0) / panels
    return t.ravel(), np.tile(w / (2.0 * panels), panels)


def hole_text(path: ArcPath) -> str:
    """Return a diameter if the hole is a circle, else width x height, mm."""
    low_x, low_y, high_x, high_y = arcpath.bounds(path)
    radii = arcpath.radii(path)
    middle = np.array([(low_x + high_x) / 2.0, (low_y + high_y) / 2.0])
    off = norm(path.vertices - middle) - radii
    if np.isfinite(radii).all() and np.abs(off).max() <= ROUND * radii.max() and np.ptp(radii) <= ROUND * radii.max():
        return f"\u2300{length_text(2.0 * float(radii.max()))}"
    return f"{length_text(high_x - low_x)} \u00d7 {length_text(high_y - low_y)}"


ROUND = 1e-3
"""Arcs whose radii and centres differ by less, relative to the radius, look like one circle: a hole drilled through a
bent sheet is one to the four digits that are written."""
