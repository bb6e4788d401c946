"""Outlines that share cuts, put together again from a file alone: open polylines, and lines in the middle of a kerf.

On CUT_OUTER a LINE is a common line, an open LWPOLYLINE what is left of an outline.  Half a kerf to the left of the
line, in either sense, lies a side that outlines run along, counter-clockwise, their parts to the left.  So each outline
is a face of the graph of polylines and sides: at every node it takes the leftmost way on, and comes back to where it
began.  Sides that nobody runs along are the ends where lines meet; they are as short as the kerf is wide.

Nothing of the drawing that was written is used here.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import pi

import numpy as np
from shapely import STRtree, linestrings

from stages.geometry.arrays import Array, Numbers, Points2, cross2, norm, unit
from stages.geometry.paths.arcpath import ArcPath, directions, piece_count
from stages.geometry.paths.biarc import LEAST_PIECE_MM
from stages.write.chains import Entity

MEET_MM = 2e-6
"""Ends as near as this meet: edges are a kerf apart to 1e-6 mm, and coordinates rounded to 1e-10."""

HALF_TURN = pi - 1e-9
"""From here on a turn is a turning back, the last way to be taken."""

PARALLEL = 1e-9
"""Sides under this sine of an angle cross nowhere that matters: they are a kerf apart, or one continues the other."""


@dataclass(frozen=True, slots=True)
class Outline:
    """An outline that was put together: its closed path, and the places of its entities in the file."""

    path: ArcPath
    entities: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Way:
    """A directed path from node to node; `entity` is its place in the file."""

    path: ArcPath
    entity: int
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class Closed:
    """The outlines that share cuts, and what of the file does not belong to any."""

    outlines: tuple[Outline, ...]
    loose: tuple[str, ...]


def closed_again(entities: Sequence[Entity], kerf_mm: float) -> Closed:
    """Return the outlines that open paths on CUT_OUTER make up."""
    found = [(place, entity) for place, entity in enumerate(entities) if is_shared(entity)]
    rests = [(entity.path, place) for place, entity in found if entity.kind != "LINE" and entity.path is not None]
    lines = [(entity.path, place) for place, entity in found if entity.kind == "LINE" and entity.path is not None]
    ways = _ways(rests, _sides(lines, kerf_mm))
    return _faces(ways, len(rests), max(kerf_mm, LEAST_PIECE_MM) + MEET_MM)


def is_shared(entity: Entity) -> bool:
    """Return whether an entity is a common line or a part of an outline that shares cuts."""
    return entity.layer == "CUT_OUTER" and not entity.closed


Owned = tuple[ArcPath, int]
"""A path and the place of its entity in the file."""


def _sides(lines: Sequence[Owned], kerf_mm: float) -> list[Owned]:
    """Return both sides of all lines, cut where others begin, end or cross."""
    sides = [(ends, place) for line, place in lines for ends in _both(line.vertices, kerf_mm)]
    if not sides:
        return []
    every = np.stack([ends for ends, _ in sides])
    drawn = linestrings(every)
    one, other = STRtree(drawn).query(drawn, predicate="dwithin", distance=2.0 * MEET_MM)
    return [
        (ArcPath(np.stack(pair), np.zeros(2), closed=False), place)
        for number, (ends, place) in enumerate(sides)
        for pair in _parts(ends, every[other[one == number]])
    ]


def _both(line: Points2, kerf_mm: float) -> tuple[Points2, Points2]:
    """Return the sides of a line: half a kerf to its left, and to the left of its way back."""
    forward = unit(line[1] - line[0])
    aside = kerf_mm / 2.0 * np.array([-forward[1], forward[0]])
    return line + aside, line[::-1] - aside


def _parts(side: Points2, other: Array) -> Iterator[tuple[Array, Array]]:
    """Yield a side in parts, cut where other sides, shape (n, 2, 2), begin, end or cross it."""
    forward, long = unit(side[1] - side[0]), float(norm(side[1] - side[0]))
    off = cross2(forward[None, None], other - side[0])
    at = (other - side[0]) @ forward
    on = np.where(np.abs(off) <= MEET_MM, at, -1.0).ravel()
    rise = off[:, 1] - off[:, 0]
    crosses = (np.abs(rise) > PARALLEL * norm(other[:, 1] - other[:, 0])) & (off[:, 0] * off[:, 1] < 0.0)
    share = np.divide(-off[:, 0], rise, out=np.zeros_like(rise), where=crosses)
    crossed = np.where(crosses, at[:, 0] + share * (at[:, 1] - at[:, 0]), -1.0)
    inner = np.sort(np.concatenate([on, crossed]))
    inner = inner[(inner > MEET_MM) & (inner < long - MEET_MM)]
    inner = inner[np.diff(inner, prepend=-1.0) > MEET_MM]
    points = [side[0], *(side[0] + inner[:, None] * forward), side[1]]
    yield from pairwise(points)


def _ways(rests: Sequence[Owned], sides: Sequence[Owned]) -> list[Way]:
    """Return rests and sides with their nodes: ends that meet are one."""
    every = [*rests, *sides]
    if not every:
        return []
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    ends = np.concatenate([path.vertices[[0, -1]] for path, _ in every])
    near = cKDTree(ends).query_pairs(MEET_MM, output_type="ndarray")
    links = coo_matrix((np.ones(len(near)), (near[:, 0], near[:, 1])), shape=(len(ends), len(ends)))
    node: Numbers = connected_components(links, directed=False)[1].reshape(-1, 2)
    return [Way(path, place, *map(int, node[k])) for k, (path, place) in enumerate(every)]


def _faces(ways: Sequence[Way], rests: int, least_mm: float) -> Closed:
    """Return the faces of the graph that hold a rest, or a side that is not just the end of a line."""
    leaving: dict[int, list[int]] = {}
    for number, way in enumerate(ways):
        leaving.setdefault(way.start, []).append(number)
    left, outlines, loose = set(range(len(ways))), list[Outline](), list[str]()
    for number, way in enumerate(ways):
        if number not in left or (number >= rests and _length(way) <= least_mm):
            continue
        face = _face(number, ways, leaving, left)
        left -= set(face)
        if ways[face[-1]].end == way.start:
            outlines.append(_outline([ways[one] for one in face]))
        else:
            x, y = ways[face[-1]].path.vertices[-1]
            loose.append(f"an outline that shares cuts ends at ({x:.6g}, {y:.6g})")
    return Closed(tuple(outlines), tuple(loose))


def _length(way: Way) -> float:
    return float(norm(way.path.vertices[-1] - way.path.vertices[0]))


def _face(first: int, ways: Sequence[Way], leaving: dict[int, list[int]], left: set[int]) -> list[int]:
    """Return the ways that follow each other, always the leftmost, until there is none or the first is back."""
    face = [first]
    while ways[face[-1]].end != ways[first].start or len(face) == 1:
        open_ways = [one for one in leaving.get(ways[face[-1]].end, ()) if one in left and one not in face]
        if not open_ways:
            break
        face.append(max(open_ways, key=lambda one: _turn(ways[face[-1]], ways[one])))
    return face


def _turn(way: Way, onto: Way) -> float:
    """Return the turn from one way to the next in rad, positive to the left; turning back counts as to the right."""
    turn = float(directions(onto.path)[0][0] - directions(way.path)[1][-1])
    turn = pi - (pi - turn) % (2.0 * pi)
    return -pi if turn >= HALF_TURN else turn


def _outline(face: Sequence[Way]) -> Outline:
    """Return the closed path of a face; where a line begins or ends amid a straight edge there is no vertex."""
    counts = [piece_count(way.path) for way in face]
    vertices = np.concatenate([way.path.vertices[:count] for way, count in zip(face, counts, strict=True)])
    bulges = np.concatenate([way.path.bulges[:count] for way, count in zip(face, counts, strict=True)])
    joints = np.cumsum([0, *counts[:-1]])
    chord = np.roll(vertices, -1, axis=0)[joints] - vertices[joints - 1]
    aside = np.abs(cross2(unit(chord), vertices[joints] - vertices[joints - 1]))
    amid = (aside <= MEET_MM) & (bulges[joints] == 0.0) & (bulges[joints - 1] == 0.0)
    path = ArcPath(np.delete(vertices, joints[amid], axis=0), np.delete(bulges, joints[amid]), closed=True)
    return Outline(path, tuple(dict.fromkeys(way.entity for way in face)))
