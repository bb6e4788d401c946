"""The way of a ruling along two rails, its corners put exactly onto F = 0: from lattice places to legs.

Stops with one move between them are one leg.  All corners are then solved for together: a smooth one must lie on F = 0,
both ends of a cone share the parameter of its apex.  That leaves some corners free to move; each Newton step is the
least change that meets all equations, so that corners neither drift nor overtake each other.  A leg that would run
backwards is dropped and the rest solved again.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from stages.errors import NoSolutionError
from stages.geometry.arrays import Array, Values
from stages.geometry.curves.curves import Curve
from stages.geometry.rails.chords import ONE_PLACE
from stages.geometry.rails.corners import TINY, Leg, Rail, corners_of
from stages.geometry.rails.crossing import crossings
from stages.geometry.rails.graph import Move, Stop
from stages.geometry.rails.linked import Link, arc, link
from stages.geometry.rails.mismatch import mismatch, scale


def legs(stops: Sequence[Stop]) -> tuple[Leg, ...]:
    """Return the legs of a way, without those of no length."""
    runs: list[list[Stop]] = []
    for stop in stops:
        if runs and runs[-1][-1].move == stop.move and not _over_break(runs[-1][-1], stop):
            runs[-1].append(stop)
        else:
            runs.append([stop])
    made = [Leg(run[0].move, np.array([(stop.t, stop.s) for stop in run]), run[-1].fold) for run in runs]
    return merged_legs([leg for leg in made if leg.length > TINY])


def _over_break(before: Stop, after: Stop) -> bool:
    """Return whether an arc goes from one piece of a rail to the next between two stops."""
    here = np.array([before.t, before.s])
    apart = abs(after.t - before.t) + abs(after.s - before.s)
    return before.move == "along" and apart <= ONE_PLACE and _at_break(here)


def merged_legs(parts: Sequence[Leg]) -> tuple[Leg, ...]:
    """Return the legs with those joined that a corner of no length had kept apart, unless a break lies between."""
    merged: list[Leg] = []
    for leg in parts:
        last = merged[-1] if merged else None
        if last is not None and last.move == leg.move and (leg.move != "along" or not _at_break(leg.knots[0])):
            merged[-1] = leg.replace(knots=np.vstack([last.knots, leg.knots[1:]]))
        else:
            merged.append(leg)
    return tuple(merged)


def _at_break(corner: Values) -> bool:
    """Return whether a corner lies between two pieces of a rail."""
    return bool((np.abs(corner - np.round(corner)) <= TINY).any())


def solved(parts: Sequence[Leg], rail_a: Rail, rail_b: Rail) -> tuple[Leg, ...]:
    """Return the legs with their corners exact.  Raises NoSolutionError where they do not converge."""
    parts = tuple(parts)
    wanted, reached, unit = TINY, np.inf, "of a piece backwards"
    for _ in range(len(parts) + MOST_REPAIRS):
        corners = corners_of(parts, rail_a, rail_b)
        rises = np.diff(corners, axis=0).min(axis=1)
        if (rises < -TINY).any():
            wanted, reached, unit = TINY, float(-rises.min()), "of a piece backwards"
            backwards = [k for k in range(len(parts)) if rises[k] < -TINY]
            parts = _without(parts, min(backwards, key=lambda k: parts[k].length))
            continue
        made = merged_legs(legs_between(parts, corners))
        gap = max((_gap(leg, k, rail_a, rail_b) for k, leg in enumerate(made)), key=lambda gap: gap.off)
        if gap.off <= ON_ARC:
            return tuple(part for leg in made for part in _divided(leg, rail_a, rail_b))
        wanted, reached, unit = ON_ARC, gap.off, "of |r'||p||c'|"
        parts = _bridged(made, gap)
    raise NoSolutionError("corners of the strip", reached=reached, wanted=wanted, unit=unit)


MOST_REPAIRS = 3
"""Gaps that are bridged."""


def _divided(leg: Leg, rail_a: Rail, rail_b: Rail) -> tuple[Leg, ...]:
    """Return a leg along an arc in parts between the points at which other arcs cross it."""
    if leg.move != "along" or _level(leg.knots[0], leg.knots[-1]):
        return (leg,)
    corner = np.floor(leg.knots.mean(axis=0))
    every = ((part, linked(part.knots, rail_a, rail_b)) for part in _parted(leg, rail_a, rail_b))
    return tuple(
        small for part, along in every for small in _split(part, crossings(along.a, along.b, along.w, along.t) + corner)
    )


def _parted(leg: Leg, rail_a: Rail, rail_b: Rail) -> tuple[Leg, ...]:
    """Return a leg along an arc in parts between the crossings that its knots show.

    More knots are put on its parts only: those between two knots far apart about a crossing would be off the arc.
    """
    places = crossings(*_on_pieces(leg.knots, rail_a, rail_b))
    return _split(leg, places + np.floor(leg.knots.mean(axis=0)))


def _split(leg: Leg, places: Array) -> tuple[Leg, ...]:
    """Return a leg in parts between places on it, (n, 2), that have knots before and after them."""
    made = []
    for place in places:
        before, after = (leg.knots < place - TINY).all(axis=1), (leg.knots > place + TINY).all(axis=1)
        if before.any() and after.any():
            made.append(leg.replace(knots=np.vstack([leg.knots[before], place]), folds=False))
            leg = leg.replace(knots=np.vstack([place, leg.knots[after]]))
    return (*made, leg)


@dataclass(frozen=True, slots=True)
class _Gap:
    """Where the knots of a leg do not lie on one arc: the leg, the share of it, and F between two knots there."""

    leg: int
    share: float
    off: float


def _gap(leg: Leg, number: int, rail_a: Rail, rail_b: Rail) -> _Gap:
    """Return where a leg is farthest off F = 0: a corner may have come to another branch of it, or past a turn."""
    first, last = leg.knots[[0, -1]].sum(axis=1)
    if leg.move != "along" or _level(leg.knots[0], leg.knots[-1]):
        return _Gap(number, 0.0, 0.0)
    off, place = max(_off(part, rail_a, rail_b) for part in _parted(leg, rail_a, rail_b))
    return _Gap(number, float((place - first) / (last - first)), off)


def _off(leg: Leg, rail_a: Rail, rail_b: Rail) -> tuple[float, float]:
    """Return the largest |F| between two knots along a leg, as a share of |r'||p||c'|, and its place, t + s."""
    along = linked(leg.knots, rail_a, rail_b)
    w = (along.w[:-1] + along.w[1:]) / 2.0
    t = arc(along, w, 0)[0]
    size = scale(along.a.jet(t, 1), along.b.jet(w - t, 1))
    off = np.abs(mismatch(along.a, along.b, t, w - t)) / size
    worst = int(np.argmax(off))
    return float(off[worst]), float(w[worst] - along.w[0] + leg.knots[0].sum())


def _bridged(parts: Sequence[Leg], gap: _Gap) -> tuple[Leg, ...]:
    """Return the legs with a gap at an end of one bridged by a cone to the next knot inside.

    Just beside its end an arc may turn back: the cone rests on the parameter that does.
    Raises NoSolutionError where the gap is not at an end.
    """
    knots = parts[gap.leg].knots
    w = knots.sum(axis=1)
    k = int(np.searchsorted(w, w[0] + gap.share * (w[-1] - w[0])))
    move: Move = "on_b" if np.argmin(knots[k] - knots[k - 1]) == 0 else "on_a"
    if k <= AT_END < w.size - AT_END:
        cone, rest = Leg(move, knots[[0, k]]), parts[gap.leg].replace(knots=knots[k:])
        return merged_legs([*parts[: gap.leg], cone, rest, *parts[gap.leg + 1 :]])
    if k >= w.size - AT_END > AT_END:
        cone, rest = Leg(move, knots[[k - 1, -1]], parts[gap.leg].folds), parts[gap.leg].replace(knots=knots[:k])
        return merged_legs([*parts[: gap.leg], rest.replace(folds=False), cone, *parts[gap.leg + 1 :]])
    raise NoSolutionError("an arc between two corners", reached=gap.off, wanted=ON_ARC, unit="of |r'||p||c'|")


AT_END = 3
"""A gap within so many knots of the end of a leg is one at its end."""


def _moved(leg: Leg, corner: Values, *, end: bool) -> Leg:
    """Return a leg with its end, or its beginning, at another corner."""
    knots = [leg.knots[:-1], corner] if end else [corner, leg.knots[1:]]
    return leg.replace(knots=np.vstack(knots))


ON_ARC = 1e-9
"""A thousand roundings of F; off every arc F is the sine of a warp that is seen."""


def linked(knots: Array, rail_a: Rail, rail_b: Rail) -> Link:
    """Return the arc with these knots, which lie in one piece of each rail."""
    return link(*_on_pieces(knots, rail_a, rail_b))


def _on_pieces(knots: Array, rail_a: Rail, rail_b: Rail) -> tuple[Curve, Curve, Values, Values]:
    """Return the pieces of the rails that knots lie in, and w and t of the knots on them."""
    i, j = (int(np.floor(knots[:, axis].mean())) for axis in (0, 1))
    beyond = float(np.max(np.abs(knots - np.array([i, j]) - MIDDLE))) - MIDDLE
    if not beyond <= TINY:
        raise NoSolutionError("an arc of a path in one piece of each rail", reached=beyond, wanted=TINY)
    t, s = np.clip(knots[:, 0] - i, 0.0, 1.0), np.clip(knots[:, 1] - j, 0.0, 1.0)
    w = t + s
    kept = np.append(True, np.diff(w) > TINY)
    return rail_a[i], rail_b[j], w[kept], t[kept]


MIDDLE = 0.5
"""Of a piece, which is 1 long."""


def _without(parts: tuple[Leg, ...], k: int) -> tuple[Leg, ...]:
    """Return the legs without one, its neighbours brought together at its middle."""
    middle = (parts[k].knots[0] + parts[k].knots[-1]) / 2.0
    left, right = list(parts[:k]), list(parts[k + 1 :])
    if left:
        left[-1] = _moved(left[-1], middle, end=True)
    if right:
        right[0] = _moved(right[0], middle, end=False)
    return merged_legs([*left, *right])


def legs_between(parts: Sequence[Leg], corners: Array) -> tuple[Leg, ...]:
    """Return the legs with their ends at the corners and the knots between that still rise."""
    made = []
    for leg, (low, high) in zip(parts, pairwise(_from_end_to_end(corners)), strict=True):
        start, end = np.maximum(low, 0.0), np.maximum(high, np.maximum(low, 0.0))
        if leg.move == "along":
            inner = leg.knots[1:-1]
            clear = ((inner > start + TINY) & (inner < end - TINY)).all(axis=1)
            level = (inner >= start - TINY).all(axis=1) & (inner <= end + TINY).all(axis=1) & _level(start, end)
            knots = np.vstack([start, inner[clear | level], end])
        else:
            knots = np.stack([start, end])
        if (end - start).sum() > TINY:
            made.append(leg.replace(knots=knots))
    return tuple(made)


def _from_end_to_end(corners: Array) -> Array:
    """Return the corners with those that lie on the first or the last but for rounding put there.

    The leg between goes, and its neighbour must begin where the rails do: if they meet there its rulings shrink to
    nothing, and one of 1e-14 left over would look anywhere.
    """
    for end in corners[[0, -1]]:
        near = np.abs(corners - end).sum(axis=1) <= TINY
        corners = np.where(near[:, None], end, corners)
    return corners


def _level(start: Values, end: Values) -> bool:
    """Return whether an arc keeps one of the parameters."""
    return bool((end - start).min() <= TINY)
