"""A surface by points on its rulings, and the direction from which it is best seen.

Every ruling that is shown is one of the net's own, so that it can be drawn between quads.  The direction is chosen from
a fixed list with z upright: the first that shows most of the area, but not face-on, and how the edges are bent.  Parts
of the surface that hide others are not considered.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np

from stages.geometry.arrays import Array, Indices, Mask, Points3, Values, Vector3, norm
from stages.model.surface import RuledSurface

RULINGS = 24
"""Rulings shown, about: at most this many, and at least one per patch up to it."""


STEPS = 120
"""Quads along the directrices, about."""


ROWS, ROWS_OF_MANY = 6, 2


MANY_STEPS = 400
"""Quads along a ruling; fewer where a strip of many patches takes more than this many steps."""


DECIMALS = 9
"""Of v: rulings that differ by less are one, else quads without width would come out of rounding."""


@dataclass(frozen=True, slots=True)
class Net:
    """A surface by points on its rulings: v over all patches (n,), points (n, m, 3), and what is special.

    joined: whether ruling i and i + 1 bound a quad (not at a joint of patches, where they coincide).
    rulings: indices of those shown.  worst: index of the worst one, or None.
    """

    v: Values
    points: Array
    joined: Mask
    rulings: Indices
    worst: int | None


def ruling_places(patches: int) -> Values:
    """Return the v of the rulings that are shown, counted over the patches, in space and flat alike."""
    if patches == 0:
        return np.zeros(0)
    if patches >= RULINGS:
        return np.arange(0, patches + 1, -(-patches // RULINGS)).astype(np.float64)
    return np.linspace(0.0, patches, patches * (RULINGS // patches) + 1)


def net(surface: RuledSurface, worst_v: float | None = None) -> Net:
    """Return points of the surface, mm, such that all rulings shown are among its own."""
    count = len(surface.patches)
    places = ruling_places(count)
    special = places if worst_v is None else np.append(places, np.clip(worst_v, 0.0, count))
    columns: list[Values] = []
    for i in range(count):
        mine = special[(special >= i) & (special <= i + 1)]
        even = np.linspace(i, i + 1, -(-STEPS // count) + 1)
        columns.append(np.unique(np.round(np.concatenate([even, mine]), DECIMALS)))
    v = np.concatenate(columns)
    u = np.linspace(0.0, 1.0, (ROWS if v.size <= MANY_STEPS else ROWS_OF_MANY) + 1)
    points = np.concatenate(
        [
            patch.c0.jet(local, 0)[0][:, None, :] + u[:, None] * patch.p.jet(local, 0)[0][:, None, :]
            for patch, local in zip(surface.patches, (v - i for i, v in enumerate(columns)), strict=True)
        ]
    )
    worst = None if worst_v is None else int(np.argmin(np.abs(v - worst_v)))
    shown = np.unique(np.searchsorted(v, np.round(places, DECIMALS)).clip(0, v.size - 1))
    return Net(v, points, np.diff(v) > 0.0, shown, worst)


def normals(shape: Net) -> Array:
    """Return twice the area vectors of the quads, shape (n - 1, m - 1, 3), on the side of p x c0'."""
    p = shape.points
    return np.cross(p[1:, 1:] - p[:-1, :-1], p[1:, :-1] - p[:-1, 1:])


AZIMUTHS_DEG = tuple(-60.0 + sign * step for step in range(0, 180, 15) for sign in ((1, -1) if step else (1,)))


ELEVATIONS_DEG = (25.0, 40.0, 55.0)
"""Directions tried, best liked first."""


SEEN_ENOUGH = 0.85
"""A surface that shows this share of its area is not turned further: face-on, its form could not be seen."""


FRONT_BONUS = 0.1
"""What seeing only the front side is worth, as a share of the area."""


FORM_BONUS = 0.25
"""What it is worth to see the hollow of an edge in full: how the sheet is bent shows in its edges."""


