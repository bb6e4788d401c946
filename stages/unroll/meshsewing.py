"""The sides of cuts in the pattern of a mesh, and the lengths that it keeps.

A cut runs along edges of the mesh, in a zigzag that nobody wants to cut.  Both sides go through the same vertices, so
the same least squares fit, a cubic at most between mouth and end, applied to either side gives the same line on the
part, to the square of the zigzag's width over the distance in which the strain changes.
"""

import numpy as np

from stages.geometry.arrays import Array, Numbers, Points2, Values, norm
from stages.geometry.curves import contours
from stages.geometry.mesh.arapkept import KEPT
from stages.geometry.mesh.meshmap import MeshMap
from stages.geometry.mesh.topology import edge_numbers, edges_of
from stages.model.report import Metric
from stages.model.surface import MeshSurface
from stages.unroll.meshdistortion import Loops, runs

PER_DEGREE = 4
"""Edges of a cut for each degree of the curve that it becomes; less would follow the zigzag."""

CUBIC = 3
"""The highest degree of that curve: it may bend to both sides between mouth and end, and no oftener."""


def without_zigzag(surface: MeshSurface, flat: MeshMap) -> Points2:
    """Return the flat positions, those inside the sides of cuts moved onto a smooth curve from mouth to end, mm."""
    places = flat.positions.copy()
    for pair in surface.slits:
        at = _shares(surface.mesh.vertices[pair[0]])
        for side in pair:
            places[side] = _smooth(flat.positions[side], at)
    return places


def _shares(points: Array) -> Values:
    """Return how far along a line each of its points is, from 0 to 1."""
    lengths = np.concatenate([[0.0], np.cumsum(norm(np.diff(points, axis=0)))])
    return np.asarray(lengths / lengths[-1])


def _smooth(points: Points2, at: Values) -> Points2:
    """Return the points moved onto the polynomial of least squares through the first and the last."""
    straight = (1.0 - at)[:, None] * points[0] + at[:, None] * points[-1]
    degree = min(CUBIC, max(1, len(points) // PER_DEGREE + 1))
    columns = np.stack([at**k - at for k in range(2, degree + 1)], axis=1) if degree > 1 else np.zeros((len(at), 0))
    weights = np.linalg.lstsq(columns, points - straight, rcond=None)[0]
    smooth: Points2 = straight + columns @ weights
    smooth[[0, -1]] = points[[0, -1]]
    return smooth


def sewing(surface: MeshSurface, flat: MeshMap, loops: Loops) -> tuple[Metric, ...]:
    """Return by how much kept lengths and sides of cuts are off; nothing where there is neither."""
    metrics = []
    if len(surface.kept):
        metrics.append(_kept(surface, flat))
    if surface.slits:
        off = norm(without_zigzag(surface, flat) - flat.positions)
        metrics += [
            Metric("seam_difference_mm", _difference(surface, loops), "mm"),
            Metric("cut_zigzag_mm", float(off.max()), "mm"),
        ]
    return tuple(metrics)


def _kept(surface: MeshSurface, flat: MeshMap) -> Metric:
    """Return the largest relative error of a kept length, with the middle of its edge in space."""
    lengths = flat.lengths[edge_numbers(edges_of(surface.mesh), surface.kept)]
    one, other = flat.positions[surface.kept[:, 0]], flat.positions[surface.kept[:, 1]]
    off = np.abs(norm(other - one) / lengths - 1.0)
    worst = int(np.argmax(off))
    middle = surface.mesh.vertices[surface.kept[worst]].mean(axis=0)
    where = dict(zip("xyz", map(float, middle), strict=True))
    return Metric("kept_length_error", float(off[worst]), "", "sampled", KEPT, dict(where))


def _difference(surface: MeshSurface, loops: Loops) -> float | None:
    """Return the largest difference of the lengths of both sides of a cut, as they are cut, mm; None if not known."""
    differences = [_side_length(one, loops) - _side_length(other, loops) for one, other in surface.slits]
    return float(np.abs(differences).max()) if np.isfinite(differences).all() else None


def _side_length(side: Numbers, loops: Loops) -> float:
    """Return the length of the edges along one side, mm; not a number where they run on beyond it."""
    length, covered = 0.0, 0
    for loop, fitted in zip(loops.vertices, loops.fitted, strict=True):
        for run, edge in zip(runs(loop, fitted), fitted.edges, strict=True):
            if np.isin(run, side).all():
                length += contours.length((edge,))
                covered += len(run) - 1
    return length if covered == len(side) - 1 else np.nan
