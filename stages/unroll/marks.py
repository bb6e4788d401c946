"""Rulings as lines to be etched, at equal turning of the surface's normal.

Between two lines the part bends by the same angle; equal spacing would do so on right cones and cylinders only.  The
turning is summed over 1024 chords of the normal per piece: exact enough for a place to etch (1e-6 of the part).
"""

import math

import numpy as np

from stages.geometry.arcpath import ArcPath
from stages.geometry.arrays import Values, dot, norm, unit
from stages.geometry.flatmap import Development
from stages.geometry.ruled import RuledPatch, end_normals, frames
from stages.model.part import MarkSpec
from stages.model.pattern import Mark

CHORDS = 1024


def ruling_marks(development: Development, spec: MarkSpec) -> tuple[Mark, ...]:
    """Return the marked rulings, edge to edge, in the flat frame."""
    v, turned = turning(tuple(piece.patch for piece in development.pieces))
    total = float(turned[-1])
    steps = spec.count + 1 if spec.count is not None else _steps(total, spec)
    if total <= FLAT:
        turned = v - v[0]
    shares = np.arange(1, steps) / steps * turned[-1]
    return tuple(
        _mark(development, f"{spec.name}-{i + 1}", place) for i, place in enumerate(np.interp(shares, turned, v))
    )


def _steps(total: float, spec: MarkSpec) -> int:
    """Return into how many equal turns the total is divided so that none exceeds `max_angle`."""
    return max(math.ceil(total / math.radians(float(spec.max_angle or 1)) * (1.0 - SUMMED)), 1)


SUMMED = 1e-9
"""What the sum of the turns may be over a whole number of angles by rounding alone, as a share."""
FLAT = 1e-9
"""A part whose normal turns by less, in rad, is flat: its lines are spaced by the parameter."""


def turning(patches: tuple[RuledPatch, ...]) -> tuple[Values, Values]:
    """Return v over all pieces and the angle in rad that the normal has turned by up to there, folds included."""
    places, normals = [], []
    for i, patch in enumerate(patches):
        v = np.linspace(0.0, 1.0, CHORDS + 1)
        n0, n1 = end_normals(frames(patch, v))
        normal = unit(n0 + n1)
        shown = norm(normal) > 0.0
        places.append(i + v[shown])
        normals.append(normal[shown])
    v, normal = np.concatenate(places), np.concatenate(normals)
    steps = np.arctan2(norm(np.cross(normal[:-1], normal[1:])), dot(normal[:-1], normal[1:]))
    return v, np.concatenate([[0.0], np.cumsum(steps)])


def _mark(development: Development, name: str, place: float) -> Mark:
    index = min(int(place), len(development.pieces) - 1)
    ends = development.pieces[index].positions(np.array([0.0, 1.0]), np.full(2, place - index))
    return Mark(name, ArcPath(ends, np.zeros(2), closed=False))
