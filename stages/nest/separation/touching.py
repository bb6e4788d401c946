"""Whether two shapes overlap, and about how deep: kernels.

Shapes are edges (x0, y0, x1, y1), holes included; a point is inside where a ray crosses an odd number of them.  Two
shapes overlap if edges cross or one holds a point of the other: as no edges cross, one point of each outline tells.

The depth is that of discs inscribed in the shapes (poles): a sum over pairs of discs of how far they reach into each
other, made smooth and positive where they do not, so that whoever makes it smaller parts the shapes [1]_.

.. [1] J. Gardeyn, G. Vanden Berghe, T. Wauters, "An open-source heuristic to reboot 2D nesting research",
   arXiv:2509.13329, section 4.
"""

from typing import no_type_check

import numpy as np

from stages.nest.separation.compiled import compiled, vectorised

LEAST_DEPTH = 0.01
"""Shapes that touch cost what an overlap of this share of their size costs: no overlap is cheap because it is small."""

FIRST_POLES = 1
"""Discs of the first shape that are tried before the edges: the largest one finds most deep overlaps."""


@compiled
@no_type_check
def is_inside(edges, start, end, x, y):
    """Return whether a point lies inside the shape of some edges."""
    odd = False
    for i in range(start, end):
        y0 = edges[i, 1]
        y1 = edges[i, 3]
        if (y0 > y) != (y1 > y) and x < (edges[i, 2] - edges[i, 0]) * (y - y0) / (y1 - y0) + edges[i, 0]:
            odd = not odd
    return odd


@compiled
@no_type_check
def edges_near(edges, start, end, clip, near):
    """Fill in, column by column, the edges whose box meets a box (low x, low y, high x, high y); how many there are."""
    count = 0
    for i in range(start, end):
        x0 = edges[i, 0]
        x1 = edges[i, 2]
        if (x0 < clip[0] and x1 < clip[0]) or (x0 > clip[2] and x1 > clip[2]):
            continue
        y0 = edges[i, 1]
        y1 = edges[i, 3]
        if (y0 < clip[1] and y1 < clip[1]) or (y0 > clip[3] and y1 > clip[3]):
            continue
        near[0, count] = x0
        near[1, count] = y0
        near[2, count] = x1
        near[3, count] = y1
        count += 1
    return count


@compiled
@no_type_check
def crossed(near, count, qx, qy, fx, fy):
    """Return how many of the edges (x0, y0, x1, y1 in rows) meet the one from (qx, qy) along (fx, fy), or its line."""
    hits = 0
    for i in range(count):
        p0x = near[0, i] - qx
        p0y = near[1, i] - qy
        p1x = near[2, i] - qx
        p1y = near[3, i] - qy
        t0 = fx * p0y - fy * p0x
        t1 = fx * p1y - fy * p1x
        ex = p1x - p0x
        ey = p1y - p0y
        s0 = ey * p0x - ex * p0y
        s1 = s0 + ex * fy - ey * fx
        hits += int((t0 * t1 <= 0.0) & (s0 * s1 <= 0.0))
    return hits


@compiled
@no_type_check
def truly_crossed(near, count, qx, qy, fx, fy):
    """Return whether one of the edges meets that edge: on its own line it does only where both overlap."""
    for i in range(count):
        p0x = near[0, i] - qx
        p0y = near[1, i] - qy
        p1x = near[2, i] - qx
        p1y = near[3, i] - qy
        t0 = fx * p0y - fy * p0x
        t1 = fx * p1y - fy * p1x
        ex = p1x - p0x
        ey = p1y - p0y
        s0 = ey * p0x - ex * p0y
        s1 = s0 + ex * fy - ey * fx
        if t0 * t1 > 0.0 or s0 * s1 > 0.0:
            continue
        if t0 != 0.0 or t1 != 0.0:
            return True
        beside = max(min(p0x, p1x), min(fx, 0.0)) > min(max(p0x, p1x), max(fx, 0.0))
        if not beside and max(min(p0y, p1y), min(fy, 0.0)) <= min(max(p0y, p1y), max(fy, 0.0)):
            return True
    return False


@compiled
@no_type_check
def edges_cross(one, one_start, one_end, other, other_start, other_end, dx, dy, clip, near):
    """Return whether an edge of `other`, moved by (dx, dy), crosses one of `one`, touches it, or runs along it.

    clip: the box that both shapes reach into, from coordinates that were moved just so: or rounding loses edges on it.
    near: room for all edges of `one`, column by column.
    """
    count = edges_near(one, one_start, one_end, clip, near)
    if count == 0:
        return False
    for j in range(other_start, other_end):
        q0x = other[j, 0] + dx
        q1x = other[j, 2] + dx
        if (q0x < clip[0] and q1x < clip[0]) or (q0x > clip[2] and q1x > clip[2]):
            continue
        q0y = other[j, 1] + dy
        q1y = other[j, 3] + dy
        if (q0y < clip[1] and q1y < clip[1]) or (q0y > clip[3] and q1y > clip[3]):
            continue
        if crossed(near, count, q0x, q0y, q1x - q0x, q1y - q0y) and truly_crossed(
            near, count, q0x, q0y, q1x - q0x, q1y - q0y
        ):
            return True
    return False


@compiled
@no_type_check
def discs_overlap(one, one_start, one_end, other, other_start, other_end, dx, dy):
    """Return whether a disc of `other`, moved by (dx, dy), reaches into one of `one`."""
    hits = 0
    for i in range(one_start, one_end):
        x = one[0, i] - dx
        y = one[1, i] - dy
        for j in range(other_start, other_end):
            ux = other[0, j] - x
            uy = other[1, j] - y
            reach = one[2, i] + other[2, j]
            hits += int(ux * ux + uy * uy < reach * reach)
    return hits > 0


@vectorised
@no_type_check
def depth(one, one_start, one_end, other, other_start, other_end, dx, dy, eps):
    """Return how deep the discs of `other`, moved by (dx, dy), reach into those of `one`: mm2, always positive."""
    total = 0.0
    for i in range(one_start, one_end):
        x = one[0, i] - dx
        y = one[1, i] - dy
        radius = one[2, i]
        for j in range(other_start, other_end):
            ux = x - other[0, j]
            uy = y - other[1, j]
            into = radius + other[2, j] - np.sqrt(ux * ux + uy * uy)
            apart = eps * eps / (2.0 * eps - min(into, eps))
            total += max(into, apart) * min(radius, other[2, j])
    return total


@compiled
@no_type_check
def severity(shapes, kind_one, kind_other, one, one_start, one_end, other, other_start, other_end, dx, dy):
    """Return how bad an overlap of two kinds is whose discs lie so: mm2."""
    eps = LEAST_DEPTH * max(shapes.size[kind_one], shapes.size[kind_other])
    deep = depth(one, one_start, one_end, other, other_start, other_end, dx, dy, eps)
    return np.sqrt(deep + eps * eps) * np.sqrt(shapes.weight[kind_one] * shapes.weight[kind_other])
