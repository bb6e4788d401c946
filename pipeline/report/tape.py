"""What to measure on a blank with a tape: corners with letters, edges along and straight, diagonals.

The corners are those of the surface that was laid flat, c0(0), c1(0), c1(1), c0(1), where they lie on the outline that
is cut; else (plates, meshes, allowances) those at which the outline turns by more than `SHARP_RAD`.  A tape goes over
notches.  A blank without corners has nothing to measure but its width and height.

Evidence: corners and edges of a surface come from its development, sampled.  Those of an outline are lengths of the
lines and arcs that are cut, in closed form, and distances of their ends: proved.
"""

from collections.abc import Iterator, Mapping, Sequence
from math import hypot, radians
from string import ascii_uppercase

import numpy as np

from stages.geometry.arrays import Points2
from stages.geometry.paths.arcpath import ArcPath, distances, joint_turns, lengths, piece_count, split
from stages.model.pattern import FlatPattern
from stages.model.report import Evidence

Document = dict[str, object]
Pair = tuple[float, float]
Edge = tuple[str, float, int, int]
"""What it is, its length along, mm, and the corners that it joins."""

SHARP_RAD = radians(30.0)
MOST_CORNERS = 12
"""The sharpest: more than that nobody measures."""

EDGES = (("start", 0, 1), ("c1", 1, 2), ("end", 2, 3), ("c0", 3, 0))
"""The edges of a surface by the corners that they join."""

EDGE, DIAGONAL = "edge", "diagonal"
"""What spans are that are no edge of a surface."""

SAME_MM = 1e-6
ON_OUTLINE = 4.0
"""In chord tolerances: how near a corner must be to the outline to be one of it."""

QUARTER_BULGE = 0.41421356237309503
LEAST_CORNERS = 2
SQUARE = 4


def tape_entry(pattern: FlatPattern, edges: Mapping[str, float] | None) -> Document:
    """Return what is measured on the blank of a pattern.

    edges: of the surface that was laid flat, by name, mm; None where there are none, or the cut lies outside of some.
    """
    outline = (pattern.boundary or pattern.outer).path
    if edges is not None and _lie_on(pattern.corners, outline, ON_OUTLINE * pattern.outer.chord_mm):
        named = [(what, edges[what], first, last) for what, first, last in EDGES]
        return _entry(_pairs(pattern.corners), named, "sampled")
    at = _sharp(outline)
    return _entry(_pairs(outline.vertices[at]), list(_sides(outline, at)), "proved")


def _pairs(points: Points2) -> list[Pair]:
    return [(float(x), float(y)) for x, y in points]


def _entry(corners: Sequence[Pair], edges: Sequence[Edge], evidence: Evidence) -> Document:
    """Return corners by their letters, edges by name, length and the corners that they join, and the diagonals."""
    spans = [_span(corners, edge, evidence) for edge in edges if edge[1] > SAME_MM]
    spans += [_span(corners, (DIAGONAL, None, i, j), evidence) for i, j in _across(corners)]
    return {"spots": list(_spots(corners)), "spans": spans}


def _across(corners: Sequence[Pair]) -> list[tuple[int, int]]:
    """Return the corners that lie opposite of each other."""
    count = len(corners)
    pairs = [(i, i + count // 2) for i in range((count + 1) // 2)] if count >= SQUARE else []
    return [(i, j) for i, j in pairs if j < count and _apart(corners, i, j) > SAME_MM]


def _span(corners: Sequence[Pair], edge: tuple[str, float | None, int, int], evidence: Evidence) -> Document:
    what, along, i, j = edge
    return {
        "from": ascii_uppercase[i],
        "to": ascii_uppercase[j],
        "what": what,
        "along_mm": along,
        "straight_mm": _apart(corners, i, j),
        "evidence": evidence,
    }


def _apart(corners: Sequence[Pair], i: int, j: int) -> float:
    return hypot(corners[j][0] - corners[i][0], corners[j][1] - corners[i][1])


def _spots(corners: Sequence[Pair]) -> Iterator[Document]:
    """Yield the corners with their letters, those that fall together as one."""
    for i, (x, y) in enumerate(corners):
        same = [j for j in range(len(corners)) if _apart(corners, i, j) <= SAME_MM]
        if same[0] == i:
            yield {"letters": "".join(ascii_uppercase[j] for j in same), "x": x, "y": y}


def _lie_on(corners: Points2, outline: ArcPath, bound_mm: float) -> bool:
    """Return whether all corners are on the outline."""
    path = split(outline, max_bulge=QUARTER_BULGE)
    pieces = np.arange(piece_count(path))
    away = [distances(np.broadcast_to(at, (pieces.size, 2)), path, pieces).min() for at in corners]
    return bool(max(away) <= bound_mm)


def _sharp(outline: ArcPath) -> list[int]:
    """Return the vertices at which an outline turns sharply, in its order."""
    turns = np.abs(joint_turns(outline))
    sharpest = np.argsort(-turns, kind="stable")[:MOST_CORNERS]
    return sorted(int(i) for i in sharpest if turns[i] > SHARP_RAD)


def _sides(outline: ArcPath, at: Sequence[int]) -> Iterator[Edge]:
    """Yield what lies between neighbouring corners of an outline."""
    if len(at) < LEAST_CORNERS:
        return
    long = lengths(outline)
    for i, first in enumerate(at):
        following = (i + 1) % len(at)
        last = at[following] if following else at[0] + len(long)
        pieces = np.arange(first, last) % len(long)
        yield EDGE, float(long[pieces].sum()), i, following
