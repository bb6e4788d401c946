"""Whether paths are alike vertex by vertex, so that places, lengths and areas need not be compared one by one."""

from collections.abc import Sequence

import numpy as np

from stages.geometry.arrays import Mask, Values
from stages.geometry.paths.arcpath import ArcPath

SHARE = 0.25
"""Vertices and bulges that agree to this share of what places may be off leave no place, length or area off by more."""

Pair = tuple[ArcPath, ArcPath]
"""A path as found and as drawn."""


def are_alike(pairs: Sequence[Pair], near_mm: Values) -> Mask:
    """Return which paths have the same vertices, and bulges that move no point of an arc by more: to a share of that.

    With d for that share, a piece on a chord c with a bulge of at most 1 moves by 2 d; its length changes by at most
    c db (the derivative of (1 + b^2) atan(b) / b is at most 1) and 2 sqrt(2) d; the area by 2 d times the length.
    """
    sizes = np.array([[path.bulges.size for path in pair] for pair in pairs], dtype=np.int64).reshape(-1, 2)
    same = np.flatnonzero(sizes[:, 0] == sizes[:, 1])
    alike = np.zeros(len(pairs), dtype=bool)
    if not same.size:
        return alike
    chosen = [pairs[number] for number in same.tolist()]
    first = np.cumsum(sizes[same, 0]) - sizes[same, 0]
    found, drawn = (np.concatenate([pair[k].vertices for pair in chosen]) for k in (0, 1))
    bent, bulges = (np.concatenate([pair[k].bulges for pair in chosen]) for k in (0, 1))
    off = np.maximum.reduceat(np.abs(found - drawn).max(axis=1), first)
    wide = (np.maximum.reduceat(drawn, first) - np.minimum.reduceat(drawn, first)).sum(axis=1)
    turned = np.maximum.reduceat(np.abs(bent - bulges), first) * wide
    steepest = np.maximum.reduceat(np.abs(bulges), first)
    alike[same] = (np.maximum(off, turned) <= SHARE * near_mm[same]) & (steepest <= 1.0)
    return alike
