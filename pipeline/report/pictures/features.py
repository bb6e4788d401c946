"""Holes, marks and bend lines on the formed surface, carried there from the flat pattern.

A point of the pattern is looked up between two flat rulings of the net and placed between the same two in space: exact
along rulings, off by the sagitta of one quad across them.  Good for a picture only.

A hole is a white patch as near to the viewer as the nearest quad in it; what lies behind it is not shown.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.report.pictures.canvas import INK, PURPLE
from pipeline.report.pictures.edges import flat_pieces
from pipeline.report.pictures.net import Net
from stages.geometry.arrays import Array, Points2, Points3, cross2, norm
from stages.geometry.paths import arcpath
from stages.geometry.paths.arcpath import ArcPath
from stages.model.pattern import FlatPattern

STEPS = 60
"""Pieces of a line as long as the part: each is hidden or shown as a whole."""

HOLE_WIDTH, MARK_WIDTH, BEND_WIDTH = 0.9, 0.8, 0.7


@dataclass(frozen=True, slots=True)
class Drawn:
    """A line on the formed surface: points (mm), and where they lie in the net, as row and column; closed: a hole."""

    points: Points3
    places: Points2
    colour: str
    width: float
    closed: bool


def drawn_on(shape: Net, pattern: FlatPattern) -> list[Drawn]:
    """Return marks, bend lines, then holes as they lie on the surface; none where net and pattern do not correspond."""
    lines = []
    for mark in pattern.marks:
        bend = mark.layer.startswith("BEND")
        lines.append((mark.path, PURPLE if bend else INK, BEND_WIDTH if bend else MARK_WIDTH, False))
    lines += [(hole.path, INK, HOLE_WIDTH, True) for hole in pattern.inner]
    flat = flat_net(shape, pattern)
    if flat is None or not lines:
        return []
    step = float(norm(np.ptp(flat, axis=(0, 1)))) / STEPS
    points = [sampled(path, step) for path, *_ in lines]
    found = looked_up(shape, flat, np.concatenate(points))
    ends = np.cumsum([len(one) for one in points])[:-1]
    return [
        Drawn(place[:, :3], place[:, 3:], colour, width, closed)
        for place, (_, colour, width, closed) in zip(np.split(found, ends), lines, strict=True)
    ]


def flat_net(shape: Net, pattern: FlatPattern) -> Array | None:
    """Return the flat images of the net's points, shape (n, m, 2), mm."""
    pieces = flat_pieces(pattern)
    patch = np.concatenate([[0], np.cumsum(~shape.joined)])
    if len(pieces) != patch[-1] + 1:
        return None
    u = np.linspace(0.0, 1.0, shape.points.shape[1])
    flat = np.zeros((*shape.points.shape[:2], 2))
    for i, piece in enumerate(pieces):
        local = np.clip(shape.v[patch == i] - i, 0.0, 1.0)
        grid = piece.positions(np.tile(u, local.size), np.repeat(local, u.size))
        flat[patch == i] = grid.reshape(local.size, u.size, 2)
    return flat


def looked_up(shape: Net, flat: Array, points: Points2) -> Array:
    """Return x, y, z and the row and column in the net of points of the pattern, shape (k, 5)."""
    blocks = [points[first : first + AT_ONCE] for first in range(0, len(points), AT_ONCE)]
    return np.concatenate([_looked_up(shape, flat, block) for block in blocks])


AT_ONCE = 2000
"""Points that are held against all rulings together: a few MB."""


def _looked_up(shape: Net, flat: Array, points: Points2) -> Array:
    start, ruling = flat[:, 0], flat[:, -1] - flat[:, 0]
    away = points[:, None] - start[None]
    reach = np.maximum(np.sum(ruling**2, axis=1), np.finfo(float).tiny)
    u, side = np.sum(away * ruling, axis=2) / reach, cross2(ruling, away) / np.sqrt(reach)
    here, there = side[:, :-1], side[:, 1:]
    between = (here * there <= 0.0) & shape.joined
    # a point on an edge or an end may lie off the net, whose edges are chords: then the nearest strip
    beyond = np.maximum(np.maximum(np.abs(u[:, :-1] - HALF), np.abs(u[:, 1:] - HALF)) - HALF, 0.0)
    astray = np.where(between, 0.0, np.minimum(np.abs(here), np.abs(there)) + OUTSIDE * np.sqrt(reach.max()))
    astray = astray + np.sqrt(reach.max()) * (OVER * beyond + np.maximum(beyond - SLACK, 0.0))
    row = np.argmin(np.where(shape.joined, astray, np.inf), axis=1)
    k = np.arange(len(points))
    gap = np.abs(side[k, row]) + np.abs(side[k, row + 1])
    share = np.abs(side[k, row]) / np.maximum(gap, np.finfo(float).tiny)
    across = [np.clip(u[k, i], 0.0, 1.0)[:, None] for i in (row, row + 1)]
    ends = [
        shape.points[i, 0] + t * (shape.points[i, -1] - shape.points[i, 0])
        for i, t in zip((row, row + 1), across, strict=True)
    ]
    placed = ends[0] + share[:, None] * (ends[1] - ends[0])
    column = across[0] * (flat.shape[1] - 1)
    return np.concatenate([placed, (row + share)[:, None], column], axis=1)


HALF = 0.5
"""u at the middle of a ruling."""
SLACK, OVER = 0.05, 1e-3
"""How far beyond the ends of rulings a point may lie, as a share of them, and what that costs: edges are no chords."""
OUTSIDE = 1e-4
"""What it costs not to lie between two rulings, as a share of the longest: more than lying a little beyond them."""


def sampled(path: ArcPath, step: float) -> Points2:
    """Return points along a path, no farther apart than `step`, the first repeated if it is closed; mm."""
    corners = arcpath.polygon(path, accuracy=step / STEPS) if path.bulges.any() else path.vertices
    if path.closed:
        corners = np.vstack([corners, corners[:1]])
    counts = np.ceil(norm(np.diff(corners, axis=0)) / step).astype(np.int64).clip(1)
    pieces: Sequence[Points2] = [
        a + np.linspace(0.0, 1.0, count, endpoint=False)[:, None] * (b - a)
        for a, b, count in zip(corners[:-1], corners[1:], counts.tolist(), strict=True)
    ]
    return np.concatenate([*pieces, corners[-1:]])
