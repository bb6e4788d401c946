"""A formed surface as it looks: shaded, with its rulings, seen along a direction that shows much of it.

The surface is cut into quads along its rulings, projected in parallel and painted from back to front.  A line on the
surface is cut at the same places, and each piece is painted right after the quads that it borders: hidden lines vanish
without a depth buffer.  Exact for surfaces without self-intersection whose quads are small beside their distance;
elsewhere a piece may show that should not.

The light side is the one from which the flat pattern is seen (that of p x c0'); the other is sand-coloured.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.report.pictures.canvas import (
    BLUE,
    GREEN,
    GREY,
    INK,
    PURPLE,
    VERMILLION,
    Box,
    Canvas,
    Fit,
    arrow,
    caption,
    fitted,
    scale_bar,
    size_text,
)
from pipeline.report.pictures.features import Drawn
from pipeline.report.pictures.names import write_names
from pipeline.report.pictures.net import Net, normals
from pipeline.report.shades import BACK_RGB, FRONT_RGB, LIGHT
from stages.geometry.arrays import Array, Indices, Points2, Points3, Values, Vector3, norm, unit

SHADE = 0.32
"""How much darker a face is that the light does not meet."""

COLOURS = {"c0": BLUE, "c1": VERMILLION, "start": GREEN, "end": "#555555"}
"""Of the four edges, the same in space and flat."""

EDGE_WIDTH, RULING_WIDTH, WORST_WIDTH, RIM_WIDTH, SEAM_WIDTH = 2.2, 0.5, 2.6, 0.9, 0.4


@dataclass(frozen=True, slots=True)
class Painting:
    """Things to be painted: corners in the picture's frame (k, any, 3), depth of each, fill, edge and width."""

    corners: Array
    depth: Values
    fill: Array
    edge: Array
    width: float


def paintings(shape: Net, frame: Points3, features: Sequence[Drawn] = ()) -> tuple[list[Painting], list[Painting]]:
    """Return the faces with what is drawn on them, and the edges, in the frame of the picture, mm."""
    placed = shape.points @ frame.T
    turned = normals(shape) @ frame.T
    depth = (placed[1:, 1:, 2] + placed[:-1, :-1, 2] + placed[1:, :-1, 2] + placed[:-1, 1:, 2]) / 4.0
    depth[~shape.joined] = -np.inf
    near = _nearest(depth)
    along = np.concatenate([near[:1], np.maximum(near[1:], near[:-1]), near[-1:]])
    first, last = np.zeros(1, dtype=np.int64), np.full(1, shape.v.size - 1)
    bent = any(one.colour == PURPLE for one in features)
    faces = [
        _quads(shape, placed, turned, depth),
        # bend lines lie along rulings: both would be too many lines
        _across(placed, along, shape.rulings[:0] if bent else shape.rulings, GREY, RULING_WIDTH),
        *(painting for one in features for painting in _feature(one, frame, near)),
        _across(placed, along + RIM_LIFT * np.ptp(placed[..., 2]), _rims(shape, turned), INK, RIM_WIDTH),
    ]
    edges = [
        _along(shape, placed[:, 0], near[:, 0], COLOURS["c0"]),
        _along(shape, placed[:, -1], near[:, -1], COLOURS["c1"]),
        _across(placed, along, last, COLOURS["end"], EDGE_WIDTH),
        _across(placed, along, first, COLOURS["start"], EDGE_WIDTH),
    ]
    worst = [] if shape.worst is None else [np.array([shape.worst])]
    return faces, edges + [_across(placed, along, index, PURPLE, WORST_WIDTH) for index in worst]


def _feature(one: Drawn, frame: Points3, near: Array) -> list[Painting]:
    """Return a line as pieces, each as near as the quads about it; a hole as a whole, as near as any quad in it."""
    placed = one.points @ frame.T
    rows, columns = (np.clip(one.places[:, k].astype(np.int64), 0, near.shape[k] - 1) for k in (0, 1))
    pieces = np.stack([placed[:-1], placed[1:]], axis=1)
    if not one.closed:
        depth = near[rows, columns]
        return [_lines(pieces, np.maximum(depth[:-1], depth[1:]), one.colour, one.width)]
    # one quad more on all sides: lines that end at the hole are no nearer
    nearest = near[max(rows.min() - 1, 0) : rows.max() + 2, max(columns.min() - 1, 0) : columns.max() + 2].max()
    white = np.ones((1, 3))
    hole = Painting(placed[None], np.array([nearest]), white, white, SEAM_WIDTH)
    return [hole, _lines(pieces, np.full(len(pieces), nearest), one.colour, one.width)]


def _nearest(depth: Array) -> Array:
    """Return the depth of the nearest of each quad and its neighbours: they must not paint over a line on it."""
    wide = np.pad(depth, 1, mode="edge")
    rows = np.maximum(np.maximum(wide[:-2], wide[1:-1]), wide[2:])
    nearest: Array = np.maximum(np.maximum(rows[:, :-2], rows[:, 1:-1]), rows[:, 2:])
    return nearest


