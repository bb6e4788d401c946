"""As rigid as possible: flat positions whose triangles are the nearest to given triangles turned, by Newton's method.

The energy is the sum over triangles of area times |F - R|^2, F the linear map of a triangle and R the rotation
nearest to it [1]_: the squares of both principal strains.  With s = |(F_11 + F_22, F_21 - F_12)|, the sum of the
singular values, it is |F|^2 - 2 s + 2, which has second derivatives in closed form: those of |F|^2 / 2 less the
turning mode t t^T / s [2]_. Alternating between rotations and positions [1]_ has the same minimum and gains a digit
in hundreds of rounds where a long strip must bend in its plane; Newton's steps double the digits.  Where the second
derivatives are not positive definite (triangles pressed together), 1/s is cut to 1/2, its value at rest.

.. [1] L. Liu, L. Zhang, Y. Xu, C. Gotsman, S. Gortler, "A local/global approach to mesh parameterization",
   Computer Graphics Forum 27 (5), 2008, 1495-1504.
.. [2] B. Smith, F. de Goes, T. Kim, "Analytic eigensystems for isotropic distortion energies", ACM Transactions on
   Graphics 38 (1), 2019, article 3.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array

from stages.errors import NoSolutionError
from stages.geometry.arrays import EPS, Array, ArrayValue, Indices, Numbers, Points2, Triples, Values, norm
from stages.geometry.mesh.intrinsic import areas
from stages.geometry.numeric.sparsesolve import Factors, factorised

MOST_STEPS = 200
"""Developable meshes take 3 to 6 steps, a hemisphere some 10."""
REUSED = 0.1
"""Factors are used again while a step is at most this share of the one before."""
SHARE = 1e-4
"""The least share of the promised fall of energy that is taken for one: Armijo's rule."""
SHORTEST = 2.0**-30
"""A step halved so often leads nowhere."""


@dataclass(frozen=True, slots=True, eq=False)
class Sheet(ArrayValue):
    """Triangles at rest.

    faces: their vertices.  by_corner: shape (m, 3, 2): F = sum over corners of position times this.  area: mm2.
    count: number of vertices.
    """

    faces: Triples
    by_corner: Array
    area: Values
    count: int


@dataclass(frozen=True, slots=True, eq=False)
class Settled:
    """Flat positions at rest.

    step_mm: how far the last step moved a vertex at most.  energy_mm2: what is left.
    """

    positions: Points2
    step_mm: float
    energy_mm2: float


def sheet(faces: Triples, corners: Array, count: int) -> Sheet:
    """Return triangles at rest where their corners are, shape (m, 3, 2)."""
    area = areas(corners)
    sides = corners[:, [2, 0, 1]] - corners[:, [1, 2, 0]]
    by_corner = np.stack([-sides[..., 1], sides[..., 0]], axis=-1) / (2.0 * area)[:, None, None]
    return Sheet(faces, by_corner, area, count)


def maps(rest: Sheet, positions: Points2) -> Array:
    """Return the linear maps F of the triangles, shape (m, 2, 2)."""
    return np.asarray(np.einsum("mkc,mkd->mcd", positions[rest.faces], rest.by_corner))


def strains(rest: Sheet, positions: Points2) -> Array:
    """Return the principal strains of the triangles, shape (m, 2), the larger first; -2 and less: turned over."""
    total, unlike, _ = _invariants(maps(rest, positions))
    return np.stack([(total + unlike) / 2.0 - 1.0, (total - unlike) / 2.0 - 1.0], axis=1)


def strain_tensors(rest: Sheet, positions: Points2) -> Array:
    """Return strains of the triangles along x and y of the plane, shape (m, 3): e_xx, e_xy, e_yy of sqrt(F F^T) - 1."""
    f = maps(rest, positions)
    e = np.einsum("mab,mcb->mac", f, _rotations(f)[0])
    return np.stack([e[:, 0, 0] - 1.0, (e[:, 0, 1] + e[:, 1, 0]) / 2.0, e[:, 1, 1] - 1.0], axis=1)


def _invariants(f: Array) -> tuple[Values, Values, Array]:
    """Return sum and difference of the singular values, and the vector (f11 + f22, f21 - f12)."""
    turning = np.stack([f[:, 0, 0] + f[:, 1, 1], f[:, 1, 0] - f[:, 0, 1]], axis=1)
    other = np.stack([f[:, 0, 0] - f[:, 1, 1], f[:, 1, 0] + f[:, 0, 1]], axis=1)
    return norm(turning), norm(other), turning


def _rotations(f: Array) -> tuple[Array, Values]:
    """Return the nearest rotations, shape (m, 2, 2), and the sums of the singular values."""
    total, _, turning = _invariants(f)
    c, s = (turning / np.maximum(total, EPS)[:, None]).T
    return np.stack([np.stack([c, -s], axis=1), np.stack([s, c], axis=1)], axis=1), total


def energy(rest: Sheet, positions: Points2) -> float:
    """Return the sum of area times squared principal strains, mm2."""
    f = maps(rest, positions)
    away = f - _rotations(f)[0]
    return float(rest.area @ np.einsum("mcd,mcd->m", away, away))


