"""Use less of the width of the last rectangle: a roll, or the emptiest of several sheets.

Its width shrinks by a share that halves after each failure down to a small one, and what lies beyond a random line
across it moves back by as much.  After a failure the next attempt starts from a layout that did not quite work out, one
of the least bad ones more often, with two large items changed about; each thread by itself, so that they look at
different places.  In the last part of the time only small shares are tried, by all threads from the best layout.

Source: the two phases, the random line and the choice of the next layout follow those of `touching`.
"""

from time import monotonic

import numpy as np

from stages.nest.separation.pool import Pool
from stages.nest.separation.problem import Arrays
from stages.nest.separation.separate import close_up, copy_places
from stages.nest.separation.sharing import Bench, Shared, Wish, laid_again, parted, same_again, swap_large, within
from stages.nest.separation.state import Layout

EFFORT = (20, 12, 8)
"""Places tried in a move: anywhere, near by, touching a neighbour."""

PATIENCE, SHORT_PATIENCE = 100, 60
"""Rounds without progress until an attempt goes on from its best layout: while looking for something new, and while
polishing."""

STRIKES = 3
"""How often in a row it may do so in vain."""

FIRST_STEP, LEAST_STEP = 0.01, 0.001
"""Shares by which the width shrinks while something new is looked for."""

ROUGH = 0.5
"""Up to this share of the time before that, what may be turned anyhow is turned by a few angles."""

POLISH, POLISH_STEP, POLISH_LEAST = 0.75, 5e-4, 1e-5
"""From this share of the time on, and the shares by which the width shrinks from then on to the end."""


def shorter(bench: Bench, shared: Shared, wish: Wish) -> None:
    """Shrink the width of the emptiest rectangle until the time is over."""
    bin_ = last_bin(shared, wish)
    if bin_ < 0:
        return
    given = within(bench.given, shared.used)
    begin = monotonic()
    turn = begin + POLISH * (wish.end - begin)
    if given.has_rough:
        explore(bench, given.roughly, shared, bin_, begin + ROUGH * (turn - begin))
    explore(bench, given, shared, bin_, turn)
    polish(bench, given, shared, bin_, (turn, wish.end))


def explore(bench: Bench, given: Arrays, shared: Shared, bin_: int, end: float) -> None:
    """Shrink the width by shares that a layout which is not disturbed cannot bring, each thread by itself."""
    shared.take(bench.layout)
    if bench.given.has_rough:
        laid_again(bench, given)
    own, width, step = same_again(bench.layout), shared.width, FIRST_STEP
    pool = Pool()
    while monotonic() < end:
        narrow(bench, given, bin_, width * (1.0 - step))
        left = parted(bench, given, PATIENCE, EFFORT, STRIKES)
        if left == 0.0:
            copy_places(bench.best, own)
            width = used_width(own, bin_)
            shared.better(own, width, alone=True)
            pool.clear()
            copy_places(own, bench.layout)
        elif bench.stop[0] == 0:
            step = max(step / 2.0, LEAST_STEP)
            pool.keep(left, bench.best)
            copy_places(own, bench.layout)
            disturb(bench, given, pool)


def polish(bench: Bench, given: Arrays, shared: Shared, bin_: int, span: tuple[float, float]) -> None:
    """Shrink the best width of all threads by shares that fall from the first to the second moment of a span."""
    begin, end = span
    while (now := monotonic()) < end:
        share = max(now - begin, 0.0) / max(end - begin, 1e-9)
        step = POLISH_STEP * (POLISH_LEAST / POLISH_STEP) ** share
        shared.take(bench.layout)
        narrow(bench, given, bin_, shared.width * (1.0 - step))
        if parted(bench, given, SHORT_PATIENCE, EFFORT, STRIKES) == 0.0:
            shared.better(bench.best, used_width(bench.best, bin_))


def narrow(bench: Bench, given: Arrays, bin_: int, width: float) -> None:
    """Make a bin narrower; what lies beyond a random line across it moves back by what sticks out."""
    given.bins.size[bin_, 0] = width
    used = used_width(bench.layout, bin_)
    line = used * bench.rng.random()
    close_up(given.shapes, bench.layout, bench.pose, given.items.fixed, bin_, line, max(used - width, 0.0))


def disturb(bench: Bench, given: Arrays, pool: Pool) -> None:
    """Start from another layout if there is one, with two items changed about."""
    pool.take(bench.layout, bench.rng)
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
