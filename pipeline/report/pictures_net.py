"""A surface by points on its rulings, and the direction from which it is best seen.

Every ruling that is shown is one of the net's own, so that it can be drawn between quads.  The direction is chosen from
a fixed list with z upright: the first that shows most of the area, but not face-on.  Parts of the surface that hide
others are not considered.
"""

from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Array, Indices, Mask, Points3, Values, norm
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


def view_direction(shape: Net) -> Points3:
    """Return the frame of the picture, rows right, up and towards the viewer, shape (3, 3); z stays upright.

    Of the directions tried, the first that shows most of the area (up to `SEEN_ENOUGH`), its front rather.
    """
    area = normals(shape)[shape.joined].reshape(-1, 3)
    total = max(float(norm(area).sum()), np.finfo(float).tiny)
    seen = [
        (round(_seen(area, frame[2], total), 2), frame)
        for frame in (frame_of(azimuth, elevation) for elevation in ELEVATIONS_DEG for azimuth in AZIMUTHS_DEG)
    ]
    return max(seen, key=lambda pair: pair[0])[1]


def _seen(area: Array, towards: Array, total: float) -> float:
    facing = area @ towards
    return min(float(np.abs(facing).sum()) / total, SEEN_ENOUGH) + FRONT_BONUS * float(facing.sum()) / total


def frame_of(azimuth_deg: float, elevation_deg: float) -> Points3:
    """Return right, up and towards the viewer for a viewer at that azimuth and elevation."""
    a, e = np.radians([azimuth_deg, elevation_deg])
    towards = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    right = np.array([-np.sin(a), np.cos(a), 0.0])
    return np.stack([right, np.cross(towards, right), towards])
