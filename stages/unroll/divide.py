"""A part whose flat pattern overlaps itself, divided along as few rulings as possible: `cut = "auto"`.

    blanks(certificate, tol) -> the certificate of each piece that is cut by itself

A part of a certified surface is certified.  Its flat pattern is, up to a motion, the same part of the whole pattern (of
the neutral surface), so everything is decided on one development.  A longer run of rulings overlaps wherever a shorter
one does: so the longest run from any ruling on is found by bisection, and such runs one after the other are as few as
can be.  Then the largest of them is made as small, in area, as their number permits.

Whether a run overlaps is decided by the area that it covers twice (`geometry.paths.cover`), its edges as arcs through
three of their points, each turning by at most `MOST_TURN`; `unroll` measures each blank again on the lines and arcs
that are cut.  Not for a pattern that overlaps within 1/4096 of a patch (a fold), nor for a part with an outline of its
own (a trim): that part stays whole.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from itertools import pairwise
from math import ceil, log2, pi

import numpy as np

from stages.errors import NoSolutionError
from stages.geometry.arrays import Array, ArrayValue, Points2, Values, cross2, dot, norm
from stages.geometry.flat.development import develop
from stages.geometry.flat.flatmap import Development, FlatPiece
from stages.geometry.paths.arcpath import ArcPath
from stages.geometry.paths.cover import doubled
from stages.geometry.ruled import ruled
from stages.geometry.ruled.ruled import RuledPatch
from stages.model.report import Finding
from stages.model.surface import Certificate, RuledSurface, Span
from stages.model.tolerances import Tolerances
from stages.unroll.thickness import neutral

STEPS = 4096
"""Places on each patch where it may be divided: a power of two, so that it is divided at short fractions."""

MOST_TURN = pi / 12.0
"""Most that an edge turns, in rad, over one arc: where its curvature doubles over 1 rad, that is within 2e-4 radii."""
FEWEST, MOST = 4, 512
"""Arcs along each edge of a patch: however straight it is, and however it winds (at `MOST_TURN` an arc, 21 times)."""

EVENED = 1.0 / 256.0
"""Of the area: the largest blank is at most so much more than the least that it can be."""

LOOKED = 64, 8, 1
"""Shares of what is left in which the end of a run is first looked for: a run of t turns takes t cubed to look at."""

NO_LENGTH = 1e-12
"""Below this share of the pattern's extent a length is rounding (an edge that is an apex)."""


@dataclass(frozen=True, slots=True, eq=False)
class Strip(ArrayValue):
    """The whole pattern, flat.

    knots: places, v counted over the pieces, between which the edges are arcs.  area: up to each of them, mm2.
    point: what is no longer than this is a point, mm.
    """

    pieces: tuple[FlatPiece, ...]
    knots: Values
    area: Values
    point: float


def blanks(certificate: Certificate, tol: Tolerances) -> tuple[Certificate, ...]:
    """Return the certificates of the blanks, named `<part>.<n>`; the one given where nothing is divided.

    Where the development does not resolve the part stays whole too: `unroll` says so.
    """
    surface = certificate.surface
    if not isinstance(surface, RuledSurface) or surface.part.spec.cut != "auto" or surface.trim is not None:
        return (certificate,)
    try:
        flat = neutral(surface, tol).surface
        ends = runs(strip_of(develop(flat.patches)), allowed=tol.chord_mm**2)
    except NoSolutionError:
        return (certificate,)
    if len(ends) == 1:
        return (certificate,)
    cuts = pairwise(place(flat, end) for end in (0, *ends))
    return tuple(replace(certificate, surface=blank(surface, n, *cut)) for n, cut in enumerate(cuts, 1))


