"""Stitch holes along a seam: round holes, or slits that a pricking iron would make.

A hole lies off the sew line by a distance along its normal, at a fraction of the length of the sew line; two seams that
have the same fractions come to lie hole on hole when they are sewn, whatever their lengths.
"""

from dataclasses import dataclass, replace

import numpy as np

from stages.geometry.arrays import ArrayValue, Points2, Values
from stages.geometry.curves.parallel import normals
from stages.geometry.curves.plane import CircularArc
from stages.geometry.paths.arcpath import ArcPath
from stages.model.pattern import Contour, Mark
from stages.model.sewing import StitchSpec
from stages.unroll import outline
from stages.unroll.seams import Seams


@dataclass(frozen=True, slots=True, eq=False)
class Stitches(ArrayValue):
    """The holes of one seam: their name, how they are made, and where, as fractions of the seam, rising."""

    name: str
    seam: str
    spec: StitchSpec
    fractions: Values


@dataclass(frozen=True, slots=True)
class Pricked:
    """Round holes and slits."""

    holes: tuple[Contour, ...] = ()
    slits: tuple[Mark, ...] = ()


def pricked(known: Seams, row: Stitches, chord_mm: float) -> Pricked:
    """Return the holes of one seam."""
    points, right = placed(known, row)
    names = [f"{row.name}-{i}" for i in range(1, len(points) + 1)]
    if row.spec.diameter is not None:
        radius = float(row.spec.diameter) / 2.0
        circles = [CircularArc(point, radius, 0.0, -2.0 * np.pi) for point in points]
        made = [outline.contour((one,), chord_mm, name) for one, name in zip(circles, names, strict=True)]
        return Pricked(holes=tuple(replace(hole, purpose="stitch") for hole in made))
    angle = np.radians(float(row.spec.angle))
    ahead = np.stack([-right[:, 1], right[:, 0]], axis=1)
    half = float(row.spec.slit or 0) / 2.0 * (np.cos(angle) * ahead - np.sin(angle) * right)
    ends = np.stack([points - half, points + half], axis=1)
    slits = [ArcPath(line, np.zeros(2), closed=False) for line in ends]
    return Pricked(slits=tuple(Mark(name, path, "CUT_SLIT") for name, path in zip(names, slits, strict=True)))


def placed(known: Seams, row: Stitches) -> tuple[Points2, Points2]:
    """Return the places of the holes, and the unit normals out of the part there."""
    line = known.lines[row.seam]
    margin = float(row.spec.margin)
    away = line.spec.allowance_mm - margin if row.spec.line == "cut" else -margin
    numbers, t = line.places(row.fractions)
    points, right = np.zeros((t.size, 2)), np.zeros((t.size, 2))
    for number in np.unique(numbers):
        here = numbers == number
        edge = known.outline[number]
        points[here], right[here] = edge.at(t[here]), normals(edge, t[here])
    return points + away * right, right
