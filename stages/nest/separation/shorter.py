"""Use less of the width of the last rectangle: a roll, or the emptiest of several sheets.

Its width shrinks by a share that halves after each failure.  After a failure the next attempt starts from the best
layout or from one that did not quite work out, mostly with two large items changed about.  In the last part of the time
only small shares are tried, from the best layout itself.
"""

from time import monotonic

import numpy as np

from stages.nest.separation.problem import Arrays
from stages.nest.separation.separate import copy_places
from stages.nest.separation.sharing import Bench, Shared, Wish, parted, same_again, swap_large, within
from stages.nest.separation.state import Layout

EFFORT = (20, 12, 8)
"""Places tried in a move: anywhere, near by, touching a neighbour."""

PATIENCE, SHORT_PATIENCE = 100, 60
"""Rounds without progress until an attempt is given up: while looking for something new, and while polishing."""

FIRST_STEP, LEAST_STEP = 0.01, 0.001
"""Shares by which the width shrinks while something new is looked for."""

POLISH, POLISH_STEP, POLISH_LEAST = 0.75, 5e-4, 1e-5
"""From this share of the time on, and the shares by which the width shrinks from then on to the end."""

POOL = 5
"""Layouts that did not quite work out and are kept."""

AGAIN, SWAP = 0.5, 0.7
"""How often an attempt starts from such a layout instead of the best one; how often items change places."""


def shorter(bench: Bench, shared: Shared, wish: Wish) -> None:
    """Shrink the width of the emptiest rectangle until the time is over."""
    bin_ = last_bin(shared, wish)
    if bin_ < 0:
        return
    given = within(bench.given, shared.used)
    begin, step, seen = monotonic(), FIRST_STEP, -1
    pool: list[Layout] = []
    while (now := monotonic()) < wish.end:
        share = (now - begin) / max(wish.end - begin, 1e-9)
        polishing = share >= POLISH
        if polishing:
            step = POLISH_STEP * (POLISH_LEAST / POLISH_STEP) ** ((share - POLISH) / (1.0 - POLISH))
        found = shared.take(bench.layout)
        if found != seen:
            pool.clear()
        elif not polishing:
            disturb(bench, given, pool)
        seen = found
        given.bins.size[bin_, 0] = shared.width * (1.0 - step)
        left = parted(bench, given, SHORT_PATIENCE if polishing else PATIENCE, EFFORT)
        if left == 0.0:
            shared.better(bench.best, used_width(bench.best, bin_))
        elif bench.stop[0] == 0:
            step = max(step / 2.0, LEAST_STEP)
            pool.append(same_again(bench.best))
            del pool[:-POOL]


def disturb(bench: Bench, given: Arrays, pool: list[Layout]) -> None:
    """Start from another layout, or with items changed about."""
    if pool and bench.rng.random() < AGAIN:
        copy_places(pool[int(bench.rng.integers(len(pool)))], bench.layout)
    if bench.rng.random() < SWAP:
        swap_large(bench, given)


def last_bin(shared: Shared, wish: Wish) -> int:
    """Return the used rectangle whose used width is least; -1 if there is none.  Its width counts from now on."""
    with shared.lock:
        used = {bin_: used_width(shared.layout, bin_) for bin_ in shared.used if wish.rectangle[bin_]}
        bin_ = min(used, key=lambda b: used[b], default=-1)
        if bin_ >= 0 and np.isinf(shared.width):
            shared.width = used[bin_]
    return bin_


def used_width(layout: Layout, bin_: int) -> float:
    """Return how much of the width of a bin is used."""
    return float(layout.box[layout.bin == bin_, 2].max())
