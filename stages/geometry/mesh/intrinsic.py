"""A first flattening of a mesh of which only the lengths of the edges are known: least squares conformal maps.

Each triangle is laid into the plane by itself from its three lengths; positions z (complex) are sought whose maps
of the triangles are the most nearly similarities [1]_.  With w_k the side against corner k as a complex number, a
map is a similarity iff w_0 z_0 + w_1 z_1 + w_2 z_2 = 0.  Two vertices far apart are held at their distance along
the mesh's longest way in space; the size is then set so that the area is that of the triangles.  For discs, with
holes or without.

.. [1] B. Levy, S. Petitjean, N. Ray, J. Maillot, "Least squares conformal maps for automatic texture atlas
   generation", ACM Transactions on Graphics 21 (3), 2002, 362-371.
"""

import numpy as np
from scipy.sparse import csc_array, csr_array

from stages.errors import NoSolutionError
from stages.geometry.arrays import Array, Numbers, Points2, Points3, Triples, Values
from stages.geometry.numeric.sparsesolve import factorised


def laid(lengths: Array) -> Array:
    """Return corners of triangles in the plane, shape (m, 3, 2), from the lengths of their sides 01, 12, 20, (m, 3).

    Raises NoSolutionError if three sides do not make a triangle.
    """
    a, b, c = lengths.T
    x = (a * a + c * c - b * b) / (2.0 * a)
    square = (c - x) * (c + x)
    if (square <= 0.0).any():
        short = float(np.min(np.sort(lengths, axis=1) @ np.array([1.0, 1.0, -1.0])))
        raise NoSolutionError("triangles from the lengths of their sides", reached=short, wanted=0.0, unit="mm")
    zero = np.zeros_like(a)
    corners = [np.stack(corner, axis=1) for corner in ((zero, zero), (a, zero), (x, np.sqrt(square)))]
    return np.stack(corners, axis=1)


def areas(corners: Array) -> Values:
    """Return the areas of triangles laid into the plane."""
    return np.asarray(corners[:, 1, 0] * corners[:, 2, 1] / 2.0)


def conformal(vertices: Points3, faces: Triples, corners: Array) -> Points2:
    """Return flat positions, mm, whose triangles are as nearly similar to the given ones as can be."""
    m, n = len(faces), len(vertices)
    z = corners[..., 0] + 1j * corners[..., 1]
    sides = z[:, [2, 0, 1]] - z[:, [1, 2, 0]]
    weights = sides / np.sqrt(2.0 * areas(corners))[:, None]
    rows = np.repeat(np.arange(m), 3)
    misfit = csr_array((weights.ravel(), (rows, faces.ravel())), shape=(m, n))
    held = np.array(_far_apart(vertices, np.unique(faces)))
    places = np.array([0.0, np.linalg.norm(vertices[held[1]] - vertices[held[0]])], dtype=np.complex128)
    free = np.setdiff1d(np.unique(faces), held)
    part = misfit[:, free]
    right = -(part.conj().T @ (misfit[:, held] @ places))
    flat = np.zeros(n, dtype=np.complex128)
    flat[held] = places
    flat[free] = factorised(csc_array(part.conj().T @ part)).solved_complex(right)
    p = flat[faces]
    made = ((p[:, 1] - p[:, 0]).conj() * (p[:, 2] - p[:, 0])).imag.sum() / 2.0
    flat *= np.sqrt(areas(corners).sum() / abs(made))
    return np.stack([flat.real, flat.imag], axis=1)


def _far_apart(vertices: Points3, candidates: Numbers) -> tuple[int, int]:
    """Return two vertices that lie far apart."""
    ends = [int(candidates[0])]
    for _ in range(2):
        away = np.linalg.norm(vertices[candidates] - vertices[ends[-1]], axis=1)
        ends.append(int(candidates[np.argmax(away)]))
    return ends[-2], ends[-1]
