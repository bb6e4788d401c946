"""Cells of a strip of ruled patches, rectangles in (u, v), and which pairs of them certainly lie apart.

Over a cell each edge u = constant is nearly the cubic with the same ends and end velocities, which lies within the hull
of its control points; what it departs from that is measured at three places.  Along a ruling all is linear.  So a cell
lies within the hull of eight points, widened by that departure.  Two cells are apart if their shadows on some axis are:
tried are 13 fixed directions, then for the pairs left the normals of both quads of corners and of their sides, and the
normals to a ruling of each.

Symbols: `hull` are the control points on u0, then on u1, each from v0 to v1; `slack` is the departure on u0 and u1, mm.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Array, Indices, Mask, Values, dot, norm, unit
from stages.geometry.numeric.basis import bernstein_basis
from stages.geometry.ruled.ruled import RuledPatch, end_normals, frames

SAFETY = 2.0
"""The departure from the cubic is raised by this: h^4 / 384 S_vvvv has its largest value in the middle of a cell."""

CHECKED = (0.25, 0.5, 0.75)
"""Where it is measured, as shares of a cell."""

STEP_RAD = 0.15
"""How far a cell of the first division turns: ruling, normal and both edges."""

SAMPLES = 257
"""Where a patch's turning is measured; finer features than 1/256 of it are summed up."""

DIRECTIONS = unit(
    np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, -1, 0], [1, 0, 1], [1, 0, -1], [0, 1, 1], [0, 1, -1],
              [1, 1, 1], [1, 1, -1], [1, -1, 1], [1, -1, -1]])
)  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """n cells by the number of their patch and their place in the chain of first strips.

    u, v: ranges, shape (n, 2).  hull: shape (n, 8, 3).  slack: shape (n, 2).
    """

    patch: Indices
    strip: Indices
    u: Array
    v: Array
    hull: Array
    slack: Array

    @property
    def corners(self) -> Array:
        """Return the corners S(u0, v0), S(u1, v0), S(u1, v1), S(u0, v1), shape (n, 4, 3)."""
        return self.hull[:, [0, 4, 7, 3]]

    def take(self, chosen: Indices) -> "Cells":
        """Return the chosen cells."""
        fields = (self.patch, self.strip, self.u, self.v, self.hull, self.slack)
        return Cells(*(field[chosen] for field in fields))


@dataclass(frozen=True, slots=True, eq=False)
class Jets:
    """c0, p and their derivatives by v, shape (2, n, 3) each."""

    c0: Array
    p: Array


def jets(patches: Sequence[RuledPatch], index: Indices, v: Values) -> Jets:
    """Return directrices and rulings of the patches of those numbers at v."""
    c0, p = np.zeros((2, v.size, 3)), np.zeros((2, v.size, 3))
    for i in np.unique(index):
        chosen = index == i
        c0[:, chosen] = patches[i].c0.jet(v[chosen], 1)
        p[:, chosen] = patches[i].p.jet(v[chosen], 1)
    return Jets(c0, p)


def cells_over(patches: Sequence[RuledPatch], patch: Indices, strip: Indices, u: Array, v: Array) -> Cells:
    """Return the cells over ranges of u and v, each of shape (n, 2)."""
    v0, v1 = v.T
    low, high, *checked = (jets(patches, patch, v0 + share * (v1 - v0)) for share in (0.0, 1.0, *CHECKED))
    third = ((v1 - v0) / 3.0)[:, None]
    hull, slack = [], []
    for end in (u[:, :1], u[:, 1:]):
        a, b = low.c0 + end * low.p, high.c0 + end * high.p
        cubic = np.stack([a[0], a[0] + third * a[1], b[0] - third * b[1], b[0]])
        away = [
            norm(np.tensordot(bernstein_basis(3, np.array([share]))[0], cubic, 1) - (at.c0[0] + end * at.p[0]))
            for share, at in zip(CHECKED, checked, strict=True)
        ]
        hull.append(cubic)
        slack.append(SAFETY * np.max(away, axis=0))
    return Cells(patch, strip, u, v, np.moveaxis(np.concatenate(hull), 0, 1), np.stack(slack, axis=1))


def first_cells(patches: Sequence[RuledPatch]) -> Cells:
    """Return the strips of rulings into which a surface is divided at first, each turning little."""
    breaks = [_breaks(patch) for patch in patches]
    patch = np.repeat(np.arange(len(patches)), [b.size - 1 for b in breaks])
    v = np.concatenate([np.stack([b[:-1], b[1:]], axis=1) for b in breaks])
    u = np.tile([0.0, 1.0], (patch.size, 1))
    return cells_over(patches, patch, np.arange(patch.size), u, v)


