"""Put together shapes that were cut from one another, as in a jigsaw puzzle: edge to edge, corner into corner.

The leftmost free corner is filled by whatever fits a corner of its own into it without an overlap, in every allowed
angle, and so on.  Of all part layouts with as many items those with the largest share of their outlines touching are
kept (a beam): where shapes interlock the right piece touches all round.  For one bin and lists of angles.

Limits: a corner that nothing fits is left free for good; shapes that are grown by a gap do not interlock any more.
"""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from time import monotonic

import numpy as np

from stages.nest.separation.cornering import corner_fits, first_corner
from stages.nest.separation.laying import lay
from stages.nest.separation.problem import Arrays, Problem, Spot, arrays
from stages.nest.separation.sharing import (
    Bench,
    Shared,
    Wish,
    bench_for,
    parted,
    place,
    spots_of,
    within,
)
from stages.nest.separation.shorter import EFFORT, PATIENCE, used_width
from stages.nest.separation.state import Layout

BEAM, BRANCHES = 24, 6
"""Part layouts that are kept, and how many successors each may have."""

NEAR_SHARE, STEP_SHARE = 2e-4, 2e-3
"""Edges touch within this share of the height of the bin; a corner is free if there is room this share beside it."""

ALIKE_SHARE = 5e-6
"""Lengths of edges are the same within this share of the height of the bin."""

ROUNDING_SHARE = 5e-6
"""Corners are rounded by up to this share of the height of the bin: so far shapes may overlap until they are parted."""

MATCHED = 0.6
"""Shapes count as cut from one another if this share of their edges has a partner of the same length elsewhere."""

WIDER = (0.0, 1e-6, 1e-5, 2e-5, 5e-5, 1e-4, 1e-3)
"""Shares by which places are moved apart until nothing overlaps."""

MOST_FITS = 4096


@dataclass(frozen=True, slots=True)
class Laid:
    """One item of a part layout: its kind, span, place, length touching and outline."""

    kind: int
    span: int
    x: float
    y: float
    touching: float
    outline: float


@dataclass(frozen=True, slots=True)
class Part:
    """A layout of some of the items, in the order they were laid; the last corner that nothing fits, and how many."""

    laid: tuple[Laid, ...] = ()
    after: tuple[float, float] = (-1.0, -1.0)
    dead: int = 0

    @property
    def share(self) -> float:
        """The share of the outlines that touches; what two items have in common counts for both."""
        return 2.0 * sum(one.touching for one in self.laid) / sum(one.outline for one in self.laid)


def interlocking(problem: Problem) -> bool:
    """Return whether the shapes look as if they had been cut from one another."""
    if len(problem.bins) != 1 or any(item.fixed for item in problem.items):
        return False
    if any(low < high for kind in problem.kinds for spans in kind.spans for low, high in spans):
        return False
    copies = Counter(item.kind for item in problem.items)
    edges = [(k, length) for k, kind in enumerate(problem.kinds) if copies[k] for length in _lengths(kind.shape)]
    near = ALIKE_SHARE * problem.bins[0][1]
    own, length = np.array([k for k, _ in edges]), np.array([length for _, length in edges])
    matched = (np.abs(length[:, None] - length) <= near) & (own[:, None] != own)
    return bool(matched.any(axis=1).mean() >= MATCHED)


def _lengths(shape: object) -> list[float]:
    from shapely import get_coordinates

    points = get_coordinates(shape)
    lengths: list[float] = np.linalg.norm(np.diff(points, axis=0), axis=1).tolist()
    return lengths


def interlocked(bench: Bench, problem: Problem, shared: Shared, wish: Wish, end: float) -> None:
    """Put the shapes together, part what overlaps by rounding in as little more room as that takes, and tell it."""
    spots = assembled(problem, wish.seed, lambda: monotonic() >= end)
    if spots is None:
        return
    given, height = within(bench.given, (0,)), problem.bins[0][1]
    for more in WIDER:
        _lay_spread(bench, given, spots, more, height)
        width = used_width(bench.layout, 0)
        given.bins.size[0, 0] = width
        if monotonic() < end and parted(bench, given, PATIENCE, EFFORT) == 0.0:
            shared.better(bench.best, used_width(bench.best, 0))
            return


