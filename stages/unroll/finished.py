"""A pattern from its contours: what is the same for strips, plates and meshes."""

from typing import Literal

import numpy as np

from stages.geometry.arrays import Points2
from stages.geometry.paths.arcpath import bounds
from stages.model.material import Part
from stages.model.pattern import Contour, FlatPattern
from stages.model.scalars import Angle
from stages.model.tolerances import Tolerances
from stages.unroll import outline
from stages.unroll.features import Features


def finished(part: Part, made: Features, corners: Points2, tol: Tolerances) -> FlatPattern:
    """Return the pattern of a part in its flat frame; corners: c0(0), c1(0), c1(1), c0(1), mm."""
    return FlatPattern(
        part=part.spec.name,
        quantity=part.spec.quantity,
        outer=made.outer,
        inner=made.inner,
        marks=made.marks,
        texts=made.texts,
        label_at=outline.label_place(made.outer.path, tuple(hole.path for hole in made.inner), tol.chord_mm),
        corners=corners,
        rotations=_rotations(part.spec.rotations),
        thickness_mm=part.material.thickness_mm,
        density_kg_m3=part.material.density_kg_m3,
        quality=part.spec.quality,
        axis_deg=part.spec.axis_deg,
        axis_band_deg=float(part.spec.grain_band),
        pair=part.spec.pair,
        notches=made.notches,
        boundary=made.boundary,
    )


def _rotations(asked: Literal["free"] | tuple[Angle, ...] | None) -> tuple[float, ...] | Literal["free"] | None:
    """Return a part's own rotations in degrees; None: what the nest allows."""
    return tuple(float(angle) for angle in asked) if isinstance(asked, tuple) else asked


def flat_figures(
    made: Features, corners: Points2, *, area: float, length: float, edges: dict[str, float] | None = None
) -> dict[str, object]:
    """Return what the report says of a flat pattern: area in mm2, lengths in mm, marks and holes.

    edges: the lengths of the edges of a strip, by name; those of other parts have no names.
    """
    low_x, low_y, high_x, high_y = bounds(made.outer.path)
    return {
        "area": area,
        "outline_length": length,
        "width": high_x - low_x,
        "height": high_y - low_y,
        "corners": corners.tolist(),
        "edges": edges,
        "marks": made.mark_rows,
        "holes": made.hole_rows,
    }


def box(outer: Contour) -> Points2:
    """Return the corners of the box round a contour, counter-clockwise from the least, mm."""
    low_x, low_y, high_x, high_y = bounds(outer.path)
    return np.array([[low_x, low_y], [high_x, low_y], [high_x, high_y], [low_x, high_y]])
