"""What the threads of a search share, what each works with, and how one attempt goes."""

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from stages.nest.separation.contacts import EITHER
from stages.nest.separation.laying import lay
from stages.nest.separation.problem import Arrays, Problem, Spot, arrays, empty_layout, pose_for
from stages.nest.separation.separate import copy_places, press_in, seed_all, separate
from stages.nest.separation.state import NOWHERE, Layout, Pose, Rules, Tables, Weights, Whole
from stages.nest.separation.tabling import tables_for

MOST_ROUNDS = 100_000
"""No attempt comes near so many rounds before its patience ends."""

OBSOLETE, OVER = 1, 2
"""Why a thread is to stop: another has a better layout, or the time is over."""

PAIR = 2
LARGE_SHARE = 0.34
"""Of the items, the largest by hull, of which two change places."""

SEEDS = 64
"""Seeds of the threads of one search lie so close together."""

TURN = 2.0 * np.pi


@dataclass(frozen=True, slots=True)
class Wish:
    """When to end, whether the start is a layout, how many threads, the seed; of each bin what it counts, its area,
    and whether its width does.

    held: bins in which fixed items lie.
    """

    end: float
    settled: bool
    threads: int
    seed: int
    cost: tuple[float, ...]
    area: tuple[float, ...]
    rectangle: tuple[bool, ...]
    held: tuple[int, ...] = ()

    def costs(self, used: Sequence[int]) -> float:
        """Return what some bins count; none at all: there is no layout yet."""
        return sum(self.cost[bin_] for bin_ in used) if used else np.inf


@dataclass(slots=True)
class Shared:
    """What threads share: the best layout, the bins it uses, its used width, how often it got better, whom to tell."""

    layout: Layout
    used: tuple[int, ...]
    wish: Wish
    tell: Callable[[Layout], None]
    width: float = np.inf
    found: int = 0
    lock: threading.Lock = field(default_factory=threading.Lock)
    stops: list[Whole] = field(default_factory=list)

    def better(self, layout: Layout, width: float = np.inf, *, alone: bool = False) -> None:
        """Take a layout if it is better, tell it, and stop attempts that can bring no more.

        alone: each thread goes on from layouts of its own: none is stopped.
        """
        used = tuple(sorted(set(layout.bin.tolist())))
        with self.lock:
            if (self.wish.costs(used), width) >= (self.wish.costs(self.used), self.width):
                return
            copy_places(layout, self.layout)
            self.used, self.width = used, width
            self.found += 1
            self.tell(self.layout)
            for stop in () if alone else self.stops:
                stop[0] = max(int(stop[0]), OBSOLETE)

    def take(self, layout: Layout) -> int:
        """Copy the best layout, and return how often it has got better."""
        with self.lock:
            copy_places(self.layout, layout)
            return self.found


@dataclass(slots=True)
class Bench:
    """What one thread works with: a layout that is changed, the least bad one of an attempt, weights, chance."""

    given: Arrays
    layout: Layout
    best: Layout
    weights: Weights
    pose: Pose
    tables: Tables
    rng: np.random.Generator
    stop: Whole


def bench_for(problem: Problem, seed: int, number: int, tables: Tables | None = None) -> Bench:
    """Return what one thread works with; seeds its random numbers.  Threads of one search share their tables."""
    given = arrays(problem)
    count = len(problem.items)
    seed_all(seed * SEEDS + number)
    return Bench(
        given, empty_layout(problem, given), empty_layout(problem, given),
        Weights(np.ones((count, count)), np.ones(count)), pose_for(given), tables or tables_for(problem, given),
        np.random.default_rng([seed, number]), np.zeros(1, dtype=np.int64),
    )  # fmt: skip


def same_again(layout: Layout) -> Layout:
    """Return a copy of a layout."""
    kept = Layout._make(one.copy() for one in layout)
    copy_places(layout, kept)
    return kept


def within(given: Arrays, chosen: Sequence[int]) -> Arrays:
    """Return the same with only some bins allowed."""
    region = given.rules.region.copy()
    closed = np.setdiff1d(np.arange(region.shape[1]), np.asarray(chosen, dtype=np.int64))
    region[:, closed] = NOWHERE
    return replace(given, rules=given.rules._replace(region=region), rough=given.rough._replace(region=region))