def _lay_spread(bench: Bench, given: Arrays, spots: Sequence[Spot], more: float, height: float) -> None:
    """Lay items a little apart, all places moved away from the corner in proportion: as far up as the bin allows."""
    for item, spot in enumerate(spots):
        place(given, bench.layout, bench.pose, item, spot)
    room = max(height / float(bench.layout.box[:, 3].max()) - 1.0, 0.0)
    for item, spot in enumerate(spots):
        up = spot.y * (1.0 + min(more, room))
        place(given, bench.layout, bench.pose, item, replace(spot, x=spot.x * (1.0 + more), y=up))


def assembled(problem: Problem, seed: int, over: Callable[[], bool]) -> list[Spot] | None:
    """Return all items laid corner by corner, with overlaps of the rounding of corners at most; None: not in time.

    The bin may be longer than it is.
    """
    bench = loose_bench(problem, seed)
    wanted = Counter(bench.given.items.kind.tolist())
    beam = [Part()]
    out = np.zeros((MOST_FITS, 6))
    for _ in problem.items:
        longer: dict[tuple[tuple[int, int, int], ...], Part] = {}
        for part in beam:
            if over():
                return None
            for one in _successors(bench, part, wanted, out):
                key = tuple(sorted((laid.kind, round(laid.x), round(laid.y)) for laid in one.laid))
                longer.setdefault(key, one)
        beam = sorted(longer.values(), key=lambda one: (one.dead, -one.share))[:BEAM]
        if not beam:
            return None
    _lay_all(bench.given, bench.layout, bench, beam[0])
    return spots_of(bench.layout)


def loose_bench(problem: Problem, seed: int) -> Bench:
    """Return a bench on which shapes are smaller by the rounding of their corners."""
    bench = bench_for(problem, seed, 0)
    return replace(bench, given=arrays(problem, ROUNDING_SHARE * problem.bins[0][1]))


def _successors(
    bench: Bench, part: Part, wanted: Counter[int], out: np.ndarray[tuple[int, ...], np.dtype[np.float64]]
) -> list[Part]:
    """Return the part layout with one more item in its first free corner, the best few."""
    given, layout = bench.given, bench.layout
    _lay_all(given, layout, bench, part)
    left = wanted - Counter(one.kind for one in part.laid)
    height = float(given.bins.size[0, 1])
    after, dead = part.after, part.dead
    while True:
        x, y = first_corner(given.shapes, layout, given.bins, 0, STEP_SHARE * height, after)
        if not np.isfinite(x):
            return []
        count = corner_fits(
            bench.tables, given.shapes, given.rules, given.regions, layout, given.bins, bench.weights, bench.pose,
            np.array(sorted(left), dtype=np.int64), 0, x, y, NEAR_SHARE * height, out,
        )  # fmt: skip
        if count:
            break
        after, dead = (x, y), dead + 1
    fits = [Laid(int(row[0]), int(row[1]), *row[2:].tolist()) for row in out[:count]]
    fits.sort(key=lambda one: -one.touching / one.outline)
    return [Part((*part.laid, one), after, dead) for one in fits[:BRANCHES]]


def _lay_all(given: Arrays, layout: Layout, bench: Bench, part: Part) -> None:
    """Lay the items of a part layout; all others lie nowhere."""
    layout.bin[:] = -1
    free = {kind: np.flatnonzero(given.items.kind == kind).tolist() for kind in set(given.items.kind.tolist())}
    for one in part.laid:
        low, _, c, s = given.rules.span[one.span]
        lay(given.shapes, layout, bench.pose, free[one.kind].pop(0), one.kind, 0, one.span, low, c, s, one.x, one.y)
