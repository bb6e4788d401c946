"""Common lines: where two straight edges of neighbours are one cut, they may be a kerf apart and not the gap.

The rule.  A common line is where a straight piece of the outer contour of one part and one of another face each other:
they run against each other, each on the outer side of the other, over an overlap of at least `LEAST_COMMON_MM`, at both
ends of which they are exactly the kerf apart (to `GAP_TOLERANCE_MM`).  The neighbourhood of a common line on a contour
is what hangs together with the line and stays within `NEAR_GAPS` gaps of it.  Excused from the gap are two points, one
of each part, that belong to the neighbourhoods of the same common line, or of two that meet (come as near as two kerfs:
four parts about a cross).  All other points keep the gap, and none come nearer than the kerf.

So square corners and slits that open by 30 degrees or more at the end of a common line pass; a slit that opens more
slowly, a nose that comes back to the other part further on, and an edge at any other distance do not.  Holes need no
excuse: what is nearer to a hole of a part than to its outline lies in the hole, where there are no common lines.

Pieces are cut where lines leave the neighbourhood; arcs are halved about where they do, down to a quarter of a gap, and
what is not wholly in the neighbourhood then counts as outside of it, so that less is excused, never more.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from shapely import STRtree, box, linestrings

from stages.geometry.arrays import Array, Indices, Mask, Numbers, Points2, Values, cross2, dot, norm, unit
from stages.geometry.paths.arcpath import ArcPath, along, lengths, sweeps
from stages.geometry.paths.clearance import Pieces, between, boxes, distances, joined, point_distances
from stages.geometry.paths.enclosed import inside
from stages.model.sheet import NestOptions
from stages.nest.legal.region import GAP_TOLERANCE_MM, Region

Gaps = dict[tuple[int, int], float]
"""Distances in mm by the numbers of two parts, the smaller first."""

LEAST_COMMON_MM = 20.0
"""Shorter edges are not worth the trouble of one cut for two parts."""

NEAR_GAPS = 2.0
"""1 / sin 30 deg: a slit that opens by 30 deg is a gap wide at this many gaps from its end."""

ARC_STEPS = 4.0
"""Steps of an arc to a gap, where it leaves a neighbourhood."""

MEETING_KERFS = 2.0
"""The corners of four parts about a cross are 1.4 kerfs apart."""

BEYOND_MM = 1.0
"""How far beyond the gap a distance is still told."""

SAME_PLACES = 12
"""Shares of a piece that agree to so many decimals are one place."""

LAST = 1.0 - 10.0**-SAME_PLACES

PARALLEL = 1e-9
"""Pieces that rise by less than this share of the neighbourhood's width run along its edge and do not cross it."""


class Stretch(NamedTuple):
    """A common line: from and to, mm, on the piece of the first part and on that of the second."""

    first: int
    second: int
    on_first: Points2
    on_second: Points2


def common_stretches(a: Region, b: Region, kerf_mm: float) -> list[Stretch]:
    """Return the common lines of two parts."""
    return list(_stretches(a.pieces[0], b.pieces[0], kerf_mm))


class Line(NamedTuple):
    """One side of a common line: the part and the straight piece of its outline, and its ends, shape (2, 2), mm."""

    part: int
    piece: int
    ends: Points2


class Cut(NamedTuple):
    """Outlines in smaller pieces, the part of each, and which lines' neighbourhoods it belongs to (pieces by lines)."""

    pieces: Pieces
    part: Numbers
    near: csr_array


