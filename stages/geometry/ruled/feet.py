"""The feet of points on a strip of ruled patches, and their signed distances.

Feet are nearest places, each sought on the whole surface (`pullback`), exact to rounding.  The distance is signed along
N = p x S_v.  A point beyond an edge has its foot on the edge, and counts with its whole distance.
"""

from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import ArrayValue, Points2, Points3, Values, cross3, dot, norm
from stages.geometry.ruled.pullback import nearest
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


def at_places(strip: Strip, every: Points3, place: Points2) -> Feet:
    """Return points against their feet at given places."""
    found = jet(strip, *place.T)
    across = cross3(found.s_u, found.s_v)
    normal = np.divide(across, norm(across)[:, None], out=np.zeros_like(across), where=norm(across)[:, None] > 0.0)
    off = every - found.s
    away, height = norm(off), dot(off, normal)
    sign = np.where(height < 0.0, -1.0, 1.0)
    beside = np.sqrt((away**2 - height**2).clip(0.0))
    beyond = beside > BESIDE * size(strip)
    return Feet(place, found.s, np.where(beyond, sign * away, height), beyond.astype(np.float64))
