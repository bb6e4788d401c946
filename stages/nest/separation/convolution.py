"""Where one shape overlaps another, for all their relative places at once, on a grid: kernels.

Two simple shapes overlap where the convolution of the one with the other reflected winds about their relative place;
how often it winds is how many pieces they have in common.  The winding number is kept for one point of each cell, with
the segments of the convolution that reach into the cell: the way from that point to any other in the cell crosses no
others, so that a look at a handful of segments tells exactly.  At the corners of cells the cost of an overlap is kept.

Limits: shapes without holes; a place within rounding of a segment may count as on either side of it.

Source: L. Guibas, L. Ramshaw, J. Stolfi, "A kinetic framework for computational geometry", 24th Annual Symposium on
Foundations of Computer Science (1983) 100-111: the convolution and its winding number.
"""

from typing import no_type_check

import numpy as np

from stages.nest.separation.compiled import allocating, compiled

GRID = 32
"""Cells along each side of a table."""

NODES = GRID + 1

AWRY_X, AWRY_Y = 0.381966, 0.618034
"""Where in its cell the point lies whose winding number is kept: on no segment, as no shape has such a corner."""

MARGIN = 1e-9
"""A segment reaches into a cell if it comes this near, in cells: rounding."""

FULL_TURN = 2.0 * np.pi


@allocating
@no_type_check
def outline_of(shapes, kind, cos, sin, sign):
    """Return the corners of a shape, counter-clockwise, turned and times a sign, and the directions of its edges."""
    first, end = shapes.first[kind], shapes.first[kind + 1]
    corners = np.zeros((end - first, 2))
    count = 0
    area = 0.0
    for e in range(first, end):
        x, y, tx, ty = shapes.edges[e, 0], shapes.edges[e, 1], shapes.edges[e, 2], shapes.edges[e, 3]
        if x == tx and y == ty:
            continue
        corners[count, 0] = sign * (cos * x - sin * y)
        corners[count, 1] = sign * (sin * x + cos * y)
        area += x * ty - tx * y
        count += 1
    corners = corners[:count]
    if area < 0.0:
        corners = corners[::-1].copy()
    ways = np.zeros(count)
    for i in range(count):
        j = i + 1 if i + 1 < count else 0
        way = np.arctan2(corners[j, 1] - corners[i, 1], corners[j, 0] - corners[i, 0])
        ways[i] = np.pi if way == -np.pi else way
    return corners, ways


@compiled
@no_type_check
def between(way, begin, end, first_too):
    """Return whether a direction is met on the turn to the left from one to another; which end counts is asked for."""
    if first_too:
        if begin <= end:
            return begin <= way < end
        return way >= begin or way < end
    if begin <= end:
        return begin < way <= end
    return way > begin or way <= end


@compiled
@no_type_check
def sense(before, after):
    """Return 1 where an outline turns left, -1 where it turns right, 0 where it goes straight on."""
    turn = after - before
    if turn == 0.0:
        return 0
    if turn > np.pi:
        turn -= FULL_TURN
    elif turn <= -np.pi:
        turn += FULL_TURN
    return 1 if turn > 0.0 else -1


@compiled
@no_type_check
def swept(corners, corner_ways, edges, edge_ways, first_too, rows, count):
    """Fill in the edges of an outline moved along where each is met on the turn at a corner of another; how many now.

    Where the other outline turns to the right the edges run backwards.
    """
    m, n = len(corners), len(edges)
    for i in range(m):
        before, after = corner_ways[i - 1 if i > 0 else m - 1], corner_ways[i]
        side = sense(before, after)
        if side == 0:
            continue
        begin, end = (before, after) if side > 0 else (after, before)
        for j in range(n):
            if between(edge_ways[j], begin, end, first_too):
                k = j + 1 if j + 1 < n else 0
                s, e = (j, k) if side > 0 else (k, j)
                rows[count, 0] = corners[i, 0] + edges[s, 0]
                rows[count, 1] = corners[i, 1] + edges[s, 1]
                rows[count, 2] = corners[i, 0] + edges[e, 0]
                rows[count, 3] = corners[i, 1] + edges[e, 1]
                count += 1
    return count


@compiled
@no_type_check
def convolved(one, one_ways, other, other_ways, rows):
    """Fill in the segments (x0, y0, x1, y1) of the convolution of two outlines, and return how many there are.

    Where edges are parallel those of the other count as turned a little further.
    """
    count = swept(one, one_ways, other, other_ways, True, rows, 0)
    return swept(other, other_ways, one, one_ways, False, rows, count)
