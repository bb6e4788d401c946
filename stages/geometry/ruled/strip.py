"""A strip of ruled patches as one surface S(u, v): v runs on from patch to patch, its knots at the common rulings.

Where two patches meet S is continuous and its derivatives need not be.  A v outside the strip is taken to its end.
"""

from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Array, ArrayValue, Indices, Points2, Points3, Values, diagonal
from stages.geometry.ruled.ruled import RuledPatch


@dataclass(frozen=True, slots=True, eq=False)
class Strip(ArrayValue):
    """Patches and the v at their ends, shape (patches + 1,), rising."""

    patches: tuple[RuledPatch, ...]
    knots: Values

    def check(self) -> None:
        """Refuse knots that do not fit the patches."""
        if self.knots.shape != (len(self.patches) + 1,) or not (np.diff(self.knots) > 0.0).all():
            raise ValueError(f"{len(self.patches)} patches need one more knot, in rising order: {self.knots}")


@dataclass(frozen=True, slots=True, eq=False)
class Jet(ArrayValue):
    """S and its derivatives at n places, each of shape (n, 3), mm; S_uu is 0."""

    s: Points3
    s_u: Points3
    s_v: Points3
    s_uv: Points3
    s_vv: Points3


def locate(knots: Array, v: Values) -> tuple[Indices, Values, Values]:
    """Return the patch of each v, the place in it from 0 to 1, and the width of the patch in v."""
    index = np.clip(np.searchsorted(knots, v, side="right") - 1, 0, knots.size - 2)
    width = knots[index + 1] - knots[index]
    return index, np.clip((v - knots[index]) / width, 0.0, 1.0), width


def jet(strip: Strip, u: Values, v: Values) -> Jet:
    """Return S and its derivatives by u and v."""
    index, local, width = locate(strip.knots, v)
    found = np.zeros((5, v.size, 3))
    for i in np.unique(index):
        here = index == i
        patch, at, share, scale = strip.patches[i], local[here], u[here][:, None], width[here][:, None]
        c0, p = patch.c0.jet(at, 2), patch.p.jet(at, 2)
        found[:, here] = (
            c0[0] + share * p[0],
            p[0],
            (c0[1] + share * p[1]) / scale,
            p[1] / scale,
            (c0[2] + share * p[2]) / scale**2,
        )
    return Jet(*found)


def points(strip: Strip, u: Values, v: Values) -> Points3:
    """Return the points S(u, v), mm."""
    return jet(strip, u, v).s


def rulings(strip: Strip, v: Values) -> tuple[Points3, Points3]:
    """Return c0 and p at v, mm."""
    found = jet(strip, np.zeros_like(v), v)
    return found.s, found.s_u


def size(strip: Strip) -> float:
    """Return the diagonal of the bounding box of the directrices, mm (sampled)."""
    v = np.concatenate([np.linspace(a, b, PER_PATCH) for a, b in zip(strip.knots[:-1], strip.knots[1:], strict=True)])
    c0, p = rulings(strip, v)
    every: Array = np.concatenate([c0, c0 + p])
    return diagonal(every)


PER_PATCH = 33
"""Rulings whose ends make the box of a patch: a circle's misses its size by 0.5 %."""


def divided(matrices: Array, right: Points2) -> Points2:
    """Return matrices^-1 right, shape (n, 2); 0 where a matrix is singular (an apex)."""
    (a, b), (c, d) = (matrices[:, 0, 0], matrices[:, 0, 1]), (matrices[:, 1, 0], matrices[:, 1, 1])
    x, y = right.T
    determinant = a * d - b * c
    top = np.stack([d * x - b * y, a * y - c * x], axis=1)
    solved: Points2 = np.divide(top, determinant[:, None], out=np.zeros_like(top), where=determinant[:, None] != 0.0)
    return solved
