"""Gaps in a closed path, as even as may be by arc length, on its lines first, and what is left of the path.

A gap lies within one piece, clear of corners and of places to be avoided.  Targets at equal distances are tried in
`PHASES` turns; each takes the nearest place that is allowed, on an arc only where no line is within a quarter of the
spacing, none where nothing is within half of it, or where another gap is.  That turn is taken which leaves out the
fewest, then the one with the fewest on arcs, then the one that moves the furthest gap the least.
"""

from bisect import bisect_left, insort
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Array, Points2, Values
from stages.geometry.paths.arcpath import ArcPath, distances, joint_turns, lengths, split, sweeps
from stages.geometry.paths.overlap import QUARTER_BULGE, fractions_beside
from stages.geometry.paths.parts import part, places_at

PHASES = 16
CORNER_RAD = np.radians(5.0)
"""Joints that turn less are no corners."""

Span = tuple[float, float, bool]
"""Where the middle of a gap may be, from and to along the path, mm, and whether on a line."""

Near = tuple[float, float]
"""A place along the path, and how far it is from the one that was wanted, mm."""

NOWHERE: Near = (0.0, float("inf"))


@dataclass(frozen=True, slots=True)
class Wish:
    """How many gaps of which length, how far from corners and places to be avoided, and from ends of any piece, mm."""

    count: int
    gap_mm: float
    clear_mm: float
    least_mm: float


@dataclass(frozen=True, slots=True)
class Gaps:
    """Where the middles of gaps are along a path, mm; how many are missing; how far the furthest is off its place."""

    middles: tuple[float, ...]
    missing: int
    uneven_mm: float


def gaps(path: ArcPath, wish: Wish, avoid: Points2) -> Gaps:
    """Return where the gaps of a closed path are to be."""
    spans, long = _spans(path, wish, avoid), float(lengths(path).sum())
    step = long / wish.count
    targets = step * (np.arange(PHASES)[:, None] / PHASES + np.arange(wish.count))
    lines, arcs = (_nearest(spans, targets, long, straight=straight) for straight in (True, False))
    tried = [_placed(list(zip(*rows, strict=True)), long, wish) for rows in zip(lines, arcs, strict=True)]
    _, best = min(((score, phase) for phase, (score, _) in enumerate(tried)), key=lambda item: item)
    return tried[best][1]


def opened(path: ArcPath, found: Gaps, gap_mm: float) -> list[ArcPath]:
    """Return what the gaps leave of a closed path, from the end of the last one on; the path if there is none."""
    if not found.middles:
        return [path]
    long = float(lengths(path).sum())
    enter = np.sort(np.array(found.middles))
    leave = np.concatenate([[enter[-1] - long], enter[:-1]])
    ends = places_at(path, np.concatenate([leave + gap_mm / 2.0, enter - gap_mm / 2.0])).reshape(2, -1)
    return [part(path, *pair) for pair in zip(*ends.tolist(), strict=True)]


def _spans(path: ArcPath, wish: Wish, avoid: Points2) -> list[Span]:
    """Return where the middles of gaps may be."""
    ends = np.concatenate([[0.0], np.cumsum(lengths(path))])
    half = wish.gap_mm / 2.0
    corner = ends[:-1][np.abs(joint_turns(path)) >= CORNER_RAD]
    shut = np.concatenate(
        [corner + shift for shift in (-ends[-1], 0.0, ends[-1])] + [_beside(path, avoid, wish.clear_mm)]
    )
    found: list[Span] = []
    for piece, straight in enumerate((sweeps(path) == 0.0).tolist()):
        low, high = ends[piece] + half + wish.least_mm, ends[piece + 1] - half - wish.least_mm
        found += [(*span, straight) for span in _free(float(low), float(high), np.sort(shut), half + wish.clear_mm)]
    return found


def _free(low: float, high: float, shut: Values, clear: float) -> list[tuple[float, float]]:
    """Return what is left of a range without what is within `clear` of some places, in order."""
    free = []
    for place in shut.tolist():
        if place + clear <= low or place - clear >= high:
            continue
        if place - clear >= low:
            free.append((low, place - clear))
        low = place + clear
    return [*free, (low, high)] if low <= high else free


def _beside(path: ArcPath, avoid: Points2, reach: float) -> Array:
    """Return where along a path the places to be avoided are, mm, those within reach of it."""
    gentle = split(path, max_bulge=QUARTER_BULGE)
    long = lengths(gentle)
    places, piece = np.repeat(avoid, long.size, axis=0), np.tile(np.arange(long.size), avoid.shape[0])
    near = np.flatnonzero(distances(places, gentle, piece) <= reach)
    share = fractions_beside(gentle, piece[near], places[near])
    found: Array = (np.cumsum(long) - long)[piece[near]] + share * long[piece[near]]
    return found


def _placed(row: Sequence[tuple[Near, Near]], long: float, wish: Wish) -> tuple[tuple[int, int, float], Gaps]:
    """Return the gaps of one turn, and what stands against it: how many are missing, how many on arcs, how uneven.

    row: of each target the nearest place on a line, and that on an arc.
    """
    step = long / wish.count
    middles, arcs, uneven = list[float](), 0, 0.0
    taken = list[float]()
    for line, arc in row:
        at, away = line if line[1] <= step / 4.0 or line[1] <= arc[1] else arc
        if away > step / 2.0 or _is_taken(at, taken, long, wish):
            continue
        middles.append(at)
        insort(taken, at)
        arcs += (at, away) != line
        uneven = max(uneven, away)
    gone = wish.count - len(middles)
    return (gone, arcs, round(uneven, 6)), Gaps(tuple(middles), gone, uneven)


def _is_taken(at: float, taken: Sequence[float], long: float, wish: Wish) -> bool:
    """Return whether a gap would run into another, or leave next to nothing between them; taken: in rising order."""
    place = bisect_left(taken, at)
    beside = (taken[place - 1], taken[place % len(taken)]) if taken else ()
    apart = (abs(at - other) for other in beside)
    return any(min(away, long - away) < wish.gap_mm + wish.least_mm for away in apart)


def _nearest(spans: Sequence[Span], targets: Array, long: float, *, straight: bool) -> list[list[Near]]:
    """Return the place of that sort nearest to each target, once round, in rows as the targets are."""
    some: Array = np.array([(low, high) for low, high, on_line in spans if on_line == straight]).reshape(-1, 2)
    if some.shape[0] == 0:
        return [[NOWHERE] * targets.shape[1]] * targets.shape[0]
    every = np.concatenate([some - long, some, some + long])
    places = np.clip(targets[..., None], every[:, 0], every[:, 1])
    far = np.abs(places - targets[..., None])
    best = far.argmin(axis=-1)[..., None]
    at, away = (np.take_along_axis(one, best, axis=-1)[..., 0].tolist() for one in (places, far))
    return [[(place % long, off) for place, off in zip(*rows, strict=True)] for rows in zip(at, away, strict=True)]
