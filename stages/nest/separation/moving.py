"""Move one item to where it overlaps least: kernels.

Places are drawn at random over the bins, near where it lies, and where a corner of it meets a corner of a neighbour, an
edge along an edge: only there do parts interlock that fit exactly.  The best few are walked downhill by steps along the
axes, the diagonals and, where it may be turned, in the angle; steps grow after a success and shrink after a failure.
"""

from typing import no_type_check

import numpy as np

from stages.nest.separation.compiled import allocating, compiled, inlined
from stages.nest.separation.contacts import EITHER, contact
from stages.nest.separation.laying import cost_at, lay, may_lie, pose_in, turn_into

KEPT = 3
"""Places that are walked downhill."""

NEAR = 0.25
"""A place near by is at most this share of the size away."""

COARSE, COARSE_END, FINE, FINE_END = 0.1, 0.01, 0.01, 0.001
"""First and last step of the walks, in sizes: that of the best few, and that of the best one."""

GROW, SHRINK, MOST = 1.1, 0.5, 4.0
"""A step after a success and after a failure; it never grows beyond so many first steps."""

FITS = 1e-7
"""A box may be larger than the bin by this: rounding; mm."""

CROSSING_OVER = 0.3
"""Share of the far places that are in another bin, where there are several."""

TURNING = 0.35
"""Share of the steps that turn the item, where it may be turned."""

FAR, NEARBY, TOUCHING = 0, 1, 2
"""Sorts of places: anywhere, near where the item lies, a corner at a corner of a neighbour."""

TO_AND_FRO = (-1.0, 1.0)
ALONG_X, ALONG_Y, FALLING, WAYS = 0, 1, 2, 4
"""Ways of a step: along the axes, along the falling and the rising diagonal."""


@inlined
@no_type_check
def bounds_in(bins, pose, bin_):
    """Return where the middle of a pose may be in a bin, least and most x and y; empty if it does not fit."""
    low_x = -pose.box[0]
    high_x = bins.size[bin_, 0] - pose.box[2]
    low_y = -pose.box[1]
    high_y = bins.size[bin_, 1] - pose.box[3]
    if low_x - FITS <= high_x < low_x:
        low_x = high_x = (low_x + high_x) / 2.0
    if low_y - FITS <= high_y < low_y:
        low_y = high_y = (low_y + high_y) / 2.0
    return low_x, high_x, low_y, high_y


@compiled
@no_type_check
def sticks_out(bins, layout, item):
    """Return how far an item sticks out of the box of its bin, mm; 0 if only by what counts as fitting."""
    box = layout.box[item]
    wide, high = bins.size[layout.bin[item], 0], bins.size[layout.bin[item], 1]
    far = max(-box[0], -box[1], box[2] - wide, box[3] - high)
    return far if far > 2.0 * FITS else 0.0


@inlined
@no_type_check
def any_turn(rules, kind, bin_):
    """Return a random span of a kind in a bin, an angle of it, its cosine and sine."""
    span = np.random.randint(rules.turn[kind, bin_], rules.turns[kind, bin_])
    low = rules.span[span, 0]
    high = rules.span[span, 1]
    if low == high:
        return span, low, rules.span[span, 2], rules.span[span, 3]
    angle = low + (high - low) * np.random.random()
    return span, angle, np.cos(angle), np.sin(angle)


@compiled
@no_type_check
def walk(tables, shapes, rules, regions, layout, bins, weights, pose, item, place, cost, step, end):
    """Return the place and cost at the end of a walk downhill; the pose is left as it is there, or nearly so."""
    kind, bin_, span, angle, cos, sin, x, y = place
    pose_in(tables, shapes, kind, span, cos, sin, pose)
    low, high = rules.span[span, 0], rules.span[span, 1]
    size = shapes.size[kind]
    step_x = step_y = step * size
    step_a = 2.0 * step if low < high else 0.0
    most = MOST * step * size
    least = end * size
    low_x, high_x, low_y, high_y = bounds_in(bins, pose, bin_)
    while cost > 0.0 and (step_x > least or step_y > least or step_a > 2.0 * end):
        good = False
        if step_a > 2.0 * end and (np.random.random() < TURNING or not (step_x > least or step_y > least)):
            for sign in TO_AND_FRO:
                a = min(max(angle + sign * step_a, low), high)
                c = np.cos(a)
                s = np.sin(a)
                turn_into(shapes, kind, c, s, pose)
                lx, hx, ly, hy = bounds_in(bins, pose, bin_)
                if lx > hx or ly > hy:
                    continue
                nx = min(max(x, lx), hx)
                ny = min(max(y, ly), hy)
                found = cost_at(tables, shapes, rules, regions, layout, weights, pose, item, kind, bin_, nx, ny, cost)
                if found < cost:
                    cost, x, y, angle, cos, sin, good = found, nx, ny, a, c, s, True
                    low_x, high_x, low_y, high_y = lx, hx, ly, hy
                    break
            if not good:
                turn_into(shapes, kind, cos, sin, pose)
            step_a = min(step_a * (GROW if good else SHRINK), 2.0 * MOST * step)
            continue
        way = np.random.randint(0, WAYS)
        ax = 0.0 if way == ALONG_Y else step_x
        ay = 0.0 if way == ALONG_X else (-step_y if way == FALLING else step_y)
        for sign in TO_AND_FRO:
            nx = min(max(x + sign * ax, low_x), high_x)
            ny = min(max(y + sign * ay, low_y), high_y)
            if nx == x and ny == y:
                continue
            found = cost_at(tables, shapes, rules, regions, layout, weights, pose, item, kind, bin_, nx, ny, cost)
            if found < cost:
                cost, x, y, good = found, nx, ny, True
                break
        factor = GROW if good else SHRINK
        if way != ALONG_Y:
            step_x = min(step_x * factor, most)
        if way != ALONG_X:
            step_y = min(step_y * factor, most)
    return (kind, bin_, span, angle, cos, sin, x, y), cost