def without_common_lines(regions: Sequence[Region], gaps: Gaps, options: NestOptions) -> Gaps:
    """Return the gaps of pairs by number; of those under the gap that have common lines what these do not excuse.

    Such a gap is looked for up to a little more than asked, and infinite if all that is nearer is excused.
    """
    least = min(options.kerf_mm, options.gap_mm) - GAP_TOLERANCE_MM
    near = [pair for pair, gap in gaps.items() if least <= gap < options.gap_mm - GAP_TOLERANCE_MM]
    lines = [
        line
        for i, j in near
        for one in common_stretches(regions[i], regions[j], options.kerf_mm)
        for line in (Line(i, one.first, one.on_first), Line(j, one.second, one.on_second))
    ]
    if not lines:
        return gaps
    cut = _cut_all(regions, lines, options.gap_mm)
    one, other = _near_pieces(cut, [pair for pair in near if not _one_in_other(regions, pair)], len(regions), options)
    through = cut.near @ _meeting(lines, options.kerf_mm)
    excused = through[one].multiply(cut.near[other]).sum(axis=1) > 0
    return gaps | _left(cut, one, other, excused)


def _left(cut: Cut, one: Numbers, other: Numbers, excused: Mask) -> Gaps:
    """Return the least distance of pieces that are not excused, for every two parts of which some are."""
    left: Gaps = dict.fromkeys(
        zip(cut.part[one[excused]].tolist(), cut.part[other[excused]].tolist(), strict=True), np.inf
    )
    one, other = one[~excused], other[~excused]
    distance = distances(cut.pieces.take(one), cut.pieces.take(other)).tolist()
    for i, j, apart in zip(cut.part[one].tolist(), cut.part[other].tolist(), distance, strict=True):
        if apart < left.get((i, j), -np.inf):
            left[i, j] = apart
    return left


def _near_pieces(
    cut: Cut, pairs: Sequence[tuple[int, int]], count: int, options: NestOptions
) -> tuple[Numbers, Numbers]:
    """Return the pieces of those pairs of parts, out of `count` parts, that may be nearer than a bit over the gap."""
    low_high = boxes(cut.pieces)
    reach = options.gap_mm + BEYOND_MM
    grown = low_high + reach * np.array([-1.0, -1.0, 1.0, 1.0])
    one, other = STRtree(box(*low_high.T)).query(box(*grown.T))
    wanted = np.array([i * count + j for i, j in pairs], dtype=np.int64)
    chosen = np.isin(cut.part[one] * count + cut.part[other], wanted)
    return one[chosen].astype(np.int64), other[chosen].astype(np.int64)


def _one_in_other(regions: Sequence[Region], pair: tuple[int, int]) -> bool:
    """Return whether one part lies within the outline of the other, in a hole then: nothing is excused there."""
    for a, b in (pair, pair[::-1]):
        (low_x, low_y, high_x, high_y), (x, y, right, top) = regions[a].box, regions[b].box
        if low_x < x and low_y < y and right < high_x and top < high_y:
            return bool(inside(regions[b].contours[0].vertices[:1], regions[a].pieces[0])[0])
    return False


def _meeting(lines: Sequence[Line], kerf_mm: float) -> csr_array:
    """Return which sides of common lines belong to one line, or to lines that meet (lines by lines)."""
    drawn = linestrings(np.stack([line.ends for line in lines]))
    reach = MEETING_KERFS * kerf_mm + GAP_TOLERANCE_MM
    one, other = STRtree(drawn).query(drawn, predicate="dwithin", distance=reach)
    return csr_array((np.ones(one.size), (one, other)), shape=(len(lines), len(lines)))


def _cut_all(regions: Sequence[Region], lines: Sequence[Line], gap_mm: float) -> Cut:
    """Return the outlines of all parts that have common lines, cut where they leave the neighbourhoods of these."""
    of_part: defaultdict[int, list[int]] = defaultdict(list)
    for number, line in enumerate(lines):
        of_part[line.part].append(number)
    cuts = [_cut(regions[part].pieces[0], [lines[i] for i in own], gap_mm) for part, own in of_part.items()]
    part = np.repeat(np.fromiter(of_part, np.int64), [some.bulge.size for some, _ in cuts])
    first = np.cumsum([0, *(some.bulge.size for some, _ in cuts)])
    held = [np.nonzero(near) for _, near in cuts]
    rows = np.concatenate([row + start for (row, _), start in zip(held, first.tolist(), strict=False)])
    columns = np.concatenate([np.array(own)[at] for (_, at), own in zip(held, of_part.values(), strict=True)])
    near = csr_array((np.ones(rows.size), (rows, columns)), shape=(part.size, len(lines)))
    return Cut(joined([some for some, _ in cuts]), part, near)


