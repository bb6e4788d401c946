"""Parts of a closed path between places on it, and the same path begun elsewhere; lines stay lines, arcs arcs.

A place is a number: the piece plus the share of its length that lies before it.  Places may run on beyond the last
piece, into the next round.
"""

import numpy as np

from stages.geometry.arcpath import ArcPath, along, directions, lengths, piece_count, sweeps
from stages.geometry.arrays import Values, Vector2


def part(path: ArcPath, leave: float, enter: float) -> ArcPath:
    """Return the open path from one place on a closed one to a later one."""
    places = np.concatenate([[leave], np.arange(np.floor(leave) + 1.0, np.ceil(enter)), [enter]])
    piece = np.floor(places[:-1]).astype(np.int64)
    share = np.diff(places)
    points = np.stack([point_at(path, place) for place in places.tolist()])
    bulges = np.tan(sweeps(path)[piece % path.bulges.size] * share / 4.0)
    return ArcPath(points, np.append(bulges, 0.0), closed=False)


def point_at(path: ArcPath, place: float) -> Vector2:
    """Return the point at a place; a vertex as it is."""
    piece = int(np.floor(place))
    found = path.vertices[piece % path.bulges.size]
    if place != piece:
        found = along(path, np.array([piece % path.bulges.size]), np.array([place - piece]))[0]
    point: Vector2 = found
    return point


def direction_at(path: ArcPath, place: float) -> float:
    """Return the direction at a place, in rad; at a vertex that of the piece after it."""
    piece = int(np.floor(place))
    number = piece % path.bulges.size
    return float(directions(path)[0][number] + sweeps(path)[number] * (place - piece))


def place_at(path: ArcPath, distance: float) -> float:
    """Return the place at a distance along a closed path from its first vertex, mm; it may run round more than once."""
    ends = _ends(path)
    rounds, rest = divmod(distance, float(ends[-1]))
    piece = min(int(np.searchsorted(ends, rest, side="right")) - 1, path.bulges.size - 1)
    share = (rest - float(ends[piece])) / float(ends[piece + 1] - ends[piece])
    return rounds * path.bulges.size + piece + share


def _ends(path: ArcPath) -> Values:
    """Return how far each vertex is from the first, and the first from itself, once round, in mm."""
    ends: Values = np.concatenate([[0.0], np.cumsum(lengths(path))])
    return ends


def settled(path: ArcPath, place: float, least: float) -> float:
    """Return a place at which a path may be cut: the vertex where a piece shorter than `least` mm would be left."""
    piece = np.floor(place)
    share = place - piece
    long = float(lengths(path)[int(piece) % piece_count(path)])
    if share * long < least:
        return float(piece)
    return float(piece + 1.0) if (1.0 - share) * long < least else place


def begun(path: ArcPath, place: float) -> ArcPath:
    """Return a closed path that begins at a place, which becomes a vertex if it is none."""
    piece = int(np.floor(place)) % path.bulges.size
    if place == np.floor(place):
        return ArcPath(np.roll(path.vertices, -piece, axis=0), np.roll(path.bulges, -piece), closed=True)
    whole = part(path, place, place + path.bulges.size)
    return ArcPath(whole.vertices[:-1], whole.bulges[:-1], closed=True)
