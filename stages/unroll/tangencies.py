"""Bend lines where a flat face goes over into a bent one: the edges of a bend, as a press brake is set by.

Only where the curvature across the ruling jumps; the line says which way the bent side of it bends, seen in the flat
frame, from the side of N = p x c0'.
"""

import numpy as np

from stages.geometry.flat.flatmap import Development
from stages.geometry.paths.arcpath import ArcPath
from stages.geometry.ruled.ruled import RuledPatch, curvature
from stages.model.pattern import Mark
from stages.model.surface import RuledSurface
from stages.unroll.bent import SLIGHT
from stages.unroll.forming import flat_rulings


def tangency_marks(surface: RuledSurface, development: Development) -> tuple[Mark, ...]:
    """Return the rulings at which faces go over into each other with a jump of curvature, as bend lines."""
    found = [(v, _bend(surface, v)) for v in surface.tangencies]
    places = [(v, bend) for v, bend in found if bend != 0.0]
    lines = flat_rulings(surface, development, [v for v, _ in places])
    return tuple(
        Mark(f"tangency-{i}", ArcPath(ends, np.zeros(2), closed=False), "BEND_UP" if bend > 0.0 else "BEND_DOWN")
        for i, ((_, bend), ends) in enumerate(zip(places, lines, strict=True), 1)
    )


def _bend(surface: RuledSurface, v: float) -> float:
    """Return the curvature on the more curved side of a ruling, 1/mm; 0 where it does not jump."""
    after = next(i for i, (low, _) in enumerate(surface.spans) if float(low) == v)
    here = [_curvature(surface.patches[i], end) for i, end in ((after - 1, 1.0), (after, 0.0))]
    if abs(here[1] - here[0]) * surface.size_mm <= SLIGHT:
        return 0.0
    return max(here, key=abs)


def _curvature(patch: RuledPatch, end: float) -> float:
    return float(curvature(patch, np.array([end]), 0.5)[0])
