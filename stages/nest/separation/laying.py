"""Lay shapes into a layout, and what an item would cost at a place: kernels."""

from typing import no_type_check

import numpy as np

from stages.nest.separation.compiled import compiled, inlined
from stages.nest.separation.state import NOWHERE, RECTANGLE
from stages.nest.separation.tables import looked_up
from stages.nest.separation.touching import FIRST_POLES, LEAST_DEPTH, discs_overlap, edges_cross, is_inside, severity

WALL = 2.0
"""What leaves its bin costs so much more than what lies on another part: that part may move, the bin does not."""

CELLS = 1.5
"""The distance to the edge is read from a grid: within so many cells of 0 the edges themselves are asked."""


@inlined
@no_type_check
def pose_in(tables, shapes, kind, span, cos, sin, pose):
    """Take a shape turned about its middle for a pose: but its box where tables may be all that is asked."""
    if tables.relation[span, span] < 0:
        turn_into(shapes, kind, cos, sin, pose)
        return
    for k in range(4):
        pose.box[k] = tables.box[kind, span, k]
    pose.turn[0] = cos
    pose.turn[1] = sin
    pose.span[0] = span
    pose.filled[0] = 0


@compiled
@no_type_check
def complete(shapes, kind, pose):
    """Fill a pose that has but its box."""
    if pose.filled[0] == 0:
        span = pose.span[0]
        turn_into(shapes, kind, pose.turn[0], pose.turn[1], pose)
        pose.span[0] = span


@compiled
@no_type_check
def turn_into(shapes, kind, cos, sin, pose):
    """Fill a pose with a shape turned about its middle."""
    pose.turn[0] = cos
    pose.turn[1] = sin
    pose.span[0] = -1
    pose.filled[0] = 1
    low_x = low_y = np.inf
    high_x = high_y = -np.inf
    at = shapes.first[kind]
    for i in range(shapes.first[kind + 1] - at):
        for k in range(0, 4, 2):
            x = shapes.edges[at + i, k]
            y = shapes.edges[at + i, k + 1]
            tx = cos * x - sin * y
            ty = sin * x + cos * y
            pose.edges[i, k] = tx
            pose.edges[i, k + 1] = ty
            low_x = min(low_x, tx)
            high_x = max(high_x, tx)
            low_y = min(low_y, ty)
            high_y = max(high_y, ty)
    pose.box[0] = low_x
    pose.box[1] = low_y
    pose.box[2] = high_x
    pose.box[3] = high_y
    at = shapes.pole[kind]
    for i in range(shapes.pole[kind + 1] - at):
        x = shapes.poles[0, at + i]
        y = shapes.poles[1, at + i]
        pose.poles[0, i] = cos * x - sin * y
        pose.poles[1, i] = sin * x + cos * y
        pose.poles[2, i] = shapes.poles[2, at + i]


@compiled
@no_type_check
def lay(shapes, layout, pose, item, kind, bin_, span, angle, cos, sin, x, y):
    """Put an item where it is to lie."""
    layout.x[item] = x
    layout.y[item] = y
    layout.angle[item] = angle
    layout.cos[item] = cos
    layout.sin[item] = sin
    layout.span[item] = span
    layout.kind[item] = kind
    layout.bin[item] = bin_
    turn_into(shapes, kind, cos, sin, pose)
    at = layout.first[item]
    for i in range(layout.first[item + 1] - at):
        layout.edges[at + i, 0] = pose.edges[i, 0] + x
        layout.edges[at + i, 1] = pose.edges[i, 1] + y
        layout.edges[at + i, 2] = pose.edges[i, 2] + x
        layout.edges[at + i, 3] = pose.edges[i, 3] + y
    at = layout.pole[item]
    for i in range(layout.pole[item + 1] - at):
        layout.poles[0, at + i] = pose.poles[0, i] + x
        layout.poles[1, at + i] = pose.poles[1, i] + y
        layout.poles[2, at + i] = pose.poles[2, i]
    layout.box[item, 0] = pose.box[0] + x
    layout.box[item, 1] = pose.box[1] + y
    layout.box[item, 2] = pose.box[2] + x
    layout.box[item, 3] = pose.box[3] + y


@compiled
@no_type_check
def overlap(shapes, layout, j, pose, kind, x, y):
    """Return how badly a pose at (x, y) overlaps item j; 0 if it does not."""
    low_x = max(layout.box[j, 0], pose.box[0] + x)
    high_x = min(layout.box[j, 2], pose.box[2] + x)
    if low_x >= high_x:
        return 0.0
    low_y = max(layout.box[j, 1], pose.box[1] + y)
    high_y = min(layout.box[j, 3], pose.box[3] + y)
    if low_y >= high_y:
        return 0.0
    e0 = layout.first[j]
    e1 = layout.first[j + 1]
    p0 = layout.pole[j]
    p1 = layout.pole[j + 1]
    edges = shapes.first[kind + 1] - shapes.first[kind]
    poles = shapes.pole[kind + 1] - shapes.pole[kind]
    touch = discs_overlap(layout.poles, p0, p0 + FIRST_POLES, pose.poles, 0, poles, x, y)
    if not touch:
        touch = edges_cross(layout.edges, e0, e1, pose.edges, 0, edges, x, y, (low_x, low_y, high_x, high_y), pose.near)
    if not touch:
        touch = is_inside(layout.edges, e0, e1, pose.edges[0, 0] + x, pose.edges[0, 1] + y)
    if not touch:
        touch = is_inside(pose.edges, 0, edges, layout.edges[e0, 0] - x, layout.edges[e0, 1] - y)
    if not touch:
        return 0.0
    return severity(shapes, layout.kind[j], kind, layout.poles, p0, p1, pose.poles, 0, poles, x, y)


