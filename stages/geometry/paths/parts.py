"""Parts of a closed path between places on it, and the same path begun elsewhere; lines stay lines, arcs arcs.

A place is a number: the piece plus the share of its length that lies before it.  Places may run on beyond the last
piece, into the next round.
"""

import numpy as np

from stages.geometry.arrays import Points2, Values
from stages.geometry.paths.arcpath import ArcPath, along, directions, lengths, piece_count, sweeps


def part(path: ArcPath, leave: float, enter: float) -> ArcPath:
    """Return the open path from one place on a closed one to a later one."""
    places = np.concatenate([[leave], np.arange(np.floor(leave) + 1.0, np.ceil(enter)), [enter]])
    piece = np.floor(places[:-1]).astype(np.int64)
    bulges = np.tan(sweeps(path)[piece % path.bulges.size] * np.diff(places) / 4.0)
    return ArcPath(points_at(path, places), np.append(bulges, 0.0), closed=False)


def points_at(path: ArcPath, places: Values) -> Points2:
    """Return the points at places; vertices as they are."""
    piece = np.floor(places).astype(np.int64)
    number, share = piece % path.bulges.size, places - piece
    found: Points2 = path.vertices[number]
    between = share != 0.0
    if between.any():
        found[between] = along(path, number[between], share[between])
    return found


def direction_at(path: ArcPath, place: float) -> float:
    """Return the direction at a place, in rad; at a vertex that of the piece after it."""
    piece = int(np.floor(place))
    number = piece % path.bulges.size
    return float(directions(path)[0][number] + sweeps(path)[number] * (place - piece))


def place_at(path: ArcPath, distance: float) -> float:
    """Return the place at a distance along a closed path from its first vertex, mm; it may run round more than once."""
    return float(places_at(path, np.array([distance]))[0])


def places_at(path: ArcPath, distances: Values) -> Values:
    """Return the places at distances along a closed path from its first vertex, mm."""
    ends = np.concatenate([[0.0], np.cumsum(lengths(path))])
    rounds, rest = np.divmod(distances, ends[-1])
    piece = np.minimum(np.searchsorted(ends, rest, side="right") - 1, path.bulges.size - 1)
    share = (rest - ends[piece]) / (ends[piece + 1] - ends[piece])
    places: Values = rounds * path.bulges.size + piece + share
    return places


def settled(path: ArcPath, places: Values, least: float) -> Values:
    """Return places at which a path may be cut: vertices where a piece shorter than `least` mm would be left."""
    piece = np.floor(places)
    share, long = places - piece, lengths(path)[piece.astype(np.int64) % piece_count(path)]
    late: Values = np.where((1.0 - share) * long < least, piece + 1.0, places)
    return np.where(share * long < least, piece, late)


def begun(path: ArcPath, place: float) -> ArcPath:
    """Return a closed path that begins at a place, which becomes a vertex if it is none."""
    piece = int(np.floor(place)) % path.bulges.size
    if place == np.floor(place):
        return ArcPath(np.roll(path.vertices, -piece, axis=0), np.roll(path.bulges, -piece), closed=True)
    whole = part(path, place, place + path.bulges.size)
    return ArcPath(whole.vertices[:-1], whole.bulges[:-1], closed=True)
