"""Part items that overlap, by guided local search: kernels.

Every item that overlaps is moved to where its weighted overlap is least; then the weights of the pairs that still
overlap are raised and all others fall back towards 1, so that what always ends in the same corner is driven out of it.

Source: as `touching`, with the weights of S. Umetani et al., "Solving the irregular strip packing problem via guided
local search for overlap minimization", International Transactions in Operational Research 16 (2009) 661-683.
"""

from typing import no_type_check

import numpy as np

from stages.nest.separation.compiled import compiled
from stages.nest.separation.laying import WALL, lay, overlap, turn_into, wall
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
def measure(shapes, rules, regions, items, layout, bins, pose, pairs, walls):
    """Return the overlap of all items, unweighted; fill in that of each pair and with the edges of the bins.

    What is fixed is not measured against the edges and what else is fixed: it stays, and others judge it.
    """
    total = 0.0
    for i in range(layout.x.size):
        kind = layout.kind[i]
        turn_into(shapes, kind, layout.cos[i], layout.sin[i], pose)
        walls[i] = 0.0
        if not items.fixed[i]:
            walls[i] = wall(shapes, rules, regions, pose, kind, layout.bin[i], layout.x[i], layout.y[i])
            walls[i] += WALL * sticks_out(bins, layout, i) * shapes.weight[kind]
        total += walls[i]
        for j in range(i):
            found = 0.0
            if layout.bin[i] == layout.bin[j] and not (items.fixed[i] and items.fixed[j]):
                found = overlap(shapes, layout, j, pose, kind, layout.x[i], layout.y[i])
            pairs[i, j] = found
            pairs[j, i] = found
            total += found
    return total


@compiled
@no_type_check
def overlaps_any(pairs, walls, item):
    """Return whether an item overlaps anything."""
    if walls[item] > 0.0:
        return True
    return pairs[item].max() > 0.0


@compiled
@no_type_check
def reweigh(weights, pairs, walls):
    """Raise the weights of what overlaps, let the others fall."""
    worst = max(pairs.max(), walls.max())
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
    target.x[:] = source.x
    target.y[:] = source.y
    target.angle[:] = source.angle
    target.cos[:] = source.cos
    target.sin[:] = source.sin
    target.span[:] = source.span
    target.kind[:] = source.kind
    target.bin[:] = source.bin
    target.edges[:] = source.edges
    target.poles[:] = source.poles
    target.box[:] = source.box


@compiled
@no_type_check
def separate(shapes, rules, regions, items, layout, best, bins, weights, pose, patience, rounds, effort, stop):
    """Return the least overlap reached, 0 if all are parted; `best` is the layout that has it.

    patience: rounds without progress; rounds: most rounds at all; effort: places tried (wide, near, touching).
    stop: an array that another thread may set to break off.
    """
    count = layout.x.size
    pairs = np.zeros((count, count))
    walls = np.zeros(count)
    total = measure(shapes, rules, regions, items, layout, bins, pose, pairs, walls)
    least = total
    copy_places(layout, best)
    since = 0
    for _ in range(rounds):
        if least == 0.0 or since >= patience or stop[0] != 0:
            break
        for item in np.random.permutation(count):
            if not items.fixed[item] and overlaps_any(pairs, walls, item):
                move(shapes, rules, regions, items, layout, bins, weights, pose, item, effort)
        total = measure(shapes, rules, regions, items, layout, bins, pose, pairs, walls)
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
            lay(
                shapes,
                layout,
                pose,
                i,
                layout.kind[i],
                layout.bin[i],
                layout.span[i],
                layout.angle[i],
                layout.cos[i],
                layout.sin[i],
                x,
                y,
            )