@inlined
@no_type_check
def overlap_with(tables, shapes, layout, j, pose, kind, x, y):
    """Return how badly a pose at (x, y) overlaps item j, from a table if there can be one."""
    own = pose.span[0]
    span = layout.span[j]
    if own >= 0 and tables.relation[span, own] >= 0:
        other = layout.kind[j]
        dx = x - layout.x[j]
        dy = y - layout.y[j]
        if other <= kind:
            table = tables.number[other, kind, tables.relation[span, own]]
            cos = layout.cos[j]
            sin = layout.sin[j]
        else:
            table = tables.number[kind, other, tables.relation[own, span]]
            cos = -pose.turn[0]
            sin = -pose.turn[1]
        if table >= 0:
            return looked_up(tables, table, cos * dx + sin * dy, cos * dy - sin * dx)
    complete(shapes, kind, pose)
    return overlap(shapes, layout, j, pose, kind, x, y)


@compiled
@no_type_check
def distance_in(regions, k, x, y):
    """Return the distance to the edge of a region, positive inside, from its grid; mm."""
    rows = regions.shape[k, 0]
    columns = regions.shape[k, 1]
    u = (x - regions.origin[k, 0]) / regions.cell[k]
    v = (y - regions.origin[k, 1]) / regions.cell[k]
    cu = min(max(u, 0.0), columns - 1.000001)
    cv = min(max(v, 0.0), rows - 1.000001)
    i = int(cv)
    j = int(cu)
    a = cv - i
    c = cu - j
    at = regions.start[k] + i * columns + j
    low = (1.0 - c) * regions.field[at] + c * regions.field[at + 1]
    high = (1.0 - c) * regions.field[at + columns] + c * regions.field[at + columns + 1]
    return (1.0 - a) * low + a * high - (abs(u - cu) + abs(v - cv)) * regions.cell[k]


@compiled
@no_type_check
def leaves(shapes, regions, k, pose, kind, x, y):
    """Return whether a pose at (x, y) is not wholly within a region."""
    edges = shapes.first[kind + 1] - shapes.first[kind]
    poles = shapes.pole[kind + 1] - shapes.pole[kind]
    slack = CELLS * regions.cell[k]
    for p in range(poles):
        if pose.poles[2, p] - distance_in(regions, k, x + pose.poles[0, p], y + pose.poles[1, p]) > slack:
            return True
    e0 = regions.first[k]
    e1 = regions.first[k + 1]
    clip = (pose.box[0] + x, pose.box[1] + y, pose.box[2] + x, pose.box[3] + y)
    if edges_cross(regions.edges, e0, e1, pose.edges, 0, edges, x, y, clip, pose.near):
        return True
    if not is_inside(regions.edges, e0, e1, pose.edges[0, 0] + x, pose.edges[0, 1] + y):
        return True
    for p in range(regions.point[k], regions.point[k + 1]):
        px = regions.points[p, 0]
        py = regions.points[p, 1]
        if clip[0] < px < clip[2] and clip[1] < py < clip[3] and is_inside(pose.edges, 0, edges, px - x, py - y):
            return True
    return False


@compiled
@no_type_check
def wall(shapes, rules, regions, pose, kind, bin_, x, y):
    """Return how badly a pose at (x, y) leaves what it may lie on in a bin; 0 if it does not."""
    k = rules.region[kind, bin_]
    if k == RECTANGLE:
        return 0.0
    if distance_in(regions, k, x, y) > shapes.reach[kind] + CELLS * regions.cell[k]:
        return 0.0
    complete(shapes, kind, pose)
    if not leaves(shapes, regions, k, pose, kind, x, y):
        return 0.0
    eps = LEAST_DEPTH * shapes.size[kind]
    deep = 0.0
    for p in range(shapes.pole[kind + 1] - shapes.pole[kind]):
        radius = pose.poles[2, p]
        into = radius - distance_in(regions, k, x + pose.poles[0, p], y + pose.poles[1, p])
        if into < eps:
            into = eps * eps / (2.0 * eps - into)
        deep += into * radius
    return WALL * np.sqrt(deep + eps * eps) * shapes.weight[kind]


@inlined
@no_type_check
def cost_at(tables, shapes, rules, regions, layout, weights, pose, item, kind, bin_, x, y, limit):
    """Return the weighted overlap of an item in a pose at (x, y); what is above the limit may be too small."""
    cost = 0.0
    if rules.region[kind, bin_] != RECTANGLE:
        cost = weights.wall[item] * wall(shapes, rules, regions, pose, kind, bin_, x, y)
        if cost >= limit:
            return cost
    low_x = pose.box[0] + x
    low_y = pose.box[1] + y
    high_x = pose.box[2] + x
    high_y = pose.box[3] + y
    for j in range(layout.x.size):
        if layout.box[j, 0] >= high_x or layout.box[j, 2] <= low_x:
            continue
        if layout.box[j, 1] >= high_y or layout.box[j, 3] <= low_y:
            continue
        if layout.bin[j] != bin_ or j == item:
            continue
        found = overlap_with(tables, shapes, layout, j, pose, kind, x, y)
        if found > 0.0:
            cost += found * weights.pair[item, j]
            if cost >= limit:
                return cost
    return cost


@compiled
@no_type_check
def may_lie(rules, kind, bin_):
    """Return whether a kind may lie in a bin at all."""
    return rules.region[kind, bin_] != NOWHERE and rules.turn[kind, bin_] < rules.turns[kind, bin_]
