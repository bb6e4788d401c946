"""What a flavour makes of the paths of a pattern and of a drawing, before they are written.

`polylines` knows no arcs: contours are traced again from their exact edges, by the fewest chords within the tolerance
of the part; whoever nests or measures must have these, not the arcs (`as_cut`).  What is not cut follows its arcs.

`lines-arcs`: lines alone on CUT_OUTER are common lines, so what is left of an outline is never one line; a contour of
two arcs is cut into four, since neither of two tells which way it runs; and arcs of a radius that doubles no longer
place well are lines.
"""

import numpy as np

from stages.geometry.arcpath import ArcPath, piece_count, polygon, radii, split
from stages.geometry.arrays import norm
from stages.geometry.inscribed import inscribed
from stages.model.cutfile import Machine
from stages.model.pattern import Contour, FlatPattern, Mark

STOCK_CHORD_MM = 0.02
"""How far the chords of what is not part of a pattern, the stock, may be off its arcs: nothing is cut along them."""

LARGEST_RADIUS_MM = 1e9
"""A chord of 100 mm is 1.3e-6 mm from such an arc; the ends of the arc are already 4e-7 mm off by rounding."""

CLOSES_MM = 1e-9
"""An open path with its ends as near as this is closed where pieces say no more than where they lie."""

HALF = 0.6
"""Share of the larger of two bulges that makes `split` halve both arcs or the larger one."""


def as_cut(pattern: FlatPattern, machine: Machine) -> FlatPattern:
    """Return the pattern with the contours and marks that a machine's flavour can hold."""
    if machine.flavour != "polylines":
        return pattern
    chord = pattern.outer.chord_mm
    return pattern.replace(
        outer=_straight(pattern.outer),
        inner=tuple(map(_straight, pattern.inner)),
        marks=tuple(Mark(mark.name, straight(mark.path, chord), mark.layer) for mark in pattern.marks),
    )


def _straight(contour: Contour) -> Contour:
    """Return the contour with a path of chords; one that has no arcs stays as it is."""
    if not contour.path.bulges.any():
        return contour
    path = inscribed(contour.edges, accuracy=contour.chord_mm)
    return Contour(contour.edges, path, contour.chord_mm, contour.name)


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
