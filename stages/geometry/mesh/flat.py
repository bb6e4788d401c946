"""A mesh laid into the plane: as its vertices' smooth surface would unroll, not as its chords do.

Edges get their lengths on the surface fitted to the vertices (`fit`, `lengths`); three lengths make a
triangle; the triangles are laid flat conformally (`intrinsic`) and then as rigidly as possible (`arap`).  On chords
every method lands on the unrolled polyhedron, of which the error falls with the square of the edges, 1e-5 of the
size at 10 000 triangles; the fit leaves 3e-8 and less.  Where noise or creases make its slopes worthless the chords
are taken, and the map says so.

For discs, holes allowed.  A developable mesh comes out at rest; any other with the least squares of its principal
strains.
"""

import numpy as np

from stages.geometry.arrays import Array, Values
from stages.geometry.mesh.arap import Sheet, sheet, strains
from stages.geometry.mesh.arapkept import settled_with
from stages.geometry.mesh.fit import SurfaceFit, fitted, stars
from stages.geometry.mesh.intrinsic import conformal, laid
from stages.geometry.mesh.lengths import chords, curved, mended
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.meshmap import Kind, MeshMap
from stages.geometry.mesh.ties import Ties, no_ties
from stages.geometry.mesh.topology import Edges, edges_of


def flattened(mesh: Mesh, *, accuracy: float) -> MeshMap:
    """Return the mesh in the plane, at rest: the last of Newton's steps moved no vertex further than `accuracy` mm.

    Raises NoSolutionError if that was not reached.
    """
    edges = edges_of(mesh)
    fit = fitted(mesh, stars(mesh, edges))
    lengths, kind = edge_lengths(mesh, edges, fit)
    return at_rest(mesh, edges, lengths, kind=kind, noise_mm=noise(fit), accuracy=accuracy)


def noise(fit: SurfaceFit) -> float:
    """Return how far vertices typically lie from the surface fitted to their neighbours, mm; infinite if unknown."""
    known = fit.residual[np.isfinite(fit.residual)]
    return float(np.median(known)) if len(known) else float(np.inf)


AT_REST = 1e-10
"""The last step of a flattening, relative to the size of the part: a nanometre on one of 10 m."""


def at_rest(
    mesh: Mesh, edges: Edges, lengths: Array, ties: Ties | None = None, *, kind: Kind, noise_mm: float, accuracy: float
) -> MeshMap:
    """Return the mesh laid flat on given edge lengths; ties: equations between those that hold exactly."""
    rest = resting(mesh, edges, lengths)
    start = conformal(mesh.vertices, mesh.faces, laid(by_side(edges, lengths)))
    found = settled_with(rest, start, no_ties() if ties is None else ties, still=accuracy)
    left = strains(rest, found.positions)
    return MeshMap(found.positions, lengths, left, noise_mm, kind, found.step_mm)


def by_side(edges: Edges, lengths: Values) -> Array:
    """Return the lengths of the sides 01, 12, 20 of every triangle, shape (m, 3)."""
    return np.asarray(lengths[edges.of_half].reshape(-1, 3))


def resting(mesh: Mesh, edges: Edges, lengths: Values) -> Sheet:
    """Return the triangles at rest on given edge lengths."""
    return sheet(mesh.faces, laid(by_side(edges, lengths)), len(mesh.vertices))


def edge_lengths(mesh: Mesh, edges: Edges, fit: SurfaceFit) -> tuple[Values, Kind]:
    """Return the lengths on the fitted surface, the chords' where the fit is not to be believed, and what most are."""
    straight = chords(mesh.vertices, edges.ends)
    lengths, smooth = curved(mesh.vertices, edges.ends, fit)
    if smooth.mean() < MOSTLY:
        return straight, "chord"
    return mended(np.where(smooth, lengths, straight), straight, edges.of_half), "curved"


MOSTLY = 0.5
"""Least share of edges on the fitted surface for a map of the curved kind."""
