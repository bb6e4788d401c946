"""Whether two paths are alike vertex by vertex, so that places, lengths and areas need not be compared one by one."""

import numpy as np

from stages.geometry.arcpath import ArcPath

SHARE = 0.25
"""Vertices and bulges that agree to this share of what places may be off leave no place, length or area off by more."""


def is_alike(found: ArcPath, drawn: ArcPath, near_mm: float) -> bool:
    """Return whether paths have the same vertices, and bulges that move no point of an arc by more: to a share of it.

    With d for that share, a piece on a chord c with a bulge of at most 1 moves by 2 d; its length changes by at most
    c db (the derivative of (1 + b^2) atan(b) / b is at most 1) and 2 sqrt(2) d; the area by 2 d times the length.
    """
    if found.bulges.size != drawn.bulges.size:
        return False
    off = float(np.abs(found.vertices - drawn.vertices).max())
    bent = float(np.abs(found.bulges - drawn.bulges).max()) * float(np.ptp(drawn.vertices, axis=0).sum())
    return max(off, bent) <= SHARE * near_mm and float(np.abs(drawn.bulges).max()) <= 1.0