def parted(bench: Bench, given: Arrays, patience: int, effort: tuple[int, int, int], strikes: int = 1) -> float:
    """Return the least overlap of the items of the layout that can be reached; that layout is `best` of the bench."""
    press_in(given.shapes, bench.layout, given.bins, bench.pose, given.items.fixed)
    bench.weights.pair[:] = 1.0
    bench.weights.wall[:] = 1.0
    if bench.stop[0] != OVER:
        bench.stop[0] = 0
    left = separate(
        bench.tables, given.shapes, given.rules, given.regions, given.items, bench.layout, bench.best, given.bins,
        bench.weights, bench.pose, patience, strikes, MOST_ROUNDS, np.array(effort), bench.stop,
    )  # fmt: skip
    return float(left)


def place(given: Arrays, layout: Layout, pose: Pose, item: int, spot: Spot) -> None:
    """Lay an item at a spot."""
    angle = float(np.radians(spot.angle_deg))
    span = _span_of(given.rules, spot.kind, spot.bin, angle)
    low, high, c, s = given.rules.span[span]
    if low != high:
        c, s, low = np.cos(angle), np.sin(angle), angle
    lay(given.shapes, layout, pose, item, spot.kind, spot.bin, span, low, c, s, spot.x, spot.y)


def laid_again(bench: Bench, given: Arrays) -> None:
    """Lay every item that is not fixed where it lies, in the nearest angle that the rules know."""
    for item, spot in enumerate(spots_of(bench.layout)):
        if spot.bin >= 0 and not given.items.fixed[item]:
            place(given, bench.layout, bench.pose, item, spot)


def _span_of(rules: Rules, kind: int, bin_: int, angle: float) -> int:
    """Return the number of the span that holds an angle, or that is nearest to it."""
    first, end = int(rules.turn[kind, bin_]), int(rules.turns[kind, bin_])
    return first + int(np.argmin([_outside(angle, rules.span[s, 0], rules.span[s, 1]) for s in range(first, end)]))


def _outside(angle: float, low: float, high: float) -> float:
    """Return how far an angle is outside a span, rad."""
    past = float(angle - low) % TURN
    return 0.0 if past <= high - low else min(past - (high - low), TURN - past)


def spots_of(layout: Layout) -> list[Spot]:
    """Return a layout as spots."""
    angle = np.degrees(layout.angle)
    columns = (layout.bin, layout.kind, angle, layout.x, layout.y)
    return [Spot(*row) for row in zip(*(column.tolist() for column in columns), strict=True)]


def anywhere(bench: Bench, given: Arrays, item: int) -> None:
    """Lay an item at random in one of the bins that it may lie in."""
    rng, rules = bench.rng, given.rules
    kind = int(given.items.kind[item] if rng.random() < EITHER else given.items.other[item])
    bins = np.flatnonzero((rules.region[kind] != NOWHERE) & (rules.turn[kind] < rules.turns[kind]))
    if not bins.size:
        return
    bin_ = int(rng.choice(bins))
    span = int(rng.integers(rules.turn[kind, bin_], rules.turns[kind, bin_]))
    low, high, c, s = rules.span[span]
    if low != high:
        low = rng.uniform(low, high)
        c, s = np.cos(low), np.sin(low)
    x, y = rng.uniform(0.0, 1.0, 2) * given.bins.size[bin_]
    lay(given.shapes, bench.layout, bench.pose, item, kind, bin_, span, low, c, s, x, y)


def swap_large(bench: Bench, given: Arrays) -> None:
    """Let two large items change places, each in its own angle if that is allowed there."""
    layout = bench.layout
    weight = given.shapes.weight[layout.kind]
    loose = np.flatnonzero(~given.items.fixed)
    large = loose[np.argsort(-weight[loose])][: max(PAIR, int(LARGE_SHARE * loose.size))]
    if large.size < PAIR:
        return
    a, b = (int(one) for one in bench.rng.choice(large, PAIR, replace=False))
    there = {one: (int(layout.bin[one]), float(layout.x[one]), float(layout.y[one])) for one in (a, b)}
    for item, (bin_, x, y) in ((a, there[b]), (b, there[a])):
        kind, span = int(layout.kind[item]), int(layout.span[item])
        fits = given.rules.turn[kind, bin_] <= span < given.rules.turns[kind, bin_]
        if fits and given.rules.region[kind, bin_] != NOWHERE:
            lay(
                given.shapes, layout, bench.pose, item, kind, bin_, span, float(layout.angle[item]),
                float(layout.cos[item]), float(layout.sin[item]), x, y,
            )  # fmt: skip
