"""A ruled strip, unrolled along its rulings and divided into elements of moderate shape."""

from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Array, Values, diagonal, norm
from stages.geometry.flat.development import NO_LENGTH, RulingMap, angle, develop
from stages.geometry.numeric.numbering import Shape
from stages.geometry.ruled.ruled import RuledPatch


@dataclass(frozen=True, slots=True, eq=False)
class Strip:
    """The ruling maps of a strip's patches, the ends of their coarsest elements, and the strip's size in mm.

    pointed, apex0, apex1: see `Shape`.
    """

    bases: tuple[RulingMap, ...]
    breaks: tuple[Array, ...]
    pointed: tuple[bool, ...]
    apex0: tuple[bool, ...]
    apex1: tuple[bool, ...]
    size: float

    def shape(self, breaks: tuple[Array, ...]) -> Shape:
        """Return how the strip hangs together when divided so."""
        return Shape(tuple(ends.size - 1 for ends in breaks), self.pointed, self.apex0, self.apex1)


PLACES = np.linspace(0.0, 1.0, 257)
"""Where a patch is looked at to divide it; elements end at some of them."""


def divided(patches: tuple[RuledPatch, ...]) -> Strip:
    """Return the strip with its coarsest elements.  Raises NoSolutionError where it does not unroll."""
    bases = tuple(piece for piece in develop(patches).pieces if isinstance(piece, RulingMap))
    flat = np.concatenate([base.positions(np.full_like(PLACES, u), PLACES) for base in bases for u in (0.0, 1.0)])
    size = diagonal(flat)
    short = [norm(patch.p.jet(np.array([0.0, 1.0]), 0)[0]) <= NO_LENGTH * size for patch in patches]
    pointed = (*(bool(ends[0]) for ends in short), bool(short[-1][1]))
    apex0, apex1 = (tuple(_is_point(patch, side, size) for patch in patches) for side in (0, 1))
    return Strip(bases, tuple(_breaks(base) for base in bases), pointed, apex0, apex1, size)


def _is_point(patch: RuledPatch, side: int, size: float) -> bool:
    """Return whether an edge of the patch is a single point."""
    curve = patch.c0 if side == 0 else patch.c1
    return bool(norm(curve.jet(PLACES, 1)[1]).max() <= NO_LENGTH * size)


def _breaks(base: RulingMap) -> Values:
    """Return the ends of elements of one patch: not much longer than wide, turning little, of few panels."""
    middle = base.positions(np.full_like(PLACES, 0.5), PLACES)
    longest = float(norm(base.patch.p.jet(PLACES, 0)[0]).max())
    steps = norm(np.diff(middle, axis=0)) / (LONGEST * longest) + np.abs(np.diff(angle(base, PLACES))) / MOST_TURN
    panel = np.interp(PLACES, base.breaks, np.arange(base.breaks.size))
    share = np.concatenate([[0.0], np.cumsum(steps + np.diff(panel) / MOST_PANELS)])
    count = min(max(int(np.ceil(share[-1])), 1), PLACES.size - 1)
    inner = PLACES[np.searchsorted(share, np.arange(1, count) / count * share[-1])]
    return np.unique(np.concatenate([[0.0], inner, [1.0]]))


LONGEST = 2.0
"""An element is at most so many times as long as the longest ruling: layers at the ends of a strip are a width deep."""
MOST_TURN = 1.0
"""Displacements of a ruling turn with it: over 1 rad cos and sin are resolved to 1e-9 at degree 7."""

MOST_PANELS = 6.0
"""Panels resolve the surface to 1e-14; the displacement, small already, is wanted to 4 digits and needs fewer parts."""


def halved(breaks: Array, times: int) -> Array:
    """Return the ends of elements each divided into 2**times."""
    parts = 2**times
    inner = breaks[:-1, None] + np.diff(breaks)[:, None] * np.arange(parts) / parts
    return np.append(inner.ravel(), breaks[-1])
