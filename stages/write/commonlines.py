"""Common lines: where two parts are a kerf apart along straight edges, one cut in the middle of it serves both.

On the drawing of a sheet such a stretch is one LINE on CUT_OUTER in the middle of the kerf, and both outlines are
written without it, as open polylines.  The line is the way of the beam itself; it is cut with the later of its two
parts, after the holes of both.  Outlines are nominal, as everywhere: the machine keeps half a kerf outside of them, and
there its cut meets that of the line.

Where the neighbour of one of them reaches a little along the other, the line runs on: it would be cut twice otherwise.
A line that ends a hair before the end of an edge runs on to it, so that no piece is left that is too short to cut.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import ArrayValue, Points2, Vector2, norm, unit
from stages.geometry.paths.arcpath import ArcPath, chords, length
from stages.geometry.paths.biarc import LEAST_PIECE_MM
from stages.geometry.paths.facing import Edge, Middle, Strip, middles

LEAST_COMMON_MM = 20.0
"""Shorter edges are not worth the trouble of one cut for two parts."""

APART_MM = 1e-6
"""How exactly two edges must be a kerf apart: above the rounding of coordinates, below what any machine can cut."""

Stretch = tuple[int, float, float]
"""A straight piece of an outline, and from which to which share of it: what a common line takes away."""


@dataclass(frozen=True, slots=True, eq=False)
class CommonLine(ArrayValue):
    """A cut in the middle of the kerf, from and to, shape (2, 2), and the outlines beside it, by rising number."""

    ends: Points2
    outlines: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Shared:
    """Outlines that share cuts: the lines, and what is left of every outline; an outline that shares nothing is whole.

    saved_mm: length that is cut once instead of twice.
    """

    lines: tuple[CommonLine, ...]
    rests: tuple[tuple[ArcPath, ...], ...]
    saved_mm: float


def shared_cuts(outlines: Sequence[ArcPath], kerf_mm: float) -> Shared:
    """Return the common lines of outlines that lie on one sheet, and what is left of each outline."""
    found = middles(outlines, Strip(kerf_mm, APART_MM, LEAST_COMMON_MM))
    lines = [_run_on(line, outlines) for line in found]
    taken: list[list[Stretch]] = [[] for _ in outlines]
    for line in lines:
        for edge in line.edges:
            taken[edge.path].append((edge.piece, *_covered(line, edge, outlines)))
    rests = [rests_of(path, stretches) for path, stretches in zip(outlines, taken, strict=True)]
    cut = sum(line.length_mm for line in lines) + sum(length(rest) for some in rests for rest in some)
    owned = [CommonLine(line.ends, tuple(sorted({edge.path for edge in line.edges}))) for line in lines]
    return Shared(tuple(owned), tuple(map(tuple, rests)), sum(map(length, outlines)) - cut)


def in_turn(lines: Sequence[CommonLine], begin: Vector2) -> list[ArcPath]:
    """Return the lines as paths, from a point always on to the nearest end, and from there along."""
    at, left, made = begin, [line.ends for line in lines], list[ArcPath]()
    while left:
        away = norm(np.stack(left) - at)
        line, end = np.unravel_index(int(away.argmin()), away.shape)
        ends = left.pop(int(line))[:: -1 if end else 1]
        made.append(ArcPath(ends, np.zeros(2), closed=False))
        at = ends[1]
    return made


def rests_of(path: ArcPath, taken: Iterable[Stretch]) -> list[ArcPath]:
    """Return what is left of a closed path without some stretches of its straight pieces, in order; itself if none."""
    spans = _united(taken)
    if not spans:
        return [path]
    gaps = [(leave, spans[k + 1][0]) for k, (_, leave) in enumerate(spans[:-1])]
    gaps.append((spans[-1][1], spans[0][0] + path.bulges.size))
    return [_between(path, leave, enter) for leave, enter in gaps if leave < enter]


def _united(taken: Iterable[Stretch]) -> list[tuple[float, float]]:
    """Return stretches from and to places along the path (piece plus share), those that overlap or touch as one."""
    spans: list[tuple[float, float]] = []
    for low, high in sorted((piece + low, piece + high) for piece, low, high in taken):
        if spans and low <= spans[-1][1]:
            spans[-1] = spans[-1][0], max(spans[-1][1], high)
        else:
            spans.append((low, high))
    return spans


def _between(path: ArcPath, leave: float, enter: float) -> ArcPath:
    """Return the open path from one place on a closed one to a later one; pieces that are cut short are straight."""
    places = np.concatenate([[leave], np.arange(np.floor(leave) + 1.0, np.ceil(enter)), [enter]])
    piece = np.floor(places).astype(np.int64)
    share = places - piece
    piece %= path.bulges.size
    start, end = chords(path)
    points = start[piece] + share[:, None] * (end - start)[piece]
    whole = (share[:-1] == 0.0) & (share[1:] == 0.0)
    return ArcPath(points, np.append(np.where(whole, path.bulges[piece[:-1]], 0.0), 0.0), closed=False)


def _run_on(line: Middle, outlines: Sequence[ArcPath]) -> Middle:
    """Return a line that goes on to the ends of its edges that it misses by less than a piece that can be cut."""
    forward = unit(line.ends[1] - line.ends[0])
    long = line.length_mm
    ends = [0.0, long]
    for edge in line.edges:
        for at in ((point - line.ends[0]) @ forward for point in _ends(edge, outlines)):
            ends += [float(at)] if -LEAST_PIECE_MM < at < 0.0 or long < at < long + LEAST_PIECE_MM else []
    return Middle(line.ends[0] + np.outer([min(ends), max(ends)], forward), line.edges)


def _covered(line: Middle, edge: Edge, outlines: Sequence[ArcPath]) -> tuple[float, float]:
    """Return from which to which share of an edge a line runs beside it; the whole edge where only rounding is left."""
    start, end = _ends(edge, outlines)
    long = float(norm(end - start))
    low, high = sorted(((line.ends - start) @ unit(end - start)).tolist())
    return 0.0 if low <= APART_MM else low / long, 1.0 if high >= long - APART_MM else high / long


def _ends(edge: Edge, outlines: Sequence[ArcPath]) -> tuple[Vector2, Vector2]:
    start, end = chords(outlines[edge.path])
    return start[edge.piece], end[edge.piece]
