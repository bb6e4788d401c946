"""Sampled figures of a ruled surface: warp, curvature, bending radius, shortest ruling, turning.

Each is the extreme of a smooth function of v found by `extremum.maximum`, on both ends of the rulings where u matters
(the radius of curvature is linear along a ruling).  Sampled, not proved.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

from stages.geometry import ruled
from stages.geometry.arrays import Values, norm
from stages.geometry.extremum import maximum
from stages.geometry.quadrature import integral
from stages.geometry.ruled import RuledPatch, end_normals, frames, turn_rate
from stages.model.report import Where


@dataclass(frozen=True, slots=True)
class Extreme:
    """A value and the piece, v and u where it is reached."""

    value: float
    piece: int
    v: float
    u: float | None = None

    @property
    def where(self) -> Where:
        """Return the place for a report; v counts on over the pieces."""
        place: Where = {"v": self.piece + self.v}
        return place if self.u is None else place | {"u": self.u}


def largest_warp(patch: RuledPatch, piece: int) -> Extreme:
    """Return the largest warp, rad."""
    value, v = maximum(lambda v: ruled.warp(patch, v))
    return Extreme(max(value, 0.0), piece, v)


def largest_gaussian(patch: RuledPatch, piece: int) -> Extreme:
    """Return the largest |K|, 1/mm2."""
    value, v = maximum(lambda v: ruled.gaussian(patch, v))
    return Extreme(max(value, 0.0), piece, v)


def largest_curvature(patch: RuledPatch, piece: int) -> Extreme:
    """Return the largest curvature across the rulings, 1/mm; infinite at an apex."""
    found = [(*maximum(partial(_bend, patch, u)), u) for u in (0.0, 1.0)]
    value, v, u = max(found)
    return Extreme(max(value, 0.0), piece, v, u)


def _bend(patch: RuledPatch, u: float, v: Values) -> Values:
    bend: Values = np.abs(ruled.curvature(patch, v, u))
    return bend


def shortest_ruling(patch: RuledPatch, piece: int) -> Extreme:
    """Return the shortest ruling strictly inside the patch, mm; the ends may be apexes."""
    value, v = maximum(lambda v: -_inside(norm(patch.p.jet(v, 0)[0]), v))
    return Extreme(-value, piece, v)


def weakest_normal(patch: RuledPatch, piece: int) -> Extreme:
    """Return the least |n(1/2)| / (|p| max|c'|) strictly inside: 0 where a ruling is along the directrix."""
    _, speed = _largest(patch)

    def strength(v: Values) -> Values:
        f = frames(patch, v)
        n0, n1 = end_normals(f)
        scale = norm(f.p) * speed
        return _inside(np.divide(norm(n0 + n1), scale, out=np.ones_like(scale), where=scale > 0), v)

    value, v = maximum(lambda v: -strength(v))
    return Extreme(-value, piece, v)


def is_regular(patch: RuledPatch) -> bool:
    """Return whether neither end normal vanishes anywhere, ends included, as far as samples show."""
    ruling, speed = _largest(patch)

    def weakness(v: Values) -> Values:
        n0, n1 = end_normals(frames(patch, v))
        return -np.minimum(norm(n0), norm(n1))

    return -maximum(weakness)[0] > NO_NORMAL * ruling * speed


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


def turning(patch: RuledPatch) -> float:
    """Return how far the rulings turn in the flat over the patch, rad, with its sign (counter-clockwise positive).

    Raises NoSolutionError where the turning does not resolve: a patch that folds.
    """

    def rate(v: Values) -> np.ndarray:
        rate = turn_rate(frames(patch, v))
        return np.stack([rate, np.ones_like(rate)], axis=1)  # the second channel sets the scale: 1 rad

    return float(integral(rate, "turning of the rulings")[0])
