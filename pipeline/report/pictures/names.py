"""The names of edges and rulings beside a formed surface, where they hide nothing.

Each name is tried at several places along what it names, on the side away from the surface; of those that keep clear of
all edges and of the names already written, the one nearest to the viewer is taken.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.report.pictures.canvas import PURPLE, Canvas, Fit
from pipeline.report.pictures.net import Net
from stages.geometry.arrays import Array, Points2, Points3, Values, norm, unit

SIGN_WIDTH, HALF_HEIGHT = 0.085, 0.08
"""Of bold 9.5 point type, inches."""

GAP, CLEAR = 0.07, 0.05
"""Between a name and what it names, and how far from all lines a name is clear of them, inches."""

NEARNESS = 0.3
"""What the nearest place is worth beside a clear one."""

SEAM = 1e-6
"""First and last ruling are one seam if they are nearer than this share of the size."""


@dataclass(frozen=True, slots=True)
class Label:
    """A name, and the places it may have: points on what it names, directions away from the surface, depths, mm."""

    words: str
    colour: str
    points: Points2
    away: Points2
    depth: Values


def write_names(canvas: Canvas, shape: Net, frame: Points3, fit: Fit, colours: dict[str, str]) -> None:
    """Write c0, c1, start, end and the worst ruling beside what they name."""
    placed = shape.points @ frame.T
    flat = fit.place(placed[..., :2])
    lines = np.concatenate([flat[:, 0], flat[:, -1], flat[0], flat[-1]])
    for label in labels(shape, flat, placed[..., 2], colours):
        at, half, clear = best_place(label, lines)
        canvas.text(at, label.words, 9.5, label.colour, bold=True, on_white=not clear)
        corners = np.array([[x, y] for x in (-half[0], 0.0, half[0]) for y in (-half[1], half[1])])
        lines = np.concatenate([lines, at + corners])


def labels(shape: Net, flat: Array, depth: Array, colours: dict[str, str]) -> list[Label]:
    """Return what is to be named."""
    n = shape.v.size
    thirds = np.arange(n // 4, 3 * n // 4 + 1)
    found = []
    for name, row, other in (("c0", 0, -1), ("c1", -1, 0)):
        away = unit(flat[thirds, row] - flat[thirds, other])
        found.append(Label(name, colours[name], flat[thirds, row], away, depth[thirds, row]))
    near = max(n // 12, 1)
    seam = float(norm(shape.points[0] - shape.points[-1]).max()) <= SEAM * float(
        norm(np.ptp(shape.points, axis=(0, 1)))
    )
    ends = (("start = end", 0, near),) if seam else (("start", 0, near), ("end", -1, -1 - near))
    columns = np.arange(1, flat.shape[1] - 1)
    for name, i, inner in ends:
        away = unit(flat[i, columns] - flat[inner, columns])
        found.append(Label(name, colours[name.split()[0]], flat[i, columns], away, depth[i, columns]))
    if shape.worst is not None:
        ends_of = flat[shape.worst, [0, -1]]
        words = f"worst ruling, v = {shape.v[shape.worst]:.4g}"
        found.append(Label(words, PURPLE, ends_of, unit(ends_of - ends_of[::-1]), depth[shape.worst, [0, -1]]))
    return found


def best_place(label: Label, lines: Points2) -> tuple[Array, Array, bool]:
    """Return the middle of the name, half its width and height, inches, and whether it is clear of all lines."""
    half = np.array([SIGN_WIDTH * len(label.words) / 2.0, HALF_HEIGHT])
    middles = label.points + label.away * (GAP + np.abs(label.away) @ half)[:, None]
    room = clearances(middles, half, lines)
    spread = max(float(np.ptp(label.depth)), np.finfo(float).tiny)
    worth = np.minimum(room, CLEAR) / CLEAR + NEARNESS * (label.depth - label.depth.min()) / spread
    best = int(np.argmax(np.round(worth, DECIMALS)))
    return middles[best], half, bool(room[best] >= CLEAR)


DECIMALS = 6
"""Of a worth: places that differ by less are alike, and the first is taken."""


def clearances(middles: Points2, half: Array, lines: Sequence[Array] | Array) -> Values:
    """Return how far each of some equal boxes is from the nearest of the points, inches; 0 inside."""
    apart = np.maximum(np.abs(middles[:, None] - np.asarray(lines)[None]) - half, 0.0)
    nearest: Values = norm(apart).min(axis=1)
    return nearest