HOLLOW = 0.05
"""A bulge whose area is this share of the squared size counts in full."""


def view_direction(shape: Net) -> Points3:
    """Return the frame of the picture of a surface: of its quads, of how its edges bulge, of its length."""
    return best_view(normals(shape)[shape.joined].reshape(-1, 3), hollows(shape), length(shape))


def best_view(area: Points3, bulges: Points3 | None = None, long: Vector3 | None = None) -> Points3:
    """Return the frame of the picture, rows right, up and towards the viewer, shape (3, 3); z stays upright.

    Of the directions tried, the first that shows most of the area (up to `SEEN_ENOUGH`), its front rather, most of the
    bulge of one of the edges, and the length of what is long.

    area: of each face, as a vector across it.  bulges: see `hollows`.  long: see `length`.
    """
    total = max(float(norm(area).sum()), np.finfo(float).tiny)
    edges = np.zeros((1, 3)) if bulges is None else bulges
    axis = np.zeros(3) if long is None else long
    frames = _frames()
    worth = _seen(area, frames[:, 2], total) + _form(edges, axis, frames)
    best: Points3 = frames[int(np.argmax(np.round(worth, 2)))]
    return best


@cache
def _frames() -> Array:
    """Return the views that are tried, shape (n, 3, 3)."""
    return np.stack([frame_of(azimuth, elevation) for elevation in ELEVATIONS_DEG for azimuth in AZIMUTHS_DEG])


def _form(edges: Points3, axis: Vector3, frames: Array) -> Values:
    """Return what views are worth for showing how the edges are bent, the length, and depth: not along x or y."""
    bulge = np.abs(edges @ frames[:, 2].T).max(axis=0)
    shown = norm(frames[:, :2] @ axis)
    square = np.abs(frames[:, 0, :2]).min(axis=1) < LEAST_TURN
    worth: Values = FORM_BONUS * bulge + LENGTH_BONUS * shown - np.where(square, SQUARE_ON, 0.0)
    return worth


LENGTH_BONUS = 0.3
"""What it is worth to see something slender at its full length."""


SQUARE_ON, LEAST_TURN = 0.03, 0.1
"""What it costs to look along x or y, to within so many rad."""


def length(shape: Net) -> Vector3:
    """Return the direction of greatest extent, its length 1 for a needle and 0 for what is as wide as long."""
    points = shape.points.reshape(-1, 3) - shape.points.mean(axis=(0, 1))
    _, extent, axes = np.linalg.svd(points, full_matrices=False)
    slender: Vector3 = axes[0] * (1.0 - extent[1] / max(float(extent[0]), np.finfo(float).tiny))
    return slender


def hollows(shape: Net) -> Points3:
    """Return the vector areas between the edges c0, c1 and their chords, at most of length 1: how far they bulge."""
    size = max(float(norm(np.ptp(shape.points, axis=(0, 1)))), np.finfo(float).tiny)
    edges = shape.points[:, [0, -1]] - shape.points[:1, [0, -1]]
    area = np.cross(edges[:-1], edges[1:]).sum(axis=0) / (2.0 * HOLLOW * size**2)
    bulge: Points3 = area / np.maximum(norm(area), 1.0)[:, None]
    return bulge


def _seen(area: Array, towards: Points3, total: float) -> Values:
    """Return what views in some directions show of the area, and of its front."""
    facing = area @ towards.T
    shown = np.minimum(np.abs(facing).sum(axis=0) / total, SEEN_ENOUGH)
    worth: Values = shown + FRONT_BONUS * facing.sum(axis=0) / total
    return worth


def frame_of(azimuth_deg: float, elevation_deg: float) -> Points3:
    """Return right, up and towards the viewer for a viewer at that azimuth and elevation."""
    a, e = np.radians([azimuth_deg, elevation_deg])
    towards = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    right = np.array([-np.sin(a), np.cos(a), 0.0])
    return np.stack([right, np.cross(towards, right), towards])