def _quads(shape: Net, placed: Array, turned: Array, depth: Array) -> Painting:
    corners = np.stack([placed[:-1, :-1], placed[:-1, 1:], placed[1:, 1:], placed[1:, :-1]], axis=2)[shape.joined]
    normal = unit(turned[shape.joined].reshape(-1, 3))
    front = normal[:, 2:] >= 0.0
    lit = np.abs(normal @ unit(LIGHT))[:, None]
    colour = np.where(front, FRONT_RGB, BACK_RGB) * (1.0 - SHADE * (1.0 - lit))
    return Painting(corners.reshape(-1, 4, 3), depth[shape.joined].ravel(), colour, colour, SEAM_WIDTH)


def _rims(shape: Net, turned: Array) -> Indices:
    """Return the rulings at which the surface turns away from the viewer."""
    towards = np.sum(turned[..., 2], axis=1)
    swaps = (towards[1:] * towards[:-1] < 0.0) & shape.joined[1:] & shape.joined[:-1]
    return np.flatnonzero(swaps) + 1


def _across(placed: Array, along: Array, index: Indices, colour: str, width: float) -> Painting:
    """Return rulings, cut into pieces."""
    pieces = np.stack([placed[index, :-1], placed[index, 1:]], axis=2).reshape(-1, 2, 3)
    return _lines(pieces, along[index].ravel(), colour, width)


def _along(shape: Net, edge: Points3, depth: Values, colour: str) -> Painting:
    """Return an edge along the rulings' ends, cut into pieces."""
    return _lines(np.stack([edge[:-1], edge[1:]], axis=1)[shape.joined], depth[shape.joined], colour, EDGE_WIDTH)


def _lines(pieces: Array, depth: Values, colour: str, width: float) -> Painting:
    from matplotlib.colors import to_rgb

    edge = np.tile(np.array(to_rgb(colour)), (len(pieces), 1))
    return Painting(pieces, depth, edge, edge, width)


def paint(canvas: Canvas, drawn: Sequence[Painting], fit: Fit) -> None:
    """Paint quads and lines from back to front; of equal depth, in the order given."""
    corners = [corner for one in drawn for corner in fit.place(one.corners[..., :2])]
    order = np.argsort(np.concatenate([one.depth for one in drawn]), kind="stable")
    fill = np.concatenate([one.fill for one in drawn])[order]
    edge = np.concatenate([one.edge for one in drawn])[order]
    width = np.concatenate([np.full(len(one.depth), one.width) for one in drawn])[order]
    canvas.polygons([corners[i] for i in order], fill, edge, width)


def outline_points(shape: Net, frame: Points3) -> Points2:
    """Return the points of the net as they are seen, shape (k, 2), mm."""
    seen: Points2 = (shape.points.reshape(-1, 3) @ frame.T)[:, :2]
    return seen


RIM_LIFT = 0.02
"""How far a rim is brought forward, as a share of the depth: faces beside it that turn away would cover half of it."""

MARGINS = (0.6, 0.8, 0.6, 0.7)
"""Around the surface for labels, axes and scale, inches: left, bottom, right, top."""


def draw_surface(
    canvas: Canvas, box: Box, shape: Net, frame: Points3, *, size_mm: Vector3 | None, features: Sequence[Drawn] = ()
) -> None:
    """Draw the formed surface with the names of its edges, axes, scale and size."""
    fit = fitted(outline_points(shape, frame), box.inset(*MARGINS))
    faces, edges = paintings(shape, frame, features)
    paint(canvas, faces + edges, fit)
    _ghosts(canvas, edges, fit)
    write_names(canvas, shape, frame, fit, COLOURS)
    triad(canvas, np.array([box.left + 0.5, box.bottom + 0.42]), frame)
    scale_bar(canvas, box.right - 0.3, box.bottom + 0.28, fit.scale, min(1.4, box.width / 4.0))
    caption(canvas, box, "Formed surface", size_text(size_mm))


def _ghosts(canvas: Canvas, edges: Sequence[Painting], fit: Fit) -> None:
    """Draw edges once more, faintly, so that the hidden ones can be followed."""
    from matplotlib.colors import to_hex

    for one in edges:
        pieces = list(fit.place(one.corners[..., :2]))
        if pieces:
            canvas.lines(pieces, to_hex(one.edge[0]), 0.8, alpha=0.35)


def triad(canvas: Canvas, origin: Points2, frame: Points3) -> None:
    """Draw the axes; one that points at the viewer is a dot, and of names that would meet one steps aside."""
    written: list[Points2] = []
    for axis, name in enumerate("xyz"):
        tip = 0.36 * frame[:2, axis]
        arrow(canvas, origin, origin + tip)
        at = origin + tip + 0.1 * unit(tip)
        if any(norm(at - other) < APART for other in written):
            at = origin + tip + np.array([APART, 0.0])
        written.append(at)
        canvas.text(at, name, 8.5)


APART = 0.14
"""Between the names of two axes, inches."""


def sight(shape: Net, frame: Points3) -> tuple[float, float]:
    """Return width and height of the surface as seen, mm."""
    extent = np.ptp(outline_points(shape, frame), axis=0)
    return float(extent[0]), float(extent[1])