def settled(rest: Sheet, start: Points2, *, still: float) -> Settled:
    """Return the positions of least energy near `start`; the last step moves no vertex further than `still` mm.

    Raises NoSolutionError if steps do not become as short as that.
    """
    free, slots = free_unknowns(rest, start), slots_of(rest)
    positions, factors, last = start, None, np.inf
    for _ in range(MOST_STEPS):
        slope = slope_of(rest, positions)
        fresh = factors is None
        factors = factors or _factors(rest, positions, slots, free)
        step = np.zeros(2 * rest.count)
        step[free] = -factors.solved(slope[free])
        moved = step.reshape(-1, 2)
        longest = float(norm(moved).max())
        if longest <= still:
            positions = positions + moved
            return Settled(positions, longest, energy(rest, positions))
        share = _share(rest, positions, moved, float(slope @ step))
        if not share and fresh:
            break
        positions = positions + share * moved
        factors, last = (factors if share == 1.0 and longest <= REUSED * last else None), longest
    raise NoSolutionError("flattening as rigidly as possible", reached=longest, wanted=still, unit="mm")


def slope_of(rest: Sheet, positions: Array) -> Values:
    """Return the derivatives of the energy by the coordinates, vertex by vertex."""
    f = maps(rest, positions)
    parts = np.einsum("mcd,mkd->mkc", (2.0 * rest.area)[:, None, None] * (f - _rotations(f)[0]), rest.by_corner)
    unknowns = 2 * rest.faces[..., None] + np.arange(2)
    return np.bincount(unknowns.ravel(), parts.ravel(), minlength=2 * rest.count)


def free_unknowns(rest: Sheet, positions: Array) -> Indices:
    """Return the unknowns left when no motion of the whole is possible: a vertex is held, a far one on one line."""
    used = np.unique(rest.faces)
    away = np.abs(positions[used] - positions[used[0]])
    far, axis = np.unravel_index(int(np.argmax(away)), away.shape)
    unknowns = (2 * used[:, None] + np.arange(2)).ravel()
    held = [2 * used[0], 2 * used[0] + 1, 2 * used[far] + 1 - axis]
    return np.setdiff1d(unknowns, held)


def slots_of(rest: Sheet) -> tuple[csc_array, Numbers]:
    """Return a matrix with the right places and, for each entry of the triangles' matrices, its place there."""
    unknowns = (2 * rest.faces[..., None] + np.arange(2)).reshape(-1, 6)
    rows, columns = (np.broadcast_to(x, (len(unknowns), 6, 6)).ravel()
                     for x in (unknowns[:, :, None], unknowns[:, None, :]))  # fmt: skip
    n = 2 * rest.count
    keys, slots = np.unique(columns * n + rows, return_inverse=True)
    pointers = np.searchsorted(keys, np.arange(n + 1) * n)
    return csc_array((np.zeros(len(keys)), keys % n, pointers), shape=(n, n)), slots.astype(np.int64)


def _factors(rest: Sheet, positions: Points2, slots: tuple[csc_array, Numbers], free: Numbers) -> Factors:
    """Return the factors of the second derivatives, made positive definite if they are not."""
    for convex in (False, True):
        pattern, places = slots
        data = np.bincount(places, second(rest, positions, convex=convex).ravel(), minlength=len(pattern.data))
        whole = csc_array((data, pattern.indices, pattern.indptr), shape=pattern.shape)
        factors = factorised(csc_array(whole[free][:, free]))
        if factors.positive:
            return factors
    raise NoSolutionError("flattening: part of the mesh is free to move", reached=0.0, wanted=1.0)


def second(rest: Sheet, positions: Points2, *, convex: bool) -> Array:
    """Return the second derivatives of every triangle's energy, shape (m, 6, 6)."""
    r, total = _rotations(maps(rest, positions))
    quarter = np.stack([-r[:, 1], r[:, 0]], axis=1)
    mode = np.einsum("mcd,mkd->mkc", quarter, rest.by_corner).reshape(-1, 6)
    inverse = 1.0 / np.maximum(total, 2.0 if convex else EPS)
    plain = np.einsum("mkd,mld->mkl", rest.by_corner, rest.by_corner)
    whole = np.einsum("mkl,cd->mkcld", plain, np.eye(2)).reshape(-1, 6, 6)
    bent = whole - inverse[:, None, None] * mode[:, :, None] * mode[:, None, :]
    return np.asarray((2.0 * rest.area)[:, None, None] * bent)


def _share(rest: Sheet, positions: Points2, step: Points2, fall: float) -> float:
    """Return the share of the step that lowers the energy, whose slope along the step is `fall`; 0 if none does."""
    before, area = energy(rest, positions), float(rest.area.sum())
    rounding = ROUNDINGS * EPS * (before + np.sqrt(before * area) + EPS * area)
    share = 1.0
    while share > SHORTEST:
        if energy(rest, positions + share * step) <= before + rounding + SHARE * share * fall:
            return share
        share /= 2.0
    return 0.0


ROUNDINGS = 64
"""Strains are known to some roundings of 1, and their squares are summed."""
