"""How far the flat map of a mesh is from an isometry, measured on its positions.

Lengths of the boundary against cubic splines through the same vertices in space, areas and angles against those of the
triangles on the fitted surface, strains triangle by triangle; extremes with their places, and the field on a grid.
"""

from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Array, Numbers, Points2, Values, cross2, norm
from stages.geometry.curves.refit import Refitted
from stages.geometry.mesh.arap import Sheet, energy, strain_tensors, strains
from stages.geometry.mesh.flat import by_side, resting
from stages.geometry.mesh.meshmap import MeshMap
from stages.geometry.mesh.topology import edges_of
from stages.model.report import Metric, Where
from stages.model.surface import MeshSurface


@dataclass(frozen=True, slots=True, eq=False)
class Loops:
    """The boundary loops in the plane, the outer first: numbers of their vertices, and smooth edges through them."""

    vertices: tuple[Numbers, ...]
    fitted: tuple[Refitted, ...]


def distortion(surface: MeshSurface, flat: MeshMap, loops: Loops) -> tuple[Metric, ...]:
    """Return how far the map is from an isometry, by names that are those of every part."""
    rest = resting(surface.mesh, edges_of(surface.mesh), flat.lengths)
    principal, at_rest = strains(rest, flat.positions), areas(sides(surface, flat))
    worst = int(np.argmax(np.abs(principal).max(axis=1)))
    longest, shortest = int(np.argmax(principal[:, 0])), int(np.argmin(principal[:, 1]))
    square = np.abs((1.0 + principal) ** 2 - 1.0).max()
    rms = float(np.sqrt(at_rest @ (principal**2).mean(axis=1) / at_rest.sum()))
    return (
        _length_error(surface, flat, loops),
        Metric("area_error", _area_error(surface, flat, at_rest)),
        Metric("angle_error_deg", _angle_error(surface, flat, loops), "deg"),
        Metric("metric_error", float(square)),
        Metric("max_strain", float(np.abs(principal[worst]).max()), where=_where(surface, flat, worst)),
        Metric("max_extension", float(max(principal.max(), 0.0)), where=_where(surface, flat, longest)),
        Metric("max_compression", float(max(-principal.min(), 0.0)), where=_where(surface, flat, shortest)),
        Metric("strain_rms", rms),
        Metric("flattening_reached_mm", flat.reached_mm, "mm"),
        Metric("strain_energy_mm2", energy(rest, flat.positions), "mm2"),
    )


def _where(surface: MeshSurface, flat: MeshMap, face: int) -> Where:
    """Return the middle of a triangle in space (x, y, z) and in the pattern, mm."""
    corners = surface.mesh.faces[face]
    in_space, in_plane = surface.mesh.vertices[corners].mean(axis=0), flat.positions[corners].mean(axis=0)
    names = ("x", "y", "z", "flat_x", "flat_y")
    return dict(zip(names, map(float, (*in_space, *in_plane)), strict=True))


def strain_field(surface: MeshSurface, flat: MeshMap) -> dict[str, object]:
    """Return the strains on a grid in the pattern: the mean over the triangles of each square, at their middle.

    most, least: principal strains.  direction_deg: in which it is stretched most, from +x, in (-90, 90].
    """
    rest = resting(surface.mesh, edges_of(surface.mesh), flat.lengths)
    middles = flat.positions[surface.mesh.faces].mean(axis=1)
    square = _squares(middles)
    weight = np.column_stack([rest.area, rest.area[:, None] * middles, _weighed(rest.area, flat, rest)])
    total = np.stack([np.bincount(square, column) for column in weight.T], axis=1)
    x, y, xx, xy, yy = (total[:, 1:] / total[:, :1]).T
    mean, away = (xx + yy) / 2.0, np.hypot((xx - yy) / 2.0, xy)
    turned = np.degrees(np.arctan2(2.0 * xy, xx - yy)) / 2.0
    columns = {"x": x, "y": y, "most": mean + away, "least": mean - away, "direction_deg": turned}
    return {name: column.tolist() for name, column in columns.items()}


def _weighed(area: Values, flat: MeshMap, rest: Sheet) -> Array:
    return np.asarray(area[:, None] * strain_tensors(rest, flat.positions))


def _squares(places: Points2) -> Numbers:
    """Return the square that each place lies in, numbered without gaps; `PLACES` squares at most."""
    low, extent = places.min(axis=0), np.ptp(places, axis=0)
    pitch = max(float(np.sqrt(extent.prod() / (PLACES / 2.0))), float(extent.max()) / (PLACES / 4.0))
    column, row = np.floor((places - low) / pitch).astype(np.int64).T
    _, square = np.unique(row * PLACES + column, return_inverse=True)
    return np.asarray(square)


PLACES = 1800
"""Of the field, at most: half of them by the area of its box, the rest for the rim of a long one."""


