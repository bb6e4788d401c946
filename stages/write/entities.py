"""What entities of every format have in common: how numbers are rounded, and which paths are full circles."""

import numpy as np

from stages.geometry.arrays import Array
from stages.geometry.paths.arcpath import ArcPath, centres, radii, sweeps

DECIMALS = 10
"""Of coordinates in mm: a reader gets them back to 5e-11 mm, and rounding noise such as 6e-17 becomes 0."""

BULGE_DECIMALS = 14
"""Of bulges: on a chord of 2 m the last place moves the arc by 1e-11 mm; of angles in degrees: all of a double."""

FULL_CIRCLE = 1e-9
"""A closed path that turns by 2 pi about one centre to this share of its radius is a circle."""


def circle(path: ArcPath) -> tuple[float, float, float] | None:
    """Return centre x, y and radius in mm if the path is one full circle, else None."""
    if not path.closed or not path.bulges.all():
        return None
    sweep, radius = sweeps(path), radii(path)
    if not (np.all(sweep > 0.0) or np.all(sweep < 0.0)):
        return None
    centre = centres(path)
    spread = max(float(np.ptp(centre, axis=0).max()), float(np.ptp(radius)), abs(abs(sweep.sum()) - 2.0 * np.pi))
    if spread > FULL_CIRCLE * max(float(radius.max()), 1.0):
        return None
    x, y = centre.mean(axis=0)
    return float(x), float(y), float(radius.mean())


def rounded(values: Array, decimals: int) -> list[float]:
    """Return the values as they will be written; ValueError where one is not finite: the last gate before a file."""
    if not np.isfinite(values).all():
        raise ValueError(f"a number in a cut file must be finite: {values}")
    # adding 0 turns -0.0 into 0.0
    numbers: list[float] = (np.round(values, decimals) + 0.0).tolist()
    return numbers