def place(surface: RuledSurface, end: int) -> Fraction:
    """Return the part's v at the end of a run, given in 1/4096 of a patch."""
    piece = min(end // STEPS, len(surface.spans) - 1)
    low, high = surface.spans[piece]
    return low + Fraction(end - piece * STEPS, STEPS) * (high - low)


def strip_of(development: Development) -> Strip:
    """Return the pattern with the places between which its edges are arcs."""
    ends = np.array([0.0, 0.0, 0.5, 0.5, 1.0, 1.0]), np.array([0.0, 1.0] * 3)
    point = NO_LENGTH * max(float(norm(piece.positions(*ends[::-1])).max()) for piece in development.pieces)
    counts = [_arc_count(piece, point) for piece in development.pieces]
    places = [np.linspace(0.0, 1.0, count, endpoint=False) + i for i, count in enumerate(counts)]
    knots = np.append(np.concatenate(places), float(len(counts)))
    c0, c1 = (_points(development.pieces, u, knots) for u in (0.0, 1.0))
    quads = np.abs(cross2(c1[1:] - c0[:-1], c0[1:] - c1[:-1])) / 2.0
    return Strip(development.pieces, knots, np.concatenate([[0.0], np.cumsum(quads)]), point)


def _arc_count(piece: FlatPiece, point: float) -> int:
    """Return into how many arcs the edges of a piece are divided: a power of two, so that places are exact."""
    v = np.linspace(0.0, 1.0, MOST + 1)
    turns = []
    for u in (0.0, 1.0):
        step = np.diff(piece.positions(np.full_like(v, u), v), axis=0)
        turns.append(float(np.abs(_turns(step[:-1], step[1:], point)).max()) * MOST)
    wanted = max(*turns, FEWEST * MOST_TURN) / MOST_TURN
    return min(1 << ceil(log2(wanted)), MOST)


def _turns(first: Points2, second: Points2, point: float) -> Values:
    """Return the angles in rad from vectors to vectors; those no longer than a point have no direction."""
    long = np.minimum(norm(first), norm(second)) > point
    return np.where(long, np.arctan2(cross2(first, second), dot(first, second)), 0.0)


def _points(pieces: tuple[FlatPiece, ...], u: float, places: Values) -> Points2:
    """Return the flat points of an edge at places counted over the pieces."""
    index = np.minimum(places.astype(np.int64), len(pieces) - 1)
    found = np.zeros((places.size, 2))
    for i in np.unique(index):
        chosen = index == i
        v = places[chosen] - i
        found[chosen] = pieces[i].positions(np.full_like(v, u), v)
    return found


def runs(strip: Strip, *, allowed: float) -> list[int]:
    """Return where the runs end, in 1/4096 of a patch, each covering at most `allowed` mm2 twice.

    As few as possible, the largest as small as possible; the whole in one where dividing does not help.
    """
    whole = float(strip.area[-1])
    fewest = _greedy(strip, whole, allowed, STEPS * len(strip.pieces))
    if fewest is None or len(fewest) == 1:
        return [STEPS * len(strip.pieces)]
    low, high = 1.0 / len(fewest), 1.0
    # by less than a step, so that what can be divided evenly is
    best, share = fewest, low + (1.0 - low / 2.0) * _largest_step(strip) / whole
    while high - low > EVENED:
        found = _greedy(strip, share * whole, allowed, len(fewest))
        if found is not None:
            best, high = found, share
        else:
            low = share
        share = (low + high) / 2.0
    return best


def _largest_step(strip: Strip) -> float:
    """Return by how much the area of a run may fall short of one that is asked for, as it ends in 1/4096, mm2."""
    return float((np.diff(strip.area) / np.diff(strip.knots)).max()) / STEPS


def _greedy(strip: Strip, most: float, allowed: float, count: int) -> list[int] | None:
    """Return the runs of at most `most` mm2, each as long as can be; None for more than `count`, or an empty one."""
    ends, likely = [0], 0
    while ends[-1] < STEPS * len(strip.pieces):
        end = _farthest(strip, ends[-1], most, allowed, likely) if len(ends) <= count else ends[-1]
        if end == ends[-1]:
            return None
        likely = end - ends[-1]
        ends.append(end)
    return ends[1:]


def _farthest(strip: Strip, start: int, most: float, allowed: float, likely: int) -> int:
    """Return the end of the longest run from `start` that neither exceeds the area nor overlaps.

    likely: how long that may be, 0 where nothing is known.
    """
    spent = float(np.interp(start / STEPS, strip.knots, strip.area))
    last = int(np.interp(spent + most, strip.area, strip.knots) * STEPS)

    @cache
    def good(end: int) -> bool:
        return end == start or doubled(run_outline(strip, start, end)) <= allowed

    # a run as long as the area permits is what evening out comes to
    if likely and last - start <= 2 * likely and good(last):
        return last
    near = min(start + likely, last) if likely else _within(good, start, last)
    fits, fails = _around(good, near, start, last)
    while fails - fits > 1:
        middle = (fits + fails) // 2
        fits, fails = (middle, fails) if good(middle) else (fits, middle)
    return fits


def _within(good: Callable[[int], bool], first: int, last: int) -> int:
    """Return the first end that is not good of some that are ever farther, or the last of all."""
    ends = (first + (last - first) // share for share in LOOKED)
    return next((end for end in ends if not good(end)), last)


def _around(good: Callable[[int], bool], near: int, first: int, last: int) -> tuple[int, int]:
    """Return an end that is good and one that is not, both near one; the last of all twice where that is good."""
    step, onward = 1, good(near)
    here = near
    while here != (last if onward else first):
        there = min(here + step, last) if onward else max(here - step, first)
        if good(there) != onward:
            return (here, there) if onward else (there, here)
        here, step = there, 2 * step
    return here, here


def run_outline(strip: Strip, low: int, high: int) -> ArcPath:
    """Return the outline of a run, its ends in 1/4096 of a patch, counter-clockwise."""
    first, last = low / STEPS, high / STEPS
    inner = strip.knots[(strip.knots > first) & (strip.knots < last)]
    places = np.concatenate([[first], inner, [last]])
    there, there_bulges = _edge(strip, 1.0, places)
    back, back_bulges = _edge(strip, 0.0, places[::-1])
    corners = np.concatenate([there, back])
    bulges = np.concatenate([there_bulges, [0.0], back_bulges, [0.0]])
    kept = norm(np.roll(corners, -1, axis=0) - corners) > strip.point
    return ArcPath(corners[kept], bulges[kept], closed=True)


def _edge(strip: Strip, u: float, places: Array) -> tuple[Array, Array]:
    """Return points of an edge and the bulges between them, one less: arcs through the middles."""
    points = _points(strip.pieces, u, places)
    middles = _points(strip.pieces, u, (places[:-1] + places[1:]) / 2.0)
    return points, np.tan(_turns(middles - points[:-1], points[1:] - middles, strip.point) / 2.0)


def blank(surface: RuledSurface, number: int, low: Fraction, high: Fraction) -> RuledSurface:
    """Return the part of the surface between two of its rulings, by their v.

    A place on a cut belongs to the blank that begins there.
    """
    patches: list[RuledPatch] = []
    spans: list[Span] = []
    for patch, (start, end) in zip(surface.patches, surface.spans, strict=True):
        first, last = max(start, low), min(end, high)
        if first < last:
            width = end - start
            patches.append(ruled.part(patch, (first - start) / width, (last - start) / width))
            spans.append((first, last))
    part = replace(surface.part, spec=surface.part.spec.blank(number))
    size = ruled.size_of(patches)
    ends_inside = high < surface.spans[-1][1]
    features = tuple(one for one in surface.features
                     if not (ends_inside and one.at is not None and one.at[1] == float(high)))  # fmt: skip
    return replace(
        surface,
        part=part,
        patches=tuple(patches),
        size_mm=size,
        spans=tuple(spans),
        features=features,
        divided=True,
    )


def division(surface: RuledSurface) -> tuple[Finding, ...]:
    """Return what an engineer must know of a blank: between which rulings of the part it lies."""
    if not surface.divided:
        return ()
    low, high = float(surface.spans[0][0]), float(surface.spans[-1][1])
    message = f"one blank of a part that would overlap itself when flat: its rulings from v = {low:.6g} to {high:.6g}"
    return (Finding("divided", message, fatal=False, where={"v": low, "v_end": high}),)