def _breaks(patch: RuledPatch) -> Array:
    """Return places between which neither ruling nor normal nor an edge turns by more than a step."""
    v = np.linspace(0.0, 1.0, SAMPLES)
    f = frames(patch, v)
    n0, n1 = end_normals(f)
    turned = np.zeros(SAMPLES - 1)
    for direction in (unit(f.p), unit(n0 + n1), unit(f.c0_d1), unit(f.c1_d1)):
        a, b = direction[:-1], direction[1:]
        turned = np.maximum(turned, np.arctan2(norm(np.cross(a, b)), dot(a, b)))
    total = np.concatenate([[0.0], np.cumsum(turned)])
    count = max(int(np.ceil(total[-1] / STEP_RAD)), 1)
    if count == 1:
        return np.array([0.0, 1.0])
    inner = np.interp(np.arange(1, count) * total[-1] / count, total, v)
    return np.concatenate([[0.0], inner, [1.0]])


def halved(patches: Sequence[RuledPatch], cells: Cells) -> Cells:
    """Return both halves of each cell, one after the other, cut across its longer side."""
    a, b, c, d = np.moveaxis(cells.corners, 1, 0)
    along, across = np.maximum(norm(b - a), norm(c - d)), np.maximum(norm(d - a), norm(c - b))
    in_u = (along >= across)[:, None]
    u, v = np.repeat(cells.u, 2, axis=0), np.repeat(cells.v, 2, axis=0)
    for part, ends in ((0, 1), (1, 0)):
        rows = slice(part, None, 2)
        u[rows, ends] = np.where(in_u[:, 0], cells.u.mean(axis=1), cells.u[:, ends])
        v[rows, ends] = np.where(in_u[:, 0], cells.v[:, ends], cells.v.mean(axis=1))
    return cells_over(patches, np.repeat(cells.patch, 2), np.repeat(cells.strip, 2), u, v)


def near_pairs(cells: Cells, deep: float) -> tuple[Indices, Indices]:
    """Return the pairs of cells, the smaller first, whose shadows on 13 directions overlap by more than `deep` mm."""
    low, high = _shadow(cells, np.broadcast_to(DIRECTIONS, (cells.patch.size, *DIRECTIONS.shape)))
    overlap = np.triu(np.ones((low.shape[0],) * 2, dtype=bool), 1)
    for k in range(low.shape[1]):
        below = low[:, None, k] + deep <= high[None, :, k]
        overlap &= below & below.T
    first, second = np.nonzero(overlap)
    return first.astype(np.int64), second.astype(np.int64)


def may_meet(a: Cells, b: Cells, deep: float) -> Mask:
    """Return which pairs overlap by more than `deep` mm on the axes of both quads too."""
    axes = np.concatenate([_own_axes(a), _own_axes(b), _ruling_axes(a, b)], axis=1)
    (low_a, high_a), (low_b, high_b) = _shadow(a, axes), _shadow(b, axes)
    gap = np.where(norm(axes) > 0.0, np.maximum(low_a - high_b, low_b - high_a), -np.inf)
    together: Mask = gap.max(axis=1) <= -deep
    return together


def _shadow(cells: Cells, axes: Array) -> tuple[Array, Array]:
    """Return the least and the greatest of each cell on each of its axes (n, k, 3), shape (n, k)."""
    points = axes @ np.swapaxes(cells.hull, 1, 2)
    slack = np.repeat(cells.slack, 4, axis=1)[:, None]
    return (points - slack).min(axis=2), (points + slack).max(axis=2)


def _own_axes(cells: Cells) -> Array:
    """Return the unit normals of the quads and of their sides, shape (n, 5, 3); those of sides of no length are 0."""
    quad = cells.corners
    normal = np.cross(quad[:, 2] - quad[:, 0], quad[:, 3] - quad[:, 1])[:, None]
    axes: Array = unit(np.concatenate([normal, np.cross(normal, np.roll(quad, -1, axis=1) - quad)], axis=1))
    return axes


def _ruling_axes(a: Cells, b: Cells) -> Array:
    """Return the unit normals to a ruling at an end of each cell, shape (n, 4, 3)."""
    one, other = (unit(cells.corners[:, [1, 2]] - cells.corners[:, [0, 3]]) for cells in (a, b))
    axes: Array = unit(np.cross(one[:, :, None], other[:, None]).reshape(-1, 4, 3))
    return axes
