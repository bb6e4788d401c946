"""What a flavour makes of the paths of a pattern and of a drawing, before they are written.

`polylines` knows no arcs: contours are traced again from their exact edges, by the fewest chords within the tolerance
of the part.  Contours that must not lie inside the exact ones are traced again too.  Whoever nests or measures must
have these, not the first ones (`as_cut`).  What is not cut follows its arcs.

`lines-arcs`: lines alone on CUT_OUTER are common lines, so what is left of an outline is never one line; a contour of
two arcs is cut into four, since neither of two tells which way it runs; and arcs of a radius that doubles no longer
place well are lines.
"""

from dataclasses import replace

import numpy as np

from stages.geometry.arrays import norm
from stages.geometry.paths.arcpath import ArcPath, piece_count, polygon, radii, split
from stages.geometry.paths.biarc import traced
from stages.geometry.paths.inscribed import chorded, inscribed
from stages.geometry.paths.outside import outside
from stages.model.cutfile import Machine
from stages.model.pattern import Contour, FlatPattern
from stages.write.tracing import as_pattern

STOCK_CHORD_MM = 0.02
"""How far the chords of what is not part of a pattern, the stock, may be off its arcs: nothing is cut along them."""

LARGEST_RADIUS_MM = 1e9
"""A chord of 100 mm is 1.3e-6 mm from such an arc; the ends of the arc are already 4e-7 mm off by rounding."""

CLOSES_MM = 1e-9
"""An open path with its ends as near as this is closed where pieces say no more than where they lie."""

HALF = 0.6
"""Share of the larger of two bulges that makes `split` halve both arcs or the larger one."""


def as_cut(pattern: FlatPattern, machine: Machine) -> FlatPattern:
    """Return the pattern with the contours and marks that a machine wants and its flavour can hold."""
    if machine.flavour == "aama":
        return as_pattern(pattern)
    straight_only = machine.flavour == "polylines"
    if not straight_only and machine.side == "either":
        return pattern
    made = _grown if machine.side == "outside" else _straight
    chord = pattern.outer.chord_mm
    return pattern.replace(
        outer=made(pattern.outer, machine),
        inner=tuple(made(contour, machine) for contour in pattern.inner),
        marks=tuple(replace(mark, path=straight(mark.path, chord)) for mark in pattern.marks)
        if straight_only
        else pattern.marks,
    )


def _straight(contour: Contour, _: Machine) -> Contour:
    """Return the contour with a path of chords; one that has no arcs stays as it is."""
    if not contour.path.bulges.any():
        return contour
    return replace(contour, path=inscribed(contour.edges, accuracy=contour.chord_mm))


def _grown(contour: Contour, machine: Machine) -> Contour:
    """Return the contour with a path that lies beside its edges, never within; one that does stays as it is."""
    arcs = machine.flavour != "polylines"
    if contour.side == "outside" and (arcs or not contour.path.bulges.any()):
        return contour
    path = outside(contour.edges, traced if arcs else chorded, accuracy=contour.chord_mm)
    return replace(contour, path=path, side="outside")


def straight(path: ArcPath, accuracy: float) -> ArcPath:
    """Return chords of a path, within `accuracy` mm."""
    if not path.bulges.any():
        return path
    points = polygon(path, accuracy=accuracy)
    return ArcPath(points, np.zeros(points.shape[0]), path.closed)


def as_written(path: ArcPath, machine: Machine, *, outline: bool) -> ArcPath:
    """Return a path as the flavour writes it; outline: whether it is a contour, or what is left of one."""
    if machine.flavour == "polylines":
        return straight(path, STOCK_CHORD_MM)
    return _in_pieces(path, outline=outline) if machine.flavour == "lines-arcs" else path


def _in_pieces(path: ArcPath, *, outline: bool) -> ArcPath:
    """Return a path that can be told from its pieces alone."""
    count = piece_count(path)
    flat = radii(path) > LARGEST_RADIUS_MM
    bulges = path.bulges.copy()
    bulges[:count][flat] = 0.0
    path = ArcPath(path.vertices, bulges, path.closed)
    if not path.closed and count > 1 and norm(path.vertices[-1] - path.vertices[0]) <= CLOSES_MM:
        path = ArcPath(path.vertices[:-1], path.bulges[:-1], closed=True)
    if outline and count == 1 and path.bulges[0] == 0.0:
        start, end = path.vertices
        return ArcPath(np.stack([start, (start + end) / 2.0, end]), np.zeros(3), closed=False)
    if path.closed and piece_count(path) == 2 and path.bulges.all():  # noqa: PLR2004  the fewest that close
        return split(path, max_bulge=HALF * float(np.abs(path.bulges).max()))
    return path
