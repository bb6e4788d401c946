"""Holes, marks, texts and notches of a blank of several faces: each through the flat map of the face it lies on.

A circle of the flat pattern, a cross and a text are drawn about their place, whatever bends they reach over.  A curve
that passes from face to face is made of the images of its pieces, which meet where the faces are joined; where the
blank is cut open between them they do not, and the curve is refused.  A drilled hole belongs to one face: of one that
reaches over a bend the cylinder would meet two surfaces, and it is refused.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from stages.geometry.arrays import Points2, norm
from stages.geometry.curves.plane import PlaneCurve
from stages.geometry.flat.mapped import FlatStrip, images
from stages.geometry.ruled.strip import Strip
from stages.model.features import CurveHole, DrilledHole
from stages.model.pattern import Contour, Mark
from stages.model.report import Finding
from stages.model.surface import BranchedSurface, Placed
from stages.model.tolerances import Tolerances
from stages.unroll.branches import Branch, hinge_line
from stages.unroll.features import Features, Flat, image, on_outline
from stages.unroll.onpart import on_part
from stages.unroll.trimmed import knots_of

AROUND = 257
"""Corners of the polygon for which a drilled hole is held against the bends: within 1e-4 of its radius."""


def on_branches(
    surface: BranchedSurface, made: Sequence[Branch], outer: Contour, holes: tuple[Contour, ...], tol: Tolerances
) -> Features:
    """Return the features of faces that lie in the plane, on the contours that these make together.

    Raises NoSolutionError where a curve is not resolved or its arcs do not keep the chord.
    """
    return on_outline(surface, outer, holes, lambda one: _image(surface, made, one, tol))


def left_of(rows: Sequence[tuple[Mark, ...]], features: Features) -> list[tuple[Mark, ...]]:
    """Return lines drawn on each face as far as notches and holes of the job leave them."""
    return [on_part(row, features.outer, features.inner) for row in rows]


def _image(surface: BranchedSurface, made: Sequence[Branch], one: Placed, tol: Tolerances) -> Flat | Finding:
    """Return a feature in the plane, or what forbids it."""
    if one.at is None:
        return _curve(made, one, tol)
    (k,) = one.faces
    sheet = made[k].sheet.surface
    found = image(one, _flat(made[k]), Strip(sheet.patches, knots_of(sheet)))
    if not isinstance(one.spec, DrilledHole):
        return found
    if isinstance(found, Finding) or _reaches_over(surface, made, found, k):
        message = (
            f"{one.name}: drilled in face {made[k].number} it would reach beyond the edges of that face: move it, or "
            'use kind = "circle", which is round in the flat pattern'
        )
        return Finding("hole-outside", message, fatal=True, where={"feature": one.name})
    return found


def _flat(branch: Branch) -> FlatStrip:
    return FlatStrip(branch.development.pieces, knots_of(branch.sheet.surface))


def _curve(made: Sequence[Branch], one: Placed, tol: Tolerances) -> Flat | Finding:
    """Return a curve over one or several faces; a finding where its pieces lie apart."""
    edges = [images(_flat(made[k]), (piece,)) for k, piece in zip(one.faces, one.curve, strict=True)]
    steps = list(pairwise(range(len(edges)))) + ([(len(edges) - 1, 0)] if isinstance(one.spec, CurveHole) else [])
    for i, j in steps:
        left = float(norm(_end(edges[i], 1.0) - _end(edges[j], 0.0))[0])
        if left > tol.join_mm:
            a, b = (made[one.faces[k]].number for k in (i, j))
            message = (
                f"{one.name} passes from face {a} to face {b} where the blank is cut open between them: in the flat "
                f"its pieces lie {left:.4g} mm apart; divide it there"
            )
            return Finding("feature-cut", message, fatal=True, where={"feature": one.name})
    return Flat(one, tuple(edge for row in edges for edge in row))


def _end(edges: Sequence[PlaneCurve], t: float) -> Points2:
    """Return the last point of edges for t = 1, their first for t = 0, shape (1, 2), mm."""
    return edges[-1 if t else 0].at(np.array([t]))


def _reaches_over(surface: BranchedSurface, made: Sequence[Branch], hole: Flat, k: int) -> bool:
    """Return whether a hole reaches over an edge at which its face goes over into another."""
    from shapely import LineString, Polygon

    t = np.linspace(0.0, 1.0, AROUND)
    around = Polygon(np.concatenate([edge.at(t) for edge in hole.edges]))
    hinges = [hinge for hinge in surface.hinges if k in (hinge.one, hinge.other)]
    return any(bool(LineString(hinge_line(surface, made, hinge)).intersects(around)) for hinge in hinges)
