"""How badly two items overlap, looked up by their relative place: kernels.

A table holds, for one shape beside another in one relative angle, what `convolution` finds on a grid over all places
where they could overlap.  Only where shapes are simple and angles are lists; in every other case `laying` asks the
shapes themselves.

A cell where no segment of the convolution ends up is clear or covered as a whole; in all others the winding number of
the place is found from that of one point of the cell.  The cost is linear between the corners of the cell.
"""

from typing import no_type_check

import numpy as np

from stages.nest.separation.compiled import allocating, compiled, inlined
from stages.nest.separation.convolution import AWRY_X, AWRY_Y, GRID, MARGIN, NODES, convolved, outline_of
from stages.nest.separation.touching import severity

NO_TABLE = -1
"""In place of the number of a table: a shape has holes, or there are too many."""


@allocating
@no_type_check
def fill(tables, shapes, table, one, other, relation):
    """Fill a table for a kind beside another at a relative angle, all but its segments: these are returned, (s, 4)."""
    cos, sin = tables.turn[relation, 0], tables.turn[relation, 1]
    fixed, fixed_ways = outline_of(shapes, one, 1.0, 0.0, 1.0)
    moved, moved_ways = outline_of(shapes, other, cos, sin, -1.0)
    rows = np.zeros((2 * len(fixed) * len(moved), 4))
    rows = rows[: convolved(fixed, fixed_ways, moved, moved_ways, rows)]
    for k in range(2):
        low = high = rows[0, k]
        for s in range(len(rows)):
            low = min(low, rows[s, k])
            high = max(high, rows[s, k])
        tables.frame[table, k] = low - MARGIN * (high - low)
        tables.frame[table, k + 2] = GRID / ((high - low) * (1.0 + 2.0 * MARGIN))
    segments = sort_in(tables, table, rows)
    price(tables, table, shapes, one, other, cos, sin)
    return segments


@compiled
@no_type_check
def reaches(row, frame, r):
    """Return the first and last column that a segment reaches into in a row of cells, in cells; first > last: none."""
    x0 = (row[0] - frame[0]) * frame[2]
    y0 = (row[1] - frame[1]) * frame[3]
    x1 = (row[2] - frame[0]) * frame[2]
    y1 = (row[3] - frame[1]) * frame[3]
    if y0 > y1:
        x0, y0, x1, y1 = x1, y1, x0, y0
    low, high = r - MARGIN, r + 1 + MARGIN
    if y1 < low or y0 > high:
        return 1, 0
    a, b = x0, x1
    if y1 > y0:
        if y0 < low:
            a = x0 + (x1 - x0) * (low - y0) / (y1 - y0)
        if y1 > high:
            b = x0 + (x1 - x0) * (high - y0) / (y1 - y0)
    first = int(np.floor(min(a, b) - MARGIN))
    last = int(np.floor(max(a, b) + MARGIN))
    return max(first, 0), min(last, GRID - 1)


@compiled
@no_type_check
def rows_of(row, frame):
    """Return the first and last row of cells that a segment reaches into."""
    y0 = (row[1] - frame[1]) * frame[3]
    y1 = (row[3] - frame[1]) * frame[3]
    return max(int(np.floor(min(y0, y1) - MARGIN)), 0), min(int(np.floor(max(y0, y1) + MARGIN)), GRID - 1)


@allocating
@no_type_check
def sort_in(tables, table, rows):
    """Keep the winding number of each cell and where its segments begin; return the segments cell by cell."""
    frame = tables.frame[table]
    count = np.zeros(GRID * GRID + 1, dtype=np.int64)
    step = np.zeros((GRID, GRID), dtype=np.int64)
    for s in range(len(rows)):
        low, high = rows_of(rows[s], frame)
        for r in range(low, high + 1):
            first, last = reaches(rows[s], frame, r)
            for c in range(first, last + 1):
                count[r * GRID + c + 1] += 1
            wind(step[r], rows[s], frame, r)
    for r in range(GRID):
        total = 0
        for c in range(GRID - 1, -1, -1):
            total += step[r, c]
            tables.winding[table, r * GRID + c] = total
    for cell in range(GRID * GRID):
        count[cell + 1] += count[cell]
        tables.start[table, cell + 1] = count[cell + 1]
    segments = np.zeros((count[GRID * GRID], 4))
    for s in range(len(rows)):
        low, high = rows_of(rows[s], frame)
        for r in range(low, high + 1):
            first, last = reaches(rows[s], frame, r)
            for c in range(first, last + 1):
                for k in range(4):
                    segments[count[r * GRID + c], k] = rows[s, k]
                count[r * GRID + c] += 1
    return segments


