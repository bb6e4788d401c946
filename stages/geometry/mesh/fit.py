"""The smooth surface that the vertices of a triangle mesh were taken from: normals, curvatures and noise.

Around each vertex the height over a plane is fitted by a polynomial, weighted least squares on the nearest of the
vertices that a few edges lead to [1]_: another layer of a folded sheet is never among them.  The plane is that of a
quadratic fitted first.  At an edge of the mesh all neighbours lie to one side; nearly twice as many are taken
there.  What the heights are away from the polynomial is noise, or what its degree cannot follow: fits of degrees 3
and 4 tell these apart.

In plane coordinates u, v, evened so that the neighbours reach as far in all directions, the height is a sum of
c_ab u^a v^b; meshes much finer one way than the other lose nothing.  Creases are
smoothed over, and a mesh without vertices inside has too few neighbours: `residual` says so.

.. [1] F. Cazals, M. Pouget, "Estimating differential quantities using polynomial fitting of osculating jets",
   Computer Aided Geometric Design 22, 2005, 121-146.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from stages.geometry.arrays import Array, ArrayValue, Indices, Mask, Numbers, Points3, Values, cross3, dot, norm, unit
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.topology import Edges, on_border

MOST_TRIANGLES = 400_000
"""What is fitted and laid flat: 300 000 take 20 s and 1.4 GB, and 10 000 are already good for 1e-7 of the size."""

DEGREE = 4
INSIDE, AT_EDGE = 30, 50
"""Neighbours: twice the 15 coefficients; one-sided fits lose a third of a digit with fewer than 50."""
RINGS_INSIDE, RINGS_AT_EDGE = 3, 6
"""So many edges away a regular mesh has 36 and, to one side, 63 others."""
WIDE_DEGREE = 6
WIDE_INSIDE, WIDE_AT_EDGE = 56, 94
WIDE_RINGS_INSIDE, WIDE_RINGS_AT_EDGE = 4, 8
"""The same for what needs more digits: of an ellipsoid of 10 000 triangles degree 4 leaves 3e-6 rad, this 1e-7."""
SIZES = {
    DEGREE: ((RINGS_INSIDE, INSIDE), (RINGS_AT_EDGE, AT_EDGE)),
    WIDE_DEGREE: ((WIDE_RINGS_INSIDE, WIDE_INSIDE), (WIDE_RINGS_AT_EDGE, WIDE_AT_EDGE)),
}
"""Rings and neighbours for fits of these degrees, inside and at an edge of the mesh."""
FLAT_TO = 18
"""Neighbours of the quadratic fit that sets the plane: three times its coefficients."""
REACH = 2.1
"""Plane coordinates are divided by so many standard deviations: they stay within 1 or little more."""
INDEPENDENT = 1e-7
"""Least ratio of the diagonal of R at which the neighbours still tell all coefficients apart: 9 digits are left."""


@dataclass(frozen=True, slots=True, eq=False)
class Stars(ArrayValue):
    """Vertices with their neighbours.

    rows: the vertices.
    others: shape (len(rows), k), their nearest neighbours, the last one repeated where there are fewer.
    used: shape (len(rows), k), 1 for a neighbour, 0 for a repetition.
    """

    rows: Indices
    others: Numbers
    used: Array


@dataclass(frozen=True, slots=True, eq=False)
class SurfaceFit(ArrayValue):
    """The fit at every vertex of a mesh.

    normals: of the fitted surface.
    x, y: directions in the plane of the fit.  slope: shape (n, 2), dh/dx and dh/dy at the vertex.
    second: shape (n, 3), h_xx, h_xy, h_yy, 1/mm.
    residual: standard deviation of the heights from the fit, mm, the coefficients allowed for; infinite where the
        neighbours do not determine all coefficients.
    coarser: the same of the fit of one degree less.  relief: the same of a plane: how much shape there is.
    heights: of the fitted surface over the place that it was fitted around, mm, along the normal of its plane.
    """

    normals: Points3
    x: Points3
    y: Points3
    slope: Array
    second: Points3
    residual: Values
    coarser: Values
    relief: Values
    heights: Values

    def bending(self, at: Indices, along: Points3) -> Values:
        """Return the normal curvature along unit tangents, 1/mm, positive towards the normal."""
        x, y = dot(along, self.x[at]), dot(along, self.y[at])
        xx, xy, yy = self.second[at].T
        steep = np.sqrt(1.0 + dot(self.slope[at], self.slope[at]))
        return np.asarray((xx * x * x + 2.0 * xy * x * y + yy * y * y) / steep)


def stars(mesh: Mesh, edges: Edges, degree: int = DEGREE) -> tuple[Stars, ...]:
    """Return the neighbours of the vertices inside and of those at an edge of the mesh, for fits of one of `SIZES`."""
    if len(np.unique(mesh.faces)) != len(mesh.vertices):
        raise ValueError("a vertex belongs to no face")
    links = _links(mesh, edges)
    return tuple(
        _nearest(mesh.vertices, links, np.flatnonzero(some), *size)
        for some, size in zip(_inside_and_at_edge(mesh, edges), SIZES[degree], strict=True)
        if some.any()
    )


def _links(mesh: Mesh, edges: Edges) -> csr_array:
    """Return the graph of the edges."""
    n, (a, b) = len(mesh.vertices), edges.ends.T
    return csr_array((np.ones(2 * len(a), dtype=np.int32), (np.append(a, b), np.append(b, a))), shape=(n, n))


def _inside_and_at_edge(mesh: Mesh, edges: Edges) -> tuple[Mask, Mask]:
    """Return which vertices are inside and which at an edge of the mesh."""
    at_edge = on_border(mesh, edges)
    return ~at_edge, at_edge


def _nearest(vertices: Array, links: csr_array, rows: Indices, rings: int, count: int) -> Stars:
    """Return the `count` nearest among the vertices up to `rings` edges away.

    Distances are compared in single precision: of two equally far the lower number is taken, whatever the frame.
    """
    near = links[rows]
    for _ in range(rings - 1):
        near = near @ links + near
        near.data[:] = 1
    row, other = np.repeat(np.arange(len(rows)), np.diff(near.indptr)), near.indices.astype(np.int64)
    proper = other != rows[row]
    row, other = row[proper], other[proper]
    far = norm(vertices[other] - vertices[rows[row]])
    order = np.lexsort((other, (far / far.max(initial=TINY)).astype(np.float32), row))
    found = np.bincount(row, minlength=len(rows))
    k = np.arange(min(count, int(found.max())))
    place = (np.cumsum(found) - found)[:, None] + np.minimum(k, found[:, None] - 1)
    return Stars(rows, other[order][place], (k < found[:, None]).astype(np.float64))


def fitted(mesh: Mesh, around: tuple[Stars, ...], degree: int = DEGREE) -> SurfaceFit:
    """Return the surface fitted around every vertex."""
    rows = np.concatenate([star.rows for star in around])
    normals, order = _rough_normals(mesh), np.argsort(rows)
    parts = [_fitted(mesh.vertices, block, normals, degree) for star in around for block in _blocks(star)]
    return _in_order(parts, order)


def fitted_at(mesh: Mesh, edges: Edges, places: Points3, beside: Indices, degree: int = WIDE_DEGREE) -> SurfaceFit:
    """Return the surface fitted around places near the mesh, each to the neighbours of a vertex beside it.

    The normal is that at the foot of the place on the surface, as far as the quadratic fit knows where that is.
    """
    links, normals = _links(mesh, edges), _rough_normals(mesh)
    parts, order = list[SurfaceFit](), list[Numbers]()
    for some, size in zip(_inside_and_at_edge(mesh, edges), SIZES[WIDE_DEGREE], strict=True):
        mine = np.flatnonzero(some[beside])
        for block in np.split(mine, range(BLOCK, len(mine), BLOCK)) if len(mine) else ():
            star = _with_itself(_nearest(mesh.vertices, links, beside[block], *size))
            parts.append(_fitted_about(mesh.vertices, star, places[block], normals, degree))
            order.append(block)
    return _in_order(parts, np.argsort(np.concatenate(order)))


def _with_itself(star: Stars) -> Stars:
    """Return the neighbours with the vertex among them, as the first."""
    first = np.ones((len(star.rows), 1))
    return Stars(star.rows, np.hstack([star.rows[:, None], star.others]), np.hstack([first, star.used]))


def _in_order(parts: list[SurfaceFit], order: Numbers) -> SurfaceFit:
    """Return fits of several vertices each as one, in another order."""
    names = SurfaceFit.__dataclass_fields__
    return SurfaceFit(*(np.concatenate([getattr(part, name) for part in parts])[order] for name in names))


def _blocks(star: Stars) -> Iterator[Stars]:
    """Yield the vertices in blocks whose matrices stay within the processor's memory."""
    for k in range(0, len(star.rows), BLOCK):
        part = slice(k, k + BLOCK)
        yield Stars(star.rows[part], star.others[part], star.used[part])


