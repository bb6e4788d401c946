"""A developable strip between two rails: its legs, its folds, or why there is none.

Open rails run from their first points to their last; closed ones have no first ruling: candidates for it are the open
zeros of F on some lattice lines of either rail, and each is tried as the seam, both rails turned to begin there.  The
cheapest strip wins (`graph`: fewest folds, least angle, least turning of cones).
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import islice

import numpy as np

from stages.errors import NoSolutionError
from stages.geometry.curves.curves import Curve, restrict
from stages.geometry.numeric.roots import chord_zeros
from stages.geometry.rails.bound import Bound, least_fold, least_fold_round
from stages.geometry.rails.chords import shares_an_end
from stages.geometry.rails.corners import TINY, Leg
from stages.geometry.rails.folds import folded_way
from stages.geometry.rails.graph import Rules, Way, way
from stages.geometry.rails.way import legs, solved
from stages.geometry.rails.zeros import Field, Zeros, field, zeros

Rail = tuple[Curve, ...]
LINES = 192
"""Lattice lines on each rail: 150 pairs of cubic rails need no more to have every junction found."""
SEAM_LINES = 96
"""Lattice lines while seams are compared."""
SEAMS = 4
"""Lattice lines of each rail on which seams are looked for."""
MOST_SEAMS = 6
"""Seams that are tried."""
BREAKS = 4
"""Breaks of rail b that are tried as the seam where folds are allowed: any way to turn a frame over a frame."""


@dataclass(frozen=True, slots=True)
class Strip:
    """A strip between rails: its legs, and the rails as it runs along them (turned to the seam if closed).

    starts: where these begin on the rails as given.  backwards_b: whether rail b is run the other way.
    unsettled_rad: by how much its folds still changed when their search ended; 0 where they had settled.
    """

    legs: tuple[Leg, ...]
    rail_a: Rail
    rail_b: Rail
    starts: tuple[float, float] = (0.0, 0.0)
    backwards_b: bool = False
    unsettled_rad: float = 0.0


def open_strip(rail_a: Rail, rail_b: Rail, rules: Rules, count: int = LINES) -> Strip | None:
    """Return the best strip between the rails as they run; None if there is none.

    Where rails meet at an end, one that does not shrink to a point there is taken before one that does.
    """
    found = _on_lattices(rail_a, rail_b, rules, count)
    if found is None and shares_an_end(rail_a, rail_b):
        return _on_lattices(rail_a, rail_b, replace(rules, meeting=True), count)
    return found


def _on_lattices(rail_a: Rail, rail_b: Rail, rules: Rules, count: int) -> Strip | None:
    """Return the best strip that the rules allow.

    Corners that the lattice promised and that are not there are looked for on twice as many lines, then done without.
    """
    for lines, beside in ((count, True), (2 * count, True), (count, False)):
        best, unsettled = _way(rail_a, rail_b, replace(rules, beside=beside), lines)
        if not best.stops:
            return None
        try:
            made = solved(legs(best.stops), rail_a, rail_b)
            return Strip(made, rail_a, rail_b, unsettled_rad=unsettled)
        except NoSolutionError:
            continue
    return None


def _way(rail_a: Rail, rail_b: Rail, rules: Rules, count: int) -> tuple[Way, float]:
    """Return the best way over lattices, and by how much its folds, where they are allowed, may be smaller, rad."""
    if rules.fold_rad > 0.0:
        return folded_way(rail_a, rail_b, rules, count)
    found = field(rail_a, rail_b, count)
    return way(found, zeros(found), rules), 0.0


def closed_strip(rail_a: Rail, rail_b: Rail, rules: Rules) -> Strip | None:
    """Return the best strip between closed rails, over both senses of the second and all seams tried."""
    tried = [(cost, False, seam) for cost, seam in _priced(rail_a, rail_b, rules)]
    tried += [(cost, True, seam) for cost, seam in _priced(rail_a, backwards(rail_b), rules)]
    for _, is_backwards, (t, s) in sorted(tried):
        other = backwards(rail_b) if is_backwards else rail_b
        found = open_strip(turned(rail_a, t), turned(other, s), rules)
        if found is not None:
            strip = replace(found, starts=(t, s), backwards_b=is_backwards)
            # a seam on a fold is one fold less: it stays
            return strip if rules.fold_rad > 0.0 else _from_corner(strip, rail_a, other, rules)
    return None


def _from_corner(strip: Strip, rail_a: Rail, rail_b: Rail, rules: Rules) -> Strip:
    """Return the strip begun at its first corner instead of inside a leg, if that leaves fewer legs."""
    t, s = (
        snapped(as_given(rail, start)(float(x)))
        for rail, start, x in zip((strip.rail_a, strip.rail_b), strip.starts, strip.legs[0].knots[-1], strict=True)
    )
    moved = open_strip(turned(rail_a, t), turned(rail_b, s), rules)
    if moved is None or len(moved.legs) >= len(strip.legs):
        return strip
    return replace(moved, starts=(t % len(rail_a), s % len(rail_b)), backwards_b=strip.backwards_b)


def snapped(x: float) -> float:
    """Return a parameter, that of the break that it lies on but for rounding."""
    return float(round(x)) if abs(x - round(x)) <= TINY else x


def as_given(rail: Rail, start: float) -> Callable[[float], float]:
    """Return the map from the parameter of a rail turned to `start` to that of the rail before, past its end too."""
    local = start % 1.0
    if local == 0.0:
        return lambda x: start + x

    def given(x: float) -> float:
        if x <= 1.0:
            return start + x * (1.0 - local)
        last = len(rail) - 1.0
        return start - local + x if x <= last else start - local + last + (x - last) * local

    return given


def _priced(rail_a: Rail, rail_b: Rail, rules: Rules) -> list[tuple[float, tuple[float, float]]]:
    """Return the seams from which a strip leads round, with its cost."""
    found = field(rail_a, rail_b, SEAM_LINES)
    every = zeros(found)
    priced = []
    for t, s in islice(_seams(found, every, rules), MOST_SEAMS):
        tried = field(turned(rail_a, t), turned(rail_b, s), SEAM_LINES)
        priced.append((way(tried, zeros(tried, chord_zeros), rules).cost, (t, s)))
    return [one for one in priced if np.isfinite(one[0])]


def _seams(found: Field, every: Zeros, rules: Rules) -> Iterator[tuple[float, float]]:
    """Yield pairs of parameters to begin at: open zeros on evenly spread lines of either rail, in turn.

    Where folds are allowed, those from a's first point to the breaks of b come first.
    """
    if rules.fold_rad > 0.0:
        yield from ((0.0, float(s)) for s in range(min(len(found.b.pieces), BREAKS)))
    lanes: dict[tuple[str, int], list[tuple[float, float]]] = {}
    for (kind, i, j), zero in sorted(every.items()):
        if zero.open:
            lanes.setdefault((kind, i if kind == "column" else j), []).append((zero.t, zero.s))
    chosen = [
        lanes.get((kind, int(line)), [])
        for kind, size in (("column", found.a.value.size), ("row", found.b.value.size))
        for line in np.linspace(0, size - 1, SEAMS, endpoint=False) + size // (2 * SEAMS)
    ]
    for lane in sorted((lane for lane in chosen if lane), key=len):
        yield from lane


def turned(rail: Rail, start: float) -> Rail:
    """Return a closed rail that begins at a parameter."""
    start %= len(rail)
    number = int(start)
    local = Fraction(start - number)
    if local == 0:
        return rail[number:] + rail[:number]
    first, last = restrict(rail[number], local, Fraction(1)), restrict(rail[number], Fraction(0), local)
    return (first, *rail[number + 1 :], *rail[:number], last)


def backwards(rail: Rail) -> Rail:
    """Return a rail run the other way."""
    return tuple(restrict(piece, Fraction(1), Fraction(0)) for piece in rail[::-1])


def bounds(rail_a: Rail, rail_b: Rail, count: int = LINES) -> Sequence[Bound]:
    """Return the lower bound of the largest fold of open rails, on the lattice and on one twice as fine."""
    fields = (field(rail_a, rail_b, lines) for lines in (count, 2 * count))
    return [least_fold(found, zeros(found)) for found in fields]


def closed_bounds(rail_a: Rail, rail_b: Rail, count: int = SEAM_LINES) -> Sequence[Bound]:
    """Return the lower bound of the largest fold round closed rails, on the lattice and on one twice as fine.

    The least of both senses of rail b; its place is on rail b as given.
    """
    found = []
    for lines in (count, 2 * count):
        same, other = (_round(rail_a, rail, lines) for rail in (rail_b, backwards(rail_b)))
        other = replace(other, s=len(rail_b) - other.s)
        found.append(min(same, other, key=lambda bound: bound.fold_rad))
    return found


def _round(rail_a: Rail, rail_b: Rail, lines: int) -> Bound:
    found = field(rail_a, rail_b, lines)
    return least_fold_round(found, zeros(found, chord_zeros))