def _stretches(a: Pieces, b: Pieces, kerf_mm: float) -> Iterator[Stretch]:
    """Yield the common lines of two contours whose material is on the left."""
    long_a, long_b = (np.flatnonzero((c.bulge == 0.0) & (norm(c.end - c.start) >= LEAST_COMMON_MM)) for c in (a, b))
    first, second = (np.ravel(grid) for grid in np.meshgrid(long_a, long_b, indexing="ij"))
    one, other = a.take(first), b.take(second)
    forward = unit(one.end - one.start)
    outward = np.stack([forward[:, 1], -forward[:, 0]], axis=1)
    ahead, behind = (dot(end - one.start, forward) for end in (other.start, other.end))
    high, low = np.minimum(ahead, norm(one.end - one.start)), np.maximum(behind, 0.0)
    fits = (ahead > behind) & (high - low >= LEAST_COMMON_MM)
    span = np.where(fits, ahead - behind, 1.0)
    for at in (low, high):
        facing = other.start + ((ahead - at) / span)[:, None] * (other.end - other.start)
        fits &= np.abs(dot(facing - one.start, outward) - kerf_mm) <= GAP_TOLERANCE_MM
    for k in np.flatnonzero(fits).tolist():
        ends = np.array([low[k], high[k]])
        on_first = one.start[k] + ends[:, None] * forward[k]
        on_second = other.start[k] + ((ahead[k] - ends) / span[k])[:, None] * (other.end - other.start)[k]
        yield Stretch(int(first[k]), int(second[k]), on_first, on_second)


def _cut(contour: Pieces, lines: Sequence[Line], gap_mm: float) -> tuple[Pieces, NDArray[np.bool_]]:
    """Return an outline cut where it leaves the neighbourhoods of its lines, and which pieces belong to which."""
    near = NEAR_GAPS * gap_mm
    path = ArcPath(contour.start, contour.bulge, closed=True)
    cuts = [_line_cuts(contour, line.ends, near) for line in lines]
    marks = [[0.0, *(f for cut in cuts for f in cut[i] if 0.0 < f < LAST)] for i in range(contour.bulge.size)]
    for i, shares_of_arc in _arc_cuts(contour, path, lines, near, gap_mm / ARC_STEPS).items():
        marks[i] = shares_of_arc
    shares = [np.unique(np.round(each, SAME_PLACES)) for each in marks]
    piece = np.repeat(np.arange(len(shares)), [len(each) for each in shares])
    start = np.concatenate(shares)
    last = np.append(piece[1:] != piece[:-1], True)
    end = np.where(last, 1.0, np.roll(start, -1))
    some = between(
        along(path, piece, start), along(path, piece, end), np.tan(sweeps(path)[piece] * (end - start) / 4.0)
    )
    return some, np.stack([_hanging(some, piece, line, near) for line in lines], axis=1)


def _line_cuts(contour: Pieces, ends: Array, near: float) -> Array:
    """Return where the carriers of the straight pieces meet the circles and lines round a neighbourhood, as shares."""
    along_piece, axis = contour.end - contour.start, unit(ends[1] - ends[0])
    shares = []
    for end in ends:
        offset = contour.start - end
        square, half = dot(along_piece, along_piece), dot(along_piece, offset)
        root = np.sqrt(np.maximum(half**2 - square * (dot(offset, offset) - near**2), 0.0))
        shares += [(-half - root) / square, (-half + root) / square]
    across = cross2(axis[None], along_piece)
    for side in (near, -near):
        height = side - cross2(axis[None], contour.start - ends[0])
        shares.append(np.divide(height, across, out=np.zeros_like(across), where=np.abs(across) > PARALLEL * near))
    return np.stack(shares, axis=1)


