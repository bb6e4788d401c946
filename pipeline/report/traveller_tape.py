"""What to measure on a blank with a tape: corners with letters, edges along and straight, diagonals.

The corners are those of the surface that was laid flat, c0(0), c1(0), c1(1), c0(1), where they lie on the outline that
is cut; else (plates, meshes, allowances) those at which the outline turns by more than `SHARP_RAD`.  A blank without
corners is measured across: its width and height are all there is.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import hypot, radians
from string import ascii_uppercase

import numpy as np

from pipeline.report.traveller_entries import FlatEntry, Pair
from stages.geometry.arcpath import ArcPath, distances, joint_turns, lengths, piece_count, split

SHARP_RAD = radians(30.0)
MOST_CORNERS = 12
"""The sharpest: more than that nobody measures."""

EDGES = (("start", 0, 1), ("c1", 1, 2), ("end", 2, 3), ("c0", 3, 0))
"""The edges of a surface by the corners that they join."""

SAME_MM = 1e-6
ON_OUTLINE = 4.0
"""In chord tolerances: how near a corner must be to the outline to be one of it."""

QUARTER_BULGE = 0.41421356237309503
LEAST_CORNERS = 2
SQUARE = 4


@dataclass(frozen=True, slots=True)
class Spot:
    """A corner by its letters (more than one where corners fall together), in the flat frame, mm."""

    letters: str
    x: float
    y: float


@dataclass(frozen=True, slots=True)
class Span:
    """A distance: between which corners, what it is, along the edge (None: a diagonal) and straight, mm."""

    spots: str
    what: str
    along_mm: float | None
    straight_mm: float


@dataclass(frozen=True, slots=True)
class Tape:
    """What is measured on a blank."""

    spots: tuple[Spot, ...]
    spans: tuple[Span, ...]
    diagonals: tuple[tuple[int, int], ...]
    """Corners that are joined across, numbers of `corners`."""

    corners: tuple[Pair, ...]


def tape(flat: FlatEntry, outline: ArcPath, chord_mm: float) -> Tape:
    """Return what is measured on a blank with that outline."""
    if flat.edges is not None and _lie_on(flat.corners, outline, ON_OUTLINE * chord_mm):
        named = [(what, flat.edges[what], first, last) for what, first, last in EDGES]
        return _tape(flat.corners, named)
    at = _sharp(outline)
    corners = tuple((float(x), float(y)) for x, y in outline.vertices[at])
    return _tape(corners, list(_sides(outline, at)))


def _tape(corners: Sequence[Pair], edges: Sequence[tuple[str, float, int, int]]) -> Tape:
    """Return edges by name, length and the corners that they join, and the diagonals."""
    count = len(corners)
    across = [(i, i + count // 2) for i in range((count + 1) // 2)] if count >= SQUARE else []
    across = [(i, j) for i, j in across if j < count and _apart(corners, i, j) > SAME_MM]
    letters = ascii_uppercase
    spans = [
        Span(f"{letters[i]} \N{EN DASH} {letters[j]}", what, along, _apart(corners, i, j))
        for what, along, i, j in edges
        if along > SAME_MM
    ]
    spans += [
        Span(f"{letters[i]} \N{EN DASH} {letters[j]}", "diagonal", None, _apart(corners, i, j)) for i, j in across
    ]
    return Tape(tuple(_spots(corners)), tuple(spans), tuple(across), tuple(corners))


def _apart(corners: Sequence[Pair], i: int, j: int) -> float:
    return hypot(corners[j][0] - corners[i][0], corners[j][1] - corners[i][1])


def _spots(corners: Sequence[Pair]) -> Iterator[Spot]:
    """Yield the corners with their letters, those that fall together as one."""
    for i, (x, y) in enumerate(corners):
        same = [j for j in range(len(corners)) if _apart(corners, i, j) <= SAME_MM]
        if same[0] == i:
            yield Spot(" = ".join(ascii_uppercase[j] for j in same), x, y)


def _lie_on(corners: Sequence[Pair], outline: ArcPath, bound_mm: float) -> bool:
    """Return whether all corners are on the outline."""
    path = split(outline, max_bulge=QUARTER_BULGE)
    count = piece_count(path)
    away = [distances(np.broadcast_to(np.array(at), (count, 2)), path, np.arange(count)).min() for at in corners]
    return bool(max(away) <= bound_mm)


def _sharp(outline: ArcPath) -> list[int]:
    """Return the vertices at which an outline turns sharply, in its order."""
    turns = np.abs(joint_turns(outline))
    sharpest = np.argsort(-turns, kind="stable")[:MOST_CORNERS]
    return sorted(int(i) for i in sharpest if turns[i] > SHARP_RAD)


def _sides(outline: ArcPath, at: Sequence[int]) -> Iterator[tuple[str, float, int, int]]:
    """Yield what lies between neighbouring corners of an outline."""
    if len(at) < LEAST_CORNERS:
        return
    long = lengths(outline)
    for i, first in enumerate(at):
        following = (i + 1) % len(at)
        last = at[following] if following else at[0] + len(long)
        pieces = np.arange(first, last) % len(long)
        yield "edge", float(long[pieces].sum()), i, following
