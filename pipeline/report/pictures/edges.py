"""What is asked of a flat pattern before it is drawn: its named edges, rulings, lengths and areas.

Lengths and areas are sums over a fixed number of Gauss nodes: six digits, for type beside a line; never for a report.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from pipeline.report.pictures.canvas import length_text
from stages.geometry.arrays import Array, Points2, Values, cross2, norm
from stages.geometry.curves.parallel import Parallel
from stages.geometry.curves.plane import PlaneCurve, Stretch
from stages.geometry.flat.flatmap import DevelopedEdge, DevelopedRuling, FlatPiece
from stages.geometry.paths import arcpath
from stages.geometry.paths.arcpath import ArcPath
from stages.model.pattern import FlatPattern

Sides = Mapping[str, tuple[PlaneCurve, ...]]


def sides(pattern: FlatPattern) -> Sides:
    """Return the edges called start, c1, end and c0 of a strip, in the order of its outline; none of a plate.

    Whole edges, also where a notch takes a bite out of one.
    """
    pieces = flat_pieces(pattern)
    if not pieces:
        return {}
    first, last = DevelopedRuling(pieces[0], 0.0), DevelopedRuling(pieces[-1], 1.0, reverse=True)
    there = tuple(DevelopedEdge(piece, 1.0) for piece in pieces)
    back = tuple(DevelopedEdge(piece, 0.0, reverse=True) for piece in pieces[::-1])
    return {"start": (first,), "c1": there, "end": (last,), "c0": back}


def flat_pieces(pattern: FlatPattern) -> list[FlatPiece]:
    """Return the pieces of the flat map in order, from the edges c0 and c1 of the outline; none for a plate."""
    edges = [edge for edge in map(_whole, pattern.outer.edges) if isinstance(edge, DevelopedEdge)]
    there = {id(edge.piece): edge.piece for edge in edges if not edge.reverse}
    back = {id(edge.piece): edge.piece for edge in edges if edge.reverse}
    found = list((there | back).values())
    # an allowance leaves edges without a length out, so that a piece with an apex may be on one side only
    return list(there.values()) if len(there) == len(found) else _chained(found)


def _chained(pieces: Sequence[FlatPiece]) -> list[FlatPiece]:
    """Return pieces so that each begins where the one before ends."""
    u, whole = np.array([0.0, 1.0]), np.ones(2)
    first, last = (np.stack([piece.positions(u, v * whole) for piece in pieces]) for v in (0.0, 1.0))
    apart = norm(last[:, None] - first[None]).sum(axis=2)
    np.fill_diagonal(apart, np.inf)
    at = int(np.argmax(apart.min(axis=0)))
    order = [at]
    while len(order) < len(pieces):
        apart[:, at] = np.inf
        at = int(np.argmin(apart[at]))
        order.append(at)
    return [pieces[i] for i in order]


def _whole(edge: PlaneCurve) -> PlaneCurve:
    """Return the edge of the flat map that an edge of a contour is a stretch or a parallel of."""
    while isinstance(edge, Stretch | Parallel):
        edge = edge.curve
    return edge


def rulings(pattern: FlatPattern, places: Sequence[float] | Array) -> list[Points2]:
    """Return the rulings at v, counted over the pieces, each by its two ends in mm."""
    pieces = flat_pieces(pattern)
    if not pieces:
        return []
    v = np.asarray(places, dtype=np.float64)
    whole = np.clip(np.floor(v).astype(np.int64), 0, len(pieces) - 1)
    made = np.zeros((v.size, 2, 2))
    for i, piece in enumerate(pieces):
        here = whole == i
        if here.any():
            local = np.clip(v[here] - i, 0.0, 1.0)
            made[here] = np.stack([piece.positions(np.full_like(local, u), local) for u in (0.0, 1.0)], axis=1)
    return list(made)


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
    middle = np.array([(low_x + high_x) / 2.0, (low_y + high_y) / 2.0])
    radius = (high_x - low_x + high_y - low_y) / 4.0
    off = norm(arcpath.polygon(path, accuracy=ROUND * radius / 4.0) - middle) - radius
    if np.abs(off).max() <= ROUND * radius:
        return f"\u2300{length_text(2.0 * radius)}"
    return f"{length_text(high_x - low_x)} \u00d7 {length_text(high_y - low_y)}"


ROUND = 1e-3
"""A hole whose points are as far from its middle but for this share looks like a circle: one drilled through a bent
sheet is one to the four digits that are written."""
