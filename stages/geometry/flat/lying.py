"""How a pattern lies that has no ruling to lie along: its longest extent along x, its least corner at the origin.

The box around it is the one of least area in any direction; one side of it lies on a side of the convex hull [1]_.  Of
the ways to put the box down, its long side lies along x and the middle of the outline's points is nearer to the origin
than to the corner across; so the same part lies the same way however it was given.

.. [1] H. Freeman, R. Shapira, "Determining the minimum-area encasing rectangle for an arbitrary closed curve",
   Communications of the ACM 18(7), 1975, 409-413.
"""

import numpy as np

from stages.geometry.arrays import Array, Points2, Vector2, norm


def lying(points: Points2) -> tuple[Array, Vector2]:
    """Return the rotation R, shape (2, 2), and the move d, mm, that put an outline down: R x + d."""
    import shapely

    hull = np.asarray(shapely.convex_hull(shapely.MultiPoint(points)).exterior.coords)
    sides = np.diff(hull, axis=0)
    along = sides / norm(sides)[:, None]
    across = np.column_stack([-along[:, 1], along[:, 0]])
    extents = np.stack([np.ptp(hull @ along.T, axis=0), np.ptp(hull @ across.T, axis=0)])
    areas = extents.prod(axis=0)
    # of boxes that are equal but for rounding, the one along the longest side of the hull
    near = areas <= areas.min() * (1.0 + EQUAL)
    best = int(np.argmax(np.where(near, norm(sides), 0.0)))
    x = along[best] if extents[0, best] >= extents[1, best] else across[best]
    rotation = np.array([x, [-x[1], x[0]]])
    turned = points @ rotation.T
    low, high = turned.min(axis=0), turned.max(axis=0)
    if np.sum((turned.mean(axis=0) - (low + high) / 2.0) / (high - low)) > 0.0:
        rotation, low = -rotation, -high
    return rotation, -low


EQUAL = 1e-9
"""Boxes that differ by less than this share are one by another side of the hull."""
