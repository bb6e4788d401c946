"""The flat map of least strain of a ruled strip that is nearly developable.

Minimised is the integral over the surface of (s1 - 1)^2 + (s2 - 1)^2, s1 and s2 the principal stretches, over all
continuous maps onto the plane (`strainenergy`).  The map along the rulings is the start and stays the base: only the
displacement from it is approximated, by spectral elements (`elements`), so that an exactly developable surface keeps
its exact map and a warped one loses digits of its strain alone.  Newton's method with the exact second derivatives
takes 3 to 6 steps; a step that does not lower the energy is halved, and where the energy is not convex the convex part
of its second derivative stands in.

Degrees are raised, then elements halved, until no position moves by more than `accuracy` of the size.  At a corner of
the pattern the displacement is singular (like r^2.74 at a right angle), so that it converges like a power of the
degree: with 10 deg of warp on a square 7e-8 of the size at degree 12 and 5e-9 at 20, with 1 deg a hundredth of that.
At a corner that points into the pattern the strain itself grows without bound: positions converge there, the largest
strain does not, and `strain_change` says so.

What it cannot do: a minimum, not proved to be the only one; no folding or wrinkling out of the plane; material with
grain or with a Poisson ratio.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from stages.errors import NoSolutionError
from stages.geometry.arrays import Array
from stages.geometry.flat import strainenergy
from stages.geometry.flat.development import RulingMap
from stages.geometry.flat.flatmap import Development
from stages.geometry.flat.minimise import minimised
from stages.geometry.flat.refinement import change
from stages.geometry.flat.relaxedmap import RelaxedMap
from stages.geometry.flat.subdivision import Strip, divided, halved
from stages.geometry.numeric.bordered import spread
from stages.geometry.numeric.elements import Degrees, coefficients, node_places
from stages.geometry.numeric.numbering import HELD, number
from stages.geometry.ruled.ruled import RuledPatch


@dataclass(frozen=True, slots=True)
class Relaxed:
    """A flat map of least strain, and how good it is.

    reached: the largest change of a position in the last refinement, as a share of the size.
    strain_change: the largest change of a principal strain in it.
    energy, energy_along_rulings: half the integral of (s1 - 1)^2 + (s2 - 1)^2 of this map and of the start, mm2.
    """

    development: Development
    reached: float
    strain_change: float
    energy: float
    energy_along_rulings: float


def relaxed(patches: tuple[RuledPatch, ...], *, accuracy: float) -> Relaxed:
    """Return the flat map of least strain; positions within `accuracy` of the size, as told by refinement.

    Raises NoSolutionError where refinement does not get there, or where the rulings cannot be unrolled to begin with.
    """
    strip = divided(patches)
    made = _minimum(strip, LEVELS[0], (), still=STILL * accuracy)
    last = None
    for level in LEVELS[1:]:
        before, made = made, _minimum(strip, level, made.pieces, still=STILL * accuracy)
        previous, last = last, change(before.pieces, made.pieces)
        reached = last.moved_mm / strip.size
        if reached <= accuracy and (last.settled(previous) or level is LEVELS[-1]):
            return Relaxed(Development(made.pieces), reached, last.strain, made.energy, made.energy_along_rulings)
    raise NoSolutionError("flattening by least strain", reached=reached, wanted=accuracy, unit="of the size")


STILL = 1e-3
"""Newton's last step is so small a share of what refinement may still change; the error after it is its square."""


@dataclass(frozen=True, slots=True)
class Level:
    """How fine the elements are: their degrees, and how often the coarsest ones are halved."""

    degrees: Degrees
    halvings: int


LEVELS = tuple(
    Level(Degrees(u, v), halvings)
    for u, v, halvings in (
        (6, 8, 0), (8, 10, 0), (10, 12, 0), (12, 14, 0), (14, 14, 1), (16, 14, 1), (20, 14, 2), (24, 14, 2),
    )
)  # fmt: skip
"""Across the rulings the degree stays below the 20 nodes at which panels are measured, and elements are halved instead;
along them it must go on, since corners converge by it."""


@dataclass(frozen=True, slots=True)
class _Minimum:
    pieces: tuple[RelaxedMap, ...]
    energy: float
    energy_along_rulings: float


def _minimum(strip: Strip, level: Level, before: tuple[RelaxedMap, ...], *, still: float) -> _Minimum:
    """Return the map of least energy among the polynomials of one level, sought from the level before."""
    breaks = tuple(halved(ends, level.halvings) for ends in strip.breaks)
    pairs = list(zip(strip.bases, breaks, strict=True))
    sheet = strainenergy.joined([strainenergy.sheet(base, ends, level.degrees) for base, ends in pairs])
    numbering = number(strip.shape(breaks), level.degrees, _at_nodes(strip.bases, breaks, level.degrees))
    start = np.zeros(numbering.count)
    if before:
        free = numbering.unknowns != HELD
        start[numbering.unknowns[free]] = _displaced(before, breaks, level.degrees)[free]
    values = minimised(sheet, numbering, start, still=still * strip.size)
    nodes = spread(values, numbering)
    zero = strainenergy.stretched(sheet, np.zeros_like(nodes))
    energies = (strainenergy.energy(sheet, at) for at in (strainenergy.stretched(sheet, nodes), zero))
    return _Minimum(_pieces(pairs, nodes, level.degrees), *energies)


def _pieces(pairs: list[tuple[RulingMap, Array]], nodes: Array, degrees: Degrees) -> tuple[RelaxedMap, ...]:
    """Return the maps from displacements at the nodes of all elements, shape (m, nodes, 2)."""
    series = coefficients(nodes.reshape(-1, degrees.v + 1, degrees.u + 1, 2), degrees)
    ends = np.cumsum([0, *(breaks.size - 1 for _, breaks in pairs)])
    return tuple(
        RelaxedMap(base, breaks, series[low:high])
        for (base, breaks), (low, high) in zip(pairs, pairwise(ends), strict=True)
    )


def _at_nodes(bases: tuple[RulingMap, ...], breaks: tuple[Array, ...], degrees: Degrees) -> Array:
    """Return the positions along the rulings of all nodes by columns, shape (columns, nu + 1, 2), mm."""
    rows: list[Array] = []
    for base, ends in zip(bases, breaks, strict=True):
        columns, u = node_places(ends, degrees)
        v = np.append(columns[:, :-1].ravel(), 1.0)
        every = base.positions(np.tile(u, v.size), np.repeat(v, u.size)).reshape(v.size, u.size, 2)
        rows.append(every if base is bases[-1] else every[:-1])
    return np.concatenate(rows)


def _displaced(pieces: tuple[RelaxedMap, ...], breaks: tuple[Array, ...], degrees: Degrees) -> Array:
    """Return the displacements at the nodes of all elements, shape (m, nodes, 2), mm."""
    found: list[Array] = []
    for piece, ends in zip(pieces, breaks, strict=True):
        columns, u = node_places(ends, degrees)
        v = columns.ravel()
        moved = piece.displacement(np.tile(u, v.size), np.repeat(v, u.size))
        found.append(moved.reshape(len(columns), -1, 2))
    return np.concatenate(found)
