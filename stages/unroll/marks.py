"""The lines of marks: rulings as lines to be etched, at equal turning of the surface's normal.

Between two lines the part bends by the same angle; equal spacing would do so on right cones and cylinders only.  On a
part flattened by least strain the rulings are slightly curved, and so are their lines.
"""

from collections.abc import Sequence

import numpy as np

from stages.geometry.arrays import norm
from stages.geometry.curves.plane import PlaneCurve
from stages.geometry.flat.flatmap import DevelopedRuling, Development
from stages.geometry.paths import biarc
from stages.geometry.paths.allowance import is_point
from stages.geometry.paths.arcpath import ArcPath
from stages.geometry.ruled.turning import equal_turns, turning, turning_places
from stages.model.features import RulingMarks
from stages.model.pattern import Mark


def ruling_marks(development: Development, spec: RulingMarks, *, chord_mm: float) -> tuple[Mark, ...]:
    """Return the marked rulings, edge to edge, in the flat frame, within `chord_mm`.

    Raises NoSolutionError where the turning of the normal does not resolve.
    """
    bends = turning(tuple(piece.patch for piece in development.pieces))
    steps = spec.count + 1 if spec.count is not None else equal_turns(bends.total_rad, float(spec.max_angle or 1))
    found = turning_places(bends, len(development.pieces), steps)
    return tuple(
        Mark(f"{spec.name}-{i}", _line(development, float(place), chord_mm)) for i, place in enumerate(found, 1)
    )


def _line(development: Development, place: float, chord_mm: float) -> ArcPath:
    """Return the flat ruling at a place counted over the pieces."""
    index = min(int(place), len(development.pieces) - 1)
    ruling = DevelopedRuling(development.pieces[index], place - index)
    if not ruling.is_straight():
        return biarc.fit(ruling, accuracy=chord_mm)
    return ArcPath(ruling.at(np.array([0.0, 1.0])), np.zeros(2), closed=False)


def traced(edges: Sequence[PlaneCurve], chord_mm: float) -> ArcPath:
    """Return the path of a curve: closed if it ends where it begins.  Edges that are points are left out."""
    first, last = edges[0].at(np.array([0.0]))[0], edges[-1].at(np.array([1.0]))[0]
    if norm(first - last) <= biarc.ZERO_LENGTH_MM:
        return biarc.trace(edges, accuracy=chord_mm)
    parts = [biarc.fit(edge, accuracy=chord_mm) for edge in edges if not is_point(edge)]
    vertices = np.concatenate([*(part.vertices[:-1] for part in parts), parts[-1].vertices[-1:]])
    return ArcPath(vertices, np.append(np.concatenate([part.bulges[:-1] for part in parts]), 0.0), closed=False)
