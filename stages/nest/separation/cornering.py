"""Fit shapes into a corner, and how much of their outline then touches something: kernels."""

from typing import no_type_check

import numpy as np

from stages.nest.separation.compiled import allocating, compiled
from stages.nest.separation.laying import cost_at, turn_into
from stages.nest.separation.moving import bounds_in
from stages.nest.separation.touching import is_inside

PARALLEL = 1e-4
"""Edges touch along their length if the sine of their angle is smaller."""

PARTLY = 0.2
"""What edges have in common counts so much where they are not alike, end to end: that is no sign of a common cut."""

AROUND = 16
"""Directions in which a point is asked for free room beside it."""


@compiled
@no_type_check
def edge_length(edges, i):
    """Return the length of an edge."""
    return np.hypot(edges[i, 2] - edges[i, 0], edges[i, 3] - edges[i, 1])


@compiled
@no_type_check
def common_length(one, i, other, j, dx, dy, near):
    """Return how long edge i of `one` and edge j of `other`, moved by (dx, dy), run along each other face to face."""
    ax = one[i, 2] - one[i, 0]
    ay = one[i, 3] - one[i, 1]
    bx = other[j, 2] - other[j, 0]
    by = other[j, 3] - other[j, 1]
    length = edge_length(one, i)
    if length == 0.0 or ax * bx + ay * by >= 0.0:
        return 0.0
    if abs(ax * by - ay * bx) > PARALLEL * length * edge_length(other, j):
        return 0.0
    ux = ax / length
    uy = ay / length
    px = other[j, 0] + dx - one[i, 0]
    py = other[j, 1] + dy - one[i, 1]
    if abs(ux * py - uy * px) > near:
        return 0.0
    begin = ux * px + uy * py
    end = begin + ux * bx + uy * by
    return max(0.0, min(length, begin) - max(0.0, end))


@allocating
@no_type_check
def touching_length(shapes, layout, bins, pose, kind, bin_, x, y, near):
    """Return how much of the outline of a pose at (x, y) runs along other items or the edges of its bin, mm."""
    total = 0.0
    width, height = bins.size[bin_, 0], bins.size[bin_, 1]
    walls = np.array([[0.0, height, 0.0, 0.0], [0.0, 0.0, width, 0.0], [width, height, 0.0, height]])
    for i in range(shapes.first[kind + 1] - shapes.first[kind]):
        for k in range(walls.shape[0]):
            back = walls[k : k + 1]
            turned = np.array([[back[0, 2], back[0, 3], back[0, 0], back[0, 1]]])
            total += common_length(pose.edges, i, turned, 0, -x, -y, near)
            total += common_length(pose.edges, i, back, 0, -x, -y, near)
        for item in range(layout.x.size):
            if layout.bin[item] != bin_:
                continue
            for j in range(layout.first[item], layout.first[item + 1]):
                common = common_length(pose.edges, i, layout.edges, j, -x, -y, near)
                whole = max(edge_length(pose.edges, i), edge_length(layout.edges, j))
                total += common if common >= whole - near else PARTLY * common
    return total


@compiled
@no_type_check
def is_free(layout, bins, bin_, x, y):
    """Return whether a point lies in the bin and in no item."""
    if x < 0.0 or y < 0.0 or x > bins.size[bin_, 0] or y > bins.size[bin_, 1]:
        return False
    for item in range(layout.x.size):
        if layout.bin[item] == bin_ and is_inside(layout.edges, layout.first[item], layout.first[item + 1], x, y):
            return False
    return True


@compiled
@no_type_check
def first_corner(shapes, layout, bins, bin_, step, after):
    """Return the leftmost, then lowest corner with free room a step beside it, right of (`after`); inf if none.

    Corners are those of the items and of the left end of the bin.
    """
    best_x = best_y = np.inf
    for item in range(-1, layout.x.size):
        if item >= 0 and layout.bin[item] != bin_:
            continue
        kind = layout.kind[max(item, 0)]
        count = shapes.tip[kind + 1] - shapes.tip[kind] if item >= 0 else 1
        for p in range(count):
            x = y = 0.0
            if item >= 0:
                tip = shapes.tips[shapes.tip[kind] + p]
                x = layout.cos[item] * tip[0] - layout.sin[item] * tip[1] + layout.x[item]
                y = layout.sin[item] * tip[0] + layout.cos[item] * tip[1] + layout.y[item]
            if not (x > after[0] or (x == after[0] and y > after[1])):
                continue
            if x > best_x or (x == best_x and y >= best_y):
                continue
            for way in range(AROUND):
                angle = 2.0 * np.pi * (way + 0.5) / AROUND
                if is_free(layout, bins, bin_, x + step * np.cos(angle), y + step * np.sin(angle)):
                    best_x = x
                    best_y = y
                    break
    return best_x, best_y


@compiled
@no_type_check
def corner_fits(tables, shapes, rules, regions, layout, bins, weights, pose, kinds, bin_, x, y, near, out):
    """Fill in (kind, span, x, y, length touching, outline) of all that fits with a corner at (x, y); how many."""
    count = 0
    for kind in kinds:
        for span in range(rules.turn[kind, bin_], rules.turns[kind, bin_]):
            cos, sin = rules.span[span, 2], rules.span[span, 3]
            turn_into(shapes, kind, cos, sin, pose)
            low_x, high_x, low_y, high_y = bounds_in(bins, pose, bin_)
            outline = 0.0
            for i in range(shapes.first[kind + 1] - shapes.first[kind]):
                outline += edge_length(pose.edges, i)
            for p in range(shapes.tip[kind], shapes.tip[kind + 1]):
                mx = x - (cos * shapes.tips[p, 0] - sin * shapes.tips[p, 1])
                my = y - (sin * shapes.tips[p, 0] + cos * shapes.tips[p, 1])
                if mx < low_x - near or mx > high_x + near or my < low_y - near or my > high_y + near:
                    continue
                if cost_at(tables, shapes, rules, regions, layout, weights, pose, -1, kind, bin_, mx, my, 0.0) > 0.0:
                    continue
                if count < out.shape[0]:
                    length = touching_length(shapes, layout, bins, pose, kind, bin_, mx, my, near)
                    out[count, 0] = kind
                    out[count, 1] = span
                    out[count, 2] = mx
                    out[count, 3] = my
                    out[count, 4] = length
                    out[count, 5] = outline
                    count += 1
    return count