@compiled
@no_type_check
def wind(step, row, frame, r):
    """Count a segment for all points of a row of cells that lie to the left of where it crosses their line."""
    y = frame[1] + (r + AWRY_Y) / frame[3]
    if (row[1] > y) == (row[3] > y):
        return
    x = row[0] + (row[2] - row[0]) * (y - row[1]) / (row[3] - row[1])
    last = int(np.ceil((x - frame[0]) * frame[2] - AWRY_X)) - 1
    if last >= 0:
        step[min(last, GRID - 1)] += 1 if row[3] > row[1] else -1


@allocating
@no_type_check
def price(tables, table, shapes, one, other, cos, sin):
    """Keep the cost of an overlap at the corners of all cells."""
    frame = tables.frame[table]
    a0, a1 = shapes.pole[one], shapes.pole[one + 1]
    b0, b1 = shapes.pole[other], shapes.pole[other + 1]
    turned = np.zeros((3, b1 - b0))
    for p in range(b0, b1):
        turned[0, p - b0] = cos * shapes.poles[0, p] - sin * shapes.poles[1, p]
        turned[1, p - b0] = sin * shapes.poles[0, p] + cos * shapes.poles[1, p]
        turned[2, p - b0] = shapes.poles[2, p]
    for r in range(NODES):
        y = frame[1] + r / frame[3]
        for c in range(NODES):
            x = frame[0] + c / frame[2]
            tables.cost[table, r * NODES + c] = severity(
                shapes, one, other, shapes.poles, a0, a1, turned, 0, b1 - b0, x, y
            )


@inlined
@no_type_check
def looked_up(tables, table, x, y):
    """Return how badly the shapes of a table overlap at a relative place; 0 if they do not."""
    u = (x - tables.frame[table, 0]) * tables.frame[table, 2]
    v = (y - tables.frame[table, 1]) * tables.frame[table, 3]
    if not (0.0 < u < GRID and 0.0 < v < GRID):
        return 0.0
    c = int(u)
    r = int(v)
    cell = r * GRID + c
    winding = np.int64(tables.winding[table, cell])
    first = tables.start[table, cell]
    end = tables.start[table, cell + 1]
    if first < end:
        winding += wound(tables, table, first, end, c, r, x, y)
    if winding == 0:
        return 0.0
    a = u - c
    b = v - r
    at = r * NODES + c
    low = (1.0 - a) * tables.cost[table, at] + a * tables.cost[table, at + 1]
    high = (1.0 - a) * tables.cost[table, at + NODES] + a * tables.cost[table, at + NODES + 1]
    return (1.0 - b) * low + b * high


@inlined
@no_type_check
def wound(tables, table, first, end, c, r, x, y):
    """Return by how much the winding number at a place differs from that of the point of its cell."""
    rx = tables.frame[table, 0] + (c + AWRY_X) / tables.frame[table, 2]
    ry = tables.frame[table, 1] + (r + AWRY_Y) / tables.frame[table, 3]
    fx = x - rx
    fy = y - ry
    winding = 0
    for s in range(first, end):
        px = tables.segments[s, 0] - rx
        py = tables.segments[s, 1] - ry
        qx = tables.segments[s, 2] - rx
        qy = tables.segments[s, 3] - ry
        if (fx * py - fy * px > 0.0) != (fx * qy - fy * qx > 0.0):
            ex = qx - px
            ey = qy - py
            winding += int(ex * (fy - py) - ey * (fx - px) > 0.0) - int(ey * px - ex * py > 0.0)
    return winding