@inlined
@no_type_check
def draw(shapes, rules, items, layout, bins, item, here, sort):
    """Return (found, place) of a random place of a sort: FAR, NEARBY or TOUCHING; x and y count for the last alone."""
    bin_ = here[1]
    count = bins.size.shape[0]
    if sort == FAR and count > 1 and np.random.random() < CROSSING_OVER:
        bin_ = np.random.randint(0, count)
    kind = items.kind[item] if np.random.random() < EITHER else items.other[item]
    if not may_lie(rules, kind, bin_):
        return False, here
    span, angle, cos, sin = any_turn(rules, kind, bin_)
    if sort == NEARBY and kind == here[0] and np.random.random() < EITHER:
        span, angle, cos, sin = here[2], here[3], here[4], here[5]
    if sort != TOUCHING:
        return True, (kind, bin_, span, angle, cos, sin, here[6], here[7])
    found, turned, x, y = contact(shapes, rules, layout, item, kind, bin_, span, angle)
    if turned != angle:
        angle, cos, sin = turned, np.cos(turned), np.sin(turned)
    return found, (kind, bin_, span, angle, cos, sin, x, y)


@inlined
@no_type_check
def moved_in(shapes, bins, pose, place, sort):
    """Return (found, x, y) within the bin for a place of a sort whose shape is in the pose."""
    low_x, high_x, low_y, high_y = bounds_in(bins, pose, place[1])
    x, y = place[6], place[7]
    if low_x > high_x or low_y > high_y:
        return False, x, y
    if sort == FAR:
        return True, low_x + (high_x - low_x) * np.random.random(), low_y + (high_y - low_y) * np.random.random()
    if sort == NEARBY:
        reach = NEAR * shapes.size[place[0]]
        x += reach * np.random.uniform(-1.0, 1.0)
        y += reach * np.random.uniform(-1.0, 1.0)
        return True, min(max(x, low_x), high_x), min(max(y, low_y), high_y)
    return low_x - FITS <= x <= high_x + FITS and low_y - FITS <= y <= high_y + FITS, x, y


@allocating
@no_type_check
def best_draws(tables, shapes, rules, regions, items, layout, bins, weights, pose, item, here, cost0, effort):
    """Return the best places drawn, with their costs; the first of them is where the item lies or better."""
    costs = np.full(KEPT, np.inf)
    costs[0] = cost0
    places = [here] * KEPT
    for sample in range(effort[0] + effort[1] + effort[2]):
        sort = FAR if sample < effort[0] else (NEARBY if sample < effort[0] + effort[1] else TOUCHING)
        found, place = draw(shapes, rules, items, layout, bins, item, here, sort)
        if not found:
            continue
        pose_in(tables, shapes, place[0], place[2], place[4], place[5], pose)
        found, x, y = moved_in(shapes, bins, pose, place, sort)
        if not found:
            continue
        kind, bin_ = place[0], place[1]
        cost = cost_at(tables, shapes, rules, regions, layout, weights, pose, item, kind, bin_, x, y, costs[KEPT - 1])
        if cost >= costs[KEPT - 1]:
            continue
        k = KEPT - 1
        while k > 0 and costs[k - 1] > cost:
            costs[k] = costs[k - 1]
            places[k] = places[k - 1]
            k -= 1
        costs[k] = cost
        places[k] = (kind, bin_, place[2], place[3], place[4], place[5], x, y)
        if cost == 0.0:
            break
    return costs, places


@allocating
@no_type_check
def move(tables, shapes, rules, regions, items, layout, bins, weights, pose, item, effort):
    """Move an item to the best place found and return its cost; effort: how many places of each sort are tried."""
    kind, bin_, x, y = layout.kind[item], layout.bin[item], layout.x[item], layout.y[item]
    here = (kind, bin_, layout.span[item], layout.angle[item], layout.cos[item], layout.sin[item], x, y)
    pose_in(tables, shapes, kind, here[2], here[4], here[5], pose)
    cost = cost_at(tables, shapes, rules, regions, layout, weights, pose, item, kind, bin_, x, y, np.inf)
    if sticks_out(bins, layout, item) > 0.0:
        cost = np.inf
    if cost == 0.0:
        return 0.0
    costs, places = best_draws(
        tables, shapes, rules, regions, items, layout, bins, weights, pose, item, here, cost, effort
    )
    best = np.inf
    place = here
    for k in range(KEPT):
        if costs[k] < np.inf and best > 0.0:
            end, cost = walk(
                tables,
                shapes,
                rules,
                regions,
                layout,
                bins,
                weights,
                pose,
                item,
                places[k],
                costs[k],
                COARSE,
                COARSE_END,
            )
            if cost < best:
                best = cost
                place = end
    if best == np.inf:
        return best
    place, best = walk(tables, shapes, rules, regions, layout, bins, weights, pose, item, place, best, FINE, FINE_END)
    kind, bin_, span, angle, cos, sin, x, y = place
    lay(shapes, layout, pose, item, kind, bin_, span, angle, cos, sin, x, y)
    return best
