"""The feet of points on a strip of ruled patches, and their signed distances.

Feet are nearest places, each sought on the whole surface (`pullback`), exact to rounding.  The distance is signed along
N = p x S_v.  A point beyond an edge has its foot on the edge, and counts with its whole distance.  Against a face of
the sheet, at a height along N, it is the distance to the face above the foot.
"""

from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import ArrayValue, Points2, Points3, Values, cross3, dot, norm, unit
from stages.geometry.ruled.nearest import nearest
from stages.geometry.ruled.strip import Strip, jet, size

BESIDE = 1e-6
"""A foot is beneath its point if the point is off its normal by less than this share of the size."""


@dataclass(frozen=True, slots=True, eq=False)
class Feet(ArrayValue):
    """Nearest places (u, v), their points, and the signed distances, mm.

    beyond: whether the point is beyond an edge.
    """

    place: Points2
    at: Points3
    distance_mm: Values
    beyond: Values


def exact_feet(strip: Strip, every: Points3) -> Feet:
    """Return the nearest places of points, each sought on the whole surface."""
    return at_places(strip, every, np.array([nearest(strip, point).place for point in every]))


def off_faces(strip: Strip, feet: Feet, every: Points3, heights: Values) -> tuple[Values, Points3]:
    """Return how far points are off the faces at these heights above their feet, mm, and in which directions."""
    found = jet(strip, *feet.place.T)
    normal = unit(cross3(found.s_u, found.s_v))
    away = every - feet.at - heights[:, None] * normal
    height = dot(away, normal)
    sign, beyond = np.where(height < 0.0, -1.0, 1.0), feet.beyond > 0.0
    along = np.where(beyond[:, None], sign[:, None] * unit(away), normal)
    return np.where(beyond, sign * norm(away), height), along


def at_places(strip: Strip, every: Points3, place: Points2) -> Feet:
    """Return points against their feet at given places."""
    found = jet(strip, *place.T)
    across = cross3(found.s_u, found.s_v)
    normal = unit(across)
    off = every - found.s
    away, height = norm(off), dot(off, normal)
    sign = np.where(height < 0.0, -1.0, 1.0)
    beside = np.sqrt((away**2 - height**2).clip(0.0))
    beyond = beside > BESIDE * size(strip)
    return Feet(place, found.s, np.where(beyond, sign * away, height), beyond.astype(np.float64))
