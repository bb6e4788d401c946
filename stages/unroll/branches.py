"""The faces of a branched surface laid flat: each along its rulings, then against its neighbour along their hinge.

Every face has a neutral surface of its own, with the K of its own smallest radius.  Along a hinge the normals of both
faces agree, so that parallel surfaces at any two distances have it at the same length: the flat faces still meet.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Points2, Values, norm
from stages.geometry.curves.plane import PlaneCurve
from stages.geometry.flat.development import develop
from stages.geometry.flat.flatmap import Development
from stages.geometry.flat.mapped import FlatStrip, MappedEdge, backwards
from stages.geometry.flat.placing import moved, onto
from stages.geometry.ruled.ruled import RuledPatch, curvature
from stages.model.surface import BranchedSurface, Hinge, RuledSurface, Trim
from stages.model.tolerances import Tolerances
from stages.unroll.bent import SLIGHT
from stages.unroll.distortion import Distortion, measure
from stages.unroll.spliced import Ring, spliced
from stages.unroll.thickness import Neutral
from stages.unroll.trimmed import FlatLoop, flat_loops, knots_of

ENDS = np.array([0.0, 1.0])
Key = tuple[int, int, int]
"""Of an edge: face, loop, and curve in it."""


@dataclass(frozen=True, slots=True)
class Branch:
    """One face: its number in the file, its neutral surface, its place in the plane, and what was measured there."""

    number: int
    sheet: Neutral
    development: Development
    found: Distortion
    outer: FlatLoop
    inner: tuple[FlatLoop, ...]


def branches(surface: BranchedSurface, sheets: Sequence[Neutral], tol: Tolerances) -> tuple[Branch, ...]:
    """Return the faces where they lie in the plane, the first one in its own flat frame.

    Raises NoSolutionError where a quadrature does not resolve.
    """
    flat: list[Development] = []
    for k, sheet in enumerate(sheets):
        own = develop(sheet.surface.patches)
        if k:
            hinge = surface.hinges[k - 1]
            curves = (curve_of(surface.faces[i], e) for i, e in ((hinge.one, hinge.of_one), (k, hinge.of_other)))
            target, mine = (
                flat_edge(sheets[i], curve, development, ENDS)
                for i, curve, development in zip((hinge.one, k), curves, (flat[hinge.one], own), strict=True)
            )
            own = moved(own, onto(mine[::-1], target))
        flat.append(own)
    return tuple(
        _branch(number, sheet, face, development, tol)
        for number, sheet, face, development in zip(surface.numbers, sheets, surface.faces, flat, strict=True)
    )


def _branch(number: int, sheet: Neutral, face: RuledSurface, development: Development, tol: Tolerances) -> Branch:
    outer, *inner = flat_loops(sheet, development, _trim(face))
    return Branch(number, sheet, development, measure(sheet.surface, development, tol), outer, tuple(inner))


def curve_of(face: RuledSurface, edge: tuple[int, int]) -> PlaneCurve:
    """Return the curve of u and v of an edge."""
    loop, place = edge
    return _curves(face)[loop][place]


def _trim(face: RuledSurface) -> Trim:
    if face.trim is None:
        raise ValueError("a face of a branched surface has no trim")
    return face.trim


def _curves(face: RuledSurface) -> tuple[tuple[PlaneCurve, ...], ...]:
    """Return the loops of a face in u and v, the outer one first."""
    return (_trim(face).outer, *_trim(face).inner)


def flat_edge(sheet: Neutral, curve: PlaneCurve, development: Development, t: Values) -> Points2:
    """Return points of an edge of a face in the plane, mm; curve: of u and v."""
    return FlatStrip(development.pieces, knots_of(sheet.surface)).positions(*curve.at(t).T)


def hinge_line(surface: BranchedSurface, made: Sequence[Branch], hinge: Hinge, t: Values = ENDS) -> Points2:
    """Return points of a hinge, at t along the edge of its first face, in the plane, mm."""
    side = made[hinge.one]
    return flat_edge(side.sheet, curve_of(surface.faces[hinge.one], hinge.of_one), side.development, t)


def hinge_gap(surface: BranchedSurface, made: Sequence[Branch], hinge: Hinge) -> float:
    """Return how far the flat faces of a hinge lie apart along it at most, mm: at its ends, middle and quarters.

    It is straight on both, so that the ends would do: the rest tells of a face that is not where it should be.
    """
    t, side = np.linspace(0.0, 1.0, 5), made[hinge.other]
    there = flat_edge(side.sheet, curve_of(surface.faces[hinge.other], hinge.of_other), side.development, 1.0 - t)
    return float(norm(hinge_line(surface, made, hinge, t) - there).max())


# The contours


def contours_of(surface: BranchedSurface, made: Sequence[Branch]) -> list[tuple[MappedEdge, ...]]:
    """Return the contours of the blank: those of its faces without the edges at the hinges."""
    rings = [ring for k in range(len(made)) for ring in _rings(surface.faces[k], made[k], k)]
    return spliced(rings, [((h.one, *h.of_one), (h.other, *h.of_other)) for h in surface.hinges])


def _rings(face: RuledSurface, branch: Branch, k: int) -> list[Ring[Key, MappedEdge]]:
    """Return the loops of a face with the face on their left."""
    runs = [branch.outer.edges, *(backwards(hole.edges) for hole in branch.inner)]
    rings = []
    for j, (curves, edges) in enumerate(zip(_curves(face), runs, strict=True)):
        place = {id(curve): i for i, curve in enumerate(curves)}
        rings.append(Ring(tuple((k, j, place[id(edge.curve)]) for edge in edges), tuple(edges)))
    return rings


# Where it bends


def hinge_bend(surface: BranchedSurface, hinge: Hinge) -> float:
    """Return the curvature at a hinge on its more curved side, 1/mm, positive towards N; 0 where it does not jump."""
    sides = ((hinge.one, hinge.of_one), (hinge.other, hinge.of_other))
    here = [_curvature(surface.faces[face], edge) for face, edge in sides]
    if abs(here[1] - here[0]) * surface.size_mm <= SLIGHT:
        return 0.0
    return max(here, key=abs)


def _curvature(face: RuledSurface, edge: tuple[int, int]) -> float:
    """Return the curvature across a hinge in its middle; 0 on a plane, whose hinges need be no rulings."""
    ((u, v),) = curve_of(face, edge).at(np.array([0.5]))
    piece, local = face.place_of(float(v))
    return _finite(face.patches[piece], local, float(u))


def _finite(patch: RuledPatch, v: float, u: float) -> float:
    value = float(curvature(patch, np.array([v]), u)[0])
    return value if np.isfinite(value) else 0.0


def turned_rad(branch: Branch) -> float:
    """Return the angle through which a face bends, rad, positive towards N."""
    return float(sum(stretch.angle_rad for stretch in branch.sheet.bent.bends.stretches))
