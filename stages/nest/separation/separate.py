"""Part items that overlap, by guided local search: kernels.

Every item that overlaps is moved to where its weighted overlap is least; then the weights of the pairs that still
overlap are raised and all others fall back towards 1, so that what always ends in the same corner is driven out of it.

Source: as `touching`, with the weights of S. Umetani et al., "Solving the irregular strip packing problem via guided
local search for overlap minimization", International Transactions in Operational Research 16 (2009) 661-683.
"""

from typing import no_type_check

import numpy as np

from stages.nest.separation.compiled import allocating, compiled, inlined
from stages.nest.separation.laying import WALL, lay, overlap_with, pose_in, turn_into, wall
from stages.nest.separation.moving import bounds_in, move, sticks_out

RAISE, RAISE_MORE, FALL = 1.2, 0.8, 0.95
"""A weight grows by the first and, in proportion to its share of the worst overlap, the second; or falls back."""

PROGRESS = 0.98
"""An overlap that is smaller by less than this factor is no progress."""


@compiled
@no_type_check
def seed_all(seed):
    """Start the random numbers of this thread."""
    np.random.seed(seed)


@compiled
@no_type_check
def measure(tables, shapes, rules, regions, items, layout, bins, pose, pairs, walls, exact):
    """Return the overlap of all items, unweighted; fill in that of each pair and with the edges of the bins.

    exact: the shapes themselves are asked, not tables.
    What is fixed is not measured against the edges and what else is fixed: it stays, and others judge it.
    """
    total = 0.0
    for i in range(layout.x.size):
        kind = layout.kind[i]
        if exact:
            turn_into(shapes, kind, layout.cos[i], layout.sin[i], pose)
        else:
            pose_in(tables, shapes, kind, layout.span[i], layout.cos[i], layout.sin[i], pose)
        walls[i] = 0.0
        if not items.fixed[i]:
            walls[i] = wall(shapes, rules, regions, pose, kind, layout.bin[i], layout.x[i], layout.y[i])
            walls[i] += WALL * sticks_out(bins, layout, i) * shapes.weight[kind]
        total += walls[i]
        for j in range(i):
            found = 0.0
            if layout.bin[i] == layout.bin[j] and not (items.fixed[i] and items.fixed[j]):
                found = meeting(tables, shapes, layout, j, pose, kind, layout.x[i], layout.y[i])
            pairs[i, j] = found
            pairs[j, i] = found
            total += found
    return total


@inlined
@no_type_check
def meeting(tables, shapes, layout, j, pose, kind, x, y):
    """Return how badly a pose at (x, y) overlaps item j; most are far away."""
    if layout.box[j, 0] >= pose.box[2] + x or layout.box[j, 2] <= pose.box[0] + x:
        return 0.0
    if layout.box[j, 1] >= pose.box[3] + y or layout.box[j, 3] <= pose.box[1] + y:
        return 0.0
    return overlap_with(tables, shapes, layout, j, pose, kind, x, y)


@compiled
@no_type_check
def overlaps_any(pairs, walls, item):
    """Return whether an item overlaps anything."""
    found = walls[item] > 0.0
    for j in range(walls.size):
        found |= pairs[item, j] > 0.0
    return found


@compiled
@no_type_check
def measured(tables, shapes, rules, regions, items, layout, bins, pose, pairs, walls):
    """Return what `measure` does: from tables as long as they tell of an overlap."""
    total = measure(tables, shapes, rules, regions, items, layout, bins, pose, pairs, walls, False)
    if total > 0.0:
        return total
    return measure(tables, shapes, rules, regions, items, layout, bins, pose, pairs, walls, True)


@compiled
@no_type_check
def reweigh(weights, pairs, walls):
    """Raise the weights of what overlaps, let the others fall."""
    worst = 0.0
    for i in range(walls.size):
        worst = max(worst, walls[i])
        for j in range(i):
            worst = max(worst, pairs[i, j])
    if worst <= 0.0:
        return
    for i in range(walls.size):
        if walls[i] > 0.0:
            weights.wall[i] *= RAISE + RAISE_MORE * walls[i] / worst
        else:
            weights.wall[i] = max(1.0, weights.wall[i] * FALL)
        for j in range(walls.size):
            if pairs[i, j] > 0.0:
                weights.pair[i, j] *= RAISE + RAISE_MORE * pairs[i, j] / worst
            elif weights.pair[i, j] > 1.0:
                weights.pair[i, j] = max(1.0, weights.pair[i, j] * FALL)


