"""A short way through places, each visited once: nearest first, then 2-opt and Or-opt until neither helps.

The cost of going from one place to the next may differ from that of the way back, as a cut seldom ends where it began.
2-opt turns a stretch of the way round, Or-opt moves up to `LONGEST_MOVED` places elsewhere [1]_.  A place is looked at
again only after one of its two links has changed.  No random numbers: the same costs give the same way.  The result is
a local optimum, not the shortest way.

Place 0 is where the way begins and ends; it stays first.

.. [1] D. S. Johnson, L. A. McGeoch, "The traveling salesman problem: a case study in local optimization", in "Local
   Search in Combinatorial Optimization", 1997, sections 2 and 3.
"""

from collections import deque

import numpy as np

from stages.geometry.arrays import EPS, Array, Matrix, Numbers

LONGEST_MOVED = 3
"""Places that Or-opt moves at once: more seldom helps where 2-opt goes along."""

ROUNDING = 64.0 * EPS
"""A change counts as a gain above this share of the longest cost times the places: what sums of costs round to."""


def short_tour(cost: Matrix) -> Numbers:
    """Return an order of places 0 to n - 1, place 0 first, such that going round costs little."""
    return improved(nearest_first(cost), cost)


def nearest_first(cost: Matrix) -> Numbers:
    """Return the way that always goes on to the nearest place left, the first listed of equals."""
    order = np.zeros(cost.shape[0], dtype=np.int64)
    left = cost.copy()
    left[:, 0] = np.inf
    for k in range(1, order.size):
        order[k] = np.argmin(left[order[k - 1]])
        left[:, order[k]] = np.inf
    return order


def improved(order: Numbers, cost: Matrix) -> Numbers:
    """Return a way that no single 2-opt or Or-opt move found from a changed link makes cheaper."""
    least = ROUNDING * float(cost.max(initial=0.0)) * order.size
    ring = np.append(order, order[0])
    waiting = deque(order.tolist())
    queued = set(waiting)
    while waiting:
        place = waiting.popleft()
        queued.discard(place)
        changed = _turned(ring, place, cost, least)
        if changed is None:
            changed = _moved(ring, place, cost, least)
        if changed is None:
            continue
        ring, touched = changed
        fresh = [other for other in (*touched, place) if other not in queued]
        waiting.extend(fresh)
        queued.update(fresh)
    return ring[:-1]


Changed = tuple[Numbers, list[int]]
"""A ring after a move, and the places whose links are new."""


def _turned(ring: Numbers, place: int, cost: Matrix, least: float) -> Changed | None:
    """Return the ring with the stretch turned round that gains most and begins or ends at the place, or None."""
    here = int(np.flatnonzero(ring[:-1] == place)[0])
    if here == 0:
        return None
    up_to, onwards = np.arange(1, here + 1), np.arange(here + 1, ring.size - 1)
    first = np.concatenate([up_to, np.full_like(onwards, here)])
    last = np.concatenate([np.full_like(up_to, here), onwards])
    added = _turn_costs(ring, first, last, cost)
    best = int(added.argmin())
    if added[best] >= -least:
        return None
    start, end = int(first[best]), int(last[best])
    made = ring.copy()
    made[start : end + 1] = ring[start : end + 1][::-1]
    return made, ring[[start - 1, start, end, end + 1]].tolist()


def _turn_costs(ring: Numbers, first: Numbers, last: Numbers, cost: Matrix) -> Array:
    """Return what turning round each stretch from a first to a last position adds; all of shape (n,)."""
    there = np.concatenate([[0.0], np.cumsum(cost[ring[:-1], ring[1:]])])
    back = np.concatenate([[0.0], np.cumsum(cost[ring[1:], ring[:-1]])])
    links = cost[ring[first - 1], ring[last]] + cost[ring[first], ring[last + 1]]
    return np.asarray(links + back[last] - back[first] - (there[last + 1] - there[first - 1]))


def _moved(ring: Numbers, place: int, cost: Matrix, least: float) -> Changed | None:
    """Return the ring with up to `LONGEST_MOVED` places that begin with this one put where that gains most, or None."""
    here = int(np.flatnonzero(ring[:-1] == place)[0])
    best, made = -least, None
    for count in range(1, min(LONGEST_MOVED, ring.size - 1 - here) + 1) if here > 0 else ():
        chosen, rest = ring[here : here + count], np.delete(ring, np.s_[here : here + count])
        before, after = rest[here - 1], rest[here]
        removed = cost[before, chosen[0]] + cost[chosen[-1], after] - cost[before, after]
        links, turn = cost[rest[:-1], rest[1:]], _turn_back(chosen, cost)
        for some, extra in ((chosen, 0.0), (chosen[::-1], turn)):
            added = cost[rest[:-1], some[0]] + cost[some[-1], rest[1:]] - links
            at = int(added.argmin())
            gain = float(added[at] - removed + extra)
            if gain < best:
                touched = [before, after, rest[at], rest[at + 1], chosen[0], chosen[-1]]
                best, made = gain, (np.insert(rest, at + 1, some), [int(one) for one in touched])
    return made


def _turn_back(chosen: Numbers, cost: Matrix) -> float:
    """Return what running through some places the other way adds."""
    return float((cost[chosen[1:], chosen[:-1]] - cost[chosen[:-1], chosen[1:]]).sum())
