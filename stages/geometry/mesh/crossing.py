"""Where a triangle mesh passes through itself, lies on itself, or is folded back along an edge.

Two triangles are convex: they interpenetrate by no more than t if, on some axis, their shadows overlap by no more
than t.  The axes that decide are both normals and the nine cross products of their sides, or, for two triangles in
one plane, the normals of their six sides in it [1]_.  Triangles that share a corner or a side touch there, and
touching is an overlap of 0 on one of these axes: they need no case of their own.  `depth` is the least of the
overlaps.

Pairs whose boxes meet are found on a balanced binary tree over the triangles in Morton order, both sides of a pair
descending together, so many pairs at a time that memory stays bounded.  What overlaps by less than the tolerance
counts as touching.

.. [1] S. Gottschalk, M. C. Lin, D. Manocha, "OBBTree", SIGGRAPH 1996, section 5; T. Akenine-Moller, "Fast 3D
   triangle-box overlap testing", Journal of Graphics Tools 6, 2001.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stages.geometry.arrays import Array, Indices, Mask, Numbers, Points3, Values, cross3, dot, norm, unit
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.topology import CORNERS

Words = NDArray[np.uint64]
"""Numbers as bits."""

LARGEST_BATCH = 1 << 19
"""Pairs looked at together: some 300 MB at the deepest point of the work."""
MORTON_BITS = 21
"""To an axis: three of them fill a word."""
MOST_CROSSINGS = 10_000
"""Pairs after which the search ends: a mesh with so many is not repaired by looking at each."""


@dataclass(frozen=True, slots=True, eq=False)
class Crossings:
    """Pairs of triangles that interpenetrate, how deep, mm, and whether these are all."""

    faces: Indices
    others: Indices
    depth_mm: Values
    complete: bool = True


def crossings(mesh: Mesh, tolerance: float) -> Crossings:
    """Return the pairs of triangles that overlap by more than `tolerance`, mm; folded neighbours are among them."""
    found: list[tuple[Indices, Indices, Values]] = []
    count = 0
    for one, other in close_pairs(*boxes(mesh)):
        kept, depth = penetrating(mesh, one, other, tolerance)
        if len(kept):
            found.append((one[kept], other[kept], depth))
            count += len(kept)
        if count > MOST_CROSSINGS:
            break
    if not found:
        none = np.zeros(0, dtype=np.int64)
        return Crossings(none, none, np.zeros(0))
    one, other, depth = (np.concatenate(parts) for parts in zip(*found, strict=True))
    one, other = np.minimum(one, other), np.maximum(one, other)
    order = np.lexsort((other, one, -depth))
    return Crossings(one[order], other[order], depth[order], count <= MOST_CROSSINGS)


def boxes(mesh: Mesh) -> tuple[Points3, Points3]:
    """Return the least and the largest coordinates of each triangle."""
    corners = mesh.vertices[mesh.faces]
    return corners.min(axis=1), corners.max(axis=1)


def morton(points: Points3) -> Indices:
    """Return places along a curve that fills the bounding box such that neighbours on it are near in space."""
    low, extent = points.min(axis=0), np.ptp(points, axis=0).max()
    cells = np.zeros(points.shape, dtype=np.uint64)
    if extent > 0.0:
        cells = ((points - low) / extent * ((1 << MORTON_BITS) - 1)).astype(np.uint64)
    x, y, z = (_spread(cells[:, axis]) for axis in range(3))
    places: Indices = (x | (y << np.uint64(1)) | (z << np.uint64(2))).astype(np.int64)
    return places


def _spread(words: Words) -> Words:
    """Return numbers of 21 bits with two zeros after each bit."""
    for shift, mask in (
        (32, 0x1F00000000FFFF),
        (16, 0x1F0000FF0000FF),
        (8, 0x100F00F00F00F00F),
        (4, 0x10C30C30C30C30C3),
        (2, 0x1249249249249249),
    ):
        words = (words | (words << np.uint64(shift))) & np.uint64(mask)
    return words


def close_pairs(low: Points3, high: Points3) -> Iterator[tuple[Indices, Indices]]:
    """Yield, in batches, all pairs of boxes that meet, each once."""
    m = len(low)
    if m == 0:
        return
    depth = max(m - 1, 0).bit_length()
    order = np.argsort(morton((low + high) / 2.0), kind="stable")
    levels = _levels(low[order], high[order], depth)
    stack = [(0, np.zeros(1, dtype=np.int64), np.zeros(1, dtype=np.int64))]
    while stack:
        level, one, other = stack.pop()
        if len(one) > LARGEST_BATCH:
            half = len(one) // 2
            stack += [(level, one[half:], other[half:]), (level, one[:half], other[:half])]
            continue
        if level == depth:
            apart = one != other
            if apart.any():
                yield order[one[apart]], order[other[apart]]
            continue
        one, other = _children(one, other)
        below_low, below_high = levels[level + 1]
        meet = _meet(below_low, below_high, one, other)
        if meet.any():
            stack.append((level + 1, one[meet], other[meet]))


def _levels(low: Points3, high: Points3, depth: int) -> list[tuple[Array, Array]]:
    """Return the boxes of a complete binary tree from the root to the leaves, which are filled up with empty boxes."""
    blank = (1 << depth) - len(low)
    low = np.concatenate([low, np.full((blank, 3), np.inf)])
    high = np.concatenate([high, np.full((blank, 3), -np.inf)])
    levels: list[tuple[Array, Array]] = [(low, high)]
    for _ in range(depth):
        low, high = np.minimum(low[0::2], low[1::2]), np.maximum(high[0::2], high[1::2])
        levels.append((low, high))
    return levels[::-1]


def _children(one: Indices, other: Indices) -> tuple[Numbers, Numbers]:
    """Return the pairs of children: three of a node with itself, four of two nodes."""
    same = one == other
    a, (b, c) = one[same], (one[~same], other[~same])
    left = np.concatenate([2 * a, 2 * a, 2 * a + 1, 2 * b, 2 * b, 2 * b + 1, 2 * b + 1])
    right = np.concatenate([2 * a, 2 * a + 1, 2 * a + 1, 2 * c, 2 * c + 1, 2 * c, 2 * c + 1])
    return left, right


def _meet(low: Array, high: Array, one: Indices, other: Indices) -> Mask:
    """Return which boxes meet."""
    meet: Mask = np.ones(len(one), dtype=bool)
    for axis in range(3):
        meet &= (low[one, axis] <= high[other, axis]) & (low[other, axis] <= high[one, axis])
    return meet


def penetrating(mesh: Mesh, one: Indices, other: Indices, tolerance: float) -> tuple[Numbers, Array]:
    """Return which pairs of triangles overlap on every axis by more than `tolerance`, and by how much at least."""
    kept = np.arange(len(one))
    depth = np.full(len(one), np.inf)
    flat = np.zeros(0, dtype=np.int64)
    for side in (0, 1):
        normals = _normals(mesh, (one, other)[side][kept])
        overlap, reach = _along(mesh, one[kept], other[kept], normals)
        flat = np.concatenate([flat, kept[reach <= tolerance]])
        kept, depth = _deeper(kept, depth, overlap, tolerance)
    for i in range(CORNERS):
        for j in range(CORNERS):
            axes = unit(cross3(_side(mesh, one[kept], i), _side(mesh, other[kept], j)))
            overlap, _ = _along(mesh, one[kept], other[kept], axes)
            crooked = norm(axes) > 0.0
            kept, depth = _deeper(kept, depth, np.where(crooked, overlap, np.inf), tolerance)
    level, level_depth = _in_plane(mesh, one, other, flat, tolerance)
    return np.concatenate([kept, level]), np.concatenate([depth, level_depth])


def _in_plane(mesh: Mesh, one: Indices, other: Indices, kept: Numbers, tolerance: float) -> tuple[Numbers, Array]:
    """Return which pairs of triangles in one plane overlap on the normals of all their sides."""
    kept = np.unique(kept)
    depth = np.full(len(kept), np.inf)
    for side in (0, 1):
        for i in range(CORNERS):
            faces = (one, other)[side][kept]
            axes = unit(cross3(_normals(mesh, faces), _side(mesh, faces, i)))
            overlap, _ = _along(mesh, one[kept], other[kept], axes)
            kept, depth = _deeper(kept, depth, overlap, tolerance)
    return kept, depth


def _deeper(kept: Indices, depth: Values, overlap: Values, tolerance: float) -> tuple[Numbers, Array]:
    """Return the pairs that overlap on one more axis, and their least overlap so far."""
    deep = overlap > tolerance
    return kept[deep], np.minimum(depth, overlap)[deep]


def _along(mesh: Mesh, one: Indices, other: Indices, axes: Points3) -> tuple[Values, Values]:
    """Return by how much the shadows on unit axes overlap, and how far the pair reaches along them."""
    low, high = _shadow(mesh, one, axes)
    low2, high2 = _shadow(mesh, other, axes)
    return np.minimum(high - low2, high2 - low), np.maximum(high, high2) - np.minimum(low, low2)


def _shadow(mesh: Mesh, faces: Indices, axes: Points3) -> tuple[Values, Values]:
    places = [dot(mesh.vertices[mesh.faces[faces, i]], axes) for i in range(CORNERS)]
    low = np.minimum(np.minimum(places[0], places[1]), places[2])
    return low, np.maximum(np.maximum(places[0], places[1]), places[2])


def _normals(mesh: Mesh, faces: Indices) -> Points3:
    return unit(cross3(_side(mesh, faces, 0), _side(mesh, faces, 1)))


def _side(mesh: Mesh, faces: Indices, i: int) -> Points3:
    """Return the vectors along one side of each of the faces."""
    side: Points3 = mesh.vertices[mesh.faces[faces, (i + 1) % CORNERS]] - mesh.vertices[mesh.faces[faces, i]]
    return side
