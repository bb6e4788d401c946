"""A mesh fitted and laid flat as it will be cut: with the lengths that are kept, and what is sewn equally long."""

import numpy as np

from stages.geometry.arrays import Array, Numbers
from stages.geometry.mesh.fit import fitted, stars
from stages.geometry.mesh.flat import AT_REST, at_rest, edge_lengths, noise
from stages.geometry.mesh.ties import Ties, equal, kept, together
from stages.geometry.mesh.topology import Edges, edge_numbers, edges_of
from stages.model.surface import MeshSurface
from stages.verify.meshbounds import Studied


def study(surface: MeshSurface) -> Studied:
    """Return the mesh fitted and flattened.

    Raises NoSolutionError if it does not come to rest, or cannot keep the lengths that it must.
    """
    mesh, edges = surface.mesh, edges_of(surface.mesh)
    around = stars(mesh, edges)
    fit = fitted(mesh, around)
    lengths, kind = edge_lengths(mesh, edges, fit)
    ties = ties_of(surface, edges, lengths)
    still = AT_REST * surface.size_mm
    flat = at_rest(mesh, edges, lengths, ties, kind=kind, noise_mm=noise(fit), accuracy=still)
    return Studied(mesh, edges, around, fit, flat)


def ties_of(surface: MeshSurface, edges: Edges, lengths: Array) -> Ties:
    """Return the ties of a mesh: kept edges, and sides of cuts, edge by edge, unless both of them are kept."""
    numbers = edge_numbers(edges, surface.kept)
    one, other = (_edges([pair[i] for pair in surface.slits]) for i in (0, 1))
    both = np.isin(edge_numbers(edges, one), numbers) & np.isin(edge_numbers(edges, other), numbers)
    one, other = one[~both], other[~both]
    held = kept(surface.kept, lengths[numbers])
    return together(held, equal(one, other, lengths[edge_numbers(edges, one)]))


def _edges(sides: list[Numbers]) -> Numbers:
    """Return the edges along sides, shape (k, 2)."""
    none = np.zeros((0, 2), dtype=np.int64)
    return np.concatenate([none, *(np.stack([side[:-1], side[1:]], axis=1) for side in sides)])