def _arc_cuts(
    contour: Pieces, path: ArcPath, lines: Sequence[Line], near: float, least_mm: float
) -> dict[int, list[float]]:
    """Return where the parts of each arc begin, as shares: halved until each is in or out of every neighbourhood.

    A part no longer than `least_mm` is left as it is.  An arc meets the edge of a neighbourhood in eight places at
    most, and only the part about such a place is halved on: there are few, however small the gap.
    """
    found: defaultdict[int, list[float]] = defaultdict(list)
    piece = np.flatnonzero(contour.bulge)
    low, high, sweep, size = np.zeros(piece.size), np.ones(piece.size), sweeps(path), lengths(path)
    while piece.size:
        some = between(along(path, piece, low), along(path, piece, high), np.tan(sweep[piece] * (high - low) / 4.0))
        done = (size[piece] * (high - low) <= least_mm) | _settled(some, lines, near)
        for i, share in zip(piece[done].tolist(), low[done].tolist(), strict=True):
            found[i].append(share)
        piece, low, high = piece[~done], low[~done], high[~done]
        middle = (low + high) / 2.0
        piece, low, high = np.tile(piece, 2), np.concatenate([low, middle]), np.concatenate([middle, high])
    return found


def _settled(some: Pieces, lines: Sequence[Line], near: float) -> Mask:
    """Return which arcs are halved no more: those wholly in or wholly out of each neighbourhood."""
    settled = np.ones(some.bulge.size, dtype=bool)
    for line in lines:
        settled &= (_farthest(some, line.ends) <= near) | (_nearest(some, line.ends) > near)
    return settled


def _farthest(some: Pieces, ends: Array) -> Values:
    """Return what no point of a piece is further from a segment than, mm: the farther end, an arc's height added."""
    farthest: Values = np.maximum(_away(some.start, *ends), _away(some.end, *ends)) + _heights(some)
    return farthest


def _nearest(some: Pieces, ends: Array) -> Values:
    """Return what no point of a piece is nearer to a segment than, mm: that of its chord, less an arc's height.

    Not of chords that cross the segment: with them it says too much.
    """
    there = np.minimum(_away(some.start, *ends), _away(some.end, *ends))
    back = [_away(end, some.start, some.end) for end in ends]
    return np.asarray(np.minimum.reduce([there, *back]) - _heights(some))


def _hanging(some: Pieces, piece: Indices, line: Line, near: float) -> Mask:
    """Return which pieces of a cut contour are near a common line and hang together with it."""
    middles = _away((some.start + some.end) / 2.0, *line.ends)
    close = np.where(some.bulge == 0.0, middles, _farthest(some, line.ends)) <= near
    middle = np.tile(line.ends.mean(axis=0), (piece.size, 1))
    home = int(np.argmin(np.where(piece == line.piece, point_distances(middle, some), np.inf)))
    turned = np.roll(close, -home)
    if turned.all():
        return close
    ahead = np.cumprod(turned).astype(bool)
    back = np.cumprod(turned[::-1]).astype(bool)[::-1]
    hanging: Mask = np.roll(ahead | back, home)
    return hanging


def _away(points: Array, start: Array, end: Array) -> Values:
    """Return the distance of points to segments, mm; one of either or one for each."""
    chord = end - start
    share = np.clip(dot(points - start, chord) / dot(chord, chord), 0.0, 1.0)
    return norm(points - start - share[..., None] * chord)


def _heights(some: Pieces) -> Values:
    """Return the heights of arcs over their chords, mm: no point of an arc is further from its chord."""
    return np.asarray(np.abs(some.bulge) * norm(some.end - some.start) / 2.0)
