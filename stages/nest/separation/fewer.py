"""Look for a layout on fewer or cheaper bins.

Choices of bins that count less and are large enough by their area are tried in turn: the items of all other bins are
dealt over them at random, and all are parted.  Of each choice the least bad layouts are kept; most attempts go on from
one of those of the most promising choice, disturbed: two large items change places, or some are laid anywhere.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import combinations, islice
from time import monotonic

import numpy as np

from stages.nest.separation.pool import Pool
from stages.nest.separation.problem import Problem
from stages.nest.separation.sharing import Bench, Shared, Wish, anywhere, parted, swap_large, within

EFFORT = (40, 12, 8)
"""Places tried in a move: anywhere, near by, touching a neighbour."""

PATIENCE, STRIKES = 100, 3
"""Rounds without progress until an attempt goes on from its best layout; how often in a row it may do so in vain."""

SETS, FIRST_SETS = 12, 3
"""So many choices of bins are tried at all; and each of these before any is tried again."""

SPARE, MOST_CHOICES = 4, 20_000
"""Choices of so many bins are drawn from that many and these; and so many choices are looked at."""

FULLEST = 0.97
"""Bins whose area is filled by more than this are not tried."""

KEPT = 12
"""Layouts of a choice that are kept."""

ANEW, ELSEWHERE = 0.2, 0.25
"""How often an attempt starts anew, and how often with another choice than the most promising one."""

SWAP, MOST_MOVED = 0.6, 4
"""How often two items change places; otherwise up to so many are laid anywhere."""


@dataclass(slots=True)
class Choice:
    """Some bins, and the least bad layouts on them."""

    bins: tuple[int, ...]
    pool: Pool = field(default_factory=lambda: Pool(most=KEPT))


def fewer(bench: Bench, problem: Problem, shared: Shared, end: float) -> None:
    """Look for fewer or cheaper bins until there is no choice left, or the time is over."""
    while choices := cheaper(problem, shared.wish, shared.used):
        if not _tried(bench, [Choice(bins) for bins in choices], shared, lambda: monotonic() >= end):
            return


def _tried(bench: Bench, choices: list[Choice], shared: Shared, over: Callable[[], bool]) -> bool:
    """Try choices until a better layout is found, by whatever thread; False: the time is over."""
    begun = shared.found
    while not over():
        if shared.found != begun:
            return True
        choice = _pick(bench, choices)
        given = within(bench.given, choice.bins)
        shared.take(bench.layout)
        if choice.pool.layouts and bench.rng.random() >= ANEW:
            choice.pool.take(bench.layout, bench.rng)
            _disturb(bench, choice)
        for item in np.flatnonzero(~np.isin(bench.layout.bin, choice.bins)):
            anywhere(bench, given, int(item))
        left = parted(bench, given, PATIENCE, EFFORT, STRIKES)
        if left == 0.0:
            shared.better(bench.best)
        else:
            choice.pool.keep(left, bench.best)
    return False


def _pick(bench: Bench, choices: list[Choice]) -> Choice:
    """Return the choice to try next."""
    untried = next((choice for choice in choices[:FIRST_SETS] if not choice.pool.layouts), None)
    if untried is not None:
        return untried
    if bench.rng.random() < ELSEWHERE:
        return choices[int(bench.rng.integers(len(choices)))]
    return min(choices, key=lambda choice: choice.pool.least)


def _disturb(bench: Bench, choice: Choice) -> None:
    """Change a layout that did not work out."""
    given = within(bench.given, choice.bins)
    if bench.rng.random() < SWAP:
        swap_large(bench, given)
        return
    loose = np.flatnonzero(~given.items.fixed)
    for item in bench.rng.choice(loose, min(int(bench.rng.integers(1, MOST_MOVED + 1)), loose.size), replace=False):
        anywhere(bench, given, int(item))


def cheaper(problem: Problem, wish: Wish, used: tuple[int, ...]) -> list[tuple[int, ...]]:
    """Return choices of bins that count less and could hold all by their area, dear ones first, then roomy ones.

    Bins alike in cost and area count as the same; those that hold fixed items are in every choice.
    """
    wanted = sum(problem.kinds[item.kind].shape.area for item in problem.items)
    held, cost = set(wish.held), wish.costs(used)
    by_room = sorted(range(len(problem.bins)), key=lambda b: -wish.area[b])
    found: dict[tuple[tuple[float, float], ...], tuple[int, ...]] = {}
    for size in range(len(used) or len(problem.bins), max(len(used) - 2, 0), -1):
        for chosen in islice(combinations(by_room[: size + SPARE], size), MOST_CHOICES):
            if (
                held <= set(chosen)
                and wish.costs(chosen) < cost
                and sum(wish.area[b] for b in chosen) * FULLEST >= wanted
            ):
                found.setdefault(tuple((wish.cost[b], wish.area[b]) for b in chosen), tuple(sorted(chosen)))
    dear_first = sorted(found.values(), key=lambda chosen: (-wish.costs(chosen), -sum(wish.area[b] for b in chosen)))
    return dear_first[:SETS]
