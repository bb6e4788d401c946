"""Sampled figures of a ruled surface: warp, |K|, bending radius, rulings and normals that vanish, turning.

Each is the extreme of a smooth function of v found by `extremum.maxima`, on both ends of the rulings where u matters
(the radius of curvature is linear along a ruling).  All figures of one search share the frames.  Sampled, not proved.
"""

from dataclasses import dataclass
from math import inf, pi

import numpy as np

from stages.geometry.arrays import Array, Values, norm
from stages.geometry.numeric.extremum import maxima
from stages.geometry.numeric.quadrature import integral
from stages.geometry.ruled.ruled import (
    Frames,
    RuledPatch,
    curvature_of,
    end_normals,
    frames,
    gaussian_of,
    turn_rate,
    warp_of,
)


@dataclass(frozen=True, slots=True)
class Extreme:
    """A value and the piece, v on it and u where it is reached."""

    value: float
    piece: int
    v: float
    u: float | None = None


@dataclass(frozen=True, slots=True)
class Survey:
    """How far a patch is from developable, and where it is nearest to having no tangent plane.

    warp: the largest, rad; pi where no ruling has a normal.  gaussian: the largest |K|, 1/mm2.
    ruling: the shortest ruling strictly inside, mm; the ends may be apexes.
    normal: the least |n(1/2)| / (|p| max|c'|) strictly inside: 0 where a ruling is along the directrix.
    regular: whether neither end normal vanishes anywhere, ends included, as far as samples show.
    """

    warp: Extreme
    gaussian: Extreme
    ruling: Extreme
    normal: Extreme
    regular: bool


def survey(patch: RuledPatch, piece: int) -> Survey:
    """Return the extremes of a patch, all from one search."""
    length, speed = _largest(patch)

    def figures(v: Values) -> Array:
        f = frames(patch, v)
        return np.column_stack([warp_of(f), gaussian_of(f), -_strengths(f, v, speed)])

    warp, gaussian, ruling, normal, weakest = maxima(figures)
    return Survey(
        Extreme(max(warp[0], 0.0), piece, warp[1]) if warp[0] > -inf else Extreme(pi, piece, 0.5),
        Extreme(max(gaussian[0], 0.0), piece, gaussian[1]),
        Extreme(-ruling[0], piece, ruling[1]),
        Extreme(-normal[0], piece, normal[1]),
        -weakest[0] > NO_NORMAL * length * speed,
    )


def _strengths(f: Frames, v: Values, speed: float) -> Array:
    """Return the length of the rulings, the middle normal over it and a speed, and the weaker end normal, (n, 3)."""
    n0, n1 = end_normals(f)
    length = norm(f.p)
    middle = np.divide(norm(n0 + n1), length * speed, out=np.ones_like(length), where=length * speed > 0)
    return np.stack([_inside(length, v), _inside(middle, v), np.minimum(norm(n0), norm(n1))], axis=1)


NO_NORMAL = 1e-7
"""A normal below this share of the largest |p| and |c'| vanishes: sampling comes within 5e-9 of a zero, and there the
normal grows by up to some ten times its scale per unit of v."""


def _largest(patch: RuledPatch) -> tuple[float, float]:
    """Return the largest |p| and |c'| over the patch at 65 places, mm: scales that do not depend on where one looks."""
    f = frames(patch, np.linspace(0.0, 1.0, 65))
    return float(norm(f.p).max()), float(max(norm(f.c0_d1).max(), norm(f.c1_d1).max()))


INSIDE = 1e-3
"""Rulings within this share of an end count as the end's: both figures above may fade to zero there."""


def _inside(values: Values, v: Values) -> Values:
    return np.where((v > INSIDE) & (v < 1.0 - INSIDE), values, np.inf)


def largest_curvature(patch: RuledPatch, piece: int) -> Extreme:
    """Return the largest curvature across the rulings, 1/mm; infinite at an apex."""

    def figures(v: Values) -> Array:
        f = frames(patch, v)
        bends: Array = np.abs(np.stack([curvature_of(f, 0.0), curvature_of(f, 1.0)], axis=1))
        return bends

    value, v, u = max((*found, u) for found, u in zip(maxima(figures), (0.0, 1.0), strict=True))
    return Extreme(max(value, 0.0), piece, v, u)


def turning(patch: RuledPatch) -> float:
    """Return how far the rulings turn in the flat over the patch, rad, with its sign (counter-clockwise positive).

    Raises NoSolutionError where the turning does not resolve: a patch that folds.
    """

    def rates(v: Values) -> Array:
        turning = turn_rate(frames(patch, v))
        return np.stack([turning, np.ones_like(turning)], axis=1)  # the second channel sets the scale: 1 rad

    return float(integral(rates, "turning of the rulings")[0])
