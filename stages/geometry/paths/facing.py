"""Where straight edges of closed paths face each other across a narrow strip, and the middle of that strip.

Paths run counter-clockwise around what is kept.  Two straight pieces face each other if they run against each other,
each on the outer side of the other, and are equally far apart at both ends of the stretch over which they overlap.
Middles that continue each other are one line: where two parts lie side by side along a third, the line runs on across
the strip between the two.

Pairs are found on their boxes.  Arcs are not looked at.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from shapely import STRtree, box, linestrings

from stages.geometry.arrays import Array, ArrayValue, Indices, Numbers, Points2, Values, dot, norm, unit
from stages.geometry.paths.arcpath import ArcPath, chords
from stages.geometry.paths.clearance import FLAT_BULGE

BIT_MM = 5e-3
"""Shorter overlaps are none: half of what counts as cut twice."""


@dataclass(frozen=True, slots=True)
class Strip:
    """What is asked of two facing edges, mm: how far apart they are, how parallel, over what length at least."""

    apart_mm: float
    tolerance_mm: float
    least_mm: float


@dataclass(frozen=True, slots=True)
class Edge:
    """A straight piece of a path, both by number."""

    path: int
    piece: int


@dataclass(frozen=True, slots=True, eq=False)
class Middle(ArrayValue):
    """A line in the middle of a strip, from and to, shape (2, 2), and the edges on both sides of it."""

    ends: Points2
    edges: tuple[Edge, ...]

    @property
    def length_mm(self) -> float:
        """How long it is."""
        return float(norm(self.ends[1] - self.ends[0]))


@dataclass(frozen=True, slots=True, eq=False)
class _Straight(ArrayValue):
    """The straight pieces of some paths that are long enough, and which they are."""

    start: Points2
    end: Points2
    path: Indices
    piece: Indices


@dataclass(frozen=True, slots=True, eq=False)
class Facing(ArrayValue):
    """Pairs of edges that face each other, each pair once, the path of the smaller number first.

    path, piece: numbers of both edges, shape (n, 2).
    apart: how far they are apart, mm.  outward: unit normals from the first to the second.
    ends: where the middle of the strip begins and ends, shape (n, 2, 2).
    """

    path: Numbers
    piece: Numbers
    apart: Values
    outward: Points2
    ends: Array


def middles(paths: Sequence[ArcPath], strip: Strip) -> list[Middle]:
    """Return the middles of all strips between different paths, those that continue each other as one line.

    A shorter overlap than asked counts where it continues one that is long enough.
    """
    reach = Strip(strip.apart_mm + strip.tolerance_mm, strip.tolerance_mm, min(BIT_MM, strip.least_mm))
    found = facing(paths, reach)
    fit = np.flatnonzero(np.abs(found.apart - strip.apart_mm) <= strip.tolerance_mm).tolist()
    single = [Middle(found.ends[k], (_edge(found, k, 0), _edge(found, k, 1))) for k in fit]
    return _continued(single, strip)


def _edge(found: Facing, pair: int, side: int) -> Edge:
    return Edge(int(found.path[pair, side]), int(found.piece[pair, side]))


def facing(paths: Sequence[ArcPath], strip: Strip) -> Facing:
    """Return the edges of different paths that face each other and are at most so far apart."""
    some = _straight(paths, strip.least_mm)
    one, other = _near(some, strip.apart_mm)
    start, forward = some.start[one], unit(some.end[one] - some.start[one])
    # the other piece runs backwards: its end lies behind its start
    ahead, behind = (dot(end[other] - start, forward) for end in (some.start, some.end))
    low, high = np.maximum(behind, 0.0), np.minimum(ahead, norm(some.end[one] - start))
    fits = (ahead > behind) & (high - low >= strip.least_mm)
    outward = np.stack([forward[:, 1], -forward[:, 0]], axis=1)
    share = np.divide(ahead - np.stack([low, high]), ahead - behind, out=np.zeros((2, one.size)), where=fits)
    across = some.start[other] + share[..., None] * (some.end - some.start)[other]
    here = start + np.stack([low, high])[..., None] * forward
    apart = dot(across - here, outward)
    fits &= (np.abs(apart[1] - apart[0]) <= strip.tolerance_mm) & (apart.max(axis=0) <= strip.apart_mm)
    fits &= apart.min(axis=0) >= -strip.tolerance_mm
    ends = np.swapaxes((here + across) / 2.0, 0, 1)[fits]
    path, piece = (np.stack([which[one], which[other]], axis=1)[fits] for which in (some.path, some.piece))
    return Facing(path, piece, apart.mean(axis=0)[fits], outward[fits], ends)


def _straight(paths: Sequence[ArcPath], least_mm: float) -> _Straight:
    """Return the straight pieces of closed paths that are not shorter than that."""
    ends = [chords(path) for path in paths]
    start, end = (np.concatenate([np.zeros((0, 2)), *(one[k] for one in ends)]) for k in (0, 1))
    counts = [path.bulges.size for path in paths]
    path = np.repeat(np.arange(len(counts)), counts)
    piece = np.concatenate([np.zeros(0, dtype=np.int64), *(np.arange(count) for count in counts)])
    bulge = np.concatenate([np.zeros(0), *(one.bulges for one in paths)])
    long = np.flatnonzero((np.abs(bulge) < FLAT_BULGE) & (norm(end - start) >= least_mm))
    return _Straight(start[long], end[long], path[long], piece[long])


def _near(some: _Straight, reach: float) -> tuple[Indices, Indices]:
    """Return the pairs of pieces of different paths whose boxes come that near, each once, in order."""
    low, high = np.minimum(some.start, some.end), np.maximum(some.start, some.end)
    frames, wide = box(*low.T, *high.T), box(*(low - reach).T, *(high + reach).T)
    one, other = STRtree(frames).query(wide)
    once = some.path[one] < some.path[other]
    order = np.lexsort((other[once], one[once]))
    return one[once][order].astype(np.int64), other[once][order].astype(np.int64)


def _continued(single: Sequence[Middle], strip: Strip) -> list[Middle]:
    """Return the middles with those joined that lie on one line and no farther apart than the strip is wide."""
    if not single:
        return []
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    drawn = linestrings([line.ends for line in single])
    one, other = STRtree(drawn).query(drawn, predicate="dwithin", distance=strip.apart_mm + 2.0 * strip.tolerance_mm)
    meet = [i < j and _continues(single[i].ends, single[j].ends, strip) for i, j in zip(one, other, strict=True)]
    links = coo_matrix((np.ones(sum(meet)), (one[meet], other[meet])), shape=(len(single), len(single)))
    count, label = connected_components(links, directed=False)
    groups: list[list[Middle]] = [[] for _ in range(count)]
    for line, group in zip(single, label.tolist(), strict=True):
        groups[group].append(line)
    return [_joined(group) for group in groups if _is_long(group, strip)]


def _is_long(lines: Sequence[Middle], strip: Strip) -> bool:
    return any(line.length_mm >= strip.least_mm for line in lines)


def _continues(line: Points2, other: Points2, strip: Strip) -> bool:
    """Return whether two lines are parts of one, the strip's width between their ends or less."""
    forward = unit(line[1] - line[0])
    aside = (other - line[0]) @ np.array([-forward[1], forward[0]])
    if np.abs(aside).max() > strip.tolerance_mm:
        return False
    at = (other - line[0]) @ forward
    gap = max(float(at.min()) - float(norm(line[1] - line[0])), -float(at.max()))
    return gap <= strip.apart_mm + strip.tolerance_mm


def _joined(lines: Sequence[Middle]) -> Middle:
    """Return lines that continue each other as one, which runs to the right, or straight up."""
    every = np.concatenate([line.ends for line in lines])
    forward = lines[0].ends[1] - lines[0].ends[0]
    order = np.argsort((every - every[0]) @ forward, kind="stable")
    ends = every[order[[0, -1]]]
    edges = tuple(dict.fromkeys(edge for line in lines for edge in line.edges))
    return Middle(ends if ends[0].tolist() <= ends[1].tolist() else ends[::-1], edges)