BLOCK = 2048
"""Matrices of 30 x 15 doubles take 7 MB together; a million vertices at once would take gigabytes."""


def _rough_normals(mesh: Mesh) -> Points3:
    """Return the sums of the adjacent faces' normals, weighted by area, as unit vectors."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    areas = cross3(b - a, c - a)
    n = len(mesh.vertices)
    sums = [np.bincount(mesh.faces.ravel(), np.repeat(areas[:, k], 3), minlength=n) for k in range(3)]
    return unit(np.stack(sums, axis=1))


def _fitted(vertices: Points3, star: Stars, normals: Points3, degree: int) -> SurfaceFit:
    return _fitted_about(vertices, star, vertices[star.rows], normals, degree)


def _fitted_about(vertices: Array, star: Stars, places: Array, normals: Array, degree: int) -> SurfaceFit:
    """Return the surfaces around places of their own, to the neighbours of the vertices beside them."""
    away = vertices[star.others] - places[:, None]
    few = min(FLAT_TO, away.shape[1])
    flat = _polynomial(away[:, :few], star.used[:, :few], normals[star.rows], 2)
    return _polynomial(away, star.used, flat.normals, degree)


def _polynomial(away: Array, used: Array, z: Points3, degree: int) -> SurfaceFit:
    """Return the fits of heights over the planes through the vertices with normals z."""
    x, y = _plane(z)
    count = np.maximum(used.sum(axis=1), 1.0)
    local = np.einsum("nkd,nde->nke", away, np.stack([x, y], axis=2))
    inverse = _evened(local, used, count)
    u, v = np.einsum("nab,nkb->ank", inverse, local)
    weight = used * np.exp(-(u * u + v * v))
    heights = weight * np.einsum("nkd,nd->nk", away, z)
    c, left, sound = _least_squares(weight[..., None] * _monomials(u, v, degree), heights)
    total = dot(weight, weight)
    spreads = [
        np.sqrt(left[terms] / (total * np.maximum(1.0 - terms / count, 1.0 / count)))
        for terms in (_terms(degree), _terms(degree - 1), _terms(1))
    ]
    residual = np.where(sound & (count > _terms(degree)), spreads[0], np.inf)
    slope = np.einsum("na,nab->nb", c[:, 1:3], inverse)
    form = np.stack([2.0 * c[:, 3], c[:, 4], c[:, 4], 2.0 * c[:, 5]], axis=1).reshape(-1, 2, 2)
    second = np.einsum("nac,nab,nbd->ncd", inverse, form, inverse).reshape(-1, 4)[:, [0, 1, 3]]
    normals = unit(z - slope[:, :1] * x - slope[:, 1:] * y)
    return SurfaceFit(normals, x, y, slope, second, residual, spreads[1], spreads[2], c[:, 0])


def _evened(local: Array, used: Array, count: Values) -> Array:
    """Return the matrices, shape (n, 2, 2), that make the neighbours' spread in the plane the same in all directions.

    They are the inverses of Cholesky's factors of the second moments, divided by `REACH`.
    """
    xx, xy, yy = (
        np.einsum("nk,nk,nk->n", used, local[..., a], local[..., b]) / count for a, b in ((0, 0), (0, 1), (1, 1))
    )
    a = np.sqrt(xx) + TINY
    b = xy / a
    c = np.maximum(np.sqrt(np.maximum(yy - b * b, 0.0)), INDEPENDENT * a)
    rows = np.stack([1.0 / a, np.zeros_like(a), -b / (a * c), 1.0 / c], axis=1)
    return np.asarray(rows.reshape(-1, 2, 2) / REACH)


TINY = 1e-150
"""Keeps neighbours in one place from dividing by 0; their fit is not sound."""


def _terms(degree: int) -> int:
    """Return the number of coefficients of a polynomial in two variables."""
    return (degree + 1) * (degree + 2) // 2


def _plane(z: Points3) -> tuple[Points3, Points3]:
    """Return two perpendicular directions in each plane."""
    least = np.eye(3)[np.argmin(np.abs(z), axis=1)]
    x = unit(least - dot(least, z)[:, None] * z)
    return x, cross3(z, x)


def _monomials(x: Array, y: Array, degree: int) -> Array:
    """Return 1, x, y, x^2, x y, y^2, ... along a new last axis."""
    powers = [(total - b, b) for total in range(degree + 1) for b in range(total + 1)]
    xs, ys = ([np.ones_like(t)] for t in (x, y))
    for _ in range(degree):
        xs.append(xs[-1] * x)
        ys.append(ys[-1] * y)
    return np.stack([xs[a] * ys[b] for a, b in powers], axis=-1)


def _least_squares(matrix: Array, right: Array) -> tuple[Array, Array, Mask]:
    """Return coefficients, squares left by the first k columns, and where the columns are independent (else all 0).

    Squares left: shape (columns + 1, n), by k from 0; columns that come first are orthogonalised first.
    """
    columns = matrix.shape[2]
    missing = max(columns - matrix.shape[1], 0)
    q, r = np.linalg.qr(np.pad(matrix, ((0, 0), (0, missing), (0, 0))))
    diagonal = np.abs(np.einsum("nii->ni", r))
    sound = np.asarray(diagonal.min(axis=1) > INDEPENDENT * diagonal.max(axis=1))
    r[~sound] = np.eye(columns)
    parts = np.einsum("nkm,nk->nm", q, np.pad(right, ((0, 0), (0, missing)))) * sound[:, None]
    c = np.linalg.solve(r, parts[..., None])[..., 0]
    rest = right - np.einsum("nkm,nm->nk", matrix, c)
    left = dot(rest, rest)[:, None] + np.append(np.cumsum(parts[:, ::-1] ** 2, axis=1)[:, ::-1], 0.0 * c[:, :1], axis=1)
    return c, left.T, sound