@compiled
@no_type_check
def copy_places(source, target):
    """Copy a layout."""
    for i in range(source.x.size):
        target.x[i] = source.x[i]
        target.y[i] = source.y[i]
        target.angle[i] = source.angle[i]
        target.cos[i] = source.cos[i]
        target.sin[i] = source.sin[i]
        target.span[i] = source.span[i]
        target.kind[i] = source.kind[i]
        target.bin[i] = source.bin[i]
        for k in range(4):
            target.box[i, k] = source.box[i, k]
    for e in range(source.edges.shape[0]):
        for k in range(4):
            target.edges[e, k] = source.edges[e, k]
    for k in range(3):
        for p in range(source.poles.shape[1]):
            target.poles[k, p] = source.poles[k, p]


@allocating
@no_type_check
def separate(
    tables, shapes, rules, regions, items, layout, best, bins, weights, pose, patience, strikes, rounds, effort, stop
):  # fmt: skip
    """Return the least overlap reached, 0 if all are parted; `best` is the layout that has it.

    patience: rounds without progress until it goes on from the best layout with the weights that it has by then;
    strikes: how often in a row it does that in vain; rounds: most rounds at all; effort: places tried (wide, near,
    touching).
    stop: an array that another thread may set to break off.
    """
    count = layout.x.size
    pairs = np.zeros((count, count))
    walls = np.zeros(count)
    total = measured(tables, shapes, rules, regions, items, layout, bins, pose, pairs, walls)
    least = total
    copy_places(layout, best)
    since = struck = 0
    begun = least
    for _ in range(rounds):
        if since >= patience:
            struck = struck + 1 if least > PROGRESS * begun else 0
            since = 0
            begun = least
            if struck < strikes:
                copy_places(best, layout)
                measured(tables, shapes, rules, regions, items, layout, bins, pose, pairs, walls)
        if least == 0.0 or struck >= strikes or stop[0] != 0:
            break
        for item in np.random.permutation(count):
            if not items.fixed[item] and overlaps_any(pairs, walls, item):
                move(tables, shapes, rules, regions, items, layout, bins, weights, pose, item, effort)
        total = measured(tables, shapes, rules, regions, items, layout, bins, pose, pairs, walls)
        since += 1
        if total < least:
            if total < PROGRESS * least:
                since = 0
            least = total
            copy_places(layout, best)
        reweigh(weights, pairs, walls)
    return least


@compiled
@no_type_check
def close_up(shapes, layout, pose, fixed, bin_, beyond, by):
    """Move what lies beyond a line across a bin back by a distance: a gap closes or an overlap opens along it."""
    for i in range(layout.x.size):
        if layout.bin[i] == bin_ and layout.x[i] > beyond and not fixed[i]:
            lay_at(shapes, layout, pose, i, layout.x[i] - by, layout.y[i])


@compiled
@no_type_check
def lay_at(shapes, layout, pose, i, x, y):
    """Move an item within its bin."""
    kind, bin_, span = layout.kind[i], layout.bin[i], layout.span[i]
    lay(shapes, layout, pose, i, kind, bin_, span, layout.angle[i], layout.cos[i], layout.sin[i], x, y)


@compiled
@no_type_check
def press_in(shapes, layout, bins, pose, fixed):
    """Move every item that is not fixed into the box of its bin."""
    for i in range(layout.x.size):
        if fixed[i]:
            continue
        turn_into(shapes, layout.kind[i], layout.cos[i], layout.sin[i], pose)
        low_x, high_x, low_y, high_y = bounds_in(bins, pose, layout.bin[i])
        x = min(max(layout.x[i], low_x), high_x)
        y = min(max(layout.y[i], low_y), high_y)
        if x != layout.x[i] or y != layout.y[i]:
            lay_at(shapes, layout, pose, i, x, y)
