"""Whether a mesh is a plane, a cylinder of revolution or a right circular cone, and how surely.

    recognised(mesh, chord_mm=...) -> Recognised | None

The simplest primitive of least squares (`primitives`) is taken whose deviation is explained by what the file
keeps of its numbers, and never one that merely is near: of a surface that is something else the deviations of the
vertices are a smooth function of the place, however small they are, and those by rounding and noise are not.  The rule:

1. the facets stand for the surface: they face one way, none is a piece of a lid, the surface turns by no more than
   `SMOOTH_RAD` over one of them on average (a prism is no cylinder), and there are three times as many vertices as a
   cylinder or cone has parameters;
2. no vertex is farther away than a tenth of the chord;
3. and either no vertex is farther away than the rounding of the file (`rounding`), or the deviations of neighbours are
   independent: their correlation along the edges (Moran's I [1]_) is within `INDEPENDENT` standard deviations of 0.

.. [1] P. A. P. Moran, "Notes on continuous stochastic phenomena", Biometrika 37, 1950, 17-23.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import radians

import numpy as np

from stages.geometry.arrays import EPS, Mask, Points3, Values, cross3, dot, norm, unit
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.primitives import (
    Plane,
    Primitive,
    Rotational,
    cone,
    cylinder,
    distances,
    facets,
    normals,
    plane,
)
from stages.geometry.mesh.topology import half_edges

SMOOTH_RAD = radians(20.0)
"""18 facets round a circle: coarser meshes may be meant as prisms and pyramids."""
WIDEST_RAD = radians(100.0)
"""Some facet of a lid, however it is divided, reaches 120 deg round the axis."""
ABOUT_APEX, ON_APEX = 0.1, 1e-6
"""As shares of the largest slant height: facets about an apex, and a vertex that is one."""
PER_PARAMETER = 3
SHARE = 0.1
"""Of the chord: what a fit may be off."""
INDEPENDENT = 4.0
"""Standard deviations: noise is beyond them in one mesh of 30 000."""
UNITS = (1.0, 25.4, 10.0, 1000.0, 304.8)
"""Millimetres in the units that files are written in."""
FINEST_DECIMALS = 9
KEPT = 4.0
"""Roundings that a deviation may have: three coordinates, and the fit through them."""


@dataclass(frozen=True, slots=True)
class Deviation:
    """How far vertices are from a surface: the farthest and the root mean square, mm, and what rounding explains.

    correlation: of neighbours, in standard deviations of that of independent ones.
    """

    most_mm: float
    rms_mm: float
    rounding_mm: float
    correlation: float

    def explained(self, chord_mm: float) -> bool:
        """Return whether rounding or noise explains it, far below the chord."""
        noise = abs(self.correlation) <= INDEPENDENT
        return self.most_mm <= SHARE * chord_mm and (self.most_mm <= self.rounding_mm or noise)


@dataclass(frozen=True, slots=True)
class Recognised:
    """A primitive, and how far the vertices are from it."""

    primitive: Primitive
    deviation: Deviation


def recognised(mesh: Mesh, *, chord_mm: float) -> Recognised | None:
    """Return the simplest primitive that explains the vertices, or None."""
    for least, fit in FITS:
        found = fit(mesh) if len(mesh.vertices) >= least else None
        if found is not None:
            deviation = deviation_of(mesh, distances(found, mesh.vertices), reach_mm=_reach(found))
            if deviation.explained(chord_mm) and _faces_along(mesh, found):
                return Recognised(found, deviation)
    return None


FITS: tuple[tuple[int, Callable[[Mesh], Plane | Rotational | None]], ...] = (
    (3, plane),
    (PER_PARAMETER * 5, cylinder),
    (PER_PARAMETER * 6, cone),
)
"""With the least number of vertices: a plane needs no more than it has parameters, its facets are in it."""


def _reach(found: Primitive) -> float:
    """Return the largest number that distances from a primitive are computed from, beside coordinates, mm."""
    return found.radius if isinstance(found, Rotational) else 0.0


def _faces_along(mesh: Mesh, found: Primitive) -> bool:
    """Return whether the facets stand for the surface: all face its outside, or all its inside, and are fine enough.

    Facets about an apex are passed over: however small, they go far round the axis.
    """
    centres, areas = facets(mesh)
    cosine = dot(areas, normals(found, centres))
    if isinstance(found, Plane):
        return bool(np.all(cosine > 0.0))
    span, apex = _spans(mesh, found), _at_apex(mesh, found)
    turn = float(np.average(span, weights=norm(areas))) * np.cos(found.half_angle_rad)
    one_way = bool(np.all(cosine[~apex] > 0.0) or np.all(cosine[~apex] < 0.0))
    return one_way and bool(turn <= SMOOTH_RAD) and float(np.max(span[~apex], initial=0.0)) < WIDEST_RAD


def _spans(mesh: Mesh, found: Rotational) -> Values:
    """Return the largest angle round the axis between two corners of each facet, rad."""
    offset = mesh.vertices - found.point
    outward = unit(offset - (offset @ found.axis)[:, None] * found.axis)[mesh.faces]
    pairs = [(outward[:, i], outward[:, i - 1]) for i in range(3)]
    spans: Values = np.max([np.arctan2(norm(cross3(a, b)), dot(a, b)) for a, b in pairs], axis=0)
    return spans


def _at_apex(mesh: Mesh, found: Rotational) -> Mask:
    """Return the facets about the apex of a cone that has a vertex there."""
    apex = found.apex
    if apex is None:
        return np.zeros(len(mesh.faces), dtype=bool)
    slant = norm(mesh.vertices - apex)
    near = slant <= ABOUT_APEX * float(slant.max())
    about: Mask = near[mesh.faces].all(axis=1) & bool(slant.min() <= ON_APEX * slant.max())
    return about


def deviation_of(mesh: Mesh, off: Values, *, reach_mm: float = 0.0) -> Deviation:
    """Return what is to be said of the signed distances of the vertices from a surface.

    reach_mm: the largest number, beside coordinates, that they were computed from.
    """
    keeps = KEPT * (rounding(mesh.vertices) + EPS * (reach_mm + float(np.abs(mesh.vertices).max())))
    rms = float(np.sqrt(np.mean(off**2)))
    return Deviation(float(np.abs(off).max()), rms, keeps, _correlation(mesh, off))


FEWEST_EDGES = 100
"""Fewer say nothing of noise."""


def _correlation(mesh: Mesh, off: Values) -> float:
    """Return Moran's I of neighbouring vertices in its standard deviations; infinite where too few are neighbours."""
    start, end = half_edges(mesh.faces)
    if start.size < FEWEST_EDGES:
        return float("inf")
    about = off - off.mean()
    spread = float(np.mean(about**2))
    if spread == 0.0:
        return 0.0
    # every inner edge is met twice, from either side: the sum has half as many independent terms
    return float(np.mean(about[start] * about[end]) / spread * np.sqrt(start.size / 2.0))


def rounding(points: Points3) -> float:
    """Return how far a file may have rounded its coordinates, mm: by float32, by decimals, else by float64.

    The coordinates are looked at in millimetres and in the other units that files are written in.
    """
    largest = float(np.abs(points).max(initial=0.0))
    kept = [EPS / 2.0 * largest]
    for unit_mm in UNITS:
        values = points / unit_mm
        if bool(np.all(np.abs(values - values.astype(np.float32)) <= SAME * np.abs(values))):
            kept.append(unit_mm * float(np.spacing(np.float32(largest / unit_mm))) / 2.0)
        kept += [unit_mm * 10.0**-places / 2.0 for places in _decimals(values)]
    return max(kept)


SAME = 4.0 * EPS
"""Numbers that differ by less are the same but for the change of unit."""


def _decimals(values: Points3) -> list[int]:
    """Return the least number of decimals that all values have, if it is at most `FINEST_DECIMALS`."""
    for places in range(FINEST_DECIMALS + 1):
        scaled = values * 10.0**places
        if bool(np.all(np.abs(scaled - np.round(scaled)) <= SAME * np.abs(scaled))):
            return [places]
    return []