def sides(surface: MeshSurface, flat: MeshMap) -> Array:
    """Return the lengths of the sides of every triangle on the surface, shape (m, 3)."""
    return by_side(edges_of(surface.mesh), flat.lengths)


def areas(lengths: Array) -> Values:
    """Return the areas of triangles from their sides (W. Kahan's order of Heron's formula), mm2."""
    c, b, a = np.sort(lengths, axis=1).T
    product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c))
    return np.asarray(np.sqrt(np.maximum(product, 0.0)) / 4.0)


def _area_error(surface: MeshSurface, flat: MeshMap, at_rest: Values) -> float:
    """Return the relative difference of the area inside the boundary polygons and that of all triangles at rest."""
    inside = sum(_polygon_area(flat.positions[loop]) for loop in surface.loops)
    return abs(inside / float(at_rest.sum()) - 1.0)


def _polygon_area(points: Points2) -> float:
    about = points - points[0]
    return float(cross2(about, np.roll(about, -1, axis=0)).sum() / 2.0)


def _length_error(surface: MeshSurface, flat: MeshMap, loops: Loops) -> Metric:
    """Return the largest relative difference of the length of a boundary edge, flat against in space."""
    worst, where = 0.0, ""
    for number, (loop, fitted) in enumerate(zip(loops.vertices, loops.fitted, strict=True)):
        for run in runs(loop, fitted):
            if not _along_mesh(surface, run):
                continue
            in_space, in_plane = (_length(points[run]) for points in (surface.mesh.vertices, flat.positions))
            if abs(in_plane / in_space - 1.0) >= worst:
                worst, where = abs(in_plane / in_space - 1.0), "outline" if number == 0 else f"hole-{number}"
    return Metric("length_error", worst, where={"edge": where} if where else None)


def runs(loop: Numbers, fitted: Refitted) -> list[Numbers]:
    """Return the vertices along each edge of a refitted loop."""
    ends = [*fitted.at[1:], fitted.at[0] + len(loop)]
    closed = np.concatenate([loop, loop, loop[:1]])
    return [
        closed[low : (high if high > low else high + len(loop)) + 1] for low, high in zip(fitted.at, ends, strict=True)
    ]


def _along_mesh(surface: MeshSurface, run: Numbers) -> bool:
    """Return whether a run of boundary vertices is no side of a seam or cut, which has been made smooth."""
    ends = {(int(side[0]), int(side[-1])) for pair in surface.seams for side in pair}
    pair = int(run[0]), int(run[-1])
    if any(np.isin(run, side).all() for slit in surface.slits for side in slit):
        return False
    return len(run) > len(pair) or not (pair in ends or pair[::-1] in ends)


def _length(points: Array) -> float:
    """Return the length of the cubic spline through points of the plane or of space, mm, by Gauss's rule."""
    from scipy.interpolate import CubicSpline

    if len(points) < LEAST_CURVED:
        return float(norm(np.diff(points, axis=0)).sum())
    chords = norm(np.diff(points, axis=0))
    curve = CubicSpline(np.concatenate([[0.0], np.cumsum(chords)]), points, axis=0)
    nodes, weights = np.polynomial.legendre.leggauss(5)
    low, high = curve.x[:-1, None], curve.x[1:, None]
    speed = norm(curve((low + high) / 2.0 + (high - low) / 2.0 * nodes, 1))
    return float((speed @ weights * (high - low)[:, 0] / 2.0).sum())


LEAST_CURVED = 4
"""Points through which a cubic spline is more than a guess."""


def _angle_error(surface: MeshSurface, flat: MeshMap, loops: Loops) -> float:
    """Return the largest difference of the angle of the part at a corner of its outline, degrees."""
    rest, laid = _angles(sides(surface, flat)), _angles(_flat_sides(surface, flat))
    count = len(surface.mesh.vertices)
    sums = [np.bincount(surface.mesh.faces.ravel(), angles.ravel(), minlength=count) for angles in (rest, laid)]
    corners = np.concatenate([loop[list(fitted.at)] for loop, fitted in zip(loops.vertices, loops.fitted, strict=True)])
    return float(np.degrees(np.abs(sums[0] - sums[1])[corners].max()))


def _flat_sides(surface: MeshSurface, flat: MeshMap) -> Array:
    corners = flat.positions[surface.mesh.faces]
    return norm(corners - np.roll(corners, -1, axis=1))


def _angles(lengths: Array) -> Array:
    """Return the angles at the corners 0, 1, 2 of triangles with sides 01, 12, 20, rad."""
    ab, bc, ca = lengths.T
    area = 4.0 * areas(lengths)
    return np.stack([
        np.arctan2(area, ab**2 + ca**2 - bc**2),
        np.arctan2(area, ab**2 + bc**2 - ca**2),
        np.arctan2(area, bc**2 + ca**2 - ab**2),
    ], axis=1)  # fmt: skip
